// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "points_latin_kernels.h"

#include "platform.h"
#include "strata.h"

enum { RUN = 512 }; /* words at a time, so that their arrays stay in the first cache */

/* The words of a run: their place in the tables, and what becomes of them. */
typedef struct run {
    const sf_latin_tables *tables;
    size_t at, words;
    uint32_t first; /* the row of place 0 of the tables */
    uint32_t numbers[RUN], cells[RUN];
} run;

static void step(const sf_permutation_shape *shape, size_t words, const uint32_t *SF_RESTRICT row_keys,
                 const uint32_t *SF_RESTRICT column_keys, uint32_t *SF_RESTRICT cells) {
    sf_permutation_shape s = *shape;
    for (size_t i = 0; i < words; ++i) cells[i] = sf_permutation_step(&s, cells[i], row_keys[i], column_keys[i]);
}

static void permute_once(const run *r, size_t at, size_t words, uint32_t *cells) {
    const sf_latin_tables *t = r->tables;
    for (unsigned round = 0; round < t->shape.rounds; round += 2) {
        const uint32_t *keys = t->keys + (size_t)round * t->period + r->at + at;
        step(&t->shape, words, keys, keys + t->period, cells + at);
    }
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

static void place(size_t words, double inverse, const uint32_t *SF_RESTRICT random,
                  const uint32_t *SF_RESTRICT cells, uint32_t *SF_RESTRICT high) {
    for (size_t i = 0; i < words; ++i) high[i] = sf_stratum_word(random[i], cells[i], inverse);
}

static void continue_below(size_t words, const uint32_t *SF_RESTRICT random, const uint32_t *SF_RESTRICT keys,
                           uint32_t *SF_RESTRICT low) {
    for (size_t i = 0; i < words; ++i) low[i] = sf_stratum_low_hash(random[i], keys[i]);
}

/* With more strata than floats hold, one word at a time. */
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
    permute_once(r, 0, r->words, r->cells);
    walk(r);
    rotate(r->words, &t->shape, t->keys + (size_t)t->shape.rounds * t->period + r->at, r->cells);
    if (t->count > SF_FLOAT_STRATA) {
        place_finely(r, keys, high, low);
        return;
    }
    hash(r->words, keys, r->numbers);
    place(r->words, 1.0 / (double)t->count, r->numbers, r->cells, high);
    if (low) continue_below(r->words, r->numbers, keys, low);
}

static void fill(const sf_latin_tables *t, uint32_t first, size_t words, uint32_t *high, uint32_t *low) {
    run r = {.tables = t, .first = first};
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

const sf_latin_kernels SF_AT_LEVEL(sf_latin_kernels) = {fill};
