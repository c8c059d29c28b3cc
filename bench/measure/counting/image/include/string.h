/* The freestanding target of `zig cc` has no libc headers; its compiler runtime has these. */
#ifndef UWB_COUNT_STRING_H
#define UWB_COUNT_STRING_H
#include <stddef.h>
void *memcpy(void *restrict to, const void *restrict from, size_t bytes);
void *memmove(void *to, const void *from, size_t bytes);
void *memset(void *at, int value, size_t bytes);
#endif
