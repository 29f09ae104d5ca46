// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Converts the words of points to floats, and hashes the keys of their rows. */
#include "points/points_kernels.h"

#include "base/platform.h"

static void f32(size_t count, const uint32_t *SF_RESTRICT high, float *SF_RESTRICT out) {
    for (size_t i = 0; i < count; ++i) out[i] = sf_float_from_bits(high[i]);
}

static void f64(size_t count, const uint32_t *SF_RESTRICT high, const uint32_t *SF_RESTRICT low,
                double *SF_RESTRICT out) {
    for (size_t i = 0; i < count; ++i) out[i] = sf_double_from_words(high[i], low[i]);
}

static void row_keys(uint64_t seed, uint64_t first, size_t rows, uint64_t *SF_RESTRICT keys) {
    for (size_t i = 0; i < rows; ++i) keys[i] = sf_hash64(seed, first + i);
}

enum { RUN = 512 }; /* words whose 64-bit state is held at a time */

static void random_words(const uint64_t *SF_RESTRICT keys, size_t rows, uint32_t dims, uint32_t *SF_RESTRICT high,
                         uint32_t *SF_RESTRICT low) {
    uint64_t states[RUN];
    size_t count = rows * dims, row = 0;
    uint32_t dimension = 0;
    for (size_t begin = 0, n; begin < count; begin += n) {
        n = count - begin < RUN ? count - begin : RUN;
        for (size_t i = 0; i < n;) {
            size_t left = dims - dimension < n - i ? dims - dimension : n - i;
            for (size_t k = 0; k < left; ++k)
                states[i + k] = keys[row] + (dimension + k + 1) * UINT64_C(0x9e3779b97f4a7c15);
            i += left;
            dimension += (uint32_t)left;
            if (dimension == dims) {
                dimension = 0;
                ++row;
            }
        }
        for (size_t i = 0; i < n; ++i) states[i] = sf_mix64(states[i]);
        for (size_t i = 0; i < n; ++i) high[begin + i] = (uint32_t)(states[i] >> 32);
        for (size_t i = 0; low && i < n; ++i) low[begin + i] = (uint32_t)states[i];
    }
}

static void place(size_t rows, uint32_t dims, const uint32_t *sides, const uint32_t *cells, uint32_t *high,
                  uint32_t *low) {
    for (size_t row = 0, i = 0; row < rows; ++row)
        for (uint32_t d = 0; d < dims; ++d, ++i) {
            uint64_t random = (uint64_t)high[i] << 32 | low[i];
            uint64_t word = sf_place_in_cell(random, cells[i], sides[d]);
            high[i] = (uint32_t)(word >> 32);
            low[i] = (uint32_t)word;
        }
}

const sf_points_kernels SF_AT_ISA(sf_points_kernels) = {f32, f64, row_keys, random_words, place};
