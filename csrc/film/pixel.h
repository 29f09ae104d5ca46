// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A pixel's statistics: what its blocks add up to, and what the stopping rule keeps of them. */
#ifndef SUNFLECK_PIXEL_H
#define SUNFLECK_PIXEL_H

#include "film/block.h"

#define SF_DYADIC_LEVELS 4

/* What the rule "dyadic" keeps of a pixel; see stopping.h. Level 0 is the coarsest. */
typedef struct sf_dyadic {
    double unit;                      /* sum over the blocks of the unit at work */
    double pending[SF_DYADIC_LEVELS]; /* means of left halves that wait for their right ones */
    float squares[SF_DYADIC_LEVELS];  /* sums of ((A - B) / 2)^2 over the pairs of a level */
} sf_dyadic;

#define SF_REPLICATES 8 /* of the rule "replicates" */

/* A pixel's running statistics: 120 bytes, whatever the sample count. */
typedef struct sf_film_pixel {
    sf_vector_moments moments;
    union {
        sf_dyadic dyadic;
        double replicates[SF_REPLICATES - 1]; /* sums of block means; the last follows from the mean */
        double planned;                       /* of a second set: how many samples it is to have */
    } evidence;
    uint32_t hits;
    float half_width;
    float variance; /* of the mean, at the last look */
    uint8_t look;   /* that was at 16 * 2^look samples; 0: none yet */
    uint8_t reason; /* sf_stop_reason, once it has stopped */
    uint8_t doubt;  /* 1 where its variance at the last look was raised to a share of its neighbours' */
} sf_film_pixel;

/* How many samples the pixel took, those that were not finite too. */
static inline uint64_t sf_film_taken(const sf_film_pixel *pixel) {
    return pixel->moments.count + pixel->moments.nonfinite;
}

/* (R+G+B)/3 of a mean colour: what errors and levels are of. */
static inline double sf_film_level_of(const sf_vector_moments *moments) {
    return (moments->mean[0] + moments->mean[1] + moments->mean[2]) / 3;
}

/* Adds a block to its pixel; blocks of a pixel are added in the order of their base. */
void sf_film_add(sf_film_pixel *pixel, const sf_block_statistics *block);

/* Adds what another film's pixel has seen, but for half-width and reason. */
void sf_film_merge_pixel(sf_film_pixel *pixel, const sf_film_pixel *other);

/* Half-width of the error of (R+G+B)/3 by the lecture's colour rule, for z standard errors:
 * z s / sqrt(3 N). With s^2 the sum of the channels' variances, var((R+G+B)/3) <= s^2 / 3, and
 * equal to it where the channels move together. Infinity for fewer than two samples. */
float sf_film_half_width(const sf_film_pixel *pixel, double z);

#endif
