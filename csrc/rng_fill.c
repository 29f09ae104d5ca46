// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Drawing from any generator: one value, and arrays. */
#include <assert.h>
#include <string.h>

#include "rng_methods.h"

/* Raw draws between drawing and converting. Few, so that the stores of one block to memory go on
 * while the next is drawn: with 2048 the two took turns, at 1.2 instead of 0.9 ns for sfc64. */
enum { BLOCK_WORDS = 512 };

/* Asking for the level costs as much as dozens of draws. */
static const sf_rng_kernels *kernels_for(size_t count) {
    return sf_rng_kernels_at(count < 64 ? SF_ISA_BASELINE : sf_isa_active());
}

/* Whether floats are not the top bits of draws: an LCG with a modulus of its own. */
static int is_scaled(const sf_rng *rng) {
    return (rng->kind == SF_RNG_LCG32 && rng->as.lcg32.modulus) || (rng->kind == SF_RNG_LCG64 && rng->as.lcg64.modulus);
}

/* ---- one value ---- */

uint64_t sf_rng_next_raw(sf_rng *rng) {
    switch (rng->kind) {
        case SF_RNG_MINSTD: return sf_minstd_next(&rng->as.minstd);
        case SF_RNG_LCG32: return sf_lcg32_next(&rng->as.lcg32);
        case SF_RNG_LCG64: return sf_lcg64_next(&rng->as.lcg64);
        case SF_RNG_RANDU: return sf_randu_next(&rng->as.randu);
        case SF_RNG_RAN1: return sf_ran1_next(&rng->as.ran1);
        case SF_RNG_RAN2: return sf_ran2_next(&rng->as.ran2);
        case SF_RNG_XORSHIFT64: return sf_xorshift64_next(&rng->as.xorshift64);
        case SF_RNG_XORSHIFT64_LRL: return sf_xorshift64_lrl_next(&rng->as.xorshift64);
        case SF_RNG_COMBINED: return sf_combined_next(&rng->as.combined);
        case SF_RNG_MT19937: return sf_mt19937_next(&rng->as.mt19937);
        case SF_RNG_MT19937_64: return sf_mt19937_64_next(&rng->as.mt19937_64);
        case SF_RNG_PCG32: return sf_pcg32_next(&rng->as.pcg32);
        case SF_RNG_PCG64DXSM: return sf_pcg64dxsm_next(&rng->as.pcg64dxsm);
        case SF_RNG_XOSHIRO256PP: return sf_xoshiro256pp_next(&rng->as.xoshiro256pp);
        case SF_RNG_SFC64: return sf_sfc64_next(&rng->as.sfc64);
        case SF_RNG_PHILOX4X32: return sf_philox4x32_next(&rng->as.philox4x32);
        case SF_RNG_PHILOX4X64: return sf_philox4x64_next(&rng->as.philox4x64);
        case SF_RNG_SPLITMIX64: return sf_splitmix64_next(&rng->as.splitmix64);
        case SF_RNG_COUNT: break;
    }
    assert(!"rng was initialized");
    return 0;
}

/* The next half of a 64-bit draw; the high one waits in the generator. */
static uint32_t next_half(sf_rng *rng) {
    uint32_t half = rng->pending;
    if (rng->has_pending) {
        rng->pending = 0;
        rng->has_pending = 0;
        return half;
    }
    uint64_t draw = sf_rng_next_raw(rng);
    rng->pending = (uint32_t)(draw >> 32);
    rng->has_pending = 1;
    return (uint32_t)draw;
}

uint32_t sf_rng_next_u32(sf_rng *rng) {
    return sf_rng_method_of(rng)->native_bits == 64 ? next_half(rng) : (uint32_t)sf_rng_next_raw(rng);
}

uint64_t sf_rng_next_u64(sf_rng *rng) {
    uint64_t first = sf_rng_next_raw(rng);
    return sf_rng_method_of(rng)->native_bits == 64 ? first : sf_rng_next_raw(rng) << 32 | first;
}

/* A draw as a fraction of 2^64, or of 2^32 for methods of up to 32 bits. */
static uint64_t next_fraction(sf_rng *rng) {
    const sf_rng_method *method = sf_rng_method_of(rng);
    uint64_t wide = sf_rng_next_raw(rng);
    if (method->native_bits == 64) {
        if (is_scaled(rng)) method->scale(rng, 1, &wide);
        return wide;
    }
    uint32_t narrow = (uint32_t)wide << (32 - method->native_bits);
    if (is_scaled(rng)) method->scale(rng, 1, &narrow);
    return narrow;
}

float sf_rng_next_f32(sf_rng *rng) {
    if (sf_rng_method_of(rng)->native_bits < 64) return sf_float_from_bits((uint32_t)next_fraction(rng));
    return sf_float_from_bits(is_scaled(rng) ? (uint32_t)(next_fraction(rng) >> 32) : next_half(rng));
}

double sf_rng_next_f64(sf_rng *rng) {
    uint64_t first = next_fraction(rng);
    if (sf_rng_method_of(rng)->native_bits == 64) return sf_double_from_bits(first);
    return (double)(int64_t)(first >> 5) * 0x1p-27 + (double)(int64_t)(next_fraction(rng) >> 6) * 0x1p-53;
}

uint32_t sf_rng_next_full32(sf_rng *rng) {
    unsigned bits = sf_rng_method_of(rng)->native_bits;
    if (bits == 64) return is_scaled(rng) ? (uint32_t)(next_fraction(rng) >> 32) : next_half(rng);
    uint32_t first = (uint32_t)next_fraction(rng);
    return bits == 32 ? first : (first & 0xffff0000u) | (uint32_t)next_fraction(rng) >> 16;
}

uint64_t sf_rng_next_full64(sf_rng *rng) {
    if (sf_rng_method_of(rng)->native_bits == 64) return next_fraction(rng);
    uint64_t first = sf_rng_next_full32(rng);
    return first << 32 | sf_rng_next_full32(rng);
}

/* ---- arrays ---- */

/* The halves of 64-bit draws, low first; an odd one waits in the generator. */
static void draw_halves(sf_rng *rng, size_t count, uint32_t *out, const sf_rng_kernels *kernels) {
    uint64_t block[BLOCK_WORDS / 2];
    if (count && rng->has_pending) {
        *out++ = next_half(rng);
        --count;
    }
    while (count > 1) {
        size_t pairs = count / 2 < BLOCK_WORDS / 2 ? count / 2 : BLOCK_WORDS / 2;
        sf_rng_method_of(rng)->draw(rng, pairs, block, kernels);
        for (size_t i = 0; i < pairs; ++i) {
            out[2 * i] = (uint32_t)block[i];
            out[2 * i + 1] = (uint32_t)(block[i] >> 32);
        }
        out += 2 * pairs;
        count -= 2 * pairs;
    }
    if (count) *out = next_half(rng);
}

void sf_rng_fill_u32(sf_rng *rng, size_t count, uint32_t *out) {
    const sf_rng_method *method = sf_rng_method_of(rng);
    if (method->native_bits == 64)
        draw_halves(rng, count, out, kernels_for(count));
    else
        method->draw(rng, count, out, kernels_for(count));
}

void sf_rng_fill_u64(sf_rng *rng, size_t count, uint64_t *out) {
    const sf_rng_method *method = sf_rng_method_of(rng);
    const sf_rng_kernels *kernels = kernels_for(count);
    if (method->native_bits == 64) {
        method->draw(rng, count, out, kernels);
        return;
    }
    uint32_t block[BLOCK_WORDS];
    for (size_t n; count; count -= n, out += n) {
        n = count < BLOCK_WORDS / 2 ? count : BLOCK_WORDS / 2;
        method->draw(rng, 2 * n, block, kernels);
        for (size_t i = 0; i < n; ++i) out[i] = (uint64_t)block[2 * i + 1] << 32 | block[2 * i];
    }
}

/* `count` words of which floats take the top bits: draws of methods of up to 32 bits, halves of
 * 64-bit ones. */
static void draw_float_words(sf_rng *rng, size_t count, uint32_t *out, const sf_rng_kernels *kernels) {
    const sf_rng_method *method = sf_rng_method_of(rng);
    if (method->native_bits < 64) {
        method->draw(rng, count, out, kernels);
        if (is_scaled(rng)) method->scale(rng, count, out);
    } else if (is_scaled(rng)) {
        for (size_t i = 0; i < count; ++i) out[i] = (uint32_t)(next_fraction(rng) >> 32);
    } else {
        draw_halves(rng, count, out, kernels);
    }
}

void sf_rng_fill_f32(sf_rng *rng, size_t count, float *out) {
    const sf_rng_method *method = sf_rng_method_of(rng);
    const sf_rng_kernels *kernels = kernels_for(count);
    if (method->draw_floats && count > BLOCK_WORDS) {
        if (rng->has_pending) {
            *out++ = sf_float_from_bits(next_half(rng));
            --count;
        }
        method->draw_floats(rng, count / 2, SF_RNG_F32, out, kernels);
        out += count & ~(size_t)1;
        count &= 1;
    }
    uint32_t block[BLOCK_WORDS];
    for (size_t n; count; count -= n, out += n) {
        n = count < BLOCK_WORDS ? count : BLOCK_WORDS;
        draw_float_words(rng, n, block, kernels);
        kernels->f32_from_u32(n, method->native_bits == 31, block, out);
    }
}

static void fill_f64_wide(sf_rng *rng, size_t count, double *out, const sf_rng_kernels *kernels) {
    const sf_rng_method *method = sf_rng_method_of(rng);
    if (method->draw_floats) {
        method->draw_floats(rng, count, SF_RNG_F64, out, kernels);
        return;
    }
    uint64_t block[BLOCK_WORDS / 2];
    for (size_t n; count; count -= n, out += n) {
        n = count < BLOCK_WORDS / 2 ? count : BLOCK_WORDS / 2;
        method->draw(rng, n, block, kernels);
        if (is_scaled(rng)) method->scale(rng, n, block);
        kernels->f64_from_u64(n, block, out);
    }
}

void sf_rng_fill_f64(sf_rng *rng, size_t count, double *out) {
    const sf_rng_method *method = sf_rng_method_of(rng);
    const sf_rng_kernels *kernels = kernels_for(count);
    if (method->native_bits == 64) {
        fill_f64_wide(rng, count, out, kernels);
        return;
    }
    uint32_t block[BLOCK_WORDS];
    for (size_t n; count; count -= n, out += n) {
        n = count < BLOCK_WORDS / 2 ? count : BLOCK_WORDS / 2;
        draw_float_words(rng, 2 * n, block, kernels);
        kernels->f64_from_u32(n, method->native_bits == 31, block, out);
    }
}
