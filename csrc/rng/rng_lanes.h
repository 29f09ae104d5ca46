// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Generators that can be drawn several steps at once, a step to a lane of a register, because
 * their state n steps on is known at once: Philox counts, PCG is congruential. Only rng_kernels.c
 * includes it. */
#ifndef SUNFLECK_RNG_LANES_H
#define SUNFLECK_RNG_LANES_H

#include <string.h>

#include "base/platform.h"
#include "rng/rng_kernels.h"

/* sf_double_from_bits, in operations that every level has for lanes; below AVX-512 none converts
 * 64-bit integers. The halves of the 53 bits are put into the significands of 2^84 and 2^52, whose
 * sum less those powers is exact. */
static inline double to_double(uint64_t bits) {
#if defined(__AVX512DQ__)
    return sf_double_from_bits(bits);
#else
    uint64_t n = bits >> 11;
    union {
        uint64_t bits;
        double value;
    } high = {UINT64_C(0x4530000000000000) | n >> 32}, low = {UINT64_C(0x4330000000000000) | (n & 0xffffffffu)};
    return ((high.value - 0x1.00000001p84) + low.value) * 0x1p-53;
#endif
}

static inline sf_lanes64 all_lanes(uint64_t x) { return x - (sf_lanes64){0}; }

/* 0, 1, 2, … */
static inline sf_lanes64 lane_numbers(void) {
    uint64_t numbers[SF_LANES64];
    sf_lanes64 result;
    for (int l = 0; l < SF_LANES64; ++l) numbers[l] = (uint64_t)l;
    memcpy(&result, numbers, sizeof result);
    return result;
}

/* sf_multiply_high64_by_halves. */
static inline sf_lanes64 multiply_high(sf_lanes64 a, uint64_t b) {
    sf_lanes64 low = all_lanes(b & 0xffffffffu), high = all_lanes(b >> 32), a1 = a >> 32;
    sf_lanes64 middle = sf_lanes64_multiply32(a1, low) + (sf_lanes64_multiply32(a, low) >> 32);
    sf_lanes64 rest = sf_lanes64_multiply32(a, high) + (middle & 0xffffffffu);
    return sf_lanes64_multiply32(a1, high) + (middle >> 32) + (rest >> 32);
}

/* Registers of counters that go through Philox 4x32's rounds together: each round waits for products of
 * the one before, and a second register fills the wait. */
enum { PHILOX_SETS = 2, PHILOX_BLOCKS = PHILOX_SETS * SF_LANES64 };

/* ---- Philox 4x32 ---- */

/* Words of 32 bits live in lanes of 64, where products are; what is above them is never read. */
static inline void philox4x32_rounds(sf_lanes64 x[PHILOX_SETS][4], const uint32_t key[2]) {
    const sf_lanes64 a = all_lanes(0xd2511f53u), b = all_lanes(0xcd9e8d57u);
    uint32_t k0 = key[0], k1 = key[1];
    for (int round = 0; round < 10; ++round) {
        for (int s = 0; s < PHILOX_SETS; ++s) {
            sf_lanes64 p = sf_lanes64_multiply32(a, x[s][0]), q = sf_lanes64_multiply32(b, x[s][2]);
            x[s][0] = q >> 32 ^ x[s][1] ^ k0;
            x[s][2] = p >> 32 ^ x[s][3] ^ k1;
            x[s][1] = q;
            x[s][3] = p;
        }
        k0 += 0x9e3779b9u;
        k1 += 0xbb67ae85u;
    }
}

/* The blocks of one register, in order. */
static inline void philox4x32_store(const sf_lanes64 x[4], uint32_t *SF_RESTRICT out) {
    sf_lanes64 halves[2] = {(x[0] & 0xffffffffu) | x[1] << 32, (x[2] & 0xffffffffu) | x[3] << 32};
    sf_lanes64_interleave2(halves, out);
}

static void philox4x32(const uint32_t *counter, const uint32_t *key, size_t blocks, uint32_t *SF_RESTRICT out) {
    uint64_t first = (uint64_t)counter[1] << 32 | counter[0];
    size_t done = 0;
    for (; blocks - done >= PHILOX_BLOCKS; done += PHILOX_BLOCKS) {
        sf_lanes64 x[PHILOX_SETS][4];
        for (int s = 0; s < PHILOX_SETS; ++s) {
            sf_lanes64 n = all_lanes(first + done + (uint64_t)(s * SF_LANES64)) + lane_numbers();
            x[s][0] = n;
            x[s][1] = n >> 32;
            x[s][2] = all_lanes(counter[2]);
            x[s][3] = all_lanes(counter[3]);
        }
        philox4x32_rounds(x, key);
        for (int s = 0; s < PHILOX_SETS; ++s) philox4x32_store(x[s], out + 4 * (done + (size_t)(s * SF_LANES64)));
    }
    for (; done < blocks; ++done) {
        uint64_t n = first + done;
        const uint32_t now[4] = {(uint32_t)n, (uint32_t)(n >> 32), counter[2], counter[3]};
        sf_philox4x32_block(now, key, out + 4 * done);
    }
}

/* ---- Philox 4x64 ---- */

#if defined(__AVX512DQ__) /* with fewer lanes, four products to a product are no gain */
/* Measured with 1 to 3 registers and 2 to 8 beside: three and eight are quickest, and a group is
 * then 128 words, of which the blocks that become floats are multiples. */
enum { WIDE_SETS = 3, WIDE_BESIDE = 8, WIDE_GROUP = WIDE_SETS * SF_LANES64 + WIDE_BESIDE };

#define PHILOX_A UINT64_C(0xd2e7470ee14c6c93)
#define PHILOX_B UINT64_C(0xca5a826395121157)
#define PHILOX_STEP0 UINT64_C(0x9e3779b97f4a7c15)
#define PHILOX_STEP1 UINT64_C(0xbb67ae8584caa73b)

/* Blocks of one fill differ in the first word of the counter only, so that of the first two rounds'
 * four products two are the same in all of them. This is what two rounds XOR to the others, and the
 * last word that they leave. */
typedef struct philox4x64_opening {
    uint64_t second, first, third, last;
} philox4x64_opening;

static philox4x64_opening philox4x64_open(const uint64_t *counter, const uint64_t *key) {
    uint64_t x0 = sf_multiply_high64(PHILOX_B, counter[2]) ^ counter[1] ^ key[0];
    return (philox4x64_opening){.second = counter[3] ^ key[1],
                                .first = PHILOX_B * counter[2] ^ (key[0] + PHILOX_STEP0),
                                .third = sf_multiply_high64(PHILOX_A, x0) ^ (key[1] + PHILOX_STEP1),
                                .last = PHILOX_A * x0};
}

/* The first two rounds of blocks whose counters begin with n. */
static inline void philox4x64_begin_lanes(const philox4x64_opening *o, sf_lanes64 n, sf_lanes64 x[4]) {
    sf_lanes64 second = multiply_high(n, PHILOX_A) ^ o->second;
    x[0] = multiply_high(second, PHILOX_B) ^ o->first;
    x[1] = second * PHILOX_B;
    x[2] = n * PHILOX_A ^ o->third;
    x[3] = all_lanes(o->last);
}
static inline void philox4x64_begin(const philox4x64_opening *o, uint64_t n, uint64_t x[4]) {
    uint64_t second = sf_multiply_high64(PHILOX_A, n) ^ o->second;
    x[0] = sf_multiply_high64(PHILOX_B, second) ^ o->first;
    x[1] = second * PHILOX_B;
    x[2] = n * PHILOX_A ^ o->third;
    x[3] = o->last;
}

/* The other eight rounds of registers of blocks, and of a few blocks beside them in the core's own
 * multiplier, which lanes leave idle. */
static inline void philox4x64_rounds(sf_lanes64 x[WIDE_SETS][4], uint64_t beside[WIDE_BESIDE][4],
                                     const uint64_t key[2]) {
    uint64_t k0 = key[0] + 2 * PHILOX_STEP0, k1 = key[1] + 2 * PHILOX_STEP1;
    for (int round = 2; round < 10; ++round) {
        for (int s = 0; s < WIDE_SETS; ++s) {
            sf_lanes64 p = multiply_high(x[s][0], PHILOX_A), q = multiply_high(x[s][2], PHILOX_B);
            sf_lanes64 y1 = x[s][2] * PHILOX_B, y3 = x[s][0] * PHILOX_A;
            x[s][0] = q ^ x[s][1] ^ k0;
            x[s][2] = p ^ x[s][3] ^ k1;
            x[s][1] = y1;
            x[s][3] = y3;
        }
        for (int s = 0; s < WIDE_BESIDE; ++s) {
            uint64_t *y = beside[s], p = sf_multiply_high64(PHILOX_A, y[0]), q = sf_multiply_high64(PHILOX_B, y[2]);
            uint64_t y1 = PHILOX_B * y[2], y3 = PHILOX_A * y[0];
            y[0] = q ^ y[1] ^ k0;
            y[2] = p ^ y[3] ^ k1;
            y[1] = y1;
            y[3] = y3;
        }
        k0 += PHILOX_STEP0;
        k1 += PHILOX_STEP1;
    }
}

/* Whole groups of WIDE_GROUP; returns how many blocks they are. */
static size_t philox4x64_lanes(const uint64_t *counter, const uint64_t *key, size_t blocks, uint64_t *SF_RESTRICT out) {
    const philox4x64_opening opening = philox4x64_open(counter, key);
    size_t done = 0;
    for (; blocks - done >= WIDE_GROUP; done += WIDE_GROUP) {
        sf_lanes64 x[WIDE_SETS][4];
        uint64_t first = counter[0] + done, beside[WIDE_BESIDE][4];
        for (int s = 0; s < WIDE_SETS; ++s)
            philox4x64_begin_lanes(&opening, all_lanes(first + (uint64_t)(s * SF_LANES64)) + lane_numbers(), x[s]);
        for (int s = 0; s < WIDE_BESIDE; ++s)
            philox4x64_begin(&opening, first + WIDE_SETS * SF_LANES64 + (uint64_t)s, beside[s]);
        philox4x64_rounds(x, beside, key);
        for (int s = 0; s < WIDE_SETS; ++s) sf_lanes64_interleave4(x[s], out + 4 * (done + (size_t)(s * SF_LANES64)));
        memcpy(out + 4 * (done + WIDE_SETS * SF_LANES64), beside, sizeof beside);
    }
    return done;
}
#endif

static void philox4x64(const uint64_t *counter, const uint64_t *key, size_t blocks, uint64_t *SF_RESTRICT out) {
    size_t done = 0;
#if defined(__AVX512DQ__)
    done = philox4x64_lanes(counter, key, blocks, out);
#endif
    for (; done < blocks; ++done) {
        const uint64_t now[4] = {counter[0] + done, counter[1], counter[2], counter[3]};
        sf_philox4x64_block(now, key, out + 4 * done);
    }
}

/* ---- PCG64 DXSM ---- */

#if defined(__AVX512DQ__)
/* Draws a multiple of SF_LANES64: lane l starts l steps on, and each goes SF_LANES64 steps at once,
 * by the map x -> A x + C that they compose to (Brown 1994). */
static size_t pcg64dxsm_lanes(sf_pcg64dxsm *state, size_t count, uint64_t *SF_RESTRICT out) {
    sf_pcg64dxsm g = *state, a = {0, 1, 0, 0}, c = {0, 0, g.increment_high, g.increment_low};
    uint64_t starts[2][SF_LANES64];
    for (int l = 0; l < SF_LANES64; ++l) {
        starts[0][l] = g.state_high;
        starts[1][l] = g.state_low;
        sf_pcg64dxsm_step(&g);
        sf_pcg64dxsm_step(&a);
        sf_pcg64dxsm_step(&c);
    }
    sf_lanes64 high, low;
    memcpy(&high, starts[0], sizeof high);
    memcpy(&low, starts[1], sizeof low);
    size_t done = 0;
    for (; count - done >= SF_LANES64; done += SF_LANES64) {
        sf_lanes64 x = (high ^ high >> 32) * SF_PCG64_CHEAP_MULTIPLIER;
        x = (x ^ x >> 48) * (low | 1);
        memcpy(out + done, &x, sizeof x);
        high = high * a.state_low + low * a.state_high + multiply_high(low, a.state_low);
        low = low * a.state_low + c.state_low;
        high = high + c.state_high - (sf_lanes64)(low < c.state_low); /* true is all bits, -1 */
    }
    memcpy(starts[0], &high, sizeof high);
    memcpy(starts[1], &low, sizeof low);
    state->state_high = starts[0][0];
    state->state_low = starts[1][0];
    return done;
}
#endif

static void pcg64dxsm(sf_pcg64dxsm *state, size_t count, uint64_t *SF_RESTRICT out) {
    size_t done = 0;
#if defined(__AVX512DQ__)
    if (count >= 64) done = pcg64dxsm_lanes(state, count, out);
#endif
    sf_pcg64dxsm g = *state;
    for (; done < count; ++done) out[done] = sf_pcg64dxsm_next(&g);
    *state = g;
}

#endif
