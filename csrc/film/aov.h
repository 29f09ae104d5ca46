// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Arbitrary output variables (AOVs): what a film keeps beside the colours where a render asks.
 *
 * A film without them has none of this: no memory, and one branch a batch. Sums are kept in
 * double and added block by block in a pixel's own order, so that no bit depends on threads or
 * tiles. After 10^9 samples, 6 * 10^7 blocks, a sum is within 6 * 10^7 * 2^-53 < 10^-8 of itself. */
#ifndef SUNFLECK_AOV_H
#define SUNFLECK_AOV_H

#include "film/block.h"
#include "sunfleck/film.h"

/* Those that the first hit tells. */
#define SF_AOVS_OF_HITS (1u << SF_AOV_ALBEDO | 1u << SF_AOV_NORMAL | 1u << SF_AOV_DEPTH)

typedef struct sf_aov_film {
    uint32_t wanted; /* bit k: sf_aov k */
    uint32_t sums_per_pixel;
    uint32_t first_sum[SF_AOV_COUNT]; /* within a pixel: its components' sums, then their count */
    double *sums;                     /* by pixel of the traced region */
    float *values[SF_AOV_COUNT];      /* by pixel of the crop, components interleaved */
    sf_hit_sums *hits;                /* by thread and block of its batch */
    void *memory;                     /* that the arrays lie in */
    size_t memory_bytes;
} sf_aov_film;

/* Makes the film's AOVs, all sums 0; for a film whose region is known. */
sf_status sf_aov_create(const sf_render_options *options, sf_film *film, sf_error *error);
void sf_aov_destroy(sf_aov_film *aovs);

/* Sets all sums back to 0. */
void sf_aov_reset(sf_film *film);

/* Adds what `count` blocks have come to, to their pixels; `hits` is NULL where no AOV tells of first hits. */
void sf_aov_add(sf_aov_film *aovs, uint32_t count, const sf_block *blocks, const sf_block_statistics *statistics,
                const sf_hit_sums *hits);

/* Fills row y of the crop's values. */
void sf_aov_resolve_row(sf_film *film, uint32_t y);

/* The channels, in the order of the enumeration. */
size_t sf_aov_channel_count(const sf_aov_film *aovs);
sf_channel sf_aov_channel(const sf_aov_film *aovs, size_t index);

#endif
