// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Meshes on their way into a scene: checked, surveyed, copied where Embree cannot read them in place, and attached. */
#include "scene/scene_mesh.h"

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "scene/scene_input.h"

#define PAGE_SIZE 4096

sf_mesh sf_mesh_default(void) {
    sf_mesh mesh = {0};
    for (int c = 0; c < 3; ++c) mesh.albedo[c] = 0.5f;
    mesh.material = sf_material_default();
    return mesh;
}

sf_scene_info sf_scene_no_info(void) {
    return (sf_scene_info){.bounds_lower = {INFINITY, INFINITY, INFINITY},
                           .bounds_upper = {-INFINITY, -INFINITY, -INFINITY}};
}

void sf_scene_free_arrays(sf_scene_mesh *kept) {
    free(kept->vertex_copy);
    free(kept->index_copy);
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
