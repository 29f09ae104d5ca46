// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Padded sets: a net's first two or four dimensions side by side as often as needed, each time
 * with keys of its own and in an order of its own, a shuffle of the index that maps aligned blocks
 * of 2^k points onto aligned blocks of 2^k (Burley 2020, "Practical Hash-based Owen Scrambling",
 * section 4), so that every set keeps its quality and knows nothing of the others. */
#include <string.h>

#include "base/error.h"
#include "base/platform.h"
#include "points/points_set.h"

struct sf_pad_tables {
    uint32_t pad;
    uint32_t bytes[4][4][256]; /* by dimension of the set: direction numbers summed over each byte */
    uint32_t *keys;            /* [dims]: owen */
    uint64_t *nested;          /* [dims]: nested */
};

void sf_pad_release(sf_pad_tables *t) {
    if (!t) return;
    sf_aligned_free(t->keys);
    sf_aligned_free(t->nested);
    sf_aligned_free(t);
}

static void sum_bytes(const sf_points_options *o, uint32_t dimension, uint32_t sums[4][256]) {
    uint32_t columns[32];
    (o->pattern == SF_PATTERN_SZ ? sf_sz_matrix : sf_sobol_matrix)(dimension, columns);
    for (unsigned byte = 0; byte < 4; ++byte)
        for (uint32_t value = 0; value < 256; ++value) {
            uint32_t sum = 0;
            for (unsigned bit = 0; bit < 8; ++bit) sum ^= columns[8 * byte + bit] & (0u - (value >> bit & 1));
            sums[byte][value] = o->scramble == SF_SCRAMBLE_OWEN ? sf_reverse_bits32(sum) : sum;
        }
}

sf_status sf_pad_prepare(sf_point_set *set, sf_error *error) {
    const sf_points_options *o = &set->options;
    int owen = o->scramble == SF_SCRAMBLE_OWEN;
    size_t bytes = o->dims * (owen ? sizeof(uint32_t) : sizeof(uint64_t));
    sf_pad_tables *t = set->padded = sf_aligned_alloc(sizeof *t);
    if (!t) return sf_fail_memory(error, "the tables of padded sets", sizeof *t);
    memset(t, 0, sizeof *t);
    t->pad = o->pad;
    void *keys = sf_aligned_alloc(bytes);
    if (!keys) return sf_fail_memory(error, "the tables of padded sets", bytes);
    if (owen)
        t->keys = keys;
    else
        t->nested = keys;
    for (uint32_t d = 0; d < o->pad && d < o->dims; ++d) sum_bytes(o, d, t->bytes[d]);
    for (uint32_t d = 0; d < o->dims; ++d) {
        if (owen)
            t->keys[d] = sf_owen_seed(o->seed, d);
        else
            t->nested[d] = sf_hash64(o->seed, d);
    }
    return SF_STATUS_OK;
}

/* The word of the set's index without its least byte. */
static uint32_t start_word(const uint32_t bytes[4][256], uint32_t index) {
    return bytes[1][index >> 8 & 255] ^ bytes[2][index >> 16 & 255] ^ bytes[3][index >> 24];
}

enum { RUN = 256 }; /* points of an aligned block that share all but the least byte of their index */

/* The indices that a set has for points first .. first + rows - 1. */
static void set_indices(sf_points_cursor *cursor, uint32_t set, uint32_t first, size_t rows, uint32_t *indices) {
    uint64_t key = sf_padded_key(cursor->set->options.seed, set);
    if (set && cursor->set->padded->keys) {
        cursor->net_kernels->shuffle(first, rows, (uint32_t)(key >> 32), indices);
        return;
    }
    for (size_t i = 0; i < rows; ++i) indices[i] = first + (uint32_t)i;
    if (set) cursor->net_kernels->nested(rows, &key, 1, indices, NULL);
}

/* One set's columns of `rows` points of one run: words, scrambled where that is done by `keys`. */
static void make_set(sf_points_cursor *cursor, uint32_t set, uint32_t first, size_t rows, uint32_t *out) {
    const sf_pad_tables *t = cursor->set->padded;
    uint32_t dims = cursor->set->options.dims, begin = set * t->pad, indices[RUN], words[4][RUN];
    uint32_t columns = dims - begin < t->pad ? dims - begin : t->pad;
    set_indices(cursor, set, first, rows, indices);
    for (uint32_t d = 0; d < columns; ++d) {
        const uint32_t (*bytes)[256] = t->bytes[d];
        uint32_t start = start_word(bytes, indices[0]);
        if (t->keys)
            cursor->net_kernels->look_up(rows, indices, bytes[0], start, t->keys[begin + d], words[d]);
        else
            for (size_t i = 0; i < rows; ++i) words[d][i] = bytes[0][indices[i] & 255] ^ start;
    }
    for (size_t i = 0; i < rows; ++i)
        for (uint32_t d = 0; d < columns; ++d) out[i * dims + begin + d] = words[d][i];
}

void sf_pad_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low) {
    const sf_pad_tables *t = cursor->set->padded;
    uint32_t dims = cursor->set->options.dims, sets = (dims - 1) / t->pad + 1;
    for (size_t row = 0, some; row < rows; row += some) {
        some = RUN - (size_t)((first + row) % RUN);
        if (some > rows - row) some = rows - row;
        for (uint32_t set = 0; set < sets; ++set)
            make_set(cursor, set, (uint32_t)(first + row), some, high + row * dims);
    }
    if (t->nested)
        cursor->net_kernels->nested(rows * dims, t->nested, dims, high, low);
    else if (low)
        cursor->net_kernels->owen_low(rows * dims, high, t->keys, dims, low);
}
