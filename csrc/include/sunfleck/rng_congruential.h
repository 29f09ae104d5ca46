// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Generators that go from x to a x + c mod m: plain, shuffled, combined and permuted.
 *
 * Each struct is the whole state and is copied by assignment. A `next` cannot fail and is safe on
 * distinct objects; sf_rng_init (rng.h) seeds any of them and refuses a bad seed.
 */
#ifndef SUNFLECK_RNG_CONGRUENTIAL_H
#define SUNFLECK_RNG_CONGRUENTIAL_H

#include "sunfleck/base.h"

#ifdef __cplusplus
extern "C" {
#endif

#define SF_MINSTD_MODULUS UINT32_C(2147483647)
#define SF_LCG64_MULTIPLIER UINT64_C(6364136223846793005)
#define SF_LCG64_INCREMENT UINT64_C(1442695040888963407)
#define SF_PCG64_CHEAP_MULTIPLIER UINT64_C(0xda942042e4dd58b5)

/* Park & Miller 1988, "minimal standard": x = 16807 x mod 2^31 - 1. A draw is 1 .. 2^31 - 2, and
 * the period is 2^31 - 2: seconds of a render. State 0 is refused. */
typedef struct sf_minstd {
    uint32_t state; /* 1 .. 2^31 - 2 */
} sf_minstd;

static inline uint32_t sf_minstd_next(sf_minstd *g) {
    /* Reduce modulo 2^31 - 1 by adding the high part to the low, as 2^31 = 1 there. */
    uint64_t product = UINT64_C(16807) * g->state;
    uint32_t x = (uint32_t)(product & 0x7fffffffu) + (uint32_t)(product >> 31);
    return g->state = x >= 0x7fffffffu ? x - 0x7fffffffu : x;
}

/* a x + c mod m, all below m; m = 0 stands for 2^64. Constant time where there are 128-bit
 * integers, 64 steps elsewhere. */
static inline uint64_t sf_multiply_add_modulo64(uint64_t a, uint64_t x, uint64_t c, uint64_t m) {
    if (m == 0) return a * x + c;
#if defined(__SIZEOF_INT128__)
    __extension__ typedef unsigned __int128 wide;
    return (uint64_t)(((wide)a * x + c) % m);
#else
    for (uint64_t term = x; a; a >>= 1) {
        if (a & 1) c = c >= m - term ? c - (m - term) : c + term;
        term = term >= m - term ? term - (m - term) : term + term;
    }
    return c;
#endif
}

/* x = multiplier x + increment mod modulus, any below 2^32; a draw is x, in 0 .. modulus - 1. The
 * default is Knuth and Lewis's a = 1664525, c = 1013904223, m = 2^32: bit j then has period
 * 2^(j+1), and the points of any d draws in a row lie on few planes. */
typedef struct sf_lcg32 {
    uint32_t state, multiplier, increment;
    uint32_t modulus; /* 0 = 2^32 */
} sf_lcg32;

static inline uint32_t sf_lcg32_next(sf_lcg32 *g) {
    uint64_t x = (uint64_t)g->multiplier * g->state + g->increment;
    return g->state = g->modulus ? (uint32_t)(x % g->modulus) : (uint32_t)x;
}

/* The same below 2^64; the default is Knuth's MMIX: a = 6364136223846793005,
 * c = 1442695040888963407, m = 2^64. */
typedef struct sf_lcg64 {
    uint64_t state, multiplier, increment;
    uint64_t modulus; /* 0 = 2^64 */
} sf_lcg64;

static inline uint64_t sf_lcg64_next(sf_lcg64 *g) {
    return g->state = sf_multiply_add_modulo64(g->multiplier, g->state, g->increment, g->modulus);
}

/* RANDU (IBM 1968): x = 65539 x mod 2^31, x odd. Kept as the bad example: three draws in a row
 * satisfy x'' = 6 x' - 9 x, so that all triples lie on 15 planes. Period 2^29. */
typedef struct sf_randu {
    uint32_t state; /* odd, below 2^31 */
} sf_randu;

static inline uint32_t sf_randu_next(sf_randu *g) { return g->state = g->state * 65539u & 0x7fffffffu; }

/* "ran1" of Press et al. 1992: minstd, whose draws wait in a table of 32 and leave it in an order
 * that the draws themselves choose (Bays & Durham 1976), which breaks serial correlation.
 * A draw is 1 .. 2^31 - 2. */
typedef struct sf_ran1 {
    uint32_t state;     /* of minstd */
    uint32_t last;      /* the latest draw, whose top bits choose the next */
    uint32_t table[32]; /* all 1 .. 2^31 - 2 */
} sf_ran1;

static inline uint32_t sf_ran1_next(sf_ran1 *g) {
    sf_minstd engine = {g->state};
    uint32_t place = g->last >> 26; /* 2^31 / 32 = 2^26 */
    g->last = g->table[place];
    g->table[place] = g->state = sf_minstd_next(&engine);
    return g->last;
}

#define SF_RAN2_MODULUS_1 UINT32_C(2147483563)
#define SF_RAN2_MODULUS_2 UINT32_C(2147483399)

/* "ran2" of Press et al. 1992: L'Ecuyer 1988 subtracts a sequence x = 40692 x mod 2147483399 from
 * x = 40014 x mod 2147483563, which first passes through a table of 32 as above. Period about
 * 2.3e18; a draw is 1 .. 2147483562. */
typedef struct sf_ran2 {
    uint32_t first, second; /* 1 .. modulus - 1 */
    uint32_t last;          /* 1 .. 2147483562 */
    uint32_t table[32];     /* of the first sequence */
} sf_ran2;

static inline uint32_t sf_ran2_next(sf_ran2 *g) {
    g->first = (uint32_t)(UINT64_C(40014) * g->first % SF_RAN2_MODULUS_1);
    g->second = (uint32_t)(UINT64_C(40692) * g->second % SF_RAN2_MODULUS_2);
    uint32_t place = g->last / (1 + (SF_RAN2_MODULUS_1 - 1) / 32), waiting = g->table[place];
    g->table[place] = g->first;
    /* The difference modulo 2147483562, with representatives 1 .. 2147483562. */
    return g->last = waiting > g->second ? waiting - g->second : waiting + (SF_RAN2_MODULUS_1 - 1) - g->second;
}

/* O'Neill 2014, PCG-XSH-RR 64/32: period 2^64 in each of 2^63 streams. */
typedef struct sf_pcg32 {
    uint64_t state;
    uint64_t increment; /* odd: 2 stream + 1 */
} sf_pcg32;

/* Seeded as the reference's pcg32_srandom_r(seed, stream); the top bit of `stream` is lost. */
static inline sf_pcg32 sf_pcg32_seeded(uint64_t seed, uint64_t stream) {
    sf_pcg32 g;
    g.increment = stream << 1 | 1;
    g.state = (g.increment + seed) * SF_LCG64_MULTIPLIER + g.increment;
    return g;
}

static inline uint32_t sf_pcg32_next(sf_pcg32 *g) {
    uint64_t x = g->state;
    g->state = x * SF_LCG64_MULTIPLIER + g->increment;
    uint32_t folded = (uint32_t)((x >> 18 ^ x) >> 27), turn = (uint32_t)(x >> 59);
    return folded >> turn | folded << (-turn & 31);
}

/* O'Neill 2019, PCG64 DXSM with the 64-bit "cheap" multiplier, as NumPy's PCG64DXSM: period 2^128
 * in each of 2^127 streams, of which seeding by `stream` reaches 2^64. */
typedef struct sf_pcg64dxsm {
    uint64_t state_high, state_low;
    uint64_t increment_high, increment_low; /* odd: 2 stream + 1 */
} sf_pcg64dxsm;

static inline void sf_pcg64dxsm_step(sf_pcg64dxsm *g) {
    uint64_t m = SF_PCG64_CHEAP_MULTIPLIER;
    uint64_t high = g->state_high * m + sf_multiply_high64(g->state_low, m);
    g->state_low = g->state_low * m + g->increment_low;
    g->state_high = high + g->increment_high + (g->state_low < g->increment_low);
}

/* Seeded as the reference's cm_setseq_dxsm_128_64(seed, stream). */
static inline sf_pcg64dxsm sf_pcg64dxsm_seeded(uint64_t seed, uint64_t stream) {
    sf_pcg64dxsm g = {0, 0, stream >> 63, stream << 1 | 1};
    g.state_low = g.increment_low + seed;
    g.state_high = g.increment_high + (g.state_low < seed);
    sf_pcg64dxsm_step(&g);
    return g;
}

static inline uint64_t sf_pcg64dxsm_next(sf_pcg64dxsm *g) {
    uint64_t x = g->state_high;
    x = (x ^ x >> 32) * SF_PCG64_CHEAP_MULTIPLIER;
    x = (x ^ x >> 48) * (g->state_low | 1);
    sf_pcg64dxsm_step(g);
    return x;
}

#ifdef __cplusplus
}
#endif
#endif
