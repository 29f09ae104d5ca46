// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Computes what measures of uniformity sum and compare, in loops over blocks of points that vectorize. */
#include "uniformity/uniformity_kernels.h"

#include <math.h>

#include "base/platform.h"

enum { LANES = 8 };

/* The terms of a pair of coordinates; see sf_discrepancy_kind for where they come from. */
static inline double centered_term(double a, double b) {
    return 1.0 + 0.5 * (fabs(a - 0.5) + fabs(b - 0.5) - fabs(a - b));
}
static inline double wraparound_term(double a, double b) {
    double d = fabs(a - b);
    return 1.5 - d * (1.0 - d);
}
static inline double mixture_term(double a, double b) {
    double d = fabs(a - b);
    return 1.875 - 0.25 * (fabs(a - 0.5) + fabs(b - 0.5)) - d * (0.75 - 0.5 * d);
}
static inline double l2_star_term(double a, double b) { return 1.0 - (a > b ? a : b); }

/* In LANES interleaved sums added pairwise, so that every level adds in one order. */
static double sum(const double *x, size_t n) {
    double lane[LANES] = {0.0};
    size_t i = 0;
    for (; i + LANES <= n; i += LANES)
        for (int k = 0; k < LANES; ++k) lane[k] += x[i + k];
    for (int k = 0; i < n; ++i, ++k) lane[k] += x[i];
    return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}

#define PAIR_SUM(kind)                                                                         \
    static double kind##_sum(const sf_columns *points, size_t i, size_t begin, size_t count) { \
        double product[SF_UNIFORMITY_BLOCK];                                                   \
        for (size_t j = 0; j < count; ++j) product[j] = 1.0;                                   \
        for (uint32_t k = 0; k < points->dims; ++k) {                                          \
            const double *SF_RESTRICT x = points->values + k * points->stride;                 \
            const double a = x[i];                                                             \
            for (size_t j = 0; j < count; ++j) product[j] *= kind##_term(a, x[begin + j]);     \
        }                                                                                      \
        return sum(product, count);                                                            \
    }

PAIR_SUM(centered)
PAIR_SUM(wraparound)
PAIR_SUM(mixture)
PAIR_SUM(l2_star)

static inline double gap(double a, double b) { return fabs(a - b); }
static inline double toroidal_gap(double a, double b) {
    double d = fabs(a - b), other = 1.0 - d;
    return d < other ? d : other;
}

#define NEAREST(name, gap)                                                                \
    static double name(const sf_columns *points, size_t i, size_t begin, size_t count) {  \
        double square[SF_UNIFORMITY_BLOCK], least = INFINITY;                             \
        for (size_t j = 0; j < count; ++j) square[j] = 0.0;                               \
        for (uint32_t k = 0; k < points->dims; ++k) {                                     \
            const double *SF_RESTRICT x = points->values + k * points->stride;            \
            const double a = x[i];                                                        \
            for (size_t j = 0; j < count; ++j) {                                          \
                double d = gap(a, x[begin + j]);                                          \
                square[j] += d * d;                                                       \
            }                                                                             \
        }                                                                                 \
        for (size_t j = 0; j < count; ++j) least = square[j] < least ? square[j] : least; \
        return least;                                                                     \
    }

NEAREST(nearest, gap)
NEAREST(nearest_toroidal, toroidal_gap)

static void extremes(size_t count, const double *SF_RESTRICT a, const double *SF_RESTRICT b, double scale,
                     double *greatest, double *least) {
    double high[LANES], low[LANES];
    for (int k = 0; k < LANES; ++k) high[k] = low[k] = a[0] - scale * b[0];
    size_t j = 0;
    for (; j + LANES <= count; j += LANES)
        for (int k = 0; k < LANES; ++k) {
            double value = a[j + k] - scale * b[j + k];
            high[k] = value > high[k] ? value : high[k];
            low[k] = value < low[k] ? value : low[k];
        }
    for (; j < count; ++j) {
        double value = a[j] - scale * b[j];
        high[0] = value > high[0] ? value : high[0];
        low[0] = value < low[0] ? value : low[0];
    }
    for (int k = 1; k < LANES; ++k) {
        high[0] = high[k] > high[0] ? high[k] : high[0];
        low[0] = low[k] < low[0] ? low[k] : low[0];
    }
    *greatest = high[0];
    *least = low[0];
}

static void append(size_t count, const uint32_t *SF_RESTRICT digits, uint32_t divisor, uint32_t radix,
                   uint32_t *SF_RESTRICT cells) {
    for (size_t i = 0; i < count; ++i) cells[i] = cells[i] * radix + digits[i] / divisor;
}

static void append_bits(size_t count, const uint32_t *SF_RESTRICT digits, unsigned shift, unsigned bits,
                        uint32_t *SF_RESTRICT cells) {
    for (size_t i = 0; i < count; ++i) cells[i] = cells[i] << bits | digits[i] >> shift;
}

const sf_uniformity_kernels SF_AT_ISA(sf_uniformity_kernels) = {
    {centered_sum, wraparound_sum, mixture_sum, l2_star_sum},
    {nearest, nearest_toroidal},
    extremes,
    append,
    append_bits,
};
