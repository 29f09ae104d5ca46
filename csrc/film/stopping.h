// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* When a pixel is done: at which sample counts a rule looks, and what it makes of the evidence. A rule reads
 * the statistics of pixels and returns a variance; where the pixels lie in a film is film_looks.h's.
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

#include "film/pixel.h"
#include "sunfleck/film.h"

/* Variance of a sample over the square of the mean from which on a pool's light is rare: that of an
 * event of probability 1/9. Measured, 32 samples a pixel: three quarters of keyhole's pools are beyond
 * 15, the largest of penumbra and defocus have 3.6, and 2 of 64 in cornell are beyond 8. */
#define SF_HEAVY_TAIL 8

/* How the blocks between two looks are paired: units of 2^unit_shift blocks, over `levels` levels. */
typedef struct sf_pairing {
    unsigned levels; /* 0: the rule keeps no differences */
    unsigned unit_shift;
} sf_pairing;

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

/* How blocks are paired on the way to the look at `look` samples. */
sf_pairing sf_stop_pairing(const sf_render_options *options, uint32_t look);

/* Whether the pixel has the samples that its second set was to have. */
static inline bool sf_stop_second_is_full(const sf_film_pixel *pixel) {
    return (double)sf_film_taken(pixel) >= pixel->evidence.planned;
}

/* Readies what is kept of a pixel that has been looked at for the way to the next look; `mean` is that of
 * (R+G+B)/3 so far. */
void sf_dyadic_begin(sf_dyadic *dyadic, double mean);

/* Adds the mean of (R+G+B)/3 over block number `block` of the pixel's. */
void sf_dyadic_add(sf_dyadic *dyadic, double mean, uint32_t block, sf_pairing pairing);

/* The variance of the mean that the differences tell, where it falls by the factor `decay` as samples double. */
float sf_dyadic_variance(const sf_dyadic *dyadic, sf_pairing pairing, float decay);

/* What the averaged variance is multiplied by: pixels whose estimate came out low are the ones
 * that stop. Measured, bench/render_coverage.py: 1.0 leaves 92 % coverage on the Cornell box, 1.38 95 %. */
#define SF_DYADIC_SAFETY 1.38

/* What the pixels of a pool, over which decay is fitted, come to at a look; begins as zeros. */
typedef struct sf_stop_pool {
    double squares[SF_DYADIC_LEVELS]; /* over the pixels looked at */
    double looked_at;
    double variance, power; /* of a sample of (R+G+B)/3, and squared means: over all pixels */
} sf_stop_pool;

void sf_stop_pool_add(sf_stop_pool *pool, const sf_film_pixel *pixel, uint32_t look, sf_pairing pairing);

/* The factor 2^a by which variance falls as samples double, from the pool's differences: 2 to 2^2.5. */
float sf_stop_pool_decay(const sf_stop_pool *pool, sf_pairing pairing);

/* The least variance that a pixel of the pool is believed to have: a share of their mean where light
 * is rare. */
float sf_stop_pool_least_variance(const sf_stop_pool *pool, sf_pairing pairing, float decay);

/* The variance of a mean over eight replicates of equal size; `mean` is that of (R+G+B)/3. */
double sf_stop_replicates_variance(const sf_film_pixel *pixel, double mean);

/* The mean over channels of 1 / (r^2 + 0.01): what makes a variance an error of relMSE. */
double sf_stop_relative_weight(const sf_film_pixel *pixel);

/* Sets how many standard errors make half-widths: first the rule's where nothing tells how well the
 * variance is known; then, under dyadic, by the levels of differences at the last look. */
void sf_stop_set_factors(const sf_render_options *options, double factors[SF_DYADIC_LEVELS + 1]);

/* The one of them that the pixel's half-width has. */
double sf_stop_factor(const double factors[SF_DYADIC_LEVELS + 1], const sf_render_options *options,
                      const sf_film_pixel *pixel);

/* What the probability of an event lies below, times the samples that did not see it: -log(1 - confidence), 3 at
 * 95 % (the rule of three). */
double sf_stop_unseen(const sf_render_options *options);

#endif
