// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#ifndef SUNFLECK_RNG_METHODS_H
#define SUNFLECK_RNG_METHODS_H

#include "rng/rng_kernels.h"
#include "sunfleck/rng.h"

/* What sf_rng knows of a method. The struct of every method is an array of fields of one width,
 * so that its state is read and written without knowing more. */
typedef struct sf_rng_method {
    const char *name, *description;
    unsigned native_bits;
    unsigned field_bits; /* 32 or 64 */
    unsigned field_count;
    /* Seeds with stream 0; refuses what the method cannot take. The constants of an LCG are set. */
    sf_status (*seed)(sf_rng *rng, uint64_t seed, sf_error *error);
    /* Seeds another stream from any seed. */
    void (*seed_stream)(sf_rng *rng, uint64_t seed, uint64_t stream);
    /* Raw draws into uint32_t (native_bits up to 32) or uint64_t. */
    void (*draw)(sf_rng *rng, size_t count, void *out, const sf_rng_kernels *kernels);
    /* Draws straight into floats, `form` being SF_RNG_F64 or SF_RNG_F32 (two floats a draw); NULL
     * where drawing and converting by blocks is as fast. 64-bit methods only. */
    void (*draw_floats)(sf_rng *rng, size_t draws, sf_rng_form form, void *out, const sf_rng_kernels *kernels);
    /* Makes raw draws below another modulus fractions of 2^32 or 2^64; NULL but for lcg32, lcg64. */
    void (*scale)(const sf_rng *rng, size_t count, void *words);
    /* NULL where there is no way but to draw. */
    void (*skip)(sf_rng *rng, uint64_t count, const sf_rng_kernels *kernels);
    /* What is wrong with the state, or NULL. */
    const char *(*fault)(const sf_rng *rng);
} sf_rng_method;

extern const sf_rng_method sf_rng_minstd, sf_rng_lcg32, sf_rng_lcg64, sf_rng_randu, sf_rng_ran1, sf_rng_ran2,
    sf_rng_xorshift64, sf_rng_xorshift64_lrl, sf_rng_combined, sf_rng_mt19937, sf_rng_mt19937_64, sf_rng_pcg32,
    sf_rng_pcg64dxsm, sf_rng_xoshiro256pp, sf_rng_sfc64, sf_rng_philox4x32, sf_rng_philox4x64, sf_rng_splitmix64;

const sf_rng_method *sf_rng_method_of(const sf_rng *rng);

/* Whether floats are not the top bits of draws: an LCG with a modulus of its own. */
int sf_rng_is_scaled(const sf_rng *rng);

/* The next half of a 64-bit draw, low first; the high one waits in the generator. */
uint32_t sf_rng_next_half(sf_rng *rng);

/* Defines draw_NEXT: a loop on a copy, which the compiler keeps in registers. */
#define SF_RNG_DRAW(member, next, T)                                                               \
    static void draw_##next(sf_rng *rng, size_t count, void *out, const sf_rng_kernels *kernels) { \
        (void)kernels;                                                                             \
        T *words = out;                                                                            \
        sf_##member g = rng->as.member;                                                            \
        for (size_t i = 0; i < count; ++i) words[i] = sf_##next##_next(&g);                        \
        rng->as.member = g;                                                                        \
    }

/* The affine map x -> a x + c mod m (0 = 2^64) done `count` times (Brown 1994, "Random Number
 * Generation with Arbitrary Strides"). */
uint64_t sf_lcg_skip(uint64_t x, uint64_t a, uint64_t c, uint64_t m, uint64_t count);

/* Advances a generator that is linear over bits, `words` words of state, by `count` steps. Its
 * characteristic polynomial has degree 64 * words, and `polynomial` holds the coefficients below
 * the leading one. */
void sf_linear_skip(uint64_t *state, unsigned words, const uint64_t *polynomial, void (*step)(uint64_t *state),
                    uint64_t count);

#endif
