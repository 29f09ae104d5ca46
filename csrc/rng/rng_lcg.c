// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The general linear congruential methods behind sf_rng, lcg32 and lcg64: which constants and
 * seeds are taken, and how draws below any modulus become floats. */
#include <inttypes.h>
#include <stdio.h>

#include "base/error.h"
#include "base/wide.h"
#include "rng/rng_lcg.h"
#include "rng/rng_methods.h"

SF_RNG_DRAW(lcg32, lcg32, uint32_t)
SF_RNG_DRAW(lcg64, lcg64, uint64_t)

static uint64_t common_factor(uint64_t a, uint64_t b) {
    while (b) {
        uint64_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

/* The greatest common factor of x > 0 with a modulus, 0 standing for 2^64. */
static uint64_t factor_with_modulus(uint64_t x, uint64_t modulus) {
    return modulus ? common_factor(x, modulus) : x & -x;
}

/* ---- constants ---- */

sf_lcg_parameters sf_lcg_parameters_default(sf_rng_kind kind) {
    if (kind == SF_RNG_LCG32) return (sf_lcg_parameters){1664525, 1013904223, UINT64_C(1) << 32};
    return (sf_lcg_parameters){SF_LCG64_MULTIPLIER, SF_LCG64_INCREMENT, 0};
}

static sf_status check_modulus(sf_rng_kind kind, uint64_t m, sf_error *error) {
    if (kind == SF_RNG_LCG32 && (m < 2 || m > UINT64_C(1) << 32))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "m is %" PRIu64 "; lcg32 takes a modulus of 2 .. 2^32", m);
    if (kind == SF_RNG_LCG64 && m && m <= UINT64_C(1) << 32)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "m is %" PRIu64 "; lcg64 takes a modulus of 2^32 + 1 .. 2^64, lcg32 smaller ones", m);
    return SF_STATUS_OK;
}

/* Constants of the whole range of words are checked with m = 0 standing for 2^64. */
static sf_status check_constants(uint64_t a, uint64_t c, uint64_t m, sf_error *error) {
    if (a < 1 || (m && a >= m))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "a is %" PRIu64 "; a multiplier is 1 .. m - 1 = %" PRIu64, a,
                       m - 1);
    if (m && c >= m)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "c is %" PRIu64 "; an increment is 0 .. m - 1 = %" PRIu64, c,
                       m - 1);
    uint64_t factor = factor_with_modulus(a, m);
    if (factor != 1)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "a is %" PRIu64 ", which shares the factor %" PRIu64
                       " with m: the sequence would run into fewer and fewer states; a and m must be coprime",
                       a, factor);
    if (a == 1 && c == 0)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "a is 1 and c is 0: the state would stay; give another a or c");
    return SF_STATUS_OK;
}

sf_status sf_lcg_set(sf_rng *rng, const sf_lcg_parameters *p, sf_error *error) {
    sf_status status = check_modulus(rng->kind, p->modulus, error);
    if (status == SF_STATUS_OK) status = check_constants(p->multiplier, p->increment, p->modulus, error);
    if (status != SF_STATUS_OK) return status;
    if (rng->kind == SF_RNG_LCG32) {
        rng->as.lcg32.multiplier = (uint32_t)p->multiplier;
        rng->as.lcg32.increment = (uint32_t)p->increment;
        rng->as.lcg32.modulus = (uint32_t)p->modulus;
    } else {
        rng->as.lcg64.multiplier = p->multiplier;
        rng->as.lcg64.increment = p->increment;
        rng->as.lcg64.modulus = p->modulus;
    }
    return SF_STATUS_OK;
}

sf_lcg_parameters sf_lcg_get(const sf_rng *rng) {
    if (rng->kind != SF_RNG_LCG32)
        return (sf_lcg_parameters){rng->as.lcg64.multiplier, rng->as.lcg64.increment, rng->as.lcg64.modulus};
    uint64_t m = rng->as.lcg32.modulus;
    return (sf_lcg_parameters){rng->as.lcg32.multiplier, rng->as.lcg32.increment, m ? m : UINT64_C(1) << 32};
}

/* ---- seeds ---- */

/* Why a state is not to be started from, or NULL. */
static const char *bad_state(uint64_t x, const sf_lcg_parameters *p) {
    if (p->modulus && x >= p->modulus) return "a state is below m";
    if (p->increment == 0 && (x == 0 || factor_with_modulus(x, p->modulus) != 1))
        return "with c = 0 it must share no factor with m, or the cycle is short";
    if (sf_multiply_add_modulo64(p->multiplier, x, p->increment, p->modulus) == x)
        return "it is a fixed point: the state would stay";
    return NULL;
}

static void set_state(sf_rng *rng, uint64_t x) {
    if (rng->kind == SF_RNG_LCG32)
        rng->as.lcg32.state = (uint32_t)x;
    else
        rng->as.lcg64.state = x;
}

static sf_status seed_lcg(sf_rng *rng, uint64_t seed, sf_error *error) {
    sf_lcg_parameters p = sf_lcg_get(rng);
    const char *reason = bad_state(seed, &p);
    if (reason) {
        char m[24] = "2^64";
        if (p.modulus) snprintf(m, sizeof m, "%" PRIu64, p.modulus);
        const char *name = rng->kind == SF_RNG_LCG32 ? sf_rng_lcg32.name : sf_rng_lcg64.name;
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "seed is %" PRIu64 "; %s with m = %s can't start from it: %s",
                       seed, name, m, reason);
    }
    set_state(rng, seed);
    return SF_STATUS_OK;
}

static void seed_stream_lcg(sf_rng *rng, uint64_t seed, uint64_t stream) {
    /* Start from the hash, and go up to the first good state. Bad ones lie apart: fixed points are
     * m / gcd(a - 1, m) from each other, and numbers coprime to m are never far. */
    sf_lcg_parameters p = sf_lcg_get(rng);
    uint64_t x = sf_hash64(seed, stream);
    if (p.modulus) x %= p.modulus;
    while (bad_state(x, &p)) x = x + 1 == p.modulus ? 0 : x + 1;
    set_state(rng, x);
}

/* ---- floats ---- */

static void scale_lcg32(const sf_rng *rng, size_t count, void *out) {
    uint64_t m = rng->as.lcg32.modulus;
    uint32_t *words = out;
    for (size_t i = 0; m && i < count; ++i) words[i] = (uint32_t)(((uint64_t)words[i] << 32) / m);
}

static void scale_lcg64(const sf_rng *rng, size_t count, void *out) {
    uint64_t m = rng->as.lcg64.modulus, *words = out;
    for (size_t i = 0; m && i < count; ++i) words[i] = sf_wide_divide((sf_wide){words[i], 0}, m);
}

/* ---- the rest ---- */

static void skip_lcg32(sf_rng *rng, uint64_t count, const sf_rng_kernels *kernels) {
    (void)kernels;
    sf_lcg_parameters p = sf_lcg_get(rng);
    sf_lcg32 *g = &rng->as.lcg32;
    g->state = (uint32_t)sf_lcg_skip(g->state, p.multiplier, p.increment, p.modulus, count);
}

static void skip_lcg64(sf_rng *rng, uint64_t count, const sf_rng_kernels *kernels) {
    (void)kernels;
    sf_lcg64 *g = &rng->as.lcg64;
    g->state = sf_lcg_skip(g->state, g->multiplier, g->increment, g->modulus, count);
}

static const char *fault_lcg(const sf_rng *rng) {
    sf_lcg_parameters p = sf_lcg_get(rng);
    if (check_modulus(rng->kind, p.modulus, NULL) != SF_STATUS_OK ||
        check_constants(p.multiplier, p.increment, p.modulus, NULL) != SF_STATUS_OK)
        return "its words are state, a, c and m (0 for 2^32 or 2^64), and these a, c and m are refused";
    return bad_state(rng->kind == SF_RNG_LCG32 ? rng->as.lcg32.state : rng->as.lcg64.state, &p);
}

const sf_rng_method sf_rng_lcg32 = {
    .name = "lcg32",
    .description = "x = a x + c mod m below 2^32, by default Knuth & Lewis's 1664525, 1013904223, 2^32; weak low bits",
    .native_bits = 32,
    .field_bits = 32,
    .field_count = 4,
    .seed = seed_lcg,
    .seed_stream = seed_stream_lcg,
    .draw = draw_lcg32,
    .scale = scale_lcg32,
    .skip = skip_lcg32,
    .fault = fault_lcg,
};

const sf_rng_method sf_rng_lcg64 = {
    .name = "lcg64",
    .description = "x = a x + c mod m below 2^64, by default Knuth's MMIX constants; weak low bits",
    .native_bits = 64,
    .field_bits = 64,
    .field_count = 4,
    .seed = seed_lcg,
    .seed_stream = seed_stream_lcg,
    .draw = draw_lcg64,
    .scale = scale_lcg64,
    .skip = skip_lcg64,
    .fault = fault_lcg,
};
