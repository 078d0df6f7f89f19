/* gonio_wasm.h: what a WebAssembly module without a C library needs, in place of
 * <math.h> and <stdlib.h>:
 *
 *     clang --target=wasm32 -nostdlib -O2 -Wl,--no-entry brdf.c -o brdf.wasm
 *
 * The functions of math.h are imports that gonio provides; malloc, free, memcpy,
 * memmove and memset are here, and gonio_alloc and gonio_free are made of them.
 * Any number of the module's files may include it: what it defines is weak.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef GONIO_WASM_H
#define GONIO_WASM_H

#if !defined(__wasm32__)
#error "gonio_wasm.h is for --target=wasm32; elsewhere include <math.h> and <stdlib.h>"
#endif

#include "gonio.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GONIO_WEAK __attribute__((weak))
#define GONIO_IMPORT(name) __attribute__((import_module("env"), import_name(#name)))

/* Definitions that call an import, since clang forgets what a declaration says of
 * functions that it knows. The linker leaves out those that nobody calls. */
#define GONIO_MATH(name) \
    GONIO_IMPORT(name) double gonio_import_##name(double); \
    GONIO_IMPORT(name##f) float gonio_import_##name##f(float); \
    GONIO_WEAK double name(double x) { return gonio_import_##name(x); } \
    GONIO_WEAK float name##f(float x) { return gonio_import_##name##f(x); }
#define GONIO_MATH_2(name) \
    GONIO_IMPORT(name) double gonio_import_##name(double, double); \
    GONIO_IMPORT(name##f) float gonio_import_##name##f(float, float); \
    GONIO_WEAK double name(double x, double y) { return gonio_import_##name(x, y); } \
    GONIO_WEAK float name##f(float x, float y) { return gonio_import_##name##f(x, y); }

/* Those that are instructions of wasm. */
#define GONIO_INSTRUCTION(name) \
    GONIO_WEAK double name(double x) { return __builtin_##name(x); } \
    GONIO_WEAK float name##f(float x) { return __builtin_##name##f(x); }

GONIO_MATH(sin)
GONIO_MATH(cos)
GONIO_MATH(tan)
GONIO_MATH(asin)
GONIO_MATH(acos)
GONIO_MATH(atan)
GONIO_MATH(sinh)
GONIO_MATH(cosh)
GONIO_MATH(tanh)
GONIO_MATH(asinh)
GONIO_MATH(acosh)
GONIO_MATH(atanh)
GONIO_MATH(exp)
GONIO_MATH(exp2)
GONIO_MATH(expm1)
GONIO_MATH(log)
GONIO_MATH(log2)
GONIO_MATH(log10)
GONIO_MATH(log1p)
GONIO_MATH(cbrt)
GONIO_MATH(erf)
GONIO_MATH(erfc)
GONIO_MATH(lgamma)
GONIO_MATH(tgamma)
GONIO_MATH(round)
GONIO_MATH_2(pow)
GONIO_MATH_2(atan2)
GONIO_MATH_2(hypot)
GONIO_MATH_2(fmod)
GONIO_MATH_2(fmin)
GONIO_MATH_2(fmax)
GONIO_INSTRUCTION(sqrt)
GONIO_INSTRUCTION(fabs)
GONIO_INSTRUCTION(floor)
GONIO_INSTRUCTION(ceil)
GONIO_INSTRUCTION(trunc)
GONIO_INSTRUCTION(rint)
GONIO_INSTRUCTION(nearbyint)
GONIO_WEAK double copysign(double x, double y) { return __builtin_copysign(x, y); }
GONIO_WEAK float copysignf(float x, float y) { return __builtin_copysignf(x, y); }

/* clang writes calls of these three for copies and zeros. */
GONIO_WEAK void *memcpy(void *to, const void *from, size_t size)
{
    char *t = (char *)to;
    const char *f = (const char *)from;
    for (; size > 0; --size) {
        *t++ = *f++;
    }
    return to;
}

GONIO_WEAK void *memmove(void *to, const void *from, size_t size)
{
    char *t = (char *)to;
    const char *f = (const char *)from;
    if (t < f) {
        for (; size > 0; --size) {
            *t++ = *f++;
        }
    } else {
        for (; size > 0; --size) {
            t[size - 1] = f[size - 1];
        }
    }
    return to;
}

GONIO_WEAK void *memset(void *to, int byte, size_t size)
{
    char *t = (char *)to;
    for (; size > 0; --size) {
        *t++ = (char)byte;
    }
    return to;
}

/* Blocks of 2^k bytes, each behind a head of 16 that tells k while it is used and
 * the next free block of its size while it is not. */
typedef union gonio_block {
    struct {
        union gonio_block *next;
        unsigned size; /* k */
    } head;
    char bytes[16];
} gonio_block;

extern unsigned char __heap_base; /* where the linker's data ends */
GONIO_WEAK size_t gonio_heap_end; /* as far as memory was given away; 0 at first */
GONIO_WEAK gonio_block *gonio_free_blocks[32];

GONIO_WEAK void *malloc(size_t size)
{
    unsigned k = 5;
    gonio_block *block;
    size_t start, have, need;
    while (k < 31 && ((size_t)1 << k) - sizeof *block < size) {
        ++k;
    }
    need = (size_t)1 << k;
    if (k == 31) {
        return NULL;
    }
    block = gonio_free_blocks[k];
    if (block != NULL) {
        gonio_free_blocks[k] = block->head.next;
        return block + 1;
    }
    start = gonio_heap_end != 0 ? gonio_heap_end : ((size_t)&__heap_base + 15) / 16 * 16;
    have = __builtin_wasm_memory_size(0) * (size_t)65536;
    if (start + need > have) {
        const size_t pages = (start + need - have + 65535) / 65536;
        if (start + need < start || __builtin_wasm_memory_grow(0, pages) == (size_t)-1) {
            return NULL;
        }
    }
    gonio_heap_end = start + need;
    block = (gonio_block *)start;
    block->head.size = k;
    return block + 1;
}

GONIO_WEAK void free(void *address)
{
    if (address != NULL) {
        gonio_block *block = (gonio_block *)address - 1;
        block->head.next = gonio_free_blocks[block->head.size];
        gonio_free_blocks[block->head.size] = block;
    }
}

GONIO_WEAK void *gonio_alloc(size_t size)
{
    return malloc(size);
}

GONIO_WEAK void gonio_free(void *address, size_t size)
{
    (void)size;
    free(address);
}

#ifdef __cplusplus
}
#endif

#endif
