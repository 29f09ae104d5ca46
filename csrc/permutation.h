// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A keyed permutation of 0 .. count - 1, for any count up to 2^32, of which any value can be had
 * at any time.
 *
 * A number is held as a row and a column of a table of `rows` x 2^column_bits cells, about
 * square and hardly larger than `count`. Rounds add to the row a hash of the column, and to the
 * column a hash of the row (Black & Rogaway 2002, "Ciphers with Arbitrary Finite Domains",
 * section 4, the generalized Feistel construction); a number that ends outside the count goes
 * through again (their section 3). A last random rotation makes each image of a number exactly
 * equally likely over the keys. */
#ifndef SUNFLECK_PERMUTATION_H
#define SUNFLECK_PERMUTATION_H

#include "sunfleck/base.h"

/* Rounds: tables with fewer cells need more, as a round mixes less there. With these, the images
 * of a pair of numbers were within a chi-square test of equally likely, over 200,000 keys, for
 * every count from 2 to 20, and 16 x 16 bins of them for larger counts. */
enum { SF_PERMUTATION_ROUNDS = 6, SF_PERMUTATION_FEW_ROUNDS = 12, SF_PERMUTATION_MAX_ROUNDS = 24 };

/* What the permutations of one count share. */
typedef struct sf_permutation_shape {
    uint32_t last;  /* count - 1 */
    uint32_t rows;  /* at most 2^16 */
    uint32_t column_bits; /* 1 .. 16 */
    unsigned rounds; /* even */
} sf_permutation_shape;

static inline sf_permutation_shape sf_permutation_shape_of(uint64_t count) {
    sf_permutation_shape shape = {(uint32_t)(count - 1), 1, 1, SF_PERMUTATION_ROUNDS};
    while (UINT64_C(1) << (2 * shape.column_bits) < count) ++shape.column_bits;
    shape.rows = (uint32_t)((count - 1) >> shape.column_bits) + 1;
    if (count < 4096) shape.rounds = count > 16 ? SF_PERMUTATION_FEW_ROUNDS : SF_PERMUTATION_MAX_ROUNDS;
    return shape;
}

/* The key of round `round`. */
static inline uint32_t sf_permutation_key(uint64_t key, unsigned round) {
    return (uint32_t)(sf_mix64(key + (round + UINT64_C(1)) * UINT64_C(0x9e3779b97f4a7c15)) >> 32);
}

static inline uint32_t sf_permutation_rotation(const sf_permutation_shape *shape, uint64_t key) {
    return (uint32_t)(sf_permutation_key(key, shape->rounds) * (shape->last + UINT64_C(1)) >> 32);
}

/* The keys of the rounds, and after them the rotation. */
static inline void sf_permutation_keys(const sf_permutation_shape *shape, uint64_t key,
                                       uint32_t keys[SF_PERMUTATION_MAX_ROUNDS + 1]) {
    for (unsigned round = 0; round < shape->rounds; ++round) keys[round] = sf_permutation_key(key, round);
    keys[shape->rounds] = sf_permutation_rotation(shape, key);
}

/* A hash of up to 16 bits, whose top 16 are used. The multipliers are those of the 32-bit
 * mixers that Wellons 2018, "Prospecting for Hash Functions", found by search. */
static inline uint32_t sf_permutation_hash(uint32_t word, uint32_t key) {
    word = (word ^ key) * 0x7feb352du;
    word = (word ^ word >> 15) * 0x846ca68bu;
    return word;
}

/* Two rounds on a cell of the table. */
static inline uint32_t sf_permutation_step(const sf_permutation_shape *shape, uint32_t cell, uint32_t row_key,
                                           uint32_t column_key) {
    uint32_t bits = shape->column_bits, mask = (UINT32_C(1) << bits) - 1;
    uint32_t row = cell >> bits, column = cell & mask;
    row += (sf_permutation_hash(column, row_key) >> 16) * shape->rows >> 16;
    row = row >= shape->rows ? row - shape->rows : row;
    column = (column + (sf_permutation_hash(row, column_key) >> (32 - bits))) & mask;
    return row << bits | column;
}

static inline uint32_t sf_permutation_rotate(const sf_permutation_shape *shape, uint32_t number, uint32_t rotation) {
    return number > shape->last - rotation ? number - (shape->last - rotation) - 1 : number + rotation;
}

/* The image of `number`, which is below the count, under sf_permutation_keys. */
static inline uint32_t sf_permute(const sf_permutation_shape *shape, uint32_t number, const uint32_t *keys) {
    do
        for (unsigned round = 0; round < shape->rounds; round += 2)
            number = sf_permutation_step(shape, number, keys[round], keys[round + 1]);
    while (number > shape->last);
    return sf_permutation_rotate(shape, number, keys[shape->rounds]);
}

#endif
