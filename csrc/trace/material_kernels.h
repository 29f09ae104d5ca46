// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What a batch's vertices do on surfaces that are not diffuse; for scenes that have any. `count`
 * is of rays. */
#ifndef SUNFLECK_MATERIAL_KERNELS_H
#define SUNFLECK_MATERIAL_KERNELS_H

#include "base/isa_dispatch.h"
#include "trace/batch.h"

typedef struct sf_material_kernels {
    /* Takes along what the material needs of the rays that were kept (`order`), whose vertices
     * have been moved together: before any of them goes on. */
    void (*keep)(sf_batch *batch, const sf_scene *scene, uint32_t count);

    /* The same once more among the vertices themselves. */
    void (*compact)(sf_batch *batch, uint32_t count);

    /* Sorts the vertices by the way they scatter into `by_scatter`. */
    void (*sort)(sf_batch *batch, const sf_scene *scene, uint32_t count);

    /* Light sampled from the vertices: `contribution`, which is bare, times what
     * the surface scatters of it, in the share that multiple importance sampling leaves to light
     * sampling; where the shadow rays start, and `alive`. Smooth surfaces have none of it.
     * `diffuse_goes_on`: diffuse vertices will draw a surface ray too. */
    void (*respond)(sf_batch *batch, const sf_scene *scene, bool diffuse_goes_on);

    /* Clears `alive` of the diffuse vertices, and sets it for the others. */
    void (*end_diffuse)(sf_batch *batch, uint32_t count);

    /* New rays off the surfaces that are not diffuse, from coordinate[0 .. 1] and [2] to choose a
     * lobe; throughput times what they scatter, and `alive` of all. */
    void (*scatter)(sf_batch *batch, const sf_scene *scene, uint32_t count);
} sf_material_kernels;
SF_KERNELS(sf_material_kernels)

#endif
