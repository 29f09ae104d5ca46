// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Sums of what the camera rays' first hits tell, block by block of a batch. Lanes that miss, or
 * were not asked for, add 0. */
#ifndef SUNFLECK_AOV_KERNELS_H
#define SUNFLECK_AOV_KERNELS_H

#include "base/isa_dispatch.h"
#include "film/block.h"
#include "trace/batch.h"

typedef struct sf_aov_kernels {
    void (*albedo)(const sf_batch *batch, const sf_mesh_table *meshes, sf_hit_sums *out);

    /* Unit normals, on the side that the ray came from. A triangle without area has none: 0. */
    void (*normal)(const sf_batch *batch, const sf_mesh_table *meshes, sf_hit_sums *out);

    /* Distances along `forward`, and how many rays hit. */
    void (*depth)(const sf_batch *batch, const sf_mesh_table *meshes, const float forward[3], sf_hit_sums *out);
} sf_aov_kernels;
SF_KERNELS(sf_aov_kernels)

#endif
