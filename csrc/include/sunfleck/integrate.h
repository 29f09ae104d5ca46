// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* integrate: the integral of a function over [0,1)^d, to a tolerance at a confidence.
 *
 *     static int circle(void *user, size_t count, uint32_t dims, const double *points, double *values) {
 *         for (size_t i = 0; i < count; ++i, points += dims)
 *             values[i] = points[0] * points[0] + points[1] * points[1] < 1.0 ? 4.0 : 0.0;
 *         return 0;
 *     }
 *     …
 *     sf_integrate_options options = sf_integrate_options_default();
 *     sf_integral pi;
 *     sf_error error;
 *     if (sf_integrate(circle, NULL, &options, &pi, &error) != SF_STATUS_OK) …
 *     printf("%.5f +- %.5f from %" PRIu64 " samples: %s\n", pi.value, pi.half_width, pi.samples,
 *            sf_integral_stop_name(pi.stop));
 *
 * Points of a low-discrepancy pattern are not independent, so that their standard error says
 * nothing. The error is told from independent replicates instead: R copies of the pattern with
 * seeds of their own, Student's t with R - 1 degrees of freedom on their means (L'Ecuyer,
 * Nakayama, Owen & Tuffin 2023). Each replicate doubles its points between two looks. The pattern
 * "random" is judged by its samples, each of which is a copy, and its next look falls where the
 * tolerance is expected to be met. docs/integrate.md has the coverage measured.
 */
#ifndef SUNFLECK_INTEGRATE_H
#define SUNFLECK_INTEGRATE_H

#include "sunfleck/points.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The function: fills values[0 .. count - 1] for `count` rows of `dims` coordinates in [0,1), or
 * within the bounds of the options (of several components, values[i * components + k] is the k-th
 * of row i), and returns 0; anything else stops the integration, as interrupted. It is called on the caller's
 * thread. The points may be overwritten. */
typedef int (*sf_integrand)(void *user, size_t count, uint32_t dims, const double *points, double *values);

typedef enum sf_integral_stop {
    SF_INTEGRAL_MET = 0,     /* the half-width is within the tolerance */
    SF_INTEGRAL_MAX_SAMPLES, /* the next look would need more than max_samples */
    SF_INTEGRAL_INTERRUPTED, /* the function said so: value and half-width are the last look's */
    SF_INTEGRAL_SUSPICIOUS,  /* met, or max_samples, but the half-width cannot be trusted: samples that
                                are not finite, or the means of the replicates follow the most
                                extreme sample of each (correlated beyond 0.999, and without it they
                                have less than half of their variance), or the most extreme of all
                                spread as those of a law without a variance (Hill's index above 1/2):
                                a heavy tail, or an event seen less than about once in each; or all
                                samples are 0 and no range says what may hide between them */
    SF_INTEGRAL_STOP_COUNT
} sf_integral_stop;

/* "met", "max_samples", "interrupted", "suspicious"; NULL beyond. */
SF_API const char *sf_integral_stop_name(sf_integral_stop stop);

#define SF_INTEGRATE_MAX_REPLICATES 1024
#define SF_INTEGRATE_MAX_LOOKS 128

typedef struct sf_integrate_options {
    sf_pattern pattern;            /* default sobol */
    sf_scramble scramble;          /* default SF_SCRAMBLE_DEFAULT. Where the seed does not move every
                                      coordinate of the points, each replicate is shifted at random, modulo 1
                                      (Cranley & Patterson 1976) */
    uint32_t dims;                 /* default 2 */
    uint64_t seed;                 /* default 0: same seed, same options and function, same result */
    double absolute;               /* tolerance: max(absolute, relative * |value|); each finite and >= 0, not */
    double relative;               /* both 0. Default 1e-3 absolute */
    double confidence;             /* in (0,1), default 0.95 */
    uint64_t min_samples;          /* before the first look, shared by the replicates and rounded up to what
                                      they can take; at least 2, default 1024 */
    uint64_t max_samples;          /* in all, default 2^24 */
    uint32_t replicates;           /* 2 .. SF_INTEGRATE_MAX_REPLICATES, default 16; of random, streams */
    double low, high;              /* where the function's values are known to lie, low < high: a value
                                      outside is refused, and with the pattern random the interval is then a
                                      confidence sequence, which holds at every count and not only in the
                                      limit. Default: infinite, unknown */
    uint32_t threads;              /* that make the points: 1 (default) ..; 0: one for each processor. Changes no bit */
    const double *lower;           /* `dims` ends of the region each, lower below upper, -infinity and infinity */
    const double *upper;           /* allowed; read during the call. Default NULL, both: the unit cube. A range
                                      of values needs finite bounds; it is the function's, before the volume */
    const sf_interrupt *interrupt; /* default NULL: none. Asked while the points' tables are made, which
                                      takes seconds for many replicates of many dimensions; where it says
                                      stop, as where the function does, the integration ends interrupted */
} sf_integrate_options;

SF_API sf_integrate_options sf_integrate_options_default(void);

/* What was known at a look. */
typedef struct sf_integral_look {
    uint64_t samples; /* evaluations of the function so far */
    double value, half_width;
} sf_integral_look;

typedef struct sf_integral {
    double value;       /* NaN where no sample was finite */
    double half_width;  /* bounds |value - integral| with the confidence; never 0 */
    uint64_t samples;   /* evaluations of the function, all of them */
    uint64_t nonfinite; /* of them, NaN or infinite: counted, never averaged in */
    sf_integral_stop stop;
    uint32_t replicates;
    int shifted;    /* 1 where replicates were shifted at random, the seed leaving them in place */
    int folded;     /* 1 where they were shifted and folded, so that a step shows in their spread */
    uint32_t looks; /* entries of `history` */
    sf_integral_look history[SF_INTEGRATE_MAX_LOOKS];
} sf_integral;

/* Integrates `function` over [0,1)^dims, or between the bounds.
 *
 * Points that lie at random within strata (sobol and sz but under shift, latin, jittered, multijittered,
 * orthogonal; halton and hammersley under owen) are shifted modulo 1 and folded, x -> 1 - |2x - 1|,
 * by each replicate for itself, three of four in each dimension. All replicates else may see the same number of points
 * beside a step across an axis, an error that no spread shows. Where all points of a replicate have one
 * offset within their strata (halton and hammersley otherwise, lattice, shifted nets, uniform), no such map
 * helps; the half-width then falls no faster than 1 / n until the next three looks bear it out, and at the
 * first three is at least a part of the values' range over n. docs/integrate.md has what both cost.
 *
 * An infinite end is reached by t / (1 - t), two by s / (1 - s^2), s = 2t - 1: functions that fall
 * faster than x^-2 stay bounded.
 *
 * A half-width is never 0. Where all replicates (all samples, of random) agree to the last bit,
 * an event may have been missed: the half-width is then log(1 / (1 - confidence)) / N of the
 * values' range (the rule of three: 3 / N at 0.95), as given by low and high, else as seen, else
 * the value itself, else 1.
 *
 * Repeated looks give the error more chances. Each look therefore has a half of the error
 * probability (0.8 with random, whose error is known better): stopping at the first look that
 * meets the tolerance then errs at most as often as asked, by simulation with normal means and by
 * the integrands of docs/integrate.md. The entries of `history` hold one by one, not all at once;
 * those of a confidence sequence do both.
 *
 * A pattern that needs its total ahead (jittered, …) starts afresh at each look, so that the earlier
 * looks' samples, about as many again, are spent on the decision alone.
 *
 * Calls the function with blocks of about 8,192 points. Refuses bad options before any call;
 * thread-safe if the function is. */
SF_API sf_status sf_integrate(sf_integrand function, void *user, const sf_integrate_options *options,
                              sf_integral *result, sf_error *error);

/* The same for a function of several components, on the same points: results[0 .. components - 1],
 * each with its own value, half-width, history and stop. Goes on until every component has met the
 * tolerance; each half-width holds with the confidence for itself, not all at once. */
SF_API sf_status sf_integrate_vector(sf_integrand function, void *user, const sf_integrate_options *options,
                                     uint32_t components, sf_integral *results, sf_error *error);

#ifdef __cplusplus
}
#endif
#endif
