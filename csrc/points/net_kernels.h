// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Rows of digital nets in base 2 (sobol, sz), their scrambles, and their padded sets. */
#ifndef SUNFLECK_NET_KERNELS_H
#define SUNFLECK_NET_KERNELS_H

#include <string.h>

#include "base/isa_dispatch.h"
#include "points/points_kernels.h"
#include "sunfleck/points.h"

/* A net laid out for filling rows in order. A block of 2^block_bits points shares the high bits
 * of its index: its words are those of block 0 (`block`) XOR one row of the high bits, and the
 * row of the next block differs by one row of `steps`. Rows are repeated until they are long
 * enough for a vector loop.
 *
 * Arrays come in pairs: [0] holds the upper 32 bits of a coordinate, [1] the 32 below, NULL where
 * these do not change with the index. With `keys` all words are bit-reversed. */
typedef struct sf_net_tables {
    uint32_t dims;
    unsigned index_bits; /* that the greatest index has */
    unsigned block_bits;
    uint32_t period;      /* words of a repeated row, a multiple of dims that divides a block's words */
    uint32_t *columns[2]; /* [index_bits][dims]: row k is the XOR of the direction numbers 0 .. k */
    uint32_t *block[2];   /* [2^block_bits][dims] */
    uint32_t *steps[2];   /* [index_bits - block_bits][period]: XOR of the numbers block_bits .. block_bits + k */
    uint32_t *shift[2];   /* [dims]: of a digital shift; NULL: none */
    uint32_t *keys;       /* [period]: of the Owen scramble */
    uint64_t *nested;     /* [period]: keys of nested scrambling */
} sf_net_tables;

typedef struct sf_net_kernels {
    /* The repeated rows, upper and lower, of the block in which `index` lies. */
    void (*start)(const sf_net_tables *tables, uint64_t index, uint32_t *state);
    /* Points first .. first + rows - 1 as numbers of a type, without nested scrambling; `state` is
     * that of the block in which `first` lies, and on return that of first + rows. `streams`: past
     * the caches, to be followed by sf_stream_end. */
    void (*rows)(const sf_net_tables *tables, uint64_t first, size_t rows, uint32_t *state, sf_number_type type,
                 int streams, void *out);
    /* The words below those of Owen-scrambled points, or of points scrambled in nested fashion:
     * the latter also replaces the words by the scrambled ones. `low` may be NULL there. */
    void (*owen_low)(size_t count, const uint32_t *high, const uint32_t *keys, uint32_t period, uint32_t *low);
    void (*nested)(size_t count, const uint64_t *keys, uint32_t period, uint32_t *high, uint32_t *low);
    /* out[i] = sf_owen_scramble32(first + i, key). */
    void (*shuffle)(uint32_t first, size_t count, uint32_t key, uint32_t *out);
    /* out[i] = the Owen scramble of table[indices[i] & 255] ^ start, both reversed. */
    void (*look_up)(size_t count, const uint32_t *indices, const uint32_t table[256], uint32_t start, uint32_t key,
                    uint32_t *out);
} sf_net_kernels;

SF_KERNELS(sf_net_kernels)

/* Repeats the first `dims` words up to `period`, dims times a power of two. */
static inline void sf_repeat_row(uint32_t *row, uint32_t dims, uint32_t period) {
    for (uint32_t filled = dims; filled < period; filled *= 2) memcpy(row + filled, row, filled * sizeof *row);
}

/* What continues an Owen-scrambled word below its 32 bits. Distinct indices have distinct words,
 * so that Owen's flips beyond depth 32 are independent uniform bits: any hash of the word. */
static inline uint32_t sf_owen_low_word(uint32_t word, uint32_t key) {
    word = (word ^ key ^ 0x6a09e667u) * 0x7feb352du;
    word = (word ^ word >> 15) * 0x846ca68bu;
    return word ^ word >> 16;
}

/* Owen's scrambling by the letter: bit k of a word, from the top, is flipped by a bit that
 * belongs to the node of the binary tree which the k bits above it lead to. Node 2^k + path is
 * the path's; six levels share one hash of 64 bits, that of the subtree's root, of which each of
 * the 63 nodes has a bit of its own. Flips of the 54 levels of a double: nine hashes. */
enum { SF_NESTED_LEVELS = 6, SF_NESTED_DEPTH = 54 };

/* Flips of levels depth .. depth + 5 of a word whose bits are at the top of 64, in their places. */
static inline uint64_t sf_nested_flips(uint64_t word, unsigned depth, uint64_t key) {
    uint64_t root = UINT64_C(1) << depth | word >> 1 >> (63 - depth), result = 0;
    uint64_t flips = sf_mix64(key ^ root * UINT64_C(0xd1342543de82ef95));
    /* Within the subtree the node of level l is a one and the l bits that lead to it. */
    uint64_t path = 64 | (word >> (58 - depth) & 63);
    for (unsigned level = 0; level < SF_NESTED_LEVELS; ++level) {
        uint64_t node = path >> (SF_NESTED_LEVELS - level);
        result |= (flips >> node & 1) << (SF_NESTED_LEVELS - 1 - level);
    }
    return result << (58 - depth);
}

#endif
