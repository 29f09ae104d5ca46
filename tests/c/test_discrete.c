// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Alias tables and piecewise constant densities: the exact shares they give, what weight 0 never
 * gets, round trips, refusals. */

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sunfleck/discrete.h"
#include "sunfleck/elementary.h"

static void expect_refused(sf_status status, const sf_error *error, const char *text) {
    assert_int_equal(status, SF_STATUS_INVALID_VALUE);
    if (!strstr(error->message, text)) fail_msg("\"%s\" does not say \"%s\"", error->message, text);
}

/* n weights of several kinds: equal, one heavy, many zeros, a span of 10^20. */
static void make_weights(int kind, size_t n, double *w) {
    for (size_t i = 0; i < n; ++i) {
        double u = sf_double_from_bits(sf_hash64((uint64_t)kind, i));
        w[i] = kind == 0   ? 1.0
               : kind == 1 ? (i == n / 2 ? 1e6 : u)
               : kind == 2 ? (u < 0.7 ? 0.0 : u)
                           : pow(10.0, 20.0 * u - 10.0);
    }
    w[n / 3] = 1.0;
    if (kind == 2) w[0] = w[n - 1] = n > 3 ? 0.0 : 1.0;
}

/* ---- alias ---- */

/* What a table gives each entry, exactly: its own part and the rests of the columns that lead to it. */
static void shares_of(const float *keep, const uint32_t *alias, size_t n, double *share) {
    for (size_t i = 0; i < n; ++i) share[i] = 0.0;
    for (size_t i = 0; i < n; ++i) {
        share[i] += (double)keep[i] / (double)n;
        share[alias[i]] += (1.0 - (double)keep[i]) / (double)n;
    }
}

static void test_an_alias_table_gives_every_entry_its_share(void **state) {
    (void)state;
    const size_t counts[] = {1, 2, 3, 7, 100, 5000};
    for (int kind = 0; kind < 4; ++kind)
        for (int k = 0; k < 6; ++k) {
            size_t n = counts[k];
            double *w = malloc(n * sizeof *w), *share = malloc(n * sizeof *share), total = 0.0;
            float *keep = malloc(n * sizeof *keep);
            uint32_t *alias = malloc(n * sizeof *alias);
            make_weights(kind, n, w);
            assert_int_equal(sf_alias_build(w, n, keep, alias, NULL), SF_STATUS_OK);
            shares_of(keep, alias, n, share);
            for (size_t i = 0; i < n; ++i) total += w[i];
            for (size_t i = 0; i < n; ++i) {
                /* Every keep is rounded by 2^-25 at most; a heavy entry has up to n of them over it. */
                assert_true(fabs(share[i] - w[i] / total) <=
                            0x1p-25 * fmin(1.0, (1.0 + (double)n * w[i] / total) / (double)n) + 1e-14);
                if (w[i] == 0.0) assert_true(share[i] == 0.0);
            }
            free(w);
            free(share);
            free(keep);
            free(alias);
        }
}

static void test_entries_of_weight_0_are_never_drawn(void **state) {
    (void)state;
    double w[1000];
    sf_alias_table *table;
    make_weights(2, 1000, w);
    assert_int_equal(sf_alias_table_create(w, 1000, &table, NULL, NULL), SF_STATUS_OK);
    assert_int_equal(sf_alias_table_count(table), 1000);
    for (uint32_t i = 0; i < 1 << 16; ++i) {
        float u = i == 0 ? SF_UNIT_MAX_F : (float)i * 0x1p-16f;
        double wide = i == 0 ? SF_UNIT_MAX : (double)u;
        uint32_t index[2];
        assert_int_equal(sf_alias_table_sample_fill_f32(table, 1, &u, index, NULL), SF_STATUS_OK);
        assert_int_equal(sf_alias_table_sample_fill_f64(table, 1, &wide, index + 1, NULL), SF_STATUS_OK);
        assert_true(w[index[0]] > 0.0 && w[index[1]] > 0.0);
    }
    sf_alias_table_destroy(table);
    sf_alias_table_destroy(NULL);
}

static void test_what_u_has_left_is_uniform(void **state) {
    (void)state;
    const double w[5] = {0.5, 3.0, 1.0, 0.0, 0.25};
    float keep[5];
    uint32_t alias[5];
    double sum[5] = {0}, square[5] = {0}, count[5] = {0};
    sf_alias_build(w, 5, keep, alias, NULL);
    for (uint32_t i = 0; i < 1 << 20; ++i) {
        float rest;
        uint32_t k = sf_alias_pick(keep, alias, 5, (float)i * 0x1p-20f, &rest);
        assert_true(rest >= 0.0f && rest < 1.0f);
        sum[k] += (double)rest;
        square[k] += (double)rest * (double)rest;
        count[k] += 1.0;
    }
    for (int k = 0; k < 5; ++k) {
        assert_true(fabs(count[k] * 0x1p-20 - w[k] / 4.75) < 1e-5);
        /* Equidistant values in at most four runs: within a few spacings of 1/2 and 1/3. */
        if (count[k] > 0.0)
            assert_true(fabs(sum[k] / count[k] - 0.5) < 1e-4 && fabs(square[k] / count[k] - 1.0 / 3.0) < 1e-4);
    }
}

static void test_the_inverse_of_an_index_leads_back_to_it(void **state) {
    (void)state;
    double w[1000], u[1000], pdf[1000], total = 0.0, sum = 0.0;
    uint32_t index[1000], back[1000];
    sf_alias_table *table;
    make_weights(3, 1000, w);
    sf_alias_table_create(w, 1000, &table, NULL, NULL);
    for (uint32_t i = 0; i < 1000; ++i) index[i] = i;
    for (int i = 0; i < 1000; ++i) total += w[i];
    assert_int_equal(sf_alias_table_invert_fill(table, 1000, index, u, NULL), SF_STATUS_OK);
    assert_int_equal(sf_alias_table_sample_fill_f64(table, 1000, u, back, NULL), SF_STATUS_OK);
    assert_memory_equal(index, back, sizeof index);
    assert_int_equal(sf_alias_table_pdf_fill(table, 1000, index, pdf, NULL), SF_STATUS_OK);
    for (int i = 0; i < 1000; ++i) {
        assert_true(fabs(pdf[i] * total / w[i] - 1.0) < 1e-12);
        sum += pdf[i];
    }
    assert_true(fabs(sum - 1.0) < 1e-12);
    sf_alias_table_destroy(table);
}

static void test_bad_weights_are_refused_by_place_and_value(void **state) {
    (void)state;
    const double negative[3] = {1, -2, 3}, nan[3] = {1, 2, NAN}, none[2] = {0, 0}, good[2] = {0, 1};
    sf_alias_table *table;
    sf_piecewise *piecewise;
    sf_error error;
    expect_refused(sf_alias_table_create(negative, 3, &table, NULL, &error), &error,
                   "weights[1] is -2; it must be finite");
    expect_refused(sf_alias_table_create(nan, 3, &table, NULL, &error), &error, "weights[2] is nan");
    expect_refused(sf_alias_table_create(none, 2, &table, NULL, &error), &error, "all 2 weights are 0");
    expect_refused(sf_alias_build(good, 0, NULL, NULL, &error), &error, "count is 0");
    expect_refused(sf_piecewise_create_1d(negative, 3, &piecewise, NULL, &error), &error, "weights[1] is -2");
    expect_refused(sf_piecewise_create_2d(none, 2, 1, &piecewise, NULL, &error), &error, "all 2 weights");
    expect_refused(sf_piecewise_create_2d(good, 0, 2, &piecewise, NULL, &error), &error,
                   "0 x 2 cells; each must be 1 .. 2^24");
    assert_null(piecewise);
    sf_piecewise_destroy(NULL);
}

static void test_bad_points_are_refused_before_anything_is_written(void **state) {
    (void)state;
    const double good[2] = {0, 1};
    const float u[3] = {0.5f, 1.0f, 0.2f};
    const double wide[2] = {0.5, NAN};
    uint32_t index[3] = {9, 9, 9}, out_of_range = 2, zero = 0;
    float x[3] = {-7, -7, -7};
    double y[2] = {-7, -7};
    sf_alias_table *table;
    sf_piecewise *line;
    sf_error error;
    sf_alias_table_create(good, 2, &table, NULL, NULL);
    sf_piecewise_create_1d(good, 2, &line, NULL, NULL);
    expect_refused(sf_alias_table_sample_fill_f32(table, 3, u, index, &error), &error,
                   "value 1 of u is 1; it must be in [0,1)");
    expect_refused(sf_alias_table_sample_fill_f64(table, 2, wide, index, &error), &error, "nan");
    expect_refused(sf_alias_table_pdf_fill(table, 1, &out_of_range, y, &error), &error,
                   "index 0 is 2; it must be 0 .. 1");
    expect_refused(sf_alias_table_invert_fill(table, 1, &zero, y, &error), &error, "weight is 0");
    expect_refused(sf_piecewise_sample_fill_f32(line, 3, u, x, &error), &error, "value 1 of u is 1");
    expect_refused(sf_piecewise_pdf_fill_f64(line, 2, wide, y, &error), &error, "value 1 of x is nan");
    assert_true(index[0] == 9 && x[0] == -7.0f && y[0] == -7.0);
    sf_alias_table_destroy(table);
    sf_piecewise_destroy(line);
}

/* ---- piecewise ---- */

static void test_a_line_gives_every_cell_its_share(void **state) {
    (void)state;
    const size_t counts[] = {1, 2, 3, 7, 100, 5000};
    enum { POINTS = 1 << 17 };
    double *u = malloc(POINTS * sizeof *u), *x = malloc(POINTS * sizeof *x), *pdf = malloc(POINTS * sizeof *pdf);
    for (size_t i = 0; i < POINTS; ++i) u[i] = ((double)i + 0.5) / POINTS;
    for (int kind = 0; kind < 4; ++kind)
        for (int k = 0; k < 6; ++k) {
            size_t n = counts[k];
            double *w = malloc(n * sizeof *w), *hits = calloc(n, sizeof *hits), total = 0.0;
            sf_piecewise *line;
            make_weights(kind, n, w);
            for (size_t i = 0; i < n; ++i) total += w[i];
            assert_int_equal(sf_piecewise_create_1d(w, n, &line, NULL, NULL), SF_STATUS_OK);
            assert_int_equal(sf_piecewise_sample_fill_f64(line, POINTS, u, x, NULL), SF_STATUS_OK);
            assert_int_equal(sf_piecewise_pdf_fill_f64(line, POINTS, x, pdf, NULL), SF_STATUS_OK);
            for (size_t i = 0; i < POINTS; ++i) {
                size_t cell = (size_t)(x[i] * (double)n);
                assert_true(x[i] >= 0.0 && x[i] < 1.0 && (i == 0 || x[i] >= x[i - 1]));
                assert_true(w[cell] > 0.0 &&
                            fabs(pdf[i] * total / (w[cell] * (double)n) - 1.0) < 1e-9 + 1e-15 * total / w[cell]);
                hits[cell] += 1.0;
            }
            /* Equidistant u: a cell's hits are its share, but for one at either end. */
            for (size_t i = 0; i < n; ++i) assert_true(fabs(hits[i] - POINTS * w[i] / total) <= 1.001);
            sf_piecewise_destroy(line);
            free(w);
            free(hits);
        }
    free(u);
    free(x);
    free(pdf);
}

static void test_a_grid_comes_back_and_keeps_off_cells_of_weight_0(void **state) {
    (void)state;
    enum { COLUMNS = 13, ROWS = 7, POINTS = 20000 };
    static double w[ROWS * COLUMNS], u[2 * POINTS], x[2 * POINTS], back[2 * POINTS];
    static float fu[2 * POINTS], fx[2 * POINTS], pdf[POINTS];
    sf_piecewise *grid;
    make_weights(2, ROWS * COLUMNS, w);
    for (int c = 0; c < COLUMNS; ++c) w[3 * COLUMNS + c] = 0.0; /* a dark row */
    assert_int_equal(sf_piecewise_create_2d(w, COLUMNS, ROWS, &grid, NULL, NULL), SF_STATUS_OK);
    assert_int_equal(sf_piecewise_width(grid), 2);
    for (size_t i = 0; i < 2 * POINTS; ++i) {
        fu[i] = i < 4 ? (i < 2 ? 0.0f : SF_UNIT_MAX_F) : sf_float_from_bits((uint32_t)(sf_hash64(6, i) >> 32));
        u[i] = i < 4 ? (i < 2 ? 0.0 : SF_UNIT_MAX) : sf_double_from_bits(sf_hash64(6, i));
    }
    assert_int_equal(sf_piecewise_sample_fill_f64(grid, POINTS, u, x, NULL), SF_STATUS_OK);
    assert_int_equal(sf_piecewise_invert_fill_f64(grid, POINTS, x, back, NULL), SF_STATUS_OK);
    assert_int_equal(sf_piecewise_sample_fill_f32(grid, POINTS, fu, fx, NULL), SF_STATUS_OK);
    assert_int_equal(sf_piecewise_pdf_fill_f32(grid, POINTS, fx, pdf, NULL), SF_STATUS_OK);
    for (size_t i = 0; i < POINTS; ++i) {
        assert_true(w[(size_t)(x[2 * i + 1] * ROWS) * COLUMNS + (size_t)(x[2 * i] * COLUMNS)] > 0.0);
        assert_true(w[(size_t)(fx[2 * i + 1] * ROWS) * COLUMNS + (size_t)(fx[2 * i] * COLUMNS)] > 0.0);
        assert_true(pdf[i] > 0.0f && fx[2 * i] < 1.0f && fx[2 * i + 1] < 1.0f);
        /* x is rounded by 2^-53 and u changes by the density, at most COLUMNS, times that. */
        for (int k = 0; k < 2; ++k) assert_true(fabs(back[2 * i + k] - u[2 * i + k]) <= 4.0 * COLUMNS * 0x1p-53);
    }
    sf_piecewise_destroy(grid);
}

static void test_the_density_of_a_grid_has_mean_one(void **state) {
    (void)state;
    enum { COLUMNS = 5, ROWS = 4 };
    double w[ROWS * COLUMNS], sum = 0.0;
    sf_piecewise *grid;
    make_weights(1, ROWS * COLUMNS, w);
    sf_piecewise_create_2d(w, COLUMNS, ROWS, &grid, NULL, NULL);
    for (int i = 0; i < ROWS * COLUMNS; ++i) {
        double x[2] = {(i % COLUMNS + 0.5) / COLUMNS, (i / COLUMNS + 0.5) / ROWS}, pdf;
        sf_piecewise_pdf_fill_f64(grid, 1, x, &pdf, NULL);
        sum += pdf / (ROWS * COLUMNS);
    }
    assert_true(fabs(sum - 1.0) < 1e-12);
    sf_piecewise_destroy(grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_an_alias_table_gives_every_entry_its_share),
        cmocka_unit_test(test_entries_of_weight_0_are_never_drawn),
        cmocka_unit_test(test_what_u_has_left_is_uniform),
        cmocka_unit_test(test_the_inverse_of_an_index_leads_back_to_it),
        cmocka_unit_test(test_bad_weights_are_refused_by_place_and_value),
        cmocka_unit_test(test_bad_points_are_refused_before_anything_is_written),
        cmocka_unit_test(test_a_line_gives_every_cell_its_share),
        cmocka_unit_test(test_a_grid_comes_back_and_keeps_off_cells_of_weight_0),
        cmocka_unit_test(test_the_density_of_a_grid_has_mean_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
