// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The reference's pixel filters, as tables of their absolute values along an axis. */
#ifndef REFERENCE_FILTERS_H
#define REFERENCE_FILTERS_H

#include <math.h>
#include <stdint.h>

#define PI 3.14159265358979323846
#define FILTER_BINS 8192

enum { BOX, TENT, GAUSSIAN, GAUSSIAN_TRUNCATED, BLACKMAN_HARRIS, MITCHELL, LANCZOS };
static const double reach_of[] = {0.5, 1, 2.4, 1.5, 1.5, 2, 3};

static double sinc(double x) { return x == 0 ? 1 : sin(PI * x) / (PI * x); }
static double filter_at(int64_t filter, double x) {
    double d = fabs(x), p = 2 * PI * (x + 1.5) / 3;
    switch (filter) {
        case TENT: return 1 - d;
        case GAUSSIAN:
        case GAUSSIAN_TRUNCATED: return exp(-x * x / (2 * 0.4 * 0.4));
        case BLACKMAN_HARRIS: return 0.35875 - 0.48829 * cos(p) + 0.14128 * cos(2 * p) - 0.01168 * cos(3 * p);
        case MITCHELL: /* Mitchell & Netravali 1988, eq. 8, with B = C = 1/3 */
            return d < 1 ? (7 * d * d * d - 12 * d * d + 16.0 / 3) / 6
                         : (-7.0 / 3 * d * d * d + 12 * d * d - 20 * d + 32.0 / 3) / 6;
        case LANCZOS: return sinc(x) * sinc(x / 3);
        default: return 1;
    }
}
typedef struct filter_table {
    double sums[FILTER_BINS + 1], reach, ratio; /* ratio: integral of |f| over that of f */
    int64_t filter;
} filter_table;

static void tabulate(filter_table *t, int64_t filter) {
    double plain = 0;
    t->filter = filter;
    t->reach = reach_of[filter];
    t->sums[0] = 0;
    for (int i = 0; i < FILTER_BINS; ++i) {
        double f = filter_at(filter, ((i + 0.5) / FILTER_BINS * 2 - 1) * t->reach);
        t->sums[i + 1] = t->sums[i] + fabs(f);
        plain += f;
    }
    t->ratio = t->sums[FILTER_BINS] / plain;
}
/* An offset from the pixel's centre; multiplies the weight by the filter's sign and size. u, v in [0, 1). */
static double place(const filter_table *t, double u, double v, double *weight) {
    double wanted = u * t->sums[FILTER_BINS];
    int low = 0, high = FILTER_BINS;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (t->sums[middle] <= wanted)
            low = middle;
        else
            high = middle;
    }
    double x = ((low + v) / FILTER_BINS * 2 - 1) * t->reach;
    *weight *= filter_at(t->filter, x) < 0 ? -t->ratio : t->ratio;
    return x;
}

#endif
