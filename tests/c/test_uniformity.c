// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <math.h>

#include "sunfleck/points.h"
#include "sunfleck/uniformity.h"

static double uniform(uint64_t i) { return sf_double_from_bits(sf_mix64(i + 1)); }

static void fill_random(double *x, size_t values, uint64_t seed) {
    for (size_t i = 0; i < values; ++i) x[i] = sf_double_from_bits(sf_hash64(seed, i));
}

static void fill_pattern(double *x, sf_pattern pattern, sf_scramble scramble, size_t count, uint32_t dims) {
    sf_points_options options = sf_points_options_default();
    options.pattern = pattern;
    options.scramble = scramble;
    options.dims = dims;
    options.seed = 3;
    assert_int_equal(sf_points_fill_f64(&options, count, x, NULL), SF_STATUS_OK);
}

static double discrepancy_of(sf_discrepancy_kind kind, const double *x, size_t count, uint32_t dims) {
    double value = NAN;
    assert_int_equal(sf_discrepancy(kind, x, count, dims, 1, &value, NULL, NULL), SF_STATUS_OK);
    return value;
}

static void expect_near(double x, double expected, double tolerance) {
    if (!(fabs(x - expected) <= tolerance)) fail_msg("%.17g, expected %.17g within %.1e", x, expected, tolerance);
}

/* ---- discrepancies ---- */

static void test_centered_discrepancy_meets_scipys_documented_values(void **state) {
    (void)state;
    /* scipy.stats.qmc.Sobol, d = 2, unscrambled, 8 points: 0.013882107204860938; the example of
     * scipy.stats.qmc.discrepancy, six points scaled from [0.5, 6.5]: 0.008142039609053464. */
    static const double sobol[] = {0, 0, .5, .5, .75, .25, .25, .75, .375, .375, .875, .875, .625, .125, .125, .625};
    double six[] = {1, 3, 2, 6, 3, 2, 4, 5, 5, 1, 6, 4};
    for (int i = 0; i < 12; ++i) six[i] = (six[i] - 0.5) / 6.0;
    expect_near(discrepancy_of(SF_DISCREPANCY_CENTERED, sobol, 8, 2), 0.013882107204860938, 1e-15);
    expect_near(discrepancy_of(SF_DISCREPANCY_CENTERED, six, 6, 2), 0.008142039609053464, 1e-15);
}

static void test_in_one_dimension_centered_and_l2_star_are_the_integral_of_the_squared_difference(void **state) {
    (void)state;
    /* Integral of (F(x) - x)^2 = 1 / (12 n^2) + (1/n) sum (x_i - (2i-1) / (2n))^2, x_i rising. */
    double x[100], integral = 1.0 / (12.0 * 100 * 100);
    for (int i = 0; i < 100; ++i) {
        x[i] = (i + uniform((uint64_t)i)) / 100.0;
        integral += (x[i] - (2 * i + 1) / 200.0) * (x[i] - (2 * i + 1) / 200.0) / 100.0;
    }
    /* Differences of terms near 1, each a mean of 10^4 roundings of 2^-53. */
    expect_near(discrepancy_of(SF_DISCREPANCY_CENTERED, x, 100, 1), integral, 1e-14);
    double star = discrepancy_of(SF_DISCREPANCY_L2_STAR, x, 100, 1);
    expect_near(star * star, integral, 1e-14);
}

static void test_wraparound_discrepancy_of_a_lattice_is_its_closed_form(void **state) {
    (void)state;
    /* -4/3 + (1/n) sum (3/2 - k/n (1 - k/n)) = 1 / (6 n^2), wherever the lattice starts. */
    for (int n = 1; n <= 300; n += 23) {
        double x[300];
        for (int i = 0; i < n; ++i) x[i] = (i + 0.3) / n;
        expect_near(discrepancy_of(SF_DISCREPANCY_WRAPAROUND, x, (size_t)n, 1), 1.0 / (6.0 * n * n), 1e-14);
    }
}

static void test_l2_star_of_random_points_has_its_expectation(void **state) {
    (void)state;
    /* E = (2^-d - 3^-d) / n. 200 sets: the mean of the squares, relative deviation about 0.5 of a
     * set (measured), 0.035 of the mean; four of them. */
    double x[64 * 3], mean = 0.0;
    for (uint64_t seed = 0; seed < 200; ++seed) {
        fill_random(x, 64 * 3, seed);
        double star = discrepancy_of(SF_DISCREPANCY_L2_STAR, x, 64, 3);
        mean += star * star / 200.0;
    }
    double expected = (1.0 / 8.0 - 1.0 / 27.0) / 64.0;
    expect_near(mean, expected, 0.14 * expected);
}

static void test_sobol_is_more_even_than_random_by_every_kind(void **state) {
    (void)state;
    static double sobol[1024 * 4], random[1024 * 4];
    fill_pattern(sobol, SF_PATTERN_SOBOL, SF_SCRAMBLE_OWEN, 1024, 4);
    fill_random(random, 1024 * 4, 1);
    for (int kind = 0; kind < SF_DISCREPANCY_KIND_COUNT; ++kind) {
        double better = discrepancy_of((sf_discrepancy_kind)kind, sobol, 1024, 4);
        assert_true(better < 0.5 * discrepancy_of((sf_discrepancy_kind)kind, random, 1024, 4));
    }
}

/* ---- star discrepancy ---- */

/* By its definition, over every box whose sides are coordinates or 1; dims at most 3. */
static double star_by_definition(const double *x, size_t count, uint32_t dims) {
    double best = 0.0;
    size_t sides = count + 1, boxes = 1;
    for (uint32_t k = 0; k < dims; ++k) boxes *= sides;
    for (size_t box = 0; box < boxes; ++box) {
        double side[3] = {1.0, 1.0, 1.0};
        for (size_t k = 0, rest = box; k < dims; ++k, rest /= sides)
            if (rest % sides < count) side[k] = x[rest % sides * dims + k];
        double open = 0.0, closed = 0.0, volume = side[0] * side[1] * side[2];
        for (size_t i = 0; i < count; ++i) {
            int below = 1, within = 1;
            for (uint32_t k = 0; k < dims; ++k) {
                below &= x[i * dims + k] < side[k];
                within &= x[i * dims + k] <= side[k];
            }
            open += below;
            closed += within;
        }
        best = fmax(best, fmax(volume - open / (double)count, closed / (double)count - volume));
    }
    return best;
}

static void test_star_discrepancy_is_its_definition_where_that_is_affordable(void **state) {
    (void)state;
    double x[3 * 24];
    for (uint32_t dims = 1; dims <= 3; ++dims)
        for (uint64_t seed = 0; seed < 12; ++seed) {
            size_t count = 1 + 2 * (size_t)seed;
            fill_random(x, count * dims, seed);
            /* Every other time with ties. */
            for (size_t i = 0; seed & 1 && i < count * dims; ++i) x[i] = floor(4.0 * x[i]) / 4.0;
            double lower, upper;
            assert_int_equal(sf_star_discrepancy(x, count, dims, 1, &lower, &upper, NULL, NULL), SF_STATUS_OK);
            expect_near(lower, star_by_definition(x, count, dims), 1e-14);
            assert_true(lower == upper);
        }
}

static void test_star_discrepancy_meets_closed_forms(void **state) {
    (void)state;
    double x[4096], lower, upper;
    /* Centres of a line: 1 / (2n). */
    for (int i = 0; i < 1000; ++i) x[i] = (i + 0.5) / 1000.0;
    sf_star_discrepancy(x, 1000, 1, 1, &lower, &upper, NULL, NULL);
    expect_near(lower, 1.0 / 2000.0, 1e-15);
    /* Corners of a k x k grid: the open box just below (1, 1) misses nothing but k^2 - (k-1)^2 of
     * its share; the closed one up to (1 - 1/k, 1 - 1/k) holds all of them. */
    for (int i = 0; i < 2025; ++i) {
        x[2 * i] = i % 45 / 45.0;
        x[2 * i + 1] = i / 45 / 45.0;
    }
    sf_star_discrepancy(x, 2025, 2, 1, &lower, &upper, NULL, NULL);
    expect_near(lower, 1.0 - 44.0 * 44.0 / 2025.0, 1e-15);
    assert_true(lower == upper);
}

static void test_star_bounds_hold_the_star_discrepancy(void **state) {
    (void)state;
    enum { SIDE = 16, COUNT = SIDE * SIDE * SIDE };
    static double x[COUNT * 3];
    double shift[SIDE], column[3 * SIDE];
    for (int j = 0; j < SIDE; ++j) shift[j] = (j + uniform((uint64_t)j)) / SIDE;
    for (int i = 0; i < COUNT; ++i) {
        x[3 * i] = shift[i % SIDE];
        x[3 * i + 1] = shift[i / SIDE % SIDE];
        x[3 * i + 2] = shift[i / SIDE / SIDE];
    }
    /* A product of one line, so that boxes with sides on the line say all. */
    double star = 0.0;
    for (int j = 0; j < SIDE; ++j) column[j] = shift[j];
    for (int a = 0; a <= SIDE; ++a)
        for (int b = 0; b <= SIDE; ++b)
            for (int c = 0; c <= SIDE; ++c) {
                double sides[3] = {a < SIDE ? column[a] : 1.0, b < SIDE ? column[b] : 1.0, c < SIDE ? column[c] : 1.0};
                double volume = sides[0] * sides[1] * sides[2];
                star = fmax(star, volume - a * b * c / (double)COUNT);
                if (a < SIDE && b < SIDE && c < SIDE)
                    star = fmax(star, (a + 1) * (b + 1) * (c + 1) / (double)COUNT - volume);
            }
    double last = 1.0;
    for (uint64_t boxes = 1; boxes <= 1 << 14; boxes *= 128) {
        double lower, upper;
        assert_int_equal(sf_star_discrepancy(x, COUNT, 3, boxes, &lower, &upper, NULL, NULL), SF_STATUS_OK);
        assert_true(lower <= star + 1e-14 && star <= upper + 1e-14);
        assert_true(upper - lower <= last);
        last = upper - lower;
    }
    assert_true(last < 0.06); /* the weight of 2^14 boxes in 3 dimensions, measured: 0.046 */
}

static void test_star_bounds_of_many_dimensions_are_honest(void **state) {
    (void)state;
    static double x[16 * 100];
    double lower, upper;
    assert_int_equal(sf_star_discrepancy(x, 16, 100, 1 << 16, &lower, &upper, NULL, NULL), SF_STATUS_OK);
    assert_true(lower == 1.0 && upper == 1.0); /* all points at the origin */
    fill_random(x, 16 * 100, 4);
    assert_int_equal(sf_star_discrepancy(x, 16, 100, 1 << 16, &lower, &upper, NULL, NULL), SF_STATUS_OK);
    assert_true(lower > 0.0 && lower < upper && upper == 1.0);
}

/* ---- nets ---- */

static uint32_t t_of(const double *x, size_t count, uint32_t dims, uint32_t base) {
    uint32_t t = 99;
    sf_error error = {0};
    if (sf_net_t_value(x, count, dims, base, 0, 1, &t, NULL, &error) != SF_STATUS_OK) fail_msg("%s", error.message);
    return t;
}

static void test_sobol_has_the_t_values_of_its_polynomials(void **state) {
    (void)state;
    /* t of the sequence is the sum over the polynomials of their degree less 1 (Sobol' 1967):
     * degrees 1, 2, 3, 3, 4 from the second dimension on. A net may do better, not worse, and
     * scrambling changes no t. */
    static const uint32_t most[] = {0, 0, 0, 1, 3, 5, 8};
    static double plain[1024 * 6], owen[1024 * 6];
    for (uint32_t dims = 1; dims <= 6; ++dims) {
        fill_pattern(plain, SF_PATTERN_SOBOL, SF_SCRAMBLE_NONE, 1024, dims);
        fill_pattern(owen, SF_PATTERN_SOBOL, SF_SCRAMBLE_OWEN, 1024, dims);
        uint32_t t = t_of(plain, 1024, dims, 2);
        assert_true(t <= most[dims] && (dims < 3 || t > 0));
        assert_int_equal(t_of(owen, 1024, dims, 2), t);
    }
}

/* The radical inverse of i, `levels` digits in `base`, as the nearest double. */
static double inverse(uint32_t i, uint32_t base, unsigned levels) {
    uint32_t reversed = 0, scale = 1;
    for (unsigned k = 0; k < levels; ++k, i /= base, scale *= base) reversed = reversed * base + i % base;
    return (double)reversed / (double)scale;
}

static void test_hammersley_is_a_net_with_t_0_in_its_own_base_only(void **state) {
    (void)state;
    static const struct {
        uint32_t base;
        unsigned levels;
        size_t count;
    } nets[] = {{2, 10, 1024}, {3, 6, 729}, {4, 5, 1024}, {5, 4, 625}, {7, 3, 343}, {16, 2, 256}};
    static double x[2 * 1024];
    for (int k = 0; k < 6; ++k) {
        for (uint32_t i = 0; i < nets[k].count; ++i) {
            x[2 * i] = (double)i / (double)nets[k].count;
            x[2 * i + 1] = inverse(i, nets[k].base, nets[k].levels);
        }
        assert_int_equal(t_of(x, nets[k].count, 2, nets[k].base), 0);
        /* Exchange two points' second coordinates across the middle: the finest intervals break. */
        double swapped = x[1];
        x[1] = x[2 * nets[k].count - 1];
        x[2 * nets[k].count - 1] = swapped;
        assert_true(t_of(x, nets[k].count, 2, nets[k].base) > 0);
    }
    for (uint32_t i = 0; i < 1024; ++i) {
        x[2 * i] = i / 1024.0;
        x[2 * i + 1] = inverse(i, 2, 10);
    }
    assert_true(t_of(x, 1024, 2, 4) <= 1); /* a (0,m,s)-net in base 2 has t at most 1 in base 4 */
}

/* Whether all intervals of the given numbers of binary digits hold the same number, by comparing
 * every point with every interval's border. */
static int shape_is_balanced(const double *x, size_t count, const uint32_t *digits, unsigned level) {
    for (uint32_t cell = 0; cell < 1u << level; ++cell) {
        size_t held = 0;
        for (size_t i = 0; i < count; ++i) {
            int inside = 1;
            for (uint32_t k = 0, rest = cell; k < 3; ++k) {
                double width = ldexp(1.0, -(int)digits[k]), low = (rest & ((1u << digits[k]) - 1)) * width;
                inside &= x[3 * i + k] >= low && x[3 * i + k] < low + width;
                rest >>= digits[k];
            }
            held += (size_t)inside;
        }
        if (held != count >> level) return 0;
    }
    return 1;
}

static uint32_t t_by_definition(const double *x, unsigned levels) {
    unsigned level = 0;
    for (int balanced = 1; balanced && level < levels;) {
        uint32_t d[3];
        for (d[0] = 0; d[0] <= level + 1; ++d[0])
            for (d[1] = 0; d[0] + d[1] <= level + 1; ++d[1]) {
                d[2] = level + 1 - d[0] - d[1];
                balanced &= shape_is_balanced(x, (size_t)1 << levels, d, level + 1);
            }
        level += (unsigned)balanced;
    }
    return levels - level;
}

static void test_t_value_is_its_definition(void **state) {
    (void)state;
    double x[3 * 64];
    unsigned seen = 0;
    fill_pattern(x, SF_PATTERN_SOBOL, SF_SCRAMBLE_OWEN, 64, 3);
    for (uint64_t step = 0; step < 60; ++step) {
        uint32_t t = t_by_definition(x, 6);
        assert_int_equal(t_of(x, 64, 3, 2), t);
        seen |= 1u << t;
        /* Replace one bit of a coordinate, ever higher, so that t rises on the way. */
        double *moved = &x[sf_hash64(7, step) % 192], bit = ldexp(1.0, -6 + (int)step / 10);
        *moved += fmod(*moved, 2.0 * bit) < bit ? bit : -bit;
    }
    assert_int_equal(seen, 0x7e); /* every t from 1 to 6 */
}

static void test_t_value_stops_at_the_effort_given_and_says_how_far_it_got(void **state) {
    (void)state;
    static double x[256 * 400];
    uint32_t t = 99;
    sf_error error;
    fill_pattern(x, SF_PATTERN_SOBOL, SF_SCRAMBLE_NONE, 256, 400);
    /* Level 1: 400 shapes of 256 * 400 steps; level 2: 80,200 of them, 8.2e9 > 2^30. */
    assert_int_equal(sf_net_t_value(x, 256, 400, 2, 1, 1, &t, NULL, &error), SF_STATUS_UNSUPPORTED);
    assert_non_null(strstr(error.message, "t is at most 7"));
    assert_int_equal(t, 99);
}

/* ---- minimum distance ---- */

static void test_minimum_distance_is_that_of_all_pairs(void **state) {
    (void)state;
    static double x[700 * 6];
    for (uint32_t dims = 1; dims <= 6; dims += dims)
        for (int toroidal = 0; toroidal < 2; ++toroidal)
            for (uint64_t seed = 0; seed < 4; ++seed) {
                size_t count = seed ? 700 : 2;
                fill_random(x, count * dims, seed);
                double least = INFINITY, distance;
                for (size_t i = 0; i < count; ++i)
                    for (size_t j = 0; j < i; ++j) {
                        double square = 0.0;
                        for (uint32_t k = 0; k < dims; ++k) {
                            double d = fabs(x[i * dims + k] - x[j * dims + k]);
                            if (toroidal) d = fmin(d, 1.0 - d);
                            square += d * d;
                        }
                        least = fmin(least, square);
                    }
                assert_int_equal(sf_minimum_distance(x, count, dims, toroidal, 2, &distance, NULL, NULL), SF_STATUS_OK);
                assert_true(distance == sqrt(least));
            }
}

static void test_opposite_sides_touch_on_the_torus_only(void **state) {
    (void)state;
    static const double x[] = {0.5, 0.0, 0.5, 0.875};
    double distance;
    sf_minimum_distance(x, 2, 2, 0, 1, &distance, NULL, NULL);
    assert_true(distance == 0.875);
    sf_minimum_distance(x, 2, 2, 1, 1, &distance, NULL, NULL);
    assert_true(distance == 0.125);
}

/* ---- all ---- */

/* Every measure of the same points, as bits to compare. */
static void measure_all(const double *x, size_t count, uint32_t threads, double *values) {
    uint32_t t;
    for (int kind = 0; kind < SF_DISCREPANCY_KIND_COUNT; ++kind)
        sf_discrepancy((sf_discrepancy_kind)kind, x, count, 3, threads, values++, NULL, NULL);
    for (int toroidal = 0; toroidal < 2; ++toroidal)
        sf_minimum_distance(x, count, 3, toroidal, threads, values++, NULL, NULL);
    sf_star_discrepancy(x, count, 3, 1000, values, values + 1, NULL, NULL);
    sf_net_t_value(x, count, 3, 2, 0, threads, &t, NULL, NULL);
    values[2] = t;
}

static void test_threads_and_levels_change_no_bit(void **state) {
    (void)state;
    enum { COUNT = 2048, MEASURES = 9 };
    static double x[COUNT * 3];
    double expected[MEASURES], values[MEASURES];
    fill_pattern(x, SF_PATTERN_SOBOL, SF_SCRAMBLE_OWEN, COUNT, 3);
    measure_all(x, COUNT, 1, expected);
    for (int level = 0; level <= (int)SF_ISA_AVX512; ++level) {
        setenv("SUNFLECK_ISA", sf_isa_name((sf_isa)level), 1);
        for (uint32_t threads = 0; threads <= 3; ++threads) {
            memset(values, 0, sizeof values);
            measure_all(x, COUNT, threads, values);
            assert_memory_equal(values, expected, sizeof values);
        }
    }
    unsetenv("SUNFLECK_ISA");
}

static void expect_refused(sf_status status, sf_status expected, const sf_error *error, const char *part) {
    assert_int_equal(status, expected);
    assert_int_equal(error->status, expected);
    if (!strstr(error->message, part)) fail_msg("\"%s\" does not say \"%s\"", error->message, part);
}

static void test_bad_points_are_named(void **state) {
    (void)state;
    double x[] = {0.5, 0.25, 0.75, 1.0, 0.0, NAN}, value, other;
    uint32_t t;
    sf_error e;
    const sf_status bad = SF_STATUS_INVALID_VALUE;
    expect_refused(sf_discrepancy(SF_DISCREPANCY_CENTERED, x, 3, 2, 1, &value, NULL, &e), bad, &e,
                   "coordinate 1 of point 2");
    expect_refused(sf_star_discrepancy(x, 2, 2, 10, &value, &other, NULL, &e), bad, &e, "coordinate 1 of point 1 is 1");
    expect_refused(sf_net_t_value(x, 2, 2, 2, 0, 1, &t, NULL, &e), bad, &e, "coordinate 1 of point 1 is 1");
    expect_refused(sf_minimum_distance(x, 3, 2, 0, 1, &value, NULL, &e), bad, &e, "nan");
    assert_int_equal(sf_discrepancy(SF_DISCREPANCY_CENTERED, x, 2, 2, 1, &value, NULL, &e),
                     SF_STATUS_OK); /* 1 is in [0,1] */
    x[0] = -0.001;
    expect_refused(sf_discrepancy(SF_DISCREPANCY_CENTERED, x, 2, 2, 1, &value, NULL, &e), bad, &e, "-0.001");
}

static void test_bad_options_are_named(void **state) {
    (void)state;
    static double x[2 * 25000];
    double value, other;
    uint32_t t;
    sf_discrepancy_kind kind;
    sf_error e;
    const sf_status bad = SF_STATUS_INVALID_VALUE;
    expect_refused(sf_discrepancy_kind_find("centred", &kind, &e), bad, &e, "centered, wraparound, mixture, l2-star");
    expect_refused(sf_discrepancy((sf_discrepancy_kind)9, x, 1, 1, 1, &value, NULL, &e), bad, &e, "9");
    expect_refused(sf_discrepancy(SF_DISCREPANCY_CENTERED, x, 0, 1, 1, &value, NULL, &e), bad, &e, "0 points");
    expect_refused(sf_discrepancy(SF_DISCREPANCY_CENTERED, x, 2, 25000, 1, &value, NULL, &e), bad, &e, "25000");
    expect_refused(sf_discrepancy(SF_DISCREPANCY_L2_STAR, x, 2, 1000, 1, &value, NULL, &e), bad, &e, "1000");
    expect_refused(sf_star_discrepancy(x, 2, 2, 0, &value, &other, NULL, &e), bad, &e, "boxes is 0");
    expect_refused(sf_net_t_value(x, 2, 2, 1, 0, 1, &t, NULL, &e), bad, &e, "base is 1");
    expect_refused(sf_net_t_value(x, 1000, 2, 2, 0, 1, &t, NULL, &e), bad, &e, "512 or 1024");
    expect_refused(sf_net_t_value(x, 10, 2, 3, 0, 1, &t, NULL, &e), bad, &e, "9 or 27");
    expect_refused(sf_minimum_distance(x, 1, 2, 0, 1, &value, NULL, &e), bad, &e, "needs 2");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_centered_discrepancy_meets_scipys_documented_values),
        cmocka_unit_test(test_in_one_dimension_centered_and_l2_star_are_the_integral_of_the_squared_difference),
        cmocka_unit_test(test_wraparound_discrepancy_of_a_lattice_is_its_closed_form),
        cmocka_unit_test(test_l2_star_of_random_points_has_its_expectation),
        cmocka_unit_test(test_sobol_is_more_even_than_random_by_every_kind),
        cmocka_unit_test(test_star_discrepancy_is_its_definition_where_that_is_affordable),
        cmocka_unit_test(test_star_discrepancy_meets_closed_forms),
        cmocka_unit_test(test_star_bounds_hold_the_star_discrepancy),
        cmocka_unit_test(test_star_bounds_of_many_dimensions_are_honest),
        cmocka_unit_test(test_sobol_has_the_t_values_of_its_polynomials),
        cmocka_unit_test(test_hammersley_is_a_net_with_t_0_in_its_own_base_only),
        cmocka_unit_test(test_t_value_is_its_definition),
        cmocka_unit_test(test_t_value_stops_at_the_effort_given_and_says_how_far_it_got),
        cmocka_unit_test(test_minimum_distance_is_that_of_all_pairs),
        cmocka_unit_test(test_opposite_sides_touch_on_the_torus_only),
        cmocka_unit_test(test_threads_and_levels_change_no_bit),
        cmocka_unit_test(test_bad_points_are_named),
        cmocka_unit_test(test_bad_options_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
