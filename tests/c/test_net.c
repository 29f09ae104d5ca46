// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Sobol' and SZ: matrices, elementary intervals, scrambles, padding, and one result for every way
 * to compute it. The scrambles' laws are in test_scramble.c. */
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include "sunfleck/points.h"

static const sf_pattern nets[] = {SF_PATTERN_SOBOL, SF_PATTERN_SZ};
static const sf_scramble scrambles[] = {SF_SCRAMBLE_NONE, SF_SCRAMBLE_SHIFT, SF_SCRAMBLE_LMS, SF_SCRAMBLE_OWEN,
                                        SF_SCRAMBLE_NESTED};
enum { NETS = 2, SCRAMBLES = 5 };

static sf_points_options options_for(sf_pattern pattern, sf_scramble scramble, uint32_t dims, uint64_t seed) {
    sf_points_options o = sf_points_options_default();
    o.pattern = pattern;
    o.scramble = scramble;
    o.dims = dims;
    o.seed = seed;
    return o;
}

static uint32_t plain_word(sf_pattern pattern, uint32_t index, uint32_t dimension) {
    return pattern == SF_PATTERN_SZ ? sf_sz_bits(index, dimension) : sf_sobol_bits(index, dimension);
}

/* ---- matrices ---- */

static void test_sobol_starts_with_the_published_points(void **state) {
    (void)state;
    /* SciPy's documentation of qmc.Sobol, in Gray-code order, times 8. */
    static const uint32_t published[8][2] = {{0, 0}, {4, 4}, {6, 2}, {2, 6}, {3, 3}, {7, 7}, {5, 1}, {1, 5}};
    for (uint32_t i = 0; i < 8; ++i)
        for (uint32_t d = 0; d < 2; ++d) assert_int_equal(sf_sobol_bits(i ^ i >> 1, d), published[i][d] << 29);
}

/* Row i of a dimension's matrix: bit k is what bit k of the index gives to digit i. */
static void matrix_rows(sf_pattern pattern, uint32_t dimension, uint32_t rows[32]) {
    uint32_t columns[32];
    if (pattern == SF_PATTERN_SZ)
        sf_sz_matrix(dimension, columns);
    else
        sf_sobol_matrix(dimension, columns);
    for (int i = 0; i < 32; ++i) {
        rows[i] = 0;
        for (int k = 0; k < 32; ++k) rows[i] |= (columns[k] >> (31 - i) & 1) << k;
    }
}

static int independent(const uint32_t *rows, int count) {
    uint32_t basis[32] = {0};
    for (int i = 0; i < count; ++i) {
        uint32_t v = rows[i];
        int top = 31;
        for (; v; --top) {
            if (!(v >> top & 1)) continue;
            if (!basis[top]) break;
            v ^= basis[top];
        }
        if (!v) return 0;
        basis[top] = v;
    }
    return 1;
}

/* Whether `total` digits of `bits` bits, however shared among the dimensions from `dimension` on,
 * are independent functions of as many digits of the index: then every aligned block of 2^(bits *
 * total) points has one in each elementary interval of base 2^bits. */
static int fills_intervals(uint32_t (*rows)[32], int dims, int bits, int total, int left, uint32_t *chosen, int count) {
    if (dims == 1) {
        uint32_t mask = total * bits == 32 ? UINT32_MAX : (UINT32_C(1) << total * bits) - 1;
        for (int i = 0; i < left * bits; ++i) chosen[count++] = rows[0][i];
        for (int i = 0; i < count; ++i) chosen[i] &= mask;
        return independent(chosen, count);
    }
    for (int own = 0; own <= left; ++own) {
        uint32_t more[32];
        memcpy(more, chosen, sizeof more);
        for (int i = 0; i < own * bits; ++i) more[count + i] = rows[0][i];
        if (!fills_intervals(rows + 1, dims - 1, bits, total, left - own, more, count + own * bits)) return 0;
    }
    return 1;
}

static void assert_zero_sequence(sf_pattern pattern, uint32_t dimension, int dims, int bits, int most) {
    uint32_t rows[16][32], chosen[32] = {0};
    for (int d = 0; d < dims; ++d) matrix_rows(pattern, dimension + (uint32_t)d, rows[d]);
    for (int total = 1; total <= most; ++total)
        if (!fills_intervals(rows, dims, bits, total, total, chosen, 0))
            fail_msg("%d dimensions from %u on: t > 0 in base %d at %d digits", dims, dimension, 1 << bits, total);
}

static void test_sz_pairs_are_zero_two_sequences_in_base_two(void **state) {
    (void)state;
    for (uint32_t d = 0; d < SF_SZ_MAX_DIMS; d += 2) assert_zero_sequence(SF_PATTERN_SZ, d, 2, 1, 32);
}

static void test_sz_fours_are_zero_four_sequences_in_base_four(void **state) {
    (void)state;
    for (uint32_t d = 0; d < SF_SZ_MAX_DIMS; d += 4) assert_zero_sequence(SF_PATTERN_SZ, d, 4, 2, 16);
}

static void test_every_dimension_alone_is_a_zero_one_sequence(void **state) {
    (void)state; /* distinct indices then have distinct words, which the scrambles rely on */
    for (uint32_t d = 0; d < SF_SOBOL_MAX_DIMS; d += d < 200 ? 1 : 97)
        for (int net = 0; net < NETS; ++net)
            if (d < sf_pattern_max_dims(nets[net])) assert_zero_sequence(nets[net], d, 1, 1, 32);
}

/* ---- elementary intervals of the floats ---- */

/* The least t for which 2^k points of two columns have 2^t in each box of volume 2^(t - k). */
static int t_value(const float *u, uint32_t dims, uint32_t a, uint32_t b, int k) {
    static uint32_t boxes[1 << 12];
    for (int t = 0; t <= k; ++t) {
        int good = 1;
        for (int p = 0; p <= k - t && good; ++p) {
            memset(boxes, 0, sizeof(uint32_t) << (k - t));
            for (size_t i = 0; i < (size_t)1 << k; ++i) {
                uint32_t x = (uint32_t)(u[i * dims + a] * (float)(1 << p));
                uint32_t y = (uint32_t)(u[i * dims + b] * (float)(1 << (k - t - p)));
                ++boxes[x << (k - t - p) | y];
            }
            for (size_t i = 0; i < (size_t)1 << (k - t); ++i) good &= boxes[i] == UINT32_C(1) << t;
        }
        if (good) return t;
    }
    return k + 1;
}

enum { PAIR_DIMS = 4, LOG_POINTS = 10, BLOCKS = 3 };

/* t of every pair at every block length, the greatest over all aligned blocks. */
static void t_values(sf_pattern pattern, sf_scramble scramble, uint64_t seed,
                     int t[PAIR_DIMS][PAIR_DIMS][LOG_POINTS + 1]) {
    static float u[(BLOCKS << LOG_POINTS) * PAIR_DIMS];
    sf_points_options o = options_for(pattern, scramble, PAIR_DIMS, seed);
    assert_int_equal(sf_points_fill_f32(&o, BLOCKS << LOG_POINTS, u, NULL), SF_STATUS_OK);
    for (uint32_t a = 0; a < PAIR_DIMS; ++a)
        for (uint32_t b = a + 1; b < PAIR_DIMS; ++b)
            for (int k = 1; k <= LOG_POINTS; ++k) {
                size_t blocks = (size_t)BLOCKS << (LOG_POINTS - k);
                t[a][b][k] = 0;
                for (size_t block = 0; block < blocks; ++block) {
                    int found = t_value(u + (block << k) * PAIR_DIMS, PAIR_DIMS, a, b, k);
                    if (found > t[a][b][k]) t[a][b][k] = found;
                }
            }
}

static void test_every_scramble_keeps_the_t_value_of_every_pair_and_block(void **state) {
    (void)state; /* base-2 scrambles map elementary intervals onto such: t is that of the plain net */
    for (int net = 0; net < NETS; ++net) {
        int plain[PAIR_DIMS][PAIR_DIMS][LOG_POINTS + 1], t[PAIR_DIMS][PAIR_DIMS][LOG_POINTS + 1];
        t_values(nets[net], SF_SCRAMBLE_NONE, 0, plain);
        for (int s = 1; s < SCRAMBLES; ++s) {
            t_values(nets[net], scrambles[s], 40 + (uint64_t)s, t);
            for (int a = 0; a < PAIR_DIMS; ++a)
                for (int b = a + 1; b < PAIR_DIMS; ++b)
                    for (int k = 1; k <= LOG_POINTS; ++k)
                        if (t[a][b][k] != plain[a][b][k])
                            fail_msg("%s %s, pair %d %d, 2^%d points: t is %d, plain %d", sf_pattern_name(nets[net]),
                                     sf_scramble_name(scrambles[s]), a, b, k, t[a][b][k], plain[a][b][k]);
        }
        print_message("%s, t of pairs at 2^%d points:", sf_pattern_name(nets[net]), LOG_POINTS);
        for (int a = 0; a < PAIR_DIMS; ++a)
            for (int b = a + 1; b < PAIR_DIMS; ++b) print_message(" %d%d:%d", a, b, plain[a][b][LOG_POINTS]);
        print_message("\n");
        for (int k = 1; k <= LOG_POINTS; ++k) assert_int_equal(plain[0][1][k], 0);
        for (int d = 0; d < PAIR_DIMS && nets[net] == SF_PATTERN_SZ; d += 2)
            for (int k = 1; k <= LOG_POINTS; ++k) assert_int_equal(plain[d][d + 1][k], 0);
    }
}

static void test_padded_sets_keep_their_intervals_and_differ(void **state) {
    (void)state;
    enum { DIMS = 10, K = 8 };
    static float u[4 << K][DIMS];
    for (int s = 3; s < SCRAMBLES; ++s) {
        sf_points_options o = options_for(SF_PATTERN_SOBOL, scrambles[s], DIMS, 5);
        o.pad = 2;
        assert_int_equal(sf_points_fill_f32(&o, 4 << K, &u[0][0], NULL), SF_STATUS_OK);
        for (uint32_t d = 0; d < DIMS; d += 2)
            for (int k = 1; k <= K; ++k)
                for (size_t block = 0; block < 4; ++block)
                    assert_int_equal(t_value(u[block << k], DIMS, d, d + 1, k), 0);
        /* Sets in step would have dimension d + 2 in the order of d, up to the scramble's flips: the
         * halves of both would then agree or disagree at every point. */
        for (uint32_t d = 0; d + 2 < DIMS; ++d) {
            int agree = 0;
            for (size_t i = 0; i < 1 << K; ++i) agree += (u[i][d] < 0.5f) == (u[i][d + 2] < 0.5f);
            assert_in_range(agree, 1, (1 << K) - 1);
        }
    }
}

/* ---- one result for every way ---- */

static uint64_t expected_bits(const sf_points_options *o, uint32_t index, uint32_t dimension) {
    sf_scramble scramble = o->scramble;
    if (o->pad) index = sf_padded_index(index, dimension / o->pad, o->seed, scramble);
    uint32_t own = o->pad ? dimension % o->pad : dimension;
    return sf_scramble_word(plain_word(o->pattern, index, own), dimension, o->seed, scramble);
}

static void assert_fills_are_the_samples(const sf_points_options *options, uint64_t first, size_t count) {
    sf_points_options o = *options;
    size_t words = count * o.dims;
    uint32_t *u32 = malloc(words * sizeof *u32);
    float *f32 = malloc(words * sizeof *f32);
    double *f64 = malloc(words * sizeof *f64);
    o.first = first;
    assert_int_equal(sf_points_fill_u32(&o, count, u32, NULL), SF_STATUS_OK);
    assert_int_equal(sf_points_fill_f32(&o, count, f32, NULL), SF_STATUS_OK);
    assert_int_equal(sf_points_fill_f64(&o, count, f64, NULL), SF_STATUS_OK);
    float (*sample)(uint32_t, uint32_t, uint64_t, sf_scramble, uint32_t) =
        o.pattern == SF_PATTERN_SZ ? sf_sz_sample_with : sf_sobol_sample_with;
    for (size_t i = 0; i < words; i += words > 600 ? words / 600 : 1) {
        uint32_t index = (uint32_t)(first + i / o.dims), d = (uint32_t)(i % o.dims);
        uint64_t bits = expected_bits(&o, index, d);
        assert_int_equal(u32[i], bits >> 32);
        assert_true(f32[i] == sf_float_from_bits((uint32_t)(bits >> 32)));
        assert_true(f64[i] == sf_double_from_bits(bits));
        assert_true(f32[i] == sample(index, d, o.seed, o.scramble, o.pad));
        if (o.scramble == SF_SCRAMBLE_OWEN && !o.pad)
            assert_true(f32[i] == (o.pattern == SF_PATTERN_SZ ? sf_sz_sample : sf_sobol_sample)(index, d, o.seed));
    }
    free(u32);
    free(f32);
    free(f64);
}

static void test_fills_are_the_stateless_samples(void **state) {
    (void)state;
    static const uint32_t dims[] = {1, 2, 4, 16, 300, 2100};
    for (int net = 0; net < NETS; ++net)
        for (int s = 0; s < SCRAMBLES; ++s)
            for (int d = 0; d < 6 && dims[d] <= sf_pattern_max_dims(nets[net]); ++d) {
                sf_points_options o = options_for(nets[net], scrambles[s], dims[d], 77);
                assert_fills_are_the_samples(&o, 0, dims[d] > 16 ? 20 : 2500);
                assert_fills_are_the_samples(&o, 1021, dims[d] > 16 ? 7 : 60);
                assert_fills_are_the_samples(&o, UINT32_MAX - 40, 41);
            }
}

static void test_padded_fills_are_the_stateless_samples(void **state) {
    (void)state;
    static const uint32_t dims[] = {1, 2, 3, 7, 64, 6000};
    for (int net = 0; net < NETS; ++net)
        for (int s = 3; s < SCRAMBLES; ++s)
            for (int d = 0; d < 6; ++d)
                for (uint32_t pad = 2; pad <= 4; pad += 2) {
                    sf_points_options o = options_for(nets[net], scrambles[s], dims[d], 78);
                    o.pad = pad;
                    assert_fills_are_the_samples(&o, 0, dims[d] > 64 ? 5 : 300);
                    assert_fills_are_the_samples(&o, UINT32_MAX - 40, dims[d] > 64 ? 5 : 41);
                }
}

static void test_the_first_padded_set_is_the_net(void **state) {
    (void)state;
    uint32_t padded[64 * 4], plain[64 * 4];
    sf_points_options o = options_for(SF_PATTERN_SZ, SF_SCRAMBLE_OWEN, 4, 3);
    assert_int_equal(sf_points_fill_u32(&o, 64, plain, NULL), SF_STATUS_OK);
    o.pad = 4;
    assert_int_equal(sf_points_fill_u32(&o, 64, padded, NULL), SF_STATUS_OK);
    assert_memory_equal(padded, plain, sizeof plain);
}

/* A digest of a fill, by the bits of its numbers. */
static uint64_t digest(const void *numbers, size_t bytes) {
    uint64_t sum = 0;
    for (size_t i = 0; i < bytes / 4; ++i) sum = sf_hash64(sum, ((const uint32_t *)numbers)[i]);
    return sum;
}

static uint64_t fill_digest(const sf_points_options *o, size_t count, int type) {
    size_t words = count * o->dims, bytes = words * (type == 1 ? 8 : 4);
    void *out = malloc(bytes);
    sf_status status = type == 0   ? sf_points_fill_f32(o, count, out, NULL)
                       : type == 1 ? sf_points_fill_f64(o, count, out, NULL)
                                   : sf_points_fill_u32(o, count, out, NULL);
    assert_int_equal(status, SF_STATUS_OK);
    uint64_t sum = digest(out, bytes);
    free(out);
    return sum;
}

static void test_levels_threads_and_teams_change_no_bit(void **state) {
    (void)state;
    static const char *const levels[] = {"baseline", "avx2", "avx512"};
    enum { COUNT = 12345 };
    sf_thread_team *team;
    assert_int_equal(sf_thread_team_create(&team, NULL), SF_STATUS_OK);
    for (int net = 0; net < NETS; ++net)
        for (int s = 0; s < SCRAMBLES; ++s)
            for (int type = 0; type < 3; ++type)
                for (uint32_t pad = 0; pad <= (s < 3 ? 0u : 2u); pad += 2) {
                    sf_points_options o = options_for(nets[net], scrambles[s],
                                                      nets[net] == SF_PATTERN_SZ && !pad ? SF_SZ_MAX_DIMS : 7, 99);
                    o.pad = pad;
                    o.first = 333;
                    unsetenv("SUNFLECK_ISA");
                    uint64_t expected = fill_digest(&o, COUNT, type);
                    for (int level = 0; level < 3; ++level) {
                        setenv("SUNFLECK_ISA", levels[level], 1);
                        o.threads = 1 + (uint32_t)level;
                        assert_true(fill_digest(&o, COUNT, type) == expected);
                        o.team = team;
                        assert_true(fill_digest(&o, COUNT, type) == expected);
                        o.team = NULL;
                    }
                }
    unsetenv("SUNFLECK_ISA");
    sf_thread_team_destroy(team);
}

typedef struct sharer {
    sf_thread_team *team;
    uint64_t expected;
    int wrong;
} sharer;

/* Fills again and again on two threads of the team, now at once and now after it fell asleep. */
static void *share_team(void *argument) {
    sharer *s = argument;
    sf_points_options o = options_for(SF_PATTERN_SOBOL, SF_SCRAMBLE_OWEN, 16, 4);
    static const struct timespec nap = {0, 200000};
    o.team = s->team;
    o.threads = 3;
    for (int i = 0; i < 60; ++i) {
        s->wrong += fill_digest(&o, 4096, 0) != s->expected;
        if (i % 4 == 0) nanosleep(&nap, NULL);
    }
    return NULL;
}

static void test_a_team_may_be_shared(void **state) {
    (void)state;
    sf_points_options o = options_for(SF_PATTERN_SOBOL, SF_SCRAMBLE_OWEN, 16, 4);
    sharer s[2] = {{NULL, fill_digest(&o, 4096, 0), 0}};
    assert_int_equal(sf_thread_team_create(&s[0].team, NULL), SF_STATUS_OK);
    s[1] = s[0];
    pthread_t other;
    assert_int_equal(pthread_create(&other, NULL, share_team, s + 1), 0);
    share_team(s);
    pthread_join(other, NULL);
    assert_int_equal(s[0].wrong + s[1].wrong, 0);
    sf_thread_team_destroy(s[0].team);
    sf_thread_team_destroy(NULL);
}

static void test_an_array_written_past_the_caches_has_the_same_bits(void **state) {
    (void)state;
    enum { COUNT = (4 << 20) + 3, PART = 99991 };
    uint32_t *whole = malloc((COUNT + 1) * sizeof *whole), *part = malloc(PART * sizeof *part);
    sf_points_options o = options_for(SF_PATTERN_SOBOL, SF_SCRAMBLE_OWEN, 1, 1);
    assert_int_equal(sf_points_fill_u32(&o, COUNT, whole + 1, NULL), SF_STATUS_OK);
    for (o.first = 0; o.first + PART <= COUNT; o.first += PART) {
        assert_int_equal(sf_points_fill_u32(&o, PART, part, NULL), SF_STATUS_OK);
        assert_memory_equal(whole + 1 + o.first, part, PART * sizeof *part);
    }
    free(whole);
    free(part);
}

static void test_a_set_fills_any_part(void **state) {
    (void)state;
    enum { DIMS = 21201 };
    static float row[DIMS];
    sf_points_options o = options_for(SF_PATTERN_SOBOL, SF_SCRAMBLE_OWEN, DIMS, 12);
    sf_point_set *set;
    assert_int_equal(sf_point_set_create(&o, &set, NULL), SF_STATUS_OK);
    static const uint64_t indices[] = {0, 1, 0x55555555, 0xffffffff, 123456789};
    for (int i = 0; i < 5; ++i) {
        assert_int_equal(sf_point_set_fill_f32(set, indices[i], 1, row, NULL), SF_STATUS_OK);
        for (uint32_t d = 0; d < DIMS; d += 200) assert_true(row[d] == sf_sobol_sample((uint32_t)indices[i], d, 12));
    }
    sf_point_set_destroy(set);
}

/* ---- bad options ---- */

static void assert_refused(const sf_points_options *o, const char *part) {
    static float out[16] = {0};
    sf_error error;
    assert_int_equal(sf_points_fill_f32(o, 1, out, &error), SF_STATUS_INVALID_VALUE);
    if (!strstr(error.message, part)) fail_msg("\"%s\" does not say \"%s\"", error.message, part);
    for (int i = 0; i < 16; ++i) assert_true(out[i] == 0.0f);
}

static void test_bad_options_are_named(void **state) {
    (void)state;
    sf_points_options good = options_for(SF_PATTERN_SOBOL, SF_SCRAMBLE_OWEN, 2, 0), o = good;
    o.pad = 3;
    assert_refused(&o, "pad is 3");
    o.pad = 2;
    o.scramble = SF_SCRAMBLE_LMS;
    assert_refused(&o, "owen or nested, not lms");
    o = good;
    o.pad = 2;
    o.dims = SF_POINTS_MAX_DIMS + 1;
    assert_refused(&o, "65537");
    o = options_for(SF_PATTERN_RANDOM, SF_SCRAMBLE_DEFAULT, 2, 0);
    o.pad = 2;
    assert_refused(&o, "random");
    o = options_for(SF_PATTERN_SZ, SF_SCRAMBLE_OWEN, SF_SZ_MAX_DIMS + 1, 0);
    assert_refused(&o, "d is 5; sz has 1 .. 4 dimensions");
    o = options_for(SF_PATTERN_SOBOL, SF_SCRAMBLE_OWEN, SF_SOBOL_MAX_DIMS + 1, 0);
    assert_refused(&o, "21201");
    o = options_for(SF_PATTERN_SZ, SF_SCRAMBLE_PERMUTED, 2, 0);
    assert_refused(&o, "none, shift, lms, owen, nested");
    o = good;
    o.first = UINT64_C(1) << 32;
    assert_refused(&o, "4294967296");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sobol_starts_with_the_published_points),
        cmocka_unit_test(test_sz_pairs_are_zero_two_sequences_in_base_two),
        cmocka_unit_test(test_sz_fours_are_zero_four_sequences_in_base_four),
        cmocka_unit_test(test_every_dimension_alone_is_a_zero_one_sequence),
        cmocka_unit_test(test_every_scramble_keeps_the_t_value_of_every_pair_and_block),
        cmocka_unit_test(test_padded_sets_keep_their_intervals_and_differ),
        cmocka_unit_test(test_fills_are_the_stateless_samples),
        cmocka_unit_test(test_padded_fills_are_the_stateless_samples),
        cmocka_unit_test(test_the_first_padded_set_is_the_net),
        cmocka_unit_test(test_levels_threads_and_teams_change_no_bit),
        cmocka_unit_test(test_a_team_may_be_shared),
        cmocka_unit_test(test_an_array_written_past_the_caches_has_the_same_bits),
        cmocka_unit_test(test_a_set_fills_any_part),
        cmocka_unit_test(test_bad_options_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
