// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Draws and converts arrays of random numbers in loops that vectorize. */
#include "rng/rng_kernels.h"

#include <string.h>

#include "base/platform.h"
#include "rng/rng_lanes.h"
#include "rng/rng_xoshiro_lanes.h"

/* ---- floats ---- */

static void f32_from_u32(size_t count, unsigned shift, const uint32_t *SF_RESTRICT words, float *SF_RESTRICT out) {
    for (size_t i = 0; i < count; ++i) out[i] = sf_float_from_bits(words[i] << shift);
}

static void f64_from_u64(size_t count, const uint64_t *SF_RESTRICT words, double *SF_RESTRICT out) {
    for (size_t i = 0; i < count; ++i) out[i] = to_double(words[i]);
}

static void f64_from_u32(size_t count, unsigned shift, const uint32_t *SF_RESTRICT words, double *SF_RESTRICT out) {
    /* Both parts and their sum are exact: 27 + 26 = 53 bits. */
#if defined(__AVX512DQ__) /* converts 64-bit integers: put the bits together first */
    for (size_t i = 0; i < count; ++i) {
        uint64_t pair;
        memcpy(&pair, words + 2 * i, 8);
        uint64_t high = (pair << shift & 0xffffffffu) >> 5, low = (pair >> 32 << shift & 0xffffffffu) >> 6;
        out[i] = (double)(int64_t)(high << 26 | low) * 0x1p-53;
    }
#else
    for (size_t i = 0; i < count; ++i) {
        int32_t high = (int32_t)(words[2 * i] << shift >> 5), low = (int32_t)(words[2 * i + 1] << shift >> 6);
        out[i] = (double)high * 0x1p-27 + (double)low * 0x1p-53;
    }
#endif
}

/* ---- splitmix64 ---- */

static void splitmix64(uint64_t state, size_t count, uint64_t *SF_RESTRICT out) {
    for (size_t i = 0; i < count; ++i) out[i] = sf_mix64(state + (i + 1) * UINT64_C(0x9e3779b97f4a7c15));
}

/* ---- Mersenne Twisters ---- */

static inline uint32_t twist32(uint32_t high, uint32_t low) {
    uint32_t x = (high & 0x80000000u) | (low & 0x7fffffffu);
    return x >> 1 ^ (SF_MT19937_TWIST & -(x & 1));
}

static void mt19937_refill(uint32_t *w) {
    /* Words depend on others 227 and 397 away, so that many are made side by side. */
    for (int i = 0; i < 227; ++i) w[i] = w[i + 397] ^ twist32(w[i], w[i + 1]);
    for (int i = 227; i < 623; ++i) w[i] = w[i - 227] ^ twist32(w[i], w[i + 1]);
    w[623] = w[396] ^ twist32(w[623], w[0]);
}

static void mt19937_temper(size_t count, const uint32_t *SF_RESTRICT words, uint32_t *SF_RESTRICT out) {
    for (size_t i = 0; i < count; ++i) {
        uint32_t x = words[i];
        x ^= x >> 11;
        x ^= (x << 7) & 0x9d2c5680u;
        x ^= (x << 15) & 0xefc60000u;
        out[i] = x ^ x >> 18;
    }
}

static inline uint64_t twist64(uint64_t high, uint64_t low) {
    uint64_t x = (high & ~UINT64_C(0x7fffffff)) | (low & 0x7fffffffu);
    return x >> 1 ^ (SF_MT19937_64_TWIST & -(x & 1));
}

static void mt19937_64_refill(uint64_t *w) {
    for (int i = 0; i < 156; ++i) w[i] = w[i + 156] ^ twist64(w[i], w[i + 1]);
    for (int i = 156; i < 311; ++i) w[i] = w[i - 156] ^ twist64(w[i], w[i + 1]);
    w[311] = w[155] ^ twist64(w[311], w[0]);
}

static void mt19937_64_temper(size_t count, const uint64_t *SF_RESTRICT words, uint64_t *SF_RESTRICT out) {
    for (size_t i = 0; i < count; ++i) {
        uint64_t x = words[i];
        x ^= (x >> 29) & UINT64_C(0x5555555555555555);
        x ^= (x << 17) & UINT64_C(0x71d67fffeda60000);
        x ^= (x << 37) & UINT64_C(0xfff7eee000000000);
        out[i] = x ^ x >> 43;
    }
}

/* ---- xoshiro256++ ---- */

static void xoshiro256pp(sf_xoshiro256pp *state, size_t count, sf_rng_form form, void *out) {
    unsigned char *bytes = out;
    size_t done = 0;
#if defined(__AVX2__) /* below, eight lanes are slower than one */
    done = xoshiro_fill_lanes(state, count, form, out);
#endif
    sf_xoshiro256pp g = *state;
    for (int n; done < count; done += (size_t)n) {
        uint64_t line[64];
        n = count - done < 64 ? (int)(count - done) : 64;
        for (int i = 0; i < n; ++i) line[i] = sf_xoshiro256pp_next(&g);
        xoshiro_store(line, n, form, bytes + 8 * done);
    }
    *state = g;
}

const sf_rng_kernels SF_AT_ISA(sf_rng_kernels) = {
    .f32_from_u32 = f32_from_u32,
    .f64_from_u64 = f64_from_u64,
    .f64_from_u32 = f64_from_u32,
    .splitmix64 = splitmix64,
    .mt19937_refill = mt19937_refill,
    .mt19937_temper = mt19937_temper,
    .mt19937_64_refill = mt19937_64_refill,
    .mt19937_64_temper = mt19937_64_temper,
    .philox4x32 = philox4x32,
    .philox4x64 = philox4x64,
    .pcg64dxsm = pcg64dxsm,
    .xoshiro256pp = xoshiro256pp,
};
