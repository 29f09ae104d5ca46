// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#ifndef SUNFLECK_RNG_KERNELS_H
#define SUNFLECK_RNG_KERNELS_H

#include "base/isa_dispatch.h"
#include "sunfleck/rng.h"

#define SF_MT19937_TWIST 0x9908b0dfu
#define SF_MT19937_64_TWIST UINT64_C(0xb5026f5aa96619e9)

/* What 64-bit draws are written as: themselves, doubles, or two floats each. */
typedef enum sf_rng_form { SF_RNG_U64, SF_RNG_F64, SF_RNG_F32 } sf_rng_form;

/* Loops over arrays that vectorize: conversions of raw draws, and draws of methods that can be
 * drawn side by side. `shift` is 32 minus the bits of a native draw. */
typedef struct sf_rng_kernels {
    void (*f32_from_u32)(size_t count, unsigned shift, const uint32_t *words, float *out);
    void (*f64_from_u64)(size_t count, const uint64_t *words, double *out);
    /* Two words to a double: the top 27 bits of the first above the top 26 of the second. */
    void (*f64_from_u32)(size_t count, unsigned shift, const uint32_t *words, double *out);
    void (*splitmix64)(uint64_t state, size_t count, uint64_t *out);
    /* The next generation in place, and the draws that words of it stand for. */
    void (*mt19937_refill)(uint32_t words[624]);
    void (*mt19937_temper)(size_t count, const uint32_t *words, uint32_t *out);
    void (*mt19937_64_refill)(uint64_t words[312]);
    void (*mt19937_64_temper)(size_t count, const uint64_t *words, uint64_t *out);
    /* `blocks` blocks of four from this counter on, whose low 64 bits do not overflow. */
    void (*philox4x32)(const uint32_t counter[4], const uint32_t key[2], size_t blocks, uint32_t *out);
    void (*philox4x64)(const uint64_t counter[4], const uint64_t key[2], size_t blocks, uint64_t *out);
    void (*pcg64dxsm)(sf_pcg64dxsm *g, size_t count, uint64_t *out);
    void (*xoshiro256pp)(sf_xoshiro256pp *g, size_t count, sf_rng_form form, void *out);
} sf_rng_kernels;

SF_KERNELS(sf_rng_kernels)

#endif
