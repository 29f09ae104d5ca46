// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Radiance of suns and the environment for rays that hit nothing. */
#ifndef SUNFLECK_SKY_KERNELS_H
#define SUNFLECK_SKY_KERNELS_H

#include "base/isa_dispatch.h"
#include "trace/batch.h"

typedef struct sf_sky_kernels {
    /* Adds to the radiance of camera rays. */
    void (*first)(sf_batch *batch, const sf_scene *scene);

    /* Adds to `emission` of surface rays, times throughput, the share that light sampling leaves. */
    void (*later)(sf_batch *batch, const sf_scene *scene, uint32_t count);
} sf_sky_kernels;
SF_KERNELS(sf_sky_kernels)

#endif
