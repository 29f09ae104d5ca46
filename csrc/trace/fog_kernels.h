// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Fog between surfaces: where rays scatter in it, and what it leaves of light. */
#ifndef SUNFLECK_FOG_KERNELS_H
#define SUNFLECK_FOG_KERNELS_H

#include "base/isa_dispatch.h"
#include "trace/batch.h"

typedef struct sf_fog_kernels {
    /* Draws by coordinate[0] how far each ray goes in the fog. Where that is less than to its hit, the
     * fog is what it hit: the mesh table's row of the fog, with the normal against the ray. */
    void (*drift)(sf_batch *batch, const sf_scene *scene, uint32_t count);

    /* Dims the light that was sampled, along the shadow rays. */
    void (*dim)(sf_batch *batch, const sf_scene *scene, uint32_t count);
} sf_fog_kernels;
SF_KERNELS(sf_fog_kernels)

#endif
