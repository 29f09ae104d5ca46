// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#ifndef SUNFLECK_POINTS_KERNELS_H
#define SUNFLECK_POINTS_KERNELS_H

#include "base/isa_dispatch.h"
#include "sunfleck/points.h"

typedef enum sf_number_type { SF_NUMBER_F32 = 0, SF_NUMBER_F64, SF_NUMBER_U32 } sf_number_type;

/* A double in [0,1) from 32 bits and the 21 top bits of a further word, each and their sum exact.
 * The offset makes the upper word a signed one, which every level can convert. */
static inline double sf_double_from_words(uint32_t high, uint32_t low) {
    double top = (double)(int32_t)(high ^ 0x80000000u) + 0x1p31;
    return top * 0x1p-32 + (double)(int32_t)(low >> 11) * 0x1p-53;
}

typedef struct sf_points_kernels {
    void (*f32)(size_t count, const uint32_t *high, float *out);
    void (*f64)(size_t count, const uint32_t *high, const uint32_t *low, double *out);
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

#endif
