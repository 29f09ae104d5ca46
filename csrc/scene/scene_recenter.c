// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Scenes far from the origin are traced near it: 100,000 units away floats lie 2^-7 apart, and every
 * ray's origin and every vertex would be rounded to that. */

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "scene/scene_internal.h"

#define FAR 4 /* sizes of the scene from the origin, along an axis */

/* Moves along the axes on which the scene lies far: to the middle of its bounds. Of what lies at
 * least FAR sizes from 0 within one size the least and the greatest coordinates are within a factor
 * of 2, so that differences are exact (Sterbenz 1974, theorem 4.3.1). */
bool sf_scene_far_shift(const sf_scene_info *info, float shift[3]) {
    float extent = 0;
    bool far = false;
    for (int c = 0; c < 3; ++c) extent = fmaxf(extent, info->bounds_upper[c] - info->bounds_lower[c]);
    for (int c = 0; c < 3; ++c) {
        float low = info->bounds_lower[c], high = info->bounds_upper[c];
        bool off = fminf(fabsf(low), fabsf(high)) > FAR * extent && low * high > 0;
        shift[c] = off ? low + (high - low) / 2 : 0;
        far |= off;
    }
    return far;
}

sf_status sf_mesh_move(sf_scene_mesh *kept, const float shift[3], sf_scene_info *info, sf_error *error) {
    size_t count = 3 * kept->mesh.vertex_count, bytes = count * sizeof(float);
    if (!kept->vertex_copy) {
        kept->vertex_copy = malloc(bytes + 16); /* Embree reads up to 4 bytes past */
        if (!kept->vertex_copy) return sf_fail_memory(error, "a mesh moved to the origin", bytes);
        memcpy(kept->vertex_copy, kept->mesh.vertices, bytes);
        kept->mesh.vertices = kept->vertex_copy;
        info->copied_bytes += bytes;
    }
    for (size_t i = 0; i < count; ++i) kept->vertex_copy[i] -= shift[i % 3];
    return SF_STATUS_OK;
}

static sf_status move_mesh(sf_scene *scene, sf_scene_mesh *kept, RTCGeometry geometry, sf_error *error) {
    sf_status status = sf_mesh_move(kept, scene->shift, &scene->info, error);
    if (status) return status;
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, kept->vertex_copy, 0, 12,
                               kept->mesh.vertex_count);
    return SF_STATUS_OK;
}

static void move_quadric(const sf_scene *scene, sf_quadric *quadric, RTCGeometry geometry) {
    float *vertex = rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
    for (int c = 0; c < 3; ++c) vertex[c] = quadric->centre[c] -= scene->shift[c];
    rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
}

sf_status sf_scene_recenter(sf_scene *scene, sf_error *error) {
    if (!scene->moved_count && !sf_scene_far_shift(&scene->info, scene->shift)) return SF_STATUS_OK;
    for (size_t i = scene->moved_count; i < scene->info.mesh_count; ++i) {
        sf_scene_mesh *kept = scene->meshes + i;
        if (kept->place.placed) { /* by a transform, which instance_transform.c moves */
            scene->moved_count = i + 1;
            continue;
        }
        RTCGeometry geometry = rtcGetGeometry(scene->embree, (unsigned)i);
        if (kept->quadric.kind)
            move_quadric(scene, &kept->quadric, geometry);
        else {
            sf_status status = move_mesh(scene, kept, geometry, error);
            if (status) return status;
        }
        rtcCommitGeometry(geometry);
        scene->moved_count = i + 1;
    }
    return SF_STATUS_OK;
}
