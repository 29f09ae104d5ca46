// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "coordinates.h"

#include <assert.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "error.h"
#include "halton.h"
#include "sunfleck/render.h"

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

/* Gives each group of the plan its place. Light points have the best pair, (0, 1): a block of
 * 16 then has one point in each cell of a 4 x 4 grid on the light. */
static void assign_sources(sf_coordinates *coordinates, const sf_plan *plan) {
    bool lens = plan->stages >> SF_STAGE_LENS & 1u;
    for (uint32_t g = 0; g < plan->dimension_group_count; ++g) {
        const sf_plan_dimensions *group = plan->dimensions + g;
        sf_coordinate_source *source = coordinates->sources + g;
        *source = (sf_coordinate_source){.first = group->first, .count = group->count, .set = group->bounce - 1};
        switch (group->use) {
            case SF_DIMENSION_PIXEL:
                /* Apart from the first vertex's, where that has the same dimensions. */
                source->set = lens || plan->surface_rays > 0 || plan->max_bounces > 1 ? plan->max_bounces : 0;
                source->dimension = 2;
                break;
            case SF_DIMENSION_LENS:
                source->set = plan->max_bounces;
                source->dimension = 0;
                break;
            case SF_DIMENSION_LIGHT: source->dimension = 0; break;
            case SF_DIMENSION_SURFACE: source->dimension = 2; break;
            case SF_DIMENSION_CHOICE: source->dimension = 4; break;
            case SF_DIMENSION_LOBE: source->dimension = 5; break;
            case SF_DIMENSION_FOG:
                if (group->bounce == 0) source->set = plan->max_bounces;
                source->dimension = 7;
                break;
        }
    }
}

/* The path's dimensions are those of the groups, one after another, and then roulette's. */
static void assign_primes(sf_coordinates *coordinates, const sf_plan *plan) {
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

static sf_status choose_cells(sf_coordinates *coordinates, uint32_t spp, sf_error *error) {
    bool uniform = coordinates->pattern == SF_PATTERN_UNIFORM;
    if (!uniform && coordinates->pattern != SF_PATTERN_JITTERED) return SF_STATUS_OK;
    if (uniform && spp == 0)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "pattern uniform needs to know its total ahead: give spp, or choose another pattern");
    coordinates->cells = spp ? spp : SF_LANES;
    return sf_grid_sides(coordinates->cells, 2, coordinates->sides, error);
}

int sf_render_takes_pattern(sf_pattern pattern) {
    return pattern == SF_PATTERN_UNIFORM || pattern == SF_PATTERN_RANDOM || pattern == SF_PATTERN_JITTERED ||
           pattern == SF_PATTERN_HALTON || pattern == SF_PATTERN_SOBOL;
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

sf_status sf_coordinates_init(sf_coordinates *coordinates, sf_pattern pattern, const sf_plan *plan, uint32_t spp,
                              uint64_t seed, sf_error *error) {
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
