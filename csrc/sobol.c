// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The Sobol' sequence, Joe & Kuo's direction numbers: one dimension's matrix, one coordinate,
 * and the tables for filling rows. */
#include <assert.h>
#include <string.h>

#include "error.h"
#include "platform.h"
#include "points_set.h"
#include "sunfleck/points.h"
#include "tables/sobol_table.h"

/* The `count` bits, up to 17, of the packed table from `at`. */
static uint32_t table_bits(uint32_t at, unsigned count) {
    const uint64_t *word = sf_sobol_words + at / 64;
    unsigned shift = at % 64;
    uint64_t bits = word[0] >> shift | word[1] << 1 << (63 - shift);
    return (uint32_t)bits & ((UINT32_C(1) << count) - 1);
}

void sf_sobol_matrix(uint32_t dimension, uint32_t columns[32]) {
    assert(dimension < SF_SOBOL_MAX_DIMS);
    if (dimension == 0) {
        for (unsigned k = 0; k < 32; ++k) columns[k] = UINT32_C(1) << (31 - k);
        return;
    }
    unsigned degree = SF_SOBOL_MAX_DEGREE;
    while (dimension < sf_sobol_first_dimension[degree]) --degree;
    uint32_t at = sf_sobol_first_bit[degree] +
                  (dimension - sf_sobol_first_dimension[degree]) * ((degree - 1) * (degree + 2) / 2);
    /* Read the inner coefficients a_1 (highest) .. a_(s-1), and m_1 .. m_s. */
    uint32_t coefficients = table_bits(at, degree - 1);
    at += degree - 1;
    columns[0] = UINT32_C(1) << 31;
    for (unsigned i = 2; i <= degree; at += i - 1, ++i)
        columns[i - 1] = (table_bits(at, i - 1) << 1 | 1) << (32 - i);
    /* Continue by the recurrence (Joe & Kuo 2008, eq. 2): v_k = a_1 v_(k-1) ^ … ^ a_(s-1)
     * v_(k-s+1) ^ v_(k-s) ^ v_(k-s) / 2^s. */
    for (unsigned k = degree; k < 32; ++k) {
        uint32_t v = columns[k - degree] ^ columns[k - degree] >> degree;
        for (unsigned i = 1; i < degree; ++i) v ^= columns[k - i] & -(coefficients >> (degree - 1 - i) & 1);
        columns[k] = v;
    }
}

uint32_t sf_sobol_bits(uint32_t index, uint32_t dimension) {
    uint32_t columns[32], word = 0;
    sf_sobol_matrix(dimension, columns);
    for (unsigned k = 0; index >> k; ++k) {
        word ^= columns[k] & -(index >> k & 1);
        if (k == 31) break;
    }
    return word;
}

float sf_sobol_sample(uint32_t index, uint32_t dimension, uint64_t seed) {
    return sf_float_from_bits(sf_owen_scramble32(sf_sobol_bits(index, dimension), sf_owen_seed(seed, dimension)));
}

/* Direction numbers of all dimensions, a row for each bit of the index. */
static void fill_columns(sf_sobol_tables *t, int reversed) {
    for (uint32_t d = 0; d < t->dims; ++d) {
        uint32_t columns[32];
        sf_sobol_matrix(d, columns);
        for (unsigned k = 0; k < 32; ++k)
            t->columns[(size_t)k * t->dims + d] = reversed ? sf_reverse_bits32(columns[k]) : columns[k];
    }
}

static void fill_block(sf_sobol_tables *t) {
    size_t dims = t->dims;
    memset(t->low, 0, dims * sizeof *t->low);
    for (unsigned k = 0; k < t->block_bits; ++k) {
        size_t half = ((size_t)1 << k) * dims;
        for (size_t i = 0; i < half; ++i) t->low[half + i] = t->low[i] ^ t->columns[k * dims + i % dims];
    }
}

static void fill_steps(sf_sobol_tables *t) {
    for (unsigned k = t->block_bits; k < 32; ++k) {
        uint32_t *step = t->steps + (size_t)(k - t->block_bits) * t->period;
        for (uint32_t i = 0; i < t->period; ++i)
            step[i] = t->columns[(size_t)k * t->dims + i % t->dims] ^ (k > t->block_bits ? step[i - (ptrdiff_t)t->period] : 0);
    }
}

void sf_sobol_release(sf_sobol_tables *t) {
    if (!t) return;
    sf_aligned_free(t->columns);
    sf_aligned_free(t->low);
    sf_aligned_free(t->steps);
    sf_aligned_free(t->keys);
    sf_aligned_free(t);
}

static sf_sobol_tables *allocate_tables(uint32_t dims, int keyed, size_t *bytes) {
    enum { BLOCK_WORDS = 2048, PERIOD_WORDS = 256 };
    sf_sobol_tables *t = sf_aligned_alloc(sizeof *t);
    if (!t) return NULL;
    memset(t, 0, sizeof *t);
    t->dims = t->period = dims;
    while (((size_t)dims << (t->block_bits + 1)) <= BLOCK_WORDS) ++t->block_bits;
    while (t->period < PERIOD_WORDS) t->period *= 2;
    size_t columns = (size_t)32 * dims * 4, low = ((size_t)dims << t->block_bits) * 4;
    size_t steps = (size_t)(32 - t->block_bits) * t->period * 4, keys = keyed ? (size_t)t->period * 4 : 0;
    *bytes = columns + low + steps + keys;
    t->columns = sf_aligned_alloc(columns);
    t->low = sf_aligned_alloc(low);
    t->steps = sf_aligned_alloc(steps);
    t->keys = keyed ? sf_aligned_alloc(keys) : NULL;
    if (t->columns && t->low && t->steps && (t->keys || !keyed)) return t;
    sf_sobol_release(t);
    return NULL;
}

sf_status sf_sobol_prepare(sf_point_set *set, sf_error *error) {
    int owen = set->options.scramble == SF_SCRAMBLE_OWEN;
    size_t bytes = 0;
    sf_sobol_tables *t = set->sobol = allocate_tables(set->options.dims, owen, &bytes);
    if (!t) return sf_fail_memory(error, "the tables of sobol", bytes);
    fill_columns(t, owen);
    fill_block(t);
    fill_steps(t);
    for (uint32_t i = 0; owen && i < t->period; ++i) t->keys[i] = sf_owen_seed(set->options.seed, i % t->dims);
    return SF_STATUS_OK;
}

/* The repeated row of the block that `index` lies in. */
static void start_row(const sf_sobol_tables *t, uint64_t index, uint32_t *state) {
    memset(state, 0, t->dims * sizeof *state);
    for (unsigned k = t->block_bits; k < 32; ++k) {
        if (!(index >> k & 1)) continue;
        const uint32_t *column = t->columns + (size_t)k * t->dims;
        for (uint32_t d = 0; d < t->dims; ++d) state[d] ^= column[d];
    }
    for (uint32_t i = t->dims; i < t->period; ++i) state[i] = state[i - t->dims];
}

void sf_sobol_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low) {
    const sf_sobol_tables *t = cursor->set->sobol;
    if (cursor->next != first) start_row(t, first, cursor->state);
    cursor->kernels->sobol(t, first, rows, cursor->state, high);
    cursor->next = first + rows;
    if (!low) return;
    if (t->keys)
        cursor->kernels->owen_low(rows * t->dims, high, t->keys, t->period, low);
    else
        memset(low, 0, rows * t->dims * sizeof *low);
}
