/* The freestanding target of `zig cc` has no libc headers; its compiler runtime has these. */
#ifndef UWB_COUNT_STRING_H
#define UWB_COUNT_STRING_H
#include <stddef.h>
void *memcpy(void *restrict to, const void *restrict from, size_t bytes);
void *memmove(void *to, const void *from, size_t bytes);
void *memset(void *at, int value, size_t bytes);
/* zig compiles freestanding targets without builtins: a copy of four bytes would be a call. */
#define memcpy(to, from, bytes) __builtin_memcpy((to), (from), (bytes))
#define memset(at, value, bytes) __builtin_memset((at), (value), (bytes))
#endif
