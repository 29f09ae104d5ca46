// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Pixels under a filter with negative lobes.
 *
 * Samples are drawn by |f| and fall apart by the sign of f there. With f scaled to the integral 1 and
 * b the integral of its negative part, the filtered value is
 *
 *     F = (1 + b) E[r | f > 0] - b E[r | f < 0],
 *
 * and its estimate has the two means in place of the expectations: m+ + b (m+ - m-). What the weights
 * of a mean would do by chance, the number of negative samples among n, does not enter: a constant image
 * is exact at any n, nothing is divided by a sum of weights of both signs, and the variance is that of
 * the residuals about either mean, (1 + b)^2 s+^2 / n+ + b^2 s-^2 / n- (stratification after
 * sampling: Cochran 1977, section 5A.9). While one sign has no sample yet the other's mean stands in.
 *
 * The film's own accumulators hold this estimate, and the sum of squares that gives its variance, so
 * that levels, half-widths and decisions read them as under any filter. The two parts are kept
 * beside, 104 bytes a pixel, only where such a filter is asked for. */
#ifndef SUNFLECK_SIGNED_FILTER_H
#define SUNFLECK_SIGNED_FILTER_H

#include "film/pixel.h"
#include "sunfleck/film.h"

typedef struct sf_signed_pixel {
    sf_vector_moments positive, negative;
    double blocks; /* sum of the blocks' (R+G+B)/3, for the rule "replicates" */
} sf_signed_pixel;

/* b: the integral of the negative part of the filter, scaled to the integral 1; 0 where it has none. */
double sf_filter_negative_part(sf_pixel_filter filter);

/* Adds a block, whose samples with f > 0 are in `block` and whose others are in `negative`, to pixel
 * number `pixel` of the film. Then `block` becomes what stopping rules and half-buffers take a block
 * for: all of its samples, whose mean is the block's own estimate of the pixel, exact for a
 * constant, with the deviation of its share of negative samples corrected by the pixel's means so far. */
void sf_signed_add(sf_film *film, uint32_t pixel, sf_block_statistics *block, const sf_vector_moments *negative);

/* Adds another film's pixel to the parts, and tells the pixel's moments from them. */
void sf_signed_merge(sf_film_pixel *pixel, sf_signed_pixel *parts, const sf_signed_pixel *other, double b);

#endif
