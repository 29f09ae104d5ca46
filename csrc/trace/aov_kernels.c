// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Sums what the camera rays' first hits tell over each block of a batch. */
#include "trace/aov_kernels.h"

#include <math.h>

#include "trace/lanes.h"

static void albedo(const sf_batch *b, const sf_mesh_table *meshes, sf_hit_sums *out) {
    SF_ALIGNED(double) value[SF_LANES];
    for (uint32_t block = 0; block < b->block_count; ++block)
        for (int c = 0; c < 3; ++c) {
            const float *column = meshes->columns[SF_MESH_ALBEDO_R + c];
            const uint32_t *mesh = b->mesh + block * b->width;
            SF_ROLLED
            for (int l = 0; l < SF_LANES; ++l)
                value[l] = l < (int)b->width ? (double)column[mesh[l]] : 0; /* 0 in the row of a miss */
            out[block].albedo[c] = sf_sum16(value);
        }
}

static void normal(const sf_batch *b, const sf_mesh_table *meshes, sf_hit_sums *out) {
    SF_ALIGNED(double) value[3][SF_LANES];
    for (uint32_t block = 0; block < b->block_count; ++block) {
        uint32_t first = block * b->width;
        SF_ROLLED
        for (uint32_t l = 0; l < SF_LANES; ++l) {
            uint32_t i = first + l;
            double x = (double)b->hit_normal[0][i], y = (double)b->hit_normal[1][i], z = (double)b->hit_normal[2][i];
            double along =
                (double)b->direction[0][i] * x + (double)b->direction[1][i] * y + (double)b->direction[2][i] * z;
            double square = x * x + y * y + z * z, inverse = 1 / sqrt(square);
            double scale = along > 0 ? -inverse : inverse;
            /* NaN and infinity fail the comparison as 0 does. */
            bool known = (l < b->width) & (b->mesh[i] != meshes->miss) & (square > 0) & (square <= 1e300);
            value[0][l] = known ? x * scale : 0;
            value[1][l] = known ? y * scale : 0;
            value[2][l] = known ? z * scale : 0;
        }
        for (int c = 0; c < 3; ++c) out[block].normal[c] = sf_sum16(value[c]);
    }
}

static void depth(const sf_batch *b, const sf_mesh_table *meshes, const float forward[3], sf_hit_sums *out) {
    SF_ALIGNED(double) value[SF_LANES], hits[SF_LANES];
    double x = (double)forward[0], y = (double)forward[1], z = (double)forward[2];
    for (uint32_t block = 0; block < b->block_count; ++block) {
        uint32_t first = block * b->width;
        SF_ROLLED
        for (uint32_t l = 0; l < SF_LANES; ++l) {
            uint32_t i = first + l;
            double along =
                (double)b->direction[0][i] * x + (double)b->direction[1][i] * y + (double)b->direction[2][i] * z;
            bool hit = (l < b->width) & (b->mesh[i] != meshes->miss) & (b->distance[i] < INFINITY);
            value[l] = hit ? (double)b->distance[i] * along : 0;
            hits[l] = hit ? 1 : 0;
        }
        out[block].depth = sf_sum16(value);
        out[block].hits = sf_sum16(hits);
    }
}

const sf_aov_kernels SF_AT_ISA(sf_aov_kernels) = {albedo, normal, depth};
