// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The Sobol' sequence, Joe & Kuo's direction numbers: one dimension's matrix, one coordinate. */
#include <assert.h>

#include "points/tables/sobol_table.h"
#include "sunfleck/points.h"

/* The `count` bits, up to 17, of the packed table from `at`. */
static uint32_t table_bits(uint32_t at, unsigned count) {
    const uint64_t *word = sf_sobol_words + at / 64;
    unsigned shift = at % 64;
    uint64_t bits = word[0] >> shift | word[1] << 1 << (63 - shift);
    return (uint32_t)bits & ((UINT32_C(1) << count) - 1);
}

void sf_sobol_matrix(uint32_t dimension, uint32_t columns[32]) {
    assert(dimension < SF_SOBOL_MAX_DIMS);
    if (dimension == 0) {
        for (unsigned k = 0; k < 32; ++k) columns[k] = UINT32_C(1) << (31 - k);
        return;
    }
    unsigned degree = SF_SOBOL_MAX_DEGREE;
    while (dimension < sf_sobol_first_dimension[degree]) --degree;
    uint32_t at =
        sf_sobol_first_bit[degree] + (dimension - sf_sobol_first_dimension[degree]) * ((degree - 1) * (degree + 2) / 2);
    /* Read the inner coefficients a_1 (highest) .. a_(s-1), and m_1 .. m_s. */
    uint32_t coefficients = table_bits(at, degree - 1);
    at += degree - 1;
    columns[0] = UINT32_C(1) << 31;
    for (unsigned i = 2; i <= degree; at += i - 1, ++i) columns[i - 1] = (table_bits(at, i - 1) << 1 | 1) << (32 - i);
    /* Continue by the recurrence (Joe & Kuo 2008, eq. 2): v_k = a_1 v_(k-1) ^ … ^ a_(s-1)
     * v_(k-s+1) ^ v_(k-s) ^ v_(k-s) / 2^s. */
    for (unsigned k = degree; k < 32; ++k) {
        uint32_t v = columns[k - degree] ^ columns[k - degree] >> degree;
        for (unsigned i = 1; i < degree; ++i) v ^= columns[k - i] & -(coefficients >> (degree - 1 - i) & 1);
        columns[k] = v;
    }
}

uint32_t sf_sobol_bits(uint32_t index, uint32_t dimension) {
    uint32_t columns[32], word = 0;
    sf_sobol_matrix(dimension, columns);
    for (unsigned k = 0; k < 32; ++k) word ^= columns[k] & (0u - (index >> k & 1));
    return word;
}
