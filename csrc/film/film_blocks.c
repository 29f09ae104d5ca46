// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Adds the blocks of a round to a film. */
#include "film/film_blocks.h"

#include "film/aov.h"
#include "film/film_internal.h"
#include "film/signed_filter.h"

/* Adds block i to its pixel's statistics, and to what the stopping rule keeps. */
static void add_block(sf_film *film, const sf_film_round *round, const sf_film_blocks *blocks, uint32_t i) {
    const sf_block *block = blocks->blocks + i;
    sf_block_statistics *statistics = blocks->statistics + i;
    sf_film_pixel *pixel = film->pixels + block->pixel;
    bool lap_begins = round->pairing.levels && round->from && sf_film_taken(pixel) == round->from &&
                      sf_stop_is_look(&film->options, round->from);
    if (lap_begins) sf_dyadic_begin(&pixel->evidence.dyadic, sf_film_level_of(&pixel->moments));
    if (film->signed_pixels)
        sf_signed_add(film, block->pixel, statistics, blocks->negative + i);
    else
        sf_film_add(pixel, statistics);
    double mean = sf_film_level_of(&statistics->moments);
    if (round->pairing.levels) sf_dyadic_add(&pixel->evidence.dyadic, mean, block->number, round->pairing);
    uint32_t replicate = block->number % SF_REPLICATES;
    if (film->options.stop == SF_STOP_RULE_REPLICATES && !round->second && replicate < SF_REPLICATES - 1)
        pixel->evidence.replicates[replicate] += mean;
}

void sf_film_add_blocks(sf_film *film, const sf_film_round *round, const sf_film_blocks *blocks) {
    for (uint32_t i = 0; i < blocks->count; ++i) add_block(film, round, blocks, i);
    if (film->aovs) sf_aov_add(film->aovs, blocks->count, blocks->blocks, blocks->statistics, blocks->hits);
}
