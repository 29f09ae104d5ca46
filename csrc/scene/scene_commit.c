// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Builds what rays and shading read from what a scene was given: tables, sky, lights, Embree's hierarchy, the plan. */
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/platform.h"
#include "scene/scene_input.h"
#include "scene/scene_internal.h"

static sf_status build_mesh_table(sf_scene *scene, sf_error *error) {
    sf_mesh_table *table = &scene->mesh_table;
    size_t rows = scene->info.mesh_count + 1 + sf_foggy(scene);
    table->miss = (uint32_t)scene->info.mesh_count;
    for (int c = 0; c < SF_MESH_COLUMNS; ++c) {
        float *column = table->columns[c] = sf_aligned_alloc(rows * sizeof *column);
        if (!column) return sf_fail_memory(error, "the table of meshes", rows * sizeof *column);
        memset(column, 0, rows * sizeof *column);
    }
    for (size_t i = 0; i < scene->info.mesh_count; ++i) {
        for (int c = 0; c < 3; ++c) {
            table->columns[SF_MESH_ALBEDO_R + c][i] = scene->meshes[i].mesh.albedo[c];
            table->columns[SF_MESH_EMISSION_R + c][i] = scene->meshes[i].mesh.emission[c];
        }
        sf_material_tabulate(table, i, &scene->meshes[i].mesh);
        table->columns[SF_MESH_LIFT][i] = SF_LIFT_OF_EDGES * scene->meshes[i].longest;
    }
    sf_instances_tabulate(scene, table);
    sf_fog_tabulate(scene, table);
    return SF_STATUS_OK;
}

static sf_status build_quadrics(sf_scene *scene, sf_error *error) {
    const sf_scene_info *info = &scene->info;
    if (info->sphere_count + info->disk_count == 0) return SF_STATUS_OK;
    size_t bytes = (info->mesh_count + 1 + sf_foggy(scene)) * sizeof *scene->quadrics;
    scene->quadrics = sf_aligned_alloc(bytes);
    if (!scene->quadrics) return sf_fail_memory(error, "the table of spheres and disks", bytes);
    memset(scene->quadrics, 0, bytes);
    for (size_t i = 0; i < info->mesh_count; ++i) scene->quadrics[i] = scene->meshes[i].quadric;
    return SF_STATUS_OK;
}

/* The power of two next to 1 / extent^2: exact, and the squares of normals stay floats. */
static float normal_scale(const sf_scene_info *info) {
    float extent = 0;
    for (int c = 0; c < 3; ++c) extent = fmaxf(extent, info->bounds_upper[c] - info->bounds_lower[c]);
    int exponent = 0;
    frexpf(extent, &exponent);
    return extent > 0 ? ldexpf(1, -2 * exponent) : 1;
}

/* Up to so many primitives surface rays are sorted, and their packets traced as coherent. Up to 60 triangles whole
 * renders take 0.73 to 0.92 of the time so; with 66 to 140, 0.88 to 1.06; from 300 on up to 1.7 where they are of
 * like size, as large triangles that most rays meet cost the least (bench/render_sort_threshold.py). In
 * fog it does not pay. */
#define FEW 64

static void set_packing(sf_scene *scene) {
    const sf_scene_info *info = &scene->info;
    scene->few = info->triangle_count + info->sphere_count + info->disk_count <= FEW && !sf_has_instances(scene) &&
                 !sf_foggy(scene);
    for (int c = 0; c < 3; ++c)
        scene->middle[c] = info->bounds_lower[c] / 2 + info->bounds_upper[c] / 2 - scene->shift[c];
}

/* Frees what a failed commit left. */
static void drop_tables(sf_scene *scene) {
    for (int c = 0; c < SF_MESH_COLUMNS; ++c) {
        sf_aligned_free(scene->mesh_table.columns[c]);
        scene->mesh_table.columns[c] = NULL;
    }
    sf_lights_free(&scene->lights);
    sf_sky_free(&scene->sky);
    sf_aligned_free(scene->quadrics);
    scene->quadrics = NULL;
    sf_aligned_free(scene->turns);
    scene->turns = NULL;
}

/* What decides the picture beside the shapes; a scene without the later ones keeps its hash. */
static uint64_t hash_settings(const sf_scene *scene) {
    uint64_t hash = scene->info.hash;
    hash = sf_scene_hash(hash, &scene->camera, sizeof scene->camera);
    hash = sf_scene_hash(hash, scene->background, sizeof scene->background);
    hash = sf_hash64(hash, scene->max_bounces);
    if (scene->light_sampling) hash = sf_hash64(hash, (uint64_t)scene->light_sampling);
    if (scene->light_choice) hash = sf_hash64(hash, UINT64_C(0x63686f696365) + scene->light_choice); /* as above */
    if (scene->solid_angle_ratio != 1) hash = sf_scene_hash(hash, &scene->solid_angle_ratio, sizeof(float));
    if (scene->info.sun_count) hash = sf_scene_hash(hash, scene->suns, scene->info.sun_count * sizeof *scene->suns);
    if (scene->robust) hash = sf_hash64(hash, UINT64_C(0x726f62757374)); /* no way of light_sampling */
    if (sf_foggy(scene)) hash = sf_scene_hash(hash, &scene->fog, sizeof scene->fog);
    const sf_environment *e = &scene->environment;
    if (!e->pixels) return hash;
    hash = sf_scene_hash(hash, e->pixels, (size_t)e->width * e->height * 12);
    hash = sf_hash64(hash, (uint64_t)e->width << 32 | e->height);
    hash = sf_scene_hash(hash, e->up, sizeof e->up);
    return sf_scene_hash(hash, &e->rotation, sizeof e->rotation);
}

sf_status sf_scene_commit(sf_scene *scene, sf_error *error) {
    sf_status status = sf_scene_refuse_committed(scene, error);
    if (status) return status;
    if (scene->info.mesh_count == 0)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "the scene has no mesh, sphere or disk; add at least one");
    status = sf_fog_check(scene, error);
    if (status) return status;
    drop_tables(scene);
    scene->back = scene->robust ? 1.0f : 0.0f;
    if (scene->robust) rtcSetSceneFlags(scene->embree, RTC_SCENE_FLAG_ROBUST);
    status = sf_scene_recenter(scene, error);
    if (!status) status = build_mesh_table(scene, error);
    if (!status) status = build_quadrics(scene, error);
    if (!status) status = sf_sky_build(scene, error);
    if (!status) status = sf_lights_build(scene, error);
    scene->normal_scale = normal_scale(&scene->info);
    set_packing(scene);
    if (!status) status = sf_instances_build(scene, error);
    if (status) return status;
    rtcCommitScene(scene->embree);
    int code = (int)rtcGetDeviceError(scene->device);
    if (code != RTC_ERROR_NONE)
        return sf_fail_embree(error, code, "could not build the hierarchy over %zu triangles",
                              scene->info.triangle_count);
    sf_scene_info *info = &scene->info;
    info->light_count = scene->lights.count;
    info->rectangle_light_count = scene->lights.rectangle_count;
    info->hash = hash_settings(scene);
    sf_plan_derive(scene, &scene->plan);
    scene->committed = true;
    return SF_STATUS_OK;
}
