/* The freestanding target of `zig cc` has no libc headers; these become instructions or calls. */
#ifndef UWB_COUNT_MATH_H
#define UWB_COUNT_MATH_H
float expf(float x);
float fabsf(float x);
float floorf(float x);
float fmaf(float x, float y, float z);
float fmaxf(float x, float y);
float fminf(float x, float y);
float logf(float x);
float rintf(float x);
float roundf(float x);
float sqrtf(float x);
#define isnan(x) __builtin_isnan(x)
#define isfinite(x) __builtin_isfinite(x)
#endif
