// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Which of a batch's rays share a packet, and in which order. `count` is of rays. */
#ifndef SUNFLECK_ORDER_KERNELS_H
#define SUNFLECK_ORDER_KERNELS_H

#include "base/isa_dispatch.h"
#include "trace/batch.h"

typedef struct sf_order_kernels {
    /* Lists the living rays in `order`. Returns how many. */
    uint32_t (*list_alive)(sf_batch *batch, uint32_t count);

    /* The same, then moves their vertices together. */
    uint32_t (*compact)(sf_batch *batch, uint32_t count);

    /* Lists the shadow rays that have a contribution in `order`, bin by bin; the coordinates of their
     * points of the light are still there. Returns how many. */
    uint32_t (*sort_shadow_rays)(sf_batch *batch, uint32_t count);

    /* Moves the surface rays, with what their paths carry, so that those of a packet start and go alike; drops
     * those that a material did not scatter. Returns how many are left. */
    uint32_t (*sort_surface_rays)(sf_batch *batch, const sf_scene *scene, uint32_t count);
} sf_order_kernels;
SF_KERNELS(sf_order_kernels)

#endif
