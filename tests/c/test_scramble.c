// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The laws of the scrambles of nets: pairs of words under Owen's, and the variance of means that
 * follows from it. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sunfleck/points.h"

/* ---- pairs, by enumeration ---- */

/* The k top bits of a word are the k low bits of its reversal, and these depend on no others, nor
 * on more of the seed than its low k bits and the k - 1 bits above bit 16: 2^(2k - 1) seeds give
 * all the maps that there are. */
static uint32_t seed_number(uint32_t number, int k) {
    uint32_t low = (UINT32_C(1) << k) - 1;
    return (number & low) | (number >> k) << 17;
}

/* Laine & Karras 2011, "Stratified Sampling for Stochastic Transparency", section 3.1. */
static uint32_t laine_karras_hash32(uint32_t reversed, uint32_t seed) {
    reversed += seed;
    reversed ^= reversed * 0x6c50b47cu;
    reversed ^= reversed * 0xb82f1e52u;
    reversed ^= reversed * 0xc7afe638u;
    reversed ^= reversed * 0x8d22f6e6u;
    return reversed;
}

typedef uint32_t (*hash_fn)(uint32_t reversed, uint32_t seed);
static uint32_t revised_hash32(uint32_t reversed, uint32_t seed) { return sf_owen_hash32(reversed, seed); }

/* How many of the first bits, here the lowest, two words share; k where all. */
static int shared_bits(uint32_t x, uint32_t y, int k) {
    int bits = 0;
    while (bits < k && !((x ^ y) >> bits & 1)) ++bits;
    return bits;
}

/* The chance that Owen's scrambling takes the pair (x, y) to (a, b): the images share as many
 * first bits as the words and differ in the next; all such pairs are equally likely. */
static double owen_chance(uint32_t x, uint32_t y, uint32_t a, uint32_t b, int k) {
    int shared = shared_bits(x, y, k);
    if (shared_bits(a, b, k) != shared) return 0;
    return ldexp(1, shared == k ? -k : shared + 1 - 2 * k);
}

/* The greatest total variation between the law of a pair's images, over the seeds, and Owen's. */
static double worst_distance(hash_fn hash, int k, uint32_t seeds) {
    static uint32_t counts[32][32];
    uint32_t size = UINT32_C(1) << k, mask = size - 1;
    double worst = 0;
    for (uint32_t x = 0; x < size; ++x)
        for (uint32_t y = 0; y < size; ++y) {
            memset(counts, 0, sizeof counts);
            for (uint32_t n = 0; n < seeds; ++n) {
                uint32_t seed = seed_number(n, k);
                ++counts[hash(x, seed) & mask][hash(y, seed) & mask];
            }
            double distance = 0;
            for (uint32_t a = 0; a < size; ++a)
                for (uint32_t b = 0; b < size; ++b)
                    distance += fabs(counts[a][b] / (double)seeds - owen_chance(x, y, a, b, k)) / 2;
            if (distance > worst) worst = distance;
        }
    return worst;
}

static void test_the_revised_hash_has_owens_law_of_pairs(void **state) {
    (void)state; /* exactly: all chances are multiples of 2^(1 - 2k), exact in a double */
    for (int k = 2; k <= 5; ++k) assert_true(worst_distance(revised_hash32, k, UINT32_C(1) << (2 * k - 1)) == 0);
}

static void test_the_original_hash_has_not(void **state) {
    (void)state; /* REFERENCES: up to 0.94 at depth 5, where 2^5 seeds share 2^8 images of a pair */
    double distance = 0;
    for (int k = 2; k <= 5; ++k) {
        double next = worst_distance(laine_karras_hash32, k, UINT32_C(1) << (2 * k - 1));
        assert_true(next >= distance);
        distance = next;
    }
    assert_true(fabs(distance - 0.94) < 0.005);
}

/* The correlation, over the seeds, of the flips of bit `level` of two words. */
static double flip_correlation(hash_fn hash, uint32_t x, uint32_t y, int level, uint32_t seeds) {
    int sum = 0;
    for (uint32_t n = 0; n < seeds; ++n) {
        uint32_t seed = seed_number(n, level + 1), flips = (hash(x, seed) ^ x) ^ (hash(y, seed) ^ y);
        sum += flips >> level & 1 ? -1 : 1;
    }
    return sum / (double)seeds;
}

static void test_flips_of_one_level_correlate_under_the_original_hash_only(void **state) {
    (void)state; /* REFERENCES: -0.5 at depth 3, bit 2 with 4 nodes */
    double least = 0;
    for (uint32_t x = 0; x < 4; ++x)
        for (uint32_t y = 0; y < x; ++y) {
            assert_true(flip_correlation(revised_hash32, x, y, 2, 32) == 0);
            double c = flip_correlation(laine_karras_hash32, x, y, 2, 32);
            if (c < least) least = c;
        }
    assert_true(least == -0.5);
}

/* ---- pairs, by many seeds ---- */

static void test_nested_scrambling_has_owens_law_of_pairs(void **state) {
    (void)state;
    enum { K = 3, SIZE = 1 << K, SEEDS = 1 << 14 };
    double worst = 0;
    for (uint32_t x = 0; x < SIZE; ++x)
        for (uint32_t y = 0; y < x; ++y) {
            uint32_t counts[SIZE][SIZE] = {{0}}, reversed_x = sf_reverse_bits32(x), reversed_y = sf_reverse_bits32(y);
            for (uint64_t seed = 0; seed < SEEDS; ++seed) {
                uint64_t a = sf_scramble_word(reversed_x, 4, seed, SF_SCRAMBLE_NESTED) >> (64 - K);
                uint64_t b = sf_scramble_word(reversed_y, 4, seed, SF_SCRAMBLE_NESTED) >> (64 - K);
                ++counts[sf_reverse_bits32((uint32_t)a) >> (32 - K)][sf_reverse_bits32((uint32_t)b) >> (32 - K)];
            }
            double chi2 = 0, cells = 0;
            for (uint32_t a = 0; a < SIZE; ++a)
                for (uint32_t b = 0; b < SIZE; ++b) {
                    double expected = SEEDS * owen_chance(x, y, a, b, K);
                    if (expected == 0) {
                        assert_int_equal(counts[a][b], 0);
                        continue;
                    }
                    ++cells;
                    chi2 += (counts[a][b] - expected) * (counts[a][b] - expected) / expected;
                }
            double normal = (chi2 - (cells - 1)) / sqrt(2 * (cells - 1));
            if (normal > worst) worst = normal;
        }
    /* 28 pairs, of 8 to 32 cells: chi-square of 7 degrees passes 7 + 5.5 sqrt(14) = 27.6 with
     * chance 2.6e-4, times 28 under 1 %; with more degrees it is rarer. */
    assert_true(worst < 5.5);
}

/* Flips of the nodes on the path of a word, at every depth to 53, are fair and independent of one
 * another: pairs of depths agree in half of the seeds. */
static void test_nested_flips_are_independent_at_all_depths(void **state) {
    (void)state;
    enum { SEEDS = 4096, DEPTHS = 53 };
    static int agree[DEPTHS][DEPTHS];
    int ones[DEPTHS] = {0};
    for (uint64_t seed = 0; seed < SEEDS; ++seed) {
        uint64_t flips = sf_scramble_word(0x9d2c5680u, 1, seed, SF_SCRAMBLE_NESTED) ^ UINT64_C(0x9d2c568000000000);
        for (int i = 0; i < DEPTHS; ++i) {
            ones[i] += (int)(flips >> (63 - i) & 1);
            for (int j = 0; j < i; ++j) agree[i][j] += (flips >> (63 - i) & 1) == (flips >> (63 - j) & 1);
        }
    }
    /* 53 + 1378 counts of standard deviation 32: 5 of them are passed with chance 6e-7 each. */
    for (int i = 0; i < DEPTHS; ++i) {
        assert_in_range(ones[i], SEEDS / 2 - 160, SEEDS / 2 + 160);
        for (int j = 0; j < i; ++j) assert_in_range(agree[i][j], SEEDS / 2 - 160, SEEDS / 2 + 160);
    }
}

/* Two words that differ in bit 31 at last share 31 flips, and none that is forced thereafter. */
static void test_nested_words_share_flips_down_to_where_they_part(void **state) {
    (void)state;
    for (unsigned part = 0; part < 32; ++part) {
        uint32_t x = 0x5bd1e995u, y = x ^ UINT32_C(1) << (31 - part);
        uint64_t mask = UINT64_MAX << (63 - part), differ = 0;
        for (uint64_t seed = 0; seed < 64; ++seed) {
            uint64_t a = sf_scramble_word(x, 0, seed, SF_SCRAMBLE_NESTED) ^ (uint64_t)x << 32;
            uint64_t b = sf_scramble_word(y, 0, seed, SF_SCRAMBLE_NESTED) ^ (uint64_t)y << 32;
            assert_true(((a ^ b) & mask) == 0);
            differ |= a ^ b;
        }
        /* Each of the other levels parts in some seed, but with chance 2^-64. */
        assert_true((differ >> 11 | mask >> 11) == UINT64_MAX >> 11);
    }
}

/* ---- variance of means ---- */

/* E (x - 1/2)(y - 1/2) of two scrambled coordinates that share `shared` first bits: x - 1/2 is the
 * sum of s_l 2^-(l + 2) over the bits l = 0, 1, …, s_l = +-1 fair; the shared agree, the next is
 * opposite, the others are independent. */
static double covariance(int shared) {
    double sum = 0;
    for (int l = 0; l < shared; ++l) sum += ldexp(1, -2 * (l + 2));
    return shared >= 32 ? 1.0 / 12 : sum - ldexp(1, -2 * (shared + 2));
}

typedef uint32_t (*bits_fn)(uint32_t index, uint32_t dimension);

static int shared_top(uint32_t x, uint32_t y) { return shared_bits(sf_reverse_bits32(x), sf_reverse_bits32(y), 32); }

/* The variance of the mean of (x - 1/2)(y - 1/2) over n scrambled points, from Owen's law. */
static double product_variance(bits_fn bits, uint32_t a, uint32_t b, uint32_t n) {
    double sum = 0;
    for (uint32_t i = 0; i < n; ++i)
        for (uint32_t j = 0; j < n; ++j)
            sum += covariance(shared_top(bits(i, a), bits(j, a))) * covariance(shared_top(bits(i, b), bits(j, b)));
    return sum / ((double)n * n);
}

static void test_theory_knows_the_weak_pairs(void **state) {
    (void)state; /* REFERENCES: n 16, f = (x - 1/2)(y - 1/2): RMSE 0.022 on dimensions (0, 3), 0.0061 on (0, 1) */
    assert_true(fabs(sqrt(product_variance(sf_sobol_bits, 0, 3, 16)) - 0.022) < 0.0005);
    assert_true(fabs(sqrt(product_variance(sf_sobol_bits, 0, 1, 16)) - 0.0061) < 0.00005);
    /* Every pair of sz's first four beats independent points, 1/12 / sqrt(16), by two and more. */
    for (uint32_t a = 0; a < 4; ++a)
        for (uint32_t b = a + 1; b < 4; ++b) assert_true(sqrt(product_variance(sf_sz_bits, a, b, 16)) < 0.0208 / 2);
}

/* Mean over the seeds of the squared error, and its own standard error. */
static double mean_square(sf_scramble scramble, uint32_t a, uint32_t b, uint32_t n, double *error) {
    enum { SEEDS = 4000 };
    double sum = 0, squares = 0;
    for (uint64_t seed = 0; seed < SEEDS; ++seed) {
        double mean = 0;
        for (uint32_t i = 0; i < n; ++i) {
            double x = sf_double_from_bits(sf_scramble_word(sf_sobol_bits(i, a), a, seed, scramble)) - 0.5;
            double y = sf_double_from_bits(sf_scramble_word(sf_sobol_bits(i, b), b, seed, scramble)) - 0.5;
            mean += (a == b ? x : x * y) / n;
        }
        sum += mean * mean / SEEDS;
        squares += mean * mean * mean * mean / SEEDS;
    }
    *error = sqrt((squares - sum * sum) / SEEDS);
    return sum;
}

static void test_variance_of_means_is_the_theorys(void **state) {
    (void)state; /* within 4.5 standard errors as measured: 6 comparisons */
    static const sf_scramble scrambles[] = {SF_SCRAMBLE_OWEN, SF_SCRAMBLE_NESTED};
    for (int s = 0; s < 2; ++s) {
        double error, found = mean_square(scrambles[s], 0, 0, 32, &error);
        double expected = 1.0 / 12 / (32.0 * 32 * 32); /* x: a uniform point in each of n strata */
        assert_true(fabs(found - expected) < 4.5 * error);
        found = mean_square(scrambles[s], 0, 1, 16, &error);
        assert_true(fabs(found - product_variance(sf_sobol_bits, 0, 1, 16)) < 4.5 * error);
        found = mean_square(scrambles[s], 0, 3, 16, &error);
        assert_true(fabs(found - product_variance(sf_sobol_bits, 0, 3, 16)) < 4.5 * error);
    }
}

/* A linear scramble shifts each pair's difference at random below where they part, and has the
 * same law of pairs as Owen's (Owen 2003, "Variance with alternative scramblings"): so the same
 * variance. A digital shift alone has not: the points keep their differences. */
static void test_linear_scrambling_has_owens_variance(void **state) {
    (void)state;
    double error, found = mean_square(SF_SCRAMBLE_LMS, 0, 3, 16, &error);
    assert_true(fabs(found - product_variance(sf_sobol_bits, 0, 3, 16)) < 4.5 * error);
    found = mean_square(SF_SCRAMBLE_SHIFT, 0, 0, 32, &error);
    assert_true(found > 2 * (1.0 / 12 / (32.0 * 32 * 32))); /* about 1 / (12 n^2) */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_revised_hash_has_owens_law_of_pairs),
        cmocka_unit_test(test_the_original_hash_has_not),
        cmocka_unit_test(test_flips_of_one_level_correlate_under_the_original_hash_only),
        cmocka_unit_test(test_nested_scrambling_has_owens_law_of_pairs),
        cmocka_unit_test(test_nested_flips_are_independent_at_all_depths),
        cmocka_unit_test(test_nested_words_share_flips_down_to_where_they_part),
        cmocka_unit_test(test_theory_knows_the_weak_pairs),
        cmocka_unit_test(test_variance_of_means_is_the_theorys),
        cmocka_unit_test(test_linear_scrambling_has_owens_variance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
