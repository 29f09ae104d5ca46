// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What the stages share that work on a batch's rays; for kernels. */
#ifndef SUNFLECK_RAYS_H
#define SUNFLECK_RAYS_H

#include <math.h>

#include "trace/batch.h"

/* Rays in whole packets. */
static inline uint32_t sf_whole_packets(uint32_t count) { return (count + SF_LANES - 1) / SF_LANES * SF_LANES; }

/* How far a hit is moved off its surface: 2^-18 of what its coordinates were computed from. */
static inline float sf_lift(float origin_x, float origin_y, float origin_z, float distance) {
    float ax = fabsf(origin_x), ay = fabsf(origin_y), az = fabsf(origin_z), largest = ax > ay ? ax : ay;
    return 0x1p-18f * ((largest > az ? largest : az) + distance);
}
/* On a sphere its middle and radius count too. */
static inline float sf_lift_on_sphere(const sf_quadric *quadric, float lift) {
    float ax = fabsf(quadric->centre[0]), ay = fabsf(quadric->centre[1]), az = fabsf(quadric->centre[2]);
    float largest = ax > ay ? ax : ay, own = 0x1p-18f * ((largest > az ? largest : az) + quadric->radius);
    return own > lift ? own : lift;
}

/* The coordinates of the rays' paths. */
static inline float (*sf_sample_dimensions_by_ray(sf_batch *b, uint32_t count, int coordinates)) [SF_PATHS] {
    if (b->in_place) return b->coordinate;
    for (int c = 0; c < coordinates; ++c)
        for (uint32_t i = 0; i < count; ++i) b->coordinate_by_ray[c][i] = b->coordinate[c][b->path[i]];
    return b->coordinate_by_ray;
}

/* Adds what the rays carry to the radiance of their paths: one by one, as processors are slow to scatter. */
static inline void sf_add_by_path(sf_batch *b, float (*value)[SF_PATHS], uint32_t count) {
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t path = b->path[i];
        b->radiance[0][path] += value[0][i];
        b->radiance[1][path] += value[1][i];
        b->radiance[2][path] += value[2][i];
    }
}

/* The power heuristic with exponent 2 (Veach 1997, eq. 9.11), pdf^2 / (pdf^2 + other^2), by the
 * ratio: the squares of densities by solid angle leave the floats' range in large scenes. */
static inline float sf_power_weight(float pdf, float other) {
    float ratio = other / pdf;
    return 1 / (1 + ratio * ratio);
}

/* What part of light that can be sampled is left to the rays that find it. */
typedef enum sf_found_share {
    SF_FOUND_ALL,      /* light is not sampled */
    SF_FOUND_NONE,     /* light sampling alone has it: but for rays of a mirror, which nothing else finds */
    SF_FOUND_WEIGHTED, /* both do, weighted by their densities */
} sf_found_share;
static inline sf_found_share sf_share_found(const sf_plan *plan) {
    if (sf_plan_has(plan, SF_STAGE_WEIGHT)) return SF_FOUND_WEIGHTED;
    return sf_plan_has(plan, SF_STAGE_LIGHT) ? SF_FOUND_NONE : SF_FOUND_ALL;
}
/* `pdf`: with which the surface drew the ray, infinity in a mirror's direction; `light_pdf`: with
 * which light sampling would have. */
static inline float sf_found_weight(sf_found_share share, float pdf, float light_pdf) {
    if (share == SF_FOUND_WEIGHTED) return sf_power_weight(pdf, light_pdf);
    return share == SF_FOUND_ALL || pdf > 3e38f ? 1.0f : 0.0f;
}

#endif
