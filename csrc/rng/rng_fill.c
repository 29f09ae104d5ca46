// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Arrays of draws from any generator. */
#include <string.h>

#include "rng/rng_methods.h"

/* Raw draws between drawing and converting. Few, so that the stores of one block to memory go on
 * while the next is drawn: with 2048 the two took turns, at 1.2 instead of 0.9 ns for sfc64. */
enum { BLOCK_WORDS = 512 };

/* Asking for the level costs as much as dozens of draws. */
static const sf_rng_kernels *kernels_for(size_t count) {
    return sf_rng_kernels_at(count < 64 ? SF_ISA_BASELINE : sf_isa_active());
}

/* The halves of 64-bit draws, low first; an odd one waits in the generator. */
static void draw_halves(sf_rng *rng, size_t count, uint32_t *out, const sf_rng_kernels *kernels) {
    uint64_t block[BLOCK_WORDS / 2];
    if (count && rng->has_pending) {
        *out++ = sf_rng_next_half(rng);
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
    if (count) *out = sf_rng_next_half(rng);
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
        if (sf_rng_is_scaled(rng)) method->scale(rng, count, out);
    } else if (sf_rng_is_scaled(rng)) {
        for (size_t i = 0; i < count; ++i) out[i] = sf_rng_next_full32(rng);
    } else {
        draw_halves(rng, count, out, kernels);
    }
}

void sf_rng_fill_f32(sf_rng *rng, size_t count, float *out) {
    const sf_rng_method *method = sf_rng_method_of(rng);
    const sf_rng_kernels *kernels = kernels_for(count);
    if (method->draw_floats && count > BLOCK_WORDS) {
        if (rng->has_pending) {
            *out++ = sf_float_from_bits(sf_rng_next_half(rng));
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
        if (sf_rng_is_scaled(rng)) method->scale(rng, n, block);
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
