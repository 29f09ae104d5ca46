// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Which piece of the lights is drawn how often, and what a sample of it weighs. */

#include "base/error.h"
#include "base/platform.h"
#include "scene/scene_internal.h"

#define PI 3.14159265358979323846

/* Power of the lights in the scene, and of the sky. */
typedef struct totals {
    double power[2];
    double share; /* of the samples that each kind has */
} totals;

static totals sum_power(const sf_light_source *sources, size_t count) {
    totals t = {{0, 0}, 1};
    for (size_t i = 0; i < count; ++i) t.power[sources[i].sky] += sources[i].area * sources[i].power;
    if (t.power[0] > 0 && t.power[1] > 0) t.share = 0.5;
    return t;
}

/* Probability area x power / total, over the area: power / total. The tree's is 1 here, to be multiplied
 * by what it gives. */
static void weigh_piece(sf_scene *scene, float *piece, const sf_light_source *source, const totals *t) {
    bool by_tree = scene->lights.tree && !source->sky;
    double pdf = t->share * (by_tree ? 1 / source->area : source->power / t->power[source->sky]);
    for (int c = 0; c < 3; ++c) piece[SF_LIGHT_WEIGHT_R + c] = (float)((double)source->radiance[c] / (pdf * PI));
    piece[SF_LIGHT_PDF] = (float)pdf;
    piece[SF_LIGHT_AREA] = (float)source->area;
    if (!source->sky) scene->mesh_table.columns[SF_MESH_LIGHT_PDF][source->mesh] = (float)pdf;
}

/* The densities by which rays that miss are weighted: suns come first among the pieces of the sky. */
static void weigh_sky(sf_scene *scene, const sf_light_source *sources) {
    sf_sky *sky = &scene->sky;
    size_t sun = 0;
    for (size_t i = 0; i < scene->lights.count; ++i) {
        if (!sources[i].sky) continue;
        float pdf = scene->lights.pieces[i][SF_LIGHT_PDF];
        if (sun == sky->sun_count) {
            sky->pdf = (float)((double)pdf / sky->total);
            continue;
        }
        sf_sky_sun *s = sky->suns + sun++;
        s->pdf = s->height > 0 ? (float)((double)pdf / (2 * PI * (double)s->height)) : 0;
    }
}

sf_status sf_light_table_fill(sf_scene *scene, const sf_light_source *sources, sf_error *error) {
    sf_light_table *lights = &scene->lights;
    size_t count = lights->count;
    totals t = sum_power(sources, count);
    if (!(t.power[0] <= 1e30)) /* beyond it the single-precision weights would overflow */
        return sf_fail(
            error, SF_STATUS_INVALID_VALUE,
            "area x emission of the lights is %g; it must be at most 1e30: scale the scene or its lights down",
            t.power[0]);
    double *power = calloc(count, sizeof *power);
    float *keep = malloc(count * sizeof *keep);
    sf_status status = SF_STATUS_OK;
    if (!power || !keep) status = sf_fail_memory(error, "the powers of the lights", count * sizeof *power);
    lights->scene_share = count > lights->sky_first ? (float)t.share : 1;
    for (size_t i = 0; !status && i < count; ++i) {
        weigh_piece(scene, lights->pieces[i], sources + i, &t);
        power[i] = sources[i].area * (sources[i].power / t.power[sources[i].sky]);
    }
    size_t first = lights->tree ? lights->sky_first : 0; /* the table's pieces */
    if (!status && first < count)
        status = sf_alias_build(power + first, count - first, keep + first, lights->alias + first, error);
    for (size_t i = first; !status && i < count; ++i) {
        lights->pieces[i][SF_LIGHT_KEEP] = keep[i];
        lights->alias[i] += (uint32_t)first;
    }
    if (!status) weigh_sky(scene, sources);
    free(power);
    free(keep);
    return status;
}
