// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The way of a batch through the plan's stages. */

#include "trace/batch.h"

#include "trace/aov_kernels.h"
#include "trace/camera_kernels.h"
#include "trace/fog_kernels.h"
#include "trace/gather_kernels.h"
#include "trace/light_kernels.h"
#include "trace/light_shape_kernels.h"
#include "trace/material_kernels.h"
#include "trace/order_kernels.h"
#include "trace/quadric_kernels.h"
#include "trace/rays.h"
#include "trace/sample_dimensions_kernels.h"
#include "trace/shade_kernels.h"
#include "trace/sky_kernels.h"
#include "trace/trace_kernels.h"

/* The batch's run in progress: who works on what. */
typedef struct run {
    sf_batch *batch;
    const sf_render_context *context;
    const sf_sample_dimensions_kernels *coordinates;
    const sf_shade_kernels *shade;
    const sf_order_kernels *order;
    const sf_trace_kernels *trace;
    const sf_light_kernels *light;
    const sf_light_shape_kernels *shapes;
    const sf_material_kernels *material; /* NULL without SF_STAGE_SCATTER */
    bool special;                        /* light is sampled, or weighted, in more ways than the plainest */
    bool sorts;                          /* surface rays are moved to others like them */
    uint32_t group;                      /* the plan's next group of dimensions */
} run;

static void begin(run *r, sf_work work) { sf_work_begin(&r->batch->clock, work); }

static bool has(const run *r, sf_stage stage) { return sf_plan_has(&r->context->scene->plan, stage); }

/* Fills `out` with the source's coordinates. */
static void fill_coordinates(run *r, const sf_coordinate_source *source, float (*out)[SF_PATHS]) {
    const sf_sample_dimensions *coordinates = &r->context->coordinates;
    sf_batch *b = r->batch;
    begin(r, SF_WORK_COORDINATES);
    if (b->width == SF_LANES)
        r->coordinates->fill(coordinates, source, b->blocks, b->block_count, out);
    else
        r->coordinates->fill_narrow(coordinates, source, b->blocks, b->block_count, b->width, b->first_sample,
                                    b->contribution, out);
}

/* Fills `out` with the coordinates of the plan's next group, which is for `use`. */
static void next_coordinates(run *r, sf_dimension_use use, float (*out)[SF_PATHS]) {
    const sf_plan *plan = &r->context->scene->plan;
    while (plan->dimensions[r->group].use != use) ++r->group;
    fill_coordinates(r, r->context->coordinates.sources + r->group++, out);
}

/* The same where the vertex `bounce` may have no such group. */
static void optional_coordinates(run *r, sf_dimension_use use, uint32_t bounce, float (*out)[SF_PATHS]) {
    const sf_plan *plan = &r->context->scene->plan;
    for (uint32_t g = r->group; g < plan->dimension_group_count && plan->dimensions[g].bounce <= bounce; ++g)
        if (plan->dimensions[g].bounce == bounce && plan->dimensions[g].use == use) {
            next_coordinates(r, use, out);
            return;
        }
}

/* The nearest hits, with the normals of what is quadric. */
static void trace_nearest(run *r, uint32_t packets, const uint32_t *active, sf_coherence coherence) {
    const sf_scene *scene = r->context->scene;
    r->trace->nearest(r->batch, scene, packets, active, coherence);
    if (has(r, SF_STAGE_QUADRIC)) sf_quadric_kernels_at(r->context->isa)->face(r->batch, scene, packets * SF_LANES);
}

/* The sums over first hits, after the camera's rays were traced and before others are. */
static void gather_hits(sf_batch *batch, const sf_render_context *context) {
    const sf_aov_kernels *kernels = sf_aov_kernels_at(context->isa);
    const sf_mesh_table *meshes = &context->scene->mesh_table;
    if (context->aovs >> SF_AOV_ALBEDO & 1u) kernels->albedo(batch, meshes, batch->hit_sums);
    if (context->aovs >> SF_AOV_NORMAL & 1u) kernels->normal(batch, meshes, batch->hit_sums);
    if (context->aovs >> SF_AOV_DEPTH & 1u) kernels->depth(batch, meshes, context->camera.forward, batch->hit_sums);
}

/* Ends rays in the fog. */
static void drift(run *r, uint32_t count) {
    next_coordinates(r, SF_DIMENSION_FOG, r->batch->coordinate);
    sf_fog_kernels_at(r->context->isa)->drift(r->batch, r->context->scene, count);
}

static void trace_camera(run *r) {
    sf_batch *b = r->batch;
    const sf_scene *scene = r->context->scene;
    uint32_t active[SF_BLOCKS] = {0}, paths = sf_batch_paths(b);
    for (uint32_t i = 0; i < b->block_count; ++i)
        active[i * b->width / SF_LANES] |= sf_batch_wanted(b, i) << i * b->width % SF_LANES;
    next_coordinates(r, SF_DIMENSION_PIXEL, b->coordinate);
    bool lens = has(r, SF_STAGE_LENS);
    if (lens) next_coordinates(r, SF_DIMENSION_LENS, b->coordinate_by_ray);
    begin(r, SF_WORK_CAMERA);
    sf_camera_kernels_at(r->context->isa)
        ->camera(b, &r->context->camera, r->context->filter, lens ? b->coordinate_by_ray : NULL);
    begin(r, SF_WORK_CAMERA_RAYS);
    trace_nearest(r, paths / SF_LANES, active, SF_STREAM);
    begin(r, SF_WORK_VERTICES);
    if (b->hit_sums) gather_hits(b, r->context);
    if (has(r, SF_STAGE_FOG)) drift(r, paths);
    r->shade->first_radiance(b, scene);
    if (has(r, SF_STAGE_SKY)) sf_sky_kernels_at(r->context->isa)->first(b, scene);
}

/* Light sampled from the vertices of bounce `bounce`. */
static void connect_lights(run *r, uint32_t bounce, uint32_t count) {
    const sf_plan *plan = &r->context->scene->plan;
    next_coordinates(r, SF_DIMENSION_LIGHT, r->batch->coordinate);
    if (has(r, SF_STAGE_CHOOSE_LIGHT)) next_coordinates(r, SF_DIMENSION_CHOICE, r->batch->coordinate + 2);
    sf_batch *b = r->batch;
    const sf_scene *scene = r->context->scene;
    bool onward = bounce < plan->max_bounces || has(r, SF_STAGE_LAST_SURFACE);
    bool weigh = onward && has(r, SF_STAGE_WEIGHT);
    begin(r, SF_WORK_LIGHT);
    if (r->material) {
        r->shapes->bare_light(b, scene, count);
        r->material->respond(b, scene, onward);
    } else
        (r->special ? r->shapes->light : r->light->light)(b, scene, count, weigh);
    if (has(r, SF_STAGE_FOG)) sf_fog_kernels_at(r->context->isa)->dim(b, scene, count);
    /* Those of the first bounce are together by the pixel, those of sorted surface rays by these. */
    bool sort = bounce > 1 && !r->sorts;
    uint32_t rays = (sort ? r->order->sort_shadow_rays : r->order->list_alive)(b, count);
    begin(r, SF_WORK_SHADOW_RAYS);
    r->trace->shadow(b, scene, r->material ? b->origin : b->point, rays);
    begin(r, SF_WORK_LIGHT);
    r->light->add_light(b, count);
}

/* The radiance that surface rays find. */
static void add_found(run *r, uint32_t count) {
    sf_batch *b = r->batch;
    const sf_scene *scene = r->context->scene;
    if (!r->special) {
        r->shade->later_radiance(b, scene, count);
        return;
    }
    r->shapes->found(b, scene, count);
    if (has(r, SF_STAGE_SKY)) sf_sky_kernels_at(r->context->isa)->later(b, scene, count);
    sf_add_by_path(b, b->emission, count);
}

/* The rays off surfaces of all kinds, at the last bounce perhaps of all but the diffuse. Returns
 * how many vertices have one, of which those that are not `alive` scattered nothing. */
static uint32_t scatter(run *r, uint32_t bounce, uint32_t count) {
    sf_batch *b = r->batch;
    const sf_scene *scene = r->context->scene;
    if (bounce == scene->plan.max_bounces && !has(r, SF_STAGE_LAST_SURFACE)) {
        r->material->end_diffuse(b, count);
        count = r->order->compact(b, count);
        r->material->compact(b, count);
        r->material->sort(b, scene, count);
    }
    optional_coordinates(r, SF_DIMENSION_SURFACE, bounce, b->coordinate);
    optional_coordinates(r, SF_DIMENSION_LOBE, bounce, b->coordinate + 2);
    begin(r, SF_WORK_SURFACE);
    if (b->scatter_first[SF_SCATTER_DIFFUSE + 1]) r->shade->surface(b, count);
    r->material->scatter(b, scene, count);
    return count;
}

/* Surface-sampled rays from the vertices, and the radiance that they find. Returns how many. */
static uint32_t trace_surface(run *r, uint32_t bounce, uint32_t count) {
    sf_batch *b = r->batch;
    uint32_t active[SF_BLOCKS];
    if (r->material)
        count = scatter(r, bounce, count);
    else {
        next_coordinates(r, SF_DIMENSION_SURFACE, b->coordinate);
        begin(r, SF_WORK_SURFACE);
        r->shade->surface(b, count);
    }
    begin(r, SF_WORK_SURFACE_RAYS);
    if (r->sorts) count = r->order->sort_surface_rays(b, r->context->scene, count);
    uint32_t packets = (count + SF_LANES - 1) / SF_LANES;
    if (packets == 0) return 0;
    for (uint32_t p = 0; p < packets; ++p) active[p] = 0xffffu;
    if (count % SF_LANES) active[packets - 1] = (1u << count % SF_LANES) - 1;
    if (r->material && !r->sorts)
        for (uint32_t i = 0; i < count; ++i) active[i / SF_LANES] &= ~((b->alive[i] ^ 1u) << i % SF_LANES);
    trace_nearest(r, packets, active, r->sorts ? SF_COHERENT : SF_INCOHERENT);
    begin(r, SF_WORK_SURFACE);
    if (has(r, SF_STAGE_FOG)) drift(r, count);
    add_found(r, count);
    return count;
}

static void play_roulette(run *r, uint32_t bounce, uint32_t count) {
    sf_coordinate_source source = sf_roulette_source(&r->context->coordinates, &r->context->scene->plan, bounce);
    sf_batch *b = r->batch;
    fill_coordinates(r, &source, b->coordinate);
    r->shade->roulette(b, count);
}

static void place_vertices(run *r, uint32_t bounce, uint32_t count) {
    sf_batch *b = r->batch;
    const sf_scene *scene = r->context->scene;
    if (bounce == 1)
        r->shade->first_vertex(b, scene);
    else
        r->shade->later_vertex(b, scene, count);
    if (has(r, SF_STAGE_QUADRIC)) sf_quadric_kernels_at(r->context->isa)->settle(b, scene, count);
}

/* Leaves the vertices where the path goes on, moved together. */
static uint32_t compact(run *r, uint32_t count) {
    count = r->order->compact(r->batch, count);
    if (r->material) {
        r->material->keep(r->batch, r->context->scene, count);
        r->material->sort(r->batch, r->context->scene, count);
    }
    return count;
}

void sf_batch_run(sf_batch *batch, const sf_render_context *context) {
    run r = {.batch = batch,
             .context = context,
             .coordinates = sf_sample_dimensions_kernels_at(context->isa),
             .shade = sf_shade_kernels_at(context->isa),
             .order = sf_order_kernels_at(context->isa),
             .trace = sf_trace_kernels_at(context->isa),
             .light = sf_light_kernels_at(context->isa),
             .shapes = sf_light_shape_kernels_at(context->isa)};
    if (has(&r, SF_STAGE_SCATTER)) r.material = sf_material_kernels_at(context->isa);
    const sf_plan *plan = &context->scene->plan;
    r.special = context->scene->lights.special || context->scene->light_sampling != SF_LIGHT_SAMPLING_BOTH;
    r.sorts = context->scene->few;
    batch->in_place = true;
    trace_camera(&r);
    bool light = has(&r, SF_STAGE_LIGHT);
    uint32_t count = sf_batch_paths(batch);
    for (uint32_t bounce = 1; bounce <= plan->max_bounces; ++bounce) {
        bool onward = r.material || has(&r, bounce < plan->max_bounces ? SF_STAGE_SURFACE : SF_STAGE_LAST_SURFACE);
        if (!light && !onward) break;
        begin(&r, SF_WORK_VERTICES);
        place_vertices(&r, bounce, count);
        if (context->roulette && bounce >= context->roulette) play_roulette(&r, bounce, count);
        begin(&r, SF_WORK_VERTICES);
        count = compact(&r, count);
        if (count == 0) break;
        if (light) connect_lights(&r, bounce, count);
        if (onward) count = trace_surface(&r, bounce, count);
    }
    begin(&r, SF_WORK_SUMS);
    const sf_gather_kernels *gather = sf_gather_kernels_at(context->isa);
    if (context->signed_filter)
        gather->gather_by_sign(batch);
    else
        gather->gather_statistics(batch);
}
