// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The render from its call to its film: what is set up, and what is put together at the end. */

#include "sunfleck/render.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "film/aov.h"
#include "film/mask.h"
#include "film/render_options.h"
#include "render/checkpoint.h"
#include "render/progress.h"
#include "render/relmse_target.h"
#include "render/rounds.h"

static void resolve_row(void *user, unsigned worker, size_t item) {
    (void)worker;
    sf_film_resolve_row(((sf_rounds *)user)->film, (uint32_t)item);
}

/* The pixels of a cell of which `width` columns and `height` rows lie in the film. */
static uint64_t pixels_inside(uint32_t width, uint32_t height) {
    if (width >= SF_CELL_SIZE && height >= SF_CELL_SIZE) return UINT64_MAX;
    uint64_t inside = 0;
    for (uint32_t m = 0; m < SF_CELL_PIXELS; ++m)
        if (sf_cell_x(m) < width && sf_cell_y(m) < height) inside |= UINT64_C(1) << m;
    return inside;
}

static void open_all(sf_rounds *r) {
    for (uint32_t y = 0; y < r->film->cell_rows; ++y)
        for (uint32_t x = 0; x < r->film->cell_columns; ++x)
            r->open[(size_t)y * r->film->cell_columns + x] =
                sf_mask_touches_cell(&r->options, r->film->x0 + x * SF_CELL_SIZE, r->film->y0 + y * SF_CELL_SIZE)
                    ? pixels_inside(r->film->width - x * SF_CELL_SIZE, r->film->height - y * SF_CELL_SIZE)
                    : 0;
}

static sf_status lay_out_cells(sf_rounds *r, sf_error *error) {
    const sf_film *film = r->film;
    r->tile_cells = r->options.tile_size / SF_CELL_SIZE;
    uint32_t x0 = film->x0 / SF_CELL_SIZE, y0 = film->y0 / SF_CELL_SIZE;
    r->tile_x0 = x0 / r->tile_cells * r->tile_cells;
    r->tile_y0 = y0 / r->tile_cells * r->tile_cells;
    r->tile_columns = (x0 + film->cell_columns - r->tile_x0 + r->tile_cells - 1) / r->tile_cells;
    r->tile_rows = (y0 + film->cell_rows - r->tile_y0 + r->tile_cells - 1) / r->tile_cells;
    size_t cells = sf_film_cell_count(r->film), tiles = (size_t)r->tile_columns * r->tile_rows;
    r->open = malloc(cells * sizeof *r->open);
    r->active = malloc(cells * sizeof *r->active);
    r->tiles = malloc(tiles * sizeof *r->tiles);
    if (!r->open || !r->active || !r->tiles)
        return sf_fail_memory(error, "the lists of cells and tiles", cells * 16 + tiles * 4);
    memset(r->active, 0, cells * sizeof *r->active);
    open_all(r);
    return SF_STATUS_OK;
}

static sf_status hire_workers(sf_rounds *r, sf_error *error) {
    size_t bytes = r->options.threads * sizeof *r->workers;
    r->workers = sf_aligned_alloc(bytes);
    if (!r->workers) return sf_fail_memory(error, "the threads' batches", bytes);
    memset(r->workers, 0, bytes);
    for (uint32_t i = 0; i < r->options.threads; ++i) {
        uint64_t stream = r->options.seeds == SF_SEEDS_THREAD ? i : 0;
        sf_status status = sf_rng_init(&r->workers[i].stream, SF_RNG_XOSHIRO256PP, r->options.seed, stream, error);
        if (status) return status;
        r->workers[i].batch.clock = (sf_work_clock){.runs = r->options.profile != 0, .at = SF_WORK_FILM};
        if (r->context.aovs & SF_AOVS_OF_HITS)
            r->workers[i].batch.hit_sums = r->film->aovs->hits + (size_t)i * SF_BLOCKS;
    }
    return sf_thread_pool_create(r->options.threads, &r->pool, error);
}

static sf_status prepare(sf_rounds *r, sf_error *error) {
    const sf_scene *scene = r->context.scene;
    const sf_render_options *o = &r->options;
    sf_status status =
        sf_sample_dimensions_init(&r->context.coordinates, o->pattern, &scene->plan, o->spp, o->seed, error);
    if (!status) status = sf_film_create(o, o->mask != NULL, &r->film, error);
    r->context.aovs = o->aovs;
    if (!status) status = lay_out_cells(r, error);
    if (!status) status = hire_workers(r, error);
    if (!status) status = sf_relmse_target_create(o, r->film, &r->goal, error);
    if (status) return status;
    r->region = sf_rounds_count_pixels(r, r->open);
    if (o->samples && sf_rounds_budget(r) < r->region)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "samples is %" PRIu64 "; at least %s for each of %" PRIu64 " pixels is allowed", o->samples,
                       o->unbiased ? "two, with unbiased," : "one", r->region);
    r->context.camera = sf_camera_frame_of(&scene->camera, o->width, o->height);
    for (int c = 0; c < 3; ++c) r->context.camera.position[c] -= scene->shift[c];
    r->context.filter = o->pixel_filter;
    r->context.signed_filter = r->film->negative_part > 0;
    r->context.seeds = o->seeds;
    r->context.roulette = o->roulette;
    r->context.isa = sf_isa_active();
    sf_rounds_set_deadline(r);
    r->progress.pixels = r->film->counted;
    r->progress.expected_samples = o->spp * r->region;
    r->progress.time_limit = o->seconds;
    r->from = r->to = o->start;
    r->film->summary.tolerance = -1;
    r->target = -1;
    return sf_film_identify(r->film, scene, r->context.isa, error);
}

/* The largest index that any pixel's next sample has. */
static uint32_t furthest(const sf_rounds *r) {
    const sf_film *film = r->film;
    uint64_t most = 0;
    for (size_t i = 0; i < film->stored; ++i) {
        if (sf_film_taken(film->pixels + i) > most) most = sf_film_taken(film->pixels + i);
    }
    most += r->options.start;
    return most < SF_MAX_SPP ? (uint32_t)most : SF_MAX_SPP;
}

/* What the checkpoint holds becomes the render's. Where more is asked for, every pixel takes part
 * again from the first round on: rounds add nothing to the pixels that have gone beyond them, and
 * decide nothing there, so that a pixel goes on from where it stopped, on the looks of a render
 * that had been asked for as much from the start. */
static void adopt_checkpoint(sf_rounds *r, const sf_round_state *state, bool extended) {
    sf_film_summary *summary = &r->film->summary;
    r->from = state->from;
    r->to = state->to;
    r->look = state->look;
    r->target = state->target;
    r->in_lap = state->in_lap != 0;
    r->second = state->second != 0;
    r->ahead = furthest(r);
    r->level_fixed = state->level_fixed != 0;
    summary->level = state->level;
    summary->tolerance = state->tolerance;
    summary->rounds = state->rounds;
    r->start -= state->seconds;
    sf_atomic_store(&r->workers[0].samples, state->traced_samples);
    if (extended) {
        r->from = r->to = r->options.start;
        summary->rounds = 0;
        r->in_lap = false;
        r->target = -1;
        /* A count below min_spp ended where the larger one takes no level. */
        if (r->ahead - r->options.start < r->options.min_spp) r->level_fixed = false;
        open_all(r);
        if (r->level_fixed) sf_rounds_set_tolerance(r);
    }
    r->pairing = r->second ? (sf_pairing){0, 0} : sf_stop_pairing(&r->options, r->look);
    sf_rounds_list_tiles(r);
    r->progress.round = summary->rounds;
    r->workers[0].done = (r->region - sf_rounds_count_pixels(r, r->open)) * r->progress.pixels / r->region;
}

static sf_status resume(sf_rounds *r, sf_error *error) {
    const char *path = r->options.checkpoint_path;
    if (!path) return SF_STATUS_OK;
    sf_checkpoint checkpoint = sf_rounds_checkpoint(r);
    sf_resume kind;
    sf_status status = sf_checkpoint_restore(&checkpoint, path, &kind, error);
    if (!status && kind != SF_RESUME_NONE) adopt_checkpoint(r, &checkpoint.state, kind == SF_RESUME_EXTENDED);
    sf_rounds_set_deadline(r);
    r->checkpoint_due = sf_seconds_now() + r->options.checkpoint_seconds;
    return status;
}

static void finish(sf_rounds *r) {
    sf_film_summary *summary = &r->film->summary;
    summary->traced_samples = sf_rounds_samples(r);
    summary->confidence = r->options.confidence;
    summary->threads = r->options.threads;
    for (uint32_t i = 0; i < r->options.threads; ++i)
        for (int work = 0; work < SF_WORK_COUNT; ++work)
            summary->work_seconds[work] += r->workers[i].batch.clock.seconds[work];
    if (!r->level_fixed) sf_rounds_measure_level(r);
    sf_thread_pool_run(r->pool, r->film->crop_height, resolve_row, sf_rounds_wake, r);
    sf_film_summarize_rows(r->film);
    summary->seconds = sf_seconds_now() - r->start;
}

sf_status sf_render(const sf_scene *scene, const sf_render_options *options, sf_film **film, sf_error *error) {
    *film = NULL;
    sf_plan plan;
    sf_status status = sf_scene_get_plan(scene, &plan, error); /* refuses a scene that is not committed */
    if (status) return status;
    sf_rounds *r = calloc(1, sizeof *r);
    if (!r) return sf_fail_memory(error, "a render", sizeof *r);
    r->start = sf_seconds_now();
    r->context.scene = scene;
    r->options = *options;
    status = sf_render_options_complete(&r->options, error);
    if (!status) status = prepare(r, error);
    if (!status) status = resume(r, error);
    if (!status) {
        sf_rounds_run(r);
        finish(r);
        status = sf_film_describe(r->film, error);
    }
    sf_thread_pool_destroy(r->pool);
    sf_aligned_free(r->workers);
    sf_relmse_target_destroy(r->goal);
    free(r->open);
    free(r->active);
    free(r->tiles);
    if (status)
        sf_film_destroy(r->film);
    else
        *film = r->film;
    if (!status && r->checkpoint_status)
        status = sf_fail(error, r->checkpoint_status, "%s", r->checkpoint_error.message);
    free(r);
    return status;
}
