// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* When a pixel is done: at which sample counts a rule looks, and what it makes of the evidence.
 *
 * The rule "dyadic" needs no replicates. Let a pixel's first n = 2^m points of one scrambled
 * sequence have halves with means A and B. The halves are exchangeable, so that with d = (A-B)/2
 * the variance of a mean obeys V(n/2) = V(n) + E d^2. Where V falls as n^-a, V(n) = E d^2 / (2^a - 1):
 * a = 1 for independent samples, up to 3 for stratified ones. The same holds for the two halves'
 * own halves, and so on: four levels of differences are kept, pairs of n/2, n/4, n/8 and n/16
 * points. Their decay, pooled over cells of 16 x 16 pixels fixed in the frame, gives a, held
 * within 1 .. 2.5; every level then predicts V(n), and the predictions are averaged in proportion
 * to their pairs, and over the 3 x 3 pixels around.
 *
 * Where light is rare, pixels that happen to have seen little of it have small differences, and
 * would stop first. Such places are told by their samples: where, over a pooling cell, the variance
 * of a sample is beyond SF_HEAVY_TAIL times the square of the mean, no pixel of it is believed to
 * have less than a quarter of the cell's mean variance. Pixels that were raised so, and do not meet
 * the tolerance for it, are those that stop as suspicious.
 *
 * Decisions fall at barriers between rounds, from all pixels' evidence up to there: no bit
 * depends on threads or tiles. */
#ifndef SUNFLECK_STOPPING_H
#define SUNFLECK_STOPPING_H

#include <stdbool.h>

#include "film/block.h"
#include "film/film_internal.h"

#define SF_POOL_SIZE 16u /* pixels a side of the cells that decay is pooled over */

/* Variance of a sample over the square of the mean from which on a pool's light is rare: that of an
 * event of probability 1/9. Measured, 32 samples a pixel: three quarters of keyhole's pools are beyond
 * 15, the largest of penumbra and defocus have 3.6, and 2 of 64 in cornell are beyond 8. */
#define SF_HEAVY_TAIL 8

/* The samples between two looks: units of 2^unit_shift blocks, paired up over `levels` levels. */
typedef struct sf_lap {
    unsigned levels; /* 0: the rule keeps no differences */
    unsigned unit_shift;
} sf_lap;

/* A quarter more than n, in whole blocks: one at the least, 256 samples at the most. */
static inline uint32_t sf_stop_quarter_more(uint32_t n) {
    uint32_t step = n / 4 / SF_LANES * SF_LANES;
    step = step < SF_LANES ? SF_LANES : step > 256 ? 256 : step;
    return n / SF_LANES * SF_LANES + step;
}

/* Whether a tolerance is given. */
static inline bool sf_has_tolerance(const sf_render_options *o) {
    return o->relative_tolerance > 0 || o->absolute_tolerance > 0;
}

/* Whether all open pixels move on together: not where a budget or a goal of the picture chooses them. */
static inline bool sf_moves_together(const sf_render_options *o) { return o->spp || sf_has_tolerance(o); }

/* The most samples that a pixel may take, those before `start` too. */
static inline uint32_t sf_stop_most(const sf_render_options *o) {
    bool bounded = sf_has_tolerance(o) || o->relmse > 0;
    return o->spp ? o->start + o->spp : bounded ? o->max_spp : SF_MAX_SPP;
}

/* The least count above n at which the rule looks, whatever the render's own end; SF_MAX_SPP
 * where there is none above. */
uint32_t sf_stop_next_look(const sf_render_options *options, uint32_t n);

/* Whether the rule can tell a half-width from n samples of every pixel. */
bool sf_stop_is_look(const sf_render_options *options, uint32_t n);

/* The lap that ends with the look at `look` samples. */
sf_lap sf_stop_lap(const sf_render_options *options, uint32_t look);

/* Whether the pixel has the samples that its second set was to have. */
static inline bool sf_stop_second_is_full(const sf_film_pixel *pixel) {
    return (double)sf_film_taken(pixel) >= pixel->evidence.planned;
}

/* Readies a pixel that has been looked at for the lap after. */
void sf_dyadic_begin(sf_film_pixel *pixel);

/* Adds the mean of (R+G+B)/3 over block number `block` of the pixel's. */
void sf_dyadic_add(sf_dyadic *dyadic, double mean, uint32_t block, sf_lap lap);

/* How many cells the decay is pooled over in this film. */
uint32_t sf_stop_pool_count(const sf_film *film);

/* The pixels of a pooling cell: columns x0 .. x1 - 1, rows y0 .. y1 - 1 of the film. */
typedef struct sf_pool_range {
    uint32_t x0, y0, x1, y1;
} sf_pool_range;
sf_pool_range sf_stop_pool_range(const sf_film *film, uint32_t pool);

/* Looks at the pixels of one pooling cell that have `look` samples, of which there are some: fills their
 * `variance` and `look`. */
void sf_stop_look_at_pool(sf_film *film, uint32_t pool, uint32_t look, sf_lap lap);

/* Sets how many standard errors make half-widths: first the rule's where nothing tells how well the
 * variance is known; then, under dyadic, by the levels of differences at the last look. */
void sf_stop_set_factors(sf_film *film, const sf_render_options *options);

/* The one that the pixel's half-width has. */
double sf_stop_factor(const sf_film *film, const sf_render_options *options, const sf_film_pixel *pixel);

/* The pixel's part in relMSE: the variance of its mean of (R+G+B)/3 by the rule, with dyadic's safety, over the
 * square of each channel and 0.01, averaged. 0 where no sample differed; infinity below two samples. */
double sf_stop_relative_error(const sf_film *film, const sf_film_pixel *pixel);

/* The same, under dyadic pooled over the 3 x 3 pixels around (x, y) of the film, as half-widths are. */
float sf_stop_relative_error_around(const sf_film *film, uint32_t x, uint32_t y);

/* The factor by which variance falls as samples double, around pixel (x, y) of the film: 2 to 2^2.5. */
float sf_stop_decay(const sf_film *film, uint32_t x, uint32_t y);

/* The half-width of pixel (x, y) of the film by the rule. To be called when all pools have been
 * looked at. Infinity where fewer than two samples were taken. */
float sf_stop_half_width(const sf_film *film, const sf_render_options *options, uint32_t x, uint32_t y);

#endif
