// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Adds to a pixel's statistics, and tells their half-width. */
#include "film/pixel.h"

#include <math.h>

void sf_film_add(sf_film_pixel *pixel, const sf_block_statistics *block) {
    sf_vector_moments_merge(&pixel->moments, &block->moments);
    pixel->hits += block->hits;
}

void sf_film_merge_pixel(sf_film_pixel *pixel, const sf_film_pixel *other) {
    sf_vector_moments_merge(&pixel->moments, &other->moments);
    pixel->hits += other->hits;
}

float sf_film_half_width(const sf_film_pixel *pixel, double z) {
    return (float)(z * sf_vector_moments_standard_error(&pixel->moments) * sqrt(1.0 / 3.0));
}
