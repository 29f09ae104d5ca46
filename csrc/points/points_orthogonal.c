// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Latin hypercubes on orthogonal arrays of strength 2 (Owen 1992, "Orthogonal Arrays for Computer
 * Experiments, Integration and Visualization"; Tang 1993, "Orthogonal Array-Based Latin
 * Hypercubes"; for rendering Jarosz et al. 2019, "Orthogonal Array Sampling for Monte Carlo
 * Rendering"): n = q^2 points, q levels, in up to q + 1 dimensions. Each pair of dimensions has
 * one point in each of q x q cells, each dimension one in each of n strata.
 *
 * The array is Bose's (1938): run (a, b) has level a + d b in dimension d < q, and b in dimension
 * q, in the field of q elements. The levels of a dimension are permuted at random; the q points of
 * a level, told apart by b (in dimension q by a), take its q strata in an order that is a random
 * affine map of the field, one for each level, under which all pairs of strata are equally
 * likely. The runs come in a random order. */
#include <assert.h>
#include <inttypes.h>
#include <stdio.h>

#include "base/error.h"
#include "base/platform.h"
#include "points/permutation.h"
#include "points/points_set.h"
#include "points/strata.h"

/* ---- the field of q elements, q a prime or a power of two ---- */

enum { MAX_LEVELS = 4096 }; /* q^2 strata are held by floats */

typedef struct field {
    uint32_t size;
    uint32_t polynomial; /* of a power of two from 4 on: an irreducible one of that degree; else 0 */
} field;

/* Seroussi 1998, "Table of Low-Weight Binary Irreducible Polynomials". */
static const uint16_t polynomials[13] = {0, 0, 0x7, 0xb, 0x13, 0x25, 0x43, 0x83, 0x11b, 0x203, 0x409, 0x805, 0x1009};

static int is_prime(uint64_t n) {
    if (n < 4) return n > 1;
    if (n % 2 == 0) return 0;
    for (uint64_t factor = 3; factor * factor <= n; factor += 2)
        if (n % factor == 0) return 0;
    return 1;
}

/* Whether there are orthogonal arrays of q levels here. */
static int is_level_count(uint64_t q) { return q >= 2 && q <= MAX_LEVELS && ((q & (q - 1)) == 0 || is_prime(q)); }

static field make_field(uint32_t size) {
    field f = {size, 0};
    for (unsigned k = 2; k < sizeof polynomials / sizeof *polynomials; ++k)
        if (size == UINT32_C(1) << k) f.polynomial = polynomials[k];
    return f;
}

static uint32_t add(const field *f, uint32_t a, uint32_t b) {
    if (f->polynomial) return a ^ b;
    uint32_t sum = a + b;
    return sum >= f->size ? sum - f->size : sum;
}

static uint32_t multiply(const field *f, uint32_t a, uint32_t b) {
    if (!f->polynomial) return a * b % f->size;
    uint32_t product = 0;
    for (; b; b >>= 1) {
        product ^= a & -(b & 1u);
        a <<= 1;
        a ^= f->polynomial & -(uint32_t)((a & f->size) != 0);
    }
    return product;
}

/* ---- counts ---- */

sf_status sf_orthogonal_valid_counts(uint64_t n, uint32_t dims, uint64_t *below, uint64_t *above) {
    *below = *above = 0;
    for (uint64_t q = dims > 2 ? dims - 1 : 2; q <= MAX_LEVELS && !*above; ++q) {
        if (!is_level_count(q)) continue;
        if (q * q <= n) *below = q * q;
        if (q * q >= n) *above = q * q;
    }
    return SF_STATUS_OK;
}

static uint32_t root(uint64_t n) {
    uint32_t q = 0;
    while (q < MAX_LEVELS && (uint64_t)(q + 1) * (q + 1) <= n) ++q;
    return q;
}

static sf_status check_count(uint64_t n, uint32_t dims, sf_error *error) {
    uint64_t q = root(n), below = 0, above = 0;
    if (q * q == n && is_level_count(q) && dims <= q + 1) return SF_STATUS_OK;
    char nearby[96];
    sf_orthogonal_valid_counts(n, dims, &below, &above);
    if (below && above)
        snprintf(nearby, sizeof nearby, "%" PRIu64 " and %" PRIu64, below, above);
    else
        snprintf(nearby, sizeof nearby, "%" PRIu64, below ? below : above);
    return sf_fail(error, SF_STATUS_INVALID_VALUE,
                   "%" PRIu64 " points are no orthogonal array of %" PRIu32
                   " dimensions: it takes q^2 points, q a prime or a power of two, at least dims - 1; the nearest: %s",
                   n, dims, nearby);
}

/* ---- points ---- */

static uint64_t order_key(uint64_t seed) { return sf_hash64(seed, UINT64_MAX); }

typedef struct dimension_keys {
    uint64_t levels, strata; /* of the permutation of levels, and of the affine maps */
    uint32_t place;
} dimension_keys;

static dimension_keys keys_of(uint64_t seed, uint32_t dimension) {
    uint64_t key = sf_hash64(seed, dimension);
    return (dimension_keys){key, sf_hash64(key, 1), (uint32_t)(sf_hash64(key, 2) >> 32)};
}

/* The stratum of run a q + b, given the image of each level. */
static uint32_t level_of(const field *f, uint32_t run, uint32_t dimension) {
    uint32_t a = run / f->size, b = run % f->size;
    return dimension == f->size ? b : add(f, a, multiply(f, dimension, b));
}

static uint32_t stratum_of(const field *f, uint32_t run, uint32_t dimension, uint32_t level,
                           const dimension_keys *keys) {
    uint64_t key = sf_hash64(keys->strata, level);
    uint32_t among = dimension == f->size ? run / f->size : run % f->size;
    uint32_t factor = 1 + (uint32_t)((key & 0xffffffffu) * (f->size - 1) >> 32);
    uint32_t offset = (uint32_t)((key >> 32) * f->size >> 32);
    return level * f->size + add(f, offset, multiply(f, factor, among));
}

/* One block of memory. */
typedef struct orthogonal_tables {
    field levels;
    sf_permutation_shape shape;              /* of the runs */
    uint32_t order[SF_PERMUTATION_MAX_KEYS]; /* keys of their order */
    uint16_t images[];                       /* [dims][q]: the levels, permuted */
} orthogonal_tables;

sf_status sf_orthogonal_prepare(sf_point_set *set, sf_error *error) {
    uint64_t total = set->options.total, seed = set->options.seed;
    uint32_t dims = set->options.dims, q = root(total), keys[SF_PERMUTATION_MAX_KEYS];
    sf_status status = check_count(total, dims, error);
    if (status != SF_STATUS_OK) return status;
    size_t bytes = sizeof(orthogonal_tables) + (size_t)dims * q * sizeof(uint16_t);
    orthogonal_tables *t = set->block = sf_aligned_alloc(bytes);
    if (!t) return sf_fail_memory(error, "the tables of orthogonal", bytes);
    t->levels = make_field(q);
    t->shape = sf_permutation_shape_of(total);
    sf_permutation_keys(&t->shape, order_key(seed), t->order);
    sf_permutation_shape shape = sf_permutation_shape_of(q);
    for (uint32_t d = 0; d < dims; ++d) {
        sf_permutation_keys(&shape, keys_of(seed, d).levels, keys);
        for (uint32_t level = 0; level < q; ++level)
            t->images[(size_t)d * q + level] = (uint16_t)sf_permute(&shape, level, keys);
    }
    return SF_STATUS_OK;
}

void sf_orthogonal_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low) {
    const orthogonal_tables *t = cursor->set->block;
    const field *f = &t->levels;
    uint32_t dims = cursor->set->options.dims, total = f->size * f->size, *runs = cursor->state;
    for (size_t row = 0; row < rows; ++row) runs[row] = sf_permute(&t->shape, (uint32_t)(first + row), t->order);
    for (uint32_t d = 0; d < dims; ++d) {
        const uint16_t *images = t->images + (size_t)d * f->size;
        dimension_keys keys = keys_of(cursor->set->options.seed, d);
        for (size_t row = 0; row < rows; ++row) {
            uint32_t level = images[level_of(f, runs[row], d)];
            uint32_t stratum = stratum_of(f, runs[row], d, level, &keys);
            uint64_t word = sf_stratum_place((uint32_t)(first + row), keys.place, stratum, total);
            high[row * dims + d] = (uint32_t)(word >> 32);
            if (low) low[row * dims + d] = (uint32_t)word;
        }
    }
}

float sf_orthogonal_sample(uint64_t index, uint32_t dimension, uint64_t seed, uint32_t levels) {
    assert(is_level_count(levels) && index < (uint64_t)levels * levels && dimension <= levels);
    uint32_t round_keys[SF_PERMUTATION_MAX_KEYS], total = levels * levels;
    field f = make_field(levels);
    sf_permutation_shape runs = sf_permutation_shape_of(total), shape = sf_permutation_shape_of(levels);
    sf_permutation_keys(&runs, order_key(seed), round_keys);
    uint32_t run = sf_permute(&runs, (uint32_t)index, round_keys);
    dimension_keys keys = keys_of(seed, dimension);
    sf_permutation_keys(&shape, keys.levels, round_keys);
    uint32_t level = sf_permute(&shape, level_of(&f, run, dimension), round_keys);
    uint32_t stratum = stratum_of(&f, run, dimension, level, &keys);
    return sf_float_from_bits((uint32_t)(sf_stratum_place((uint32_t)index, keys.place, stratum, total) >> 32));
}
