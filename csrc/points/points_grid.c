// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The patterns that stand on a grid or on nothing: uniform, jittered, random. */
#include <assert.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/platform.h"
#include "points/points_set.h"

#define MAX_CELLS (UINT64_C(1) << 32)
#define MAX_SIDE (UINT64_C(1) << 24) /* so that every cell holds a float */

enum { MANY_DIMS = 32 }; /* from here on sides are 1 or 2, as 3^33 > 2^32 */

static uint64_t saturating_power(uint64_t base, uint32_t exponent) {
    uint64_t power = 1;
    for (uint32_t i = 0; i < exponent; ++i) {
        if (power > UINT64_MAX / base) return UINT64_MAX;
        power *= base;
        if (base == 1) break;
    }
    return power;
}

/* The nearest products found so far around n. */
typedef struct nearest {
    uint64_t n, below, above;
} nearest;

static void offer(nearest *best, uint64_t product) {
    if (product > MAX_CELLS) return;
    if (product <= best->n && product > best->below) best->below = product;
    if (product >= best->n && (best->above == 0 || product < best->above)) best->above = product;
}

/* Tries products of `product` and `left` sides, rising from `least`, none above `most`. */
static void search_products(nearest *best, uint64_t product, uint32_t left, uint64_t least, uint64_t most) {
    if (left == 1) {
        uint64_t side = best->n / product;
        if (side >= least) offer(best, product * (side < most ? side : most));
        side += side * product < best->n;
        if (side <= most) offer(best, product * (side > least ? side : least));
        return;
    }
    for (uint64_t side = least; side <= most; ++side) {
        /* Give up where even the least product is beyond what was found, and pass over where
         * even the greatest falls short of it. */
        uint64_t p = product * side, low = saturating_power(side, left - 1), high = saturating_power(most, left - 1);
        if (p > MAX_CELLS / low || (best->above && p * low > best->above)) return;
        if (high <= MAX_CELLS / p && p * high < best->below) continue;
        if (best->below && best->below == best->n) return;
        search_products(best, p, left - 1, side, most);
    }
}

static void powers_of_two(nearest *best, uint32_t dims) {
    for (uint32_t k = 0; k <= 32 && k <= dims; ++k) offer(best, UINT64_C(1) << k);
}

static nearest nearest_counts(uint64_t n, uint32_t dims) {
    nearest best = {n > MAX_CELLS ? MAX_CELLS : n, 0, 0};
    if (dims == 1) {
        best.below = best.n < MAX_SIDE ? best.n : MAX_SIDE;
        best.above = n > MAX_SIDE ? 0 : n ? n : 1;
    } else if (dims > MANY_DIMS) {
        powers_of_two(&best, dims);
    } else {
        for (uint64_t side = 1; saturating_power(side, dims) <= MAX_CELLS; ++side) {
            uint64_t smallest = saturating_power(side, dims), rest = saturating_power(2 * side, dims - 1);
            int falls_short = rest <= MAX_CELLS / side && side * rest < best.below;
            if (best.above && smallest > best.above) break;
            if (!falls_short) search_products(&best, side, dims - 1, side, 2 * side);
        }
    }
    if (n > MAX_CELLS) best.above = 0;
    return best;
}

sf_status sf_grid_valid_counts(uint64_t n, uint32_t dims, uint64_t *below, uint64_t *above) {
    nearest best = nearest_counts(n, dims);
    *below = best.below;
    *above = best.above;
    return SF_STATUS_OK;
}

/* Writes `left` sides of product n, rising from `least` up to `most`, at sides[left - 1] .. sides[0]
 * in falling order. The greatest side is the least possible: `most` grows until one fits. */
static int factor(uint64_t n, uint32_t left, uint64_t least, uint64_t most, uint32_t *sides) {
    if (left == 1) {
        if (n < least || n > most) return 0;
        sides[0] = (uint32_t)n;
        return 1;
    }
    if (saturating_power(most, left) < n) return 0;
    for (uint64_t side = least; side <= most && saturating_power(side, left) <= n; ++side) {
        if (n % side) continue;
        sides[left - 1] = (uint32_t)side;
        if (factor(n / side, left - 1, side, most, sides)) return 1;
    }
    return 0;
}

/* The most even factorization, the largest least side first; 0 where there is none. */
static int find_sides(uint64_t n, uint32_t dims, uint32_t *sides) {
    if (dims == 1) {
        sides[0] = (uint32_t)n;
        return n <= MAX_SIDE;
    }
    if (dims > MANY_DIMS) {
        if (n & (n - 1)) return 0;
        for (uint32_t d = 0; d < dims; ++d, n = n > 1 ? n / 2 : 1) sides[d] = n > 1 ? 2 : 1;
        return n == 1;
    }
    uint64_t root = 1;
    while (saturating_power(root + 1, dims) <= n) ++root;
    for (uint64_t least = root; least >= 1; --least) {
        if (saturating_power(2 * least, dims - 1) < n / least) return 0;
        if (n % least) continue;
        sides[dims - 1] = (uint32_t)least;
        for (uint64_t most = least; most <= 2 * least; ++most)
            if (factor(n / least, dims - 1, least, most, sides)) return 1;
    }
    return 0;
}

sf_status sf_grid_sides(uint64_t n, uint32_t dims, uint32_t *sides, sf_error *error) {
    if (dims < 1 || dims > SF_POINTS_MAX_DIMS)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "d is %" PRIu32 "; it is 1 .. %u", dims, SF_POINTS_MAX_DIMS);
    if (n >= 1 && n <= MAX_CELLS && find_sides(n, dims, sides)) return SF_STATUS_OK;
    nearest best = nearest_counts(n, dims);
    char nearby[96];
    if (best.below && best.above)
        snprintf(nearby, sizeof nearby, "%" PRIu64 " and %" PRIu64, best.below, best.above);
    else
        snprintf(nearby, sizeof nearby, "%" PRIu64, best.below ? best.below : best.above);
    return sf_fail(error, SF_STATUS_INVALID_VALUE,
                   "%" PRIu64 " points are no grid of %" PRIu32 " dimensions: it takes a product of %" PRIu32
                   " integers, the largest at most twice the smallest; the nearest: %s",
                   n, dims, dims, nearby);
}

sf_status sf_grid_prepare(sf_point_set *set, sf_error *error) {
    size_t bytes = set->options.dims * sizeof *set->sides;
    set->sides = sf_aligned_alloc(bytes);
    if (!set->sides) return sf_fail_memory(error, "the sides of a grid", bytes);
    return sf_grid_sides(set->options.total, set->options.dims, set->sides, error);
}

/* The cells of point `index`: dimension 0 counts fastest. */
static void cells_of(uint64_t index, uint32_t dims, const uint32_t *sides, uint32_t *cells) {
    for (uint32_t d = 0; d < dims; ++d) {
        cells[d] = (uint32_t)(index % sides[d]);
        index /= sides[d];
    }
}

/* cells <- those of the next point. */
static void count_up(uint32_t dims, const uint32_t *sides, const uint32_t *cells, uint32_t *next) {
    memcpy(next, cells, dims * sizeof *next);
    for (uint32_t d = 0; d < dims && ++next[d] == sides[d]; ++d) next[d] = 0;
}

/* Points beyond the last cell are never asked for, so that counting up past it is harmless. */
static void fill_cells(uint64_t first, size_t rows, uint32_t dims, const uint32_t *sides, uint32_t *cells) {
    if (rows) cells_of(first, dims, sides, cells);
    for (size_t row = 1; row < rows; ++row) count_up(dims, sides, cells + (row - 1) * dims, cells + row * dims);
}

/* The middle of a cell, where border and width are multiples of 2^8: a float inside it. */
static uint32_t cell_middle(uint32_t cell, uint32_t side) {
    return (uint32_t)((sf_cell_border(cell, side) + sf_cell_border(cell + 1, side)) / 2);
}

void sf_uniform_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low) {
    uint32_t dims = cursor->set->options.dims;
    const uint32_t *sides = cursor->set->sides;
    fill_cells(first, rows, dims, sides, high);
    for (size_t i = 0; i < rows * dims; ++i) high[i] = cell_middle(high[i], sides[i % dims]);
    if (low) memset(low, 0, rows * dims * sizeof *low);
}

void sf_random_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low) {
    uint64_t keys[256];
    uint32_t dims = cursor->set->options.dims;
    for (size_t n; rows; rows -= n, first += n) {
        n = rows < 256 ? rows : 256;
        cursor->kernels->row_keys(cursor->set->options.seed, first, n, keys);
        cursor->kernels->random(keys, n, dims, high, low);
        high += n * dims;
        if (low) low += n * dims;
    }
}

void sf_jittered_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low) {
    uint32_t dims = cursor->set->options.dims;
    const uint32_t *sides = cursor->set->sides;
    uint32_t *cells = cursor->state, *below = low ? low : cells + SF_POINTS_CHUNK_WORDS + dims;
    size_t step = SF_POINTS_CHUNK_WORDS / dims ? SF_POINTS_CHUNK_WORDS / dims : 1;
    for (size_t n; rows; rows -= n, first += n) {
        n = rows < step ? rows : step;
        sf_random_make(cursor, first, n, high, below);
        fill_cells(first, n, dims, sides, cells);
        cursor->kernels->place(n, dims, sides, cells, high, below);
        high += n * dims;
        if (low) below += n * dims;
    }
}

/* ---- one coordinate ---- */

static uint32_t cell_of(uint64_t index, uint32_t dimension, uint32_t dims, const uint32_t *sides) {
    assert(dimension < dims);
    (void)dims;
    for (uint32_t d = 0; d < dimension; ++d) index /= sides[d];
    return (uint32_t)(index % sides[dimension]);
}

float sf_random_sample(uint64_t index, uint32_t dimension, uint64_t seed) {
    return sf_float_from_bits((uint32_t)(sf_random_word(sf_hash64(seed, index), dimension) >> 32));
}

float sf_uniform_sample(uint64_t index, uint32_t dimension, uint32_t dims, const uint32_t *sides) {
    return sf_float_from_bits(cell_middle(cell_of(index, dimension, dims, sides), sides[dimension]));
}

float sf_jittered_sample(uint64_t index, uint32_t dimension, uint64_t seed, uint32_t dims, const uint32_t *sides) {
    uint64_t random = sf_random_word(sf_hash64(seed, index), dimension);
    uint64_t word = sf_place_in_cell(random, cell_of(index, dimension, dims, sides), sides[dimension]);
    return sf_float_from_bits((uint32_t)(word >> 32));
}
