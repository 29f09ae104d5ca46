// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Prototypes, and their placements as rows among the scene's meshes. A placement has one row for each
 * mesh of its prototype that does not emit, in a run, and Embree's instance has the number of the
 * first: a hit's row is instance + mesh. Those that emit become meshes of the scene. */

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "scene/scene_input.h"
#include "scene/scene_internal.h"
#include "scene/scene_mesh.h"

#define CONDITION_LIMIT 3e5 /* Embree inverts transforms in single precision */
#define LEAST_DETERMINANT 1e-36
#define ROW_LIMIT 0x7fffffff

static void free_prototype(sf_prototype *prototype) {
    for (uint32_t i = 0; i < prototype->mesh_count; ++i) sf_scene_free_arrays(prototype->meshes + i);
    free(prototype->meshes);
    if (prototype->embree) rtcReleaseScene(prototype->embree);
}

void sf_instances_free(sf_scene *scene) {
    for (size_t i = 0; i < scene->prototype_count; ++i) free_prototype(scene->prototypes + i);
    free(scene->prototypes);
}

/* ---- prototypes ---- */

/* Takes the meshes over, the dark ones first. */
static sf_status take_meshes(sf_prototype *p, const sf_mesh *meshes, size_t count, sf_error *error) {
    p->meshes = calloc(count, sizeof *p->meshes);
    if (!p->meshes) return sf_fail_memory(error, "the meshes of a prototype", count * sizeof *p->meshes);
    for (int lit = 0; lit < 2; ++lit) {
        for (size_t i = 0; i < count; ++i) {
            if (sf_emits(meshes + i) != (lit == 1)) continue;
            sf_scene_mesh *kept = p->meshes + p->mesh_count++;
            *kept = (sf_scene_mesh){.mesh = meshes[i]};
            sf_status status = sf_scene_survey_mesh(lit ? &p->lit : &p->dark, meshes + i, i, error);
            if (!status) status = sf_scene_keep_arrays(kept, &p->dark, error);
            if (status) return status;
        }
        if (!lit) p->dark_count = p->mesh_count;
    }
    return SF_STATUS_OK;
}

static sf_status attach_meshes(const sf_scene *scene, sf_prototype *p, sf_error *error) {
    p->embree = rtcNewScene(scene->device);
    if (!p->embree) return sf_fail_embree(error, (int)rtcGetDeviceError(scene->device), "gave no scene for instances");
    bool far = sf_scene_far_shift(&p->dark, p->offset);
    for (uint32_t i = 0; i < p->dark_count; ++i) {
        sf_status status = far ? sf_mesh_move(p->meshes + i, p->offset, &p->dark, error) : SF_STATUS_OK;
        if (!status) status = sf_scene_attach_mesh(scene->device, p->embree, &p->meshes[i].mesh, i, error);
        if (status) return status;
    }
    return SF_STATUS_OK;
}

static sf_status reserve_prototype(sf_scene *scene, sf_error *error) {
    sf_prototype *prototypes = sf_scene_grow(scene->prototypes, &scene->prototype_capacity, scene->prototype_count,
                                             sizeof *prototypes, "the list of prototypes", error);
    if (!prototypes) return SF_STATUS_OUT_OF_MEMORY;
    scene->prototypes = prototypes;
    return SF_STATUS_OK;
}

sf_status sf_scene_add_prototype(sf_scene *scene, const sf_mesh *meshes, size_t mesh_count, uint32_t *prototype,
                                 sf_error *error) {
    sf_status status = sf_scene_refuse_committed(scene, error);
    if (status) return status;
    if (!meshes || mesh_count < 1 || mesh_count > ROW_LIMIT)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "the prototype has %zu meshes; it must have 1 to %d",
                       meshes ? mesh_count : 0, ROW_LIMIT);
    sf_prototype p = {.dark = sf_scene_no_info(), .lit = sf_scene_no_info()};
    status = reserve_prototype(scene, error);
    if (!status) status = take_meshes(&p, meshes, mesh_count, error);
    if (!status && p.dark_count) status = attach_meshes(scene, &p, error);
    if (status) {
        free_prototype(&p);
        return status;
    }
    scene->info.copied_bytes += p.dark.copied_bytes;
    scene->info.unique_triangle_count += p.dark.unique_triangle_count;
    scene->prototype_mesh_count += mesh_count;
    *prototype = (uint32_t)scene->prototype_count;
    scene->prototypes[scene->prototype_count++] = p;
    return SF_STATUS_OK;
}

/* ---- placements ---- */

/* The place of a transform, before the prototype's offset. */
static sf_instance_transform place_of(const float *transform) {
    sf_instance_transform place = {.placed = true};
    for (int r = 0; r < 3; ++r) {
        memcpy(place.linear + 3 * r, transform + 4 * r, 12);
        place.translation[r] = (double)transform[4 * r + 3];
    }
    return place;
}

static sf_status check_transform(const float *transform, size_t number, sf_error *error) {
    for (int i = 0; i < 12; ++i)
        if (!(fabsf(transform[i]) <= SF_LENGTH_LIMIT))
            return sf_fail(error, SF_STATUS_INVALID_VALUE,
                           "transform %zu: row %d, column %d is %g; it must be finite and at most %g in size", number,
                           i / 4, i % 4, (double)transform[i], (double)SF_LENGTH_LIMIT);
    sf_instance_transform place = place_of(transform);
    double cofactors[9], determinant = sf_cofactors(place.linear, cofactors), condition = sf_condition(place.linear);
    if (!(condition <= CONDITION_LIMIT))
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "transform %zu is singular to single precision: its 3 x 3 part has determinant %g and norms "
                       "whose product with the inverse's is %g; at most %g is allowed",
                       number, determinant, condition, CONDITION_LIMIT);
    if (!(fabs(determinant) >= LEAST_DETERMINANT && fabs(determinant) <= 1 / LEAST_DETERMINANT))
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "transform %zu: the determinant of its 3 x 3 part is %g; its size must be in [%g, %g]", number,
                       determinant, LEAST_DETERMINANT, 1 / LEAST_DETERMINANT);
    return SF_STATUS_OK;
}

sf_status sf_instances_check(const sf_instances *instances, sf_error *error) {
    if (!instances->transforms || instances->count < 1 || instances->count > ROW_LIMIT)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "%zu transforms; there must be 1 to %d",
                       instances->transforms ? instances->count : 0, ROW_LIMIT);
    for (size_t i = 0; i < instances->count; ++i) {
        sf_status status = check_transform(instances->transforms + 12 * i, i, error);
        if (status) return status;
        for (size_t c = 0; instances->albedos && c < 3; ++c) {
            float albedo = instances->albedos[3 * i + c];
            if (!(albedo >= 0 && albedo <= 1))
                return sf_fail(error, SF_STATUS_INVALID_VALUE, "albedo %zu: its value %zu is %g; it must be in [0, 1]",
                               i, c, (double)albedo);
        }
    }
    return SF_STATUS_OK;
}

/* The transformed boxes of the dark and the lit must lie where meshes may. */
static sf_status check_reach(const sf_prototype *p, const sf_instances *instances, sf_error *error) {
    for (size_t i = 0; i < instances->count; ++i)
        for (int lit = 0; lit < 2; ++lit) {
            const sf_scene_info *info = lit ? &p->lit : &p->dark;
            sf_instance_transform place = place_of(instances->transforms + 12 * i);
            double low[3], high[3];
            if (info->triangle_count == 0) continue;
            sf_instance_box(&place, info->bounds_lower, info->bounds_upper, low, high);
            for (int c = 0; c < 3; ++c)
                if (!(fmax(fabs(low[c]), fabs(high[c])) <= (double)SF_LENGTH_LIMIT))
                    return sf_fail(error, SF_STATUS_INVALID_VALUE,
                                   "transform %zu takes its prototype to coordinates of %g; at most %g are allowed", i,
                                   fmax(fabs(low[c]), fabs(high[c])), (double)SF_LENGTH_LIMIT);
        }
    return SF_STATUS_OK;
}

/* The rows of the dark meshes, and an instance in Embree that instance_transform.c gives its transform. */
static sf_status place_dark(sf_scene *scene, uint32_t number, const float *transform, const float *albedo,
                            sf_error *error) {
    const sf_prototype *p = scene->prototypes + number;
    sf_scene_info *info = &scene->info;
    sf_instance_transform place = place_of(transform);
    double low[3], high[3];
    sf_instance_box(&place, p->dark.bounds_lower, p->dark.bounds_upper, low, high);
    place.prototype = number;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) place.translation[r] += (double)place.linear[3 * r + c] * (double)p->offset[c];
    RTCGeometry geometry = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, p->embree);
    rtcAttachGeometryByID(scene->embree, geometry, (unsigned)info->mesh_count);
    rtcReleaseGeometry(geometry);
    int code = (int)rtcGetDeviceError(scene->device);
    if (code) return sf_fail_embree(error, code, "refused an instance");
    for (uint32_t i = 0; i < p->dark_count; ++i) {
        sf_status status = sf_scene_reserve_mesh(scene, error);
        if (status) return status;
        sf_scene_mesh *row = scene->meshes + info->mesh_count++;
        *row = (sf_scene_mesh){.mesh = p->meshes[i].mesh, .longest = p->meshes[i].longest, .place = place};
        row->place.member = i;
        if (albedo) memcpy(row->mesh.albedo, albedo, sizeof row->mesh.albedo);
    }
    for (int c = 0; c < 3; ++c) {
        info->bounds_lower[c] = fminf(info->bounds_lower[c], (float)low[c]);
        info->bounds_upper[c] = fmaxf(info->bounds_upper[c], (float)high[c]);
    }
    info->triangle_count += p->dark.triangle_count;
    info->degenerate_count += p->dark.degenerate_count;
    info->hash = sf_hash64(info->hash, p->dark.hash);
    info->hash = sf_scene_hash(info->hash, transform, 48);
    if (albedo) info->hash = sf_scene_hash(info->hash, albedo, 12);
    scene->placed_count += p->dark_count;
    return SF_STATUS_OK;
}

/* A copy whose corners go round the other way where the transform mirrors: so the side that emits
 * stays the same. */
static sf_status place_lit(sf_scene *scene, const sf_scene_mesh *from, const float *transform, const float *albedo,
                           sf_error *error) {
    sf_scene_mesh kept = {.mesh = from->mesh};
    sf_instance_transform place = place_of(transform);
    size_t vertices = kept.mesh.vertex_count, triangles = kept.mesh.triangle_count;
    double cofactors[9];
    bool mirror = sf_cofactors(place.linear, cofactors) < 0;
    kept.vertex_copy = malloc(12 * vertices + 16); /* Embree reads up to 4 bytes past */
    kept.index_copy = mirror ? malloc(12 * triangles + 16) : NULL;
    if (!kept.vertex_copy || (mirror && !kept.index_copy)) {
        sf_scene_free_arrays(&kept);
        return sf_fail_memory(error, "a copy of a mesh that emits", 12 * (vertices + triangles));
    }
    for (size_t i = 0; i < vertices; ++i)
        for (int r = 0; r < 3; ++r) {
            const float *v = from->mesh.vertices + 3 * i, *row = place.linear + 3 * r;
            kept.vertex_copy[3 * i + (size_t)r] =
                (float)(place.translation[r] + (double)row[0] * (double)v[0] + (double)row[1] * (double)v[1] +
                        (double)row[2] * (double)v[2]);
        }
    for (size_t i = 0; mirror && i < 3 * triangles; ++i)
        kept.index_copy[i] = from->mesh.triangles[i % 3 == 0 ? i : i % 3 == 1 ? i + 1 : i - 1];
    kept.mesh.vertices = kept.vertex_copy;
    if (mirror) kept.mesh.triangles = kept.index_copy;
    if (albedo) memcpy(kept.mesh.albedo, albedo, sizeof kept.mesh.albedo);
    sf_status status = sf_scene_take_mesh(scene, &kept, error);
    if (status) return status;
    scene->info.copied_bytes += 12 * (vertices + (mirror ? triangles : 0));
    ++scene->placed_count;
    return SF_STATUS_OK;
}

sf_status sf_scene_add_instances(sf_scene *scene, uint32_t prototype, const sf_instances *instances, sf_error *error) {
    sf_status status = sf_scene_refuse_committed(scene, error);
    if (status) return status;
    if (prototype >= scene->prototype_count)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "prototype is %u; the scene has %zu of them", prototype,
                       scene->prototype_count);
    const sf_prototype *p = scene->prototypes + prototype;
    status = sf_instances_check(instances, error);
    if (!status) status = check_reach(p, instances, error);
    if (!status && (double)instances->count * p->mesh_count + (double)scene->info.mesh_count > ROW_LIMIT)
        status = sf_fail(error, SF_STATUS_INVALID_VALUE, "%zu instances of %u meshes are more than a scene's %d meshes",
                         instances->count, p->mesh_count, ROW_LIMIT);
    for (size_t i = 0; !status && i < instances->count; ++i) {
        const float *transform = instances->transforms + 12 * i;
        const float *albedo = instances->albedos ? instances->albedos + 3 * i : NULL;
        if (p->dark_count) status = place_dark(scene, prototype, transform, albedo, error);
        for (uint32_t m = p->dark_count; !status && m < p->mesh_count; ++m)
            status = place_lit(scene, p->meshes + m, transform, albedo, error);
        scene->info.instance_count += !status;
    }
    return status;
}
