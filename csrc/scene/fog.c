// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Sets and checks a scene's fog, and gives it its row in the table of meshes. */
#include "base/error.h"
#include "scene/scene_input.h"
#include "scene/scene_internal.h"

sf_fog sf_fog_default(void) { return (sf_fog){0, 0, 0}; }

sf_status sf_scene_set_fog(sf_scene *scene, const sf_fog *fog, sf_error *error) {
    sf_status status = sf_scene_refuse_committed(scene, error);
    if (status) return status;
    sf_fog given = fog ? *fog : sf_fog_default();
    if (!(given.scattering >= 0 && given.scattering <= SF_FOG_LIMIT))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "scattering is %g; it must be in [0, %g]",
                       (double)given.scattering, (double)SF_FOG_LIMIT);
    if (!(given.absorption >= 0 && given.absorption <= SF_FOG_LIMIT))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "absorption is %g; it must be in [0, %g]",
                       (double)given.absorption, (double)SF_FOG_LIMIT);
    if (!(given.g >= -0.99f && given.g <= 0.99f))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "g is %g; it must be in [-0.99, 0.99]", (double)given.g);
    scene->fog = given;
    return SF_STATUS_OK;
}

/* Nothing comes through from infinitely far. */
sf_status sf_fog_check(const sf_scene *scene, sf_error *error) {
    if (!sf_foggy(scene)) return SF_STATUS_OK;
    float background = scene->background[0] + scene->background[1] + scene->background[2];
    if (background > 0 || scene->info.sun_count || scene->environment.pixels)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "the scene has fog and light from infinitely far (%s), of which nothing comes through; leave "
                       "one of them out",
                       background > 0          ? "a background"
                       : scene->info.sun_count ? "a sun"
                                               : "an environment");
    return SF_STATUS_OK;
}

/* The row of the fog, after that of a miss: what is scattered, of what it takes. */
void sf_fog_tabulate(const sf_scene *scene, sf_mesh_table *table) {
    if (!sf_foggy(scene)) return;
    float share = scene->fog.scattering / (scene->fog.scattering + scene->fog.absorption);
    for (int c = 0; c < 3; ++c)
        table->columns[SF_MESH_ALBEDO_R + c][table->miss + 1] = table->columns[SF_MESH_PASS_R + c][table->miss + 1] =
            share;
    table->columns[SF_MESH_SCATTER][table->miss + 1] = SF_SCATTER_FOG;
}
