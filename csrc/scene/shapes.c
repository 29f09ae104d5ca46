// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Spheres and disks, which Embree intersects as what they are. */

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "scene/scene_input.h"
#include "scene/scene_internal.h"
#include "scene/scene_mesh.h"

#define LEAST_RADIUS 1e-15f /* squares stay floats */

sf_sphere sf_sphere_default(void) {
    return (sf_sphere){.radius = 1, .albedo = {0.5f, 0.5f, 0.5f}, .material = sf_material_default()};
}
sf_disk sf_disk_default(void) {
    return (sf_disk){.normal = {0, 0, 1}, .radius = 1, .albedo = {0.5f, 0.5f, 0.5f}, .material = sf_material_default()};
}

/* Makes v as long as 1; refuses one without direction. */
static sf_status unit_vector(const char *what, const float v[3], float out[3], sf_error *error) {
    double square = 0;
    for (int c = 0; c < 3; ++c) square += (double)v[c] * v[c];
    if (!(square > 0)) return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s is (0, 0, 0), which is no direction", what);
    for (int c = 0; c < 3; ++c) out[c] = (float)((double)v[c] / sqrt(square));
    return SF_STATUS_OK;
}

static sf_status check_quadric(const char *what, const sf_quadric *quadric, const sf_mesh *surface, sf_error *error) {
    sf_status status = sf_scene_check_vector(what, quadric->centre, error);
    if (!status && !(quadric->radius >= LEAST_RADIUS && quadric->radius <= SF_LENGTH_LIMIT))
        status = sf_fail(error, SF_STATUS_INVALID_VALUE, "radius is %g; it must be in [%g, %g]",
                         (double)quadric->radius, (double)LEAST_RADIUS, (double)SF_LENGTH_LIMIT);
    if (!status) status = sf_scene_check_color("albedo", surface->albedo, 1, error);
    if (!status) status = sf_scene_check_color("emission", surface->emission, SF_RADIANCE_LIMIT, error);
    return status ? status : sf_material_check(&surface->material, error);
}

static sf_status attach_quadric(sf_scene *scene, const sf_quadric *quadric, uint32_t number, sf_error *error) {
    bool disk = quadric->kind == SF_QUADRIC_DISK;
    RTCGeometry geometry =
        rtcNewGeometry(scene->device, disk ? RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT : RTC_GEOMETRY_TYPE_SPHERE_POINT);
    float *vertex = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, 1);
    float *normal =
        disk ? rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3, 12, 1) : NULL;
    if (vertex && (normal || !disk)) {
        memcpy(vertex, quadric->centre, 12);
        vertex[3] = quadric->radius;
        if (disk) memcpy(normal, quadric->normal, 12);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene->embree, geometry, number);
    }
    rtcReleaseGeometry(geometry);
    int code = (int)rtcGetDeviceError(scene->device);
    if (code == RTC_ERROR_NONE) return SF_STATUS_OK;
    return sf_fail_embree(error, code, "refused shape %u", number);
}

/* Takes its bounds and values into the scene's. */
static void survey_quadric(sf_scene_info *info, const sf_quadric *quadric, const sf_mesh *surface) {
    for (int c = 0; c < 3; ++c) {
        double n = (double)quadric->normal[c], radius = (double)quadric->radius;
        double reach = quadric->kind == SF_QUADRIC_DISK ? radius * sqrt(fmax(1 - n * n, 0)) : radius;
        info->bounds_lower[c] = fminf(info->bounds_lower[c], (float)((double)quadric->centre[c] - reach));
        info->bounds_upper[c] = fmaxf(info->bounds_upper[c], (float)((double)quadric->centre[c] + reach));
    }
    info->hash = sf_scene_hash(info->hash, quadric, sizeof *quadric);
    info->hash = sf_scene_hash(info->hash, surface->albedo, sizeof surface->albedo);
    info->hash = sf_scene_hash(info->hash, surface->emission, sizeof surface->emission);
    info->hash = sf_material_hash(info->hash, &surface->material);
    ++*(quadric->kind == SF_QUADRIC_DISK ? &info->disk_count : &info->sphere_count);
}

static sf_status add_quadric(sf_scene *scene, const sf_quadric *quadric, const sf_mesh *surface, sf_error *error) {
    sf_status status = sf_scene_refuse_committed(scene, error);
    if (!status)
        status =
            check_quadric(quadric->kind == SF_QUADRIC_DISK ? "disk centre" : "sphere centre", quadric, surface, error);
    if (!status) status = sf_scene_reserve_mesh(scene, error);
    uint32_t number = (uint32_t)scene->info.mesh_count;
    if (!status) status = attach_quadric(scene, quadric, number, error);
    if (status) return status;
    scene->meshes[number] = (sf_scene_mesh){.mesh = *surface, .quadric = *quadric};
    survey_quadric(&scene->info, quadric, surface);
    ++scene->info.mesh_count;
    return SF_STATUS_OK;
}

/* A mesh without triangles, to hold what surfaces have. */
static sf_mesh surface_of(const float albedo[3], const float emission[3], const sf_material *material) {
    sf_mesh surface = sf_mesh_default();
    memcpy(surface.albedo, albedo, sizeof surface.albedo);
    memcpy(surface.emission, emission, sizeof surface.emission);
    surface.material = *material;
    return surface;
}

sf_status sf_scene_add_sphere(sf_scene *scene, const sf_sphere *sphere, sf_error *error) {
    sf_mesh surface = surface_of(sphere->albedo, sphere->emission, &sphere->material);
    sf_quadric quadric = {.radius = sphere->radius, .kind = SF_QUADRIC_SPHERE};
    memcpy(quadric.centre, sphere->centre, sizeof quadric.centre);
    return add_quadric(scene, &quadric, &surface, error);
}

sf_status sf_scene_add_disk(sf_scene *scene, const sf_disk *disk, sf_error *error) {
    sf_mesh surface = surface_of(disk->albedo, disk->emission, &disk->material);
    sf_quadric quadric = {.radius = disk->radius, .kind = SF_QUADRIC_DISK};
    memcpy(quadric.centre, disk->centre, sizeof quadric.centre);
    sf_status status = sf_scene_check_vector("disk normal", disk->normal, error);
    if (!status) status = unit_vector("disk normal", disk->normal, quadric.normal, error);
    return status ? status : add_quadric(scene, &quadric, &surface, error);
}
