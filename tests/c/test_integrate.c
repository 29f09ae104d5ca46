// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sunfleck/estimate.h"
#include "sunfleck/integrate.h"

#define PI 3.14159265358979323846

/* What the integrands below are told and tell. */
typedef struct watch {
    uint64_t calls, points, outside;
    uint64_t stop_after; /* calls; 0: never */
    double constant, threshold;
} watch;

static int enter(void *user, size_t count, uint32_t dims, const double *points) {
    watch *w = user;
    if (w->stop_after && w->calls == w->stop_after) return 1;
    ++w->calls;
    w->points += count;
    for (size_t i = 0; i < count * dims; ++i) w->outside += !(points[i] >= 0.0 && points[i] < 1.0);
    return 0;
}

/* The lecture's: 4 where the point lies inside the circle. */
static int circle(void *user, size_t count, uint32_t dims, const double *points, double *values) {
    if (enter(user, count, dims, points)) return 1;
    for (size_t i = 0; i < count; ++i, points += dims)
        values[i] = points[0] * points[0] + points[1] * points[1] < 1.0 ? 4.0 : 0.0;
    return 0;
}

/* exp of the sum: integral (e - 1)^dims. */
static int exponential(void *user, size_t count, uint32_t dims, const double *points, double *values) {
    if (enter(user, count, dims, points)) return 1;
    for (size_t i = 0; i < count; ++i, points += dims) {
        double sum = 0.0;
        for (uint32_t k = 0; k < dims; ++k) sum += points[k];
        values[i] = exp(sum);
    }
    return 0;
}

static int constant(void *user, size_t count, uint32_t dims, const double *points, double *values) {
    if (enter(user, count, dims, points)) return 1;
    for (size_t i = 0; i < count; ++i) values[i] = ((watch *)user)->constant;
    return 0;
}

/* 1 below the threshold in the first coordinate: probability `threshold`. */
static int step(void *user, size_t count, uint32_t dims, const double *points, double *values) {
    if (enter(user, count, dims, points)) return 1;
    for (size_t i = 0; i < count; ++i, points += dims) values[i] = points[0] < ((watch *)user)->threshold;
    return 0;
}

/* x^-0.6: integral 2.5, variance infinite. */
static int heavy(void *user, size_t count, uint32_t dims, const double *points, double *values) {
    if (enter(user, count, dims, points)) return 1;
    for (size_t i = 0; i < count; ++i, points += dims) values[i] = pow(points[0] + 1e-300, -0.6);
    return 0;
}

static int sometimes_nan(void *user, size_t count, uint32_t dims, const double *points, double *values) {
    if (enter(user, count, dims, points)) return 1;
    for (size_t i = 0; i < count; ++i, points += dims)
        values[i] = points[0] < 0.01 ? (double)NAN : points[0] > 0.99 ? (double)INFINITY : 2.0 + points[1];
    return 0;
}

/* A step across one axis and something smooth across the other: integral threshold + 1/3. */
static int step_and_square(void *user, size_t count, uint32_t dims, const double *points, double *values) {
    if (enter(user, count, dims, points)) return 1;
    for (size_t i = 0; i < count; ++i, points += dims)
        values[i] = (points[0] < ((watch *)user)->threshold) + points[dims - 1] * points[dims - 1];
    return 0;
}

/* Finite, though its square is not. */
static int huge(void *user, size_t count, uint32_t dims, const double *points, double *values) {
    if (enter(user, count, dims, points)) return 1;
    for (size_t i = 0; i < count; ++i, points += dims) values[i] = 1.7e308 * points[0];
    return 0;
}

/* exp(-x^2 / 2) and its product with x^2, over the line: sqrt(2 pi) both; y is between 2 and 5. */
static int normal(void *user, size_t count, uint32_t dims, const double *points, double *values) {
    watch *w = user;
    for (size_t i = 0; i < count; ++i, points += dims) {
        w->outside += !(isfinite(points[0]) && points[1] >= 2.0 && points[1] < 5.0);
        values[2 * i] = exp(-0.5 * points[0] * points[0]);
        values[2 * i + 1] = values[2 * i] * points[0] * points[0];
    }
    return 0;
}

static sf_integral integrate(sf_integrand f, watch *w, const sf_integrate_options *options) {
    sf_integral result;
    sf_error error = {SF_STATUS_OK, ""};
    if (sf_integrate(f, w, options, &result, &error) != SF_STATUS_OK) fail_msg("%s", error.message);
    assert_true(w->outside == 0);
    assert_true(result.samples == w->points);
    assert_true(result.samples <= options->max_samples);
    assert_true(result.half_width > 0.0);
    assert_true(result.replicates == options->replicates);
    return result;
}

static void test_pi_to_a_hundredth_by_every_pattern(void **state) {
    (void)state;
    for (int p = 0; sf_pattern_name((sf_pattern)p); ++p)
        for (int s = SF_SCRAMBLE_DEFAULT; s < SF_SCRAMBLE_COUNT; ++s) {
            if (!sf_pattern_takes_scramble((sf_pattern)p, (sf_scramble)s)) continue;
            watch w = {0};
            sf_integrate_options options = sf_integrate_options_default();
            options.pattern = (sf_pattern)p;
            options.scramble = (sf_scramble)s;
            options.absolute = 0.01;
            sf_integral pi = integrate(circle, &w, &options);
            /* One interval for each pattern and scramble: at confidence 0.95 the error is within twice
             * the half-width but in some 1e-4 of the cases. */
            if (!(fabs(pi.value - PI) < 2.0 * pi.half_width && pi.half_width <= 0.01))
                fail_msg("%s: %g +- %g", sf_pattern_name((sf_pattern)p), pi.value, pi.half_width);
            assert_int_equal(pi.stop, SF_INTEGRAL_MET);
            assert_true(pi.history[pi.looks - 1].samples == pi.samples && pi.history[0].samples >= 1024);
        }
}

static void test_what_the_seed_leaves_in_place_is_shifted(void **state) {
    (void)state;
    const struct {
        sf_pattern pattern;
        sf_scramble scramble;
        int shifted;
    } cases[] = {{SF_PATTERN_UNIFORM, SF_SCRAMBLE_DEFAULT, 1}, {SF_PATTERN_SOBOL, SF_SCRAMBLE_NONE, 1},
                 {SF_PATTERN_SOBOL, SF_SCRAMBLE_OWEN, 0},      {SF_PATTERN_HALTON, SF_SCRAMBLE_NONE, 1},
                 {SF_PATTERN_HALTON, SF_SCRAMBLE_DEFAULT, 0},  {SF_PATTERN_RANDOM, SF_SCRAMBLE_DEFAULT, 0},
                 {SF_PATTERN_JITTERED, SF_SCRAMBLE_DEFAULT, 0}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; ++k) {
        watch w = {0};
        sf_integrate_options options = sf_integrate_options_default();
        options.pattern = cases[k].pattern;
        options.scramble = cases[k].scramble;
        options.absolute = 0.05;
        assert_int_equal(integrate(exponential, &w, &options).shifted, cases[k].shifted);
    }
}

static void test_coverage_is_what_was_asked_for(void **state) {
    (void)state;
    /* 200 seeds: four binomial deviations at 0.95 are 0.06. Above is as good as at. */
    const sf_pattern patterns[] = {SF_PATTERN_SOBOL, SF_PATTERN_HALTON, SF_PATTERN_RANDOM, SF_PATTERN_JITTERED,
                                   SF_PATTERN_UNIFORM};
    for (int k = 0; k < 5; ++k) {
        int covered = 0;
        for (uint64_t seed = 0; seed < 200; ++seed) {
            watch w = {0};
            sf_integrate_options options = sf_integrate_options_default();
            options.pattern = patterns[k];
            options.seed = seed;
            options.absolute = 0.03;
            covered += fabs(integrate(circle, &w, &options).value - PI) <= 0.03;
        }
        if (covered < 0.89 * 200) fail_msg("%s covers %d of 200", sf_pattern_name(patterns[k]), covered);
    }
}

static void test_a_tolerance_relative_to_the_value_and_many_dimensions(void **state) {
    (void)state;
    watch w = {0};
    sf_integrate_options options = sf_integrate_options_default();
    options.dims = 20;
    options.absolute = 0.0;
    options.relative = 1e-3;
    sf_integral result = integrate(exponential, &w, &options);
    double exact = pow(exp(1.0) - 1.0, 20.0);
    assert_true(result.half_width <= 1e-3 * result.value);
    assert_true(fabs(result.value - exact) <= 2.0 * result.half_width);
    options.dims = 5000; /* rows of a block: 52 */
    options.max_samples = 1024;
    watch many = {.threshold = 0.5};
    assert_int_equal(integrate(step, &many, &options).stop, SF_INTEGRAL_MAX_SAMPLES);
    assert_true(many.calls > 10);
}

static void test_the_same_seed_gives_the_same_bits_for_any_threads(void **state) {
    (void)state;
    for (int p = 0; sf_pattern_name((sf_pattern)p); ++p) {
        sf_integral results[3];
        for (int k = 0; k < 3; ++k) {
            watch w = {0};
            sf_integrate_options options = sf_integrate_options_default();
            options.pattern = (sf_pattern)p;
            options.absolute = 0.01;
            options.seed = k == 2 ? 8 : 7;
            options.threads = k == 1 ? 3 : 1;
            results[k] = integrate(circle, &w, &options);
        }
        assert_true(memcmp(&results[0], &results[1], sizeof *results) == 0);
        assert_true(results[0].value != results[2].value);
    }
}

static void test_samples_that_are_all_equal_do_not_mean_no_error(void **state) {
    (void)state;
    const sf_pattern patterns[] = {SF_PATTERN_SOBOL, SF_PATTERN_RANDOM, SF_PATTERN_JITTERED};
    const double constants[] = {0.0, 0.1, -50.0};
    for (int k = 0; k < 3; ++k)
        for (int c = 0; c < 3; ++c) {
            watch w = {.constant = constants[c]};
            sf_integrate_options options = sf_integrate_options_default();
            options.pattern = patterns[k];
            options.absolute = 1e-2;
            sf_integral result = integrate(constant, &w, &options);
            /* log(20) / N of the value, or of 1. Of jittered, the last look's N counts. */
            double scale = constants[c] != 0.0 ? fabs(constants[c]) : 1.0;
            assert_true(result.half_width >= log(20.0) / (double)result.samples * scale * (1.0 - 1e-12));
            assert_true(result.half_width <= 1e-2 && fabs(result.value - constants[c]) <= 1e-15 * scale);
            /* Of what may hide among zeros no scale is known. */
            assert_int_equal(result.stop, constants[c] == 0.0 ? SF_INTEGRAL_SUSPICIOUS : SF_INTEGRAL_MET);
        }
}

static void test_an_event_that_no_sample_saw_is_allowed_for(void **state) {
    (void)state;
    /* p = 1e-4, tolerance 5e-4: most pilots of 1,024 see nothing, and must go on. */
    int covered = 0, zero = 0;
    for (uint64_t seed = 0; seed < 200; ++seed) {
        watch w = {.threshold = 1e-4};
        sf_integrate_options options = sf_integrate_options_default();
        options.pattern = SF_PATTERN_RANDOM;
        options.seed = seed;
        options.absolute = 5e-4;
        sf_integral result = integrate(step, &w, &options);
        covered += fabs(result.value - 1e-4) <= result.half_width;
        zero += fabs(result.history[0].half_width - log(20.0) / 1024.0) < 1e-12;
    }
    assert_true(zero > 150);
    assert_true(covered >= 190); /* 0.95; Student's interval alone would have covered 0.1 */
}

static void test_a_step_that_few_points_see_is_covered(void **state) {
    (void)state;
    /* Of 0.51, 4 stratified points see 2 in 0.96 of the replicates: unless these are shifted and folded, all 16
     * agree in half of the seeds, at 0.5. */
    int covered = 0;
    for (uint64_t seed = 0; seed < 50; ++seed) {
        watch w = {.threshold = 0.51};
        sf_integrate_options options = sf_integrate_options_default();
        options.dims = 1;
        options.seed = seed;
        options.min_samples = options.max_samples = 64;
        options.absolute = 1e-9;
        sf_integral result = integrate(step, &w, &options);
        assert_true(result.folded && result.half_width > 0);
        covered += fabs(result.value - 0.51) <= result.half_width;
    }
    assert_true(covered >= 43); /* of 0.95 * 50, three binomial deviations below */
}

static void test_a_step_beside_something_smooth_is_covered(void **state) {
    (void)state;
    /* 200 steps at random places: at 0.95, three deviations are 0.046. Without the fold: 0.57 to 0.75. */
    const sf_pattern patterns[] = {SF_PATTERN_SOBOL, SF_PATTERN_SZ, SF_PATTERN_LATIN, SF_PATTERN_MULTIJITTERED};
    for (int k = 0; k < 4; ++k) {
        int covered = 0;
        for (uint64_t seed = 0; seed < 200; ++seed) {
            watch w = {.threshold = (double)(sf_hash64(3, seed) >> 11) * 0x1p-53};
            sf_integrate_options options = sf_integrate_options_default();
            options.pattern = patterns[k];
            options.seed = seed;
            options.absolute = 5e-4;
            sf_integral result = integrate(step_and_square, &w, &options);
            assert_true(result.folded && !result.shifted);
            covered += fabs(result.value - w.threshold - 1.0 / 3.0) <= result.half_width;
        }
        if (covered < 181) fail_msg("%s covers %d of 200", sf_pattern_name(patterns[k]), covered);
    }
}

static void test_finite_values_have_a_finite_integral(void **state) {
    (void)state;
    watch w = {0};
    sf_integrate_options options = sf_integrate_options_default();
    options.absolute = 0.0;
    options.relative = 1e-3;
    sf_integral result = integrate(huge, &w, &options);
    assert_int_equal(result.stop, SF_INTEGRAL_MET);
    assert_true(fabs(result.value / 1.7e308 - 0.5) <= 2e-3 && result.half_width <= 1e-3 * result.value);
    options.pattern = SF_PATTERN_RANDOM;
    watch other = {0};
    result = integrate(huge, &other, &options);
    assert_true(fabs(result.value / 1.7e308 - 0.5) <= 2e-3);
}

static void test_a_smooth_function_whose_mean_follows_its_extremes_is_not_suspicious(void **state) {
    (void)state;
    /* Of x under a shift the replicates' extremes tell their means, though they hardly enter them. */
    const sf_pattern patterns[] = {SF_PATTERN_SOBOL, SF_PATTERN_HALTON, SF_PATTERN_LATTICE, SF_PATTERN_HAMMERSLEY,
                                   SF_PATTERN_R2};
    for (int k = 0; k < 5; ++k) {
        int suspicious = 0;
        for (uint64_t seed = 0; seed < 50; ++seed) {
            watch w = {0};
            sf_integrate_options options = sf_integrate_options_default();
            options.pattern = patterns[k];
            if (patterns[k] == SF_PATTERN_SOBOL) options.scramble = SF_SCRAMBLE_SHIFT;
            options.seed = seed;
            options.dims = 1;
            options.absolute = 1e-2;
            suspicious += integrate(exponential, &w, &options).stop == SF_INTEGRAL_SUSPICIOUS;
        }
        assert_true(suspicious == 0);
    }
}

static void test_bounds_and_components(void **state) {
    (void)state;
    const double lower[2] = {-(double)INFINITY, 2.0}, upper[2] = {(double)INFINITY, 5.0};
    watch w = {0};
    sf_integrate_options options = sf_integrate_options_default();
    sf_integral results[2];
    sf_error error;
    options.lower = lower;
    options.upper = upper;
    assert_int_equal(sf_integrate_vector(normal, &w, &options, 2, results, &error), SF_STATUS_OK);
    assert_true(w.outside == 0);
    for (int k = 0; k < 2; ++k) {
        assert_int_equal(results[k].stop, SF_INTEGRAL_MET);
        assert_true(results[k].half_width <= 1e-3);
        assert_true(fabs(results[k].value - 3.0 * sqrt(2.0 * PI)) <= 2.0 * results[k].half_width);
    }
    assert_true(results[0].value != results[1].value && results[0].samples == results[1].samples);
    options.low = 0.0;
    options.high = 1.0;
    assert_int_equal(sf_integrate_vector(normal, &w, &options, 2, results, &error), SF_STATUS_INVALID_VALUE);
    assert_non_null(strstr(error.message, "infinite bounds"));
    options = sf_integrate_options_default();
    options.lower = upper;
    options.upper = lower;
    assert_int_equal(sf_integrate_vector(normal, &w, &options, 2, results, &error), SF_STATUS_INVALID_VALUE);
    assert_non_null(strstr(error.message, "bounds of dimension 0"));
    options.upper = NULL;
    assert_int_equal(sf_integrate_vector(normal, &w, &options, 2, results, &error), SF_STATUS_INVALID_VALUE);
    options.lower = NULL;
    assert_int_equal(sf_integrate_vector(normal, &w, &options, 0, results, &error), SF_STATUS_INVALID_VALUE);
}

static void test_a_known_range_makes_random_a_confidence_sequence(void **state) {
    (void)state;
    int missed = 0;
    for (uint64_t seed = 0; seed < 200; ++seed) {
        watch w = {.threshold = 0.003};
        sf_integrate_options options = sf_integrate_options_default();
        options.pattern = SF_PATTERN_RANDOM;
        options.seed = seed;
        options.low = 0.0;
        options.high = 1.0;
        options.absolute = 1e-3;
        sf_integral result = integrate(step, &w, &options);
        /* Every look holds, not only the last. */
        int miss = 0;
        for (uint32_t k = 0; k < result.looks; ++k)
            miss |= fabs(result.history[k].value - 0.003) > result.history[k].half_width * (1.0 + 1e-12);
        missed += miss;
        assert_int_equal(result.stop, SF_INTEGRAL_MET);
    }
    assert_true(missed <= 10 + 12); /* 0.05 of 200 and four deviations of 3.1 */
}

static void test_a_value_outside_its_range_is_refused(void **state) {
    (void)state;
    watch w = {0};
    sf_integrate_options options = sf_integrate_options_default();
    sf_integral result;
    sf_error error;
    options.low = 0.0;
    options.high = 3.0;
    assert_int_equal(sf_integrate(circle, &w, &options, &result, &error), SF_STATUS_INVALID_VALUE);
    assert_non_null(strstr(error.message, "gave 4, outside the range of values, [0, 3]"));
}

static void test_values_that_are_not_finite_are_counted_and_left_out(void **state) {
    (void)state;
    watch w = {0};
    sf_integrate_options options = sf_integrate_options_default();
    sf_integral result = integrate(sometimes_nan, &w, &options);
    assert_int_equal(result.stop, SF_INTEGRAL_SUSPICIOUS);
    /* 2 % of the samples, of a set that is stratified. */
    assert_true(fabs((double)result.nonfinite / (double)result.samples - 0.02) < 0.003);
    assert_true(fabs(result.value - 2.5) < 0.01);
    watch all = {.constant = (double)NAN};
    options.max_samples = 4096;
    sf_integral none = integrate(constant, &all, &options);
    assert_true(isnan(none.value) && isinf(none.half_width) && none.nonfinite == none.samples);
    assert_int_equal(none.stop, SF_INTEGRAL_SUSPICIOUS);
}

static void test_a_heavy_tail_is_suspicious_and_a_tame_integrand_is_not(void **state) {
    (void)state;
    int suspicious = 0, tame = 0;
    for (uint64_t seed = 0; seed < 100; ++seed) {
        watch w = {0};
        sf_integrate_options options = sf_integrate_options_default();
        options.seed = seed;
        options.dims = 1;
        options.absolute = 0.05;
        suspicious += integrate(heavy, &w, &options).stop == SF_INTEGRAL_SUSPICIOUS;
        watch other = {0};
        options.absolute = 1e-4;
        tame += integrate(exponential, &other, &options).stop == SF_INTEGRAL_SUSPICIOUS;
    }
    assert_true(suspicious >= 95);
    assert_true(tame <= 2);
}

static void test_a_function_that_stops_leaves_what_is_known(void **state) {
    (void)state;
    sf_integrate_options options = sf_integrate_options_default();
    options.absolute = 1e-9;
    watch later = {.stop_after = 5};
    sf_integral result = integrate(circle, &later, &options);
    assert_int_equal(result.stop, SF_INTEGRAL_INTERRUPTED);
    assert_true(result.looks > 0 && result.value == result.history[result.looks - 1].value);
    assert_true(fabs(result.value - PI) < 2.0 * result.half_width);
    options.min_samples = 32768; /* four blocks */
    watch early = {.stop_after = 2};
    result = integrate(circle, &early, &options);
    assert_int_equal(result.stop, SF_INTEGRAL_INTERRUPTED);
    assert_true(result.looks == 0 && isinf(result.half_width) && fabs(result.value - PI) < 0.1);
    watch never = {0};
    sf_integral none;
    never.stop_after = 1;
    never.calls = 1;
    assert_int_equal(sf_integrate(circle, &never, &options, &none, NULL), SF_STATUS_OK);
    assert_true(none.samples == 0 && isnan(none.value) && isinf(none.half_width));
}

static void test_max_samples_is_never_exceeded(void **state) {
    (void)state;
    for (int p = 0; sf_pattern_name((sf_pattern)p); ++p) {
        watch w = {0};
        sf_integrate_options options = sf_integrate_options_default();
        options.pattern = (sf_pattern)p;
        options.absolute = 1e-12;
        options.max_samples = 30000;
        sf_integral result = integrate(circle, &w, &options);
        assert_int_equal(result.stop, SF_INTEGRAL_MAX_SAMPLES);
        assert_true(result.samples > 14000);
    }
}

static void test_bad_options_are_refused_before_any_call(void **state) {
    (void)state;
    const sf_integrate_options good = sf_integrate_options_default();
    sf_integrate_options bad[11];
    const char *const words[11] = {"absolute tolerance is -1",
                                   "relative tolerance is nan",
                                   "the tolerance is 0",
                                   "confidence is 1",
                                   "replicates is 1",
                                   "min_samples is 1",
                                   "max_samples is 100",
                                   "range of values is [2, 1]",
                                   "d is 0",
                                   "pattern is 99",
                                   "scramble"};
    for (int k = 0; k < 11; ++k) bad[k] = good;
    bad[0].absolute = -1.0;
    bad[1].relative = (double)NAN;
    bad[2].absolute = 0.0;
    bad[3].confidence = 1.0;
    bad[4].replicates = 1;
    bad[5].min_samples = 1;
    bad[6].max_samples = 100;
    bad[7].low = 2.0;
    bad[7].high = 1.0;
    bad[8].dims = 0;
    bad[9].pattern = (sf_pattern)99;
    bad[10].scramble = SF_SCRAMBLE_PERMUTED;
    for (int k = 0; k < 11; ++k) {
        watch w = {0};
        sf_integral result;
        sf_error error;
        assert_int_equal(sf_integrate(circle, &w, &bad[k], &result, &error), SF_STATUS_INVALID_VALUE);
        if (!strstr(error.message, words[k])) fail_msg("\"%s\" lacks \"%s\"", error.message, words[k]);
        assert_true(w.calls == 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pi_to_a_hundredth_by_every_pattern),
        cmocka_unit_test(test_what_the_seed_leaves_in_place_is_shifted),
        cmocka_unit_test(test_coverage_is_what_was_asked_for),
        cmocka_unit_test(test_a_tolerance_relative_to_the_value_and_many_dimensions),
        cmocka_unit_test(test_the_same_seed_gives_the_same_bits_for_any_threads),
        cmocka_unit_test(test_samples_that_are_all_equal_do_not_mean_no_error),
        cmocka_unit_test(test_an_event_that_no_sample_saw_is_allowed_for),
        cmocka_unit_test(test_a_step_that_few_points_see_is_covered),
        cmocka_unit_test(test_a_step_beside_something_smooth_is_covered),
        cmocka_unit_test(test_finite_values_have_a_finite_integral),
        cmocka_unit_test(test_a_smooth_function_whose_mean_follows_its_extremes_is_not_suspicious),
        cmocka_unit_test(test_bounds_and_components),
        cmocka_unit_test(test_a_known_range_makes_random_a_confidence_sequence),
        cmocka_unit_test(test_a_value_outside_its_range_is_refused),
        cmocka_unit_test(test_values_that_are_not_finite_are_counted_and_left_out),
        cmocka_unit_test(test_a_heavy_tail_is_suspicious_and_a_tame_integrand_is_not),
        cmocka_unit_test(test_a_function_that_stops_leaves_what_is_known),
        cmocka_unit_test(test_max_samples_is_never_exceeded),
        cmocka_unit_test(test_bad_options_are_refused_before_any_call),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
