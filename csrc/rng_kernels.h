// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#ifndef SUNFLECK_RNG_KERNELS_H
#define SUNFLECK_RNG_KERNELS_H

#include "level.h"
#include "sunfleck/rng.h"

/* Loops over arrays that vectorize: conversions of raw draws, and the draws of methods that
 * count, whose draw i depends on i alone. `shift` is 32 minus the bits of a native draw. */
typedef struct sf_rng_kernels {
    void (*f32_from_u32)(size_t count, unsigned shift, const uint32_t *words, float *out);
    void (*f64_from_u64)(size_t count, const uint64_t *words, double *out);
    /* Two words to a double: the top 27 bits of the first above the top 26 of the second. */
    void (*f64_from_u32)(size_t count, unsigned shift, const uint32_t *words, double *out);
    void (*splitmix64)(uint64_t state, size_t count, uint64_t *out);
} sf_rng_kernels;

SF_KERNELS(sf_rng_kernels)

#endif
