// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* estimate: running means and variances, standard errors, and the quantiles of intervals.
 *
 * Of N samples x_i with mean m, as the lecture defines them:
 *
 *     variance          (1/N) sum (x_i - m)^2              (the population's: 1/N)
 *     sample deviation  s = sqrt(1/(N-1) sum (x_i - m)^2)
 *     standard error    s / sqrt(N)
 *
 * Two ways to keep them. sf_running_sums is the lecture's (sum, sum of squares): one subtraction
 * of near-equal numbers at the end loses mean^2 / variance in relative precision, so that float
 * sums fail at mean / sigma of some 10^3 and double sums at some 10^8. It is kept because it is
 * the lecture's, as the one that fails. sf_moments (Welford 1962; merge by Chan, Golub & LeVeque
 * 1979) is the one to use.
 *
 * Samples that are not finite are counted in `nonfinite` and otherwise left out; a vector with
 * one component that is not finite is left out whole. With no sample, mean and variance are NaN;
 * with fewer than two, sample deviation and standard error are infinity: nothing is known.
 *
 * All states are plain structs, zeroed to begin ({0}), copied by assignment. Every function is
 * safe on distinct objects. Bulk calls give the same bits on every instruction-set level.
 */
#ifndef SUNFLECK_ESTIMATE_H
#define SUNFLECK_ESTIMATE_H

#include <math.h>

#include "sunfleck/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- scalar moments (Welford) ---- */

typedef struct sf_moments {
    uint64_t count;     /* of finite samples */
    double mean;
    double m2;          /* sum of squared deviations from the mean */
    uint64_t nonfinite; /* samples left out */
} sf_moments;

static inline void sf_moments_add(sf_moments *m, double x) {
    if (!isfinite(x)) {
        ++m->nonfinite;
        return;
    }
    double deviation = x - m->mean;
    m->mean += deviation / (double)++m->count;
    m->m2 += deviation * (x - m->mean);
}

/* Adds what `other` has seen, as if its samples had been added here (up to rounding). For equal
 * results merge in a fixed order. */
static inline void sf_moments_merge(sf_moments *m, const sf_moments *other) {
    m->nonfinite += other->nonfinite;
    if (other->count == 0) return;
    double a = (double)m->count, b = (double)other->count, share = b / (a + b);
    double difference = other->mean - m->mean;
    m->count += other->count;
    m->mean += difference * share;
    m->m2 += other->m2 + difference * difference * (a * share);
}

static inline double sf_moments_mean(const sf_moments *m) { return m->count ? m->mean : (double)NAN; }
static inline double sf_moments_variance(const sf_moments *m) { return m->count ? m->m2 / (double)m->count : (double)NAN; }
static inline double sf_moments_sample_deviation(const sf_moments *m) {
    return m->count > 1 ? sqrt(m->m2 / ((double)m->count - 1.0)) : (double)INFINITY;
}
static inline double sf_moments_standard_error(const sf_moments *m) {
    return m->count > 1 ? sqrt(m->m2 / ((double)m->count - 1.0) / (double)m->count) : (double)INFINITY;
}

/* Adds x[0 .. count - 1]: moments of aligned blocks of 256 are merged pairwise, then into `m`, so
 * that the error grows as log(count). Costs about one pass over the memory. */
void sf_moments_add_f32(sf_moments *m, size_t count, const float *x);
void sf_moments_add_f64(sf_moments *m, size_t count, const double *x);

/* ---- colours: a vector mean with one scalar sum of squares, the lecture's rule ---- */

/* Variance, deviation and error are the scalars of the distance |x - mean|. */
typedef struct sf_vector_moments {
    uint64_t count;
    double mean[3];
    double m2; /* sum of squared distances from the mean */
    uint64_t nonfinite;
} sf_vector_moments;

static inline void sf_vector_moments_add(sf_vector_moments *m, const double x[3]) {
    if (!(isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]))) {
        ++m->nonfinite;
        return;
    }
    double n = (double)++m->count;
    for (int k = 0; k < 3; ++k) {
        double deviation = x[k] - m->mean[k];
        m->mean[k] += deviation / n;
        m->m2 += deviation * (x[k] - m->mean[k]);
    }
}

static inline void sf_vector_moments_merge(sf_vector_moments *m, const sf_vector_moments *other) {
    m->nonfinite += other->nonfinite;
    if (other->count == 0) return;
    double a = (double)m->count, b = (double)other->count, share = b / (a + b), square = 0.0;
    m->count += other->count;
    for (int k = 0; k < 3; ++k) {
        double difference = other->mean[k] - m->mean[k];
        m->mean[k] += difference * share;
        square += difference * difference;
    }
    m->m2 += other->m2 + square * (a * share);
}

static inline double sf_vector_moments_variance(const sf_vector_moments *m) {
    return m->count ? m->m2 / (double)m->count : (double)NAN;
}
static inline double sf_vector_moments_sample_deviation(const sf_vector_moments *m) {
    return m->count > 1 ? sqrt(m->m2 / ((double)m->count - 1.0)) : (double)INFINITY;
}
static inline double sf_vector_moments_standard_error(const sf_vector_moments *m) {
    return m->count > 1 ? sqrt(m->m2 / ((double)m->count - 1.0) / (double)m->count) : (double)INFINITY;
}

/* Adds `count` rows of three, packed; as sf_moments_add_f32. */
void sf_vector_moments_add_f32(sf_vector_moments *m, size_t count, const float *x);
void sf_vector_moments_add_f64(sf_vector_moments *m, size_t count, const double *x);

/* ---- colours, each channel for itself ---- */

typedef struct sf_channel_moments {
    uint64_t count;
    double mean[3];
    double m2[3];
    uint64_t nonfinite;
} sf_channel_moments;

static inline void sf_channel_moments_add(sf_channel_moments *m, const double x[3]) {
    if (!(isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]))) {
        ++m->nonfinite;
        return;
    }
    double n = (double)++m->count;
    for (int k = 0; k < 3; ++k) {
        double deviation = x[k] - m->mean[k];
        m->mean[k] += deviation / n;
        m->m2[k] += deviation * (x[k] - m->mean[k]);
    }
}

static inline void sf_channel_moments_merge(sf_channel_moments *m, const sf_channel_moments *other) {
    m->nonfinite += other->nonfinite;
    if (other->count == 0) return;
    double a = (double)m->count, b = (double)other->count, share = b / (a + b);
    m->count += other->count;
    for (int k = 0; k < 3; ++k) {
        double difference = other->mean[k] - m->mean[k];
        m->mean[k] += difference * share;
        m->m2[k] += other->m2[k] + difference * difference * (a * share);
    }
}

/* One channel as scalar moments (nonfinite is that of the whole). */
static inline sf_moments sf_channel_moments_at(const sf_channel_moments *m, int channel) {
    sf_moments one;
    one.count = m->count;
    one.mean = m->mean[channel];
    one.m2 = m->m2[channel];
    one.nonfinite = m->nonfinite;
    return one;
}

/* Adds `count` rows of three, packed; as sf_moments_add_f32. */
void sf_channel_moments_add_f32(sf_channel_moments *m, size_t count, const float *x);
void sf_channel_moments_add_f64(sf_channel_moments *m, size_t count, const double *x);

/* ---- weighted moments (West 1979) ---- */

/* The weighted mean sum(w x) / sum(w), weights finite and >= 0; of weight 0 only the count is
 * kept. A sample or weight that is not finite, or a negative weight, counts as nonfinite. */
typedef struct sf_weighted_moments {
    uint64_t count;
    double weight;        /* sum of w */
    double weight_square; /* sum of w^2 */
    double mean;
    double m2; /* sum of w (x - mean)^2 */
    uint64_t nonfinite;
} sf_weighted_moments;

static inline void sf_weighted_moments_add(sf_weighted_moments *m, double x, double weight) {
    if (!isfinite(x) || !isfinite(weight) || weight < 0.0) {
        ++m->nonfinite;
        return;
    }
    ++m->count;
    if (weight == 0.0) return;
    double deviation = x - m->mean;
    m->weight += weight;
    m->weight_square += weight * weight;
    m->mean += deviation * (weight / m->weight);
    m->m2 += weight * (deviation * (x - m->mean));
}

static inline void sf_weighted_moments_merge(sf_weighted_moments *m, const sf_weighted_moments *other) {
    m->nonfinite += other->nonfinite;
    m->count += other->count;
    if (!(other->weight > 0.0)) return;
    double share = other->weight / (m->weight + other->weight), difference = other->mean - m->mean;
    m->m2 += other->m2 + difference * difference * (m->weight * share);
    m->mean += difference * share;
    m->weight += other->weight;
    m->weight_square += other->weight_square;
}

static inline double sf_weighted_moments_variance(const sf_weighted_moments *m) {
    return m->weight > 0.0 ? m->m2 / m->weight : (double)NAN;
}

/* sqrt(s^2 sum(w^2)) / sum(w), s^2 = m2 / (sum w - sum w^2 / sum w): for weights that do not
 * depend on the samples; s / sqrt(N) where all are equal. */
static inline double sf_weighted_moments_standard_error(const sf_weighted_moments *m) {
    double freedom = m->weight > 0.0 ? m->weight - m->weight_square / m->weight : 0.0;
    return m->count > 1 && freedom > 0.0 ? sqrt(m->m2 / freedom * m->weight_square) / m->weight : (double)INFINITY;
}

/* ---- the lecture's running sums ---- */

typedef struct sf_running_sums {
    uint64_t count;
    double m; /* sum of f */
    double s; /* sum of f^2 */
} sf_running_sums;

/* The same in float, as a renderer's inner loop would have them. */
typedef struct sf_running_sums_f32 {
    uint64_t count;
    float m, s;
} sf_running_sums_f32;

static inline void sf_running_sums_add(sf_running_sums *r, double f) {
    ++r->count;
    r->m += f;
    r->s += f * f;
}
static inline void sf_running_sums_f32_add(sf_running_sums_f32 *r, float f) {
    ++r->count;
    r->m += f;
    r->s += f * f;
}

/* s/N - mean^2, negative where the subtraction has lost it; the error is then NaN, as it would
 * be on the lecture's slide. Samples that are not finite spoil the sums for good. */
static inline double sf_running_sums_mean(const sf_running_sums *r) { return r->m / (double)r->count; }
static inline double sf_running_sums_variance(const sf_running_sums *r) {
    double mean = r->m / (double)r->count;
    return r->s / (double)r->count - mean * mean;
}
static inline double sf_running_sums_standard_error(const sf_running_sums *r) {
    return sqrt(sf_running_sums_variance(r) / ((double)r->count - 1.0));
}
static inline float sf_running_sums_f32_mean(const sf_running_sums_f32 *r) { return r->m / (float)r->count; }
static inline float sf_running_sums_f32_variance(const sf_running_sums_f32 *r) {
    float mean = r->m / (float)r->count;
    return r->s / (float)r->count - mean * mean;
}
static inline float sf_running_sums_f32_standard_error(const sf_running_sums_f32 *r) {
    return sqrtf(sf_running_sums_f32_variance(r) / ((float)r->count - 1.0f));
}

/* ---- quantiles and half-widths ---- */

/* The z below which a standard normal falls with probability p; relative error at most 1e-13.
 * -infinity at 0, infinity at 1, NaN outside [0,1]. */
double sf_normal_quantile(double p);

/* The same of Student's t with `dof` > 0 degrees of freedom (need not be whole; infinity gives
 * the normal); relative error at most 1e-10. NaN for dof <= 0 or p outside [0,1]. */
double sf_student_t_quantile(double p, double dof);

/* The factor z (t, with dof) of a two-sided interval: the quantile at (1 + confidence) / 2, for
 * confidence in (0,1). */
static inline double sf_normal_factor(double confidence) { return -sf_normal_quantile(0.5 * (1.0 - confidence)); }
static inline double sf_student_t_factor(double confidence, double dof) {
    return -sf_student_t_quantile(0.5 * (1.0 - confidence), dof);
}

/* Half-width of the mean's interval by Student's t: for independent samples that are near normal,
 * above all the means of replicates or of batches. Infinity below two samples. */
double sf_moments_half_width(const sf_moments *m, double confidence);

#ifdef __cplusplus
}
#endif
#endif
