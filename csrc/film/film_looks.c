// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Asks the stopping rule about a film's pixels: pool by pool, and averaged over neighbours. */
#include "film/film_looks.h"

#include <math.h>

#include "film/signed_filter.h"

/* ---- pools ---- */

static uint32_t pool_columns(const sf_film *film) {
    return (film->x0 + film->width - 1) / SF_POOL_SIZE - film->x0 / SF_POOL_SIZE + 1;
}

uint32_t sf_film_pool_count(const sf_film *film) {
    return pool_columns(film) * ((film->y0 + film->height - 1) / SF_POOL_SIZE - film->y0 / SF_POOL_SIZE + 1);
}

static uint32_t pool_of(const sf_film *film, uint32_t x, uint32_t y) {
    uint32_t column = (film->x0 + x) / SF_POOL_SIZE - film->x0 / SF_POOL_SIZE;
    return ((film->y0 + y) / SF_POOL_SIZE - film->y0 / SF_POOL_SIZE) * pool_columns(film) + column;
}

static uint32_t held(uint32_t frame, uint32_t offset, uint32_t size) {
    uint32_t inside = frame > offset ? frame - offset : 0;
    return inside < size ? inside : size;
}

sf_pool_range sf_film_pool_range(const sf_film *film, uint32_t pool) {
    uint32_t left = (film->x0 / SF_POOL_SIZE + pool % pool_columns(film)) * SF_POOL_SIZE;
    uint32_t top = (film->y0 / SF_POOL_SIZE + pool / pool_columns(film)) * SF_POOL_SIZE;
    return (sf_pool_range){held(left, film->x0, film->width), held(top, film->y0, film->height),
                           held(left + SF_POOL_SIZE, film->x0, film->width),
                           held(top + SF_POOL_SIZE, film->y0, film->height)};
}

static sf_stop_pool sum_pool(const sf_film *film, sf_pool_range range, uint32_t look, sf_pairing pairing) {
    sf_stop_pool pool = {.looked_at = 0};
    for (uint32_t y = range.y0; y < range.y1; ++y)
        for (uint32_t x = range.x0; x < range.x1; ++x) sf_stop_pool_add(&pool, sf_film_at(film, x, y), look, pairing);
    return pool;
}

void sf_film_look_at_pool(sf_film *film, uint32_t pool, uint32_t look, sf_pairing pairing) {
    sf_pool_range range = sf_film_pool_range(film, pool);
    sf_stop_pool sums = sum_pool(film, range, look, pairing);
    float decay = film->decay[pool] = sf_stop_pool_decay(&sums, pairing);
    float least = sf_stop_pool_least_variance(&sums, pairing, decay);
    for (uint32_t y = range.y0; y < range.y1; ++y)
        for (uint32_t x = range.x0; x < range.x1; ++x) {
            sf_film_pixel *pixel = sf_film_at(film, x, y);
            if (sf_film_taken(pixel) != look) continue;
            float variance = sf_dyadic_variance(&pixel->evidence.dyadic, pairing, decay);
            pixel->look = (uint8_t)(pairing.levels + pairing.unit_shift);
            pixel->doubt = variance < least;
            pixel->variance = pixel->doubt ? least : variance;
        }
}

/* ---- half-widths ---- */

/* decay^power, of a neighbour looked at so many doublings later. */
static float power_of(float decay, int power) {
    float result = 1;
    for (; power > 0; --power) result *= decay;
    for (; power < 0; ++power) result /= decay;
    return result;
}

/* The mean over the 3 x 3 pixels around of the variance at this pixel's look, or of the relative one;
 * those that stopped at another look are carried there by the decay. */
static inline float pooled_variance(const sf_film *film, uint32_t x, uint32_t y, bool relative) {
    const sf_film_pixel *centre = sf_film_at(film, x, y);
    float decay = film->decay[pool_of(film, x, y)], sum = 0, count = 0;
    for (uint32_t v = y ? y - 1 : 0; v <= y + 1 && v < film->height; ++v)
        for (uint32_t u = x ? x - 1 : 0; u <= x + 1 && u < film->width; ++u) {
            const sf_film_pixel *pixel = sf_film_at(film, u, v);
            if (!pixel->look) continue;
            float variance = pixel->variance * power_of(decay, (int)pixel->look - (int)centre->look);
            sum += relative ? variance * (float)sf_stop_relative_weight(pixel) : variance;
            ++count;
        }
    return sum / count;
}

/* Where 25 n samples around saw no difference, there may still be one that is rarer than that: it is taken to
 * be of the size of the frame's level. */
static double unseen(const sf_film *film, double n) { return film->unseen * film->summary.level / (25 * n); }

static float replicates_half_width(const sf_film *film, const sf_film_pixel *pixel, double factor) {
    double mean = sf_film_level_of(&pixel->moments),
           blocks = (double)(sf_film_taken(pixel) / (SF_LANES * SF_REPLICATES));
    if (film->signed_pixels) mean = film->signed_pixels[pixel - film->pixels].blocks / (blocks * SF_REPLICATES);
    return (float)(factor * sqrt(sf_stop_replicates_variance(pixel, mean)));
}

float sf_film_half_width_at(const sf_film *film, uint32_t x, uint32_t y) {
    const sf_film_pixel *pixel = sf_film_at(film, x, y);
    const sf_render_options *o = &film->options;
    double factor = sf_stop_factor(film->factors, o, pixel);
    if (o->stop == SF_STOP_RULE_REPLICATES && sf_stop_is_look(o, (uint32_t)sf_film_taken(pixel)))
        return replicates_half_width(film, pixel, factor);
    if (o->stop != SF_STOP_RULE_DYADIC || !pixel->look) return sf_film_half_width(pixel, factor);
    double half_width = factor * sqrt((double)pooled_variance(film, x, y, false));
    double least = unseen(film, (double)((uint64_t)SF_LANES << pixel->look));
    return (float)(half_width > least ? half_width : least);
}

double sf_film_relative_error(const sf_film *film, const sf_film_pixel *pixel) {
    if (sf_film_taken(pixel) == 0) return INFINITY;
    if (film->options.stop == SF_STOP_RULE_DYADIC && pixel->look)
        return SF_DYADIC_SAFETY * (double)pixel->variance * sf_stop_relative_weight(pixel);
    double error = (double)pixel->half_width / sf_stop_factor(film->factors, &film->options, pixel);
    return error * error * sf_stop_relative_weight(pixel);
}

float sf_film_relative_error_around(const sf_film *film, uint32_t x, uint32_t y) {
    const sf_film_pixel *pixel = sf_film_at(film, x, y);
    if (film->options.stop != SF_STOP_RULE_DYADIC || !pixel->look) return (float)sf_film_relative_error(film, pixel);
    return (float)SF_DYADIC_SAFETY * pooled_variance(film, x, y, true);
}

float sf_film_decay_at(const sf_film *film, uint32_t x, uint32_t y) {
    float decay = film->decay[pool_of(film, x, y)];
    return decay > 2 ? decay : 2;
}
