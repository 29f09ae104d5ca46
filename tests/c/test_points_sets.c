// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* points: one coordinate at a time equals the fill, of latin, multijittered, orthogonal, halton,
 * hammersley, lattice and r2. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "sunfleck/points.h"

enum { N = 961, D = 7 }; /* 31 x 31, and the square of a prime */

static float filled[N * D];

static sf_points_options options_of(sf_pattern pattern, sf_scramble scramble, uint64_t seed) {
    sf_points_options options = sf_points_options_default();
    options.pattern = pattern;
    options.scramble = scramble;
    options.seed = seed;
    options.dims = D;
    return options;
}

static void fill_from(uint64_t first, sf_pattern pattern, sf_scramble scramble, uint64_t seed) {
    sf_error error;
    sf_points_options options = options_of(pattern, scramble, seed);
    options.first = first;
    assert_int_equal(sf_points_fill_f32(&options, N, filled, &error), SF_STATUS_OK);
}

#define EACH_EQUALS(call)            \
    for (uint32_t i = 0; i < N; ++i) \
        for (uint32_t d = 0; d < D; ++d) assert_true(filled[i * D + d] == (call))

static void test_one_coordinate_of_a_set_equals_the_fill(void **state) {
    (void)state;
    uint32_t sides[2];
    assert_int_equal(sf_grid_sides(N, 2, sides, NULL), SF_STATUS_OK);
    for (uint64_t seed = 0; seed < 3; ++seed) {
        fill_from(0, SF_PATTERN_LATIN, SF_SCRAMBLE_DEFAULT, seed);
        EACH_EQUALS(sf_latin_sample(i, d, seed, N));
        fill_from(0, SF_PATTERN_MULTIJITTERED, SF_SCRAMBLE_DEFAULT, seed);
        EACH_EQUALS(sf_multijittered_sample(i, d, seed, sides));
        fill_from(0, SF_PATTERN_ORTHOGONAL, SF_SCRAMBLE_DEFAULT, seed);
        EACH_EQUALS(sf_orthogonal_sample(i, d, seed, 31));
    }
    fill_from(0, SF_PATTERN_HAMMERSLEY, SF_SCRAMBLE_DEFAULT, 0);
    EACH_EQUALS(sf_hammersley_sample(i, d, N));
}

static void test_one_coordinate_of_a_sequence_equals_the_fill(void **state) {
    (void)state;
    uint64_t increments[D];
    sf_r2_increments(D, increments);
    static const uint64_t firsts[] = {0, 12345, (UINT64_C(1) << 31) - 400, UINT64_C(1) << 45};
    for (unsigned k = 0; k < 4; ++k) {
        uint64_t first = firsts[k], seed = k;
        fill_from(first, SF_PATTERN_HALTON, SF_SCRAMBLE_DEFAULT, seed);
        EACH_EQUALS(sf_halton_sample(first + i, d, seed));
        fill_from(first, SF_PATTERN_HALTON, SF_SCRAMBLE_OWEN, seed);
        EACH_EQUALS(sf_halton_owen_sample(first + i, d, seed));
        fill_from(first, SF_PATTERN_HALTON, SF_SCRAMBLE_NONE, seed);
        EACH_EQUALS(sf_float_from_bits(sf_halton_bits(first + i, d)));
        fill_from(first, SF_PATTERN_LATTICE, SF_SCRAMBLE_DEFAULT, seed);
        EACH_EQUALS(sf_lattice_sample(first + i, d));
        fill_from(first, SF_PATTERN_LATTICE, SF_SCRAMBLE_SHIFT, seed);
        EACH_EQUALS(sf_lattice_shifted_sample(first + i, d, seed));
        fill_from(first, SF_PATTERN_R2, SF_SCRAMBLE_DEFAULT, seed);
        EACH_EQUALS(sf_r2_sample(first + i, increments[d]));
        fill_from(first, SF_PATTERN_R2, SF_SCRAMBLE_SHIFT, seed);
        EACH_EQUALS(sf_r2_shifted_sample(first + i, d, seed, increments[d]));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_coordinate_of_a_set_equals_the_fill),
        cmocka_unit_test(test_one_coordinate_of_a_sequence_equals_the_fill),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
