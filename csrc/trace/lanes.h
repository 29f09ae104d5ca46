// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What kernels do with the lanes of a block: sums, and loops by how many there are. */
#ifndef SUNFLECK_LANES_H
#define SUNFLECK_LANES_H

#include "base/platform.h"
#include "film/block.h"

/* Calls f(width, ...), which is inlined, with the width of a batch's blocks as a constant: each has loops of its own.
 */
#define SF_AT_WIDTH(width, f, ...)                \
    switch (width) {                              \
        case 1: f(1, __VA_ARGS__); break;         \
        case 2: f(2, __VA_ARGS__); break;         \
        case 4: f(4, __VA_ARGS__); break;         \
        case 8: f(8, __VA_ARGS__); break;         \
        default: f(SF_LANES, __VA_ARGS__); break; \
    }

/* The sum of 16 numbers, halved in a fixed order that vectorizes. */
static inline double sf_sum16(const double x[SF_LANES]) {
    SF_ALIGNED(double) a[8];
    SF_ROLLED
    for (int l = 0; l < 8; ++l) a[l] = x[l] + x[l + 8];
    return ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]));
}

/* The sum of as many, a power of two of at most 16: that of 16 of which the others are 0. */
static inline double sf_sum_lanes(const double *x, uint32_t width) {
    switch (width) {
        case 1: return x[0];
        case 2: return x[0] + x[1];
        case 4: return (x[0] + x[2]) + (x[1] + x[3]);
        case 8: return ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]));
        default: return sf_sum16(x);
    }
}

#endif
