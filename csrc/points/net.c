// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Digital nets in base 2, whichever their matrices: scrambles of one word, and the tables for
 * filling rows. */
#include <assert.h>
#include <string.h>

#include "base/error.h"
#include "base/platform.h"
#include "points/points_set.h"
#include "sunfleck/points.h"

/* ---- one word ---- */

/* Column `digit` of a random lower triangular matrix with ones on its diagonal, of 64 digits, the
 * first at the top (Matousek 1998, "On the L2-discrepancy for anchored boxes"). */
static uint64_t random_column(uint64_t key, unsigned digit) {
    uint64_t one = UINT64_C(1) << (63 - digit);
    return one | (sf_hash64(key, digit) & (one - 1));
}

static uint64_t scramble_linearly(uint32_t word, uint64_t key) {
    uint64_t result = key;
    for (unsigned digit = 0; digit < 32; ++digit)
        result ^= random_column(key, digit) & (0 - (uint64_t)(word >> (31 - digit) & 1));
    return result;
}

static uint64_t scramble_nested(uint32_t word, uint64_t key) {
    uint64_t bits = (uint64_t)word << 32, flips = 0;
    for (unsigned depth = 0; depth < SF_NESTED_DEPTH; depth += SF_NESTED_LEVELS)
        flips |= sf_nested_flips(bits, depth, key);
    return bits ^ flips;
}

uint64_t sf_scramble_word(uint32_t word, uint32_t dimension, uint64_t seed, sf_scramble scramble) {
    uint64_t key = sf_hash64(seed, dimension);
    uint32_t owen;
    switch (scramble) {
        case SF_SCRAMBLE_DEFAULT:
        case SF_SCRAMBLE_OWEN:
            owen = sf_owen_scramble32(word, (uint32_t)(key >> 32));
            return (uint64_t)owen << 32 | sf_owen_low_word(owen, (uint32_t)(key >> 32));
        case SF_SCRAMBLE_SHIFT: return (uint64_t)word << 32 ^ key;
        case SF_SCRAMBLE_LMS: return scramble_linearly(word, key);
        case SF_SCRAMBLE_NESTED: return scramble_nested(word, key);
        default: assert(scramble == SF_SCRAMBLE_NONE); return (uint64_t)word << 32;
    }
}

uint32_t sf_padded_index(uint32_t index, uint32_t set, uint64_t seed, sf_scramble scramble) {
    if (set == 0) return index;
    uint64_t key = sf_padded_key(seed, set);
    if (scramble == SF_SCRAMBLE_NESTED) return (uint32_t)(scramble_nested(index, key) >> 32);
    return sf_owen_scramble32(index, (uint32_t)(key >> 32));
}

static float net_sample(uint32_t (*bits)(uint32_t, uint32_t), uint32_t index, uint32_t dimension, uint64_t seed,
                        sf_scramble scramble, uint32_t pad) {
    assert(pad == 0 || pad == 2 || pad == 4);
    uint32_t own = dimension;
    if (pad) {
        index = sf_padded_index(index, dimension / pad, seed, scramble);
        own = dimension % pad;
    }
    return sf_float_from_bits((uint32_t)(sf_scramble_word(bits(index, own), dimension, seed, scramble) >> 32));
}

float sf_sobol_sample(uint32_t index, uint32_t dimension, uint64_t seed) {
    return net_sample(sf_sobol_bits, index, dimension, seed, SF_SCRAMBLE_OWEN, 0);
}
float sf_sobol_sample_with(uint32_t index, uint32_t dimension, uint64_t seed, sf_scramble scramble, uint32_t pad) {
    return net_sample(sf_sobol_bits, index, dimension, seed, scramble, pad);
}
float sf_sz_sample(uint32_t index, uint32_t dimension, uint64_t seed) {
    return net_sample(sf_sz_bits, index, dimension, seed, SF_SCRAMBLE_OWEN, 0);
}
float sf_sz_sample_with(uint32_t index, uint32_t dimension, uint64_t seed, sf_scramble scramble, uint32_t pad) {
    return net_sample(sf_sz_bits, index, dimension, seed, scramble, pad);
}

/* ---- tables ---- */

enum { BLOCK_WORDS = 2048, PERIOD_WORDS = 512, COLUMN_GROUP = 16 };

/* The columns of a dimension as 64-bit words, scrambled where a matrix scramble is asked for. */
static void make_columns(const sf_points_options *o, uint32_t dimension, uint64_t columns[32]) {
    uint32_t plain[32];
    if (o->pattern == SF_PATTERN_SZ)
        sf_sz_matrix(dimension, plain);
    else
        sf_sobol_matrix(dimension, plain);
    if (o->scramble != SF_SCRAMBLE_LMS) {
        int reversed = o->scramble == SF_SCRAMBLE_OWEN;
        for (unsigned k = 0; k < 32; ++k)
            columns[k] = (uint64_t)(reversed ? sf_reverse_bits32(plain[k]) : plain[k]) << 32;
        return;
    }
    uint64_t key = sf_hash64(o->seed, dimension);
    for (unsigned k = 0; k < 32; ++k) columns[k] = 0;
    for (unsigned digit = 0; digit < 32; ++digit) {
        uint64_t column = random_column(key, digit);
        for (unsigned k = digit; k < 32; ++k) columns[k] ^= column & (0 - (uint64_t)(plain[k] >> (31 - digit) & 1));
    }
}

/* Sums of the columns, a group of dimensions at a time, so that each row gets a whole line. */
static void fill_columns(sf_net_tables *t, const sf_points_options *o) {
    for (uint32_t begin = 0; begin < t->dims; begin += COLUMN_GROUP) {
        uint64_t group[COLUMN_GROUP][32], sums[COLUMN_GROUP] = {0};
        uint32_t count = t->dims - begin < COLUMN_GROUP ? t->dims - begin : COLUMN_GROUP;
        for (uint32_t i = 0; i < count; ++i) make_columns(o, begin + i, group[i]);
        for (unsigned k = 0; k < t->index_bits; ++k)
            for (uint32_t i = 0; i < count; ++i) {
                size_t at = (size_t)k * t->dims + begin + i;
                sums[i] ^= group[i][k];
                t->columns[0][at] = (uint32_t)(sums[i] >> 32);
                if (t->columns[1]) t->columns[1][at] = (uint32_t)sums[i];
            }
    }
}

/* Direction number k of a dimension, from the sums. */
static uint32_t column(const sf_net_tables *t, int part, unsigned k, uint32_t dimension) {
    const uint32_t *sum = t->columns[part] + (size_t)k * t->dims + dimension;
    return k ? sum[0] ^ sum[-(ptrdiff_t)t->dims] : sum[0];
}

static void fill_block(sf_net_tables *t, int part) {
    uint32_t *block = t->block[part];
    memset(block, 0, t->dims * sizeof *block);
    for (unsigned k = 0; k < t->block_bits; ++k) {
        size_t rows = (size_t)1 << k, half = rows * t->dims;
        for (uint32_t d = 0; d < t->dims; ++d) block[half + d] = column(t, part, k, d);
        for (size_t row = 1; row < rows; ++row)
            for (uint32_t d = 0; d < t->dims; ++d)
                block[half + row * t->dims + d] = block[row * t->dims + d] ^ block[half + d];
    }
}

static void fill_steps(sf_net_tables *t, int part) {
    for (unsigned k = t->block_bits; k < t->index_bits; ++k) {
        uint32_t *step = t->steps[part] + (size_t)(k - t->block_bits) * t->period;
        const uint32_t *upto = t->columns[part] + (size_t)k * t->dims;
        for (uint32_t d = 0; d < t->dims; ++d) {
            step[d] = upto[d];
            if (t->block_bits) step[d] ^= t->columns[part][(size_t)(t->block_bits - 1) * t->dims + d];
        }
        sf_repeat_row(step, t->dims, t->period);
    }
}

void sf_net_release(sf_net_tables *t) {
    if (!t) return;
    for (int part = 0; part < 2; ++part) {
        if (t->steps[part] != t->columns[part]) sf_aligned_free(t->steps[part]);
        sf_aligned_free(t->columns[part]);
        sf_aligned_free(t->block[part]);
        sf_aligned_free(t->shift[part]);
    }
    sf_aligned_free(t->keys);
    sf_aligned_free(t->nested);
    sf_aligned_free(t);
}

/* Memory that is counted, and of which a failure is remembered. */
typedef struct counted {
    size_t bytes;
    int failed;
} counted;

static void *take(counted *memory, size_t bytes) {
    void *taken = sf_aligned_alloc(bytes);
    memory->bytes += bytes;
    memory->failed |= !taken;
    return taken;
}

static void choose_layout(sf_net_tables *t, uint64_t total) {
    t->index_bits = 32;
    while (t->index_bits && total && (total - 1) >> (t->index_bits - 1) == 0) --t->index_bits;
    while (t->block_bits < t->index_bits && (size_t)t->dims << (t->block_bits + 1) <= BLOCK_WORDS) ++t->block_bits;
    t->period = t->dims;
    while (t->period < PERIOD_WORDS && t->period < t->dims << t->block_bits) t->period *= 2;
}

/* Where blocks are single points, a step is a sum of columns. */
static void allocate_part(sf_net_tables *t, int part, counted *memory) {
    size_t row = t->dims * sizeof(uint32_t), steps = t->index_bits - t->block_bits;
    t->columns[part] = take(memory, t->index_bits * row);
    t->block[part] = take(memory, row << t->block_bits);
    t->steps[part] = t->block_bits ? take(memory, steps * t->period * sizeof(uint32_t)) : t->columns[part];
}

static sf_net_tables *allocate_tables(const sf_points_options *o, counted *memory) {
    sf_net_tables *t = take(memory, sizeof *t);
    if (!t) return NULL;
    memset(t, 0, sizeof *t);
    t->dims = o->dims;
    choose_layout(t, o->total);
    int linear = o->scramble == SF_SCRAMBLE_LMS;
    allocate_part(t, 0, memory);
    if (linear) allocate_part(t, 1, memory);
    for (int part = 0; part < 2 && (linear || o->scramble == SF_SCRAMBLE_SHIFT); ++part)
        t->shift[part] = take(memory, t->dims * sizeof(uint32_t));
    if (o->scramble == SF_SCRAMBLE_OWEN) t->keys = take(memory, t->period * sizeof *t->keys);
    if (o->scramble == SF_SCRAMBLE_NESTED) t->nested = take(memory, t->period * sizeof *t->nested);
    if (!memory->failed) return t;
    sf_net_release(t);
    return NULL;
}

static void fill_keys(sf_net_tables *t, uint64_t seed) {
    for (uint32_t d = 0; d < t->dims; ++d) {
        uint64_t key = sf_hash64(seed, d);
        if (t->shift[0]) t->shift[0][d] = (uint32_t)(key >> 32);
        if (t->shift[1]) t->shift[1][d] = (uint32_t)key;
        if (t->keys) t->keys[d] = (uint32_t)(key >> 32);
        for (uint32_t i = d; t->nested && i < t->period; i += t->dims) t->nested[i] = key;
    }
    if (t->keys) sf_repeat_row(t->keys, t->dims, t->period);
}

sf_status sf_net_prepare(sf_point_set *set, sf_error *error) {
    counted memory = {0, 0};
    sf_net_tables *t = set->net = allocate_tables(&set->options, &memory);
    if (!t) return sf_fail_memory(error, "the tables of a net", memory.bytes);
    fill_columns(t, &set->options);
    for (int part = 0; part < 2; ++part) {
        if (!t->columns[part]) continue;
        fill_block(t, part);
        if (t->block_bits) fill_steps(t, part);
    }
    fill_keys(t, set->options.seed);
    return SF_STATUS_OK;
}

/* ---- rows ---- */

void sf_net_rows(sf_points_cursor *cursor, uint64_t first, size_t rows, sf_number_type type, int streams, void *out) {
    const sf_net_tables *t = cursor->set->net;
    if (cursor->next != first) cursor->net_kernels->start(t, first, cursor->state);
    cursor->net_kernels->rows(t, first, rows, cursor->state, type, streams, out);
    cursor->next = first + rows;
}

void sf_net_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low) {
    const sf_net_tables *t = cursor->set->net;
    sf_net_rows(cursor, first, rows, SF_NUMBER_U32, 0, high);
    cursor->net_kernels->nested(rows * t->dims, t->nested, t->period, high, low);
}
