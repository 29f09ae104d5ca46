// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Light sampled from a batch's vertices. `count` is of rays; every loop runs over whole
 * packets. */
#ifndef SUNFLECK_LIGHT_KERNELS_H
#define SUNFLECK_LIGHT_KERNELS_H

#include "base/isa_dispatch.h"
#include "trace/batch.h"

typedef struct sf_light_kernels {
    /* Shadow rays towards the light points that coordinate[0 .. 1] (and [2], if there is a
     * choice) stand for: to_light, contribution, and `alive` where it is not zero.
     * `weigh`: surface rays may find the same light, so take the light's share only. */
    void (*light)(sf_batch *batch, const sf_scene *scene, uint32_t count, bool weigh);

    /* Adds the contributions that arrive to the radiance of their paths. */
    void (*add_light)(sf_batch *batch, uint32_t count);
} sf_light_kernels;
SF_KERNELS(sf_light_kernels)

#endif
