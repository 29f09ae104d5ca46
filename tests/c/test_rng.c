// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "sunfleck/rng.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "rng_kernels.h"

#define FOR_EACH_KIND(kind) for (sf_rng_kind kind = (sf_rng_kind)0; kind < SF_RNG_COUNT; kind = (sf_rng_kind)(kind + 1))

/* A seed that every method takes. */
static sf_rng seeded(sf_rng_kind kind, uint64_t seed) {
    sf_rng rng;
    assert_int_equal(sf_rng_init(&rng, kind, seed, 0, NULL), SF_STATUS_OK);
    return rng;
}

static uint64_t draw_number(sf_rng rng, uint64_t n) {
    uint64_t word = 0;
    for (uint64_t i = 0; i < n; ++i) word = sf_rng_next_raw(&rng);
    return word;
}

/* ---- known answers ---- */

static void test_minstd_10000th_draw_from_seed_1_is_the_standards(void **state) {
    (void)state; /* C++ standard, rand.predef: minstd_rand0 */
    assert_int_equal(draw_number(seeded(SF_RNG_MINSTD, 1), 10000), 1043618065);
}

static void test_pcg32_draws_the_references_words(void **state) {
    (void)state; /* pcg32-demo of pcg-c-basic, seeded (42, 54) */
    static const uint32_t expected[] = {0xa15c02b7, 0x7b47f409, 0xba1d3330, 0x83d2f293, 0xbfa4784b, 0xcbed606e};
    sf_rng rng;
    assert_int_equal(sf_rng_init(&rng, SF_RNG_PCG32, 42, 54, NULL), SF_STATUS_OK);
    for (int i = 0; i < 6; ++i) assert_int_equal(sf_rng_next_raw(&rng), expected[i]);
}

static void test_splitmix64_draws_the_published_words(void **state) {
    (void)state; /* Rosetta Code, "Pseudo-random numbers/Splitmix64" */
    sf_rng rng = seeded(SF_RNG_SPLITMIX64, 1234567);
    assert_true(sf_rng_next_raw(&rng) == UINT64_C(6457827717110365317));
    assert_true(sf_rng_next_raw(&rng) == UINT64_C(3203168211198807973));
}

static void test_xoshiro256pp_draws_the_references_words_from_state_1_2_3_4(void **state) {
    (void)state; /* of xoshiro256plusplus.c; also in the tests of Rust's rand_xoshiro */
    sf_xoshiro256pp g = {{1, 2, 3, 4}};
    assert_true(sf_xoshiro256pp_next(&g) == UINT64_C(41943041));
    assert_true(sf_xoshiro256pp_next(&g) == UINT64_C(58720359));
    assert_true(sf_xoshiro256pp_next(&g) == UINT64_C(3588806011781223));
}

static void test_xoshiro256pp_is_seeded_by_splitmix64(void **state) {
    (void)state;
    sf_rng rng = seeded(SF_RNG_XOSHIRO256PP, 1234567);
    assert_true(rng.as.xoshiro256pp.s[0] == UINT64_C(6457827717110365317));
    assert_true(rng.as.xoshiro256pp.s[1] == UINT64_C(3203168211198807973));
}

static void test_xorshift64_first_draws_from_state_1_follow_by_hand(void **state) {
    (void)state; /* 1 ^ 1 >> 21 = 1; ^ << 35 = 2^35 + 1; ^ >> 4 = 2^35 + 2^31 + 1 */
    assert_true(draw_number(seeded(SF_RNG_XORSHIFT64, 1), 1) == (UINT64_C(1) << 35 | UINT64_C(1) << 31 | 1));
    /* 1 ^ << 21 = 2^21 + 1; ^ >> 35 the same; ^ << 4 = 2^25 + 2^21 + 2^4 + 1 */
    assert_true(draw_number(seeded(SF_RNG_XORSHIFT64_LRL, 1), 1) == (1u << 25 | 1u << 21 | 1u << 4 | 1u));
}

static void test_combined_is_the_xor_of_its_parts(void **state) {
    (void)state;
    sf_rng rng = seeded(SF_RNG_COMBINED, 7);
    uint64_t lcg = rng.as.combined.lcg;
    sf_xorshift64 shifter = {rng.as.combined.xorshift};
    for (int i = 0; i < 100; ++i) {
        lcg = lcg * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
        assert_true(sf_rng_next_raw(&rng) == (lcg ^ sf_xorshift64_next(&shifter)));
    }
}

/* ---- fills ---- */

static void test_fills_agree_with_raw_draws(void **state) {
    (void)state;
    enum { N = 2500 };
    static uint32_t words[2 * N];
    static uint64_t wide[N];
    static float floats[2 * N];
    static double doubles[N];
    FOR_EACH_KIND(kind) {
        unsigned bits = sf_rng_native_bits(kind), up = bits == 31;
        sf_rng raw = seeded(kind, 9), a = raw, b = raw, c = raw, d = raw;
        sf_rng_fill_u32(&a, 2 * N, words);
        sf_rng_fill_u64(&b, N, wide);
        sf_rng_fill_f32(&c, 2 * N, floats);
        sf_rng_fill_f64(&d, N, doubles);
        for (int i = 0; i < N; ++i) {
            uint64_t first = sf_rng_next_raw(&raw), whole = first;
            if (bits < 64) {
                uint64_t second = sf_rng_next_raw(&raw);
                whole = second << 32 | first;
                double expected = (double)(first << up >> 5) * 0x1p-27 + (double)(second << up >> 6) * 0x1p-53;
                assert_true(doubles[i] == expected);
            } else {
                assert_true(doubles[i] == (double)(whole >> 11) * 0x1p-53);
            }
            assert_true(wide[i] == whole);
            assert_int_equal(words[2 * i], (uint32_t)whole);
            assert_int_equal(words[2 * i + 1], whole >> 32);
            assert_true(floats[2 * i] == (float)((uint32_t)whole << up >> 8) * 0x1p-24f);
            assert_true(floats[2 * i + 1] == (float)((uint32_t)(whole >> 32) << up >> 8) * 0x1p-24f);
        }
    }
}

static void test_split_fills_are_the_whole_fill(void **state) {
    (void)state;
    enum { N = 4001 };
    static uint32_t whole[N], part[N];
    FOR_EACH_KIND(kind) {
        sf_rng a = seeded(kind, 3), b = a;
        sf_rng_fill_u32(&a, N, whole);
        for (size_t at = 0, step = 1; at < N; at += step, step = step * 2 + 1) {
            if (step > N - at) step = N - at;
            sf_rng_fill_u32(&b, step, part + at);
        }
        assert_memory_equal(whole, part, sizeof whole);
    }
}

static void test_every_level_gives_the_same_bits(void **state) {
    (void)state;
    enum { N = 1500 };
    static float floats[2][N];
    static double doubles[2][N];
    static uint64_t words[2][N];
    FOR_EACH_KIND(kind) {
        for (int level = 0; level <= (int)SF_ISA_AVX512; ++level) {
            int other = level > 0;
            setenv("SUNFLECK_ISA", sf_isa_name((sf_isa)level), 1);
            sf_rng rng = seeded(kind, 11);
            sf_rng_fill_f32(&rng, N, floats[other]);
            sf_rng_fill_f64(&rng, N, doubles[other]);
            sf_rng_fill_u64(&rng, N, words[other]);
            assert_memory_equal(floats[0], floats[other], sizeof floats[0]);
            assert_memory_equal(doubles[0], doubles[other], sizeof doubles[0]);
            assert_memory_equal(words[0], words[other], sizeof words[0]);
        }
        unsetenv("SUNFLECK_ISA");
    }
}

static void test_floats_of_the_largest_words_stay_below_one(void **state) {
    (void)state;
    static const uint32_t narrow[2] = {UINT32_MAX, UINT32_MAX}, narrow31[2] = {0x7fffffff, 0x7fffffff};
    static const uint64_t wide[1] = {UINT64_MAX};
    const sf_rng_kernels *kernels = sf_rng_kernels_at(SF_ISA_BASELINE);
    float f[2];
    double d;
    kernels->f32_from_u32(2, 0, narrow, f);
    assert_true(f[0] == 0x1.fffffep-1f && f[0] < 1);
    kernels->f32_from_u32(2, 1, narrow31, f);
    assert_true(f[0] == 0x1.fffffep-1f);
    kernels->f64_from_u64(1, wide, &d);
    assert_true(d == 1 - 0x1p-53 && d < 1);
    kernels->f64_from_u32(1, 0, narrow, &d);
    assert_true(d == 1 - 0x1p-53);
    kernels->f64_from_u32(1, 1, narrow31, &d);
    assert_true(d == 1 - 0x1p-53);
}

/* ---- skip, spawn, state ---- */

static void test_skip_lands_where_drawing_does(void **state) {
    (void)state;
    static const uint64_t counts[] = {0, 1, 2, 63, 64, 65, 1000, 4097};
    FOR_EACH_KIND(kind) {
        for (size_t c = 0; c < sizeof counts / sizeof *counts; ++c) {
            sf_rng walked = seeded(kind, 5), skipped = walked;
            sf_error error;
            sf_status status = sf_rng_skip(&skipped, counts[c], &error);
            if (status == SF_STATUS_UNSUPPORTED) {
                assert_non_null(strstr(error.message, sf_rng_name(kind)));
                assert_memory_equal(&walked, &skipped, sizeof walked);
                continue;
            }
            assert_int_equal(status, SF_STATUS_OK);
            for (uint64_t i = 0; i < counts[c]; ++i) sf_rng_next_raw(&walked);
            for (int i = 0; i < 5; ++i) assert_true(sf_rng_next_raw(&walked) == sf_rng_next_raw(&skipped));
        }
    }
}

static void test_skips_add_up(void **state) {
    (void)state; /* far beyond what can be walked */
    FOR_EACH_KIND(kind) {
        sf_rng once = seeded(kind, 5), twice = once;
        if (sf_rng_skip(&once, UINT64_C(0x123456789abcdef0) + 77, NULL) != SF_STATUS_OK) continue;
        assert_int_equal(sf_rng_skip(&twice, UINT64_C(0x123456789abcdef0), NULL), SF_STATUS_OK);
        assert_int_equal(sf_rng_skip(&twice, 77, NULL), SF_STATUS_OK);
        assert_true(sf_rng_next_raw(&once) == sf_rng_next_raw(&twice));
    }
}

static void test_minstd_returns_after_its_whole_period(void **state) {
    (void)state;
    sf_rng rng = seeded(SF_RNG_MINSTD, 12345);
    assert_int_equal(sf_rng_skip(&rng, 2147483646, NULL), SF_STATUS_OK);
    assert_int_equal(rng.as.minstd.state, 12345);
    assert_int_equal(sf_rng_skip(&rng, 2147483646 / 2, NULL), SF_STATUS_OK);
    assert_int_not_equal(rng.as.minstd.state, 12345);
}

static void test_state_round_trips_in_the_middle_of_a_draw(void **state) {
    (void)state;
    static uint64_t words[SF_RNG_STATE_MAX];
    FOR_EACH_KIND(kind) {
        sf_rng rng = seeded(kind, 21), children[3], copy;
        sf_rng_spawn(&rng, 3, children);
        sf_rng_next_u32(&rng); /* leaves a half word waiting in the 64-bit methods */
        size_t size = sf_rng_state_size(kind);
        assert_in_range(size, 5, SF_RNG_STATE_MAX);
        sf_rng_get_state(&rng, words);
        assert_int_equal(sf_rng_set_state(&copy, kind, words, size, NULL), SF_STATUS_OK);
        for (int i = 0; i < 2000; ++i) assert_int_equal(sf_rng_next_u32(&rng), sf_rng_next_u32(&copy));
        sf_rng_spawn(&rng, 1, &children[0]);
        sf_rng_spawn(&copy, 1, &children[1]);
        assert_true(sf_rng_next_u64(&children[0]) == sf_rng_next_u64(&children[1]));
    }
}

static void test_bad_states_are_refused_and_change_nothing(void **state) {
    (void)state;
    uint64_t words[SF_RNG_STATE_MAX] = {0};
    sf_error error;
    sf_rng rng = seeded(SF_RNG_PCG32, 1), before = rng;
    static const sf_rng_kind without_zero[] = {SF_RNG_MINSTD, SF_RNG_XORSHIFT64, SF_RNG_XORSHIFT64_LRL,
                                               SF_RNG_COMBINED, SF_RNG_PCG32, SF_RNG_XOSHIRO256PP};
    for (size_t i = 0; i < sizeof without_zero / sizeof *without_zero; ++i) {
        sf_rng_kind kind = without_zero[i];
        assert_int_equal(sf_rng_set_state(&rng, kind, words, sf_rng_state_size(kind), &error),
                         SF_STATUS_INVALID_VALUE);
        assert_non_null(strstr(error.message, sf_rng_name(kind)));
    }
    assert_int_equal(sf_rng_set_state(&rng, SF_RNG_SPLITMIX64, words, 3, &error), SF_STATUS_INVALID_VALUE);
    assert_string_equal(error.message, "the state has 3 words; that of splitmix64 has 5");
    words[0] = UINT64_C(1) << 32;
    assert_int_equal(sf_rng_set_state(&rng, SF_RNG_MINSTD, words, 5, &error), SF_STATUS_INVALID_VALUE);
    assert_non_null(strstr(error.message, "below 2^32"));
    words[1] = 17; /* a half word without the mark that it waits */
    assert_int_equal(sf_rng_set_state(&rng, SF_RNG_SPLITMIX64, words, 5, &error), SF_STATUS_INVALID_VALUE);
    assert_memory_equal(&rng, &before, sizeof rng);
}

static void test_streams_and_children_share_no_word(void **state) {
    (void)state;
    /* 16 sequences of 64 words: by chance two of 1024 words of 64 bits are equal once in 2^45. */
    FOR_EACH_KIND(kind) {
        sf_rng parents[2] = {seeded(kind, 1), seeded(kind, 3)}, rngs[16];
        sf_rng_spawn(&parents[0], 4, rngs);
        sf_rng_spawn(&parents[0], 4, rngs + 4);
        sf_rng_spawn(&parents[1], 4, rngs + 8);
        for (uint64_t s = 0; s < 4; ++s) assert_int_equal(sf_rng_init(&rngs[12 + s], kind, 1, s, NULL), SF_STATUS_OK);
        static uint64_t words[16 * 64];
        for (int r = 0; r < 16; ++r) sf_rng_fill_u64(&rngs[r], 64, words + 64 * r);
        for (int i = 0; i < 16 * 64; ++i)
            for (int j = 0; j < i; ++j) assert_true(words[i] != words[j]);
    }
}

static void test_shared_seeds_repeat_and_spawned_ones_do_not(void **state) {
    (void)state;
    /* The lecture's warning: threads that start alike draw alike. Correlation of 4096 floats: 1
     * for shared seeds; for independent ones its deviation is 1/64, and 5 of those are allowed. */
    enum { N = 4096 };
    static float a[N], b[N];
    FOR_EACH_KIND(kind) {
        sf_rng shared[2] = {seeded(kind, 77), seeded(kind, 77)}, parent = seeded(kind, 77), spawned[2];
        sf_rng_spawn(&parent, 2, spawned);
        sf_rng_fill_f32(&shared[0], N, a);
        sf_rng_fill_f32(&shared[1], N, b);
        assert_memory_equal(a, b, sizeof a);
        sf_rng_fill_f32(&spawned[0], N, a);
        sf_rng_fill_f32(&spawned[1], N, b);
        double sum = 0;
        for (int i = 0; i < N; ++i) sum += (a[i] - 0.5) * (b[i] - 0.5);
        assert_true(12 * sum / N < 5.0 / 64 && 12 * sum / N > -5.0 / 64);
    }
}

/* ---- bad input ---- */

static void test_bad_seeds_and_names_are_refused_by_name_and_range(void **state) {
    (void)state;
    sf_rng rng;
    sf_rng_kind kind;
    sf_error error;
    assert_int_equal(sf_rng_init(&rng, SF_RNG_MINSTD, 0, 0, &error), SF_STATUS_INVALID_VALUE);
    assert_string_equal(error.message, "seed is 0; minstd takes 1 .. 2147483646 (state 0 would stay 0)");
    assert_int_equal(sf_rng_init(&rng, SF_RNG_MINSTD, 2147483647, 0, &error), SF_STATUS_INVALID_VALUE);
    assert_int_equal(sf_rng_init(&rng, SF_RNG_MINSTD, 0, 1, &error), SF_STATUS_OK);
    assert_int_equal(sf_rng_init(&rng, SF_RNG_XORSHIFT64, 0, 0, &error), SF_STATUS_INVALID_VALUE);
    assert_int_equal(sf_rng_init(&rng, SF_RNG_PCG32, 0, UINT64_C(1) << 63, &error), SF_STATUS_INVALID_VALUE);
    assert_int_equal(sf_rng_init(&rng, (sf_rng_kind)1000, 1, 0, &error), SF_STATUS_INVALID_VALUE);
    assert_int_equal(sf_rng_find("pcg64", &kind, &error), SF_STATUS_INVALID_VALUE);
    FOR_EACH_KIND(k) assert_non_null(strstr(error.message, sf_rng_name(k)));
    assert_null(sf_rng_name(SF_RNG_COUNT));
    assert_null(sf_rng_description(SF_RNG_COUNT));
}

static void test_every_name_finds_its_kind(void **state) {
    (void)state;
    FOR_EACH_KIND(kind) {
        sf_rng_kind found = SF_RNG_COUNT;
        assert_int_equal(sf_rng_find(sf_rng_name(kind), &found, NULL), SF_STATUS_OK);
        assert_int_equal(found, kind);
        assert_non_null(sf_rng_description(kind));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_minstd_10000th_draw_from_seed_1_is_the_standards),
        cmocka_unit_test(test_pcg32_draws_the_references_words),
        cmocka_unit_test(test_splitmix64_draws_the_published_words),
        cmocka_unit_test(test_xoshiro256pp_draws_the_references_words_from_state_1_2_3_4),
        cmocka_unit_test(test_xoshiro256pp_is_seeded_by_splitmix64),
        cmocka_unit_test(test_xorshift64_first_draws_from_state_1_follow_by_hand),
        cmocka_unit_test(test_combined_is_the_xor_of_its_parts),
        cmocka_unit_test(test_fills_agree_with_raw_draws),
        cmocka_unit_test(test_split_fills_are_the_whole_fill),
        cmocka_unit_test(test_every_level_gives_the_same_bits),
        cmocka_unit_test(test_floats_of_the_largest_words_stay_below_one),
        cmocka_unit_test(test_skip_lands_where_drawing_does),
        cmocka_unit_test(test_skips_add_up),
        cmocka_unit_test(test_minstd_returns_after_its_whole_period),
        cmocka_unit_test(test_state_round_trips_in_the_middle_of_a_draw),
        cmocka_unit_test(test_bad_states_are_refused_and_change_nothing),
        cmocka_unit_test(test_streams_and_children_share_no_word),
        cmocka_unit_test(test_shared_seeds_repeat_and_spawned_ones_do_not),
        cmocka_unit_test(test_bad_seeds_and_names_are_refused_by_name_and_range),
        cmocka_unit_test(test_every_name_finds_its_kind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
