// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The packed direction numbers; make_sobol_table.py says how they lie. */
#ifndef SUNFLECK_SOBOL_TABLE_H
#define SUNFLECK_SOBOL_TABLE_H

#include <stdint.h>

#define SF_SOBOL_WORDS 49205
#define SF_SOBOL_MAX_DEGREE 18

/* By degree of the polynomial: the first dimension and where its bits begin. Entry 19 of the
 * first is the number of dimensions; entry 0 is not used. */
extern const uint32_t sf_sobol_first_dimension[20];
extern const uint32_t sf_sobol_first_bit[20];
extern const uint64_t sf_sobol_words[SF_SOBOL_WORDS];

#endif
