// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A block: sixteen samples of one pixel, which enter its statistics together. */
#ifndef SUNFLECK_BLOCK_H
#define SUNFLECK_BLOCK_H

#include <stdint.h>

#include "sunfleck/estimate.h"

#define SF_LANES 16  /* samples of a block, and rays of a packet */
#define SF_BLOCKS 64 /* blocks of a batch: the pixels of a cell */

/* Length of an array over a batch's paths: a packet more than there are. Equal places of arrays
 * that follow one another then lie in different sets of the first-level cache, which has 8 places
 * of 4,096 bytes each: at a distance of 4,096, ten arrays in a loop evict one another. */
#define SF_PATHS (SF_LANES * (SF_BLOCKS + 1))

/* Sixteen samples of one pixel, with indices base .. base + 15, of which bit l of `active` says
 * whether base + l is among those wanted. */
typedef struct sf_block {
    uint64_t key;  /* randomizes the block: of its pixel, or drawn from the thread's stream */
    uint32_t base; /* a multiple of 16 */
    uint32_t active;
    uint32_t x, y;   /* of the full frame */
    uint32_t pixel;  /* in the film */
    uint32_t number; /* among the pixel's blocks */
} sf_block;

/* What the 16 samples of a block come to: the lecture's vector mean and scalar sum of squares. */
typedef struct sf_block_statistics {
    sf_vector_moments moments; /* samples that are not finite are counted there, and left out */
    uint32_t hits;             /* finite samples whose camera ray hit a surface */
} sf_block_statistics;

/* Sums over the samples of a block whose camera ray hit a surface. */
typedef struct sf_hit_sums {
    double albedo[3], normal[3], depth, hits;
} sf_hit_sums;

#endif
