// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Generators that are linear over bits: shifts and XORs of the state. State 0 would stay 0 and is
 * refused; a test of the rank of binary matrices sees those whose output is the state itself.
 *
 * Each struct is the whole state and is copied by assignment. A `next` cannot fail and is safe on
 * distinct objects; sf_rng_init (rng.h) seeds any of them.
 */
#ifndef SUNFLECK_RNG_LINEAR_H
#define SUNFLECK_RNG_LINEAR_H

#include "sunfleck/rng_congruential.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Marsaglia 2003, "Xorshift RNGs", 64 bits, shifts 21-35-4: right, left, right. Period
 * 2^64 - 1. */
typedef struct sf_xorshift64 {
    uint64_t state; /* not 0 */
} sf_xorshift64;

static inline uint64_t sf_xorshift64_next(sf_xorshift64 *g) {
    uint64_t x = g->state;
    x ^= x >> 21;
    x ^= x << 35;
    x ^= x >> 4;
    return g->state = x;
}

/* The same in the order left, right, left. */
static inline uint64_t sf_xorshift64_lrl_next(sf_xorshift64 *g) {
    uint64_t x = g->state;
    x ^= x << 21;
    x ^= x >> 35;
    x ^= x << 4;
    return g->state = x;
}

/* A combined generator: the shift-XOR above, XORed with the linear congruential
 * x = 6364136223846793005 x + 1442695040888963407 mod 2^64 (Knuth's MMIX constants). The LCG's
 * low bits are weak and the shift-XOR is linear; neither shows through the other. Period
 * 2^64 (2^64 - 1). */
typedef struct sf_combined {
    uint64_t lcg;
    uint64_t xorshift; /* not 0 */
} sf_combined;

static inline uint64_t sf_combined_next(sf_combined *g) {
    sf_xorshift64 shifter = {g->xorshift};
    g->lcg = g->lcg * SF_LCG64_MULTIPLIER + SF_LCG64_INCREMENT;
    g->xorshift = sf_xorshift64_next(&shifter);
    return g->lcg ^ g->xorshift;
}

/* Blackman & Vigna 2019, xoshiro256++ 1.0: period 2^256 - 1; its output is not linear. */
typedef struct sf_xoshiro256pp {
    uint64_t s[4]; /* not all 0 */
} sf_xoshiro256pp;

static inline uint64_t sf_xoshiro256pp_next(sf_xoshiro256pp *g) {
    uint64_t sum = g->s[0] + g->s[3], result = (sum << 23 | sum >> 41) + g->s[0], t = g->s[1] << 17;
    g->s[2] ^= g->s[0];
    g->s[3] ^= g->s[1];
    g->s[1] ^= g->s[2];
    g->s[0] ^= g->s[3];
    g->s[2] ^= t;
    g->s[3] = g->s[3] << 45 | g->s[3] >> 19;
    return result;
}

/* Matsumoto & Nishimura 1998, MT19937: period 2^19937 - 1, 2.5 KB of state, drawn in generations
 * of 624 words. Laid out as the reference's mt[] and mti. */
typedef struct sf_mt19937 {
    uint32_t words[624]; /* the top bit of the first and all of the others: not all 0 */
    uint32_t used;       /* 0 .. 624, the words drawn of this generation */
} sf_mt19937;

/* Replaces the words by the next generation. */
SF_API void sf_mt19937_refill(sf_mt19937 *g);

static inline uint32_t sf_mt19937_next(sf_mt19937 *g) {
    if (g->used == 624) sf_mt19937_refill(g);
    uint32_t x = g->words[g->used++];
    x ^= x >> 11;
    x ^= x << 7 & 0x9d2c5680u;
    x ^= x << 15 & 0xefc60000u;
    return x ^ x >> 18;
}

/* Nishimura 2000, MT19937-64: the same period in 312 words of 64 bits. */
typedef struct sf_mt19937_64 {
    uint64_t words[312]; /* the top 33 bits of the first and all of the others: not all 0 */
    uint64_t used;       /* 0 .. 312 */
} sf_mt19937_64;

SF_API void sf_mt19937_64_refill(sf_mt19937_64 *g);

static inline uint64_t sf_mt19937_64_next(sf_mt19937_64 *g) {
    if (g->used == 312) sf_mt19937_64_refill(g);
    uint64_t x = g->words[g->used++];
    x ^= x >> 29 & UINT64_C(0x5555555555555555);
    x ^= x << 17 & UINT64_C(0x71d67fffeda60000);
    x ^= x << 37 & UINT64_C(0xfff7eee000000000);
    return x ^ x >> 43;
}

#ifdef __cplusplus
}
#endif
#endif
