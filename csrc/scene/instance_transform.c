// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What placements mean to rays: Embree's instances, normals, how far hits are moved off. */

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/platform.h"
#include "scene/scene_internal.h"

double sf_cofactors(const float m[9], double out[9]) {
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
            int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
            out[3 * r + c] =
                (double)m[3 * r1 + c1] * (double)m[3 * r2 + c2] - (double)m[3 * r1 + c2] * (double)m[3 * r2 + c1];
        }
    return (double)m[0] * out[0] + (double)m[1] * out[1] + (double)m[2] * out[2];
}

double sf_condition(const float m[9]) {
    double cofactors[9], determinant = sf_cofactors(m, cofactors), own = 0, inverse = 0;
    for (int i = 0; i < 9; ++i) {
        own += (double)m[i] * (double)m[i];
        inverse += cofactors[i] * cofactors[i];
    }
    return determinant == 0 ? (double)INFINITY : sqrt(own) * sqrt(inverse) / fabs(determinant);
}

void sf_instance_vertex(const sf_scene *scene, const sf_scene_mesh *shape, const float *v, double out[3]) {
    for (int r = 0; r < 3; ++r) {
        const float *row = shape->place.linear + 3 * r;
        out[r] = (double)v[r];
        if (!shape->place.placed) continue;
        out[r] = shape->place.translation[r] - (double)scene->shift[r] + (double)row[0] * (double)v[0] +
                 (double)row[1] * (double)v[1] + (double)row[2] * (double)v[2];
    }
}

/* Arvo 1990, "Transforming Axis-Aligned Bounding Boxes". */
void sf_instance_box(const sf_instance_transform *place, const float lower[3], const float upper[3], double low[3],
                     double high[3]) {
    for (int r = 0; r < 3; ++r) {
        low[r] = high[r] = place->translation[r];
        for (int c = 0; c < 3; ++c) {
            double a = (double)place->linear[3 * r + c] * (double)lower[c];
            double b = (double)place->linear[3 * r + c] * (double)upper[c];
            low[r] += fmin(a, b);
            high[r] += fmax(a, b);
        }
    }
}

/* Gives Embree's instance its transform, from the moved prototype to the moved scene. */
static void give_transform(const sf_scene *scene, const sf_instance_transform *place, unsigned number) {
    RTCGeometry geometry = rtcGetGeometry(scene->embree, number);
    float rows[12];
    for (int r = 0; r < 3; ++r) {
        memcpy(rows + 4 * r, place->linear + 3 * r, 12);
        rows[4 * r + 3] = (float)(place->translation[r] - (double)scene->shift[r]);
    }
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, rows);
    rtcCommitGeometry(geometry);
}

/* Normals go by the inverse transposed, which is the cofactors over the determinant. Without its size they
 * have the length that the triangle's cross product has in the scene; its sign keeps the side. */
static void turn_of(const sf_scene *scene, const sf_instance_transform *place, float turn[9]) {
    double cofactors[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, sign = 1;
    if (place->placed) sign = sf_cofactors(place->linear, cofactors) < 0 ? -1 : 1;
    for (int i = 0; i < 9; ++i) turn[i] = (float)(sign * cofactors[i] * (double)scene->normal_scale);
}

sf_status sf_instances_build(sf_scene *scene, sf_error *error) {
    if (!sf_has_instances(scene)) return SF_STATUS_OK;
    size_t rows = scene->info.mesh_count + 1 + sf_foggy(scene);
    scene->turns = sf_aligned_alloc(rows * sizeof *scene->turns);
    if (!scene->turns) return sf_fail_memory(error, "the normals of instances", rows * sizeof *scene->turns);
    for (size_t i = 0; i < rows; ++i)
        turn_of(scene, i < scene->info.mesh_count ? &scene->meshes[i].place : &(sf_instance_transform){0},
                scene->turns[i]);
    for (size_t i = 0; i < scene->prototype_count; ++i) {
        RTCScene embree = scene->prototypes[i].embree;
        if (!embree) continue;
        if (scene->robust) rtcSetSceneFlags(embree, RTC_SCENE_FLAG_ROBUST);
        rtcCommitScene(embree);
    }
    for (size_t i = 0; i < scene->info.mesh_count; ++i) {
        const sf_instance_transform *place = &scene->meshes[i].place;
        if (place->placed && place->member == 0) give_transform(scene, place, (unsigned)i);
    }
    int code = (int)rtcGetDeviceError(scene->device);
    if (code == RTC_ERROR_NONE) return SF_STATUS_OK;
    return sf_fail_embree(error, code, "could not build the instances");
}

/* ---- how far hits are moved off ---- */

/* The largest coordinate of the scene, as it is traced, and of its camera. */
static double reach_of_scene(const sf_scene *scene) {
    double reach = 0;
    for (int c = 0; c < 3; ++c) {
        double shift = (double)scene->shift[c];
        reach = fmax(reach, fabs((double)scene->info.bounds_lower[c] - shift));
        reach = fmax(reach, fabs((double)scene->info.bounds_upper[c] - shift));
        reach = fmax(reach, fabs((double)scene->camera.position[c] - shift));
    }
    return reach;
}

/* Embree takes rays to the prototype by the inverse in single precision. Back in the scene its rounding is
 * some 2^-23 of what was subtracted there (the ray's origin, the translation, the vertices), times the
 * condition number. Four times that of the placement's own coordinates is the least; measured on ellipsoids
 * squashed up to 10^4-fold, twice is too little. The ray's own coordinates are in the lift of every hit
 * (rays.h), but for transforms that stretch much more along one axis than along another. */
static double lift_of(const sf_scene *scene, const sf_scene_mesh *row, double reach_of_all) {
    const sf_instance_transform *place = &row->place;
    const sf_prototype *p = scene->prototypes + place->prototype;
    double condition = sf_condition(place->linear), reach = 0, stretch = 0;
    for (int r = 0; r < 3; ++r) {
        double sum = 0, own = fabs(place->translation[r] - (double)scene->shift[r]);
        for (int c = 0; c < 3; ++c) {
            double low = (double)p->dark.bounds_lower[c] - (double)p->offset[c];
            double high = (double)p->dark.bounds_upper[c] - (double)p->offset[c];
            sum += fabs((double)place->linear[3 * r + c]);
            own += fabs((double)place->linear[3 * r + c]) * fmax(fabs(low), fabs(high));
        }
        stretch = fmax(stretch, sum);
        reach = fmax(reach, own);
    }
    double far = condition > 6 ? reach_of_all : 0;
    return (double)SF_LIFT_OF_EDGES * stretch * (double)row->longest + 0x1p-21 * condition * (reach + far);
}

void sf_instances_tabulate(const sf_scene *scene, sf_mesh_table *table) {
    if (!sf_has_instances(scene)) return;
    double reach = reach_of_scene(scene);
    for (size_t i = 0; i < scene->info.mesh_count; ++i)
        if (scene->meshes[i].place.placed)
            table->columns[SF_MESH_LIFT][i] = (float)lift_of(scene, scene->meshes + i, reach);
}
