// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#ifndef SUNFLECK_POINTS_LATTICE_KERNELS_H
#define SUNFLECK_POINTS_LATTICE_KERNELS_H

#include "base/isa_dispatch.h"

typedef struct sf_lattice_kernels {
    /* Word d of row r: begins[d] + factors[r] * steps[d] modulo 2^64, row-major; the low halves
     * unless `low` is NULL. */
    void (*fill)(const uint64_t *factors, size_t rows, const uint64_t *begins, const uint64_t *steps, uint32_t dims,
                 uint32_t *high, uint32_t *low);
} sf_lattice_kernels;

SF_KERNELS(sf_lattice_kernels)

#endif
