// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What the kernels that sample light share: choosing a piece. */
#ifndef SUNFLECK_LIGHT_LANES_H
#define SUNFLECK_LIGHT_LANES_H

#include "trace/batch.h"

/* Draws a piece from the alias table, which is over those from `begin` on: the integer part picks a
 * column, the rest decides. */
static inline uint32_t sf_choose_piece(const sf_light_table *lights, uint32_t begin, float u) {
    uint32_t count = (uint32_t)lights->count - begin, last = count - 1;
    float place = u * (float)count;
    uint32_t column = (uint32_t)place;
    column = column < last ? column : last;
    uint32_t row = begin + column;
    return place - (float)column < lights->pieces[row][SF_LIGHT_KEEP] ? row : lights->alias[row];
}

#endif
