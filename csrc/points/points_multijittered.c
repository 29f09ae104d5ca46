// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Correlated multi-jittered points (Kensler 2013, "Correlated Multi-Jittered Sampling"): n = m k
 * points, one in each cell of an m x k grid, and one in each of n strata of either coordinate.
 * The point of cell (i, j) lies in stratum i k + s(j) of the first and j m + t(i) of the second,
 * with one random permutation s for all columns and one t for all rows, which keeps neighbours
 * apart better than a permutation for each (his section 2).
 *
 * Here the cells are taken in a random order (his section 3), and further dimensions are further
 * such sets, two dimensions each, with keys and orders of their own; the last dimension of an
 * odd number is the first coordinate of a set. */
#include <assert.h>
#include <string.h>

#include "base/error.h"
#include "base/platform.h"
#include "points/permutation.h"
#include "points/points_set.h"
#include "points/strata.h"

enum { ORDER_KEYS = SF_PERMUTATION_MAX_KEYS };

/* The permutations of a pair of dimensions: what the keys of its order, of s and of t come from. */
static uint64_t pair_key(uint64_t seed, uint32_t dimension, unsigned which) {
    return sf_hash64(sf_hash64(seed, dimension / 2), which);
}

static uint32_t place_key(uint64_t seed, uint32_t dimension) {
    return (uint32_t)(pair_key(seed, dimension, 3 + dimension % 2) >> 32);
}

/* One block of memory. */
typedef struct multijittered_tables {
    uint32_t sides[2];          /* m, k */
    sf_permutation_shape shape; /* of n */
    uint32_t *orders;           /* [pairs][ORDER_KEYS] */
    uint32_t *shuffles[2];      /* [pairs][k]: s, and [pairs][m]: t */
} multijittered_tables;

static void tabulate(uint32_t count, uint64_t key, uint32_t *images) {
    uint32_t keys[SF_PERMUTATION_MAX_KEYS];
    sf_permutation_shape shape = sf_permutation_shape_of(count);
    sf_permutation_keys(&shape, key, keys);
    for (uint32_t i = 0; i < count; ++i) images[i] = sf_permute(&shape, i, keys);
}

sf_status sf_multijittered_valid_counts(uint64_t n, uint64_t *below, uint64_t *above) {
    sf_grid_valid_counts(n < SF_FLOAT_STRATA ? n : SF_FLOAT_STRATA, 2, below, above);
    if (n > SF_FLOAT_STRATA) *above = 0;
    return SF_STATUS_OK;
}

sf_status sf_multijittered_prepare(sf_point_set *set, sf_error *error) {
    uint32_t pairs = (set->options.dims + 1) / 2, sides[2];
    sf_status status = sf_grid_sides(set->options.total, 2, sides, error);
    if (status != SF_STATUS_OK) return status;
    size_t words = (size_t)pairs * (ORDER_KEYS + sides[0] + sides[1]);
    size_t bytes = sizeof(multijittered_tables) + words * sizeof(uint32_t);
    multijittered_tables *t = set->block = sf_aligned_alloc(bytes);
    if (!t) return sf_fail_memory(error, "the tables of multijittered", bytes);
    memcpy(t->sides, sides, sizeof t->sides);
    t->shape = sf_permutation_shape_of(set->options.total);
    t->orders = (uint32_t *)(void *)(t + 1);
    t->shuffles[0] = t->orders + (size_t)pairs * ORDER_KEYS;
    t->shuffles[1] = t->shuffles[0] + (size_t)pairs * sides[1];
    for (uint32_t pair = 0; pair < pairs; ++pair) {
        uint64_t seed = set->options.seed;
        sf_permutation_keys(&t->shape, pair_key(seed, 2 * pair, 0), t->orders + (size_t)pair * ORDER_KEYS);
        tabulate(sides[1], pair_key(seed, 2 * pair, 1), t->shuffles[0] + (size_t)pair * sides[1]);
        tabulate(sides[0], pair_key(seed, 2 * pair, 2), t->shuffles[1] + (size_t)pair * sides[0]);
    }
    return SF_STATUS_OK;
}

static uint64_t word_of(const multijittered_tables *t, uint32_t index, uint32_t dimension, uint32_t key) {
    uint32_t pair = dimension / 2, m = t->sides[0], k = t->sides[1];
    uint32_t cell = sf_permute(&t->shape, index, t->orders + (size_t)pair * ORDER_KEYS);
    uint32_t column = cell % m, row = cell / m;
    uint32_t stratum = dimension % 2 ? row * m + t->shuffles[1][(size_t)pair * m + column]
                                     : column * k + t->shuffles[0][(size_t)pair * k + row];
    return sf_stratum_place(index, key, stratum, (uint64_t)m * k);
}

void sf_multijittered_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low) {
    const multijittered_tables *t = cursor->set->block;
    uint32_t dims = cursor->set->options.dims;
    for (uint32_t d = 0; d < dims; ++d) {
        uint32_t key = place_key(cursor->set->options.seed, d);
        for (size_t row = 0; row < rows; ++row) {
            uint64_t word = word_of(t, (uint32_t)(first + row), d, key);
            high[row * dims + d] = (uint32_t)(word >> 32);
            if (low) low[row * dims + d] = (uint32_t)word;
        }
    }
}

float sf_multijittered_sample(uint64_t index, uint32_t dimension, uint64_t seed, const uint32_t sides[2]) {
    uint64_t total = (uint64_t)sides[0] * sides[1];
    assert(index < total && total <= SF_FLOAT_STRATA);
    uint32_t keys[SF_PERMUTATION_MAX_KEYS], m = sides[0], k = sides[1], second = dimension % 2;
    sf_permutation_shape shape = sf_permutation_shape_of(total), short_shape = sf_permutation_shape_of(second ? m : k);
    sf_permutation_keys(&shape, pair_key(seed, dimension, 0), keys);
    uint32_t cell = sf_permute(&shape, (uint32_t)index, keys), column = cell % m, row = cell / m;
    sf_permutation_keys(&short_shape, pair_key(seed, dimension, 1 + second), keys);
    uint32_t shuffled = sf_permute(&short_shape, second ? column : row, keys);
    uint32_t stratum = second ? row * m + shuffled : column * k + shuffled;
    uint64_t word = sf_stratum_place((uint32_t)index, place_key(seed, dimension), stratum, total);
    return sf_float_from_bits((uint32_t)(word >> 32));
}
