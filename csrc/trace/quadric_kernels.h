// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Points and normals of rays that hit spheres and disks; other rays keep what they have. */
#ifndef SUNFLECK_QUADRIC_KERNELS_H
#define SUNFLECK_QUADRIC_KERNELS_H

#include "base/isa_dispatch.h"
#include "trace/batch.h"

typedef struct sf_quadric_kernels {
    /* After rays were traced: hit_normal, outwards, of length 1 within some ulp. */
    void (*face)(sf_batch *batch, const sf_scene *scene, uint32_t count);

    /* After the vertices were placed: on spheres, puts `point` on the sphere and moves it off along
     * the normal again. Embree's distance may be off it by 2^-24 of the distance to the middle. */
    void (*settle)(sf_batch *batch, const sf_scene *scene, uint32_t count);
} sf_quadric_kernels;
SF_KERNELS(sf_quadric_kernels)

#endif
