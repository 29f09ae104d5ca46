// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* coordinates: the renderer's blocks of Halton's points are the stateless ones, bit for bit, at
 * every instruction set; blocks that share packets keep their samples. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka.h needs those. */
#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "sunfleck/render.h"
#include "trace/sample_dimensions_kernels.h"

enum { GROUPS = 5 * SF_MAX_BOUNCES };

static sf_sample_dimensions coordinates;
static float made[2][SF_PATHS], expected[2][SF_PATHS];

/* As long a path as there is: of each bounce all that it can have. */
static void prepare(sf_pattern pattern) {
    sf_plan plan;
    sf_error error;
    memset(&plan, 0, sizeof plan);
    static const sf_dimension_use uses[5] = {SF_DIMENSION_LIGHT, SF_DIMENSION_SURFACE, SF_DIMENSION_CHOICE,
                                             SF_DIMENSION_LOBE, SF_DIMENSION_FOG};
    for (uint32_t g = 0; g < GROUPS; ++g) {
        uint32_t count = g % 5 < 2 ? 2 : 1;
        plan.dimensions[g] = (sf_plan_dimensions){
            .use = uses[g % 5], .bounce = 1 + g / 5, .first = plan.dimensions_per_path, .count = count};
        plan.dimensions_per_path += count;
    }
    plan.max_bounces = SF_MAX_BOUNCES;
    plan.dimension_group_count = GROUPS;
    assert_int_equal(sf_sample_dimensions_init(&coordinates, pattern, &plan, 48, 1, &error), SF_STATUS_OK);
}

static void expect_stateless(uint32_t group, const sf_block blocks[SF_BLOCKS]) {
    const sf_coordinate_source *source = coordinates.sources + group;
    for (uint32_t d = 0; d < source->count; ++d)
        for (uint32_t i = 0; i < SF_BLOCKS * SF_LANES; ++i)
            expected[d][i] =
                sf_halton_sample(blocks[i / SF_LANES].base + i % SF_LANES, source->first + d, blocks[i / SF_LANES].key);
    for (int isa = SF_ISA_BASELINE; isa <= (int)sf_isa_active(); ++isa) {
        sf_sample_dimensions_kernels_at((sf_isa)isa)->fill(&coordinates, source, blocks, SF_BLOCKS, made);
        for (uint32_t d = 0; d < source->count; ++d)
            for (uint32_t i = 0; i < SF_BLOCKS * SF_LANES; ++i)
                if (memcmp(made[d] + i, expected[d] + i, sizeof(float)) != 0)
                    fail_msg("level %d, dimension %u, index %u, key %llx: %a, not %a", isa, source->first + d,
                             blocks[i / SF_LANES].base + i % SF_LANES, (unsigned long long)blocks[i / SF_LANES].key,
                             made[d][i], expected[d][i]);
    }
}

/* Where digits carry: around powers of the base, about 2^31, at both ends of the indices; and
 * anywhere, from few digits to all. */
static void choose_blocks(uint32_t group, uint64_t seed, sf_block blocks[SF_BLOCKS]) {
    static const uint32_t bases[] = {0,           16,          0x7fffffe0u, 0x7ffffff0u, 0x80000000u,
                                     0x80000010u, 0xffffffe0u, 0xfffffff0u, 0xfffffff0u, 1024};
    uint64_t power = coordinates.sources[group].primes[0];
    for (uint32_t b = 0; b < SF_BLOCKS; ++b) {
        uint64_t hash = sf_hash64(seed, b);
        uint32_t base = (uint32_t)(hash >> (32 + b % 32));
        if (b < sizeof bases / sizeof *bases) {
            base = bases[b];
        } else if (b < 32 && power <= UINT32_MAX) {
            base = (uint32_t)power - (b % 2) * 16; /* the power lies in this block, or ends the one before */
            if (b % 2) power *= coordinates.sources[group].primes[0];
        }
        blocks[b] = (sf_block){.key = sf_mix64(hash), .base = base & ~15u};
    }
    blocks[40].key = 0;
    blocks[41].key = UINT64_MAX;
}

/* Of the first ten groups, bases 2 to 47, 25 sets of keys. The kernel's bounds are 1 / power apart,
 * the first power of the base from 2^36 on, and a coordinate's word changes at 2^24 borders of
 * floats and at up to as many of intervals: one coordinate in 3,025 (base 3) to 48,184 (base 31)
 * is left to the exact sum, by which some 56 of these are to be expected. */
static void test_halton_is_the_stateless_one(void **state) {
    (void)state;
    sf_block blocks[SF_BLOCKS];
    prepare(SF_PATTERN_HALTON);
    for (uint32_t group = 0; group < GROUPS; ++group)
        for (uint64_t set = 0; set < (group < 10 ? 24 / TEST_STRIDE + 1 : 1); ++set) {
            choose_blocks(group, sf_hash64(group, set), blocks);
            expect_stateless(group, blocks);
        }
}

/* Of blocks that share packets every lane is what it is in the whole block. */
static void expect_same_lanes(const sf_coordinate_source *source, const sf_block *blocks, uint32_t count,
                              uint32_t width, uint32_t first_sample, sf_isa isa) {
    static float scratch[2][SF_PATHS];
    const sf_sample_dimensions_kernels *kernels = sf_sample_dimensions_kernels_at(isa);
    kernels->fill(&coordinates, source, blocks, count, expected);
    kernels->fill_narrow(&coordinates, source, blocks, count, width, first_sample, scratch, made);
    for (uint32_t d = 0; d < source->count; ++d)
        for (uint32_t i = 0; i < count * width; ++i) {
            uint32_t whole = i / width * SF_LANES + first_sample + i % width;
            if (memcmp(made[d] + i, expected[d] + whole, sizeof(float)) != 0)
                fail_msg("level %d, pattern %d, dimension %u, width %u: lane %u is %a, not %a", (int)isa,
                         (int)coordinates.pattern, source->first + d, width, i, made[d][i], expected[d][whole]);
        }
}

static void test_blocks_that_share_packets_keep_their_samples(void **state) {
    (void)state;
    static const sf_pattern patterns[] = {SF_PATTERN_SOBOL, SF_PATTERN_RANDOM, SF_PATTERN_JITTERED, SF_PATTERN_UNIFORM,
                                          SF_PATTERN_HALTON};
    static const uint32_t counts[] = {1, 7, SF_BLOCKS}; /* packets that the blocks do not fill, too */
    sf_block blocks[SF_BLOCKS];
    for (size_t p = 0; p < sizeof patterns / sizeof *patterns; ++p) {
        prepare(patterns[p]);
        for (uint32_t b = 0; b < SF_BLOCKS; ++b)
            blocks[b] = (sf_block){.key = sf_hash64(5, b), .base = (uint32_t)sf_hash64(6, b) & 0xffff0u};
        for (uint32_t group = 0; group < 8; ++group)
            for (uint32_t width = 1; width < SF_LANES; width *= 2)
                for (int i = 0; i < 9; ++i)
                    expect_same_lanes(coordinates.sources + group, blocks, counts[i / 3], width,
                                      (uint32_t)(i * 5) % SF_LANES / width * width,
                                      (sf_isa)(i % ((int)sf_isa_active() + 1)));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_halton_is_the_stateless_one),
        cmocka_unit_test(test_blocks_that_share_packets_keep_their_samples),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
