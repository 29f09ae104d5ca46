// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Adds samples of either sign of a filter to a pixel, and tells the pixel's moments from the two parts. */
#include "film/signed_filter.h"

#include "film/film_internal.h"
#include "mapping/lanczos_table_f64.h"

double sf_filter_negative_part(sf_pixel_filter filter) {
    /* Of one axis: the integrals of |f| over those of f; see mapping_pixel.h. */
    const double *lobe = sf_lanczos_lobes_f64;
    double mitchell = 367.0 / 343.0, lanczos = (lobe[0] + lobe[1] + lobe[2]) / (lobe[0] - lobe[1] + lobe[2]);
    switch (filter) {
        case SF_PIXEL_FILTER_MITCHELL: return (mitchell * mitchell - 1) / 2;
        case SF_PIXEL_FILTER_LANCZOS: return (lanczos * lanczos - 1) / 2;
        default: return 0;
    }
}

/* The variance of the samples of one sign; below two of them, that of all samples stands in. */
static double variance_of(const sf_vector_moments *part, double of_all) {
    double n = (double)part->count;
    return (n > 1 ? part->m2 / (n - 1) : of_all) / (n > 1 ? n : 1);
}

/* Tells the pixel's moments from its parts: mean, and an m2 that is n (n - 1) times its variance. */
static void tell_moments(sf_vector_moments *moments, const sf_signed_pixel *parts, double b) {
    const sf_vector_moments *positive = &parts->positive, *negative = &parts->negative;
    sf_vector_moments all = *positive;
    sf_vector_moments_merge(&all, negative);
    double n = (double)all.count, of_all = n > 1 ? all.m2 / (n - 1) : 0;
    const double *plus = positive->count ? positive->mean : negative->mean;
    const double *minus = negative->count ? negative->mean : positive->mean;
    for (int c = 0; c < 3; ++c) all.mean[c] = plus[c] + b * (plus[c] - minus[c]);
    double variance = (1 + b) * (1 + b) * variance_of(positive, of_all) + b * b * variance_of(negative, of_all);
    all.m2 = n > 1 ? n * (n - 1) * variance : 0;
    *moments = all;
}

/* The block's samples together: mean of w r - (mean of w - 1) beta, with the weights w = +-(1 + 2 b)
 * and beta halfway between the pixel's two means. For a block that is all of its pixel this is the
 * pixel's own estimate. */
static void join(sf_vector_moments *block, const sf_vector_moments *negative, const sf_signed_pixel *parts, double b) {
    const double *plus = parts->positive.count ? parts->positive.mean : parts->negative.mean;
    const double *minus = parts->negative.count ? parts->negative.mean : parts->positive.mean;
    double n = (double)(block->count + negative->count), weight = n > 0 ? (1 + 2 * b) / n : 0;
    double up = weight * (double)block->count, down = weight * (double)negative->count;
    for (int c = 0; c < 3; ++c) {
        double beta = (plus[c] + minus[c]) / 2;
        double correction = n > 0 ? beta * (up - down - 1) : 0;
        block->mean[c] = up * block->mean[c] - down * negative->mean[c] - correction;
    }
    block->count += negative->count;
    block->nonfinite += negative->nonfinite;
}

void sf_signed_add(sf_film *film, uint32_t pixel, sf_block_statistics *block, const sf_vector_moments *negative) {
    sf_signed_pixel *parts = film->signed_pixels + pixel;
    sf_vector_moments_merge(&parts->positive, &block->moments);
    sf_vector_moments_merge(&parts->negative, negative);
    tell_moments(&film->pixels[pixel].moments, parts, film->negative_part);
    film->pixels[pixel].hits += block->hits;
    join(&block->moments, negative, parts, film->negative_part);
    parts->blocks += sf_film_level_of(&block->moments);
}

void sf_signed_merge(sf_film_pixel *pixel, sf_signed_pixel *parts, const sf_signed_pixel *other, double b) {
    sf_vector_moments_merge(&parts->positive, &other->positive);
    sf_vector_moments_merge(&parts->negative, &other->negative);
    parts->blocks += other->blocks;
    tell_moments(&pixel->moments, parts, b);
}
