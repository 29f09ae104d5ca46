// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* How threads share a seed, well and badly (docs/rng.md), and what a general LCG takes. */
#include "sunfleck/rng.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "rng_cases.h"

enum { N = 4096, THREADS = 8 };

static float drawn[THREADS][N];

static double correlation(const float *a, const float *b) {
    double sum = 0;
    for (int i = 0; i < N; ++i) sum += (a[i] - 0.5) * (b[i] - 0.5);
    return 12 * sum / N;
}

/* For independent floats a correlation of 4096 deviates by 1 / sqrt(4096) = 1/64. The tests below
 * look at some 1,500 pairs; 5.5 deviations occur by chance in one of 26 million. */
static void assert_independent(void) {
    for (int a = 0; a < THREADS; ++a)
        for (int b = 0; b < a; ++b) {
            double c = correlation(drawn[a], drawn[b]);
            assert_true(c < 5.5 / 64 && c > -5.5 / 64);
        }
}

static void test_shared_seeds_repeat(void **state) {
    (void)state; /* the lecture's warning: threads that start alike draw alike */
    FOR_EACH_KIND(kind) {
        for (int t = 0; t < 2; ++t) {
            sf_rng rng = seeded(kind, 77);
            sf_rng_fill_f32(&rng, N, drawn[t]);
        }
        assert_memory_equal(drawn[0], drawn[1], sizeof drawn[0]);
    }
}

static void test_neighbouring_seeds_of_minstd_are_proportional(void **state) {
    (void)state; /* hence "seed + thread number" is no policy: x_n = 16807^n seed */
    sf_rng one = seeded(SF_RNG_MINSTD, 1), two = seeded(SF_RNG_MINSTD, 2);
    for (int i = 0; i < 100; ++i)
        assert_int_equal(sf_rng_next_raw(&two), 2 * sf_rng_next_raw(&one) % SF_MINSTD_MODULUS);
}

static void test_spawned_generators_are_independent(void **state) {
    (void)state;
    FOR_EACH_KIND(kind) {
        sf_rng parent = seeded(kind, 77), children[THREADS];
        sf_rng_spawn(&parent, THREADS, children);
        for (int t = 0; t < THREADS; ++t) sf_rng_fill_f32(&children[t], N, drawn[t]);
        assert_independent();
    }
}

static void test_streams_are_independent(void **state) {
    (void)state;
    FOR_EACH_KIND(kind) {
        for (uint64_t t = 0; t < THREADS; ++t) {
            sf_rng rng;
            assert_int_equal(sf_rng_init(&rng, kind, 77, t, NULL), SF_STATUS_OK);
            sf_rng_fill_f32(&rng, N, drawn[t]);
        }
        assert_independent();
    }
}

static int ones(uint32_t x) {
    int count = 0;
    for (; x; x &= x - 1) ++count;
    return count;
}

static uint32_t words_of_streams[3][1 << 15];

/* The largest departure, in deviations, of the mean number of ones in a ^ turned b, or of the share of tops
 * where a, b, c are evenly spaced (a - 2 b + c near 0, as LCGs with evenly spaced increments are). A pair of
 * independent words has 16 ones with variance 8; a sum of three words is uniform. */
static double worst_of_triple(void) {
    enum { COUNT = 1 << 15 };
    const uint32_t *a = words_of_streams[0], *b = words_of_streams[1], *c = words_of_streams[2];
    double worst = 0;
    for (int turn = 0; turn < 32; ++turn) {
        double sum = 0;
        for (int i = 0; i < COUNT; ++i) sum += ones(a[i] ^ (b[i] << turn | b[i] >> (-turn & 31))) - 16;
        double deviations = sum * sum / (8.0 * COUNT);
        if (deviations > worst) worst = deviations;
    }
    double near = 0, expected = COUNT / 64.0;
    for (int i = 0; i < COUNT; ++i) near += (a[i] - 2 * b[i] + c[i] + (UINT32_C(1) << 25)) >> 26 == 0;
    double deviations = (near - expected) * (near - expected) / expected;
    return deviations > worst ? deviations : worst;
}

static void test_interleaved_streams_are_independent(void **state) {
    (void)state;
    /* Increments of neighbours, and ones that differ in few or only in high bits, which an LCG keeps apart
     * from its low ones: pcg32's own streams (1, 1 + 2^56) have 27 deviations. 18 kinds, 9 triples, 33
     * statistics: 6.5 deviations occur by chance in one of two million. The low bits of general LCGs are
     * alike in any two streams; what they are bad at alone is not asked of them here. */
    FOR_EACH_KIND(kind)
    for (unsigned shift = 0; shift < 63; shift += 7) {
        if (kind == SF_RNG_LCG32 || kind == SF_RNG_LCG64 || kind == SF_RNG_RANDU) continue;
        for (uint64_t t = 0; t < 3; ++t) {
            sf_rng rng;
            uint64_t stream = (1 + (t << shift)) & (UINT64_MAX >> 1);
            assert_int_equal(sf_rng_init(&rng, kind, 77, stream, NULL), SF_STATUS_OK);
            sf_rng_fill_u32(&rng, 1 << 15, words_of_streams[t]);
            if (sf_rng_native_bits(kind) == 31)
                for (int i = 0; i < 1 << 15; ++i) words_of_streams[t][i] = words_of_streams[t][i] << 1 | (i >> t & 1);
        }
        double worst = worst_of_triple();
        if (worst >= 6.5 * 6.5)
            print_error("%s, streams 1 + 2^%u t: %g deviations^2\n", sf_rng_name(kind), shift, worst);
        assert_true(worst < 6.5 * 6.5);
    }
}

static void test_jumped_generators_are_independent(void **state) {
    (void)state; /* by the golden ratio of 2^64, for all that skip and whose period is 2^64 or more */
    static const sf_rng_kind kinds[] = {SF_RNG_XORSHIFT64, SF_RNG_XORSHIFT64_LRL, SF_RNG_COMBINED,  SF_RNG_MT19937,
                                        SF_RNG_MT19937_64, SF_RNG_PCG32,          SF_RNG_PCG64DXSM, SF_RNG_XOSHIRO256PP,
                                        SF_RNG_PHILOX4X32, SF_RNG_PHILOX4X64,     SF_RNG_SPLITMIX64};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k) {
        sf_rng start = seeded(kinds[k], 77);
        for (int t = 0; t < THREADS; ++t) {
            sf_rng rng = start;
            sf_rng_fill_f32(&rng, N, drawn[t]);
            assert_int_equal(sf_rng_skip(&start, UINT64_C(0x9e3779b97f4a7c15), NULL), SF_STATUS_OK);
        }
        assert_independent();
    }
}

static void test_jumps_by_powers_of_two_fail_for_an_lcg(void **state) {
    (void)state; /* bit j has period 2^(j+1), so that draws 2^k apart agree in their low k bits */
    sf_rng one = seeded(SF_RNG_LCG64, 77), two = one;
    assert_int_equal(sf_rng_skip(&two, UINT64_C(1) << 40, NULL), SF_STATUS_OK);
    for (int i = 0; i < 100; ++i) {
        uint64_t difference = sf_rng_next_raw(&one) ^ sf_rng_next_raw(&two);
        assert_true(difference != 0 && difference << 24 == 0);
    }
}

static void test_keyed_blocks_are_independent(void **state) {
    (void)state; /* stateless: the key is the seed, the counter says pixel and dimension */
    for (uint32_t t = 0; t < THREADS; ++t)
        for (uint32_t i = 0; i < N / 4; ++i) {
            const uint32_t counter[4] = {i, 0, t, 0}, key[2] = {77, 0};
            uint32_t block[4];
            sf_philox4x32_block(counter, key, block);
            for (int w = 0; w < 4; ++w) drawn[t][4 * i + w] = sf_float_from_bits(block[w]);
        }
    assert_independent();
}

/* ---- the general LCG ---- */

static sf_rng congruential(sf_rng_kind kind, uint64_t a, uint64_t c, uint64_t m, uint64_t seed) {
    const sf_lcg_parameters p = {a, c, m};
    sf_rng rng;
    assert_int_equal(sf_rng_init_lcg(&rng, kind, &p, seed, 0, NULL), SF_STATUS_OK);
    return rng;
}

static void test_small_lcgs_visit_every_state(void **state) {
    (void)state; /* Hull & Dobell 1962: c coprime to m, a - 1 divisible by m's primes, by 4 if m is */
    sf_rng rng = congruential(SF_RNG_LCG32, 21, 7, 1000, 3);
    unsigned char seen[1000] = {0};
    for (int i = 0; i < 1000; ++i) {
        uint64_t x = sf_rng_next_raw(&rng);
        assert_in_range(x, 0, 999);
        assert_int_equal(seen[x]++, 0);
    }
}

static void test_lcg_floats_are_the_state_over_the_modulus(void **state) {
    (void)state;
    sf_rng raw = congruential(SF_RNG_LCG32, 3, 0, 4099, 5), narrow = raw, doubles = raw;
    for (int i = 0; i < 4098; ++i) {
        uint32_t x = (uint32_t)sf_rng_next_raw(&raw);
        float expected = (float)(((uint64_t)x << 24) / 4099) * 0x1p-24f;
        assert_true(sf_rng_next_f32(&narrow) == expected);
        if (i % 2) continue;
        double d = sf_rng_next_f64(&doubles);
        assert_true((uint64_t)(d * 0x1p27) == ((uint64_t)x << 27) / 4099);
    }
    /* 2^61 - 1 is prime; the quotient's top 53 bits differ from a double's by rounding alone. */
    raw = doubles = congruential(SF_RNG_LCG64, 37, 0, (UINT64_C(1) << 61) - 1, 12345);
    static double bulk[1000];
    sf_rng_fill_f64(&doubles, 1000, bulk);
    for (int i = 0; i < 1000; ++i) {
        double x = (double)sf_rng_next_raw(&raw) / 0x1p61;
        assert_true(bulk[i] < x + 0x1p-52 && bulk[i] > x - 0x1p-52);
    }
}

static void test_lcgs_skip_under_any_modulus_and_keep_their_constants(void **state) {
    (void)state;
    sf_rng rngs[] = {congruential(SF_RNG_LCG32, 48271, 11, 2147483647, 1), congruential(SF_RNG_LCG32, 5, 3, 64, 1),
                     congruential(SF_RNG_LCG64, 37, 5, (UINT64_C(1) << 61) - 1, 1),
                     congruential(SF_RNG_LCG64, UINT64_MAX - 100, 77, UINT64_MAX - 58, 1)};
    for (size_t k = 0; k < sizeof rngs / sizeof *rngs; ++k) {
        sf_rng walked = rngs[k], skipped = walked, child;
        for (int i = 0; i < 12345; ++i) sf_rng_next_raw(&walked);
        assert_int_equal(sf_rng_skip(&skipped, 12345, NULL), SF_STATUS_OK);
        assert_true(sf_rng_next_raw(&walked) == sf_rng_next_raw(&skipped));
        sf_rng_reset(&walked);
        assert_true(sf_rng_next_raw(&walked) == sf_rng_next_raw(&rngs[k]));
        sf_rng_spawn(&walked, 1, &child);
        if (walked.kind == SF_RNG_LCG32)
            assert_int_equal(child.as.lcg32.modulus, walked.as.lcg32.modulus);
        else
            assert_true(child.as.lcg64.modulus == walked.as.lcg64.modulus);
    }
}

static void test_bad_constants_are_named(void **state) {
    (void)state;
    static const struct {
        sf_rng_kind kind;
        sf_lcg_parameters p;
        uint64_t seed;
        const char *word;
    } cases[] = {
        {SF_RNG_LCG32, {3, 1, 1}, 0, "m is 1"},
        {SF_RNG_LCG32, {3, 1, (UINT64_C(1) << 32) + 1}, 0, "2 .. 2^32"},
        {SF_RNG_LCG64, {3, 1, 1000}, 0, "lcg32"},
        {SF_RNG_LCG32, {0, 1, 1000}, 0, "a is 0"},
        {SF_RNG_LCG32, {1000, 1, 1000}, 0, "1 .. m - 1 = 999"},
        {SF_RNG_LCG32, {3, 1000, 1000}, 0, "c is 1000"},
        {SF_RNG_LCG32, {15, 1, 1000}, 0, "factor 5"},
        {SF_RNG_LCG64, {4, 1, 0}, 0, "factor 4"},
        {SF_RNG_LCG32, {1, 0, 1000}, 1, "would stay"},
        {SF_RNG_LCG32, {3, 1, 1000}, 1000, "seed is 1000"},
        {SF_RNG_LCG32, {3, 0, 1000}, 10, "no factor"},
        {SF_RNG_LCG64, {3, 0, 0}, 0, "no factor"},
        {SF_RNG_LCG32, {3, 994, 1000}, 3, "fixed point"}, /* 3 * 3 + 994 = 1003 */
        {SF_RNG_MINSTD, {3, 1, 1000}, 1, "minstd"},
        {SF_RNG_COUNT, {3, 1, 1000}, 1, "lcg32"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; ++k) {
        sf_rng rng;
        sf_error error = {SF_STATUS_OK, ""};
        assert_int_equal(sf_rng_init_lcg(&rng, cases[k].kind, &cases[k].p, cases[k].seed, 0, &error),
                         SF_STATUS_INVALID_VALUE);
        assert_non_null(strstr(error.message, cases[k].word));
    }
}

static void test_streams_of_tiny_moduli_start_from_good_states(void **state) {
    (void)state;
    const sf_lcg_parameters p = {5, 0, 12};
    for (uint64_t stream = 1; stream < 200; ++stream) {
        sf_rng rng;
        assert_int_equal(sf_rng_init_lcg(&rng, SF_RNG_LCG32, &p, 0, stream, NULL), SF_STATUS_OK);
        uint32_t x = rng.as.lcg32.state;
        assert_true(x == 1 || x == 5 || x == 7 || x == 11);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shared_seeds_repeat),
        cmocka_unit_test(test_neighbouring_seeds_of_minstd_are_proportional),
        cmocka_unit_test(test_spawned_generators_are_independent),
        cmocka_unit_test(test_streams_are_independent),
        cmocka_unit_test(test_interleaved_streams_are_independent),
        cmocka_unit_test(test_jumped_generators_are_independent),
        cmocka_unit_test(test_jumps_by_powers_of_two_fail_for_an_lcg),
        cmocka_unit_test(test_keyed_blocks_are_independent),
        cmocka_unit_test(test_small_lcgs_visit_every_state),
        cmocka_unit_test(test_lcg_floats_are_the_state_over_the_modulus),
        cmocka_unit_test(test_lcgs_skip_under_any_modulus_and_keep_their_constants),
        cmocka_unit_test(test_bad_constants_are_named),
        cmocka_unit_test(test_streams_of_tiny_moduli_start_from_good_states),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
