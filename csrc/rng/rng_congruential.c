// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The congruential methods behind sf_rng: how each is seeded, drawn, skipped and checked. */
#include <inttypes.h>

#include "base/error.h"
#include "base/wide.h"
#include "rng/rng_methods.h"

SF_RNG_DRAW(minstd, minstd, uint32_t)
SF_RNG_DRAW(randu, randu, uint32_t)
SF_RNG_DRAW(ran1, ran1, uint32_t)
SF_RNG_DRAW(ran2, ran2, uint32_t)
SF_RNG_DRAW(pcg32, pcg32, uint32_t)

/* A word of 1 .. modulus - 1 from a hash. */
static uint32_t residue(uint64_t hash, uint32_t modulus) { return 1 + (uint32_t)(hash % (modulus - 1)); }

static int is_residue(uint32_t x, uint32_t modulus) { return x >= 1 && x < modulus; }

/* ---- minstd ---- */

static sf_status seed_minstd(sf_rng *rng, uint64_t seed, sf_error *error) {
    if (seed < 1 || seed >= SF_MINSTD_MODULUS)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "seed is %" PRIu64 "; minstd takes 1 .. 2147483646 (state 0 would stay 0)", seed);
    rng->as.minstd.state = (uint32_t)seed;
    return SF_STATUS_OK;
}

static void seed_stream_minstd(sf_rng *rng, uint64_t seed, uint64_t stream) {
    rng->as.minstd.state = residue(sf_hash64(seed, stream), SF_MINSTD_MODULUS);
}

static void skip_minstd(sf_rng *rng, uint64_t count, const sf_rng_kernels *kernels) {
    (void)kernels;
    rng->as.minstd.state = (uint32_t)sf_lcg_skip(rng->as.minstd.state, 16807, 0, SF_MINSTD_MODULUS, count);
}

static const char *fault_minstd(const sf_rng *rng) {
    return is_residue(rng->as.minstd.state, SF_MINSTD_MODULUS) ? NULL : "minstd's state is 1 .. 2147483646";
}

const sf_rng_method sf_rng_minstd = {
    .name = "minstd",
    .description = "Park & Miller's minimal standard: x = 16807 x mod 2^31 - 1; 31 bits, short period",
    .native_bits = 31,
    .field_bits = 32,
    .field_count = 1,
    .seed = seed_minstd,
    .seed_stream = seed_stream_minstd,
    .draw = draw_minstd,
    .skip = skip_minstd,
    .fault = fault_minstd,
};

/* ---- randu ---- */

static sf_status seed_randu(sf_rng *rng, uint64_t seed, sf_error *error) {
    if (seed % 2 == 0 || seed >> 31)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "seed is %" PRIu64 "; randu takes odd numbers below 2147483648 (even ones have shorter cycles)",
                       seed);
    rng->as.randu.state = (uint32_t)seed;
    return SF_STATUS_OK;
}

static void seed_stream_randu(sf_rng *rng, uint64_t seed, uint64_t stream) {
    rng->as.randu.state = (uint32_t)(sf_hash64(seed, stream) >> 33) | 1;
}

static void skip_randu(sf_rng *rng, uint64_t count, const sf_rng_kernels *kernels) {
    (void)kernels;
    rng->as.randu.state = (uint32_t)sf_lcg_skip(rng->as.randu.state, 65539, 0, UINT64_C(1) << 31, count);
}

static const char *fault_randu(const sf_rng *rng) {
    uint32_t x = rng->as.randu.state;
    return x & 1 && x >> 31 == 0 ? NULL : "randu's state is odd and below 2^31";
}

const sf_rng_method sf_rng_randu = {
    .name = "randu",
    .description = "IBM's RANDU: x = 65539 x mod 2^31; all triples on 15 planes, kept as the bad example",
    .native_bits = 31,
    .field_bits = 32,
    .field_count = 1,
    .seed = seed_randu,
    .seed_stream = seed_stream_randu,
    .draw = draw_randu,
    .skip = skip_randu,
    .fault = fault_randu,
};

/* ---- ran1 ---- */

static void start_ran1(sf_ran1 *g, uint32_t seed) {
    /* Pass over eight draws, then fill the table from its end. */
    sf_minstd engine = {seed};
    for (int i = 0; i < 8; ++i) sf_minstd_next(&engine);
    for (int i = 31; i >= 0; --i) g->table[i] = sf_minstd_next(&engine);
    g->state = g->last = engine.state;
}

static sf_status seed_ran1(sf_rng *rng, uint64_t seed, sf_error *error) {
    if (seed < 1 || seed >= SF_MINSTD_MODULUS)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "seed is %" PRIu64 "; ran1 takes 1 .. 2147483646 (state 0 would stay 0)", seed);
    start_ran1(&rng->as.ran1, (uint32_t)seed);
    return SF_STATUS_OK;
}

static void seed_stream_ran1(sf_rng *rng, uint64_t seed, uint64_t stream) {
    start_ran1(&rng->as.ran1, residue(sf_hash64(seed, stream), SF_MINSTD_MODULUS));
}

static const char *fault_ran1(const sf_rng *rng) {
    const sf_ran1 *g = &rng->as.ran1;
    int good = is_residue(g->state, SF_MINSTD_MODULUS) && is_residue(g->last, SF_MINSTD_MODULUS);
    for (int i = 0; i < 32; ++i) good = good && is_residue(g->table[i], SF_MINSTD_MODULUS);
    return good ? NULL : "all words of ran1 are 1 .. 2147483646";
}

const sf_rng_method sf_rng_ran1 = {
    .name = "ran1",
    .description = "minstd through a Bays-Durham table of 32 (Numerical Recipes' ran1); 31 bits, short period",
    .native_bits = 31,
    .field_bits = 32,
    .field_count = 34,
    .seed = seed_ran1,
    .seed_stream = seed_stream_ran1,
    .draw = draw_ran1,
    .fault = fault_ran1,
};

/* ---- ran2 ---- */

static void start_ran2(sf_ran2 *g, uint32_t seed, uint32_t second) {
    g->first = seed;
    g->second = second;
    for (int i = 39; i >= 0; --i) {
        g->first = (uint32_t)(UINT64_C(40014) * g->first % SF_RAN2_MODULUS_1);
        if (i < 32) g->table[i] = g->first;
    }
    g->last = g->table[0];
}

static sf_status seed_ran2(sf_rng *rng, uint64_t seed, sf_error *error) {
    if (seed < 1 || seed >= SF_RAN2_MODULUS_2)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "seed is %" PRIu64 "; ran2 takes 1 .. 2147483398 (state 0 would stay 0)", seed);
    start_ran2(&rng->as.ran2, (uint32_t)seed, (uint32_t)seed);
    return SF_STATUS_OK;
}

static void seed_stream_ran2(sf_rng *rng, uint64_t seed, uint64_t stream) {
    uint64_t key = sf_hash64(seed, stream);
    start_ran2(&rng->as.ran2, residue(key, SF_RAN2_MODULUS_1), residue(sf_mix64(key), SF_RAN2_MODULUS_2));
}

static const char *fault_ran2(const sf_rng *rng) {
    const sf_ran2 *g = &rng->as.ran2;
    int good = is_residue(g->first, SF_RAN2_MODULUS_1) && is_residue(g->second, SF_RAN2_MODULUS_2) &&
               is_residue(g->last, SF_RAN2_MODULUS_1);
    for (int i = 0; i < 32; ++i) good = good && is_residue(g->table[i], SF_RAN2_MODULUS_1);
    return good ? NULL : "ran2's second word is 1 .. 2147483398, the others 1 .. 2147483562";
}

const sf_rng_method sf_rng_ran2 = {
    .name = "ran2",
    .description = "two congruential sequences subtracted, one through a table (L'Ecuyer; Numerical Recipes' ran2)",
    .native_bits = 31,
    .field_bits = 32,
    .field_count = 35,
    .seed = seed_ran2,
    .seed_stream = seed_stream_ran2,
    .draw = draw_ran2,
    .fault = fault_ran2,
};

/* ---- pcg32 ---- */

static sf_status seed_pcg32(sf_rng *rng, uint64_t seed, sf_error *error) {
    (void)error;
    rng->as.pcg32 = sf_pcg32_seeded(seed, 0);
    return SF_STATUS_OK;
}

/* Not the method's own increments from one starting point: the states of such streams differ by a sequence
 * that depends on the increments alone, so that nearby streams correlate when they are interleaved. State
 * and increment both come from the hash. */
static void seed_stream_pcg32(sf_rng *rng, uint64_t seed, uint64_t stream) {
    uint64_t key = sf_hash64(seed, stream);
    rng->as.pcg32 = sf_pcg32_seeded(sf_hash64(key, 0), sf_hash64(key, 1));
}

static void skip_pcg32(sf_rng *rng, uint64_t count, const sf_rng_kernels *kernels) {
    (void)kernels;
    sf_pcg32 *g = &rng->as.pcg32;
    g->state = sf_lcg_skip(g->state, SF_LCG64_MULTIPLIER, g->increment, 0, count);
}

static const char *fault_pcg32(const sf_rng *rng) {
    return rng->as.pcg32.increment & 1 ? NULL : "pcg32's increment is odd";
}

const sf_rng_method sf_rng_pcg32 = {
    .name = "pcg32",
    .description = "O'Neill's PCG-XSH-RR 64/32: small and fast",
    .native_bits = 32,
    .field_bits = 64,
    .field_count = 2,
    .seed = seed_pcg32,
    .seed_stream = seed_stream_pcg32,
    .draw = draw_pcg32,
    .skip = skip_pcg32,
    .fault = fault_pcg32,
};

/* ---- pcg64dxsm ---- */

static sf_status seed_pcg64dxsm(sf_rng *rng, uint64_t seed, sf_error *error) {
    (void)error;
    rng->as.pcg64dxsm = sf_pcg64dxsm_seeded(seed, 0);
    return SF_STATUS_OK;
}

static void seed_stream_pcg64dxsm(sf_rng *rng, uint64_t seed, uint64_t stream) {
    rng->as.pcg64dxsm = sf_pcg64dxsm_seeded(seed, stream);
}

static void draw_pcg64dxsm(sf_rng *rng, size_t count, void *out, const sf_rng_kernels *kernels) {
    kernels->pcg64dxsm(&rng->as.pcg64dxsm, count, out);
}

static void skip_pcg64dxsm(sf_rng *rng, uint64_t count, const sf_rng_kernels *kernels) {
    (void)kernels;
    /* Brown's composition as in sf_lcg_skip, in 128 bits. */
    sf_pcg64dxsm *g = &rng->as.pcg64dxsm;
    sf_wide x = {g->state_high, g->state_low}, c = {g->increment_high, g->increment_low};
    sf_wide a = {0, SF_PCG64_CHEAP_MULTIPLIER}, total_a = {0, 1}, total_c = {0, 0};
    for (; count; count >>= 1) {
        if (count & 1) {
            total_a = sf_wide_multiply(total_a, a);
            total_c = sf_wide_add(sf_wide_multiply(total_c, a), c);
        }
        c = sf_wide_add(sf_wide_multiply(c, a), c);
        a = sf_wide_multiply(a, a);
    }
    x = sf_wide_add(sf_wide_multiply(x, total_a), total_c);
    g->state_high = x.high;
    g->state_low = x.low;
}

static const char *fault_pcg64dxsm(const sf_rng *rng) {
    return rng->as.pcg64dxsm.increment_low & 1 ? NULL : "pcg64dxsm's increment is odd";
}

const sf_rng_method sf_rng_pcg64dxsm = {
    .name = "pcg64dxsm",
    .description = "O'Neill's PCG64 DXSM, as in NumPy: 64 bits, period 2^128, with 2^127 streams",
    .native_bits = 64,
    .field_bits = 64,
    .field_count = 4,
    .seed = seed_pcg64dxsm,
    .seed_stream = seed_stream_pcg64dxsm,
    .draw = draw_pcg64dxsm,
    .skip = skip_pcg64dxsm,
    .fault = fault_pcg64dxsm,
};
