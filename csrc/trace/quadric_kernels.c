// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Gives hits on spheres and disks their normals, and puts hit points back onto spheres. */
#include "trace/quadric_kernels.h"

#include <math.h>

#include "trace/rays.h"

static inline void face_sphere(sf_batch *b, const sf_quadric *quadric, uint32_t i) {
    float q[3], square = 0;
    for (int c = 0; c < 3; ++c) {
        q[c] = (b->origin[c][i] - quadric->centre[c]) + b->distance[i] * b->direction[c][i];
        square += q[c] * q[c];
    }
    float scale = square > 0 ? 1 / sqrtf(square) : 0.0f;
    for (int c = 0; c < 3; ++c) b->hit_normal[c][i] = q[c] * scale;
}

static void face(sf_batch *b, const sf_scene *scene, uint32_t count) {
    for (uint32_t i = 0; i < count; ++i) {
        const sf_quadric *quadric = scene->quadrics + b->mesh[i];
        if (quadric->kind == SF_QUADRIC_SPHERE)
            face_sphere(b, quadric, i);
        else if (quadric->kind == SF_QUADRIC_DISK)
            for (int c = 0; c < 3; ++c) b->hit_normal[c][i] = quadric->normal[c];
    }
}

/* The lift is a share of what the point was computed from, as elsewhere: here also the sphere's
 * middle and radius. */
static void settle(sf_batch *b, const sf_scene *scene, uint32_t count) {
    for (uint32_t i = 0; i < count; ++i) {
        const sf_quadric *quadric = scene->quadrics + b->mesh[i];
        if (quadric->kind != SF_QUADRIC_SPHERE) continue;
        const float *centre = quadric->centre;
        float lift =
            sf_lift_on_sphere(quadric, sf_lift(b->origin[0][i], b->origin[1][i], b->origin[2][i], b->distance[i]));
        for (int c = 0; c < 3; ++c)
            b->point[c][i] = (centre[c] + quadric->radius * b->hit_normal[c][i]) +
                             lift * (b->normal[c][i] - scene->back * b->direction[c][i]);
    }
}

const sf_quadric_kernels SF_AT_ISA(sf_quadric_kernels) = {face, settle};
