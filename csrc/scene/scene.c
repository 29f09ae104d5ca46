// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "sunfleck/scene.h"

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/platform.h"
#include "scene/scene_internal.h"

#define PAGE_SIZE 4096

sf_mesh sf_mesh_default(void) {
    sf_mesh mesh = {0};
    for (int c = 0; c < 3; ++c) mesh.albedo[c] = 0.5f;
    mesh.material = sf_material_default();
    return mesh;
}

sf_camera sf_camera_default(void) { return (sf_camera){.position = {0, 0, 1}, .up = {0, 1, 0}, .vertical_fov = 40}; }

sf_scene_info sf_scene_no_info(void) {
    return (sf_scene_info){.bounds_lower = {INFINITY, INFINITY, INFINITY},
                           .bounds_upper = {-INFINITY, -INFINITY, -INFINITY}};
}

sf_status sf_scene_create(sf_scene **out, sf_error *error) {
    *out = NULL;
    sf_scene *scene = calloc(1, sizeof *scene);
    if (!scene) return sf_fail_memory(error, "a scene", sizeof *scene);
    scene->camera = sf_camera_default();
    scene->max_bounces = 5;
    scene->solid_angle_ratio = 1;
    scene->info = sf_scene_no_info();
    scene->device = rtcNewDevice(NULL);
    if (scene->device) scene->embree = rtcNewScene(scene->device);
    if (!scene->embree) {
        int code = (int)rtcGetDeviceError(scene->device);
        sf_scene_destroy(scene);
        return sf_fail_embree(error, code, "gave no device or scene");
    }
    *out = scene;
    return SF_STATUS_OK;
}

void sf_scene_free_arrays(sf_scene_mesh *kept) {
    free(kept->vertex_copy);
    free(kept->index_copy);
}

void sf_scene_destroy(sf_scene *scene) {
    if (!scene) return;
    if (scene->embree) rtcReleaseScene(scene->embree);
    sf_instances_free(scene);
    if (scene->device) rtcReleaseDevice(scene->device);
    for (size_t i = 0; i < scene->info.mesh_count; ++i) sf_scene_free_arrays(scene->meshes + i);
    free(scene->meshes);
    for (int c = 0; c < SF_MESH_COLUMNS; ++c) sf_aligned_free(scene->mesh_table.columns[c]);
    sf_lights_free(&scene->lights);
    sf_sky_free(&scene->sky);
    sf_aligned_free(scene->quadrics);
    sf_aligned_free(scene->turns);
    free(scene->suns);
    free(scene);
}

sf_status sf_scene_refuse_committed(const sf_scene *scene, sf_error *error) {
    if (!scene->committed) return SF_STATUS_OK;
    return sf_fail(error, SF_STATUS_INVALID_VALUE, "the scene is committed; it can't be changed any more");
}

/* Refuses a value that is not in [0, upper]; NaN is in no interval. */
sf_status sf_scene_check_color(const char *what, const float *color, float upper, sf_error *error) {
    for (int c = 0; c < 3; ++c)
        if (!(color[c] >= 0 && color[c] <= upper))
            return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s[%d] is %g; it must be in [0, %g]", what, c,
                           (double)color[c], (double)upper);
    return SF_STATUS_OK;
}

sf_status sf_scene_check_vector(const char *what, const float *v, sf_error *error) {
    for (int c = 0; c < 3; ++c)
        if (!(fabsf(v[c]) <= SF_LENGTH_LIMIT))
            return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s[%d] is %g; it must be finite and at most %g in size",
                           what, c, (double)v[c], (double)SF_LENGTH_LIMIT);
    return SF_STATUS_OK;
}

/* One pass over the arrays: every vertex finite, every index in range. */
static sf_status check_mesh(const sf_mesh *mesh, size_t number, sf_error *error) {
    if (!mesh->vertices || mesh->vertex_count < 3 || mesh->vertex_count > UINT32_MAX)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "mesh %zu has %zu vertices; it must have 3 to 2^32 - 1", number,
                       mesh->vertices ? mesh->vertex_count : 0);
    if (!mesh->triangles || mesh->triangle_count < 1 || mesh->triangle_count > UINT32_MAX)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "mesh %zu has %zu triangles; it must have 1 to 2^32 - 1", number,
                       mesh->triangles ? mesh->triangle_count : 0);
    for (size_t i = 0; i < 3 * mesh->vertex_count; ++i)
        if (!(fabsf(mesh->vertices[i]) <= SF_LENGTH_LIMIT))
            return sf_fail(error, SF_STATUS_INVALID_VALUE,
                           "mesh %zu: coordinate %zu of vertex %zu is %g; it must be finite and at most %g in size",
                           number, i % 3, i / 3, (double)mesh->vertices[i], (double)SF_LENGTH_LIMIT);
    for (size_t i = 0; i < 3 * mesh->triangle_count; ++i)
        if (mesh->triangles[i] >= mesh->vertex_count)
            return sf_fail(error, SF_STATUS_INVALID_VALUE,
                           "mesh %zu: triangle %zu has vertex index %u; the mesh has %zu vertices", number, i / 3,
                           mesh->triangles[i], mesh->vertex_count);
    sf_status status = sf_scene_check_color("albedo", mesh->albedo, 1, error);
    if (!status) status = sf_scene_check_color("emission", mesh->emission, SF_RADIANCE_LIMIT, error);
    return status ? status : sf_material_check(&mesh->material, error);
}

/* Embree loads the last vertex and the last index triple with 16-byte reads: up to 4 bytes past
 * the array. They are harmless on the array's own page, and only there. */
static bool can_read_past(const void *array, size_t bytes) { return ((uintptr_t)array + bytes) % PAGE_SIZE != 0; }

static sf_status copy_padded(const void **array, void **copy, size_t bytes, sf_scene_info *info, sf_error *error) {
    *copy = malloc(bytes + 16);
    if (!*copy) return sf_fail_memory(error, "a padded copy of a mesh array", bytes);
    memcpy(*copy, *array, bytes);
    *array = *copy;
    info->copied_bytes += bytes;
    return SF_STATUS_OK;
}

uint64_t sf_scene_hash(uint64_t hash, const void *bytes, size_t count) {
    const unsigned char *p = bytes;
    uint64_t word;
    hash = sf_hash64(hash, count);
    for (; count >= 8; count -= 8, p += 8) {
        memcpy(&word, p, 8);
        hash = sf_mix64(hash ^ word) + UINT64_C(0x9e3779b97f4a7c15);
    }
    word = 0;
    memcpy(&word, p, count);
    return sf_hash64(hash, word);
}

static float longest_edge(const sf_mesh *mesh) {
    float longest = 0;
    for (size_t i = 0; i < mesh->triangle_count; ++i) {
        const uint32_t *t = mesh->triangles + 3 * i;
        for (int c = 0; c < 3; ++c) {
            float x = mesh->vertices[3 * (size_t)t[0] + (size_t)c], y = mesh->vertices[3 * (size_t)t[1] + (size_t)c];
            float z = mesh->vertices[3 * (size_t)t[2] + (size_t)c];
            longest = fmaxf(longest, fmaxf(fmaxf(x, y), z) - fminf(fminf(x, y), z));
        }
    }
    return longest;
}

/* Takes bounds, hash and counts of a checked mesh into the scene's; returns how many of its triangles have no area. */
static size_t take_values(sf_scene_info *info, const sf_mesh *mesh) {
    for (size_t i = 0; i < 3 * mesh->vertex_count; ++i) {
        float v = mesh->vertices[i];
        if (v < info->bounds_lower[i % 3]) info->bounds_lower[i % 3] = v;
        if (v > info->bounds_upper[i % 3]) info->bounds_upper[i % 3] = v;
    }
    size_t degenerate = 0;
    for (size_t i = 0; i < mesh->triangle_count; ++i) {
        const uint32_t *t = mesh->triangles + 3 * i;
        double n[3];
        sf_triangle_cross(mesh->vertices + 3 * (size_t)t[0], mesh->vertices + 3 * (size_t)t[1],
                          mesh->vertices + 3 * (size_t)t[2], n);
        degenerate += n[0] * n[0] + n[1] * n[1] + n[2] * n[2] == 0;
    }
    info->hash = sf_scene_hash(info->hash, mesh->vertices, 12 * mesh->vertex_count);
    info->hash = sf_scene_hash(info->hash, mesh->triangles, 12 * mesh->triangle_count);
    info->hash = sf_scene_hash(info->hash, mesh->albedo, sizeof mesh->albedo);
    info->hash = sf_scene_hash(info->hash, mesh->emission, sizeof mesh->emission);
    info->hash = sf_material_hash(info->hash, &mesh->material);
    info->triangle_count += mesh->triangle_count;
    info->unique_triangle_count += mesh->triangle_count;
    info->degenerate_count += degenerate;
    return degenerate;
}

sf_status sf_scene_survey_mesh(sf_scene_info *info, const sf_mesh *mesh, size_t number, sf_error *error) {
    sf_status status = check_mesh(mesh, number, error);
    if (status) return status;
    size_t degenerate = take_values(info, mesh);
    if (!sf_emits(mesh) || degenerate < mesh->triangle_count) return SF_STATUS_OK;
    return sf_fail(error, SF_STATUS_INVALID_VALUE,
                   "mesh %zu emits light but all of its %zu triangles have area 0; a light needs an area", number,
                   mesh->triangle_count);
}

sf_status sf_scene_keep_arrays(sf_scene_mesh *kept, sf_scene_info *info, sf_error *error) {
    sf_mesh *mesh = &kept->mesh;
    size_t vertex_bytes = 12 * mesh->vertex_count, index_bytes = 12 * mesh->triangle_count;
    sf_status status = SF_STATUS_OK;
    kept->longest = longest_edge(mesh);
    if (!kept->vertex_copy && !can_read_past(mesh->vertices, vertex_bytes))
        status = copy_padded((const void **)&mesh->vertices, (void **)&kept->vertex_copy, vertex_bytes, info, error);
    if (!status && !kept->index_copy && !can_read_past(mesh->triangles, index_bytes))
        status = copy_padded((const void **)&mesh->triangles, (void **)&kept->index_copy, index_bytes, info, error);
    return status;
}

sf_status sf_scene_attach_mesh(RTCDevice device, RTCScene embree, const sf_mesh *mesh, uint32_t number,
                               sf_error *error) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh->vertices, 0, 12,
                               mesh->vertex_count);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh->triangles, 0, 12,
                               mesh->triangle_count);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(embree, geometry, number);
    rtcReleaseGeometry(geometry);
    int code = (int)rtcGetDeviceError(device);
    if (code == RTC_ERROR_NONE) return SF_STATUS_OK;
    return sf_fail_embree(error, code, "refused mesh %u of %zu triangles", number, mesh->triangle_count);
}

void *sf_scene_grow(void *list, size_t *capacity, size_t count, size_t bytes, const char *what, sf_error *error) {
    if (count < *capacity) return list;
    size_t larger = *capacity ? 2 * *capacity : 8;
    void *grown = realloc(list, larger * bytes);
    if (grown)
        *capacity = larger;
    else
        (void)sf_fail_memory(error, what, larger * bytes);
    return grown;
}

sf_status sf_scene_reserve_mesh(sf_scene *scene, sf_error *error) {
    sf_scene_mesh *meshes = sf_scene_grow(scene->meshes, &scene->mesh_capacity, scene->info.mesh_count, sizeof *meshes,
                                          "the list of meshes", error);
    if (!meshes) return SF_STATUS_OUT_OF_MEMORY;
    scene->meshes = meshes;
    return SF_STATUS_OK;
}

sf_status sf_scene_take_mesh(sf_scene *scene, sf_scene_mesh *kept, sf_error *error) {
    size_t number = scene->info.mesh_count;
    sf_scene_info info = scene->info; /* kept only when all went well */
    sf_status status = sf_scene_survey_mesh(&info, &kept->mesh, number, error);
    if (!status) status = sf_scene_reserve_mesh(scene, error);
    if (!status) status = sf_scene_keep_arrays(kept, &info, error);
    if (!status) status = sf_scene_attach_mesh(scene->device, scene->embree, &kept->mesh, (uint32_t)number, error);
    if (status) {
        sf_scene_free_arrays(kept);
        return status;
    }
    scene->meshes[number] = *kept;
    scene->info = info;
    scene->info.mesh_count = number + 1;
    return SF_STATUS_OK;
}

sf_status sf_scene_add_mesh(sf_scene *scene, const sf_mesh *mesh, sf_error *error) {
    sf_scene_mesh kept = {.mesh = *mesh};
    sf_status status = sf_scene_refuse_committed(scene, error);
    return status ? status : sf_scene_take_mesh(scene, &kept, error);
}

sf_status sf_scene_set_camera(sf_scene *scene, const sf_camera *camera, sf_error *error) {
    sf_status status = sf_scene_refuse_committed(scene, error);
    if (!status) status = sf_scene_check_vector("camera position", camera->position, error);
    if (!status) status = sf_scene_check_vector("camera target", camera->target, error);
    if (!status) status = sf_scene_check_vector("camera up", camera->up, error);
    if (status) return status;
    if (!(camera->vertical_fov > 0 && camera->vertical_fov < 180))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "vertical_fov is %g; it must be in (0, 180) degrees",
                       (double)camera->vertical_fov);
    if (!(camera->aperture_radius >= 0 && camera->aperture_radius <= SF_LENGTH_LIMIT))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "aperture_radius is %g; it must be in [0, %g]",
                       (double)camera->aperture_radius, (double)SF_LENGTH_LIMIT);
    if (!(camera->focus_distance >= 0 && camera->focus_distance <= SF_LENGTH_LIMIT))
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "focus_distance is %g; it must be in (0, %g], or 0 for the target's",
                       (double)camera->focus_distance, (double)SF_LENGTH_LIMIT);
    double f[3], f2 = 0, up2 = 0, cross2 = 0;
    for (int c = 0; c < 3; ++c) {
        f[c] = (double)camera->target[c] - camera->position[c];
        f2 += f[c] * f[c];
        up2 += (double)camera->up[c] * camera->up[c];
    }
    if (f2 == 0)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "the camera looks at itself: position and target are both (%g, %g, %g)",
                       (double)camera->position[0], (double)camera->position[1], (double)camera->position[2]);
    for (int c = 0; c < 3; ++c) {
        int d = (c + 1) % 3, e = (c + 2) % 3;
        double x = f[d] * camera->up[e] - f[e] * camera->up[d];
        cross2 += x * x;
    }
    if (!(cross2 > 1e-12 * f2 * up2))
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "camera up (%g, %g, %g) is zero or along the line of sight; choose another direction",
                       (double)camera->up[0], (double)camera->up[1], (double)camera->up[2]);
    scene->camera = *camera;
    return SF_STATUS_OK;
}

sf_status sf_scene_set_background(sf_scene *scene, const float radiance[3], sf_error *error) {
    sf_status status = sf_scene_refuse_committed(scene, error);
    if (!status) status = sf_scene_check_color("background", radiance, SF_RADIANCE_LIMIT, error);
    if (!status) memcpy(scene->background, radiance, sizeof scene->background);
    return status;
}

sf_status sf_scene_set_light_sampling(sf_scene *scene, sf_light_sampling sampling, sf_error *error) {
    sf_status status = sf_scene_refuse_committed(scene, error);
    if (status) return status;
    if (!sf_light_sampling_name(sampling))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "light_sampling is %d; it must be one of the enumeration's",
                       (int)sampling);
    scene->light_sampling = sampling;
    return SF_STATUS_OK;
}

sf_status sf_scene_set_solid_angle_ratio(sf_scene *scene, float ratio, sf_error *error) {
    sf_status status = sf_scene_refuse_committed(scene, error);
    if (status) return status;
    if (!(ratio >= 0))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "solid_angle_ratio is %g; it must be 0 or more", (double)ratio);
    scene->solid_angle_ratio = ratio;
    return SF_STATUS_OK;
}

sf_status sf_scene_set_robust(sf_scene *scene, int robust, sf_error *error) {
    sf_status status = sf_scene_refuse_committed(scene, error);
    if (!status) scene->robust = robust != 0;
    return status;
}

sf_status sf_scene_set_max_bounces(sf_scene *scene, uint32_t max_bounces, sf_error *error) {
    sf_status status = sf_scene_refuse_committed(scene, error);
    if (status) return status;
    if (max_bounces > SF_MAX_BOUNCES)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "max_bounces is %u; it must be 0 to %d", max_bounces,
                       SF_MAX_BOUNCES);
    scene->max_bounces = max_bounces;
    return SF_STATUS_OK;
}

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

static sf_status build_rounds(sf_scene *scene, sf_error *error) {
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
 * like size, as large triangles that most rays meet cost the least (bench/render_sort_threshold.py). In fog it does not pay. */
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
    if (!status) status = build_rounds(scene, error);
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

static sf_status require_committed(const sf_scene *scene, sf_error *error) {
    if (scene->committed) return SF_STATUS_OK;
    return sf_fail(error, SF_STATUS_INVALID_VALUE, "the scene is not committed; call sf_scene_commit first");
}

sf_status sf_scene_get_info(const sf_scene *scene, sf_scene_info *info, sf_error *error) {
    sf_status status = require_committed(scene, error);
    if (!status) {
        *info = scene->info;
        /* Spheres, disks and what is placed have numbers among the meshes. */
        info->mesh_count -= info->sphere_count + info->disk_count + scene->placed_count;
        info->mesh_count += scene->prototype_mesh_count;
    }
    return status;
}

sf_status sf_scene_get_plan(const sf_scene *scene, sf_plan *plan, sf_error *error) {
    sf_status status = require_committed(scene, error);
    if (!status) *plan = scene->plan;
    return status;
}
