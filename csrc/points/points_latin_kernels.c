// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Fills rows of latin hypercubes: permutes strata, walks until they are below the count, and jitters within. */
#include "points/points_latin_kernels.h"

#include "base/platform.h"
#include "points/strata.h"

enum { RUN = 512 }; /* words at a time, so that their arrays stay in the first cache */

/* The words of a run: their place in the tables, and what becomes of them. */
typedef struct run {
    SF_ALIGNED(uint32_t) numbers[RUN];
    SF_ALIGNED(uint32_t) cells[RUN];
    const sf_latin_tables *tables;
    size_t at, words;
    uint32_t first; /* the row of place 0 of the tables */
} run;

/* sf_permutation_pass of five rounds, written out: one vector loop. */
static void permute_5(const sf_permutation_shape *shape, size_t words, const uint32_t *SF_RESTRICT keys, size_t stride,
                      uint32_t *SF_RESTRICT cells) {
    sf_permutation_shape s = *shape;
    const uint32_t *SF_RESTRICT k2 = keys + 2 * stride, *SF_RESTRICT k4 = keys + 4 * stride,
                                *SF_RESTRICT k6 = keys + 6 * stride, *SF_RESTRICT k8 = keys + 8 * stride;
    for (size_t i = 0; i < words; ++i) {
        uint32_t row = cells[i] >> s.column_bits, column = cells[i] & ((UINT32_C(1) << s.column_bits) - 1);
        row = sf_permutation_move_row(&s, row, column, keys[i], keys[i + stride]);
        column = sf_permutation_move_column(&s, row, column, k2[i], k2[i + stride]);
        row = sf_permutation_move_row(&s, row, column, k4[i], k4[i + stride]);
        column = sf_permutation_move_column(&s, row, column, k6[i], k6[i + stride]);
        row = sf_permutation_move_row(&s, row, column, k8[i], k8[i + stride]);
        cells[i] = row << s.column_bits | column;
    }
}

/* sf_permute of five rounds where the count is 2^(row_bits + column_bits): no image is past the
 * last, and what is taken modulo the rows or the count are low bits. */
static void permute_binary(const sf_permutation_shape *shape, uint32_t row_bits, size_t words,
                           const uint32_t *SF_RESTRICT keys, size_t stride, uint32_t *SF_RESTRICT cells) {
    sf_permutation_shape s = *shape;
    const uint32_t *SF_RESTRICT k2 = keys + 2 * stride, *SF_RESTRICT k4 = keys + 4 * stride,
                                *SF_RESTRICT k6 = keys + 6 * stride, *SF_RESTRICT k8 = keys + 8 * stride;
    uint32_t columns = (UINT32_C(1) << s.column_bits) - 1, rows = s.rows - 1, drop = 32 - row_bits;
    for (size_t i = 0; i < words; ++i) {
        uint32_t row = cells[i] >> s.column_bits, column = cells[i] & columns;
        row = (row + ((column * keys[i] + keys[i + stride]) >> drop)) & rows;
        column = sf_permutation_move_column(&s, row, column, k2[i], k2[i + stride]);
        row = (row + ((column * k4[i] + k4[i + stride]) >> drop)) & rows;
        column = sf_permutation_move_column(&s, row, column, k6[i], k6[i + stride]);
        row = (row + ((column * k8[i] + k8[i + stride]) >> drop)) & rows;
        cells[i] = ((row << s.column_bits | column) + k8[i + 2 * stride]) & s.last;
    }
}

static void permute_once(const run *r, size_t at, size_t words, uint32_t *cells) {
    const sf_latin_tables *t = r->tables;
    const uint32_t *keys = t->keys + r->at + at;
    if (t->shape.rounds == SF_PERMUTATION_ROUNDS)
        permute_5(&t->shape, words, keys, t->period, cells + at);
    else
        for (size_t i = at; i < at + words; ++i)
            cells[i] = sf_permutation_pass(&t->shape, cells[i], t->keys + r->at + i, t->period);
}

/* Cells past the last go through again. */
static void walk(run *r) {
    uint32_t last = r->tables->shape.last, most = 0;
    for (size_t i = 0; i < r->words; ++i) most = r->cells[i] > most ? r->cells[i] : most;
    if (most <= last) return;
    for (size_t i = 0; i < r->words; ++i)
        while (r->cells[i] > last) permute_once(r, i, 1, r->cells);
}

static void rotate(size_t words, const sf_permutation_shape *shape, const uint32_t *SF_RESTRICT rotations,
                   uint32_t *SF_RESTRICT cells) {
    sf_permutation_shape s = *shape;
    for (size_t i = 0; i < words; ++i) cells[i] = sf_permutation_rotate(&s, cells[i], rotations[i]);
}

static void hash(size_t words, const uint32_t *SF_RESTRICT keys, uint32_t *SF_RESTRICT numbers) {
    for (size_t i = 0; i < words; ++i) numbers[i] = sf_stratum_hash(numbers[i], keys[i]);
}

static void place(size_t words, double inverse, const uint32_t *SF_RESTRICT random, const uint32_t *SF_RESTRICT cells,
                  uint32_t *SF_RESTRICT high) {
    for (size_t i = 0; i < words; ++i) high[i] = sf_stratum_word(random[i], cells[i], inverse);
}

/* The same where the count is 2^bits. */
static void place_binary(size_t words, uint32_t bits, const uint32_t *SF_RESTRICT random,
                         const uint32_t *SF_RESTRICT cells, uint32_t *SF_RESTRICT high) {
    for (size_t i = 0; i < words; ++i) high[i] = sf_stratum_binary_word(random[i], cells[i], bits);
}

static void continue_below(size_t words, const uint32_t *SF_RESTRICT random, const uint32_t *SF_RESTRICT keys,
                           uint32_t *SF_RESTRICT low) {
    for (size_t i = 0; i < words; ++i) low[i] = sf_stratum_low_hash(random[i], keys[i]);
}

/* With about as many strata as floats hold, or more, one word at a time. */
static void place_finely(const run *r, const uint32_t *keys, uint32_t *high, uint32_t *low) {
    for (size_t i = 0; i < r->words; ++i) {
        uint64_t word = sf_stratum_place(r->numbers[i], keys[i], r->cells[i], r->tables->count);
        high[i] = (uint32_t)(word >> 32);
        if (low) low[i] = (uint32_t)word;
    }
}

static void fill_run(run *r, uint32_t *high, uint32_t *low) {
    const sf_latin_tables *t = r->tables;
    const uint32_t *rows = t->rows + r->at, *keys = t->places + r->at;
    for (size_t i = 0; i < r->words; ++i) r->cells[i] = r->numbers[i] = r->first + rows[i];
    int binary = (t->count & (t->count - 1)) == 0;
    if (binary && t->shape.rounds == SF_PERMUTATION_ROUNDS) {
        permute_binary(&t->shape, t->count_bits - t->shape.column_bits, r->words, t->keys + r->at, t->period, r->cells);
    } else {
        permute_once(r, 0, r->words, r->cells);
        walk(r);
        rotate(r->words, &t->shape, t->keys + (size_t)t->shape.rounds * 2 * t->period + r->at, r->cells);
    }
    if (t->count > SF_FLOAT_STRATA || (t->count > SF_FLOAT_STRATA / 2 && !binary)) {
        place_finely(r, keys, high, low);
        return;
    }
    hash(r->words, keys, r->numbers);
    if (binary)
        place_binary(r->words, t->count_bits, r->numbers, r->cells, high);
    else
        place(r->words, 1.0 / (double)t->count, r->numbers, r->cells, high);
    if (low) continue_below(r->words, r->numbers, keys, low);
}

static void fill(const sf_latin_tables *t, uint32_t first, size_t words, uint32_t *high, uint32_t *low) {
    run r;
    r.tables = t;
    r.first = first;
    r.at = 0;
    for (; words; words -= r.words) {
        r.words = words < RUN ? words : RUN;
        if (r.words > t->period - r.at) r.words = t->period - r.at;
        fill_run(&r, high, low);
        high += r.words;
        if (low) low += r.words;
        r.at += r.words;
        if (r.at < t->period) continue;
        r.at = 0;
        r.first += t->period_rows;
    }
}

const sf_latin_kernels SF_AT_ISA(sf_latin_kernels) = {fill};
