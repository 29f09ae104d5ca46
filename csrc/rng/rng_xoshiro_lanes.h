// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Long fills by xoshiro256++: eight generators side by side, each jumped to the start of an eighth
 * of a chunk, so that the output is the one sequence in its order. Only rng_kernels.c includes it. */
#ifndef SUNFLECK_RNG_XOSHIRO_LANES_H
#define SUNFLECK_RNG_XOSHIRO_LANES_H

#include <string.h>

#include "base/platform.h"
#include "rng/rng_kernels.h"
#include "rng/rng_lanes.h"

enum {
    XOSHIRO_LANES = 8,
    XOSHIRO_STEPS = 2048, /* of a lane in a chunk; the polynomials below depend on it */
    XOSHIRO_CHUNK = XOSHIRO_LANES * XOSHIRO_STEPS
};

/* t^(2048 k) for k = 1, 2, 4, 7, modulo the engine's characteristic polynomial (rng_linear.c). */
static const uint64_t xoshiro_jumps[4][4] = {
    {UINT64_C(0x876c2301125a85c0), UINT64_C(0x15fe822628b16f04), UINT64_C(0x3c8ca36ec9a74fa7),
     UINT64_C(0x51edef31819e01ff)},
    {UINT64_C(0xd7f4e8da7e228b85), UINT64_C(0xd638d47ec5bcf595), UINT64_C(0xaa6eb691cbf9ce10),
     UINT64_C(0x0f41cce3698fad39)},
    {UINT64_C(0x669da12373880674), UINT64_C(0xb1df898a4a6f1548), UINT64_C(0x32104b94fe2534d3),
     UINT64_C(0xda66e09e52b341d1)},
    {UINT64_C(0x2feb50ab077bac1a), UINT64_C(0xa9b302d307a6d345), UINT64_C(0x64dcf3fb942666ef),
     UINT64_C(0x3972a4b76a145204)},
};

/* Lane l of the eight, in as many registers as they take. */
enum { XOSHIRO_PARTS = XOSHIRO_LANES / SF_LANES64 };

typedef struct xoshiro_lanes {
    sf_lanes64 s[4][XOSHIRO_PARTS];
} xoshiro_lanes;

static inline void xoshiro_step(xoshiro_lanes *g, uint64_t out[XOSHIRO_LANES]) {
    for (int p = 0; p < XOSHIRO_PARTS; ++p) {
        sf_lanes64 s0 = g->s[0][p], s1 = g->s[1][p], s2 = g->s[2][p], s3 = g->s[3][p], sum = s0 + s3;
        sf_lanes64 result = (sum << 23 | sum >> 41) + s0;
        memcpy(out + SF_LANES64 * p, &result, sizeof result);
        s2 ^= s0;
        s3 ^= s1;
        g->s[1][p] = s1 ^ s2;
        g->s[0][p] = s0 ^ s3;
        g->s[2][p] = s2 ^ s1 << 17;
        g->s[3][p] = s3 << 45 | s3 >> 19;
    }
}

/* Advances all lanes by what the polynomial stands for (see sf_linear_skip). */
static void xoshiro_jump(xoshiro_lanes *g, const uint64_t polynomial[4]) {
    xoshiro_lanes walk = *g, sum;
    memset(&sum, 0, sizeof sum);
    uint64_t unused[XOSHIRO_LANES];
    for (int bit = 0; bit < 256; ++bit) {
        uint64_t take = -(polynomial[bit / 64] >> (bit % 64) & 1);
        for (int i = 0; i < 4; ++i)
            for (int p = 0; p < XOSHIRO_PARTS; ++p) sum.s[i][p] ^= walk.s[i][p] & take;
        xoshiro_step(&walk, unused);
    }
    *g = sum;
}

/* Lane l starts l eighths of a chunk from `g`: jump by 1, 2 and 4 eighths as the bits of l say. */
static void xoshiro_spread(const sf_xoshiro256pp *g, xoshiro_lanes *lanes) {
    uint64_t words[4][XOSHIRO_LANES], jumped_words[4][XOSHIRO_LANES];
    for (int i = 0; i < 4; ++i)
        for (int l = 0; l < XOSHIRO_LANES; ++l) words[i][l] = g->s[i];
    for (int k = 0; k < 3; ++k) {
        memcpy(lanes, words, sizeof words);
        xoshiro_jump(lanes, xoshiro_jumps[k]);
        memcpy(jumped_words, lanes, sizeof words);
        for (int i = 0; i < 4; ++i)
            for (int l = 0; l < XOSHIRO_LANES; ++l)
                if (l >> k & 1) words[i][l] = jumped_words[i][l];
    }
    memcpy(lanes, words, sizeof words);
}

/* `count` draws in the form asked for, 8 bytes each. */
static inline void xoshiro_store(const uint64_t *draws, int count, sf_rng_form form, unsigned char *out) {
    if (form == SF_RNG_U64) {
        memcpy(out, draws, 8 * (size_t)count);
    } else if (form == SF_RNG_F64) {
        for (int i = 0; i < count; ++i) {
            double x = to_double(draws[i]);
            memcpy(out + 8 * i, &x, 8);
        }
    } else {
        for (int i = 0; i < count; ++i) {
            float x[2] = {sf_float_from_bits((uint32_t)draws[i]), sf_float_from_bits((uint32_t)(draws[i] >> 32))};
            memcpy(out + 8 * i, x, 8);
        }
    }
}

static inline void xoshiro_fill_chunk(xoshiro_lanes *g, sf_rng_form form, unsigned char *out) {
    for (int at = 0; at < XOSHIRO_STEPS; at += 8) {
        uint64_t tile[8][XOSHIRO_LANES];
        for (int step = 0; step < 8; ++step) xoshiro_step(g, tile[step]);
        for (int l = 0; l < XOSHIRO_LANES; ++l) {
            uint64_t line[8];
            for (int step = 0; step < 8; ++step) line[step] = tile[step][l];
            xoshiro_store(line, 8, form, out + 8 * ((size_t)l * XOSHIRO_STEPS + (size_t)at));
        }
    }
}

/* Fills whole chunks, where there are enough to repay the jumps, and moves `g` past them; returns
 * the number of draws. */
static inline size_t xoshiro_fill_lanes(sf_xoshiro256pp *g, size_t count, sf_rng_form form, void *out) {
    size_t chunks = count / XOSHIRO_CHUNK;
    if (chunks < 2) return 0;
    xoshiro_lanes lanes;
    xoshiro_spread(g, &lanes);
    unsigned char *bytes = out;
    for (size_t chunk = 0; chunk < chunks; ++chunk) {
        if (chunk) xoshiro_jump(&lanes, xoshiro_jumps[3]);
        unsigned char *place = bytes + 8 * chunk * XOSHIRO_CHUNK;
        if (form == SF_RNG_U64)
            xoshiro_fill_chunk(&lanes, SF_RNG_U64, place);
        else if (form == SF_RNG_F64)
            xoshiro_fill_chunk(&lanes, SF_RNG_F64, place);
        else
            xoshiro_fill_chunk(&lanes, SF_RNG_F32, place);
    }
    uint64_t words[4][XOSHIRO_LANES];
    memcpy(words, &lanes, sizeof words);
    for (int i = 0; i < 4; ++i) g->s[i] = words[i][XOSHIRO_LANES - 1];
    return chunks * XOSHIRO_CHUNK;
}

#endif
