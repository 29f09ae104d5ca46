// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The points of sf_integrate: replicates, their randomization, bounds, and calls of the function. */

#include "integrate/integration.h"

#define PROBES 8                 /* points by which it is told whether the seed moves a pattern */
#define PLAIN_EVERY 4            /* of the copies, one is not folded in a dimension; another in the next */
#define SHIFT_WORD 0x7368696674u /* "shift": keys of the random shifts, apart from the patterns' */

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

/* Whether each point lies at random within its stratum. Where all points of a copy have one offset
 * in common (a shift, permuted digits), a shift and a fold move them no differently. */
static int is_random_within_strata(sf_pattern pattern, sf_scramble scramble) {
    switch (pattern) {
        case SF_PATTERN_JITTERED:
        case SF_PATTERN_LATIN:
        case SF_PATTERN_MULTIJITTERED:
        case SF_PATTERN_ORTHOGONAL: return 1;
        case SF_PATTERN_SOBOL:
        case SF_PATTERN_SZ: return scramble != SF_SCRAMBLE_SHIFT;
        case SF_PATTERN_HALTON:
        case SF_PATTERN_HAMMERSLEY: return scramble == SF_SCRAMBLE_OWEN;
        default: return 0;
    }
}

sf_status sf_integration_find_randomization(integration *in, uint64_t total) {
    sf_status status = find_whether_fixed(in, total, &in->shifted);
    in->folded = !in->shifted && is_random_within_strata(in->options.pattern, in->options.scramble);
    /* Hammersley's first coordinate is i / n, whatever the scramble of the others; R2's points lie in no
     * strata: the gaps between n of them have three lengths. */
    sf_pattern pattern = in->options.pattern;
    in->offset_in_common =
        !in->independent && pattern != SF_PATTERN_R2 && (!in->folded || pattern == SF_PATTERN_HAMMERSLEY);
    return status;
}

/* Makes the sets of `total` points, or some where the watch says stop; of a pattern that grows, once for all. */
static sf_status make_sets(integration *in, uint64_t total) {
    if (in->grows && in->replicate[0].set) return SF_STATUS_OK;
    sf_integration_forget(in);
    for (uint32_t r = 0; r < in->options.replicates && !sf_watch_ask(&in->watch); ++r) {
        replicate *one = &in->replicate[r];
        sf_point_set_destroy(one->set);
        one->set = NULL;
        one->key = sf_hash64(in->options.seed, r);
        if (!in->grows) one->key = sf_hash64(one->key, total);
        sf_points_options points = points_of(in, one->key, in->grows ? 0 : total);
        sf_status status = sf_point_set_create(&points, &one->set, in->error);
        if (status != SF_STATUS_OK) return status;
    }
    return SF_STATUS_OK;
}

/* Adds the replicate's shift modulo 1: of numbers in [0,1) the sum is below 2, and what rounds to
 * 1 becomes 0. A fold follows where the points are random within their strata: x -> 1 - |2x - 1|
 * (Hickernell 2002; over digital nets, Cristea, Dick, Leobacher & Pillichshammer 2007).
 *
 * Why: n stratified points see of a step at u either floor(n u) or one more. Where all copies see
 * the same, their means do not differ by the step, and the error that is left, a share of 1 / n, is
 * in no spread. The shift puts the step elsewhere among the strata of each copy, so that no fixed
 * share of it is common to all; the fold makes a smooth function continuous across the shift's
 * seam, so that its error keeps its order (its derivative doubles).
 *
 * One copy in four is left as it is in each dimension, which by measurement saves 4 to 28 % of
 * the samples of seven functions and leaves a step covered. Student's t with means of
 * unequal variances errs no more often than it says (Ibragimov & Mueller 2010). */
static void randomize(const integration *in, uint32_t r, size_t rows, double *points) {
    uint64_t shift_key = sf_hash64(in->replicate[r].key, SHIFT_WORD);
    for (uint32_t k = 0; k < in->options.dims; ++k) {
        if (in->folded && (r + k) % PLAIN_EVERY == 0) continue;
        double by = sf_double_from_bits(sf_hash64(shift_key, k));
        for (size_t i = k; i < rows * in->options.dims; i += in->options.dims) {
            double x = points[i] + by;
            x = x < 1.0 ? x : x - 1.0;
            if (in->folded) {
                x = x < 0.5 ? 2.0 * x : 2.0 - 2.0 * x;
                x = x < 1.0 ? x : 1.0 - 0x1p-53;
            }
            points[i] = x;
        }
    }
}

/* Moves t in [0,1) to between two ends and returns dx/dt, both rational: t / (1 - t) where one end
 * is infinite, as QUADPACK has it (Piessens et al. 1983), and s / (1 - s^2), s = 2t - 1, where
 * both are. t = 0 is moved by half a step, for infinity is no point. */
static double move_between(double lower, double upper, double *t) {
    double x = *t, rest = 1.0 - x;
    if (isfinite(lower) && isfinite(upper)) {
        x = lower + (upper - lower) * x;
        *t = x < upper ? x : nextafter(upper, lower);
        return upper - lower;
    }
    if (isfinite(lower) || isfinite(upper)) {
        *t = isfinite(lower) ? lower + x / rest : upper - x / rest;
        return 1.0 / (rest * rest);
    }
    x = x > 0.0 ? x : 0x1p-54;
    rest = 1.0 - x;
    double s = x - rest, square = 4.0 * x * rest;
    *t = s / square;
    return 2.0 * (1.0 + s * s) / (square * square);
}

static void move_into_bounds(const integration *in, size_t rows) {
    const sf_integrate_options *o = &in->options;
    for (size_t i = 0; i < rows; ++i) {
        double *point = in->coordinates + i * o->dims, weight = 1.0;
        for (uint32_t k = 0; k < o->dims; ++k) weight *= move_between(o->lower[k], o->upper[k], &point[k]);
        in->weights[i] = weight;
    }
}

/* Evaluates points first .. first + rows - 1 of every replicate in one call of the function. */
static sf_status take_block(integration *in, uint64_t first, size_t rows, int *stopped) {
    size_t dims = in->options.dims, count = rows * in->options.replicates;
    sf_status status = SF_STATUS_OK;
    for (uint32_t r = 0; r < in->options.replicates && status == SF_STATUS_OK; ++r) {
        double *points = in->coordinates + r * rows * dims;
        status = sf_point_set_fill_f64(in->replicate[r].set, first, rows, points, in->error);
        if (in->shifted || in->folded) randomize(in, r, rows, points);
    }
    if (status != SF_STATUS_OK) return status;
    if (in->weights) move_into_bounds(in, count);
    *stopped = in->function(in->user, count, in->options.dims, in->coordinates, in->values) != 0;
    if (*stopped) return SF_STATUS_OK;
    in->samples += count;
    for (uint32_t r = 0; r < in->options.replicates && status == SF_STATUS_OK; ++r)
        status = sf_integration_take_values(in, r, rows, in->values + r * rows * in->components,
                                            in->weights ? in->weights + r * rows : NULL);
    return status;
}

sf_status sf_integration_take_points(integration *in, uint64_t points, int *stopped) {
    sf_status status = make_sets(in, points);
    uint64_t first = in->grows ? in->points : 0;
    *stopped = sf_watch_stopped(&in->watch);
    while (status == SF_STATUS_OK && first < points && !*stopped) {
        size_t rows = points - first < in->block_rows ? (size_t)(points - first) : in->block_rows;
        status = take_block(in, first, rows, stopped);
        first += rows;
    }
    if (!*stopped) in->points = points;
    return status;
}
