// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The methods that are linear over bits behind sf_rng: how each is seeded, drawn, skipped and
 * checked. The Mersenne Twisters are in rng_twister.c. */
#include <inttypes.h>

#include "base/error.h"
#include "rng/rng_methods.h"

SF_RNG_DRAW(xorshift64, xorshift64, uint64_t)
SF_RNG_DRAW(xorshift64, xorshift64_lrl, uint64_t)
SF_RNG_DRAW(combined, combined, uint64_t)

/* ---- xorshift64, both orders ---- */

/* Both orders have one characteristic polynomial, as the maps are transposes up to similarity.
 * Found by Berlekamp & Massey's algorithm on one bit of the output. */
static const uint64_t xorshift64_polynomial[1] = {UINT64_C(0x223240da3e40dc9)};

static sf_status seed_xorshift64(sf_rng *rng, uint64_t seed, sf_error *error) {
    const char *name = rng->kind == SF_RNG_XORSHIFT64 ? sf_rng_xorshift64.name : sf_rng_xorshift64_lrl.name;
    if (seed == 0)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "seed is 0; %s takes 1 .. 2^64 - 1 (state 0 would stay 0)",
                       name);
    rng->as.xorshift64.state = seed;
    return SF_STATUS_OK;
}

static uint64_t nonzero(uint64_t word) { return word ? word : UINT64_C(0x9e3779b97f4a7c15); }

static void seed_stream_xorshift64(sf_rng *rng, uint64_t seed, uint64_t stream) {
    rng->as.xorshift64.state = nonzero(sf_hash64(seed, stream));
}

static void step_xorshift64(uint64_t *state) {
    sf_xorshift64 g = {*state};
    *state = sf_xorshift64_next(&g);
}

static void step_xorshift64_lrl(uint64_t *state) {
    sf_xorshift64 g = {*state};
    *state = sf_xorshift64_lrl_next(&g);
}

static void skip_xorshift64(sf_rng *rng, uint64_t count, const sf_rng_kernels *kernels) {
    (void)kernels;
    sf_linear_skip(&rng->as.xorshift64.state, 1, xorshift64_polynomial, step_xorshift64, count);
}

static void skip_xorshift64_lrl(sf_rng *rng, uint64_t count, const sf_rng_kernels *kernels) {
    (void)kernels;
    sf_linear_skip(&rng->as.xorshift64.state, 1, xorshift64_polynomial, step_xorshift64_lrl, count);
}

static const char *fault_xorshift64(const sf_rng *rng) {
    return rng->as.xorshift64.state ? NULL : "a shift-XOR state is not 0";
}

const sf_rng_method sf_rng_xorshift64 = {
    .name = "xorshift64",
    .description = "Marsaglia's shift-XOR, 21-35-4 right-left-right; linear over bits",
    .native_bits = 64,
    .field_bits = 64,
    .field_count = 1,
    .seed = seed_xorshift64,
    .seed_stream = seed_stream_xorshift64,
    .draw = draw_xorshift64,
    .skip = skip_xorshift64,
    .fault = fault_xorshift64,
};

const sf_rng_method sf_rng_xorshift64_lrl = {
    .name = "xorshift64-lrl",
    .description = "Marsaglia's shift-XOR, 21-35-4 left-right-left; linear over bits",
    .native_bits = 64,
    .field_bits = 64,
    .field_count = 1,
    .seed = seed_xorshift64,
    .seed_stream = seed_stream_xorshift64,
    .draw = draw_xorshift64_lrl,
    .skip = skip_xorshift64_lrl,
    .fault = fault_xorshift64,
};

/* ---- combined ---- */

static sf_status seed_combined(sf_rng *rng, uint64_t seed, sf_error *error) {
    (void)error;
    sf_splitmix64 seeder = {seed};
    rng->as.combined.lcg = sf_splitmix64_next(&seeder);
    rng->as.combined.xorshift = nonzero(sf_splitmix64_next(&seeder));
    return SF_STATUS_OK;
}

static void seed_stream_combined(sf_rng *rng, uint64_t seed, uint64_t stream) {
    seed_combined(rng, sf_hash64(seed, stream), NULL);
}

static void skip_combined(sf_rng *rng, uint64_t count, const sf_rng_kernels *kernels) {
    (void)kernels;
    rng->as.combined.lcg = sf_lcg_skip(rng->as.combined.lcg, SF_LCG64_MULTIPLIER, SF_LCG64_INCREMENT, 0, count);
    sf_linear_skip(&rng->as.combined.xorshift, 1, xorshift64_polynomial, step_xorshift64, count);
}

static const char *fault_combined(const sf_rng *rng) {
    return rng->as.combined.xorshift ? NULL : "a shift-XOR state is not 0";
}

const sf_rng_method sf_rng_combined = {
    .name = "combined",
    .description = "a linear congruential XORed with a shift-XOR generator, 64 bits",
    .native_bits = 64,
    .field_bits = 64,
    .field_count = 2,
    .seed = seed_combined,
    .seed_stream = seed_stream_combined,
    .draw = draw_combined,
    .skip = skip_combined,
    .fault = fault_combined,
};

/* ---- xoshiro256++ ---- */

/* Of the linear engine; by Berlekamp & Massey's algorithm. t^(2^128) modulo it is the JUMP
 * constant that the authors publish. */
static const uint64_t xoshiro256_polynomial[4] = {UINT64_C(0x9d116f2bb0f0f001), UINT64_C(0x280002bcefd1a5e),
                                                  UINT64_C(0x4b4edcf26259f85), UINT64_C(0x3c03c3f3ecb19)};

static sf_status seed_xoshiro256pp(sf_rng *rng, uint64_t seed, sf_error *error) {
    /* Four draws in a row of SplitMix64 are distinct, so that they are never all 0. */
    (void)error;
    sf_splitmix64 seeder = {seed};
    for (int i = 0; i < 4; ++i) rng->as.xoshiro256pp.s[i] = sf_splitmix64_next(&seeder);
    return SF_STATUS_OK;
}

static void seed_stream_xoshiro256pp(sf_rng *rng, uint64_t seed, uint64_t stream) {
    seed_xoshiro256pp(rng, sf_hash64(seed, stream), NULL);
}

static void step_xoshiro256pp(uint64_t *state) {
    sf_xoshiro256pp g = {{state[0], state[1], state[2], state[3]}};
    sf_xoshiro256pp_next(&g);
    for (int i = 0; i < 4; ++i) state[i] = g.s[i];
}

static void draw_xoshiro256pp(sf_rng *rng, size_t count, void *out, const sf_rng_kernels *kernels) {
    kernels->xoshiro256pp(&rng->as.xoshiro256pp, count, SF_RNG_U64, out);
}

static void draw_floats_xoshiro256pp(sf_rng *rng, size_t draws, sf_rng_form form, void *out,
                                     const sf_rng_kernels *kernels) {
    kernels->xoshiro256pp(&rng->as.xoshiro256pp, draws, form, out);
}

static void skip_xoshiro256pp(sf_rng *rng, uint64_t count, const sf_rng_kernels *kernels) {
    (void)kernels;
    sf_linear_skip(rng->as.xoshiro256pp.s, 4, xoshiro256_polynomial, step_xoshiro256pp, count);
}

static const char *fault_xoshiro256pp(const sf_rng *rng) {
    const uint64_t *s = rng->as.xoshiro256pp.s;
    return s[0] | s[1] | s[2] | s[3] ? NULL : "a shift-XOR state is not 0";
}

const sf_rng_method sf_rng_xoshiro256pp = {
    .name = "xoshiro256++",
    .description = "Blackman & Vigna's xoshiro256++: 64 bits, period 2^256 - 1",
    .native_bits = 64,
    .field_bits = 64,
    .field_count = 4,
    .seed = seed_xoshiro256pp,
    .seed_stream = seed_stream_xoshiro256pp,
    .draw = draw_xoshiro256pp,
    .draw_floats = draw_floats_xoshiro256pp,
    .skip = skip_xoshiro256pp,
    .fault = fault_xoshiro256pp,
};
