// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Generators against published words, and against their own of before. */
#include "sunfleck/rng.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "rng_cases.h"

#define assert_draw(expression, expected) assert_true((expression) == UINT64_C(expected))

/* ---- published ---- */

static void test_minstd_10000th_draw_from_seed_1_is_the_standards(void **state) {
    (void)state; /* C++ standard, rand.predef: minstd_rand0 and minstd_rand */
    assert_draw(draw_number(seeded(SF_RNG_MINSTD, 1), 10000), 1043618065);
    const sf_lcg_parameters p = {48271, 0, 2147483647};
    sf_rng rng;
    assert_int_equal(sf_rng_init_lcg(&rng, SF_RNG_LCG32, &p, 1, 0, NULL), SF_STATUS_OK);
    assert_draw(draw_number(rng, 10000), 399268537);
}

static void test_lcg32_draws_the_words_printed_for_its_constants(void **state) {
    (void)state; /* Press et al. 1992, section 7.1, "Quick and Dirtiest": from 0 */
    static const uint32_t expected[] = {0x3c6ef35f, 0x47502932, 0xd1ccf6e9, 0xaaf95334, 0x6252e503, 0x9f2ec686,
                                        0x57fe6c2d, 0xa3d95fa8, 0x81fdbee7, 0x94f0af1a, 0xcbf633b1};
    sf_rng rng = seeded(SF_RNG_LCG32, 0);
    for (int i = 0; i < 11; ++i) assert_int_equal(sf_rng_next_raw(&rng), expected[i]);
}

static void test_randu_lies_on_planes(void **state) {
    (void)state; /* 65539 = 2^16 + 3, hence x'' = 6 x' - 9 x mod 2^31 (Marsaglia 1968): 15 planes */
    sf_rng rng = seeded(SF_RNG_RANDU, 1);
    int64_t x = sf_rng_next_raw(&rng), y = sf_rng_next_raw(&rng);
    assert_int_equal(x, 65539);
    unsigned planes = 0;
    for (int i = 0; i < 10000; ++i) {
        int64_t z = sf_rng_next_raw(&rng), sum = 9 * x - 6 * y + z;
        assert_int_equal(sum % (INT64_C(1) << 31), 0);
        planes |= 1u << (sum / (INT64_C(1) << 31) + 6); /* the sum is in (-6, 10) 2^31 */
        x = y;
        y = z;
    }
    assert_int_equal(planes, 0x7fff << 1);
}

static void test_ran1_draws_as_printed_and_as_gsl(void **state) {
    (void)state; /* GSL's rng/test.c: seed 1, 10,000th */
    static const uint32_t expected[] = {893351816, 197493099, 1624379149, 1137522503};
    sf_rng rng = seeded(SF_RNG_RAN1, 1);
    for (int i = 0; i < 4; ++i) assert_int_equal(sf_rng_next_raw(&rng), expected[i]);
    assert_draw(draw_number(seeded(SF_RNG_RAN1, 1), 10000), 1491066076);
}

static void test_ran2_10000th_draw_is_gsls(void **state) {
    (void)state; /* GSL's rng/test.c: seed 1 */
    assert_draw(draw_number(seeded(SF_RNG_RAN2, 1), 10000), 1701364455);
}

static void test_mt19937_draws_the_references_words(void **state) {
    (void)state; /* C++ standard, rand.predef, and the first from the default seed */
    static const uint32_t expected[] = {3499211612, 581869302, 3890346734, 3586334585, 545404204};
    sf_rng rng = seeded(SF_RNG_MT19937, 5489);
    for (int i = 0; i < 5; ++i) assert_int_equal(sf_rng_next_raw(&rng), expected[i]);
    assert_draw(draw_number(seeded(SF_RNG_MT19937, 5489), 10000), 4123659995);
    assert_draw(draw_number(seeded(SF_RNG_MT19937_64, 5489), 10000), 9981545732273789042);
}

static void test_mt19937_streams_are_seeded_by_init_by_array(void **state) {
    (void)state; /* mt19937ar.out of the authors: key 0x123, 0x234, 0x345, 0x456 */
    sf_rng rng;
    uint64_t seed = UINT64_C(0x0000023400000123), stream = UINT64_C(0x0000045600000345);
    assert_int_equal(sf_rng_init(&rng, SF_RNG_MT19937, seed, stream, NULL), SF_STATUS_OK);
    static const uint32_t expected[] = {1067595299, 955945823, 477289528, 4107218783, 4228976476};
    for (int i = 0; i < 5; ++i) assert_int_equal(sf_rng_next_raw(&rng), expected[i]);
}

static void test_pcg32_draws_the_references_words(void **state) {
    (void)state; /* pcg32-demo of pcg-c-basic, seeded (42, 54) */
    static const uint32_t expected[] = {0xa15c02b7, 0x7b47f409, 0xba1d3330, 0x83d2f293, 0xbfa4784b, 0xcbed606e};
    sf_pcg32 g = sf_pcg32_seeded(42, 54);
    for (int i = 0; i < 6; ++i) assert_int_equal(sf_pcg32_next(&g), expected[i]);
}

static void test_sfc64_draws_practrands_words_from_seed_0(void **state) {
    (void)state; /* "RNG_output sfc64" of PractRand; also in the tests of Zig's standard library */
    static const uint64_t expected[] = {UINT64_C(0x3acfa029e3cc6041), UINT64_C(0xf5b6515bf2ee419c),
                                        UINT64_C(0x1259635894a29b61), UINT64_C(0x0b6ae75395f8ebd6)};
    sf_rng rng = seeded(SF_RNG_SFC64, 0);
    for (int i = 0; i < 4; ++i) assert_true(sf_rng_next_raw(&rng) == expected[i]);
}

static void test_philox4x32_gives_random123s_known_answers(void **state) {
    (void)state; /* kat_vectors of Random123: zeros, ones, digits of pi */
    static const struct {
        uint32_t counter[4], key[2], expected[4];
    } cases[] = {
        {{0, 0, 0, 0}, {0, 0}, {0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}},
        {{0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff},
         {0xffffffff, 0xffffffff},
         {0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}},
        {{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344},
         {0xa4093822, 0x299f31d0},
         {0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}},
    };
    for (size_t c = 0; c < 3; ++c) {
        uint32_t block[4];
        sf_philox4x32_block(cases[c].counter, cases[c].key, block);
        assert_memory_equal(block, cases[c].expected, sizeof block);
    }
    sf_rng rng = seeded(SF_RNG_PHILOX4X32, 0);
    for (int i = 0; i < 4; ++i) assert_int_equal(sf_rng_next_raw(&rng), cases[0].expected[i]);
}

static void test_philox_10000th_draws_are_the_standards(void **state) {
    (void)state; /* C++26, rand.predef: philox4x32 and philox4x64, from their default seed */
    assert_draw(draw_number(seeded(SF_RNG_PHILOX4X32, 20111115), 10000), 1955073260);
    assert_draw(draw_number(seeded(SF_RNG_PHILOX4X64, 20111115), 10000), 3409172418970261260);
}

static void test_splitmix64_draws_the_published_words(void **state) {
    (void)state; /* Rosetta Code, "Pseudo-random numbers/Splitmix64" */
    sf_rng rng = seeded(SF_RNG_SPLITMIX64, 1234567);
    assert_draw(sf_rng_next_raw(&rng), 6457827717110365317);
    assert_draw(sf_rng_next_raw(&rng), 3203168211198807973);
}

static void test_xoshiro256pp_draws_the_references_words_from_state_1_2_3_4(void **state) {
    (void)state; /* of xoshiro256plusplus.c; also in the tests of Rust's rand_xoshiro */
    sf_xoshiro256pp g = {{1, 2, 3, 4}};
    assert_draw(sf_xoshiro256pp_next(&g), 41943041);
    assert_draw(sf_xoshiro256pp_next(&g), 58720359);
    assert_draw(sf_xoshiro256pp_next(&g), 3588806011781223);
}

static void test_xoshiro256pp_is_seeded_by_splitmix64(void **state) {
    (void)state;
    sf_rng rng = seeded(SF_RNG_XOSHIRO256PP, 1234567);
    assert_draw(rng.as.xoshiro256pp.s[0], 6457827717110365317);
    assert_draw(rng.as.xoshiro256pp.s[1], 3203168211198807973);
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

static void test_the_two_high_products_agree(void **state) {
    (void)state;
    sf_splitmix64 words = {1};
    for (int i = 0; i < 10000; ++i) {
        uint64_t a = sf_splitmix64_next(&words) >> (i % 40), b = sf_splitmix64_next(&words);
        if (i % 7 == 0) a = ~a;
        assert_true(sf_multiply_high64(a, b) == sf_multiply_high64_by_halves(a, b));
    }
    assert_true(sf_multiply_high64(UINT64_MAX, UINT64_MAX) == UINT64_MAX - 1); /* (2^64 - 1)^2 */
    assert_true(sf_multiply_high64_by_halves(UINT64_MAX, UINT64_MAX) == UINT64_MAX - 1);
}

/* ---- frozen ---- */

static uint64_t fold(const void *data, size_t bytes, uint64_t hash) {
    const unsigned char *byte = data; /* FNV-1a */
    for (size_t i = 0; i < bytes; ++i) hash = (hash ^ byte[i]) * UINT64_C(0x100000001b3);
    return hash;
}

enum { FROZEN = 1500 };

/* Of seed 12345: the first value of each fill, and hashes of 1500 values of all four for streams
 * 0 and 3. Recorded from version 0.1; a change of any is a breaking change. */
static const struct {
    const char *name;
    uint32_t u32;
    uint64_t u64;
    float f32;
    double f64;
    uint64_t hashes[2];
} golden[SF_RNG_COUNT] = {
    {"minstd",
     0x0c5dee2f,
     UINT64_C(0x6ac056000c5dee2f),
     0x1.8bbdcp-4f,
     0x1.8bbdc5ab0158p-4,
     {UINT64_C(0xf2e087d7b2d72cbd), UINT64_C(0x57a67b20432dfb52)}},
    {"lcg32",
     0x05391c44,
     UINT64_C(0x043c7ad305391c44),
     0x1.4e47p-6f,
     0x1.4e471021e3d6p-6,
     {UINT64_C(0xb711d63e68b4d52b), UINT64_C(0xf507198263375f3f)}},
    {"lcg64",
     0x0c894254,
     UINT64_C(0x1c0d57f10c894254),
     0x1.91284p-5f,
     0x1.c0d57f10c894p-4,
     {UINT64_C(0xdf8a77f4c257e8de), UINT64_C(0xf385838673f32242)}},
    {"randu",
     0x303990ab,
     UINT64_C(0x2157b201303990ab),
     0x1.81cc84p-2f,
     0x1.81cc852157b2p-2,
     {UINT64_C(0x07a4c2b86f45e09e), UINT64_C(0x31f0bcf8ee4b2e25)}},
    {"ran1",
     0x7628d09c,
     UINT64_C(0x2aa48c567628d09c),
     0x1.d8a342p-1f,
     0x1.d8a3425552462p-1,
     {UINT64_C(0xffc66cd752665f7c), UINT64_C(0x7bce44c3fd8df727)}},
    {"ran2",
     0x037b4475,
     UINT64_C(0x078bc3b6037b4475),
     0x1.bda2p-6f,
     0x1.bda23878bc3ap-6,
     {UINT64_C(0x7dcda2a1ade38723), UINT64_C(0xf34abe8bb331fe37)}},
    {"xorshift64",
     0x8000333a,
     UINT64_C(0x000199d48000333a),
     0x1.000066p-1f,
     0x1.99d480003p-16,
     {UINT64_C(0xac99d54babab86d8), UINT64_C(0x49377a3c5676afc6)}},
    {"xorshift64-lrl",
     0x752333a9,
     UINT64_C(0x00000066752333a9),
     0x1.d48cccp-2f,
     0x1.99d48ccp-26,
     {UINT64_C(0x7d364b7fc31a7adf), UINT64_C(0xd255051e910c227c)}},
    {"combined",
     0x22ee604f,
     UINT64_C(0x9a8003ce22ee604f),
     0x1.1773p-3f,
     0x1.3500079c45dccp-1,
     {UINT64_C(0xb785137fe5399bdc), UINT64_C(0x8d328969b128a237)}},
    {"mt19937",
     0xedfb51e2,
     UINT64_C(0xe3e12de5edfb51e2),
     0x1.dbf6a2p-1f,
     0x1.dbf6a3f8f84b7p-1,
     {UINT64_C(0x9d424eed93c0ce40), UINT64_C(0xeba59dfda23d715b)}},
    {"mt19937-64",
     0xe2220cba,
     UINT64_C(0x5b8d9f1be2220cba),
     0x1.c44418p-1f,
     0x1.6e367c6f88882p-2,
     {UINT64_C(0x57e170e836ba064a), UINT64_C(0x2ec06f1229a87c51)}},
    {"pcg32",
     0x1220b391,
     UINT64_C(0x98d38aaa1220b391),
     0x1.220b3p-4f,
     0x1.220b3931a715p-4,
     {UINT64_C(0xde861587b52dc5db), UINT64_C(0x8100a27a4ef861d8)}},
    {"pcg64dxsm",
     0x928222af,
     UINT64_C(0xf6f6284e928222af),
     0x1.250444p-1f,
     0x1.edec509d25044p-1,
     {UINT64_C(0x7935a36c329d62f6), UINT64_C(0x98ddcf43f07067df)}},
    {"xoshiro256++",
     0xdef8a568,
     UINT64_C(0x8d948a82def8a568),
     0x1.bdf14ap-1f,
     0x1.1b291505bdf14p-1,
     {UINT64_C(0x8fbfa61350b3f28e), UINT64_C(0xc577b6671fd12947)}},
    {"sfc64",
     0x3fdc26a8,
     UINT64_C(0x577c74fe3fdc26a8),
     0x1.fee13p-3f,
     0x1.5df1d3f8ff708p-2,
     {UINT64_C(0xb3267d179c14d2a8), UINT64_C(0x38f3995745e4da10)}},
    {"philox4x32",
     0xd1fa3e81,
     UINT64_C(0x2f7fea51d1fa3e81),
     0x1.a3f47cp-1f,
     0x1.a3f47d0bdffa9p-1,
     {UINT64_C(0x1f3d3124d70feff3), UINT64_C(0x382427ffcd8523f1)}},
    {"philox4x64",
     0xb1976839,
     UINT64_C(0x6681025cb1976839),
     0x1.632edp-1f,
     0x1.9a040972c65dap-2,
     {UINT64_C(0x5bf608f710e23f0f), UINT64_C(0xcef67ea6824a26bd)}},
    {"splitmix64",
     0xa9d111a0,
     UINT64_C(0x22118258a9d111a0),
     0x1.53a222p-1f,
     0x1.108c12c54e888p-3,
     {UINT64_C(0xf3ecb8a03ac40732), UINT64_C(0x23cc5f7409efab15)}},
};

static uint64_t hash_of_fills(sf_rng_kind kind, uint64_t stream) {
    static uint32_t words[FROZEN];
    static uint64_t wide[FROZEN];
    static float floats[FROZEN];
    static double doubles[FROZEN];
    sf_rng a, b, c, d;
    assert_int_equal(sf_rng_init(&a, kind, 12345, stream, NULL), SF_STATUS_OK);
    b = c = d = a;
    sf_rng_fill_u32(&a, FROZEN, words);
    sf_rng_fill_u64(&b, FROZEN, wide);
    sf_rng_fill_f32(&c, FROZEN, floats);
    sf_rng_fill_f64(&d, FROZEN, doubles);
    uint64_t hash = fold(words, sizeof words, UINT64_C(0xcbf29ce484222325));
    hash = fold(wide, sizeof wide, hash);
    hash = fold(floats, sizeof floats, hash);
    return fold(doubles, sizeof doubles, hash);
}

static void test_streams_are_those_of_before(void **state) {
    (void)state;
    FOR_EACH_KIND(kind) {
        sf_rng a = seeded(kind, 12345), b = a, c = a, d = a;
        assert_string_equal(golden[kind].name, sf_rng_name(kind));
        assert_int_equal(sf_rng_next_u32(&a), golden[kind].u32);
        assert_true(sf_rng_next_u64(&b) == golden[kind].u64);
        assert_true(sf_rng_next_f32(&c) == golden[kind].f32);
        assert_true(sf_rng_next_f64(&d) == golden[kind].f64);
        assert_true(hash_of_fills(kind, 0) == golden[kind].hashes[0]);
        assert_true(hash_of_fills(kind, 3) == golden[kind].hashes[1]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_minstd_10000th_draw_from_seed_1_is_the_standards),
        cmocka_unit_test(test_lcg32_draws_the_words_printed_for_its_constants),
        cmocka_unit_test(test_randu_lies_on_planes),
        cmocka_unit_test(test_ran1_draws_as_printed_and_as_gsl),
        cmocka_unit_test(test_ran2_10000th_draw_is_gsls),
        cmocka_unit_test(test_mt19937_draws_the_references_words),
        cmocka_unit_test(test_mt19937_streams_are_seeded_by_init_by_array),
        cmocka_unit_test(test_pcg32_draws_the_references_words),
        cmocka_unit_test(test_sfc64_draws_practrands_words_from_seed_0),
        cmocka_unit_test(test_philox4x32_gives_random123s_known_answers),
        cmocka_unit_test(test_philox_10000th_draws_are_the_standards),
        cmocka_unit_test(test_splitmix64_draws_the_published_words),
        cmocka_unit_test(test_xoshiro256pp_draws_the_references_words_from_state_1_2_3_4),
        cmocka_unit_test(test_xoshiro256pp_is_seeded_by_splitmix64),
        cmocka_unit_test(test_xorshift64_first_draws_from_state_1_follow_by_hand),
        cmocka_unit_test(test_combined_is_the_xor_of_its_parts),
        cmocka_unit_test(test_the_two_high_products_agree),
        cmocka_unit_test(test_streams_are_those_of_before),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
