// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A keyed permutation of 0 .. count - 1, for any count up to 2^32, of which any value can be had
 * at any time.
 *
 * A number is held as a row and a column of a table of `rows` x 2^column_bits cells, about
 * square and hardly larger than `count`. Rounds add to the row a hash of the column and to the
 * column a hash of the row by turns (Black & Rogaway 2002, "Ciphers with Arbitrary Finite
 * Domains", section 4, the generalized Feistel construction); a number that ends outside the
 * count goes through again (their section 3). The hash is multiply-add-shift, whose values at any
 * two places are independent (Dietzfelbinger 1996, "Universal Hashing and k-wise Independent
 * Random Variables via Integer Arithmetic without Primes"): so the permutation is made for the
 * law of pairs, which decides variances. A last random rotation makes each image of a number
 * exactly equally likely over the keys. */
#ifndef SUNFLECK_PERMUTATION_H
#define SUNFLECK_PERMUTATION_H

#include "sunfleck/base.h"

/* Rounds, of rows first and last: tables with fewer cells need more, as a round mixes less there.
 * With these, the images of a pair of numbers were within a chi-square test of equally likely,
 * over 200,000 keys, for every count from 2 to 20, and over 1,000,000 in 16 x 16 bins for larger
 * counts (the pair in one row, or in one column, or neither). */
enum { SF_PERMUTATION_ROUNDS = 5, SF_PERMUTATION_FEW_ROUNDS = 13, SF_PERMUTATION_MAX_ROUNDS = 25 };

/* A factor and an addend for each round, then the rotation. */
enum { SF_PERMUTATION_MAX_KEYS = 2 * SF_PERMUTATION_MAX_ROUNDS + 1 };

/* What the permutations of one count share. */
typedef struct sf_permutation_shape {
    uint32_t last;        /* count - 1 */
    uint32_t rows;        /* at most 2^16 */
    uint32_t column_bits; /* 1 .. 16 */
    uint32_t rounds;      /* odd */
} sf_permutation_shape;

static inline sf_permutation_shape sf_permutation_shape_of(uint64_t count) {
    sf_permutation_shape shape = {(uint32_t)(count - 1), 1, 1, SF_PERMUTATION_ROUNDS};
    while (UINT64_C(1) << (2 * shape.column_bits) < count) ++shape.column_bits;
    shape.rows = (uint32_t)((count - 1) >> shape.column_bits) + 1;
    if (count < 4096) shape.rounds = count > 16 ? SF_PERMUTATION_FEW_ROUNDS : SF_PERMUTATION_MAX_ROUNDS;
    return shape;
}

static inline uint32_t sf_permutation_key_count(const sf_permutation_shape *shape) { return 2 * shape->rounds + 1; }

static inline void sf_permutation_keys(const sf_permutation_shape *shape, uint64_t key,
                                       uint32_t keys[SF_PERMUTATION_MAX_KEYS]) {
    for (uint32_t round = 0; round <= shape->rounds; ++round) {
        uint64_t word = sf_mix64(key + (round + UINT64_C(1)) * UINT64_C(0x9e3779b97f4a7c15));
        if (round == shape->rounds) {
            keys[2 * round] = (uint32_t)((word >> 32) * (shape->last + UINT64_C(1)) >> 32);
            return;
        }
        keys[2 * round] = (uint32_t)word;
        keys[2 * round + 1] = (uint32_t)(word >> 32);
    }
}

/* row <- row + hash of the column, modulo the rows. */
static inline uint32_t sf_permutation_move_row(const sf_permutation_shape *shape, uint32_t row, uint32_t column,
                                               uint32_t factor, uint32_t addend) {
    row += ((column * factor + addend) >> 16) * shape->rows >> 16;
    uint32_t wrapped = row - shape->rows;
    return wrapped < row ? wrapped : row;
}

/* column <- column + hash of the row, modulo the columns. */
static inline uint32_t sf_permutation_move_column(const sf_permutation_shape *shape, uint32_t row, uint32_t column,
                                                  uint32_t factor, uint32_t addend) {
    uint32_t bits = shape->column_bits;
    return (column + ((row * factor + addend) >> (32 - bits))) & ((UINT32_C(1) << bits) - 1);
}

static inline uint32_t sf_permutation_rotate(const sf_permutation_shape *shape, uint32_t number, uint32_t rotation) {
    return number > shape->last - rotation ? number - (shape->last - rotation) - 1 : number + rotation;
}

/* All rounds, once: the image may be past the last. Keys `stride` apart. */
static inline uint32_t sf_permutation_pass(const sf_permutation_shape *shape, uint32_t number, const uint32_t *keys,
                                           size_t stride) {
    uint32_t row = number >> shape->column_bits, column = number & ((UINT32_C(1) << shape->column_bits) - 1);
    row = sf_permutation_move_row(shape, row, column, keys[0], keys[stride]);
    for (uint32_t round = 1; round < shape->rounds; round += 2) {
        const uint32_t *k = keys + 2 * round * stride;
        column = sf_permutation_move_column(shape, row, column, k[0], k[stride]);
        row = sf_permutation_move_row(shape, row, column, k[2 * stride], k[3 * stride]);
    }
    return row << shape->column_bits | column;
}

/* The image of `number`, which is below the count, under sf_permutation_keys. */
static inline uint32_t sf_permute(const sf_permutation_shape *shape, uint32_t number, const uint32_t *keys) {
    do number = sf_permutation_pass(shape, number, keys, 1);
    while (number > shape->last);
    return sf_permutation_rotate(shape, number, keys[2 * shape->rounds]);
}

#endif
