// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Assigns the plan's dimensions to sets of the pattern, and readies the pattern's tables. */
#include "trace/sample_dimensions.h"

#include <assert.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "film/block.h"
#include "points/halton.h"
#include "sunfleck/film.h"

/* Sums a matrix over the bytes of the index, in reversed bits. */
static void tabulate_sobol(uint32_t dimension, uint32_t table[4][256]) {
    uint32_t columns[32];
    sf_sobol_matrix(dimension, columns);
    for (int byte = 0; byte < 4; ++byte)
        for (uint32_t value = 0; value < 256; ++value) {
            uint32_t sum = 0;
            for (int bit = 0; bit < 8; ++bit)
                if (value >> bit & 1u) sum ^= columns[8 * byte + bit];
            table[byte][value] = sf_reverse_bits32(sum);
        }
}

/* Who takes the next dimensions of a set. The light points of the first vertex have the best pair, (0, 1): a
 * block of 16 then has one point in each cell of a 4 x 4 grid on the light. Its surface has the next
 * best: with dimensions 4 and 5, whose cells of 1/256 may hold 8 of 256 points, cornell's error is 1.7
 * times as large. With the lens before the pixel defocus would have as little error, but the error
 * would fall in uneven steps as samples double, which half-widths could not tell: 0.53 of its variance at 64. */
static int turn_of(const sf_plan_dimensions *group) {
    switch (group->use) {
        case SF_DIMENSION_LIGHT:
        case SF_DIMENSION_SURFACE: return 0;
        case SF_DIMENSION_PIXEL: return 1;
        case SF_DIMENSION_LENS: return 2;
        default: return 3;
    }
}

static uint32_t set_of(const sf_plan *plan, uint32_t bounce) {
    if (bounce) return (bounce - 1) / SF_SET_BOUNCES;
    return plan->max_bounces > 1 ? SF_CAMERA_SET : 0;
}

/* Gives each group of the plan its place. */
static void assign_sources(sf_sample_dimensions *coordinates, const sf_plan *plan) {
    uint32_t taken[SF_CAMERA_SET + 1] = {0};
    for (int turn = 0; turn <= 3; ++turn)
        for (uint32_t g = 0; g < plan->dimension_group_count; ++g) {
            const sf_plan_dimensions *group = plan->dimensions + g;
            if (turn_of(group) != turn) continue;
            uint32_t set = set_of(plan, group->bounce);
            coordinates->sources[g] = (sf_coordinate_source){
                .set = set, .dimension = taken[set], .first = group->first, .count = group->count};
            taken[set] += group->count;
            assert(taken[set] <= SF_SET_ROULETTE);
        }
}

/* The path's dimensions are those of the groups, one after another, and then roulette's. */
static void assign_primes(sf_sample_dimensions *coordinates, const sf_plan *plan) {
    uint32_t dimension = 0, prime = sf_next_prime(0);
    for (uint32_t g = 0; g < plan->dimension_group_count; ++g) {
        sf_coordinate_source *source = coordinates->sources + g;
        assert(source->first == dimension);
        for (uint32_t d = 0; d < source->count; ++d, ++dimension, prime = sf_next_prime(prime))
            source->primes[d] = prime;
    }
    assert(dimension == plan->dimensions_per_path);
    for (uint32_t bounce = 0; bounce <= plan->max_bounces; ++bounce, prime = sf_next_prime(prime))
        coordinates->roulette_primes[bounce] = prime;
}

static sf_status choose_cells(sf_sample_dimensions *coordinates, uint32_t spp, sf_error *error) {
    bool uniform = coordinates->pattern == SF_PATTERN_UNIFORM;
    if (!uniform && coordinates->pattern != SF_PATTERN_JITTERED) return SF_STATUS_OK;
    if (uniform && spp == 0)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "pattern uniform needs to know its total ahead: give spp, or choose another pattern");
    coordinates->cells = spp ? spp : SF_LANES;
    return sf_grid_sides(coordinates->cells, 2, coordinates->sides, error);
}

static sf_status refuse_pattern(sf_pattern pattern, sf_error *error) {
    char names[256] = "";
    size_t length = 0;
    const char *name = sf_pattern_name(pattern);
    for (int p = 0; sf_pattern_name((sf_pattern)p) && length < sizeof names; ++p)
        if (sf_render_takes_pattern((sf_pattern)p))
            length += (size_t)snprintf(names + length, sizeof names - length, "%s%s", length ? ", " : "",
                                       sf_pattern_name((sf_pattern)p));
    return sf_fail(error, SF_STATUS_INVALID_VALUE, "pattern %s can't be rendered with; choose one of %s",
                   name ? name : "?", names);
}

sf_status sf_sample_dimensions_init(sf_sample_dimensions *coordinates, sf_pattern pattern, const sf_plan *plan,
                                    uint32_t spp, uint64_t seed, sf_error *error) {
    if (!sf_render_takes_pattern(pattern)) return refuse_pattern(pattern, error);
    memset(coordinates, 0, sizeof *coordinates);
    coordinates->pattern = pattern;
    coordinates->seed = seed;
    assign_sources(coordinates, plan);
    if (pattern == SF_PATTERN_HALTON) assign_primes(coordinates, plan);
    if (pattern == SF_PATTERN_SOBOL)
        for (uint32_t d = 0; d < SF_SET_DIMENSIONS; ++d) tabulate_sobol(d, coordinates->sobol[d]);
    return choose_cells(coordinates, spp, error);
}
