// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* How the blocks of a round enter a film: its pixels, what the stopping rule keeps of them, and its AOVs. */
#ifndef SUNFLECK_FILM_BLOCKS_H
#define SUNFLECK_FILM_BLOCKS_H

#include "film/stopping.h"

/* What the blocks of a round have in common. */
typedef struct sf_film_round {
    uint32_t from;      /* how many samples its pixels had when it began */
    sf_pairing pairing; /* no levels: the rule keeps no differences */
    bool second;        /* of a second set, of which the rule keeps nothing */
} sf_film_round;

/* Blocks, and what each of them has come to. */
typedef struct sf_film_blocks {
    uint32_t count;
    const sf_block *blocks;
    sf_block_statistics *statistics;   /* under a filter with negative lobes they are changed: see signed_filter.h */
    const sf_vector_moments *negative; /* read under such a filter only */
    const sf_hit_sums *hits;           /* NULL where no AOV tells of first hits */
} sf_film_blocks;

/* Adds the blocks in their order; those of a pixel come in the order of their base. Threads may add to pixels that
 * are not the same. */
void sf_film_add_blocks(sf_film *film, const sf_film_round *round, const sf_film_blocks *blocks);

#endif
