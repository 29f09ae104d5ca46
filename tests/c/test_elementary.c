// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The elementary functions against libm in the next wider type, in units of the last place. */

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "mapping/elementary_f64.h"

#define ALL 16777216 /* the multiples of 2^-24 in [0,1) */

/* |x - reference| in ulps of the reference; below the normal range, in ulps of the smallest. */
static double error_f32(float x, double reference) {
    float rounded = (float)reference, ulp;
    uint32_t bits;
    memcpy(&bits, &rounded, 4);
    bits &= 0x7f800000u;
    memcpy(&ulp, &bits, 4);
    if (bits == 0) ulp = 0x1p-126f;
    return fabs((double)x - reference) / ((double)ulp * 0x1p-23);
}

static double error_f64(double x, long double reference) {
    int exponent;
    frexp((double)reference, &exponent);
    if (exponent < -1021) exponent = -1021;
    return (double)(fabsl((long double)x - reference) / ldexpl(1.0L, exponent - 53));
}

static void expect_at_most(double worst, double limit) {
    if (!(worst <= limit)) fail_msg("worst error %.3f ulp, allowed %.3f", worst, limit);
}

/* sin and cos of 2 pi u by reduction to the first quarter, which is exact. */
static void reference_sincos(double u, double *sine, double *cosine) {
    int quarter = (int)floor(u * 4.0 + 0.5);
    double angle = 2.0 * SF_PI * (u - quarter * 0.25), s = sin(angle), c = cos(angle);
    *sine = quarter % 4 == 0 ? s : quarter % 4 == 1 ? c : quarter % 4 == 2 ? -s : -c;
    *cosine = quarter % 4 == 0 ? c : quarter % 4 == 1 ? -s : quarter % 4 == 2 ? -c : s;
}

static void test_sincos_is_within_1_5_ulp_of_every_multiple_of_2_to_minus_24(void **state) {
    (void)state;
    double worst = 0.0;
    for (int32_t i = 0; i < ALL; i += TEST_STRIDE) {
        float u = (float)i * 0x1p-24f, sine, cosine;
        double s, c;
        sf_sincos_2pi(u, &sine, &cosine);
        reference_sincos(u, &s, &c);
        double a = error_f32(sine, s), b = error_f32(cosine, c);
        worst = a > worst ? a : worst;
        worst = b > worst ? b : worst;
    }
    expect_at_most(worst, 1.5);
}

static void test_sincos_is_within_1_5_ulp_below_the_lattice_too(void **state) {
    (void)state;
    double worst = 0.0;
    for (uint32_t bits = 1; bits < 0x3f800000u; bits += 251 * TEST_STRIDE) {
        float u, sine, cosine;
        double s, c;
        memcpy(&u, &bits, 4);
        sf_sincos_2pi(u, &sine, &cosine);
        reference_sincos(u, &s, &c);
        double a = error_f32(sine, s), b = error_f32(cosine, c);
        worst = a > worst ? a : worst;
        worst = b > worst ? b : worst;
    }
    expect_at_most(worst, 1.5);
}

static void test_sincos_is_exact_at_the_quarters(void **state) {
    (void)state;
    for (int i = 0; i < 5; ++i) {
        float sine, cosine;
        sf_sincos_2pi(0.25f * (float)i, &sine, &cosine);
        assert_true(sine == (i == 1 ? 1.0f : i == 3 ? -1.0f : 0.0f));
        assert_true(cosine == (i == 2 ? -1.0f : i % 2 ? 0.0f : 1.0f));
    }
}

static void test_angle_is_within_1_5_ulp_all_around(void **state) {
    (void)state;
    double worst = 0.0;
    for (int32_t i = 0; i < ALL; i += 3 * TEST_STRIDE) {
        float x, y;
        sf_sincos_2pi((float)i * 0x1p-24f, &y, &x);
        double reference = atan2(y, x) / (2.0 * SF_PI);
        reference += reference < 0.0 ? 1.0 : 0.0;
        float angle = sf_angle_2pi(y, x);
        assert_true(angle >= 0.0f && angle < 1.0f);
        if (reference > (double)SF_UNIT_MAX_F) reference = (double)SF_UNIT_MAX_F; /* 1 is not in [0,1) */
        double e = error_f32(angle, reference);
        worst = e > worst ? e : worst;
    }
    expect_at_most(worst, 1.5);
    assert_true(sf_angle_2pi(0.0f, 0.0f) == 0.0f);
}

static void test_log1m_is_within_1_5_ulp_and_finite_on_the_whole_interval(void **state) {
    (void)state;
    double worst = 0.0;
    for (int32_t i = 0; i < ALL; i += TEST_STRIDE) {
        float s = (float)i * 0x1p-24f;
        double e = error_f32(sf_log1m(s), log1p(-(double)s));
        worst = e > worst ? e : worst;
    }
    for (uint32_t bits = 1; bits < 0x3f800000u; bits += 251 * TEST_STRIDE) {
        float s;
        memcpy(&s, &bits, 4);
        double e = error_f32(sf_log1m(s), log1p(-(double)s));
        worst = e > worst ? e : worst;
    }
    expect_at_most(worst, 1.5);
}

static void test_log_is_within_1_5_ulp_of_normal_floats(void **state) {
    (void)state;
    double worst = 0.0;
    for (uint32_t bits = 0x00800000u; bits < 0x7f800000u; bits += 131) {
        float x;
        memcpy(&x, &bits, 4);
        double e = error_f32(sf_log(x), log(x));
        worst = e > worst ? e : worst;
    }
    expect_at_most(worst, 1.5);
    assert_true(sf_log(1.0f) == 0.0f);
}

static void test_exp_and_expm1_are_within_1_5_ulp_up_to_87(void **state) {
    (void)state;
    double worst = 0.0;
    for (uint32_t bits = 1; bits <= 0x42ae0000u; bits += 131)
        for (int sign = -1; sign <= 1; sign += 2) {
            float x;
            memcpy(&x, &bits, 4);
            x *= (float)sign;
            double a = error_f32(sf_exp(x), exp(x)), b = error_f32(sf_expm1(x), expm1(x));
            worst = a > worst ? a : worst;
            worst = b > worst ? b : worst;
        }
    expect_at_most(worst, 1.5);
}

static void test_exp_stays_positive_and_finite_beyond_87(void **state) {
    (void)state;
    assert_true(sf_exp(-1e30f) == sf_exp(-87.0f) && sf_exp(-87.0f) > 0.0f);
    assert_true(sf_exp(1e30f) == sf_exp(87.0f) && sf_exp(87.0f) < (float)INFINITY);
    assert_true(sf_expm1(-1e30f) == -1.0f);
}

/* The long double of x86-64 has 11 bits more than a double; elsewhere it may have none. */
static void test_doubles_are_within_2_ulp(void **state) {
    (void)state;
    const long double pi = 3.14159265358979323846264338327950288L;
    double worst = 0.0, errors[6];
    for (uint32_t i = 0; i < (1u << 20); ++i) {
        double u = sf_double_from_bits(sf_mix64(i + 1)), x = 1400.0 * u - 700.0, sine, cosine;
        int quarter = (int)floor(u * 4.0 + 0.5);
        long double angle = 2.0L * pi * ((long double)u - quarter * 0.25L);
        long double s = sinl(angle), c = cosl(angle);
        sf_sincos_2pi_f64(u, &sine, &cosine);
        errors[0] = error_f64(sine, quarter % 4 == 0 ? s : quarter % 4 == 1 ? c : quarter % 4 == 2 ? -s : -c);
        errors[1] = error_f64(cosine, quarter % 4 == 0 ? c : quarter % 4 == 1 ? -s : quarter % 4 == 2 ? -c : s);
        errors[2] = error_f64(sf_angle_2pi_f64(u, 1.0 - u), atan2l(u, 1.0L - u) / (2.0L * pi));
        errors[3] = error_f64(sf_log1m_f64(u), log1pl(-(long double)u));
        errors[4] = error_f64(sf_exp_f64(x), expl(x));
        errors[5] = error_f64(sf_expm1_f64(x * 1e-3), expm1l((long double)(x * 1e-3)));
        for (int k = 0; k < 6; ++k) worst = errors[k] > worst ? errors[k] : worst;
    }
    expect_at_most(worst, sizeof(long double) > 8 ? 2.0 : 4.0);
}

static void test_unit_clamp_lands_in_the_half_open_interval(void **state) {
    (void)state;
    const float given[] = {-1.0f, -0.0f, 0.5f, 1.0f, 7.0f, (float)NAN, (float)INFINITY};
    const float expected[] = {0.0f, 0.0f, 0.5f, SF_UNIT_MAX_F, SF_UNIT_MAX_F, 0.0f, SF_UNIT_MAX_F};
    for (int i = 0; i < 7; ++i) {
        assert_true(sf_unit_clamp(given[i]) == expected[i]);
        assert_true((float)sf_unit_clamp_f64(given[i]) <= 1.0f);
    }
    assert_true(sf_unit_clamp_f64(1.0) < 1.0 && sf_unit_clamp_f64((double)NAN) == 0.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sincos_is_within_1_5_ulp_of_every_multiple_of_2_to_minus_24),
        cmocka_unit_test(test_sincos_is_within_1_5_ulp_below_the_lattice_too),
        cmocka_unit_test(test_sincos_is_exact_at_the_quarters),
        cmocka_unit_test(test_angle_is_within_1_5_ulp_all_around),
        cmocka_unit_test(test_log1m_is_within_1_5_ulp_and_finite_on_the_whole_interval),
        cmocka_unit_test(test_log_is_within_1_5_ulp_of_normal_floats),
        cmocka_unit_test(test_exp_and_expm1_are_within_1_5_ulp_up_to_87),
        cmocka_unit_test(test_exp_stays_positive_and_finite_beyond_87),
        cmocka_unit_test(test_doubles_are_within_2_ulp),
        cmocka_unit_test(test_unit_clamp_lands_in_the_half_open_interval),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
