// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Whether the samples of each mapping have the density that its pdf states: chi-square on a grid
 * of 12 x 12 cells of a chart, 2^21 samples at a fixed seed. A density that is off by 1 %, up in
 * half of the cells and down in the others, adds 2^21 x 1e-4 = 210 to a statistic of standard
 * deviation sqrt(2 x 144) = 17, twelve deviations: the test of the test shows it. */

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "mapping_cases.h"
#include "sunfleck/estimate.h"

#define SIDE 12
#define CELLS (SIDE * SIDE)
#define FINE 16 /* nodes along a cell's side: four parts of four Gauss-Legendre nodes */
#define SAMPLES (1u << 21)

/* The chance of a false alarm in the whole file, shared by its tests. */
#define SIGNIFICANCE 1e-4

static void sample_case(const mapping_case *c, uint64_t seed, double *counts) {
    size_t width = sf_mapping_output_width(c->mapping);
    float *u = malloc(2 * SAMPLES * sizeof *u), *x = malloc(width * SAMPLES * sizeof *x);
    case_parameters p;
    sf_error error;
    case_parameters_init(&p, c);
    for (size_t i = 0; i < 2 * SAMPLES; ++i) u[i] = sf_float_from_bits((uint32_t)(sf_hash64(seed, i) >> 32));
    if (sf_mapping_sample_fill_f32(c->mapping, SAMPLES, u, p.f32_at, NULL, x, &error)) fail_msg("%s", error.message);
    for (int i = 0; i < CELLS; ++i) counts[i] = 0.0;
    for (size_t i = 0; i < SAMPLES; ++i) {
        double point[3] = {0.0, 0.0, 0.0}, cell[2];
        for (size_t k = 0; k < width; ++k) point[k] = (double)x[i * width + k];
        chart_of(c, point, cell);
        int row = (int)(cell[0] * SIDE), column = (int)(cell[1] * SIDE);
        row = row < 0 ? 0 : row < SIDE ? row : SIDE - 1;
        column = column < 0 ? 0 : column < SIDE ? column : SIDE - 1;
        counts[row * SIDE + column] += 1.0;
    }
    free(u);
    free(x);
}

/* Node k of the whole side of the chart, and its weight: Gauss-Legendre of 4 points (Abramowitz &
 * Stegun 25.4.30), exact up to degree 7 on each part. */
static double node(size_t k, double *weight) {
    static const double at[4] = {-0.861136311594053, -0.339981043584856, 0.339981043584856, 0.861136311594053};
    static const double weights[4] = {0.347854845137454, 0.652145154862546, 0.652145154862546, 0.347854845137454};
    const double parts = SIDE * FINE / 4.0;
    *weight = 0.5 * weights[k % 4] / parts;
    return ((double)(k / 4) + 0.5 + 0.5 * at[k % 4]) / parts;
}

/* The integral of the pdf over each cell. */
static void integrate_case(const mapping_case *c, double *shares) {
    size_t width = sf_mapping_output_width(c->mapping), n = (size_t)CELLS * FINE * FINE;
    double *x = malloc(width * n * sizeof *x), *pdf = malloc(n * sizeof *pdf), *measure = malloc(n * sizeof *measure);
    case_parameters p;
    sf_error error;
    case_parameters_init(&p, c);
    for (size_t i = 0; i < n; ++i) {
        size_t row = i / (SIDE * FINE), column = i % (SIDE * FINE);
        double point[3] = {0.0, 0.0, 0.0}, weight_p, weight_q, p_at = node(row, &weight_p),
               q_at = node(column, &weight_q);
        measure[i] = chart_point(c, p_at, q_at, point) * weight_p * weight_q;
        for (size_t k = 0; k < width; ++k) x[i * width + k] = point[k];
    }
    if (sf_mapping_pdf_fill_f64(c->mapping, n, x, p.f64_at, NULL, pdf, &error)) fail_msg("%s", error.message);
    for (int i = 0; i < CELLS; ++i) shares[i] = 0.0;
    for (size_t i = 0; i < n; ++i)
        shares[i / (SIDE * FINE) / FINE * SIDE + i % (SIDE * FINE) / FINE] += pdf[i] * measure[i];
    free(x);
    free(pdf);
    free(measure);
}

/* The probability of a chi-square statistic at least this large; cells of fewer than 25 expected
 * are put together. Wilson & Hilferty 1931: its cube root is near normal. */
static double chi_square_p(const double *counts, const double *shares) {
    double statistic = 0.0, rest_count = 0.0, rest_share = 0.0;
    int cells = 0;
    for (int i = 0; i < CELLS; ++i) {
        double expected = shares[i] * SAMPLES, difference = counts[i] - expected;
        if (expected < 25.0) {
            rest_count += counts[i];
            rest_share += shares[i];
            continue;
        }
        statistic += difference * difference / expected;
        ++cells;
    }
    if (rest_share * SAMPLES >= 5.0) {
        double expected = rest_share * SAMPLES, difference = rest_count - expected;
        statistic += difference * difference / expected;
        ++cells;
    } else if (rest_count > 40.0) {
        return 0.0; /* samples where the density has none */
    }
    double freedom = cells - 1, h = 2.0 / (9.0 * freedom);
    return 0.5 * erfc((cbrt(statistic / freedom) - (1.0 - h)) / sqrt(2.0 * h));
}

/* Each case sampled and integrated once, for all tests. */
static double counts_of[CASE_COUNT][CELLS], shares_of[CASE_COUNT][CELLS];

static int prepare(void **state) {
    (void)state;
    for (size_t i = 0; i < CASE_COUNT; ++i) {
        sample_case(&mapping_cases[i], i, counts_of[i]);
        integrate_case(&mapping_cases[i], shares_of[i]);
    }
    return 0;
}

static void test_samples_have_the_density_that_the_pdf_states(void **state) {
    (void)state;
    for (size_t i = 0; i < CASE_COUNT; ++i) {
        double p = chi_square_p(counts_of[i], shares_of[i]);
        if (!(p > SIGNIFICANCE / (double)CASE_COUNT))
            fail_msg("%s (case %zu): p = %g", sf_mapping_name(mapping_cases[i].mapping), i, p);
    }
}

/* What the rule of 192 nodes a side leaves. The kinks of the signed filters lie between parts, but
 * for the jump of Mitchell's second derivative at the rim, 2/3: a part of h = 0.095 that holds it is
 * wrong by 2/3 h^3 / 24 at most, at four places. Elsewhere the Gaussian, cut at 6 sigma, has 2e-8
 * beyond. */
static double quadrature_error(const mapping_case *c) { return c->mapping == SF_MAPPING_PIXEL_MITCHELL ? 1e-4 : 1e-6; }

static void test_each_pdf_integrates_to_one(void **state) {
    (void)state;
    for (size_t i = 0; i < CASE_COUNT; ++i) {
        double sum = 0.0;
        for (int k = 0; k < CELLS; ++k) sum += shares_of[i][k];
        if (!(fabs(sum - 1.0) < quadrature_error(&mapping_cases[i])))
            fail_msg("%s (case %zu): the integral is %.9f", sf_mapping_name(mapping_cases[i].mapping), i, sum);
    }
}

static size_t case_of(sf_mapping mapping) {
    for (size_t i = 0; i < CASE_COUNT; ++i)
        if (mapping_cases[i].mapping == mapping) return i;
    fail_msg("no case of %s", sf_mapping_name(mapping));
    return 0;
}

static void test_the_naive_disk_fails_the_test_of_a_uniform_disk(void **state) {
    (void)state;
    const double *counts = counts_of[case_of(SF_MAPPING_DISK_NAIVE)];
    assert_true(chi_square_p(counts, shares_of[case_of(SF_MAPPING_DISK_POLAR)]) < 1e-12);
}

static void test_a_density_wrong_by_one_percent_fails(void **state) {
    (void)state;
    for (size_t i = 0; i < CASE_COUNT; ++i) {
        double wrong[CELLS], sum = 0.0;
        for (int k = 0; k < CELLS; ++k) sum += wrong[k] = shares_of[i][k] * ((k + k / SIDE) % 2 ? 1.01 : 0.99);
        for (int k = 0; k < CELLS; ++k) wrong[k] /= sum;
        double p = chi_square_p(counts_of[i], wrong);
        if (!(p < SIGNIFICANCE / (double)CASE_COUNT))
            fail_msg("%s (case %zu): p = %g", sf_mapping_name(mapping_cases[i].mapping), i, p);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_samples_have_the_density_that_the_pdf_states),
        cmocka_unit_test(test_each_pdf_integrates_to_one),
        cmocka_unit_test(test_the_naive_disk_fails_the_test_of_a_uniform_disk),
        cmocka_unit_test(test_a_density_wrong_by_one_percent_fails),
    };
    return cmocka_run_group_tests(tests, prepare, NULL);
}
