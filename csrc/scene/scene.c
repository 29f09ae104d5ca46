// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A scene from its making to its end: what it is set to, and what it tells of itself once committed. */
#include "sunfleck/scene.h"

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/platform.h"
#include "scene/scene_input.h"
#include "scene/scene_mesh.h"

sf_camera sf_camera_default(void) { return (sf_camera){.position = {0, 0, 1}, .up = {0, 1, 0}, .vertical_fov = 40}; }

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
