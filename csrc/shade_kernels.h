// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The arithmetic stages of a batch. `count` is of rays; every loop runs over whole packets. */
#ifndef SUNFLECK_SHADE_KERNELS_H
#define SUNFLECK_SHADE_KERNELS_H

#include "batch.h"
#include "level.h"

typedef struct sf_shade_kernels {
    /* Camera rays of every lane of the blocks, from coordinate[0 .. 1], and on a lens from
     * lens[0 .. 1]; NULL for a pinhole. */
    void (*camera)(sf_batch *batch, const sf_camera_frame *camera, sf_pixel_filter filter, float (*lens)[SF_PATHS]);

    /* Radiance of the camera rays: emission seen directly, else the background. */
    void (*first_radiance)(sf_batch *batch, const sf_scene *scene);

    /* The same for surface rays: emission in the share that multiple importance sampling leaves
     * to them where the light was sampled too, and the background. */
    void (*later_radiance)(sf_batch *batch, const sf_scene *scene, uint32_t count);

    /* The vertices where the rays hit: point, normal, throughput times albedo, and `alive`.
     * Camera rays have throughput 1, which is not read. */
    void (*first_vertex)(sf_batch *batch, const sf_scene *scene);
    void (*later_vertex)(sf_batch *batch, const sf_scene *scene, uint32_t count);

    /* Lists the living rays in `order`, then moves their vertices together. Returns how many. */
    uint32_t (*compact)(sf_batch *batch, uint32_t count);

    /* Shadow rays towards the light points that coordinate[0 .. 1] (and [2], if there is a
     * choice) stand for: to_light, contribution, bin, and `alive` where it is not zero.
     * `weigh`: surface rays may find the same light, so take the light's share only. */
    void (*light)(sf_batch *batch, const sf_scene *scene, uint32_t count, bool weigh);

    /* Lists the rays that have a contribution in `order`, bin by bin. Returns how many. */
    uint32_t (*sort_shadow_rays)(sf_batch *batch, uint32_t count);
    /* Adds the contributions that arrive to the radiance of their paths. */
    void (*add_light)(sf_batch *batch, uint32_t count);

    /* New rays off the surfaces, from coordinate[0 .. 1], by the cosine. */
    void (*surface)(sf_batch *batch, uint32_t count);

    /* The statistics of every block from radiance and covered. */
    void (*gather_statistics)(sf_batch *batch);
} sf_shade_kernels;
SF_KERNELS(sf_shade_kernels)

#endif
