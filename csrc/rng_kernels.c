// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "rng_kernels.h"

#include "platform.h"

static void f32_from_u32(size_t count, unsigned shift, const uint32_t *SF_RESTRICT words, float *SF_RESTRICT out) {
    for (size_t i = 0; i < count; ++i) out[i] = sf_float_from_bits(words[i] << shift);
}

static void f64_from_u64(size_t count, const uint64_t *SF_RESTRICT words, double *SF_RESTRICT out) {
    for (size_t i = 0; i < count; ++i) out[i] = sf_double_from_bits(words[i]);
}

static void f64_from_u32(size_t count, unsigned shift, const uint32_t *SF_RESTRICT words, double *SF_RESTRICT out) {
    /* Both parts and their sum are exact: 27 + 26 = 53 bits. */
    for (size_t i = 0; i < count; ++i) {
        int32_t high = (int32_t)(words[2 * i] << shift >> 5), low = (int32_t)(words[2 * i + 1] << shift >> 6);
        out[i] = (double)high * 0x1p-27 + (double)low * 0x1p-53;
    }
}

static void splitmix64(uint64_t state, size_t count, uint64_t *SF_RESTRICT out) {
    for (size_t i = 0; i < count; ++i) out[i] = sf_mix64(state + (i + 1) * UINT64_C(0x9e3779b97f4a7c15));
}

const sf_rng_kernels SF_AT_LEVEL(sf_rng_kernels) = {f32_from_u32, f64_from_u64, f64_from_u32, splitmix64};
