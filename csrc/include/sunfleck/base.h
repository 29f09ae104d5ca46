// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* base: status and error, version, instruction set, float conversion, bit tricks.
 *
 * Everything here is thread-safe. The library's one mutable global is a cache, behind a lock, of the memory of
 * the film destroyed last; no result depends on it.
 */
#ifndef SUNFLECK_BASE_H
#define SUNFLECK_BASE_H

#include <float.h>
#include <stddef.h>
#include <stdint.h>

/* The bits that the library promises take IEEE arithmetic in the type itself, and words whose low byte comes
 * first: a build for another machine would not fail, but give other numbers. */
#if defined(__BYTE_ORDER__) && defined(__ORDER_LITTLE_ENDIAN__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "Sunfleck does not support big-endian processors: its samples would have other bits there"
#endif
#if !defined(FLT_EVAL_METHOD) || (FLT_EVAL_METHOD != 0 && FLT_EVAL_METHOD != 16)
#error "Sunfleck needs floats that are computed as floats (FLT_EVAL_METHOD 0); on i686 compile with -msse2 -mfpmath=sse"
#endif

/* What a shared library exports. Everything else in it is hidden; a static one has nothing to say. */
#if defined(SF_BUILD_SHARED) && defined(__GNUC__)
#define SF_API __attribute__((visibility("default")))
#else
#define SF_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define SF_VERSION_MAJOR 0
#define SF_VERSION_MINOR 1
#define SF_VERSION_PATCH 0

/* The version of the library that is linked, "major.minor.patch". */
SF_API const char *sf_version(void);

/* What became of a call. Only what can fail from outside returns one. */
typedef enum sf_status {
    SF_STATUS_OK = 0,
    SF_STATUS_INVALID_VALUE, /* an argument, option or datum out of its range */
    SF_STATUS_OUT_OF_MEMORY,
    SF_STATUS_IO,          /* a file could not be read or written */
    SF_STATUS_UNSUPPORTED, /* a method that lacks this operation, or a component not built in */
    SF_STATUS_BACKEND,     /* Embree or OpenImageIO reported an error of its own */
    SF_STATUS_INTERRUPTED  /* the caller's sf_interrupt said stop */
} sf_status;

#define SF_ERROR_MESSAGE_SIZE 512

/* Filled by a failing call when the caller passed one (every `error` may be NULL).
 * The message names the value given and what is allowed; it is always NUL-terminated. */
typedef struct sf_error {
    sf_status status;
    char message[SF_ERROR_MESSAGE_SIZE];
} sf_error;

/* "ok", "invalid value", … ; never NULL. */
SF_API const char *sf_status_name(sf_status status);

/* How a caller stops work that may run long. What takes one calls `asked` with `user`, about forty times a
 * second, always on the thread that called it, and ends with SF_STATUS_INTERRUPTED some milliseconds after it
 * returned anything but 0. NULL in its place: the work is never stopped. Work of less than 25 ms does not ask. */
typedef struct sf_interrupt {
    int (*asked)(void *user);
    void *user;
} sf_interrupt;

/* A piece of some work: items first .. first + count - 1. */
typedef sf_status (*sf_piece_fn)(void *user, size_t first, size_t count, sf_error *error);

/* Calls `work` with `user` for pieces of items 0 .. total - 1 in order, on the calling thread, until one fails,
 * whose status it returns, or `interrupt` says stop. Each piece but the last is a multiple of `smallest`, at least 1,
 * and they grow until each takes some 10 to 30 ms, so that neither short work nor long pays for the asking. Without
 * an interrupt, or where total <= smallest, there is one piece, even of no items. Thread-safe. */
SF_API sf_status sf_work_in_pieces(size_t total, size_t smallest, sf_piece_fn work, void *user,
                                   const sf_interrupt *interrupt, sf_error *error);

/* Whether `name` is the one `known`, capital letters of ASCII being as small ones, "-" and " " as "_"; 0 where one
 * is NULL. Every look-up by name in the library compares so. */
SF_API int sf_name_matches(const char *name, const char *known);

/* The instruction set at which bulk kernels run. The core's results are the same bits
 * on every one. */
typedef enum sf_isa { SF_ISA_BASELINE = 0, SF_ISA_AVX2, SF_ISA_AVX512 } sf_isa;

/* The highest level that this processor and this build have; the environment variable
 * SUNFLECK_ISA (baseline, avx2, avx512) lowers it. Read at each call: about 0.1 µs. */
SF_API sf_isa sf_isa_active(void);

/* "baseline", "avx2", "avx512"; never NULL. */
SF_API const char *sf_isa_name(sf_isa isa);

/* A float in [0,1), never 1, from the top 24 bits: 24 bits are what a float's significand
 * holds, so the integer converts exactly, and the product with 2^-24 is exact too. The
 * largest result is 1 - 2^-24. Multiplying all 32 bits by 2^-32 would instead round up, and
 * return 1 for 128 of the 2^32 inputs. */
static inline float sf_float_from_bits(uint32_t bits) { return (float)(int32_t)(bits >> 8) * 0x1p-24f; }

/* A double in [0,1), never 1, from the top 53 bits, exact for the same reason. */
static inline double sf_double_from_bits(uint64_t bits) { return (double)(int64_t)(bits >> 11) * 0x1p-53; }

/* The 32 bits in reverse order. */
static inline uint32_t sf_reverse_bits32(uint32_t x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
    return (x >> 16) | (x << 16);
}

/* The 64 bits in reverse order. */
static inline uint64_t sf_reverse_bits64(uint64_t x) {
    return ((uint64_t)sf_reverse_bits32((uint32_t)x) << 32) | sf_reverse_bits32((uint32_t)(x >> 32));
}

/* The high half of the 128-bit product, from four products of 32-bit halves: C99, and a loop of
 * it vectorizes. */
static inline uint64_t sf_multiply_high64_by_halves(uint64_t a, uint64_t b) {
    uint64_t a0 = a & 0xffffffffu, a1 = a >> 32, b0 = b & 0xffffffffu, b1 = b >> 32;
    uint64_t middle = a1 * b0 + (a0 * b0 >> 32), low = a0 * b1 + (middle & 0xffffffffu);
    return a1 * b1 + (middle >> 32) + (low >> 32);
}

/* The same, by one instruction where the compiler has 128-bit integers. They are not C99, but
 * three times as fast here, and inline draws of 64-bit generators consist of little else. */
static inline uint64_t sf_multiply_high64(uint64_t a, uint64_t b) {
#if defined(__SIZEOF_INT128__)
    __extension__ typedef unsigned __int128 wide;
    return (uint64_t)((wide)a * b >> 64);
#else
    return sf_multiply_high64_by_halves(a, b);
#endif
}

/* A bijective mix of 64 bits in which every input bit reaches every output bit: the finalizer
 * of SplitMix64 (Stafford's variant 13; Steele, Lea & Flood 2014). Fixed point: 0. */
static inline uint64_t sf_mix64(uint64_t x) {
    x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
    return x ^ (x >> 31);
}

/* A key for the pair (key, word), for deriving seeds of dimensions, pixels and streams: two
 * rounds of sf_mix64 around an odd-constant step, so that neither neighbouring keys nor
 * neighbouring words give related results. */
static inline uint64_t sf_hash64(uint64_t key, uint64_t word) {
    return sf_mix64(sf_mix64(key + UINT64_C(0x9e3779b97f4a7c15)) ^
                    (word * UINT64_C(0xd1342543de82ef95) + UINT64_C(0x632be59bd9b4e019)));
}

#ifdef __cplusplus
}
#endif
#endif
