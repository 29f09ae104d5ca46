// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Integration by replicates of a pattern, look by look. */

#include "sunfleck/integrate.h"

#include <inttypes.h>
#include <string.h>

#include "base/error.h"
#include "base/platform.h"
#include "sunfleck/estimate.h"

#define BLOCK_ROWS 8192          /* a call of the function */
#define BLOCK_VALUES (1u << 18)  /* coordinates of a block, 2 MB, where dims are many */
#define HEAVY_SHARE 0.5          /* of the means' variance, by one sample of each: suspicious … */
#define HEAVY_CONFIDENCE 0.999   /* … if the means follow those samples beyond this doubt */
#define LOOK_SHARE 0.5           /* of the error probability, for each look: of replicates … */
#define INDEPENDENT_SHARE 0.8    /* … and of independent samples */
#define PROBES 8                 /* points by which it is told whether the seed moves a pattern */
#define FEWEST_GROWTH 1.05       /* of random's samples between looks … */
#define LOOKS_BEFORE_DOUBLING 64 /* … unless there are so many that they must double */
#define MARGIN 1.02              /* above the count at which random should meet the tolerance */
#define SHIFT_WORD 0x7368696674u /* "shift": keys of the random shifts, apart from the patterns' */

typedef struct replicate {
    uint64_t key;
    sf_point_set *set;
    sf_moments moments;
    double least, greatest;
} replicate;

typedef struct integration {
    sf_integrate_options options;
    sf_integrand function;
    void *user;
    sf_integral *result;
    sf_error *error;
    int independent;   /* points: each sample is a replicate */
    int grows;         /* later points go on after earlier ones */
    uint64_t points;   /* of each replicate, at the last look */
    size_t block_rows; /* of each replicate in a block */
    double *coordinates, *values;
    replicate *replicate;
    sf_confidence_sequence sequence; /* of random, where the range is known */
} integration;

/* ---- options ---- */

const char *sf_integral_stop_name(sf_integral_stop stop) {
    static const char *const names[SF_INTEGRAL_STOP_COUNT] = {"met", "max samples", "interrupted", "suspicious"};
    return (unsigned)stop < SF_INTEGRAL_STOP_COUNT ? names[stop] : NULL;
}

sf_integrate_options sf_integrate_options_default(void) {
    sf_integrate_options options;
    memset(&options, 0, sizeof options);
    options.pattern = SF_PATTERN_SOBOL;
    options.scramble = SF_SCRAMBLE_DEFAULT;
    options.dims = 2;
    options.absolute = 1e-3;
    options.confidence = 0.95;
    options.min_samples = 1024;
    options.max_samples = UINT64_C(1) << 24;
    options.replicates = 16;
    options.low = -(double)INFINITY;
    options.high = (double)INFINITY;
    options.threads = 1;
    return options;
}

static int range_is_known(const sf_integrate_options *o) { return isfinite(o->low) && isfinite(o->high); }

static sf_status check_tolerance(const sf_integrate_options *o, sf_error *error) {
    if (!(o->absolute >= 0.0 && isfinite(o->absolute)))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "absolute tolerance is %g; give a finite number, at least 0",
                       o->absolute);
    if (!(o->relative >= 0.0 && isfinite(o->relative)))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "relative tolerance is %g; give a finite number, at least 0",
                       o->relative);
    if (o->absolute == 0.0 && o->relative == 0.0)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "the tolerance is 0, which no number of samples meets; give one above 0");
    if (!(o->confidence > 0.0 && o->confidence < 1.0))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "confidence is %g; give one above 0 and below 1", o->confidence);
    return SF_STATUS_OK;
}

static sf_status check_options(const sf_integrate_options *o, sf_error *error) {
    sf_status status = check_tolerance(o, error);
    if (status != SF_STATUS_OK) return status;
    if (o->replicates < 2 || o->replicates > SF_INTEGRATE_MAX_REPLICATES)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "replicates is %" PRIu32 "; give 2 .. %d", o->replicates,
                       SF_INTEGRATE_MAX_REPLICATES);
    if (o->min_samples < 2)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "min_samples is %" PRIu64 "; give at least 2", o->min_samples);
    if (o->max_samples < o->min_samples)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "max_samples is %" PRIu64 ", below min_samples, %" PRIu64,
                       o->max_samples, o->min_samples);
    if (range_is_known(o) ? !(o->low < o->high && isfinite(o->high - o->low))
                          : !(o->low == -(double)INFINITY && o->high == (double)INFINITY))
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "the range of values is [%g, %g]; give finite low < high, or -infinity and infinity for unknown",
                       o->low, o->high);
    return SF_STATUS_OK;
}

/* ---- points ---- */

static sf_points_options points_of(const integration *in, uint64_t seed, uint64_t total) {
    sf_points_options points = sf_points_options_default();
    points.pattern = in->options.pattern;
    points.scramble = in->options.scramble;
    points.dims = in->options.dims;
    points.threads = in->options.threads;
    points.seed = seed;
    points.total = total;
    return points;
}

/* Whether the seed leaves any coordinate of the first points where it was: then the pattern, or a
 * part of it, is deterministic. Chance does so once in some 10^8 integrations, and a shift that
 * was not needed does no harm. */
static sf_status find_whether_fixed(integration *in, uint64_t total, int *fixed) {
    size_t dims = in->options.dims, rows = total < PROBES ? (size_t)total : PROBES, words = rows * dims;
    uint32_t *a = sf_aligned_alloc(2 * words * sizeof *a);
    if (!a) return sf_fail_memory(in->error, "points to probe", 2 * words * sizeof *a);
    sf_status status = SF_STATUS_OK;
    for (int k = 0; k < 2 && status == SF_STATUS_OK; ++k) {
        sf_points_options points = points_of(in, sf_hash64(in->options.seed, (uint64_t)k), total);
        sf_point_set *set;
        status = sf_point_set_create(&points, &set, in->error);
        if (status == SF_STATUS_OK) status = sf_point_set_fill_u32(set, 0, rows, a + (size_t)k * words, in->error);
        sf_point_set_destroy(set);
    }
    *fixed = 0;
    for (size_t i = 0; i < words && status == SF_STATUS_OK; ++i) *fixed |= a[i] == a[words + i];
    sf_aligned_free(a);
    return status;
}

/* Makes the sets of `total` points; of a pattern that grows, once for all. */
static sf_status make_sets(integration *in, uint64_t total) {
    for (uint32_t r = 0; r < in->options.replicates; ++r) {
        replicate *one = &in->replicate[r];
        if (in->grows && one->set) continue;
        sf_point_set_destroy(one->set);
        one->set = NULL;
        one->key = sf_hash64(in->options.seed, r);
        if (!in->grows) one->key = sf_hash64(one->key, total);
        sf_points_options points = points_of(in, one->key, in->grows ? 0 : total);
        sf_status status = sf_point_set_create(&points, &one->set, in->error);
        if (status != SF_STATUS_OK) return status;
        one->moments = (sf_moments){0};
        one->least = (double)INFINITY;
        one->greatest = -(double)INFINITY;
    }
    return SF_STATUS_OK;
}

/* Adds the replicate's shift modulo 1: of numbers in [0,1) the sum is below 2, and what rounds to
 * 1 becomes 0. */
static void shift(const integration *in, uint64_t key, size_t rows, double *points) {
    uint64_t shift_key = sf_hash64(key, SHIFT_WORD);
    for (uint32_t k = 0; k < in->options.dims; ++k) {
        double by = sf_double_from_bits(sf_hash64(shift_key, k));
        for (size_t i = k; i < rows * in->options.dims; i += in->options.dims) {
            double x = points[i] + by;
            points[i] = x < 1.0 ? x : x - 1.0;
        }
    }
}

/* ---- values ---- */

static sf_status take_values(integration *in, replicate *one, size_t count, const double *values) {
    const sf_integrate_options *o = &in->options;
    double least = one->least, greatest = one->greatest;
    for (size_t i = 0; i < count; ++i) {
        double x = values[i];
        in->result->nonfinite += !isfinite(x);
        if (!isfinite(x)) continue;
        least = x < least ? x : least;
        greatest = x > greatest ? x : greatest;
    }
    one->least = least;
    one->greatest = greatest;
    if (least < o->low || greatest > o->high)
        return sf_fail(in->error, SF_STATUS_INVALID_VALUE,
                       "the function gave %g, outside the range of values, [%g, %g], that it was said to have",
                       least < o->low ? least : greatest, o->low, o->high);
    sf_moments_add_f64(&one->moments, count, values);
    if (in->independent && range_is_known(o)) sf_confidence_sequence_add_f64(&in->sequence, count, values);
    return SF_STATUS_OK;
}

/* Evaluates points first .. first + rows - 1 of every replicate in one call of the function. */
static sf_status take_block(integration *in, uint64_t first, size_t rows, int *stopped) {
    size_t dims = in->options.dims, count = rows * in->options.replicates;
    sf_status status = SF_STATUS_OK;
    for (uint32_t r = 0; r < in->options.replicates && status == SF_STATUS_OK; ++r) {
        double *points = in->coordinates + r * rows * dims;
        status = sf_point_set_fill_f64(in->replicate[r].set, first, rows, points, in->error);
        if (in->result->shifted) shift(in, in->replicate[r].key, rows, points);
    }
    if (status != SF_STATUS_OK) return status;
    *stopped = in->function(in->user, count, in->options.dims, in->coordinates, in->values) != 0;
    if (*stopped) return SF_STATUS_OK;
    in->result->samples += count;
    for (uint32_t r = 0; r < in->options.replicates && status == SF_STATUS_OK; ++r)
        status = take_values(in, &in->replicate[r], rows, in->values + r * rows);
    return status;
}

/* Brings every replicate to `points` points. */
static sf_status take_points(integration *in, uint64_t points, int *stopped) {
    sf_status status = make_sets(in, points);
    uint64_t first = in->grows ? in->points : 0;
    *stopped = 0;
    while (status == SF_STATUS_OK && first < points && !*stopped) {
        size_t rows = points - first < in->block_rows ? (size_t)(points - first) : in->block_rows;
        status = take_block(in, first, rows, stopped);
        first += rows;
    }
    if (!*stopped) in->points = points;
    return status;
}

/* ---- looks ---- */

static sf_moments all_samples(const integration *in) {
    sf_moments all = {0};
    for (uint32_t r = 0; r < in->options.replicates; ++r) sf_moments_merge(&all, &in->replicate[r].moments);
    return all;
}

/* The least and the greatest value of all. */
static void extent(const integration *in, double *least, double *greatest) {
    *least = (double)INFINITY;
    *greatest = -(double)INFINITY;
    for (uint32_t r = 0; r < in->options.replicates; ++r) {
        *least = fmin(*least, in->replicate[r].least);
        *greatest = fmax(*greatest, in->replicate[r].greatest);
    }
}

/* What an event may weigh that none of N samples saw: its probability is below log(1 / alpha) / N
 * with confidence 1 - alpha, since (1 - p)^N <= exp(-p N). */
static double unseen(const integration *in, double n, double least, double greatest) {
    const sf_integrate_options *o = &in->options;
    double range = greatest - least;
    if (range_is_known(o))
        range = o->high - o->low;
    else if (range == 0.0)
        range = least != 0.0 ? fabs(least) : 1.0;
    return -log(1.0 - o->confidence) / n * range;
}

/* Value and half-width by Student's t, on the means of the replicates or on independent samples. */
static void estimate(const integration *in, double *value, double *half_width) {
    sf_moments all = all_samples(in), means = {0};
    double alpha = 1.0 - in->options.confidence, least, greatest;
    extent(in, &least, &greatest);
    if (in->independent) {
        means = all;
    } else {
        for (uint32_t r = 0; r < in->options.replicates; ++r)
            sf_moments_add(&means, sf_moments_mean(&in->replicate[r].moments));
        if (means.nonfinite) means.count = 0; /* a replicate without a finite sample */
    }
    alpha *= in->independent ? INDEPENDENT_SHARE : LOOK_SHARE;
    *value = means.count ? means.mean : sf_moments_mean(&all);
    *half_width = sf_moments_half_width(&means, 1.0 - alpha);
    if (means.count > 1 && (means.m2 == 0.0 || least == greatest))
        *half_width = unseen(in, (double)all.count, least, greatest);
    /* The sum itself is rounded. */
    double rounding = 4.0 * 0x1p-53 * fmax(fabs(least), fabs(greatest));
    if (all.count && *half_width < rounding) *half_width = rounding;
}

static void estimate_bounded(const integration *in, double *value, double *half_width) {
    double lower = sf_confidence_sequence_lower(&in->sequence), upper = sf_confidence_sequence_upper(&in->sequence);
    *value = 0.5 * (lower + upper);
    *half_width = 0.5 * (upper - lower);
}

static double tolerance(const integration *in) {
    return fmax(in->options.absolute, in->options.relative * fabs(in->result->value));
}

static void look(integration *in) {
    sf_integral *result = in->result;
    if (in->independent && range_is_known(&in->options))
        estimate_bounded(in, &result->value, &result->half_width);
    else
        estimate(in, &result->value, &result->half_width);
    in->sequence.target = tolerance(in);
    result->history[result->looks++] = (sf_integral_look){result->samples, result->value, result->half_width};
}

/* Whether the means of the replicates follow the most extreme sample of each: a heavy tail, or an
 * event that is seen less than about once in each. Of independent samples the two have in common
 * what one sample in n contributes, next to nothing; of a stratified pattern not even that. */
static int follows_extremes(const integration *in) {
    double all = all_samples(in).mean, R = (double)in->options.replicates, sum[2] = {0.0, 0.0}, m2[3] = {0.0, 0.0, 0.0};
    /* Pass 0 finds the averages of both, pass 1 the sums of squares and of products. */
    for (int pass = 0; pass < 2; ++pass)
        for (uint32_t r = 0; r < in->options.replicates; ++r) {
            const replicate *one = &in->replicate[r];
            double up = one->greatest - all, down = one->least - all;
            double mean = one->moments.mean - all;
            double extreme = (up > -down ? up : down) / (double)one->moments.count;
            if (pass == 0) {
                sum[0] += mean;
                sum[1] += extreme;
                continue;
            }
            mean -= sum[0] / R;
            extreme -= sum[1] / R;
            m2[0] += mean * mean;
            m2[1] += extreme * extreme;
            m2[2] += mean * extreme;
        }
    double r = m2[2] / sqrt(m2[0] * m2[1]), dof = R - 2.0;
    if (dof < 1.0 || !(r > 0.0) || !(m2[1] > HEAVY_SHARE * m2[0])) return 0;
    /* The test of a correlation: r sqrt(dof / (1 - r^2)) is Student's t where there is none. */
    double t = sf_student_t_quantile(HEAVY_CONFIDENCE, dof);
    return r * r * dof > t * t * (1.0 - r * r);
}

/* A confidence sequence allows for what it has not seen. */
static int is_suspicious(const integration *in) {
    int bounded = in->independent && range_is_known(&in->options);
    return in->result->nonfinite > 0 || (!bounded && follows_extremes(in));
}

/* ---- from look to look ---- */

/* The least count that the pattern takes from `points` on; 0 where there is none. */
static sf_status valid_count(const integration *in, uint64_t points, uint64_t *valid) {
    uint64_t below;
    return sf_pattern_valid_counts(in->options.pattern, in->options.dims, points, &below, valid, in->error);
}

/* Points for each replicate at the next look; 0 where that would need too many. */
static sf_status next_points(const integration *in, uint64_t *next) {
    const sf_integral *result = in->result;
    uint64_t left = (in->options.max_samples - result->samples) / in->options.replicates;
    *next = 0;
    if (in->points > UINT64_MAX / 4 || result->looks == SF_INTEGRATE_MAX_LOOKS) return SF_STATUS_OK;
    if (in->independent) {
        double ratio = result->half_width / tolerance(in), growth = fmin(2.0, MARGIN * ratio * ratio);
        if (!(growth < 2.0) || result->looks >= LOOKS_BEFORE_DOUBLING) growth = 2.0;
        uint64_t more = 1 + (uint64_t)((fmax(growth, FEWEST_GROWTH) - 1.0) * (double)in->points);
        *next = left == 0 ? 0 : in->points + (more < left ? more : left);
        return SF_STATUS_OK;
    }
    sf_status status = valid_count(in, 2 * in->points, next);
    uint64_t new_points = *next - (in->grows ? in->points : 0);
    if (new_points > left) *next = 0;
    return status;
}

/* A power of two for each replicate, or the next count that the pattern takes. */
static sf_status first_points(const integration *in, uint64_t *points) {
    uint32_t replicates = in->options.replicates;
    uint64_t share = in->options.min_samples / replicates + (in->options.min_samples % replicates != 0), power = 1;
    while (power < share && power <= UINT64_MAX / 2) power *= 2;
    sf_status status = valid_count(in, power, points);
    if (status != SF_STATUS_OK) return status;
    if (*points == 0)
        return sf_fail(in->error, SF_STATUS_INVALID_VALUE, "%s has no %" PRIu64 " points in %" PRIu32 " dimensions",
                       sf_pattern_name(in->options.pattern), power, in->options.dims);
    if (*points > in->options.max_samples / replicates)
        return sf_fail(in->error, SF_STATUS_INVALID_VALUE,
                       "max_samples is %" PRIu64 "; the first look needs %" PRIu32 " replicates of %" PRIu64 " points",
                       in->options.max_samples, replicates, *points);
    return SF_STATUS_OK;
}

/* The stop reason once no further look is due. */
static void stop(integration *in, sf_integral_stop reason) {
    in->result->stop = reason != SF_INTEGRAL_INTERRUPTED && is_suspicious(in) ? SF_INTEGRAL_SUSPICIOUS : reason;
    if (in->result->looks == 0) { /* interrupted before the first look */
        in->result->value = all_samples(in).count ? all_samples(in).mean : (double)NAN;
        in->result->half_width = (double)INFINITY;
    }
}

static sf_status run(integration *in, uint64_t points) {
    while (points) {
        int stopped = 0;
        sf_status status = take_points(in, points, &stopped);
        if (status != SF_STATUS_OK) return status;
        if (stopped) {
            stop(in, SF_INTEGRAL_INTERRUPTED);
            return SF_STATUS_OK;
        }
        look(in);
        if (in->result->half_width <= tolerance(in)) {
            stop(in, SF_INTEGRAL_MET);
            return SF_STATUS_OK;
        }
        status = next_points(in, &points);
        if (status != SF_STATUS_OK) return status;
    }
    stop(in, SF_INTEGRAL_MAX_SAMPLES);
    return SF_STATUS_OK;
}

/* ---- the whole ---- */

static sf_status prepare(integration *in, uint64_t *points) {
    const sf_integrate_options *o = &in->options;
    sf_status status = first_points(in, points); /* refuses an unknown pattern, too */
    if (status != SF_STATUS_OK) return status;
    in->grows = !sf_pattern_needs_total(o->pattern);
    status = find_whether_fixed(in, *points, &in->result->shifted);
    if (status == SF_STATUS_OK && range_is_known(o))
        status = sf_confidence_sequence_init(&in->sequence, o->low, o->high, o->confidence, o->absolute, in->error);
    if (status != SF_STATUS_OK) return status;
    size_t rows = o->dims > BLOCK_VALUES / BLOCK_ROWS ? BLOCK_VALUES / o->dims : BLOCK_ROWS;
    in->block_rows = rows > in->options.replicates ? rows / in->options.replicates : 1;
    rows = in->block_rows * in->options.replicates;
    size_t bytes = rows * (o->dims + (size_t)1) * sizeof(double);
    in->coordinates = sf_aligned_alloc(bytes);
    if (!in->coordinates) return sf_fail_memory(in->error, "a block of points", bytes);
    in->values = in->coordinates + rows * o->dims;
    bytes = in->options.replicates * sizeof(replicate);
    in->replicate = sf_aligned_alloc(bytes);
    if (!in->replicate) return sf_fail_memory(in->error, "the replicates", bytes);
    memset(in->replicate, 0, bytes);
    return SF_STATUS_OK;
}

sf_status sf_integrate(sf_integrand function, void *user, const sf_integrate_options *options, sf_integral *result,
                       sf_error *error) {
    memset(result, 0, sizeof *result);
    sf_status status = check_options(options, error);
    if (status != SF_STATUS_OK) return status;
    integration in = {.options = *options,
                      .function = function,
                      .user = user,
                      .result = result,
                      .error = error,
                      .independent = options->pattern == SF_PATTERN_RANDOM};
    result->replicates = options->replicates;
    uint64_t points = 0;
    status = prepare(&in, &points);
    if (status == SF_STATUS_OK) status = run(&in, points);
    for (uint32_t r = 0; in.replicate && r < options->replicates; ++r) sf_point_set_destroy(in.replicate[r].set);
    sf_aligned_free(in.replicate);
    sf_aligned_free(in.coordinates);
    return status;
}
