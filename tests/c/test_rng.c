// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "sunfleck/rng.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "rng/rng_kernels.h"
#include "rng_cases.h"

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

static void test_long_fills_agree_with_raw_draws_at_every_level(void **state) {
    (void)state; /* long enough for xoshiro256++ to go in lanes, and with a rest */
    enum { N = 3 * 16384 + 13 };
    static uint64_t raw[N], wide[N];
    static uint32_t halves[2 * N];
    static float floats[2 * N];
    static double doubles[N];
    static const sf_rng_kind kinds[] = {SF_RNG_MT19937_64, SF_RNG_PCG64DXSM,  SF_RNG_XOSHIRO256PP,
                                        SF_RNG_SFC64,      SF_RNG_PHILOX4X64, SF_RNG_SPLITMIX64};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k)
        for (int level = 0; level <= (int)SF_ISA_AVX512; ++level) {
            setenv("SUNFLECK_ISA", sf_isa_name((sf_isa)level), 1);
            sf_rng walked = seeded(kinds[k], 11), a = walked, b = a, c = a, d = a;
            for (int i = 0; i < N; ++i) raw[i] = sf_rng_next_raw(&walked);
            sf_rng_fill_u64(&a, N, wide);
            sf_rng_fill_u32(&b, 2 * N, halves);
            sf_rng_fill_f32(&c, 2 * N, floats);
            sf_rng_fill_f64(&d, N, doubles);
            assert_memory_equal(raw, wide, sizeof raw);
            for (int i = 0; i < N; ++i) {
                assert_true(halves[2 * i] == (uint32_t)raw[i] && halves[2 * i + 1] == raw[i] >> 32);
                assert_true(floats[2 * i] == (float)((uint32_t)raw[i] >> 8) * 0x1p-24f);
                assert_true(floats[2 * i + 1] == (float)(raw[i] >> 40) * 0x1p-24f);
                assert_true(doubles[i] == (double)(raw[i] >> 11) * 0x1p-53);
            }
            uint64_t next = sf_rng_next_raw(&walked);
            assert_true(sf_rng_next_raw(&a) == next && sf_rng_next_raw(&b) == next);
            assert_true(sf_rng_next_raw(&c) == next && sf_rng_next_raw(&d) == next);
        }
    unsetenv("SUNFLECK_ISA");
}

static void test_single_values_are_those_of_fills(void **state) {
    (void)state;
    enum { N = 37 };
    FOR_EACH_KIND(kind) {
        sf_rng one = seeded(kind, 3), all = one;
        for (int i = 0; i < N; ++i) {
            /* In turns, so that halves wait across draws of other widths. */
            uint32_t word;
            uint64_t wide;
            float f;
            double d;
            sf_rng_fill_u32(&all, 1, &word);
            assert_int_equal(sf_rng_next_u32(&one), word);
            sf_rng_fill_u64(&all, 1, &wide);
            assert_true(sf_rng_next_u64(&one) == wide);
            sf_rng_fill_f64(&all, 1, &d);
            assert_true(sf_rng_next_f64(&one) == d);
            if (i % 3) continue;
            sf_rng_fill_f32(&all, 1, &f);
            assert_true(sf_rng_next_f32(&one) == f);
        }
    }
}

static void test_full_words_use_the_top_bits_of_two_31_bit_draws(void **state) {
    (void)state;
    sf_rng raw = seeded(SF_RNG_RAN1, 5), full = raw;
    for (int i = 0; i < 100; ++i) {
        uint32_t a = (uint32_t)sf_rng_next_raw(&raw), b = (uint32_t)sf_rng_next_raw(&raw);
        assert_int_equal(sf_rng_next_full32(&full), a >> 15 << 16 | b >> 15);
    }
    raw = full = seeded(SF_RNG_MT19937, 5);
    uint64_t high = sf_rng_next_raw(&raw), low = sf_rng_next_raw(&raw);
    assert_true(sf_rng_next_full64(&full) == (high << 32 | low));
}

static void test_philox_counts_beyond_64_bits(void **state) {
    (void)state;
    sf_rng wide = seeded(SF_RNG_PHILOX4X64, 1), narrow = seeded(SF_RNG_PHILOX4X32, 1);
    for (int i = 0; i < 3; ++i) wide.as.philox4x64.counter[i] = UINT64_MAX;
    wide.as.philox4x64.counter[0] -= 40;
    for (int i = 0; i < 3; ++i) narrow.as.philox4x32.counter[i] = UINT32_MAX;
    narrow.as.philox4x32.counter[0] -= 40;
    sf_rng bulk[2] = {wide, narrow}, skipped[2] = {wide, narrow}, walked[2] = {wide, narrow};
    static uint64_t words[400];
    static uint32_t halves[400];
    sf_rng_fill_u64(&bulk[0], 400, words);
    sf_rng_fill_u32(&bulk[1], 400, halves);
    for (int i = 0; i < 400; ++i) {
        assert_true(words[i] == sf_rng_next_raw(&walked[0]));
        assert_true(halves[i] == sf_rng_next_raw(&walked[1]));
    }
    assert_true(walked[0].as.philox4x64.counter[3] == 1 && walked[1].as.philox4x32.counter[3] == 1);
    for (int k = 0; k < 2; ++k) {
        assert_int_equal(sf_rng_skip(&skipped[k], 400, NULL), SF_STATUS_OK);
        assert_true(sf_rng_next_raw(&skipped[k]) == sf_rng_next_raw(&walked[k]));
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

static void test_twisters_jump_to_the_state_that_drawing_reaches(void **state) {
    (void)state; /* beyond 2^13 generations, which are walked, the state is jumped */
    static const sf_rng_kind kinds[] = {SF_RNG_MT19937, SF_RNG_MT19937_64};
    static uint64_t words[2][SF_RNG_STATE_MAX];
    enum { BLOCK = 4096 };
    static uint64_t block[BLOCK];
    for (int k = 0; k < 2; ++k) {
        uint64_t count = (8195 * (k ? 312 : 624) / (2 * BLOCK) + 1) * (uint64_t)(2 * BLOCK) + 100;
        sf_rng walked = seeded(kinds[k], 5), skipped = walked;
        for (uint64_t done = 100; done < count; done += k ? BLOCK : 2 * BLOCK) sf_rng_fill_u64(&walked, BLOCK, block);
        for (int i = 0; i < 100; ++i) sf_rng_next_raw(&walked);
        assert_int_equal(sf_rng_skip(&skipped, count, NULL), SF_STATUS_OK);
        sf_rng_get_state(&walked, words[0]);
        sf_rng_get_state(&skipped, words[1]);
        assert_memory_equal(words[0], words[1], sf_rng_state_size(kinds[k]) * sizeof **words);
    }
}

static void test_methods_without_a_skip_say_so(void **state) {
    (void)state;
    static const sf_rng_kind kinds[] = {SF_RNG_RAN1, SF_RNG_RAN2, SF_RNG_SFC64};
    FOR_EACH_KIND(kind) {
        sf_rng rng = seeded(kind, 5);
        int without = kind == kinds[0] || kind == kinds[1] || kind == kinds[2];
        assert_int_equal(sf_rng_skip(&rng, 1, NULL), without ? SF_STATUS_UNSUPPORTED : SF_STATUS_OK);
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
    static const sf_rng_kind without_zero[] = {
        SF_RNG_MINSTD,     SF_RNG_LCG32,      SF_RNG_LCG64,          SF_RNG_RANDU,        SF_RNG_RAN1,
        SF_RNG_RAN2,       SF_RNG_XORSHIFT64, SF_RNG_XORSHIFT64_LRL, SF_RNG_COMBINED,     SF_RNG_MT19937,
        SF_RNG_MT19937_64, SF_RNG_PCG32,      SF_RNG_PCG64DXSM,      SF_RNG_XOSHIRO256PP, SF_RNG_PHILOX4X64};
    for (size_t i = 0; i < sizeof without_zero / sizeof *without_zero; ++i) {
        sf_rng_kind kind = without_zero[i];
        assert_int_equal(sf_rng_set_state(&rng, kind, words, sf_rng_state_size(kind), &error), SF_STATUS_INVALID_VALUE);
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

/* Edges of types, of moduli and of the words that count what was drawn. */
static void test_words_of_any_value_are_refused_or_are_a_generator(void **state) {
    (void)state;
    static const uint64_t edges[] = {0,          1,          2,          4,       5,          31,
                                     32,         312,        313,        624,     625,        0x7ffffffe,
                                     0x7fffffff, 0x80000000, 0xffffffff, 1u << 5, UINT64_MAX, UINT64_C(1) << 63};
    static uint64_t words[SF_RNG_STATE_MAX];
    static uint32_t out[3000];
    uint64_t draw = 0, taken = 0, refused = 0;
    for (int kind = 0; kind < SF_RNG_COUNT; ++kind)
        for (int k = 0; k < 400; ++k) {
            sf_rng rng, child;
            sf_error error;
            assert_int_equal(sf_rng_init(&rng, (sf_rng_kind)kind, 3, 0, &error), SF_STATUS_OK);
            sf_rng_get_state(&rng, words);
            size_t size = sf_rng_state_size((sf_rng_kind)kind);
            size_t at = k % 2 ? size - 1 - k / 2 % (size < 8 ? size : 8) : sf_hash64(++draw, 1) % size;
            words[at] = k % 5 ? edges[sf_hash64(++draw, 2) % (sizeof edges / sizeof *edges)] : sf_hash64(++draw, 3);
            int good = sf_rng_set_state(&rng, (sf_rng_kind)kind, words, size, &error) == SF_STATUS_OK;
            taken += good;
            refused += !good;
            if (!good) continue;
            for (int i = 0; i < 700; ++i) assert_true(sf_rng_next_f64(&rng) < 1);
            sf_rng_fill_u32(&rng, 3000, out);
            (void)sf_rng_skip(&rng, UINT64_MAX - draw, &error);
            sf_rng_spawn(&rng, 1, &child);
            sf_rng_reset(&rng); /* asserts that the seed is one it can have */
            sf_rng_next_u32(&child);
        }
    assert_true(taken > 0 && refused > 0);
    uint64_t even[1 + 4] = {3, 0, 4, 0, 0}; /* a seed that randu refuses, from which reset would begin */
    sf_rng rng;
    sf_error error;
    assert_int_equal(sf_rng_set_state(&rng, SF_RNG_RANDU, even, 5, &error), SF_STATUS_INVALID_VALUE);
    assert_non_null(strstr(error.message, "seed is 4"));
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
        cmocka_unit_test(test_fills_agree_with_raw_draws),
        cmocka_unit_test(test_split_fills_are_the_whole_fill),
        cmocka_unit_test(test_every_level_gives_the_same_bits),
        cmocka_unit_test(test_long_fills_agree_with_raw_draws_at_every_level),
        cmocka_unit_test(test_single_values_are_those_of_fills),
        cmocka_unit_test(test_full_words_use_the_top_bits_of_two_31_bit_draws),
        cmocka_unit_test(test_philox_counts_beyond_64_bits),
        cmocka_unit_test(test_floats_of_the_largest_words_stay_below_one),
        cmocka_unit_test(test_skip_lands_where_drawing_does),
        cmocka_unit_test(test_twisters_jump_to_the_state_that_drawing_reaches),
        cmocka_unit_test(test_methods_without_a_skip_say_so),
        cmocka_unit_test(test_skips_add_up),
        cmocka_unit_test(test_minstd_returns_after_its_whole_period),
        cmocka_unit_test(test_state_round_trips_in_the_middle_of_a_draw),
        cmocka_unit_test(test_bad_states_are_refused_and_change_nothing),
        cmocka_unit_test(test_words_of_any_value_are_refused_or_are_a_generator),
        cmocka_unit_test(test_streams_and_children_share_no_word),
        cmocka_unit_test(test_bad_seeds_and_names_are_refused_by_name_and_range),
        cmocka_unit_test(test_every_name_finds_its_kind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
