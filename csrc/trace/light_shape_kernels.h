// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Light of all shapes, sampled from a batch's vertices and found by its rays: the stages of scenes
 * whose lights are not all triangles and parallelograms sampled by area, and of those that take
 * one kind of sampling alone. */
#ifndef SUNFLECK_LIGHT_SHAPE_KERNELS_H
#define SUNFLECK_LIGHT_SHAPE_KERNELS_H

#include "base/isa_dispatch.h"
#include "trace/batch.h"

typedef struct sf_light_shape_kernels {
    /* As sf_light_kernels.light. */
    void (*light)(sf_batch *batch, const sf_scene *scene, uint32_t count, bool weigh);

    /* Light sampled for surfaces of any kind: `contribution` without what the surface makes of it (a
     * diffuse one would scatter cosine / pi), `light_pdf` by solid angle, infinite for a direction
     * that no ray finds; to_light and `alive` as above. */
    void (*bare_light)(sf_batch *batch, const sf_scene *scene, uint32_t count);

    /* Fills `emission` of surface rays, times throughput: the share of what they hit that light
     * sampling leaves to them, and the background. */
    void (*found)(sf_batch *batch, const sf_scene *scene, uint32_t count);
} sf_light_shape_kernels;
SF_KERNELS(sf_light_shape_kernels)

#endif
