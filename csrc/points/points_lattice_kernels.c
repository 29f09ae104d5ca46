// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Fills rows of lattice points: multiples of a vector modulo 1, in 64 bits. */
#include "points/points_lattice_kernels.h"

#include "base/platform.h"

/* Long rows: a vector loop over the dimensions. */
static void fill_row(uint64_t factor, const uint64_t *SF_RESTRICT begins, const uint64_t *SF_RESTRICT steps,
                     uint32_t dims, uint32_t *SF_RESTRICT high) {
    for (uint32_t d = 0; d < dims; ++d) high[d] = (uint32_t)((begins[d] + factor * steps[d]) >> 32);
}

static void fill_row_both(uint64_t factor, const uint64_t *SF_RESTRICT begins, const uint64_t *SF_RESTRICT steps,
                          uint32_t dims, uint32_t *SF_RESTRICT high, uint32_t *SF_RESTRICT low) {
    for (uint32_t d = 0; d < dims; ++d) {
        uint64_t word = begins[d] + factor * steps[d];
        high[d] = (uint32_t)(word >> 32);
        low[d] = (uint32_t)word;
    }
}

/* Short rows: one over the rows. */
static void fill_column(const uint64_t *SF_RESTRICT factors, size_t rows, uint64_t begin, uint64_t step, uint32_t dims,
                        uint32_t *SF_RESTRICT high) {
    for (size_t r = 0; r < rows; ++r) high[r * dims] = (uint32_t)((begin + factors[r] * step) >> 32);
}

static void fill_column_both(const uint64_t *SF_RESTRICT factors, size_t rows, uint64_t begin, uint64_t step,
                             uint32_t dims, uint32_t *SF_RESTRICT high, uint32_t *SF_RESTRICT low) {
    for (size_t r = 0; r < rows; ++r) {
        uint64_t word = begin + factors[r] * step;
        high[r * dims] = (uint32_t)(word >> 32);
        low[r * dims] = (uint32_t)word;
    }
}

static void fill(const uint64_t *factors, size_t rows, const uint64_t *begins, const uint64_t *steps, uint32_t dims,
                 uint32_t *high, uint32_t *low) {
    enum { LONG_ROW = 8 };
    for (size_t r = 0; dims >= LONG_ROW && r < rows; ++r) {
        if (low)
            fill_row_both(factors[r], begins, steps, dims, high + r * dims, low + r * dims);
        else
            fill_row(factors[r], begins, steps, dims, high + r * dims);
    }
    for (uint32_t d = 0; dims < LONG_ROW && d < dims; ++d) {
        if (low)
            fill_column_both(factors, rows, begins[d], steps[d], dims, high + d, low + d);
        else
            fill_column(factors, rows, begins[d], steps[d], dims, high + d);
    }
}

const sf_lattice_kernels SF_AT_ISA(sf_lattice_kernels) = {fill};
