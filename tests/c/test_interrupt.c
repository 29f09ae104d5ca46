// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* interrupt: work in pieces, callers that stop it, and fills that keep threads and tables between them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/platform.h"
#include "sunfleck/discrete.h"
#include "sunfleck/estimate.h"
#include "sunfleck/points.h"
#include "sunfleck/uniformity.h"

/* ---- pieces ---- */

typedef struct record {
    size_t next, pieces, smallest, total;
    int fails, asked, stops;
    double seconds;
} record;

static sf_status take_piece(void *user, size_t first, size_t count, sf_error *error) {
    (void)error;
    record *r = user;
    assert_int_equal(first, r->next);
    assert_true(count % r->smallest == 0 || first + count == r->total);
    r->next += count;
    ++r->pieces;
    for (double begun = sf_seconds_now(); sf_seconds_now() - begun < r->seconds;) continue;
    return r->fails && r->pieces == 3 ? SF_STATUS_IO : SF_STATUS_OK;
}

static int stop_at_second(void *user) {
    record *r = user;
    return ++r->asked == 2 && r->stops;
}

static void test_pieces_cover_the_work_in_order(void **state) {
    (void)state;
    record r = {.smallest = 7, .total = 1000003};
    sf_interrupt interrupt = {stop_at_second, &r};
    assert_int_equal(sf_work_in_pieces(r.total, 7, take_piece, &r, &interrupt, NULL), SF_STATUS_OK);
    assert_int_equal(r.next, r.total);
    assert_in_range(r.pieces, 2, 30); /* they double */
    r = (record){.smallest = 7, .total = 1000003};
    assert_int_equal(sf_work_in_pieces(r.total, 7, take_piece, &r, NULL, NULL), SF_STATUS_OK);
    assert_int_equal(r.pieces, 1);
}

/* Items that take no time of the processor, as where threads of a team do the work. */
static sf_status sleep_for_each(void *user, size_t first, size_t count, sf_error *error) {
    (void)first;
    (void)error;
    double *longest = user, begun = sf_seconds_now();
    struct timespec nap = {0, 100000};
    for (size_t i = 0; i < count; ++i) nanosleep(&nap, NULL);
    double seconds = sf_seconds_now() - begun;
    *longest = seconds > *longest ? seconds : *longest;
    return SF_STATUS_OK;
}

static void test_pieces_stay_short_where_the_caller_waits(void **state) {
    (void)state;
    double longest = 0;
    record r = {.stops = 0};
    sf_interrupt interrupt = {stop_at_second, &r};
    assert_int_equal(sf_work_in_pieces(8192, 1, sleep_for_each, &longest, &interrupt, NULL), SF_STATUS_OK);
    assert_true(longest < 0.35); /* by the processor's time alone pieces double up to 4,096 items, 0.6 s */
    assert_true(r.asked > 5);
}

static void test_pieces_stop_where_one_fails_or_the_caller_says_so(void **state) {
    (void)state;
    sf_error error;
    record r = {.smallest = 1, .total = 1000000, .fails = 1, .seconds = 5e-3};
    sf_interrupt interrupt = {stop_at_second, &r};
    assert_int_equal(sf_work_in_pieces(r.total, 1, take_piece, &r, &interrupt, &error), SF_STATUS_IO);
    assert_int_equal(r.pieces, 3);
    r = (record){.smallest = 1, .total = 1000000, .stops = 1, .seconds = 5e-3};
    assert_int_equal(sf_work_in_pieces(r.total, 1, take_piece, &r, &interrupt, &error), SF_STATUS_INTERRUPTED);
    assert_string_equal(error.message, "interrupted by the caller");
    assert_int_equal(error.status, SF_STATUS_INTERRUPTED);
    assert_int_equal(r.asked, 2);
    assert_in_range(r.pieces, 2, 20);
}

/* ---- work that is asked from inside ---- */

static int stop_at_once(void *user) {
    ++*(int *)user;
    return 1;
}

/* Points whose every measure takes longer than 25 ms, by far. */
enum { MANY = 1 << 15, WIDE = 16 };

static double *many_points(void) {
    sf_points_options o = sf_points_options_default();
    o.dims = WIDE;
    double *x = malloc((size_t)MANY * WIDE * sizeof *x);
    assert_non_null(x);
    assert_int_equal(sf_points_fill_f64(&o, MANY, x, NULL), SF_STATUS_OK);
    return x;
}

static void test_measures_stop_and_write_nothing(void **state) {
    (void)state;
    double *x = many_points(), a = -1.0, b = -1.0;
    uint32_t t = 99;
    int asked = 0;
    sf_error error;
    sf_interrupt now = {stop_at_once, &asked};
    for (uint32_t threads = 1; threads <= 3; ++threads) {
        assert_int_equal(sf_discrepancy(SF_DISCREPANCY_CENTERED, x, MANY, WIDE, threads, &a, &now, &error),
                         SF_STATUS_INTERRUPTED);
        assert_int_equal(sf_minimum_distance(x, MANY, WIDE, 1, threads, &a, &now, &error), SF_STATUS_INTERRUPTED);
        assert_int_equal(sf_net_t_value(x, MANY, WIDE, 2, 0, threads, &t, &now, &error), SF_STATUS_INTERRUPTED);
    }
    assert_int_equal(sf_star_discrepancy(x, MANY, WIDE, 1 << 14, &a, &b, &now, &error), SF_STATUS_INTERRUPTED);
    assert_int_equal(sf_star_discrepancy(x, MANY, 2, 1, &a, &b, &now, &error), SF_STATUS_INTERRUPTED);
    assert_int_equal(sf_betting_interval_f64((size_t)MANY * WIDE, x, 0.0, 1.0, 0.95, &a, &b, &now, &error),
                     SF_STATUS_INTERRUPTED);
    assert_int_equal(asked, 3 * 3 + 3);
    assert_true(a == -1.0 && b == -1.0 && t == 99);
    free(x);
}

static void test_an_order_of_many_points_is_that_of_few(void **state) {
    (void)state;
    /* 2^16 + 1 points and more are sorted in runs; two that are nearest lie in different ones. */
    enum { N = 200000 };
    double *x = malloc(N * sizeof *x), distance;
    assert_non_null(x);
    for (size_t i = 0; i < N; ++i) x[i] = (double)(i * 7919 % N) / N;
    x[N - 1] = x[0] + 0x1p-30;
    assert_int_equal(sf_minimum_distance(x, N, 1, 0, 1, &distance, NULL, NULL), SF_STATUS_OK);
    assert_true(distance == x[N - 1] - x[0]);
    free(x);
}

static void test_tables_stop_and_are_not_made(void **state) {
    (void)state;
    enum { N = 1 << 22 };
    double *weights = malloc(N * sizeof *weights);
    assert_non_null(weights);
    for (size_t i = 0; i < N; ++i) weights[i] = (double)(i % 5);
    int asked = 0;
    sf_interrupt now = {stop_at_once, &asked};
    sf_alias_table *table;
    sf_piecewise *density;
    assert_int_equal(sf_alias_table_create(weights, N, &table, &now, NULL), SF_STATUS_INTERRUPTED);
    assert_int_equal(sf_piecewise_create_2d(weights, N >> 8, 1 << 8, &density, &now, NULL), SF_STATUS_INTERRUPTED);
    assert_true(!table && !density && asked == 2);
    free(weights);
}

static void test_moments_in_pieces_are_those_of_the_array(void **state) {
    (void)state;
    double *x = many_points();
    size_t rows = (size_t)MANY * WIDE / 3;
    sf_block_moments blocks;
    sf_moments whole = {0}, pieces = {0};
    sf_vector_moments whole_rows = {0}, piece_rows = {0};
    x[12345] = (double)INFINITY;
    sf_moments_add_f64(&whole, 3 * rows, x);
    sf_vector_moments_add_f64(&whole_rows, rows, x);
    for (size_t step = 256; step <= 1 << 14; step *= 4) {
        pieces = (sf_moments){0};
        piece_rows = (sf_vector_moments){0};
        sf_block_moments_begin(&blocks);
        for (size_t i = 0; i < 3 * rows; i += step)
            sf_block_moments_add_f64(&blocks, 3 * rows - i < step ? 3 * rows - i : step, x + i);
        sf_moments_merge_blocks(&pieces, &blocks);
        assert_memory_equal(&pieces, &whole, sizeof whole);
        sf_block_moments_begin(&blocks);
        for (size_t i = 0; i < rows; i += step)
            sf_block_moments_add_rows_f64(&blocks, rows - i < step ? rows - i : step, x + 3 * i);
        sf_vector_moments_merge_blocks(&piece_rows, &blocks);
        assert_memory_equal(&piece_rows, &whole_rows, sizeof whole_rows);
    }
    free(x);
}

/* ---- the filler ---- */

enum { ROWS = 100003, DIMS = 3 };
static float plain[ROWS * DIMS], filled[ROWS * DIMS];

static int go_on(void *user) {
    (void)user;
    return 0;
}

static void assert_fills_alike(sf_point_filler *filler, const sf_points_options *options) {
    sf_interrupt interrupt = {go_on, NULL};
    assert_int_equal(sf_points_fill_f32(options, ROWS, plain, NULL), SF_STATUS_OK);
    memset(filled, 0, sizeof filled);
    assert_int_equal(sf_point_filler_fill_f32(filler, options, ROWS, filled, &interrupt, NULL), SF_STATUS_OK);
    assert_memory_equal(filled, plain, sizeof plain);
}

static void test_a_filler_gives_the_bits_of_a_fill(void **state) {
    (void)state;
    static const sf_pattern patterns[] = {SF_PATTERN_SOBOL, SF_PATTERN_HALTON, SF_PATTERN_LATIN, SF_PATTERN_RANDOM};
    sf_point_filler *filler;
    assert_int_equal(sf_point_filler_create(&filler, NULL), SF_STATUS_OK);
    for (unsigned k = 0; k < 16; ++k) {
        sf_points_options o = sf_points_options_default();
        o.dims = DIMS;
        o.pattern = patterns[k / 2 % 4]; /* each twice in a row, the tables kept or not */
        o.seed = k / 4;
        o.first = k & 1 ? 1000 : 0;
        o.threads = k % 3;
        assert_fills_alike(filler, &o);
    }
    sf_point_filler_destroy(filler);
    sf_point_filler_destroy(NULL);
}

static void test_a_filler_refuses_as_a_fill_does(void **state) {
    (void)state;
    sf_point_filler *filler;
    sf_error one, other;
    assert_int_equal(sf_point_filler_create(&filler, NULL), SF_STATUS_OK);
    for (int k = 0; k < 3; ++k) {
        sf_points_options o = sf_points_options_default();
        if (k == 0) o.dims = 0;
        if (k == 1) o.first = UINT64_C(1) << 32;
        if (k == 2) o.scramble = SF_SCRAMBLE_PERMUTED;
        sf_status status = sf_points_fill_f32(&o, 1, plain, &one);
        assert_int_equal(status, SF_STATUS_INVALID_VALUE);
        assert_int_equal(sf_point_filler_fill_f32(filler, &o, 1, filled, NULL, &other), status);
        assert_string_equal(other.message, one.message);
    }
    sf_point_filler_destroy(filler);
}

static void test_a_forked_child_goes_on_with_its_parents_filler(void **state) {
    (void)state;
#ifdef __SANITIZE_THREAD__
    skip(); /* it allows no threads after the fork of a process that has some */
#endif
    sf_point_filler *filler;
    assert_int_equal(sf_point_filler_create(&filler, NULL), SF_STATUS_OK);
    sf_points_options o = sf_points_options_default();
    o.dims = DIMS;
    o.threads = 2;
    assert_fills_alike(filler, &o);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        alarm(60); /* the parent's threads are not here to be waited for */
        o.seed = 5;
        sf_status status = sf_point_filler_fill_f32(filler, &o, ROWS, filled, NULL, NULL);
        o.threads = 1;
        if (!status) status = sf_points_fill_f32(&o, ROWS, plain, NULL);
        int differs = memcmp(filled, plain, sizeof plain) != 0;
        sf_point_filler_destroy(filler);
        _exit(status || differs);
    }
    int result;
    assert_int_equal(waitpid(child, &result, 0), child);
    assert_true(WIFEXITED(result) && WEXITSTATUS(result) == 0);
    assert_fills_alike(filler, &o);
    sf_point_filler_destroy(filler);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pieces_cover_the_work_in_order),
        cmocka_unit_test(test_pieces_stay_short_where_the_caller_waits),
        cmocka_unit_test(test_pieces_stop_where_one_fails_or_the_caller_says_so),
        cmocka_unit_test(test_measures_stop_and_write_nothing),
        cmocka_unit_test(test_an_order_of_many_points_is_that_of_few),
        cmocka_unit_test(test_tables_stop_and_are_not_made),
        cmocka_unit_test(test_moments_in_pieces_are_those_of_the_array),
        cmocka_unit_test(test_a_filler_gives_the_bits_of_a_fill),
        cmocka_unit_test(test_a_filler_refuses_as_a_fill_does),
        cmocka_unit_test(test_a_forked_child_goes_on_with_its_parents_filler),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
