// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Looks at a film: where pixels lie that a stopping rule pools, and the half-widths that come of it.
 *
 * What a rule makes of statistics is stopping.h's; here it is asked pool by pool, and its variances are
 * averaged over neighbours. */
#ifndef SUNFLECK_FILM_LOOKS_H
#define SUNFLECK_FILM_LOOKS_H

#include "film/film_internal.h"
#include "film/stopping.h"

#define SF_POOL_SIZE 16u /* pixels a side of the cells that decay is pooled over */

/* How many cells the decay is pooled over in this film. */
uint32_t sf_film_pool_count(const sf_film *film);

/* The pixels of a pooling cell: columns x0 .. x1 - 1, rows y0 .. y1 - 1 of the film. */
typedef struct sf_pool_range {
    uint32_t x0, y0, x1, y1;
} sf_pool_range;
sf_pool_range sf_film_pool_range(const sf_film *film, uint32_t pool);

/* Looks at the pixels of one pooling cell that have `look` samples, of which there are some: fills their
 * `variance` and `look`. */
void sf_film_look_at_pool(sf_film *film, uint32_t pool, uint32_t look, sf_pairing pairing);

/* The half-width of pixel (x, y) of the film by the rule. To be called when all pools have been
 * looked at. Infinity where fewer than two samples were taken. */
float sf_film_half_width_at(const sf_film *film, uint32_t x, uint32_t y);

/* The pixel's part in relMSE: the variance of its mean of (R+G+B)/3 by the rule, with dyadic's safety, over the
 * square of each channel and 0.01, averaged. 0 where no sample differed; infinity below two samples. */
double sf_film_relative_error(const sf_film *film, const sf_film_pixel *pixel);

/* The same, under dyadic pooled over the 3 x 3 pixels around (x, y) of the film, as half-widths are. */
float sf_film_relative_error_around(const sf_film *film, uint32_t x, uint32_t y);

/* The factor by which variance falls as samples double, around pixel (x, y) of the film: 2 to 2^2.5. */
float sf_film_decay_at(const sf_film *film, uint32_t x, uint32_t y);

#endif
