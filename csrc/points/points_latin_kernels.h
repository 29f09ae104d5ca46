// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#ifndef SUNFLECK_POINTS_LATIN_KERNELS_H
#define SUNFLECK_POINTS_LATIN_KERNELS_H

#include "base/isa_dispatch.h"
#include "points/permutation.h"

/* A latin hypercube laid out for filling rows in order: what belongs to a word of a row is
 * repeated until it is long enough for a vector loop. One block of memory. */
typedef struct sf_latin_tables {
    sf_permutation_shape shape;
    uint64_t count;
    uint32_t count_bits; /* log2 of the count, rounded down */
    uint32_t period;     /* words; a multiple of dims */
    uint32_t period_rows;
    uint32_t *rows;   /* [period]: the word's row, 0 .. period_rows - 1 */
    uint32_t *keys;   /* [2 rounds + 1][period]: of the permutations, see sf_permutation_keys */
    uint32_t *places; /* [period]: keys of the places in the strata */
} sf_latin_tables;

typedef struct sf_latin_kernels {
    /* `words` words from row `first` on; the low ones unless `low` is NULL. */
    void (*fill)(const sf_latin_tables *tables, uint32_t first, size_t words, uint32_t *high, uint32_t *low);
} sf_latin_kernels;

SF_KERNELS(sf_latin_kernels)

#endif
