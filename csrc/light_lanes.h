// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What the kernels that sample light share: choosing a piece, and the bin of a shadow ray. */
#ifndef SUNFLECK_LIGHT_LANES_H
#define SUNFLECK_LIGHT_LANES_H

#include "batch.h"

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

#define SF_SHADOW_BINS 64 /* 4 quarters of a cell x 4 x 4 cells of the light */

/* The quarter of the cell and the cell of the light: rays of a bin start close to each other and
 * end close to each other. */
static inline uint32_t sf_shadow_bin(const sf_batch *b, uint32_t ray, float s, float t) {
    return b->path[ray] / (b->width * SF_BLOCKS / 4) * 16 + (uint32_t)(int)(s * 4) * 4 + (uint32_t)(int)(t * 4);
}

#endif
