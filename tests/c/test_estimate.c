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

#define PI 3.14159265358979323846
#define COUNT 100003 /* no multiple of a block */

static double uniform(uint64_t i) { return sf_double_from_bits(sf_mix64(i + 1)); }

/* Near enough normal: the sum of twelve uniforms, less its mean 6, has variance 1. */
static double near_normal(uint64_t i) {
    double sum = -6.0;
    for (uint64_t k = 0; k < 12; ++k) sum += uniform(12 * i + k);
    return sum;
}

static void expect_near(double x, double expected, double relative) {
    if (!(fabs(x - expected) <= relative * fabs(expected)))
        fail_msg("%.17g, expected %.17g within %.1e", x, expected, relative);
}

/* Mean and variance in long double by two passes. */
static void reference(const double *x, size_t n, double *mean, double *variance) {
    long double sum = 0.0L, square = 0.0L;
    for (size_t i = 0; i < n; ++i) sum += x[i];
    sum /= (long double)n;
    for (size_t i = 0; i < n; ++i) square += (x[i] - sum) * (x[i] - sum);
    *mean = (double)sum;
    *variance = (double)(square / (long double)n);
}

static void test_moments_follow_the_lectures_definitions(void **state) {
    (void)state;
    sf_moments m = {0};
    const double x[] = {2, 4, 4, 4, 5, 5, 7, 9}; /* mean 5, squared deviations 32 */
    for (int i = 0; i < 8; ++i) sf_moments_add(&m, x[i]);
    assert_true(m.count == 8);
    expect_near(sf_moments_mean(&m), 5.0, 1e-15);
    expect_near(sf_moments_variance(&m), 32.0 / 8.0, 1e-15);
    expect_near(sf_moments_sample_deviation(&m), sqrt(32.0 / 7.0), 1e-15);
    expect_near(sf_moments_sample_variance(&m), 32.0 / 7.0, 1e-15);
    expect_near(sf_moments_standard_error(&m), sqrt(32.0 / 7.0 / 8.0), 1e-15);
}

static void test_running_sums_are_the_lectures_and_agree_where_nothing_cancels(void **state) {
    (void)state;
    sf_running_sums r = {0};
    sf_running_sums_f32 f = {0};
    sf_moments m = {0};
    for (uint64_t i = 0; i < 1000; ++i) {
        double x = (double)(float)uniform(i);
        sf_running_sums_add(&r, x);
        sf_running_sums_f32_add(&f, (float)x);
        sf_moments_add(&m, x);
    }
    expect_near(sf_running_sums_mean(&r), m.mean, 1e-13);
    expect_near(sf_running_sums_variance(&r), sf_moments_variance(&m), 1e-12);
    expect_near(sf_running_sums_standard_error(&r), sf_moments_standard_error(&m), 1e-12);
    /* 1000 roundings of 2^-24 on sums some 4 times the variance: below 1e-3. */
    expect_near((double)sf_running_sums_f32_mean(&f), m.mean, 1e-4);
    expect_near((double)sf_running_sums_f32_variance(&f), sf_moments_variance(&m), 1e-3);
    expect_near((double)sf_running_sums_f32_standard_error(&f), sf_moments_standard_error(&m), 1e-3);
}

static void test_float_running_sums_fail_at_mean_1e6_where_moments_do_not(void **state) {
    (void)state;
    sf_running_sums_f32 f = {0};
    sf_moments m = {0};
    double *x = malloc(10000 * sizeof *x), mean, variance;
    for (uint64_t i = 0; i < 10000; ++i) {
        x[i] = (double)(float)(1e6 + near_normal(i));
        sf_running_sums_f32_add(&f, (float)x[i]);
        sf_moments_add(&m, x[i]);
    }
    reference(x, 10000, &mean, &variance);
    /* The squares are 1e12, an ulp of their mean 65536: the variance, 1, cannot be seen. */
    assert_true(fabs((double)sf_running_sums_f32_variance(&f) - variance) > 1000.0);
    /* Welford: each step rounds by 2^-53 of 1e6 against a deviation of 1. */
    expect_near(sf_moments_variance(&m), variance, 1e-8);
    free(x);
}

static void test_double_running_sums_fail_at_mean_1e8_where_moments_do_not(void **state) {
    (void)state;
    sf_running_sums r = {0};
    sf_moments m = {0};
    for (uint64_t i = 0; i < 10000; ++i) {
        double x = 1e8 + near_normal(i);
        sf_running_sums_add(&r, x);
        sf_moments_add(&m, x);
    }
    /* 1e16 has an ulp of 2; the variance near 1 is known to 5 % from 10,000 samples. */
    assert_true(fabs(sf_running_sums_variance(&r) - 1.0) > 0.5);
    expect_near(sf_moments_variance(&m), 1.0, 0.05);
}

static void test_merge_equals_add_however_the_samples_are_split(void **state) {
    (void)state;
    const size_t splits[] = {0, 1, 7, 500, 999, 1000};
    for (int s = 0; s < 6; ++s) {
        sf_moments all = {0}, left = {0}, right = {0};
        for (size_t i = 0; i < 1000; ++i) {
            double x = i == 10 ? (double)NAN : near_normal(i) * exp(4.0 * uniform(i + 99));
            sf_moments_add(&all, x);
            sf_moments_add(i < splits[s] ? &left : &right, x);
        }
        sf_moments_merge(&left, &right);
        assert_true(left.count == all.count && left.nonfinite == all.nonfinite);
        expect_near(left.mean, all.mean, 1e-12);
        expect_near(left.m2, all.m2, 1e-13);
    }
}

static void test_a_billion_samples_lose_no_accuracy_through_merging(void **state) {
    (void)state;
    /* Doubling a block of 1000 twenty times: mean and variance must not move. */
    sf_moments m = {0};
    for (uint64_t i = 0; i < 1000; ++i) sf_moments_add(&m, 1e3 + near_normal(i));
    double mean = m.mean, variance = sf_moments_variance(&m);
    for (int k = 0; k < 20; ++k) {
        sf_moments twin = m;
        sf_moments_merge(&m, &twin);
    }
    assert_true(m.count == UINT64_C(1048576000));
    expect_near(m.mean, mean, 1e-15);
    expect_near(sf_moments_variance(&m), variance, 1e-14);
    /* One more sample still counts. */
    double before = m.mean;
    sf_moments_add(&m, 2e3);
    expect_near(m.mean - before, (2e3 - before) / (double)m.count, 1e-4);
}

static void test_arrays_give_what_single_samples_give(void **state) {
    (void)state;
    const double means[] = {0.0, 1e6, 1e8};
    double *x = malloc(COUNT * sizeof *x);
    float *f = malloc(COUNT * sizeof *f);
    for (int k = 0; k < 3; ++k) {
        double mean, variance;
        sf_moments wide = {0}, narrow = {0};
        for (size_t i = 0; i < COUNT; ++i) x[i] = (double)(f[i] = (float)(means[k] + near_normal(i)));
        reference(x, COUNT, &mean, &variance);
        sf_moments_add_f64(&wide, COUNT, x);
        sf_moments_add_f32(&narrow, COUNT, f);
        assert_true(memcmp(&wide, &narrow, sizeof wide) == 0);
        assert_true(wide.count == COUNT);
        assert_true(fabs(wide.mean - mean) <= 1e-15 * means[k] + 1e-15);
        /* A block's mean is rounded by 2^-53 of itself; against a difference of some 1/16 between
         * neighbouring blocks that is at most 1e-9 of the variance at 1e8. */
        expect_near(sf_moments_variance(&wide), variance, 1e-13 + 1e-17 * means[k]);
    }
    free(x);
    free(f);
}

static void test_arrays_leave_out_what_is_not_finite(void **state) {
    (void)state;
    float x[600];
    sf_moments bulk = {0}, single = {0};
    for (int i = 0; i < 600; ++i) {
        x[i] = i % 50 == 3   ? (float)NAN
               : i % 50 == 4 ? (float)INFINITY
               : i == 599    ? -(float)INFINITY
                             : (float)uniform((uint64_t)i);
        sf_moments_add(&single, (double)x[i]);
    }
    sf_moments_add_f32(&bulk, 600, x);
    assert_true(bulk.nonfinite == 25 && bulk.count == 575);
    assert_true(single.nonfinite == 25 && single.count == 575);
    expect_near(bulk.mean, single.mean, 1e-14);
    expect_near(bulk.m2, single.m2, 1e-13);
    sf_moments_add_f32(&bulk, 0, NULL);
    assert_true(bulk.count == 575);
}

static void test_a_vector_has_one_scalar_variance_the_sum_of_its_channels(void **state) {
    (void)state;
    double rows[3 * 700];
    sf_vector_moments v = {0}, bulk = {0}, left = {0}, right = {0};
    sf_channel_moments c = {0}, channels = {0}, c_left = {0}, c_right = {0};
    for (uint64_t i = 0; i < 2100; ++i) rows[i] = 10.0 * (double)(i % 3) + near_normal(i);
    rows[30] = (double)NAN; /* takes its whole row with it */
    for (int i = 0; i < 700; ++i) {
        sf_vector_moments_add(&v, rows + 3 * i);
        sf_channel_moments_add(&c, rows + 3 * i);
        sf_vector_moments_add(i < 123 ? &left : &right, rows + 3 * i);
        sf_channel_moments_add(i < 123 ? &c_left : &c_right, rows + 3 * i);
    }
    sf_vector_moments_merge(&left, &right);
    sf_channel_moments_merge(&c_left, &c_right);
    sf_vector_moments_add_f64(&bulk, 700, rows);
    sf_channel_moments_add_f64(&channels, 700, rows);
    assert_true(v.count == 699 && v.nonfinite == 1 && bulk.count == 699 && bulk.nonfinite == 1);
    assert_true(c.count == 699 && left.count == 699 && left.nonfinite == 1 && c_left.nonfinite == 1);
    double variance = 0.0;
    for (int k = 0; k < 3; ++k) {
        sf_moments one = sf_channel_moments_at(&c, k), array = sf_channel_moments_at(&channels, k);
        variance += sf_moments_variance(&one);
        expect_near(array.m2, one.m2, 1e-12);
        expect_near(c_left.m2[k], one.m2, 1e-12);
        expect_near(v.mean[k], one.mean, 1e-12);
        expect_near(left.mean[k], one.mean, 1e-12);
        expect_near(bulk.mean[k], one.mean, 1e-12);
    }
    expect_near(sf_vector_moments_variance(&v), variance, 1e-12);
    expect_near(sf_vector_moments_variance(&left), variance, 1e-12);
    expect_near(sf_vector_moments_variance(&bulk), variance, 1e-12);
    expect_near(sf_vector_moments_sample_deviation(&v), sqrt(variance * 699.0 / 698.0), 1e-12);
    expect_near(sf_vector_moments_standard_error(&v), sqrt(variance / 698.0), 1e-12);
}

static void test_whole_weights_stand_for_repeated_samples(void **state) {
    (void)state;
    sf_weighted_moments w = {0}, left = {0}, right = {0};
    sf_moments m = {0};
    for (uint64_t i = 0; i < 500; ++i) {
        double x = 100.0 + near_normal(i);
        uint64_t times = i % 4;
        sf_weighted_moments_add(&w, x, (double)times);
        sf_weighted_moments_add(i < 77 ? &left : &right, x, (double)times);
        for (uint64_t k = 0; k < times; ++k) sf_moments_add(&m, x);
    }
    sf_weighted_moments_merge(&left, &right);
    expect_near(w.mean, m.mean, 1e-14);
    expect_near(sf_weighted_moments_variance(&w), sf_moments_variance(&m), 1e-12);
    expect_near(left.m2, w.m2, 1e-12);
    expect_near(left.weight_square, w.weight_square, 1e-15);
    sf_weighted_moments_add(&w, 1.0, -1.0);
    sf_weighted_moments_add(&w, 1.0, (double)NAN);
    sf_weighted_moments_add(&w, (double)INFINITY, 1.0);
    assert_true(w.nonfinite == 3 && w.count == 500);
}

static void test_equal_weights_give_the_standard_error_of_plain_moments(void **state) {
    (void)state;
    sf_weighted_moments w = {0};
    sf_moments m = {0};
    for (uint64_t i = 0; i < 100; ++i) {
        sf_weighted_moments_add(&w, near_normal(i), 0.3);
        sf_moments_add(&m, near_normal(i));
    }
    expect_near(sf_weighted_moments_standard_error(&w), sf_moments_standard_error(&m), 1e-12);
}

static void test_too_few_samples_claim_nothing(void **state) {
    (void)state;
    sf_moments m = {0};
    sf_vector_moments v = {0};
    sf_weighted_moments w = {0};
    assert_true(isnan(sf_moments_mean(&m)) && isnan(sf_moments_variance(&m)));
    assert_true(isnan(sf_vector_moments_variance(&v)) && isnan(sf_weighted_moments_variance(&w)));
    sf_moments_add(&m, 3.0);
    assert_true(sf_moments_variance(&m) == 0.0);
    assert_true(isinf(sf_moments_sample_deviation(&m)) && isinf(sf_moments_standard_error(&m)));
    assert_true(isinf(sf_moments_half_width(&m, 0.95)));
    assert_true(isinf(sf_vector_moments_standard_error(&v)) && isinf(sf_weighted_moments_standard_error(&w)));
}

/* From 40-digit arithmetic; the classical ones agree with published tables. */
/* ---- values near the largest double ---- */

static void expect_huge(const sf_moments *m, uint64_t count, double mean) {
    assert_true(m->count == count);
    expect_near(m->mean, mean, 1e-14);
    assert_true(m->m2 == (double)INFINITY); /* never NaN, never 0: nothing is claimed */
    assert_true(sf_moments_standard_error(m) == (double)INFINITY);
    assert_true(sf_moments_half_width(m, 0.95) == (double)INFINITY);
}

static void test_finite_samples_have_a_finite_mean_in_any_order(void **state) {
    (void)state;
    const double orders[][4] = {{1.7e308, -1.7e308, 1.7e308, 1.7e308},
                                {-1.7e308, 1.7e308, 1.7e308, 1.7e308},
                                {1.7e308, 1.7e308, 1.7e308, -1.7e308}};
    for (int k = 0; k < 3; ++k) {
        const double *x = orders[k];
        sf_moments one = {0}, array = {0}, left = {0}, right = {0};
        for (int i = 0; i < 4; ++i) sf_moments_add(&one, x[i]);
        sf_moments_add_f64(&array, 4, x);
        sf_moments_add_f64(&left, 1, x);
        for (int i = 1; i < 4; ++i) sf_moments_add(&right, x[i]);
        sf_moments_merge(&left, &right);
        expect_huge(&one, 4, 0.85e308);
        expect_huge(&array, 4, 0.85e308);
        expect_huge(&left, 4, 0.85e308);
    }
    /* Deviations whose squares overflow, though neither sums nor differences do. */
    double rows[2000];
    sf_moments m = {0};
    for (int i = 0; i < 2000; ++i) rows[i] = i % 2 ? 3e200 : 1e200;
    sf_moments_add_f64(&m, 2000, rows);
    expect_huge(&m, 2000, 2e200);
}

static void test_equal_samples_of_any_size_have_no_variance(void **state) {
    (void)state;
    const double values[] = {1.7976931348623157e308, -1.7e308, 1e200};
    for (int k = 0; k < 3; ++k) {
        double x[771];
        sf_moments m = {0};
        for (int i = 0; i < 771; ++i) x[i] = values[k];
        for (int i = 0; i < 5; ++i) sf_moments_add(&m, x[i]);
        sf_moments_add_f64(&m, 771, x);
        assert_true(m.mean == values[k] && m.m2 == 0.0);
    }
}

static void test_vectors_and_channels_take_values_near_the_largest_double(void **state) {
    (void)state;
    const double x[] = {1.7e308, 1.0, 1e200, -1.7e308, 3.0, 1e200};
    sf_vector_moments vectors[3] = {{0}};
    sf_channel_moments channels[3] = {{0}};
    sf_vector_moments_add_f64(&vectors[0], 2, x);
    sf_channel_moments_add_f64(&channels[0], 2, x);
    for (int i = 0; i < 2; ++i) {
        sf_vector_moments twin = {0};
        sf_channel_moments channel = {0};
        sf_vector_moments_add(&vectors[1], x + 3 * i);
        sf_channel_moments_add(&channels[1], x + 3 * i);
        sf_vector_moments_add(&twin, x + 3 * i);
        sf_channel_moments_add(&channel, x + 3 * i);
        sf_vector_moments_merge(&vectors[2], &twin);
        sf_channel_moments_merge(&channels[2], &channel);
    }
    for (int i = 0; i < 3; ++i) {
        const double *mean = vectors[i].mean, *each = channels[i].mean, *m2 = channels[i].m2;
        assert_true(mean[0] == 0.0 && mean[1] == 2.0 && mean[2] == 1e200 && vectors[i].m2 == (double)INFINITY);
        assert_true(each[0] == 0.0 && each[1] == 2.0 && each[2] == 1e200);
        assert_true(m2[0] == (double)INFINITY && m2[1] == 2.0 && m2[2] == 0.0);
    }
}

static void test_weighted_samples_near_the_largest_double(void **state) {
    (void)state;
    sf_weighted_moments m = {0}, other = {0}, light = {0}, heavy = {0};
    sf_weighted_moments_add(&m, 1.7e308, 1.0);
    sf_weighted_moments_add(&other, -1.7e308, 3.0);
    sf_weighted_moments_merge(&m, &other);
    expect_near(m.mean, -0.85e308, 1e-14);
    assert_true(m.m2 == (double)INFINITY);
    /* Small weights: sum of w (x - mean)^2 = 1e-300 / 2 4e400 is a double, its factors' product is not. */
    sf_weighted_moments_add(&light, 1e200, 1e-300);
    sf_weighted_moments_add(&light, 3e200, 1e-300);
    expect_near(light.mean, 2e200, 1e-14);
    expect_near(light.m2, 2e100, 1e-13);
    /* The weights' sum overflows: no mean, rather than that of the first sample. */
    sf_weighted_moments_add(&heavy, 1.0, 1.7e308);
    sf_weighted_moments_add(&heavy, 3.0, 1.7e308);
    assert_true(isnan(heavy.mean) && isnan(sf_weighted_moments_variance(&heavy)));
}

static void test_normal_quantile_meets_known_values(void **state) {
    (void)state;
    const double known[][2] = {{0.975, 1.95996398454005386},       {0.995, 2.57582930354890045},
                               {0.75, 0.674489750196081743},       {0.9999999, 5.19933758229066109},
                               {1e-10, -6.3613409024040562},       {1e-300, -37.0470962993611992},
                               {0.5000001, 2.5066282733116483e-7}, {0.025, -1.95996398454005421}};
    for (size_t i = 0; i < sizeof known / sizeof *known; ++i)
        expect_near(sf_normal_quantile(known[i][0]), known[i][1], 1e-14);
    assert_true(sf_normal_quantile(0.5) == 0.0);
    assert_true(isinf(sf_normal_quantile(0.0)) && isinf(sf_normal_quantile(1.0)));
    assert_true(isnan(sf_normal_quantile(-0.1)) && isnan(sf_normal_quantile(1.1)) &&
                isnan(sf_normal_quantile((double)NAN)));
    expect_near(sf_normal_factor(0.95), 1.959963984540054, 1e-13);
}

static void test_student_quantile_meets_closed_forms_and_tables(void **state) {
    (void)state;
    const double p[] = {1e-9, 0.001, 0.025, 0.2, 0.3, 0.49, 0.6, 0.9, 0.975, 0.9995};
    for (int i = 0; i < 10; ++i) {
        /* dof 1 is Cauchy's, dof 2 is algebraic. */
        double cauchy = p[i] < 0.5 ? -1.0 / tan(PI * p[i]) : 1.0 / tan(PI * (1.0 - p[i]));
        expect_near(sf_student_t_quantile(p[i], 1.0), cauchy, 1e-12);
        expect_near(sf_student_t_quantile(p[i], 2.0), (2.0 * p[i] - 1.0) / sqrt(2.0 * p[i] * (1.0 - p[i])), 1e-12);
        expect_near(sf_student_t_quantile(p[i], 1e13), sf_normal_quantile(p[i]), 1e-11);
        /* The two methods meet at dof = 1e5. */
        expect_near(sf_student_t_quantile(p[i], 99999.999), sf_student_t_quantile(p[i], 100000.001), 1e-11);
    }
    expect_near(sf_student_t_quantile(0.975, 7.0), 2.36462425159278474, 1e-12);
    expect_near(sf_student_t_quantile(0.995, 30.0), 2.74999565356722497, 1e-12);
    expect_near(sf_student_t_quantile(0.975, 0.5), 164.557673480488241, 1e-12);
    expect_near(sf_student_t_factor(0.95, 15.0), 2.13144954555977521, 1e-12);
    assert_true(isnan(sf_student_t_quantile(0.9, 0.0)) && isnan(sf_student_t_quantile(1.5, 3.0)));
}

static void test_half_width_covers_the_mean_as_often_as_it_says(void **state) {
    (void)state;
    /* 4,000 intervals of 5 near-normal samples: binomial deviation 0.0034 at 0.95; four of them. */
    int covered = 0;
    for (uint64_t r = 0; r < 4000; ++r) {
        sf_moments m = {0};
        for (uint64_t i = 0; i < 5; ++i) sf_moments_add(&m, near_normal(5 * r + i));
        covered += fabs(m.mean) <= sf_moments_half_width(&m, 0.95);
    }
    assert_true(fabs(covered / 4000.0 - 0.95) < 4.0 * 0.0034);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_moments_follow_the_lectures_definitions),
        cmocka_unit_test(test_running_sums_are_the_lectures_and_agree_where_nothing_cancels),
        cmocka_unit_test(test_float_running_sums_fail_at_mean_1e6_where_moments_do_not),
        cmocka_unit_test(test_double_running_sums_fail_at_mean_1e8_where_moments_do_not),
        cmocka_unit_test(test_merge_equals_add_however_the_samples_are_split),
        cmocka_unit_test(test_a_billion_samples_lose_no_accuracy_through_merging),
        cmocka_unit_test(test_arrays_give_what_single_samples_give),
        cmocka_unit_test(test_arrays_leave_out_what_is_not_finite),
        cmocka_unit_test(test_a_vector_has_one_scalar_variance_the_sum_of_its_channels),
        cmocka_unit_test(test_whole_weights_stand_for_repeated_samples),
        cmocka_unit_test(test_equal_weights_give_the_standard_error_of_plain_moments),
        cmocka_unit_test(test_too_few_samples_claim_nothing),
        cmocka_unit_test(test_finite_samples_have_a_finite_mean_in_any_order),
        cmocka_unit_test(test_equal_samples_of_any_size_have_no_variance),
        cmocka_unit_test(test_vectors_and_channels_take_values_near_the_largest_double),
        cmocka_unit_test(test_weighted_samples_near_the_largest_double),
        cmocka_unit_test(test_normal_quantile_meets_known_values),
        cmocka_unit_test(test_student_quantile_meets_closed_forms_and_tables),
        cmocka_unit_test(test_half_width_covers_the_mean_as_often_as_it_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
