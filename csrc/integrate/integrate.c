// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Integration by replicates of a pattern, look by look. */

#include "sunfleck/integrate.h"

#include <inttypes.h>
#include <string.h>

#include "integrate/integration.h"

#define BLOCK_ROWS 8192          /* a call of the function */
#define BLOCK_VALUES (1u << 18)  /* coordinates of a block, 2 MB, where dims are many */
#define FEWEST_GROWTH 1.05       /* of random's samples between looks … */
#define LOOKS_BEFORE_DOUBLING 64 /* … unless there are so many that they must double */
#define MARGIN 1.02              /* above the count at which random should meet the tolerance */

/* ---- options ---- */

const char *sf_integral_stop_name(sf_integral_stop stop) {
    static const char *const names[SF_INTEGRAL_STOP_COUNT] = {"met", "max_samples", "interrupted", "suspicious"};
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
    if (!o->lower != !o->upper)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "only one of lower and upper is given; give both, or neither");
    if (range_is_known(o) ? !(o->low < o->high && isfinite(o->high - o->low))
                          : !(o->low == -(double)INFINITY && o->high == (double)INFINITY))
        return sf_fail(
            error, SF_STATUS_INVALID_VALUE,
            "the range of values is [%.17g, %.17g]; give finite low < high, or -infinity and infinity for unknown",
            o->low, o->high);
    return SF_STATUS_OK;
}

/* Finds the volume of the bounds, 1 where an end is infinite: the weights then have it. */
static sf_status check_bounds(integration *in) {
    const sf_integrate_options *o = &in->options;
    int finite = 1;
    double volume = 1.0;
    for (uint32_t k = 0; k < o->dims; ++k) {
        double a = o->lower[k], b = o->upper[k];
        if (!(a < b) || (isfinite(a) && isfinite(b) && !isfinite(b - a)))
            return sf_fail(in->error, SF_STATUS_INVALID_VALUE,
                           "the bounds of dimension %" PRIu32
                           " are %.17g and %.17g; give a lower end below the upper "
                           "one, either infinite or not further apart than a double holds",
                           k, a, b);
        finite &= isfinite(a) && isfinite(b);
        if (finite) volume *= b - a;
    }
    if (range_is_known(o) && !finite)
        return sf_fail(in->error, SF_STATUS_INVALID_VALUE,
                       "a range of values is given, [%.17g, %.17g], which over infinite bounds bounds nothing; give "
                       "finite bounds or no range",
                       o->low, o->high);
    if (finite && !(volume > 0.0 && isfinite(volume)))
        return sf_fail(in->error, SF_STATUS_INVALID_VALUE, "the volume of the bounds is %g, which no double holds",
                       volume);
    if (finite) in->volume = volume;
    return SF_STATUS_OK;
}

/* ---- looks ---- */

static double tolerance(const integration *in, const sf_integral *result) {
    return fmax(in->options.absolute, in->options.relative * fabs(result->value));
}

/* Estimates every component; returns the largest half-width in units of the tolerance. */
static double look(integration *in) {
    double largest = 0.0;
    for (uint32_t k = 0; k < in->components; ++k) {
        component *c = &in->component[k];
        sf_integral *result = c->result;
        sf_integration_estimate(in, c, &result->value, &result->half_width);
        c->sequence.target = tolerance(in, result);
        double ratio = result->half_width / tolerance(in, result);
        largest = fmax(largest, isnan(ratio) ? (double)INFINITY : ratio);
        result->history[in->looks] = (sf_integral_look){in->samples, result->value, result->half_width};
    }
    ++in->looks;
    return largest;
}

/* ---- from look to look ---- */

/* The least count that the pattern takes from `points` on; 0 where there is none. */
static sf_status valid_count(const integration *in, uint64_t points, uint64_t *valid) {
    uint64_t below;
    return sf_pattern_valid_counts(in->options.pattern, in->options.dims, points, &below, valid, in->error);
}

/* Points for each replicate at the next look, where the half-width is `ratio` tolerances; 0 where
 * that would need too many. */
static sf_status next_points(const integration *in, double ratio, uint64_t *next) {
    uint64_t left = (in->options.max_samples - in->samples) / in->options.replicates;
    *next = 0;
    if (in->points > UINT64_MAX / 4 || in->looks == SF_INTEGRATE_MAX_LOOKS) return SF_STATUS_OK;
    if (in->independent) {
        double growth = fmin(2.0, MARGIN * ratio * ratio);
        if (!(growth < 2.0) || in->looks >= LOOKS_BEFORE_DOUBLING) growth = 2.0;
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
    for (uint32_t k = 0; k < in->components; ++k) {
        component *c = &in->component[k];
        sf_integral *result = c->result;
        int suspicious = reason != SF_INTEGRAL_INTERRUPTED && sf_integration_is_suspicious(in, c);
        result->stop = suspicious ? SF_INTEGRAL_SUSPICIOUS : reason;
        result->samples = in->samples;
        result->looks = in->looks;
        if (in->looks > 0) continue;
        result->value = sf_integration_mean(in, c); /* interrupted before the first look */
        result->half_width = (double)INFINITY;
    }
}

static sf_status run(integration *in, uint64_t points) {
    while (points) {
        int stopped = 0;
        sf_status status = sf_integration_take_points(in, points, &stopped);
        if (status != SF_STATUS_OK) return status;
        if (stopped) {
            stop(in, SF_INTEGRAL_INTERRUPTED);
            return SF_STATUS_OK;
        }
        double ratio = look(in);
        if (ratio <= 1.0) {
            stop(in, SF_INTEGRAL_MET);
            return SF_STATUS_OK;
        }
        status = next_points(in, ratio, &points);
        if (status != SF_STATUS_OK) return status;
    }
    stop(in, SF_INTEGRAL_MAX_SAMPLES);
    return SF_STATUS_OK;
}

/* ---- the whole ---- */

static void *zeroed(const integration *in, const char *what, size_t bytes) {
    void *memory = sf_aligned_alloc(bytes);
    if (!memory)
        sf_fail_memory(in->error, what, bytes);
    else
        memset(memory, 0, bytes);
    return memory;
}

static sf_status allocate(integration *in) {
    const sf_integrate_options *o = &in->options;
    size_t rows = o->dims > BLOCK_VALUES / BLOCK_ROWS ? BLOCK_VALUES / o->dims : BLOCK_ROWS;
    in->block_rows = rows > o->replicates ? rows / o->replicates : 1;
    rows = in->block_rows * o->replicates;
    size_t doubles = rows * (o->dims + (size_t)in->components + 2);
    in->coordinates = zeroed(in, "a block of points", doubles * sizeof(double));
    in->replicate = zeroed(in, "the replicates", o->replicates * sizeof(replicate));
    in->component = zeroed(in, "the components", in->components * sizeof(component));
    in->tallies = zeroed(in, "the replicates' sums", (size_t)in->components * o->replicates * sizeof(tally));
    if (!in->coordinates || !in->replicate || !in->component || !in->tallies) return SF_STATUS_OUT_OF_MEMORY;
    in->values = in->coordinates + rows * o->dims;
    in->column = in->values + rows * in->components;
    if (o->lower) in->weights = in->column + rows;
    return SF_STATUS_OK;
}

static sf_status prepare(integration *in, sf_integral *results, uint64_t *points) {
    const sf_integrate_options *o = &in->options;
    sf_status status = first_points(in, points); /* refuses an unknown pattern, too */
    if (status == SF_STATUS_OK && o->lower) status = check_bounds(in);
    if (status != SF_STATUS_OK) return status;
    in->grows = !sf_pattern_needs_total(o->pattern);
    status = sf_integration_find_randomization(in, *points);
    if (status == SF_STATUS_OK) status = allocate(in);
    for (uint32_t k = 0; k < in->components && status == SF_STATUS_OK; ++k) {
        component *c = &in->component[k];
        c->tallies = in->tallies + (size_t)k * o->replicates;
        c->result = &results[k];
        c->result->replicates = o->replicates;
        c->result->shifted = in->shifted;
        c->result->folded = in->folded;
        if (range_is_known(o))
            status = sf_confidence_sequence_init(&c->sequence, o->low * in->volume, o->high * in->volume, o->confidence,
                                                 o->absolute, in->error);
    }
    return status;
}

sf_status sf_integrate_vector(sf_integrand function, void *user, const sf_integrate_options *options,
                              uint32_t components, sf_integral *results, sf_error *error) {
    if (components == 0) return sf_fail(error, SF_STATUS_INVALID_VALUE, "components is 0; give at least 1");
    memset(results, 0, components * sizeof *results);
    sf_status status = check_options(options, error);
    if (status != SF_STATUS_OK) return status;
    integration in = {.options = *options,
                      .function = function,
                      .user = user,
                      .error = error,
                      .components = components,
                      .volume = 1.0,
                      .independent = options->pattern == SF_PATTERN_RANDOM};
    sf_watch_begin(&in.watch, options->interrupt);
    uint64_t points = 0;
    status = prepare(&in, results, &points);
    if (status == SF_STATUS_OK) status = run(&in, points);
    for (uint32_t r = 0; in.replicate && r < options->replicates; ++r) sf_point_set_destroy(in.replicate[r].set);
    sf_aligned_free(in.tallies);
    sf_aligned_free(in.component);
    sf_aligned_free(in.replicate);
    sf_aligned_free(in.coordinates);
    return status;
}

sf_status sf_integrate(sf_integrand function, void *user, const sf_integrate_options *options, sf_integral *result,
                       sf_error *error) {
    return sf_integrate_vector(function, user, options, 1, result, error);
}
