// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* estimate: running means and variances, standard errors, and the quantiles of intervals.
 *
 * Of N samples x_i with mean m (S. Rotenberg 2017, "Random Numbers and Mappings", UCSD CSE168):
 *
 *     variance          (1/N) sum (x_i - m)^2              (the population's: 1/N)
 *     sample deviation  s = sqrt(1/(N-1) sum (x_i - m)^2)
 *     standard error    s / sqrt(N)
 *
 * There are two ways to keep them. sf_running_sums has the sum and the sum of squares: one subtraction
 * of near-equal numbers at the end loses mean^2 / variance in relative precision, so that float
 * sums fail at mean / sigma of some 10^3 and double sums at some 10^8. It is here to show that.
 * Use sf_moments (Welford 1962; merge by Chan, Golub & LeVeque 1979).
 *
 * Samples that are not finite are counted in `nonfinite` and otherwise left out; a vector with
 * one component that is not finite is left out whole. With no sample, mean and variance are NaN;
 * with fewer than two, sample deviation and standard error are infinity: nothing is known.
 *
 * The mean of finite samples is finite, whatever they are. A sum of squared deviations above
 * 1.797e308, the largest double (two samples 1.9e154 apart have it), is kept as infinity, and with it
 * the variance, the standard error and every half-width: such moments claim nothing. Give samples so
 * large, and samples whose squared deviations fall below 5e-324, in another unit.
 *
 * All states are plain structs, zeroed to begin ({0}), copied by assignment. Every function is
 * safe on distinct objects. Bulk calls give the same bits on every instruction set.
 */
#ifndef SUNFLECK_ESTIMATE_H
#define SUNFLECK_ESTIMATE_H

#include <math.h>

#include "sunfleck/base.h"

#ifdef __cplusplus
extern "C" {
#endif

#include "sunfleck/exact_begin.h"

/* ---- steps near the largest double ---- */

/* A mean moved by `share` of its way to x. Their difference is infinite where the two have different
 * signs and lie near the largest double: the parts of the weighted sum are not. */
static inline double sf_mean_moved(double mean, double x, double difference, double share) {
    return isfinite(difference) ? mean + difference * share : (mean - mean * share) + x * share;
}

/* The same by the n-th part. */
static inline double sf_mean_divided(double mean, double x, double difference, double n) {
    return isfinite(difference) ? mean + difference / n : (mean - mean / n) + x / n;
}

/* difference^2 weight, where the square alone may overflow though the weight is small, or 0. */
static inline double sf_square_weighted(double difference, double weight) {
    double square = difference * difference * weight;
    return isfinite(square) ? square : difference * (difference * weight);
}

/* ---- scalar moments (Welford) ---- */

typedef struct sf_moments {
    uint64_t count; /* of finite samples */
    double mean;
    double m2;          /* sum of squared deviations from the mean */
    uint64_t nonfinite; /* samples left out */
} sf_moments;

static inline void sf_moments_add(sf_moments *m, double x) {
    if (!isfinite(x)) {
        ++m->nonfinite;
        return;
    }
    double n = (double)++m->count, deviation = x - m->mean;
    m->mean = sf_mean_divided(m->mean, x, deviation, n);
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
    m->mean = sf_mean_moved(m->mean, other->mean, difference, share);
    m->m2 += other->m2 + sf_square_weighted(difference, a * share);
}

static inline double sf_moments_mean(const sf_moments *m) { return m->count ? m->mean : (double)NAN; }
static inline double sf_moments_variance(const sf_moments *m) {
    return m->count ? m->m2 / (double)m->count : (double)NAN;
}
/* The unbiased one of independent samples: the sum of squares over N - 1; infinite below two. */
static inline double sf_moments_sample_variance(const sf_moments *m) {
    return m->count > 1 ? m->m2 / ((double)m->count - 1.0) : (double)INFINITY;
}
static inline double sf_moments_sample_deviation(const sf_moments *m) {
    return m->count > 1 ? sqrt(m->m2 / ((double)m->count - 1.0)) : (double)INFINITY;
}
static inline double sf_moments_standard_error(const sf_moments *m) {
    return m->count > 1 ? sqrt(m->m2 / ((double)m->count - 1.0) / (double)m->count) : (double)INFINITY;
}

/* Adds x[0 .. count - 1]: moments of aligned blocks of 256 are merged pairwise, then into `m`, so
 * that the error grows as log(count). Costs about one pass over the memory. */
SF_API void sf_moments_add_f32(sf_moments *m, size_t count, const float *x);
SF_API void sf_moments_add_f64(sf_moments *m, size_t count, const double *x);

/* ---- colours: a vector mean with one scalar sum of squares ---- */

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
        m->mean[k] = sf_mean_divided(m->mean[k], x[k], deviation, n);
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
        m->mean[k] = sf_mean_moved(m->mean[k], other->mean[k], difference, share);
        square += difference * difference;
    }
    double between = square * (a * share);
    m->m2 += other->m2 + (a > 0.0 ? between : 0.0);
}

static inline double sf_vector_moments_variance(const sf_vector_moments *m) {
    return m->count ? m->m2 / (double)m->count : (double)NAN;
}
/* The unbiased one of independent samples: the sum of squares over N - 1; infinite below two. */
static inline double sf_vector_moments_sample_variance(const sf_vector_moments *m) {
    return m->count > 1 ? m->m2 / ((double)m->count - 1.0) : (double)INFINITY;
}
static inline double sf_vector_moments_sample_deviation(const sf_vector_moments *m) {
    return m->count > 1 ? sqrt(m->m2 / ((double)m->count - 1.0)) : (double)INFINITY;
}
static inline double sf_vector_moments_standard_error(const sf_vector_moments *m) {
    return m->count > 1 ? sqrt(m->m2 / ((double)m->count - 1.0) / (double)m->count) : (double)INFINITY;
}

/* Adds `count` rows of three, packed; as sf_moments_add_f32. */
SF_API void sf_vector_moments_add_f32(sf_vector_moments *m, size_t count, const float *x);
SF_API void sf_vector_moments_add_f64(sf_vector_moments *m, size_t count, const double *x);

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
        m->mean[k] = sf_mean_divided(m->mean[k], x[k], deviation, n);
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
        m->mean[k] = sf_mean_moved(m->mean[k], other->mean[k], difference, share);
        m->m2[k] += other->m2[k] + sf_square_weighted(difference, a * share);
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
SF_API void sf_channel_moments_add_f32(sf_channel_moments *m, size_t count, const float *x);
SF_API void sf_channel_moments_add_f64(sf_channel_moments *m, size_t count, const double *x);

/* ---- arrays in pieces ---- */

/* The moments of an array that comes in pieces: the same bits as one call of sf_moments_add_f32 (of rows of three
 * sf_vector_moments_add_f32, sf_channel_moments_add_f32) for the whole array, if every piece but the last is a
 * multiple of 256 long. Begin, add the pieces in order, of values or of rows and not both, and merge into moments. */
#define SF_BLOCK_MOMENTS_LEVELS 64
typedef struct sf_block_moments {
    uint64_t blocks;
    sf_channel_moments levels[SF_BLOCK_MOMENTS_LEVELS]; /* level k: of 2^k blocks, where bit k of `blocks` is set */
} sf_block_moments;

SF_API void sf_block_moments_begin(sf_block_moments *m);
SF_API void sf_block_moments_add_f32(sf_block_moments *m, size_t count, const float *x);
SF_API void sf_block_moments_add_f64(sf_block_moments *m, size_t count, const double *x);
SF_API void sf_block_moments_add_rows_f32(sf_block_moments *m, size_t count, const float *x);
SF_API void sf_block_moments_add_rows_f64(sf_block_moments *m, size_t count, const double *x);
SF_API void sf_moments_merge_blocks(sf_moments *m, const sf_block_moments *blocks);
SF_API void sf_vector_moments_merge_blocks(sf_vector_moments *m, const sf_block_moments *blocks);
SF_API void sf_channel_moments_merge_blocks(sf_channel_moments *m, const sf_block_moments *blocks);

/* ---- weighted moments (West 1979) ---- */

/* The weighted mean sum(w x) / sum(w), weights finite and >= 0; of weight 0 only the count is
 * kept. A sample or weight that is not finite, or a negative weight, counts as nonfinite. Where the
 * sum of the weights exceeds the largest double, mean and variance are NaN. */
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
    m->mean = sf_mean_moved(m->mean, x, deviation, weight / m->weight);
    double square = weight * (deviation * (x - m->mean));
    m->m2 += isfinite(square) ? square : weight * deviation * (x - m->mean);
    if (!isfinite(m->weight)) m->mean = m->m2 = (double)NAN;
}

static inline void sf_weighted_moments_merge(sf_weighted_moments *m, const sf_weighted_moments *other) {
    m->nonfinite += other->nonfinite;
    m->count += other->count;
    if (!(other->weight > 0.0)) return;
    double share = other->weight / (m->weight + other->weight), difference = other->mean - m->mean;
    m->m2 += other->m2 + sf_square_weighted(difference, m->weight * share);
    m->mean = sf_mean_moved(m->mean, other->mean, difference, share);
    m->weight += other->weight;
    if (!isfinite(m->weight)) m->mean = m->m2 = (double)NAN;
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

/* Adds `count` samples with their weights, in order. */
SF_API void sf_weighted_moments_add_f64(sf_weighted_moments *m, size_t count, const double *x, const double *weights);

/* ---- running sums ---- */

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

/* Adds count values in order; floats are added to the float sums as they are. */
SF_API void sf_running_sums_add_f64(sf_running_sums *r, size_t count, const double *f);
SF_API void sf_running_sums_f32_add_f32(sf_running_sums_f32 *r, size_t count, const float *f);

/* s/N - mean^2, negative where the subtraction has lost it; the error is then NaN, as the
 * formula has it. Samples that are not finite spoil the sums for good. */
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
SF_API double sf_normal_quantile(double p);

/* The same of Student's t with `dof` > 0 degrees of freedom (need not be whole; infinity gives
 * the normal); relative error at most 1e-10. NaN for dof <= 0 or p outside [0,1]. */
SF_API double sf_student_t_quantile(double p, double dof);

/* The factor z (t, with dof) of a two-sided interval: the quantile at (1 + confidence) / 2, for
 * confidence in (0,1). */
static inline double sf_normal_factor(double confidence) { return -sf_normal_quantile(0.5 * (1.0 - confidence)); }
static inline double sf_student_t_factor(double confidence, double dof) {
    return -sf_student_t_quantile(0.5 * (1.0 - confidence), dof);
}

/* Half-width of the mean's interval by Student's t: for independent samples that are near normal,
 * above all the means of replicates or of batches. Infinity below two samples. */
SF_API double sf_moments_half_width(const sf_moments *m, double confidence);

/* ---- batch means and replicates ---- */

/* The means of successive batches of `size` samples, as moments. Samples of one stream that depend
 * on their neighbours have batch means that hardly do, if the batch is longer than the dependence;
 * n points of each of several replicates have means that are independent altogether. Begin with
 * {0} and a size of at least 1. A sample that is not finite takes no place in its batch. */
typedef struct sf_batch_means {
    uint64_t size;
    sf_moments batch; /* the one that is filling */
    sf_moments means; /* of the full ones */
    uint64_t nonfinite;
} sf_batch_means;

static inline void sf_batch_means_add(sf_batch_means *b, double x) {
    if (!isfinite(x)) {
        ++b->nonfinite;
        return;
    }
    sf_moments_add(&b->batch, x);
    if (b->batch.count < b->size) return;
    sf_moments_add(&b->means, b->batch.mean);
    b->batch.count = 0;
    b->batch.mean = b->batch.m2 = 0.0;
}
SF_API void sf_batch_means_add_f64(sf_batch_means *b, size_t count, const double *x);

/* Of the full batches: the mean, and the half-width of its interval by Student's t. */
static inline double sf_batch_means_mean(const sf_batch_means *b) { return sf_moments_mean(&b->means); }
static inline double sf_batch_means_standard_error(const sf_batch_means *b) {
    return sf_moments_standard_error(&b->means);
}
static inline double sf_batch_means_half_width(const sf_batch_means *b, double confidence) {
    return sf_moments_half_width(&b->means, confidence);
}

/* ---- bounded values: intervals that hold at every count, not only in the limit ---- */

/* Half-width for the mean of independent samples that lie in an interval of length `range`, at
 * one count fixed ahead: the empirical Bernstein bound, Maurer & Pontil 2009, theorem 4, on both
 * sides (each with half the error). With variance s^2 and L = log(4 / (1 - confidence)):
 * sqrt(2 s^2 L / n) + 7 range L / (3 (n - 1)). Infinity below two samples. */
SF_API double sf_moments_bernstein_half_width(const sf_moments *m, double range, double confidence);

/* A confidence sequence for the mean of samples in [low, high]: an interval after every sample, all
 * of which hold at once with the confidence, so that one may look at any time and stop when one
 * likes. The samples may depend on their past if their mean, given the past, does not.
 *
 * Method: the predictable plug-in empirical Bernstein confidence sequence with running
 * intersection, Waudby-Smith & Ramdas 2023, "Estimating means of bounded random variables by
 * betting", theorem 2, bets at most 1/2. Any bet holds that only the past decides. Theirs, which
 * falls as 1 / sqrt(t log t), serves all counts alike, and pays for it with log t. Where the
 * interval need only reach a `target`, the bet target / variance is the one whose interval does so
 * first: at some 2 log(2 / (1 - confidence)) variance / target^2 samples, 1.9 times as many at 0.95
 * as the normal approximation asks for. (It never falls much below target / 2.)
 *
 * State is constant; a sample takes some 30 ns. The order of the samples counts, so that two
 * sequences cannot be merged.
 *
 * Samples that are not finite are counted and left out. One outside [low, high] shows that the
 * interval was wrong: it is counted, and the sequence is [-infinity, infinity] from then on. */
typedef struct sf_confidence_sequence {
    double low, high, confidence;
    double target; /* half-width to reach, 0 for none; may change with what the past has shown */
    uint64_t count, nonfinite, outside;
    double log_factor;              /* log(2 / (1 - confidence)) */
    double sum, square;             /* of x, of (x - mean)^2; x scaled to [0,1] */
    double bets, winnings, penalty; /* sums of lambda, lambda x, v psi(lambda) */
    double lower, upper;            /* the interval, scaled */
} sf_confidence_sequence;

/* low < high, both finite, confidence in (0,1), target finite and >= 0. */
SF_API sf_status sf_confidence_sequence_init(sf_confidence_sequence *c, double low, double high, double confidence,
                                             double target, sf_error *error);
SF_API void sf_confidence_sequence_add(sf_confidence_sequence *c, double x);
SF_API void sf_confidence_sequence_add_f64(sf_confidence_sequence *c, size_t count, const double *x);

/* The interval; [low, high] before the first sample. */
SF_API double sf_confidence_sequence_lower(const sf_confidence_sequence *c);
SF_API double sf_confidence_sequence_upper(const sf_confidence_sequence *c);

/* The interval for the mean of `count` samples in [low, high], the count fixed ahead, by the hedged
 * capital process (same paper, theorem 3, with its bets for a fixed count, truncated at 3/4 of what
 * could ruin; half the capital on each side): narrower than the empirical Bernstein bound, above
 * all where samples are few or skewed. Needs all samples at hand, and some 100 passes over them.
 * Where the samples contradict every mean (no likelier than an error), lower is above upper.
 *
 * Refuses a sample outside [low, high], or not finite; allocates 2 count doubles while it runs. Where `interrupt`
 * (NULL: none) says stop, lower and upper are not written. */
SF_API sf_status sf_betting_interval_f64(size_t count, const double *x, double low, double high, double confidence,
                                         double *lower, double *upper, const sf_interrupt *interrupt, sf_error *error);

#include "sunfleck/exact_end.h"

#ifdef __cplusplus
}
#endif
#endif
