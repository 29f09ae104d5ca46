// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Scatters rays in fog, and dims the light that comes through it. */
#include "trace/fog_kernels.h"

#include <math.h>

#include "sunfleck/elementary.h"
#include "trace/rays.h"

/* Distances of density extinction exp(-extinction s), by inversion: a surface at t is reached with
 * the probability exp(-extinction t), the transmittance, and so needs no weight. A ray that was not
 * traced has the distance -1, and its coordinate may be no number in [0, 1): it stays a miss. */
static void drift(sf_batch *b, const sf_scene *scene, uint32_t count) {
    float (*u)[SF_PATHS] = sf_sample_dimensions_by_ray(b, count, 1);
    float mean = 1 / (scene->fog.scattering + scene->fog.absorption);
    uint32_t fog = scene->mesh_table.miss + 1;
    for (uint32_t i = 0; i < sf_whole_packets(count); ++i) {
        float way = -sf_log1m(u[0][i]) * mean;
        bool scatters = (b->distance[i] > 0) & (way < b->distance[i]);
        b->distance[i] = scatters ? way : b->distance[i];
        b->mesh[i] = scatters ? fog : b->mesh[i];
        for (int c = 0; c < 3; ++c) b->hit_normal[c][i] = scatters ? -b->direction[c][i] : b->hit_normal[c][i];
    }
}

/* Beer & Lambert: exp(-extinction distance), 0 where that is below 2^-125. */
static void dim(sf_batch *b, const sf_scene *scene, uint32_t count) {
    float extinction = scene->fog.scattering + scene->fog.absorption;
    for (uint32_t i = 0; i < count; ++i) {
        float x = b->to_light[0][i], y = b->to_light[1][i], z = b->to_light[2][i];
        float depth = extinction * sqrtf(x * x + y * y + z * z);
        float left = depth < 86 ? sf_exp(-depth) : 0.0f;
        for (int c = 0; c < 3; ++c) b->contribution[c][i] *= left;
    }
}

const sf_fog_kernels SF_AT_ISA(sf_fog_kernels) = {drift, dim};
