// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Moments of arrays: blocks of 256, merged pairwise in a fixed order. */

#include "sunfleck/estimate.h"

#include <float.h>

#include "base/platform.h"

#define BLOCK 256
#define LANES 8
#define SMALL_UNIT 0x1p-540 /* where sums overflow: a block's squares of the largest double fit */

/* The finite rows of a block, column by column. */
typedef struct block {
    size_t count;
    size_t nonfinite;
    SF_ALIGNED(double) column[3][BLOCK];
} block;

static int is_finite_row(const double *row, size_t width) {
    int finite = 1;
    for (size_t k = 0; k < width; ++k) finite &= fabs(row[k]) <= DBL_MAX;
    return finite;
}

/* Takes up to BLOCK rows of `width` values, float or double, from row `first` on. */
static void take_block(block *b, size_t first, size_t rows, size_t width, const float *f32, const double *f64) {
    b->count = b->nonfinite = 0;
    for (size_t i = first; i < first + rows; ++i) {
        double row[3] = {0.0, 0.0, 0.0};
        for (size_t k = 0; k < width; ++k) row[k] = f32 ? (double)f32[i * width + k] : f64[i * width + k];
        /* Write always, count only what is finite: no branch to mispredict. */
        for (size_t k = 0; k < width; ++k) b->column[k][b->count] = row[k];
        int finite = is_finite_row(row, width);
        b->count += (size_t)finite;
        b->nonfinite += (size_t)!finite;
    }
}

/* sum of (x_i - shift)^power, power 1 or 2, in LANES interleaved sums added pairwise. */
static double sum_shifted(const double *x, size_t n, double shift, int power) {
    double lane[LANES] = {0.0};
    size_t i = 0;
    for (; i + LANES <= n; i += LANES)
        for (int k = 0; k < LANES; ++k) {
            double d = x[i + k] - shift;
            lane[k] += power == 2 ? d * d : d;
        }
    for (int k = 0; i < n; ++i, ++k) {
        double d = x[i] - shift;
        lane[k] += power == 2 ? d * d : d;
    }
    return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}

/* Mean and sum of squares of one column by two passes, corrected for the rounding of the mean
 * (Chan, Golub & LeVeque 1983, eq. 1.7). Either is not finite where a sum overflows. */
static void two_passes(const double *x, size_t n, double *mean, double *m2) {
    double centre = sum_shifted(x, n, 0.0, 1) / (double)n;
    double rest = sum_shifted(x, n, centre, 1), square = sum_shifted(x, n, centre, 2) - rest * (rest / (double)n);
    *mean = centre + rest / (double)n;
    *m2 = square < 0.0 ? 0.0 : square;
}

/* The same, again in a smaller unit where a sum overflows. The mean lies among the samples; the sum
 * of squares becomes infinite if no double holds it. */
static void column_moments(const double *x, size_t n, double *mean, double *m2) {
    *mean = *m2 = 0.0;
    if (n == 0) return;
    two_passes(x, n, mean, m2);
    if (fabs(*mean) <= DBL_MAX && *m2 <= DBL_MAX) return;
    double small[BLOCK];
    for (size_t i = 0; i < n; ++i) small[i] = x[i] * SMALL_UNIT;
    two_passes(small, n, mean, m2);
    *mean = fmax(-DBL_MAX, fmin(*mean / SMALL_UNIT, DBL_MAX));
    *m2 = *m2 / SMALL_UNIT / SMALL_UNIT;
}

/* levels[k] holds 2^k blocks until its twin arrives. */
static void add_blocks(sf_block_moments *m, size_t count, size_t width, const float *f32, const double *f64) {
    block b;
    for (size_t first = 0; first < count; first += BLOCK, ++m->blocks) {
        sf_channel_moments one = {0};
        take_block(&b, first, count - first < BLOCK ? count - first : BLOCK, width, f32, f64);
        one.count = b.count;
        one.nonfinite = b.nonfinite;
        for (size_t k = 0; k < width; ++k) column_moments(b.column[k], b.count, &one.mean[k], &one.m2[k]);
        int level = 0;
        for (; m->blocks >> level & 1; ++level) {
            sf_channel_moments_merge(&m->levels[level], &one);
            one = m->levels[level];
        }
        m->levels[level] = one;
    }
}

static sf_channel_moments total_of(const sf_block_moments *m) {
    sf_channel_moments total = {0};
    for (int level = 0; level < SF_BLOCK_MOMENTS_LEVELS && m->blocks >> level; ++level)
        if (m->blocks >> level & 1) {
            sf_channel_moments sum = m->levels[level];
            sf_channel_moments_merge(&sum, &total);
            total = sum;
        }
    return total;
}

void sf_block_moments_begin(sf_block_moments *m) { m->blocks = 0; }
void sf_block_moments_add_f32(sf_block_moments *m, size_t count, const float *x) { add_blocks(m, count, 1, x, NULL); }
void sf_block_moments_add_f64(sf_block_moments *m, size_t count, const double *x) { add_blocks(m, count, 1, NULL, x); }
void sf_block_moments_add_rows_f32(sf_block_moments *m, size_t count, const float *x) {
    add_blocks(m, count, 3, x, NULL);
}
void sf_block_moments_add_rows_f64(sf_block_moments *m, size_t count, const double *x) {
    add_blocks(m, count, 3, NULL, x);
}

void sf_moments_merge_blocks(sf_moments *m, const sf_block_moments *blocks) {
    sf_channel_moments total = total_of(blocks);
    sf_moments other = sf_channel_moments_at(&total, 0);
    sf_moments_merge(m, &other);
}

/* The scalar sum of squares is the sum of the channels'. */
void sf_vector_moments_merge_blocks(sf_vector_moments *m, const sf_block_moments *blocks) {
    sf_channel_moments total = total_of(blocks);
    sf_vector_moments other = {0};
    other.count = total.count;
    other.nonfinite = total.nonfinite;
    for (int k = 0; k < 3; ++k) other.mean[k] = total.mean[k];
    other.m2 = (total.m2[0] + total.m2[1]) + total.m2[2];
    sf_vector_moments_merge(m, &other);
}

void sf_channel_moments_merge_blocks(sf_channel_moments *m, const sf_block_moments *blocks) {
    sf_channel_moments total = total_of(blocks);
    sf_channel_moments_merge(m, &total);
}

/* An array in one piece. */
#define ADD_ARRAY(kind, type, suffix, width)                                   \
    void sf_##kind##_add_##suffix(sf_##kind *m, size_t count, const type *x) { \
        sf_block_moments blocks;                                               \
        sf_block_moments_begin(&blocks);                                       \
        sf_block_moments_add_##width##suffix(&blocks, count, x);               \
        sf_##kind##_merge_blocks(m, &blocks);                                  \
    }

ADD_ARRAY(moments, float, f32, )
ADD_ARRAY(moments, double, f64, )
ADD_ARRAY(vector_moments, float, f32, rows_)
ADD_ARRAY(vector_moments, double, f64, rows_)
ADD_ARRAY(channel_moments, float, f32, rows_)
ADD_ARRAY(channel_moments, double, f64, rows_)

void sf_weighted_moments_add_f64(sf_weighted_moments *m, size_t count, const double *x, const double *weights) {
    for (size_t i = 0; i < count; ++i) sf_weighted_moments_add(m, x[i], weights[i]);
}

void sf_running_sums_add_f64(sf_running_sums *r, size_t count, const double *f) {
    for (size_t i = 0; i < count; ++i) sf_running_sums_add(r, f[i]);
}
void sf_running_sums_f32_add_f32(sf_running_sums_f32 *r, size_t count, const float *f) {
    for (size_t i = 0; i < count; ++i) sf_running_sums_f32_add(r, f[i]);
}

void sf_batch_means_add_f64(sf_batch_means *b, size_t count, const double *x) {
    for (size_t i = 0; i < count; ++i) sf_batch_means_add(b, x[i]);
}

double sf_moments_half_width(const sf_moments *m, double confidence) {
    if (m->count < 2) return (double)INFINITY;
    return sf_student_t_factor(confidence, (double)m->count - 1.0) * sf_moments_standard_error(m);
}
