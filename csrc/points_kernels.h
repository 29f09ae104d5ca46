// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#ifndef SUNFLECK_POINTS_KERNELS_H
#define SUNFLECK_POINTS_KERNELS_H

#include "level.h"
#include "sunfleck/points.h"

/* A Sobol' net laid out for filling rows in order. A block of 2^block_bits points shares the high
 * bits of its index: its words are those of block 0 (`low`) XOR one row of the high bits, and
 * the row of the next block differs by one row of `steps`. Rows are repeated until they are long
 * enough for a vector loop. */
typedef struct sf_sobol_tables {
    uint32_t dims;
    unsigned block_bits;
    uint32_t period;   /* words of a repeated row; divides the words of a block */
    uint32_t *columns; /* [32][dims]: direction numbers, bits reversed where `keys` is set */
    uint32_t *low;     /* [2^block_bits][dims] */
    uint32_t *steps;   /* [32 - block_bits][period]: XOR of columns block_bits .. block_bits + k */
    uint32_t *keys;    /* [period], of the Owen scramble; NULL: plain */
} sf_sobol_tables;

typedef struct sf_points_kernels {
    void (*f32)(size_t count, const uint32_t *high, float *out);
    void (*f64)(size_t count, const uint32_t *high, const uint32_t *low, double *out);
    /* Points first .. first + rows - 1; `state` is the repeated row of high bits of the block
     * that `first` lies in, and on return that of first + rows. */
    void (*sobol)(const sf_sobol_tables *tables, uint64_t first, size_t rows, uint32_t *state, uint32_t *out);
    /* The low words of Owen-scrambled points: hashes of word and key. */
    void (*owen_low)(size_t count, const uint32_t *high, const uint32_t *keys, uint32_t period, uint32_t *low);
    /* keys[i] = sf_hash64(seed, first + i). */
    void (*row_keys)(uint64_t seed, uint64_t first, size_t rows, uint64_t *keys);
    /* The words of sf_mix64(key of the row + (dimension + 1) * golden ratio). */
    void (*random)(const uint64_t *keys, size_t rows, uint32_t dims, uint32_t *high, uint32_t *low);
    /* Moves random words into cell `cells[i]` of sides[i mod dims]; see sf_place_in_cell. */
    void (*place)(size_t rows, uint32_t dims, const uint32_t *sides, const uint32_t *cells, uint32_t *high,
                  uint32_t *low);
} sf_points_kernels;

SF_KERNELS(sf_points_kernels)

/* The first multiple of 2^-24 at or above cell / side, as a fraction of 2^32. Exact: cell * 2^24
 * < 2^48 is a double, and a quotient that is no integer is at least 2^-24 away from one, a
 * hundred times what the division rounds by. */
static inline uint64_t sf_cell_border(uint32_t cell, uint32_t side) {
    double quotient = (double)cell * 0x1p24 / (double)side;
    uint64_t whole = (uint64_t)(int64_t)quotient;
    return (whole + ((double)(int64_t)whole < quotient)) << 8;
}

/* A 64-bit random word moved into [border(cell), border(cell + 1)): both the 32-bit word and its
 * top 24 bits then lie in the cell. */
static inline uint64_t sf_place_in_cell(uint64_t random, uint32_t cell, uint32_t side) {
    uint64_t begin = sf_cell_border(cell, side), width = sf_cell_border(cell + 1, side) - begin;
    return (begin << 32) + (random >> 32) * width + ((random & 0xffffffffu) * width >> 32);
}

/* The random word of the patterns random and jittered. */
static inline uint64_t sf_random_word(uint64_t row_key, uint32_t dimension) {
    return sf_mix64(row_key + (dimension + UINT64_C(1)) * UINT64_C(0x9e3779b97f4a7c15));
}

/* What continues an Owen-scrambled word below its 32 bits. Distinct indices have distinct words,
 * so that Owen's flips beyond depth 32 are independent uniform bits: any hash of the word. */
static inline uint32_t sf_owen_low_word(uint32_t word, uint32_t key) {
    word = (word ^ key ^ 0x6a09e667u) * 0x7feb352du;
    word = (word ^ word >> 15) * 0x846ca68bu;
    return word ^ word >> 16;
}

#endif
