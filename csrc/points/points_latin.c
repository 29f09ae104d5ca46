// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The latin hypercube: n strata in each dimension with one point in each, the strata of the
 * dimensions paired by independent random permutations (McKay, Beckman & Conover 1979, "A
 * Comparison of Three Methods …"), a random place in the stratum. */
#include "points/points_latin_kernels.h"

#include <assert.h>

#include "base/error.h"
#include "base/platform.h"
#include "points/points_set.h"
#include "points/strata.h"

static uint32_t place_key(uint64_t key) { return (uint32_t)(sf_hash64(key, 1) >> 32); }

static void fill_tables(sf_latin_tables *t, uint32_t dims, uint64_t seed) {
    uint32_t keys[SF_PERMUTATION_MAX_KEYS], key_count = sf_permutation_key_count(&t->shape);
    for (uint32_t d = 0; d < dims; ++d) {
        uint64_t key = sf_hash64(seed, d);
        sf_permutation_keys(&t->shape, key, keys);
        for (uint32_t i = d; i < t->period; i += dims) {
            t->rows[i] = i / dims;
            t->places[i] = place_key(key);
            for (uint32_t k = 0; k < key_count; ++k) t->keys[(size_t)k * t->period + i] = keys[k];
        }
    }
}

sf_status sf_latin_prepare(sf_point_set *set, sf_error *error) {
    enum { PERIOD_WORDS = 256, HEADER_BYTES = (sizeof(sf_latin_tables) / SF_ALIGNMENT + 1) * SF_ALIGNMENT };
    uint32_t dims = set->options.dims;
    sf_permutation_shape shape = sf_permutation_shape_of(set->options.total);
    uint32_t rows = dims < PERIOD_WORDS ? PERIOD_WORDS / dims : 1, period = dims * rows;
    size_t words = (size_t)period * (sf_permutation_key_count(&shape) + 2);
    size_t bytes = HEADER_BYTES + words * sizeof(uint32_t);
    sf_latin_tables *t = set->block = sf_aligned_alloc(bytes);
    if (!t) return sf_fail_memory(error, "the tables of latin", bytes);
    uint32_t *memory = (uint32_t *)(void *)((char *)t + HEADER_BYTES);
    *t = (sf_latin_tables){.shape = shape,
                           .count = set->options.total,
                           .period = period,
                           .period_rows = rows,
                           .rows = memory,
                           .places = memory + period,
                           .keys = memory + 2 * (size_t)period};
    while (t->count >> (t->count_bits + 1)) ++t->count_bits;
    fill_tables(t, dims, set->options.seed);
    return SF_STATUS_OK;
}

void sf_latin_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low) {
    const sf_latin_tables *t = cursor->set->block;
    sf_latin_kernels_at(sf_isa_active())->fill(t, (uint32_t)first, rows * cursor->set->options.dims, high, low);
}

float sf_latin_sample(uint64_t index, uint32_t dimension, uint64_t seed, uint64_t total) {
    assert(total >= 1 && total <= UINT64_C(1) << 32 && index < total && dimension < SF_POINTS_MAX_DIMS);
    uint32_t keys[SF_PERMUTATION_MAX_KEYS];
    sf_permutation_shape shape = sf_permutation_shape_of(total);
    uint64_t key = sf_hash64(seed, dimension);
    sf_permutation_keys(&shape, key, keys);
    uint32_t cell = sf_permute(&shape, (uint32_t)index, keys);
    return sf_float_from_bits((uint32_t)(sf_stratum_place((uint32_t)index, place_key(key), cell, total) >> 32));
}
