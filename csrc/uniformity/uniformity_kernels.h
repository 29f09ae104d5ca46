// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#ifndef SUNFLECK_UNIFORMITY_KERNELS_H
#define SUNFLECK_UNIFORMITY_KERNELS_H

#include "base/isa_dispatch.h"
#include "sunfleck/uniformity.h"

/* Points as a column for each dimension: coordinate k of point i is values[k * stride + i]. */
typedef struct sf_columns {
    size_t count, stride;
    uint32_t dims;
    double *values;
} sf_columns;

enum { SF_UNIFORMITY_BLOCK = 256 }; /* the most points that a kernel is given at a time */

typedef struct sf_uniformity_kernels {
    /* The sum, over points begin .. begin + count - 1, of the product over the dimensions of the
     * kind's term for that point and point i. */
    double (*pair_sum[SF_DISCREPANCY_KIND_COUNT])(const sf_columns *points, size_t i, size_t begin, size_t count);
    /* The least squared distance between point i and points begin .. begin + count - 1: in the
     * cube [0], on the torus [1]. */
    double (*nearest[2])(const sf_columns *points, size_t i, size_t begin, size_t count);
    /* The greatest and the least of a[j] - scale * b[j], count >= 1, any count. */
    void (*extremes)(size_t count, const double *a, const double *b, double scale, double *greatest, double *least);
    /* cells[i] = cells[i] * radix + digits[i] / divisor: appends leading digits to a cell's number. */
    void (*append)(size_t count, const uint32_t *digits, uint32_t divisor, uint32_t radix, uint32_t *cells);
    /* The same with divisor and radix 2^shift and 2^bits. */
    void (*append_bits)(size_t count, const uint32_t *digits, unsigned shift, unsigned bits, uint32_t *cells);
} sf_uniformity_kernels;

SF_KERNELS(sf_uniformity_kernels)

#endif
