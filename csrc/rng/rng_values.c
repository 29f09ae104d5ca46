// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* One value at a time from any generator: functions made for each kind, found in a table. */
#include <assert.h>

#include "rng/rng_methods.h"

int sf_rng_is_scaled(const sf_rng *rng) {
    return (rng->kind == SF_RNG_LCG32 && rng->as.lcg32.modulus) || (rng->kind == SF_RNG_LCG64 && rng->as.lcg64.modulus);
}

/* ---- methods of 64 bits ---- */

/* Gives out a waiting half, or the low one of `draw()`, whose high half then waits. */
#define HALF(rng, draw)                          \
    do {                                         \
        uint32_t half = (rng)->pending;          \
        int waited = (rng)->has_pending;         \
        uint64_t word = waited ? 0 : (draw);     \
        (rng)->pending = (uint32_t)(word >> 32); \
        (rng)->has_pending = !waited;            \
        return waited ? half : (uint32_t)word;   \
    } while (0)

#define WIDE(member, next)                                                                          \
    static uint64_t next##_raw(void *rng) { return sf_##next##_next(&((sf_rng *)rng)->as.member); } \
    static uint32_t next##_half(void *rng) { HALF((sf_rng *)rng, next##_raw(rng)); }                \
    static double next##_f64(void *rng) { return sf_double_from_bits(next##_raw(rng)); }

WIDE(xorshift64, xorshift64)
WIDE(xorshift64, xorshift64_lrl)
WIDE(combined, combined)
WIDE(mt19937_64, mt19937_64)
WIDE(pcg64dxsm, pcg64dxsm)
WIDE(xoshiro256pp, xoshiro256pp)
WIDE(sfc64, sfc64)
WIDE(philox4x64, philox4x64)
WIDE(splitmix64, splitmix64)

/* ---- methods of 31 and 32 bits ---- */

/* The top 27 bits of a word above the top 26 of the next; both and their sum are exact. */
static double double_of_words(uint32_t first, uint32_t second) {
    return (double)(int32_t)(first >> 5) * 0x1p-27 + (double)(int32_t)(second >> 6) * 0x1p-53;
}

#define NARROW(next, bits)                                                                        \
    static uint64_t next##_raw(void *rng) { return sf_##next##_next(&((sf_rng *)rng)->as.next); } \
    static uint32_t next##_top(void *rng) { return (uint32_t)next##_raw(rng) << (32 - (bits)); }  \
    static uint32_t next##_full32(void *rng) {                                                    \
        uint32_t first = next##_top(rng);                                                         \
        return (bits) == 32 ? first : (first & 0xffff0000u) | next##_top(rng) >> 16;              \
    }                                                                                             \
    static uint64_t next##_full64(void *rng) {                                                    \
        uint64_t first = next##_full32(rng);                                                      \
        return first << 32 | next##_full32(rng);                                                  \
    }                                                                                             \
    static double next##_f64(void *rng) {                                                         \
        uint32_t first = next##_top(rng);                                                         \
        return double_of_words(first, next##_top(rng));                                           \
    }

NARROW(minstd, 31)
NARROW(randu, 31)
NARROW(ran1, 31)
NARROW(ran2, 31)
NARROW(mt19937, 32)
NARROW(pcg32, 32)
NARROW(philox4x32, 32)

/* ---- general LCGs: fractions of whatever modulus they have ---- */

static uint64_t lcg32_raw(void *rng) { return sf_lcg32_next(&((sf_rng *)rng)->as.lcg32); }

static uint32_t lcg32_full32(void *rng) {
    uint32_t word = (uint32_t)lcg32_raw(rng);
    if (sf_rng_is_scaled(rng)) sf_rng_lcg32.scale(rng, 1, &word);
    return word;
}

static uint64_t lcg32_full64(void *rng) {
    uint64_t first = lcg32_full32(rng);
    return first << 32 | lcg32_full32(rng);
}

static double lcg32_f64(void *rng) {
    uint32_t first = lcg32_full32(rng);
    return double_of_words(first, lcg32_full32(rng));
}

static uint64_t lcg64_raw(void *rng) { return sf_lcg64_next(&((sf_rng *)rng)->as.lcg64); }

static uint64_t lcg64_full64(void *rng) {
    uint64_t word = lcg64_raw(rng);
    if (sf_rng_is_scaled(rng)) sf_rng_lcg64.scale(rng, 1, &word);
    return word;
}

static uint32_t lcg64_full32(void *rng) {
    if (sf_rng_is_scaled(rng)) return (uint32_t)(lcg64_full64(rng) >> 32);
    HALF((sf_rng *)rng, lcg64_raw(rng));
}

static double lcg64_f64(void *rng) { return sf_double_from_bits(lcg64_full64(rng)); }

/* ---- any ---- */

#define WIDE_VALUES(next) {next##_raw, next##_half, next##_f64, next##_raw}
#define NARROW_VALUES(next) {next##_full64, next##_full32, next##_f64, next##_raw}

static const sf_rng_callbacks values[SF_RNG_COUNT] = {
    [SF_RNG_MINSTD] = NARROW_VALUES(minstd),       [SF_RNG_LCG32] = NARROW_VALUES(lcg32),
    [SF_RNG_LCG64] = NARROW_VALUES(lcg64),         [SF_RNG_RANDU] = NARROW_VALUES(randu),
    [SF_RNG_RAN1] = NARROW_VALUES(ran1),           [SF_RNG_RAN2] = NARROW_VALUES(ran2),
    [SF_RNG_XORSHIFT64] = WIDE_VALUES(xorshift64), [SF_RNG_XORSHIFT64_LRL] = WIDE_VALUES(xorshift64_lrl),
    [SF_RNG_COMBINED] = WIDE_VALUES(combined),     [SF_RNG_MT19937] = NARROW_VALUES(mt19937),
    [SF_RNG_MT19937_64] = WIDE_VALUES(mt19937_64), [SF_RNG_PCG32] = NARROW_VALUES(pcg32),
    [SF_RNG_PCG64DXSM] = WIDE_VALUES(pcg64dxsm),   [SF_RNG_XOSHIRO256PP] = WIDE_VALUES(xoshiro256pp),
    [SF_RNG_SFC64] = WIDE_VALUES(sfc64),           [SF_RNG_PHILOX4X32] = NARROW_VALUES(philox4x32),
    [SF_RNG_PHILOX4X64] = WIDE_VALUES(philox4x64), [SF_RNG_SPLITMIX64] = WIDE_VALUES(splitmix64),
};

static const sf_rng_callbacks *values_of(const sf_rng *rng) {
    assert((unsigned)rng->kind < SF_RNG_COUNT);
    return &values[rng->kind];
}

sf_rng_callbacks sf_rng_callbacks_of(sf_rng_kind kind) {
    assert((unsigned)kind < SF_RNG_COUNT);
    return values[kind];
}

uint64_t sf_rng_next_raw(sf_rng *rng) { return values_of(rng)->next_raw(rng); }
uint64_t sf_rng_next_full64(sf_rng *rng) { return values_of(rng)->next_full64(rng); }
uint32_t sf_rng_next_full32(sf_rng *rng) { return values_of(rng)->next_full32(rng); }
double sf_rng_next_f64(sf_rng *rng) { return values_of(rng)->next_f64(rng); }

uint32_t sf_rng_next_half(sf_rng *rng) { HALF(rng, sf_rng_next_raw(rng)); }

uint32_t sf_rng_next_u32(sf_rng *rng) {
    return sf_rng_method_of(rng)->native_bits == 64 ? sf_rng_next_half(rng) : (uint32_t)sf_rng_next_raw(rng);
}

uint64_t sf_rng_next_u64(sf_rng *rng) {
    uint64_t first = sf_rng_next_raw(rng);
    return sf_rng_method_of(rng)->native_bits == 64 ? first : sf_rng_next_raw(rng) << 32 | first;
}

float sf_rng_next_f32(sf_rng *rng) {
    if (sf_rng_method_of(rng)->native_bits != 31) return sf_float_from_bits(sf_rng_next_full32(rng));
    return sf_float_from_bits((uint32_t)sf_rng_next_raw(rng) << 1);
}
