// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What a batch's rays find, and where they go on. `count` is of rays; every loop runs over
 * whole packets. */
#ifndef SUNFLECK_SHADE_KERNELS_H
#define SUNFLECK_SHADE_KERNELS_H

#include "base/isa_dispatch.h"
#include "trace/batch.h"

typedef struct sf_shade_kernels {
    /* Radiance of the camera rays: emission seen directly, else the background. */
    void (*first_radiance)(sf_batch *batch, const sf_scene *scene);

    /* The same for surface rays: emission in the share that multiple importance sampling leaves
     * to them where the light was sampled too, and the background. */
    void (*later_radiance)(sf_batch *batch, const sf_scene *scene, uint32_t count);

    /* The vertices where the rays hit: point, normal, throughput times albedo, and `alive`.
     * Camera rays have throughput 1, which is not read. */
    void (*first_vertex)(sf_batch *batch, const sf_scene *scene);
    void (*later_vertex)(sf_batch *batch, const sf_scene *scene, uint32_t count);

    /* Ends paths at their vertices by coordinate[0], with a probability in proportion to their
     * throughput, and divides that of the others by it. */
    void (*roulette)(sf_batch *batch, uint32_t count);

    /* New rays off the surfaces, from coordinate[0 .. 1], by the cosine. */
    void (*surface)(sf_batch *batch, uint32_t count);
} sf_shade_kernels;
SF_KERNELS(sf_shade_kernels)

#endif
