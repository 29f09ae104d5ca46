// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* uniformity: how evenly points fill the unit cube.
 *
 * Points are `count` rows of `dims` doubles, count >= 1, dims >= 1, packed. Every function is
 * thread-safe, uses up to `threads` threads (0: one for each processor), and gives the same bits
 * for any number of them and on every instruction set. A coordinate outside the interval
 * that a function states, NaN included, is refused with its place. Where `interrupt` (NULL: none) says
 * stop, nothing is written but the error.
 */
#ifndef SUNFLECK_UNIFORMITY_H
#define SUNFLECK_UNIFORMITY_H

#include "sunfleck/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Discrepancies in closed form: means over boxes of the squared difference between the share of
 * points in a box and its volume. */
typedef enum sf_discrepancy_kind {
    SF_DISCREPANCY_CENTERED = 0, /* boxes from the nearest corner; squared (Hickernell 1998, "A generalized
                                    discrepancy and quadrature error bound") */
    SF_DISCREPANCY_WRAPAROUND,   /* boxes on the torus; squared (Hickernell 1998, "Lattice rules: how well
                                    do they measure up?") */
    SF_DISCREPANCY_MIXTURE,      /* of the two; squared (Zhou, Fang & Ning 2013, "Mixture discrepancy for
                                    quasi-random point sets") */
    SF_DISCREPANCY_L2_STAR,      /* boxes from the origin; not squared (Warnock 1972, "Computational
                                    investigations of low-discrepancy point sets") */
    SF_DISCREPANCY_KIND_COUNT
} sf_discrepancy_kind;

/* "centered", … and a line about each; NULL beyond the last, so that they can be listed. */
SF_API const char *sf_discrepancy_kind_name(sf_discrepancy_kind kind);
SF_API const char *sf_discrepancy_kind_description(sf_discrepancy_kind kind);

/* The kind called `name`; the error lists the names. */
SF_API sf_status sf_discrepancy_kind_find(const char *name, sf_discrepancy_kind *kind, sf_error *error);

/* The discrepancy of points in [0,1]^dims, as SciPy defines it: three squared, l2-star its root.
 *
 * Cost: count^2 dims / 2 terms. Rounding: a difference of sums of about (13/12)^dims (centered),
 * (4/3)^dims (wraparound), (19/12)^dims (mixture), 3^-dims (l2-star), each known to some 1e-15 of
 * itself. Refuses dims for which those are beyond a double. */
SF_API sf_status sf_discrepancy(sf_discrepancy_kind kind, const double *points, size_t count, uint32_t dims,
                                uint32_t threads, double *value, const sf_interrupt *interrupt, sf_error *error);

/* Bounds of the star discrepancy, the greatest difference between the share of points in a box
 * [0,y) and its volume, of points in [0,1)^dims: lower <= D* <= upper.
 *
 * Both are D* itself, up to rounding, in one dimension and wherever (count + 32)^2 (count + 1)^(dims - 2)
 * is at most 1.06 * 2^32 (65,536 points in 2 dimensions, 1,600 in 3, 240 in 4): every box that may
 * be the worst is visited. Otherwise the cube is covered by at most `boxes` boxes (1 .. 2^20) of equal
 * weight, which is what `upper` - `lower` comes to at most (Thiemard 2001, "An algorithm to compute
 * bounds for the star discrepancy"), in boxes * count * dims steps at most. Beyond 32 dimensions
 * the cover is one box: `upper` is 1. One thread. */
SF_API sf_status sf_star_discrepancy(const double *points, size_t count, uint32_t dims, uint64_t boxes, double *lower,
                                     double *upper, const sf_interrupt *interrupt, sf_error *error);

/* The t of the points as a (t,m,dims)-net in `base` (2 .. 65536), count = base^m in [0,1)^dims:
 * the least for which every elementary interval of volume base^(t-m) holds base^t points.
 * (Niederreiter 1987.) 0 is the best; m the worst, and every set of points is an (m,m,dims)-net.
 *
 * Levels k = m - t are tested upwards until one fails: C(k + dims - 1, k) shapes of interval at
 * each, count * dims steps a shape. `effort` caps the steps of all, in units of 2^30 (0: no cap);
 * beyond it the call fails with SF_STATUS_UNSUPPORTED and the message has the bound on t reached.
 *
 * Coordinates are taken as they are where the base is a power of 2; in other bases, whose borders
 * no double holds, one less than 2^-50 below a border counts as on it. */
SF_API sf_status sf_net_t_value(const double *points, size_t count, uint32_t dims, uint32_t base, uint32_t effort,
                                uint32_t threads, uint32_t *t, const sf_interrupt *interrupt, sf_error *error);

/* The least distance of two points in [0,1]^dims, count >= 2; on the torus where `toroidal` is not
 * 0, where opposite sides are the same. Cost: a sweep along the first coordinate, count^2 dims / 2
 * steps at most, far fewer in low dimensions. */
SF_API sf_status sf_minimum_distance(const double *points, size_t count, uint32_t dims, int toroidal, uint32_t threads,
                                     double *distance, const sf_interrupt *interrupt, sf_error *error);

#ifdef __cplusplus
}
#endif
#endif
