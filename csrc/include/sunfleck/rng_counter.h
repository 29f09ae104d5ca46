// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Generators that count: the state is, or holds, a counter, so that no state is bad.
 *
 * Each struct is the whole state and is copied by assignment. A `next` cannot fail and is safe on
 * distinct objects; sf_rng_init (rng.h) seeds any of them.
 */
#ifndef SUNFLECK_RNG_COUNTER_H
#define SUNFLECK_RNG_COUNTER_H

#include "sunfleck/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Steele, Lea & Flood 2014, SplitMix64: a counter in steps of the golden ratio, mixed. Period
 * 2^64, each 64-bit word once. */
typedef struct sf_splitmix64 {
    uint64_t state;
} sf_splitmix64;

static inline uint64_t sf_splitmix64_next(sf_splitmix64 *g) {
    return sf_mix64(g->state += UINT64_C(0x9e3779b97f4a7c15));
}

/* Doty-Humphrey's sfc64 of PractRand: three chaotic words and a counter. Period at least 2^64,
 * 2^255 on average; there is no way to jump in it. */
typedef struct sf_sfc64 {
    uint64_t a, b, c, counter;
} sf_sfc64;

static inline uint64_t sf_sfc64_next(sf_sfc64 *g) {
    uint64_t result = g->a + g->b + g->counter++;
    g->a = g->b ^ g->b >> 11;
    g->b = g->c + (g->c << 3);
    g->c = (g->c << 24 | g->c >> 40) + result;
    return result;
}

/* Salmon et al. 2011, Philox 4x32-10: ten rounds of a keyed bijection of a 128-bit counter, whose
 * four words are drawn in order. Period 2^130 for each of 2^64 keys. */
typedef struct sf_philox4x32 {
    uint32_t counter[4]; /* of the block after the one in `block`, least word first */
    uint32_t key[2];
    uint32_t block[4];
    uint32_t used; /* 0 .. 4, the words drawn of `block` */
} sf_philox4x32;

/* The bijection alone, for keyed random access: four words for a counter. Stateless. */
static inline void sf_philox4x32_block(const uint32_t counter[4], const uint32_t key[2], uint32_t out[4]) {
    uint32_t x0 = counter[0], x1 = counter[1], x2 = counter[2], x3 = counter[3], k0 = key[0], k1 = key[1];
    for (int round = 0; round < 10; ++round) {
        uint64_t p = UINT64_C(0xd2511f53) * x0, q = UINT64_C(0xcd9e8d57) * x2;
        x0 = (uint32_t)(q >> 32) ^ x1 ^ k0;
        x2 = (uint32_t)(p >> 32) ^ x3 ^ k1;
        x1 = (uint32_t)q;
        x3 = (uint32_t)p;
        k0 += 0x9e3779b9u;
        k1 += 0xbb67ae85u;
    }
    out[0] = x0;
    out[1] = x1;
    out[2] = x2;
    out[3] = x3;
}

static inline uint32_t sf_philox4x32_next(sf_philox4x32 *g) {
    if (g->used >= 4) {
        sf_philox4x32_block(g->counter, g->key, g->block);
        for (int i = 0; i < 4 && ++g->counter[i] == 0; ++i) {
        }
        g->used = 0;
    }
    return g->block[g->used++];
}

/* Philox 4x64-10, the same in words of 64 bits: period 2^258 for each of 2^128 keys. */
typedef struct sf_philox4x64 {
    uint64_t counter[4]; /* of the block after the one in `block`, least word first */
    uint64_t key[2];
    uint64_t block[4];
    uint64_t used; /* 0 .. 4, the words drawn of `block` */
} sf_philox4x64;

static inline void sf_philox4x64_block(const uint64_t counter[4], const uint64_t key[2], uint64_t out[4]) {
    const uint64_t a = UINT64_C(0xd2e7470ee14c6c93), b = UINT64_C(0xca5a826395121157);
    uint64_t x0 = counter[0], x1 = counter[1], x2 = counter[2], x3 = counter[3], k0 = key[0], k1 = key[1];
    for (int round = 0; round < 10; ++round) {
        uint64_t p = sf_multiply_high64(a, x0), q = sf_multiply_high64(b, x2);
        uint64_t y1 = b * x2, y3 = a * x0;
        x0 = q ^ x1 ^ k0;
        x2 = p ^ x3 ^ k1;
        x1 = y1;
        x3 = y3;
        k0 += UINT64_C(0x9e3779b97f4a7c15);
        k1 += UINT64_C(0xbb67ae8584caa73b);
    }
    out[0] = x0;
    out[1] = x1;
    out[2] = x2;
    out[3] = x3;
}

static inline uint64_t sf_philox4x64_next(sf_philox4x64 *g) {
    if (g->used >= 4) {
        sf_philox4x64_block(g->counter, g->key, g->block);
        for (int i = 0; i < 4 && ++g->counter[i] == 0; ++i) {
        }
        g->used = 0;
    }
    return g->block[g->used++];
}

#ifdef __cplusplus
}
#endif
#endif
