// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The plan: which stages a scene needs, and which sample dimensions exist. */

#include <string.h>

#include "scene/scene_internal.h"

/* The share of all directions that an environment's light has to come from for the last surface
 * ray to lower its error by more than the time it takes: bench/render_surface_ray.py. */
#define WIDE (1.0 / 32)

const char *sf_stage_name(sf_stage stage) {
    switch (stage) {
        case SF_STAGE_CAMERA: return "camera";
        case SF_STAGE_LENS: return "lens";
        case SF_STAGE_INTERSECT: return "intersect";
        case SF_STAGE_INSTANCES: return "instances";
        case SF_STAGE_QUADRIC: return "round shapes";
        case SF_STAGE_FOG: return "fog";
        case SF_STAGE_MISS: return "miss";
        case SF_STAGE_SKY: return "sky";
        case SF_STAGE_EMISSION: return "emission";
        case SF_STAGE_CHOOSE_LIGHT: return "choose light";
        case SF_STAGE_LIGHT: return "light";
        case SF_STAGE_LIGHT_SHAPES: return "light shapes";
        case SF_STAGE_LIGHT_TREE: return "light tree";
        case SF_STAGE_SCATTER: return "scatter";
        case SF_STAGE_SURFACE: return "surface";
        case SF_STAGE_LAST_SURFACE: return "last surface";
        case SF_STAGE_WEIGHT: return "weight";
        case SF_STAGE_COUNT: break;
    }
    return "unknown stage";
}

const char *sf_dimension_use_name(sf_dimension_use use) {
    switch (use) {
        case SF_DIMENSION_PIXEL: return "pixel";
        case SF_DIMENSION_LENS: return "lens";
        case SF_DIMENSION_LIGHT: return "light";
        case SF_DIMENSION_CHOICE: return "choice";
        case SF_DIMENSION_SURFACE: return "surface";
        case SF_DIMENSION_LOBE: return "lobe";
        case SF_DIMENSION_FOG: return "fog";
    }
    return "unknown dimension";
}

/* What the scene holds, as far as the plan depends on it. */
typedef struct contents {
    bool emission, background, lens, instances, quadric, sky, special, tree, fog;
    bool wide;      /* an environment whose light comes from many directions */
    bool spreading; /* surfaces that scatter in more directions than few: diffuse or rough */
    bool scatter;   /* surfaces that are not diffuse; */
    bool lobes;     /* of these, such as reflect and refract */
    sf_light_sampling sampling;
    size_t lights;
} contents;

static contents survey(const sf_scene *scene) {
    contents has = {.lights = scene->lights.count,
                    .lens = scene->camera.aperture_radius > 0,
                    .instances = sf_has_instances(scene),
                    .quadric = scene->quadrics != NULL,
                    .wide = scene->sky.spread > WIDE,
                    .special = scene->lights.special,
                    .tree = scene->lights.tree != NULL,
                    .fog = sf_foggy(scene),
                    .sampling = scene->light_sampling};
    for (size_t i = 0; i < scene->info.mesh_count; ++i) {
        has.emission |= sf_emits(&scene->meshes[i].mesh);
        if (!sf_reflects(&scene->meshes[i].mesh)) continue;
        sf_scatter scatter = sf_scatter_of(&scene->meshes[i].mesh.material);
        has.spreading |= scatter == SF_SCATTER_DIFFUSE || scatter >= SF_SCATTER_ROUGH_CONDUCTOR;
        has.scatter |= scatter != SF_SCATTER_DIFFUSE;
        has.lobes |= scatter == SF_SCATTER_SMOOTH_DIELECTRIC || scatter == SF_SCATTER_ROUGH_DIELECTRIC;
    }
    has.scatter |= has.fog;
    has.spreading |= has.fog;
    for (int c = 0; c < 3; ++c) has.background |= scene->background[c] > 0;
    has.sky = scene->environment.pixels != NULL;
    for (size_t i = 0; i < scene->sky.sun_count; ++i) has.sky |= scene->sky.suns[i].height > 0;
    return has;
}

static uint32_t choose_stages(const contents *has, uint32_t max_bounces) {
    uint32_t stages = 1u << SF_STAGE_INTERSECT;
#define NEED(condition, stage) stages |= (uint32_t)((condition) != 0) << (stage)
    NEED(!has->lens, SF_STAGE_CAMERA);
    NEED(has->lens, SF_STAGE_LENS);
    NEED(has->instances, SF_STAGE_INSTANCES);
    NEED(has->quadric, SF_STAGE_QUADRIC);
    NEED(has->fog, SF_STAGE_FOG);
    NEED(has->background, SF_STAGE_MISS);
    NEED(has->sky, SF_STAGE_SKY);
    NEED(has->emission, SF_STAGE_EMISSION);
    /* Light arrives from lights, which are sampled, or from the background, which is not. An
     * environment that is wide is found by both. */
    bool sampled = has->lights && has->sampling != SF_LIGHT_SAMPLING_SURFACE;
    bool found = has->sampling == SF_LIGHT_SAMPLING_SURFACE ? has->emission || has->sky
                                                            : has->wide && has->sampling == SF_LIGHT_SAMPLING_BOTH;
    bool reflection = has->spreading || has->scatter, seen = has->scatter && has->sky;
    bool bounces = max_bounces > 0 && reflection && (sampled || found || seen || has->background);
    bool surface = bounces && max_bounces > 1, last = bounces && (has->background || found);
    sampled &= has->spreading; /* smooth surfaces have no use for it */
    NEED(bounces && sampled, SF_STAGE_LIGHT);
    NEED(bounces && sampled && has->lights > 1, SF_STAGE_CHOOSE_LIGHT);
    NEED(bounces && sampled && has->special, SF_STAGE_LIGHT_SHAPES);
    NEED(bounces && sampled && has->tree, SF_STAGE_LIGHT_TREE);
    NEED(bounces && has->scatter, SF_STAGE_SCATTER);
    NEED(surface, SF_STAGE_SURFACE);
    NEED(last, SF_STAGE_LAST_SURFACE);
    NEED(sampled && has->sampling == SF_LIGHT_SAMPLING_BOTH && (surface || last || (bounces && has->scatter)),
         SF_STAGE_WEIGHT);
#undef NEED
    return stages;
}

static void add_dimensions(sf_plan *plan, sf_dimension_use use, uint32_t bounce, uint32_t count) {
    plan->dimensions[plan->dimension_group_count++] =
        (sf_plan_dimensions){.use = use, .bounce = bounce, .first = plan->dimensions_per_path, .count = count};
    plan->dimensions_per_path += count;
}

void sf_plan_derive(const sf_scene *scene, sf_plan *plan) {
    contents has = survey(scene);
    memset(plan, 0, sizeof *plan);
    plan->max_bounces = scene->max_bounces;
    plan->stages = choose_stages(&has, scene->max_bounces);
    plan->camera_rays = 1;
    add_dimensions(plan, SF_DIMENSION_PIXEL, 0, 2);
    if (has.lens) add_dimensions(plan, SF_DIMENSION_LENS, 0, 2);
    if (has.fog) add_dimensions(plan, SF_DIMENSION_FOG, 0, 1);
    for (uint32_t bounce = 1; bounce <= plan->max_bounces; ++bounce) {
        if (sf_plan_has(plan, SF_STAGE_LIGHT)) {
            add_dimensions(plan, SF_DIMENSION_LIGHT, bounce, 2);
            ++plan->shadow_rays;
        }
        if (sf_plan_has(plan, SF_STAGE_CHOOSE_LIGHT)) add_dimensions(plan, SF_DIMENSION_CHOICE, bounce, 1);
        bool scatter = sf_plan_has(plan, SF_STAGE_SCATTER);
        if (scatter || sf_plan_has(plan, bounce < plan->max_bounces ? SF_STAGE_SURFACE : SF_STAGE_LAST_SURFACE)) {
            if (has.spreading) add_dimensions(plan, SF_DIMENSION_SURFACE, bounce, 2);
            if (scatter && has.lobes) add_dimensions(plan, SF_DIMENSION_LOBE, bounce, 1);
            if (has.fog) add_dimensions(plan, SF_DIMENSION_FOG, bounce, 1);
            ++plan->surface_rays;
        }
    }
}
