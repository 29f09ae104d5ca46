// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The methods behind sf_rng: how each is seeded, drawn in bulk, skipped and checked. */
#include "rng_methods.h"

#include <inttypes.h>

#include "error.h"

#define MINSTD_MODULUS UINT32_C(0x7fffffff)
#define LCG64_MULTIPLIER UINT64_C(6364136223846793005)
#define LCG64_INCREMENT UINT64_C(1442695040888963407)
#define GOLDEN UINT64_C(0x9e3779b97f4a7c15)

/* Draws in a loop on a copy, which the compiler keeps in registers. */
#define DRAW(member, next, T)                                                                                      \
    static void draw_##next(sf_rng *rng, size_t count, void *out, const sf_rng_kernels *kernels) {               \
        (void)kernels;                                                                                             \
        T *words = out;                                                                                            \
        sf_##member g = rng->as.member;                                                                            \
        for (size_t i = 0; i < count; ++i) words[i] = sf_##next##_next(&g);                                       \
        rng->as.member = g;                                                                                        \
    }

DRAW(minstd, minstd, uint32_t)
DRAW(xorshift64, xorshift64, uint64_t)
DRAW(xorshift64, xorshift64_lrl, uint64_t)
DRAW(combined, combined, uint64_t)
DRAW(pcg32, pcg32, uint32_t)
DRAW(xoshiro256pp, xoshiro256pp, uint64_t)

/* ---- minstd ---- */

static sf_status seed_minstd(sf_rng *rng, uint64_t seed, sf_error *error) {
    if (seed < 1 || seed >= MINSTD_MODULUS)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "seed is %" PRIu64 "; minstd takes 1 .. 2147483646 (state 0 would stay 0)", seed);
    rng->as.minstd.state = (uint32_t)seed;
    return SF_STATUS_OK;
}

static void seed_stream_minstd(sf_rng *rng, uint64_t seed, uint64_t stream) {
    rng->as.minstd.state = 1 + (uint32_t)(sf_hash64(seed, stream) % (MINSTD_MODULUS - 1));
}

static void skip_minstd(sf_rng *rng, uint64_t count) {
    /* x <- x 16807^count: the multiplicative group has order 2^31 - 2. */
    uint64_t x = rng->as.minstd.state, a = 16807;
    for (; count; count >>= 1) {
        if (count & 1) x = x * a % MINSTD_MODULUS;
        a = a * a % MINSTD_MODULUS;
    }
    rng->as.minstd.state = (uint32_t)x;
}

static const char *fault_minstd(const sf_rng *rng) {
    uint32_t x = rng->as.minstd.state;
    return x >= 1 && x < MINSTD_MODULUS ? NULL : "minstd's state is 1 .. 2147483646";
}

/* ---- xorshift64, both orders ---- */

/* Both orders have one characteristic polynomial, as the maps are transposes up to similarity.
 * Found by Berlekamp & Massey's algorithm on one bit of the output. */
static const uint64_t xorshift64_polynomial[1] = {UINT64_C(0x223240da3e40dc9)};

static sf_status seed_xorshift64(sf_rng *rng, uint64_t seed, sf_error *error) {
    if (seed == 0)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "seed is 0; %s takes 1 .. 2^64 - 1 (state 0 would stay 0)",
                       sf_rng_name(rng->kind));
    rng->as.xorshift64.state = seed;
    return SF_STATUS_OK;
}

static uint64_t nonzero(uint64_t word) { return word ? word : GOLDEN; }

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

static void skip_xorshift64(sf_rng *rng, uint64_t count) {
    sf_linear_skip(&rng->as.xorshift64.state, 1, xorshift64_polynomial, step_xorshift64, count);
}

static void skip_xorshift64_lrl(sf_rng *rng, uint64_t count) {
    sf_linear_skip(&rng->as.xorshift64.state, 1, xorshift64_polynomial, step_xorshift64_lrl, count);
}

static const char *fault_xorshift64(const sf_rng *rng) {
    return rng->as.xorshift64.state ? NULL : "a shift-XOR state is not 0";
}

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

static void skip_combined(sf_rng *rng, uint64_t count) {
    rng->as.combined.lcg = sf_lcg_skip(rng->as.combined.lcg, LCG64_MULTIPLIER, LCG64_INCREMENT, count);
    sf_linear_skip(&rng->as.combined.xorshift, 1, xorshift64_polynomial, step_xorshift64, count);
}

static const char *fault_combined(const sf_rng *rng) {
    return rng->as.combined.xorshift ? NULL : "a shift-XOR state is not 0";
}

/* ---- pcg32 ---- */

static sf_status seed_pcg32(sf_rng *rng, uint64_t seed, sf_error *error) {
    (void)error;
    rng->as.pcg32 = sf_pcg32_seeded(seed, 0);
    return SF_STATUS_OK;
}

static void seed_stream_pcg32(sf_rng *rng, uint64_t seed, uint64_t stream) {
    rng->as.pcg32 = sf_pcg32_seeded(seed, stream);
}

static void skip_pcg32(sf_rng *rng, uint64_t count) {
    sf_pcg32 *g = &rng->as.pcg32;
    g->state = sf_lcg_skip(g->state, LCG64_MULTIPLIER, g->increment, count);
}

static const char *fault_pcg32(const sf_rng *rng) {
    return rng->as.pcg32.increment & 1 ? NULL : "pcg32's increment is odd";
}

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

static void skip_xoshiro256pp(sf_rng *rng, uint64_t count) {
    sf_linear_skip(rng->as.xoshiro256pp.s, 4, xoshiro256_polynomial, step_xoshiro256pp, count);
}

static const char *fault_xoshiro256pp(const sf_rng *rng) {
    const uint64_t *s = rng->as.xoshiro256pp.s;
    return s[0] | s[1] | s[2] | s[3] ? NULL : "a shift-XOR state is not 0";
}

/* ---- splitmix64 ---- */

static sf_status seed_splitmix64(sf_rng *rng, uint64_t seed, sf_error *error) {
    (void)error;
    rng->as.splitmix64.state = seed;
    return SF_STATUS_OK;
}

static void seed_stream_splitmix64(sf_rng *rng, uint64_t seed, uint64_t stream) {
    rng->as.splitmix64.state = sf_hash64(seed, stream);
}

static void draw_splitmix64(sf_rng *rng, size_t count, void *out, const sf_rng_kernels *kernels) {
    kernels->splitmix64(rng->as.splitmix64.state, count, out);
    rng->as.splitmix64.state += count * GOLDEN;
}

static void skip_splitmix64(sf_rng *rng, uint64_t count) { rng->as.splitmix64.state += count * GOLDEN; }

static const char *no_fault(const sf_rng *rng) {
    (void)rng;
    return NULL;
}

const sf_rng_method sf_rng_methods[SF_RNG_COUNT] = {
    [SF_RNG_MINSTD] = {"minstd", "Park & Miller's minimal standard: x = 16807 x mod 2^31 - 1; 31 bits, short period",
                       31, 32, 1, seed_minstd, seed_stream_minstd, draw_minstd, skip_minstd, fault_minstd},
    [SF_RNG_XORSHIFT64] = {"xorshift64", "Marsaglia's shift-XOR, 21-35-4 right-left-right; linear over bits",
                           64, 64, 1, seed_xorshift64, seed_stream_xorshift64, draw_xorshift64, skip_xorshift64,
                           fault_xorshift64},
    [SF_RNG_XORSHIFT64_LRL] = {"xorshift64-lrl", "Marsaglia's shift-XOR, 21-35-4 left-right-left; linear over bits",
                               64, 64, 1, seed_xorshift64, seed_stream_xorshift64, draw_xorshift64_lrl,
                               skip_xorshift64_lrl, fault_xorshift64},
    [SF_RNG_COMBINED] = {"combined", "a linear congruential XORed with a shift-XOR generator, 64 bits",
                         64, 64, 2, seed_combined, seed_stream_combined, draw_combined, skip_combined,
                         fault_combined},
    [SF_RNG_PCG32] = {"pcg32", "O'Neill's PCG-XSH-RR 64/32: small, fast, with 2^63 streams",
                      32, 64, 2, seed_pcg32, seed_stream_pcg32, draw_pcg32, skip_pcg32, fault_pcg32},
    [SF_RNG_XOSHIRO256PP] = {"xoshiro256++", "Blackman & Vigna's xoshiro256++: 64 bits, period 2^256 - 1",
                             64, 64, 4, seed_xoshiro256pp, seed_stream_xoshiro256pp, draw_xoshiro256pp,
                             skip_xoshiro256pp, fault_xoshiro256pp},
    [SF_RNG_SPLITMIX64] = {"splitmix64", "Steele, Lea & Flood's SplitMix64: a mixed counter, fills at the speed of memory",
                           64, 64, 1, seed_splitmix64, seed_stream_splitmix64, draw_splitmix64, skip_splitmix64,
                           no_fault},
};
