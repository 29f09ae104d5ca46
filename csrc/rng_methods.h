// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#ifndef SUNFLECK_RNG_METHODS_H
#define SUNFLECK_RNG_METHODS_H

#include "rng_kernels.h"
#include "sunfleck/rng.h"

/* What sf_rng knows of a method. The struct of every method is an array of fields of one width,
 * so that its state is read and written without knowing more. */
typedef struct sf_rng_method {
    const char *name, *description;
    unsigned native_bits;
    unsigned field_bits;  /* 32 or 64 */
    unsigned field_count;
    /* Seeds with stream 0; refuses what the method cannot take. */
    sf_status (*seed)(sf_rng *rng, uint64_t seed, sf_error *error);
    /* Seeds another stream from any seed. */
    void (*seed_stream)(sf_rng *rng, uint64_t seed, uint64_t stream);
    /* Raw draws into uint32_t (native_bits up to 32) or uint64_t. */
    void (*draw)(sf_rng *rng, size_t count, void *out, const sf_rng_kernels *kernels);
    /* NULL where there is no way but to draw. */
    void (*skip)(sf_rng *rng, uint64_t count);
    /* What is wrong with the state, or NULL. */
    const char *(*fault)(const sf_rng *rng);
} sf_rng_method;

extern const sf_rng_method sf_rng_methods[SF_RNG_COUNT];

/* The affine map x -> a x + c mod 2^64 done `count` times (Brown 1994, "Random Number Generation
 * with Arbitrary Strides"). */
uint64_t sf_lcg_skip(uint64_t x, uint64_t a, uint64_t c, uint64_t count);

/* Advances a generator that is linear over bits, `words` words of state, by `count` steps. Its
 * characteristic polynomial has degree 64 * words, and `polynomial` holds the coefficients below
 * the leading one. */
void sf_linear_skip(uint64_t *state, unsigned words, const uint64_t *polynomial, void (*step)(uint64_t *state),
                    uint64_t count);

#endif
