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

static double uniform(uint64_t i) { return sf_double_from_bits(sf_mix64(i + 1)); }

static void expect_near(double x, double expected, double relative) {
    if (!(fabs(x - expected) <= relative * fabs(expected)))
        fail_msg("%.17g, expected %.17g within %.1e", x, expected, relative);
}

/* ---- batch means ---- */

static void test_batch_means_are_the_moments_of_the_means(void **state) {
    (void)state;
    sf_batch_means b = {.size = 50};
    sf_moments means = {0};
    double x[1030];
    for (uint64_t i = 0; i < 1030; ++i) x[i] = uniform(i);
    for (int k = 0; k < 20; ++k) {
        sf_moments one = {0};
        for (int i = 0; i < 50; ++i) sf_moments_add(&one, x[50 * k + i]);
        sf_moments_add(&means, one.mean);
    }
    sf_batch_means_add_f64(&b, 1030, x);
    assert_true(b.means.count == 20 && b.batch.count == 30);
    assert_true(sf_batch_means_mean(&b) == means.mean);
    assert_true(sf_batch_means_standard_error(&b) == sf_moments_standard_error(&means));
    assert_true(sf_batch_means_half_width(&b, 0.9) == sf_moments_half_width(&means, 0.9));
    sf_batch_means_add(&b, (double)NAN);
    assert_true(b.nonfinite == 1 && b.batch.count == 30);
}

static void test_batch_means_hold_where_samples_depend_on_their_neighbours(void **state) {
    (void)state;
    /* A moving sum of 10 uniforms: the variance of a mean of n is 10 times that of independent
     * samples, so that their interval should cover some 2 Phi(1.96 / sqrt(10)) - 1 = 0.46.
     * Batches of 200 keep 1 - 10/200 of the dependence inside. 500 streams of 20 batches: four
     * binomial deviations are 0.04 at 0.95, 0.09 at 0.46. */
    int naive = 0, batched = 0;
    for (uint64_t stream = 0; stream < 500; ++stream) {
        sf_moments m = {0};
        sf_batch_means b = {.size = 200};
        double window[10] = {0}, sum = 0.0;
        for (uint64_t i = 0; i < 4010; ++i) {
            double fresh = uniform(4010 * stream + i) - 0.5;
            sum += fresh - window[i % 10];
            window[i % 10] = fresh;
            if (i < 10) continue;
            sf_moments_add(&m, sum);
            sf_batch_means_add(&b, sum);
        }
        naive += fabs(m.mean) <= sf_moments_half_width(&m, 0.95);
        batched += fabs(b.means.mean) <= sf_batch_means_half_width(&b, 0.95);
    }
    assert_true(naive / 500.0 < 0.55);
    assert_true(fabs(batched / 500.0 - 0.95) < 0.05);
}

/* ---- empirical Bernstein ---- */

static void test_bernstein_is_the_papers_formula(void **state) {
    (void)state;
    sf_moments m = {0};
    for (int i = 0; i < 100; ++i) sf_moments_add(&m, i % 2 ? 3.0 : 1.0);
    /* s^2 = 100 / 99, L = log(4 / 0.05) = log 80. */
    double L = log(80.0), expected = sqrt(2.0 * (100.0 / 99.0) * L / 100.0) + 7.0 * 2.0 * L / (3.0 * 99.0);
    expect_near(sf_moments_bernstein_half_width(&m, 2.0, 0.95), expected, 1e-14);
    sf_moments none = {0};
    assert_true(isinf(sf_moments_bernstein_half_width(&none, 1.0, 0.95)));
}

static void test_bernstein_covers_rare_events_where_student_does_not(void **state) {
    (void)state;
    /* p = 0.02 of 30 samples: more than half of the series see nothing, and Student's interval is 0
     * wide. 2,000 series: four binomial deviations at 0.95 are 0.02. */
    int student = 0, bernstein = 0;
    for (uint64_t r = 0; r < 2000; ++r) {
        sf_moments m = {0};
        for (uint64_t i = 0; i < 30; ++i) sf_moments_add(&m, uniform(30 * r + i) < 0.02);
        student += fabs(m.mean - 0.02) <= sf_moments_half_width(&m, 0.95);
        bernstein += fabs(m.mean - 0.02) <= sf_moments_bernstein_half_width(&m, 1.0, 0.95);
    }
    assert_true(student / 2000.0 < 0.5);
    assert_true(bernstein / 2000.0 > 0.93);
}

/* ---- the confidence sequence ---- */

static sf_confidence_sequence sequence(double low, double high, double confidence, double target) {
    sf_confidence_sequence c;
    assert_int_equal(sf_confidence_sequence_init(&c, low, high, confidence, target, NULL), SF_STATUS_OK);
    return c;
}

/* Distributions on [0,1] with their means. */
static double draw(int kind, uint64_t i) {
    double u = uniform(i);
    switch (kind) {
        case 0: return u < 0.5;            /* mean 1/2, the largest variance */
        case 1: return u < 0.01;           /* mean 0.01, rare */
        case 2: return u;                  /* mean 1/2 */
        default: return u * u * u * u * u; /* mean 1/6, skewed */
    }
}
static const double means[] = {0.5, 0.01, 0.5, 1.0 / 6.0};

static void test_no_look_of_a_sequence_misses_more_often_than_allowed(void **state) {
    (void)state;
    /* Looked at after every one of 2,000 samples, confidence 0.9. The running intersection keeps
     * every miss, so that the last interval tells. 400 series: four deviations at 0.1 are 0.06. */
    for (int kind = 0; kind < 4; ++kind)
        for (int aimed = 0; aimed < 2; ++aimed) {
            int missed = 0, student_missed = 0;
            for (uint64_t r = 0; r < 400; ++r) {
                sf_confidence_sequence c = sequence(0.0, 1.0, 0.9, aimed ? 0.05 : 0.0);
                sf_moments m = {0};
                int ever = 0, student_ever = 0;
                for (uint64_t i = 0; i < 2000; ++i) {
                    double x = draw(kind, 2000 * (400 * (uint64_t)kind + r) + i);
                    sf_confidence_sequence_add(&c, x);
                    ever |= sf_confidence_sequence_lower(&c) > means[kind] ||
                            sf_confidence_sequence_upper(&c) < means[kind];
                    if (kind != 2 || aimed) continue;
                    sf_moments_add(&m, x);
                    student_ever |= i > 10 && fabs(m.mean - 0.5) > sf_moments_standard_error(&m) * 1.645;
                }
                missed += ever;
                student_missed += student_ever;
            }
            assert_true(missed / 400.0 <= 0.1 + 0.06);
            /* What the sequence is for: an interval for one look, used at all, misses in most series
             * (measured: 0.62). */
            if (kind == 2 && !aimed) assert_true(student_missed / 400.0 > 0.4);
        }
}

static void test_a_sequence_with_a_target_reaches_it_at_the_count_stated(void **state) {
    (void)state;
    /* Uniforms: variance 1/12, target 0.01 at 0.95: 2 log(40) / 12 / 1e-4 = 6148 samples. */
    sf_confidence_sequence aimed = sequence(0.0, 1.0, 0.95, 0.01), plain = sequence(0.0, 1.0, 0.95, 0.0);
    uint64_t reached = 0;
    for (uint64_t i = 0; i < 8000; ++i) {
        sf_confidence_sequence_add(&aimed, uniform(i));
        sf_confidence_sequence_add(&plain, uniform(i));
        double width = sf_confidence_sequence_upper(&aimed) - sf_confidence_sequence_lower(&aimed);
        if (!reached && width <= 0.02) reached = aimed.count;
    }
    assert_true(reached > 4500 && reached < 6500);
    assert_true(sf_confidence_sequence_upper(&plain) - sf_confidence_sequence_lower(&plain) > 0.02);
}

static void test_a_sequence_scales_with_its_interval(void **state) {
    (void)state;
    sf_confidence_sequence unit = sequence(0.0, 1.0, 0.95, 0.0), wide = sequence(-4.0, 12.0, 0.95, 0.0);
    assert_true(sf_confidence_sequence_lower(&wide) == -4.0 && sf_confidence_sequence_upper(&wide) == 12.0);
    for (uint64_t i = 0; i < 500; ++i) {
        sf_confidence_sequence_add(&unit, uniform(i));
        sf_confidence_sequence_add(&wide, 16.0 * uniform(i) - 4.0);
    }
    expect_near(sf_confidence_sequence_lower(&wide), 16.0 * sf_confidence_sequence_lower(&unit) - 4.0, 1e-12);
    expect_near(sf_confidence_sequence_upper(&wide), 16.0 * sf_confidence_sequence_upper(&unit) - 4.0, 1e-12);
}

static void test_a_sequence_counts_what_is_not_finite_and_gives_up_on_what_is_outside(void **state) {
    (void)state;
    sf_confidence_sequence c = sequence(0.0, 1.0, 0.95, 0.0);
    const double x[] = {0.5, (double)NAN, 1.0, -(double)INFINITY, 0.0};
    sf_confidence_sequence_add_f64(&c, 5, x);
    assert_true(c.count == 3 && c.nonfinite == 2 && isfinite(sf_confidence_sequence_lower(&c)));
    sf_confidence_sequence_add(&c, 1.5);
    assert_true(c.outside == 1 && isinf(sf_confidence_sequence_lower(&c)) && isinf(sf_confidence_sequence_upper(&c)));
}

static void test_bad_intervals_are_refused_by_name(void **state) {
    (void)state;
    sf_confidence_sequence c;
    sf_error error;
    const double bad[][4] = {{1, 1, 0.95, 0}, {0, (double)INFINITY, 0.95, 0}, {0, 1, 1.0, 0}, {0, 1, 0.95, -1}};
    const char *const words[] = {"[1, 1]", "inf", "confidence is 1", "target is -1"};
    for (int k = 0; k < 4; ++k) {
        assert_int_equal(sf_confidence_sequence_init(&c, bad[k][0], bad[k][1], bad[k][2], bad[k][3], &error),
                         SF_STATUS_INVALID_VALUE);
        assert_non_null(strstr(error.message, words[k]));
    }
    const double x[] = {0.5, 1.5};
    double lower, upper;
    assert_int_equal(sf_betting_interval_f64(2, x, 0.0, 1.0, 0.95, &lower, &upper, NULL, &error),
                     SF_STATUS_INVALID_VALUE);
    assert_non_null(strstr(error.message, "sample 1 is 1.5"));
}

/* ---- the hedged capital ---- */

static void test_the_betting_interval_of_zeros_ends_where_the_capital_is_forty(void **state) {
    (void)state;
    /* With the one imagined sample at 1/2, the mean after i zeros is 1/2 / (i + 1), the variance
     * before sample t the sum of 1/4 and of the squares of those means, over t; the bet is
     * sqrt(2 log(40) / (n variance)), at most 3/4 / (1 - m). The capital of one who bets that the
     * mean is below m is the product of 1 + bet m; it is 2 / alpha = 40 at the upper end. */
    double x[100] = {0}, lower, upper, capital = 1.0, square = 0.25;
    assert_int_equal(sf_betting_interval_f64(100, x, 0.0, 1.0, 0.95, &lower, &upper, NULL, NULL), SF_STATUS_OK);
    for (int t = 1; t <= 100; ++t) {
        capital *= 1.0 + fmin(sqrt(2.0 * log(40.0) * t / (100.0 * square)), 0.75 / (1.0 - upper)) * upper;
        square += 0.25 / ((t + 1.0) * (t + 1.0));
    }
    assert_true(lower == 0.0);
    expect_near(capital, 40.0, 1e-9);
    assert_int_equal(sf_betting_interval_f64(0, x, 2.0, 3.0, 0.95, &lower, &upper, NULL, NULL), SF_STATUS_OK);
    assert_true(lower == 2.0 && upper == 3.0);
}

static void test_the_betting_interval_covers_and_is_narrower_than_bernsteins(void **state) {
    (void)state;
    /* 400 series of 300 samples, confidence 0.9: four deviations are 0.06. */
    for (int kind = 0; kind < 4; ++kind) {
        int missed = 0;
        double width = 0.0, bernstein = 0.0, x[300];
        for (uint64_t r = 0; r < 400; ++r) {
            sf_moments m = {0};
            double lower, upper;
            for (uint64_t i = 0; i < 300; ++i) x[i] = draw(kind, 300 * (400 * (uint64_t)kind + r) + i);
            assert_int_equal(sf_betting_interval_f64(300, x, 0.0, 1.0, 0.9, &lower, &upper, NULL, NULL), SF_STATUS_OK);
            sf_moments_add_f64(&m, 300, x);
            missed += lower > means[kind] || upper < means[kind];
            width += upper - lower;
            bernstein += 2.0 * sf_moments_bernstein_half_width(&m, 1.0, 0.9);
        }
        assert_true(missed / 400.0 <= 0.1 + 0.06);
        if (!(width < 0.9 * bernstein)) fail_msg("kind %d: %g, %g", kind, width / 400.0, bernstein / 400.0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_batch_means_are_the_moments_of_the_means),
        cmocka_unit_test(test_batch_means_hold_where_samples_depend_on_their_neighbours),
        cmocka_unit_test(test_bernstein_is_the_papers_formula),
        cmocka_unit_test(test_bernstein_covers_rare_events_where_student_does_not),
        cmocka_unit_test(test_no_look_of_a_sequence_misses_more_often_than_allowed),
        cmocka_unit_test(test_a_sequence_with_a_target_reaches_it_at_the_count_stated),
        cmocka_unit_test(test_a_sequence_scales_with_its_interval),
        cmocka_unit_test(test_a_sequence_counts_what_is_not_finite_and_gives_up_on_what_is_outside),
        cmocka_unit_test(test_bad_intervals_are_refused_by_name),
        cmocka_unit_test(test_the_betting_interval_of_zeros_ends_where_the_capital_is_forty),
        cmocka_unit_test(test_the_betting_interval_covers_and_is_narrower_than_bernsteins),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
