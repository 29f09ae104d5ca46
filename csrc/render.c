// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The render: rounds over tiles, and the decisions between them.
 *
 * A round brings every active pixel from `from` to `to` samples; threads take tiles from a
 * counter. One or more rounds make a lap, which ends at a count where the stopping rule looks.
 * Decisions fall between laps only, from the statistics of all pixels and the frame's level, so
 * that no bit of the film depends on threads or tiles.
 *
 * With a tolerance, or a fixed count, all open pixels move on together until they are closed.
 * With a budget alone a falling target takes the tolerance's place: the pixels beyond it are
 * brought on, the least sampled first, until none is, and the target falls. */

#include "sunfleck/render.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "aov.h"
#include "batch.h"
#include "checkpoint.h"
#include "error.h"
#include "film.h"
#include "mask.h"
#include "pool.h"
#include "render_options.h"
#include "stopping.h"
#include "sunfleck/rng.h"

#define CELL_PIXELS (SF_CELL_SIZE * SF_CELL_SIZE)

enum { RUNNING = 0, OUT_OF_TIME, INTERRUPTED, SPENT, PAUSED };

/* What belongs to one thread, on cache lines of its own. */
typedef struct render_worker {
    SF_ALIGNED(sf_atomic_size) samples; /* traced so far */
    uint64_t done, met;                 /* pixels of the picture, by its decisions */
    sf_rng stream;                      /* seeds = thread, shared */
    sf_batch batch;
} render_worker;

typedef struct render {
    sf_render_context context;
    sf_render_options options;
    sf_film *film;
    sf_pool *pool;
    render_worker *workers;
    uint64_t *open;   /* pixels that are not done, by cell of the film: bit m is pixel m of the cell in
                         Morton order */
    uint64_t *active; /* of these, the ones that the lap brings on */
    uint32_t cell_columns, cell_rows;
    uint32_t tile_columns, tile_rows;
    uint32_t tile_x0, tile_y0; /* of the first tile, in cells of the frame */
    uint32_t tile_cells;       /* a side */
    uint32_t *tiles;           /* those with active pixels */
    size_t tile_count;
    uint32_t from, to; /* the round's sample counts; equal between rounds */
    uint32_t ahead;    /* after a pause or a resume pixels may have up to so many samples already */
    uint64_t region;   /* pixels traced */
    bool in_lap;       /* a lap has begun and not ended */
    uint32_t look;     /* where the lap ends, unless the render does */
    sf_lap lap;
    double target;     /* of a budget: half-widths beyond it are to be lowered */
    double *worst;     /* by tile: scratch of choosing pixels */
    uint32_t *least;
    size_t *chosen;
    bool level_fixed;
    double z;          /* standard errors in a half-width */
    double start, deadline;
    sf_progress progress;
    sf_atomic_size state;
    size_t sampled; /* the state in which the round's sampling ended: what decisions go by */
    double checkpoint_due;
    sf_status checkpoint_status; /* of the last write */
    sf_error checkpoint_error;
} render;

/* ---- the camera's frame ---- */

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int c = 0; c < 3; ++c) out[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

static double normalize(double v[3]) {
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int c = 0; c < 3; ++c) v[c] /= length;
    return length;
}

static sf_camera_frame frame_camera(const sf_camera *camera, uint32_t width, uint32_t height) {
    double forward[3], up[3], right[3], distance;
    for (int c = 0; c < 3; ++c) {
        forward[c] = (double)camera->target[c] - camera->position[c];
        up[c] = camera->up[c];
    }
    distance = normalize(forward);
    normalize(up);
    cross(forward, up, right);
    normalize(right);
    cross(right, forward, up);
    sf_camera_frame frame = {.half_width = 0.5f * (float)width,
                             .half_height = 0.5f * (float)height,
                             .pixel = (float)(2 * tan((double)camera->vertical_fov * 3.14159265358979323846 / 360) / height),
                             .aperture_radius = camera->aperture_radius,
                             .focus_distance = camera->focus_distance > 0 ? camera->focus_distance : (float)distance};
    for (int c = 0; c < 3; ++c) {
        frame.position[c] = camera->position[c];
        frame.forward[c] = (float)forward[c];
        frame.right[c] = (float)right[c];
        frame.up[c] = (float)up[c];
    }
    return frame;
}

static size_t cell_count(const render *r) { return (size_t)r->cell_columns * r->cell_rows; }

static uint64_t count_pixels(const render *r, const uint64_t *cells) {
    uint64_t count = 0;
    for (size_t i = 0; i < cell_count(r); ++i)
        count += sf_count_bits((uint32_t)cells[i]) + sf_count_bits((uint32_t)(cells[i] >> 32));
    return count;
}

/* ---- a round ---- */

static uint32_t cell_x(const render *r, uint32_t cell, uint32_t m) {
    return cell % r->cell_columns * SF_CELL_SIZE + sf_cell_x(m);
}
static uint32_t cell_y(const render *r, uint32_t cell, uint32_t m) {
    return cell / r->cell_columns * SF_CELL_SIZE + sf_cell_y(m);
}
static sf_film_pixel *cell_pixel(const render *r, uint32_t cell, uint32_t m) {
    return r->film->pixels + (size_t)cell_y(r, cell, m) * r->film->width + cell_x(r, cell, m);
}

static uint64_t taken(const sf_film_pixel *pixel) { return pixel->moments.count + pixel->moments.nonfinite; }

/* The most samples that a pixel may take. */
static uint32_t most_samples(const render *r) {
    const sf_render_options *o = &r->options;
    bool adaptive = o->relative_tolerance > 0 || o->absolute_tolerance > 0;
    return o->spp ? o->start + o->spp : adaptive ? o->max_spp : SF_MAX_SPP;
}

/* Adds the block to its pixel's statistics, and to what the stopping rule keeps. */
static void add_block(render *r, const sf_block *block, const sf_block_statistics *statistics) {
    sf_film_pixel *pixel = r->film->pixels + block->pixel;
    bool lap_begins = r->lap.levels && r->from && taken(pixel) == r->from && sf_stop_is_look(&r->options, r->from);
    if (lap_begins) sf_dyadic_begin(pixel);
    sf_film_add(pixel, statistics);
    const double *means = statistics->moments.mean;
    double mean = (means[0] + means[1] + means[2]) / 3;
    if (r->lap.levels) sf_dyadic_add(&pixel->evidence.dyadic, mean, block->number, r->lap);
    if (r->options.stop == SF_STOP_REPLICATES && block->number % SF_REPLICATES < SF_REPLICATES - 1)
        pixel->evidence.replicates[block->number % SF_REPLICATES] += mean;
}

/* Runs the blocks gathered so far and adds them to the film, in their order. */
static void flush_batch(render *r, render_worker *worker) {
    sf_batch *batch = &worker->batch;
    if (batch->block_count == 0) return;
    sf_batch_run(batch, &r->context);
    size_t samples = 0;
    for (uint32_t i = 0; i < batch->block_count; ++i) {
        add_block(r, batch->blocks + i, batch->statistics + i);
        samples += sf_count_bits(batch->blocks[i].active);
    }
    if (r->film->aovs) sf_aov_add(r->film->aovs, batch);
    batch->block_count = 0;
    sf_atomic_fetch_add(&worker->samples, samples);
    if (r->deadline > 0 && sf_seconds_now() >= r->deadline) sf_atomic_store(&r->state, OUT_OF_TIME);
}

/* The block of pixel m that starts at sample `n`. */
static sf_block make_block(const render *r, uint32_t cell, uint32_t m, uint64_t key, uint32_t n) {
    uint32_t x = cell_x(r, cell, m), y = cell_y(r, cell, m);
    uint32_t base = n / SF_LANES * SF_LANES, end = r->to - base < SF_LANES ? r->to - base : SF_LANES;
    sf_block block = {.key = key,
                      .base = base,
                      .active = ((1u << end) - 1) & ~((1u << (n - base)) - 1),
                      .x = x + r->film->x0,
                      .y = y + r->film->y0,
                      .pixel = y * r->film->width + x,
                      .number = base / SF_LANES};
    if (r->options.stop == SF_STOP_REPLICATES) { /* replicates take turns by the block */
        block.key = sf_hash64(key, block.number % SF_REPLICATES + 1);
        block.base = block.number / SF_REPLICATES * SF_LANES;
    }
    return block;
}

/* Where the block of pixel m that holds sample `n` goes on: after the samples that the pixel took
 * before a pause or a stop. At or past the block's end there is nothing left to take. */
static uint32_t skip_taken(const render *r, uint32_t cell, uint32_t m, uint32_t n) {
    if (r->from >= r->ahead) return n;
    uint64_t next = r->options.start + taken(cell_pixel(r, cell, m));
    return next > n ? (uint32_t)next : n;
}

static uint32_t block_end(const render *r, uint32_t n) {
    uint32_t end = n / SF_LANES * SF_LANES + SF_LANES;
    return end < r->to ? end : r->to;
}

static void choose_keys(render *r, render_worker *worker, uint32_t cell, uint64_t active, uint64_t keys[CELL_PIXELS]) {
    for (uint32_t m = 0; m < CELL_PIXELS; ++m) {
        if (!(active >> m & 1u)) continue;
        uint64_t x = cell_x(r, cell, m) + r->film->x0, y = cell_y(r, cell, m) + r->film->y0;
        keys[m] = r->options.seeds == SF_SEEDS_PIXEL ? sf_hash64(r->options.seed, y << 32 | x)
                                                     : sf_rng_next_raw(&worker->stream);
    }
}

static void sample_cell(render *r, render_worker *worker, uint32_t cell) {
    if (sf_atomic_load(&r->state) != RUNNING) return;
    uint64_t active = r->active[cell], keys[CELL_PIXELS];
    sf_batch *batch = &worker->batch;
    choose_keys(r, worker, cell, active, keys);
    for (uint32_t n = r->from; n < r->to; n = n / SF_LANES * SF_LANES + SF_LANES)
        for (uint32_t m = 0; m < CELL_PIXELS; ++m) {
            if (!(active >> m & 1u)) continue;
            uint32_t first = skip_taken(r, cell, m, n);
            if (first >= block_end(r, n)) continue;
            batch->blocks[batch->block_count++] = make_block(r, cell, m, keys[m], first);
            if (batch->block_count < SF_BLOCKS) continue;
            flush_batch(r, worker);
            if (sf_atomic_load(&r->state) != RUNNING) return;
        }
    flush_batch(r, worker);
}

/* The cells of a tile that are in the film: columns x0 .. x1 - 1, rows y0 .. y1 - 1 of it. */
typedef struct cell_range {
    uint32_t x0, y0, x1, y1;
} cell_range;

static uint32_t clamp_below(uint32_t value, uint32_t offset) { return value > offset ? value - offset : 0; }
static uint32_t at_most(uint32_t value, uint32_t limit) { return value < limit ? value : limit; }

static cell_range tile_range(const render *r, uint32_t tile) {
    uint32_t x0 = r->film->x0 / SF_CELL_SIZE, y0 = r->film->y0 / SF_CELL_SIZE;
    uint32_t left = r->tile_x0 + tile % r->tile_columns * r->tile_cells;
    uint32_t top = r->tile_y0 + tile / r->tile_columns * r->tile_cells;
    return (cell_range){.x0 = clamp_below(left, x0),
                        .y0 = clamp_below(top, y0),
                        .x1 = at_most(left + r->tile_cells - x0, r->cell_columns),
                        .y1 = at_most(top + r->tile_cells - y0, r->cell_rows)};
}

/* Calls `visit` for every cell of the tile that has a pixel in `cells`, r->active or r->open. */
static void for_each_cell(render *r, unsigned worker, uint32_t tile, const uint64_t *cells,
                          void (*visit)(render *, render_worker *, uint32_t)) {
    cell_range range = tile_range(r, tile);
    for (uint32_t y = range.y0; y < range.y1; ++y)
        for (uint32_t x = range.x0; x < range.x1; ++x)
            if (cells[(size_t)y * r->cell_columns + x])
                visit(r, r->workers + worker, y * r->cell_columns + x);
}

static void sample_tile(void *user, unsigned worker, size_t item) {
    render *r = user;
    if (sf_atomic_load(&r->state) == RUNNING) for_each_cell(r, worker, r->tiles[item], r->active, sample_cell);
}

/* ---- progress ---- */

static uint64_t samples_traced(const render *r) {
    uint64_t samples = 0;
    for (uint32_t i = 0; i < r->options.threads; ++i) samples += sf_atomic_load(&r->workers[i].samples);
    return samples;
}

static void report(render *r, bool round_finished) {
    if (!r->options.progress) return;
    sf_progress *p = &r->progress;
    p->samples = samples_traced(r);
    p->seconds = sf_seconds_now() - r->start;
    p->round_finished = round_finished;
    if (r->options.progress(p, r->options.progress_user) != 0) sf_atomic_store(&r->state, INTERRUPTED);
}

static void wake(void *user) { report(user, false); }

static void report_round(render *r) {
    sf_progress *p = &r->progress;
    p->round = r->film->summary.rounds;
    p->pixels_done = p->pixels_met = 0;
    for (uint32_t i = 0; i < r->options.threads; ++i) {
        p->pixels_done += r->workers[i].done;
        p->pixels_met += r->workers[i].met;
    }
    p->tolerance = fmax(r->film->summary.tolerance, 0);
    report(r, true);
}

/* ---- checkpoints ---- */

static sf_checkpoint list_checkpoint(render *r) {
    return (sf_checkpoint){.film = r->film, .open = r->open, .active = r->active, .cells = cell_count(r)};
}

/* Writes the state; a failure is a notice, and the next write is tried in its time. */
static void save_checkpoint(render *r) {
    const sf_render_options *o = &r->options;
    if (!o->checkpoint_path) return;
    const sf_film_summary *summary = &r->film->summary;
    sf_checkpoint checkpoint = list_checkpoint(r);
    checkpoint.state = (sf_round_state){.from = r->from,
                                        .to = r->to,
                                        .look = r->look,
                                        .in_lap = r->in_lap,
                                        .rounds = summary->rounds,
                                        .level_fixed = r->level_fixed,
                                        .level = summary->level,
                                        .tolerance = summary->tolerance,
                                        .target = r->target,
                                        .seconds = sf_seconds_now() - r->start,
                                        .traced_samples = samples_traced(r)};
    r->checkpoint_status = sf_checkpoint_save(&checkpoint, o->checkpoint_path, &r->checkpoint_error);
    if (r->checkpoint_status && o->notice) o->notice(r->checkpoint_error.message, o->notice_user);
    r->checkpoint_due = sf_seconds_now() + o->checkpoint_seconds;
}

static bool checkpoint_is_due(const render *r) {
    return r->options.checkpoint_path && sf_seconds_now() >= r->checkpoint_due;
}

static void wake_sampling(void *user) {
    render *r = user;
    report(r, false);
    if (checkpoint_is_due(r) && sf_atomic_load(&r->state) == RUNNING) sf_atomic_store(&r->state, PAUSED);
}

/* Takes the round's samples. A stop leaves the round where it is and writes that down, before
 * anything is decided on it; so does a checkpoint that is due, after which the round goes on. */
static void sample_round(render *r) {
    for (;;) {
        sf_pool_run(r->pool, r->tile_count, sample_tile, wake_sampling, r);
        r->sampled = sf_atomic_load(&r->state);
        if (r->sampled == RUNNING) return;
        r->ahead = r->to > r->ahead ? r->to : r->ahead;
        save_checkpoint(r);
        if (r->sampled != PAUSED) return;
        sf_atomic_store(&r->state, RUNNING);
    }
}

/* ---- decisions ---- */

static void look_at_pool(void *user, unsigned worker, size_t item) {
    (void)worker;
    render *r = user;
    sf_stop_look_at_pool(r->film, (uint32_t)item, r->look, r->lap);
}

/* Why a pixel that is not met is closed. */
static sf_stop_reason unmet_reason(const render *r, bool full, size_t state) {
    if (full) return r->options.spp ? SF_STOP_FIXED : SF_STOP_MAX_SAMPLES;
    if (state == OUT_OF_TIME) return SF_STOP_OUT_OF_TIME;
    return state == INTERRUPTED ? SF_STOP_INTERRUPTED : SF_STOP_MAX_SAMPLES; /* a budget of samples is spent */
}

/* Whether the pixel is done, and why. */
static bool decide_pixel(const render *r, uint32_t x, uint32_t y, size_t state) {
    sf_film_pixel *pixel = r->film->pixels + (size_t)y * r->film->width + x;
    const sf_render_options *o = &r->options;
    const sf_film_summary *summary = &r->film->summary;
    bool full = taken(pixel) + o->start >= most_samples(r);
    if (o->start + taken(pixel) > r->to && state == RUNNING) return false; /* decided here before, by an easier tolerance */
    if (o->spp && !full && state == RUNNING) return false; /* nothing to tell before the end */
    if (taken(pixel) == 0 && state != RUNNING) return true; /* not a page of it is touched; see close_all */
    pixel->half_width = sf_stop_half_width(r->film, o, x, y, r->z);
    bool met = !o->spp && summary->tolerance >= 0 && taken(pixel) >= o->min_spp &&
               (double)pixel->half_width <= summary->tolerance;
    if (!met && !full && state == RUNNING) return false;
    sf_stop_reason reason = met ? SF_STOP_MET : unmet_reason(r, full, state);
    pixel->reason = (uint8_t)(pixel->moments.nonfinite ? SF_STOP_SUSPICIOUS : reason);
    return true;
}

static void decide_cell(render *r, render_worker *worker, uint32_t cell) {
    (void)worker;
    for (uint32_t m = 0; m < CELL_PIXELS; ++m)
        if (r->active[cell] >> m & 1u && decide_pixel(r, cell_x(r, cell, m), cell_y(r, cell, m), r->sampled))
            r->open[cell] &= ~(UINT64_C(1) << m);
}

/* Whether the pixel is of the picture, not of the margin that was traced with it. */
static bool counts(const sf_film *film, const sf_film_pixel *pixel) {
    uint32_t i = (uint32_t)(pixel - film->pixels);
    uint32_t x = i % film->width + film->x0 - film->crop_x0, y = i / film->width + film->y0 - film->crop_y0;
    return x < film->crop_width && y < film->crop_height && sf_film_counts(film, x, y);
}

/* Decides, and counts the pixels of the picture that are done. */
static void settle_cell(render *r, render_worker *worker, uint32_t cell) {
    uint64_t before = r->active[cell];
    decide_cell(r, worker, cell);
    uint64_t done = before & ~r->open[cell];
    for (uint32_t m = 0; done; ++m, done >>= 1) {
        const sf_film_pixel *pixel = cell_pixel(r, cell, m);
        if (!(done & 1u) || !counts(r->film, pixel)) continue;
        ++worker->done;
        worker->met += pixel->reason == SF_STOP_MET;
    }
}

static void decide_tile(void *user, unsigned worker, size_t item) {
    render *r = user;
    for_each_cell(r, worker, r->tiles[item], r->active, settle_cell);
}

static void sum_row(void *user, unsigned worker, size_t item) {
    (void)worker;
    sf_film_sum_row(((render *)user)->film, (uint32_t)item);
}

static void measure_level(render *r) {
    sf_pool_run(r->pool, r->film->crop_height, sum_row, wake, r);
    r->film->summary.level = sf_film_level(r->film);
}

static void resolve_row(void *user, unsigned worker, size_t item) {
    (void)worker;
    sf_film_resolve_row(((render *)user)->film, (uint32_t)item);
}

/* The tolerance at the level that was fixed. A negative one: none was asked. */
static void set_tolerance(render *r) {
    const sf_render_options *o = &r->options;
    sf_film_summary *summary = &r->film->summary;
    if (o->relative_tolerance > 0 || o->absolute_tolerance > 0)
        summary->tolerance = fmax(o->absolute_tolerance, o->relative_tolerance * summary->level);
}

/* Fixes level and tolerance after the first min_spp samples. */
static void fix_tolerance(render *r) {
    const sf_render_options *o = &r->options;
    if ((r->to < o->min_spp && r->to < most_samples(r)) || r->level_fixed) return;
    r->level_fixed = true;
    measure_level(r);
    set_tolerance(r);
}

/* Looks at the lap's pixels where the rule can, and closes those that are done. */
static void decide(render *r) {
    fix_tolerance(r);
    if (r->lap.levels && r->to == r->look && sf_stop_is_look(&r->options, r->look))
        sf_pool_run(r->pool, sf_stop_pool_count(r->film), look_at_pool, wake, r);
    sf_pool_run(r->pool, r->tile_count, decide_tile, wake, r);
}

/* ---- which pixels ---- */

static bool tile_has(const render *r, uint32_t tile, const uint64_t *cells) {
    cell_range range = tile_range(r, tile);
    for (uint32_t y = range.y0; y < range.y1; ++y)
        for (uint32_t x = range.x0; x < range.x1; ++x)
            if (cells[(size_t)y * r->cell_columns + x]) return true;
    return false;
}

static void list_tiles(render *r) {
    r->tile_count = 0;
    for (uint32_t tile = 0; tile < r->tile_columns * r->tile_rows; ++tile)
        if (tile_has(r, tile, r->active)) r->tiles[r->tile_count++] = tile;
}

/* The least count and the largest half-width among a tile's open pixels beyond the target. */
static void survey_tile(void *user, unsigned worker, size_t tile) {
    (void)worker;
    render *r = user;
    cell_range range = tile_range(r, (uint32_t)tile);
    uint32_t least = UINT32_MAX;
    double worst = 0;
    for (uint32_t y = range.y0; y < range.y1; ++y)
        for (uint32_t x = range.x0; x < range.x1; ++x) {
            uint32_t cell = y * r->cell_columns + x;
            for (uint32_t m = 0; m < CELL_PIXELS; ++m) {
                if (!(r->open[cell] >> m & 1u)) continue;
                const sf_film_pixel *pixel = cell_pixel(r, cell, m);
                double width = (double)pixel->half_width;
                worst = width > worst ? width : worst;
                if (width > r->target && taken(pixel) < least) least = (uint32_t)taken(pixel);
            }
        }
    r->least[tile] = least;
    r->worst[tile] = worst;
}

/* Activates a tile's open pixels that have `from` samples and are beyond the target. */
static void choose_tile(void *user, unsigned worker, size_t tile) {
    (void)worker;
    render *r = user;
    cell_range range = tile_range(r, (uint32_t)tile);
    r->chosen[tile] = 0;
    for (uint32_t y = range.y0; y < range.y1; ++y)
        for (uint32_t x = range.x0; x < range.x1; ++x) {
            uint32_t cell = y * r->cell_columns + x;
            r->active[cell] = 0;
            for (uint32_t m = 0; m < CELL_PIXELS; ++m) {
                if (!(r->open[cell] >> m & 1u)) continue;
                const sf_film_pixel *pixel = cell_pixel(r, cell, m);
                if (taken(pixel) != r->from || !((double)pixel->half_width > r->target)) continue;
                r->active[cell] |= UINT64_C(1) << m;
                ++r->chosen[tile];
            }
        }
}

static uint64_t choose_beyond(render *r, double target) {
    size_t tiles = (size_t)r->tile_columns * r->tile_rows;
    uint64_t count = 0;
    r->target = target;
    sf_pool_run(r->pool, tiles, choose_tile, wake, r);
    for (size_t tile = 0; tile < tiles; ++tile) count += r->chosen[tile];
    return count;
}

/* Keeps, of the chosen pixels, as many as a budget of samples still pays for: those with the
 * largest half-widths. False: of none. */
static bool keep_within_samples(render *r, uint64_t count) {
    if (!r->options.samples) return true;
    uint64_t left = r->options.samples - samples_traced(r);
    uint32_t step = r->look - r->from;
    if (r->from == 0 && left / count < step) { /* not even a first look: as far as it goes, together */
        r->look = (uint32_t)(left / count);
        return true;
    }
    if (count <= left / step) return true;
    double low = r->target, high = 0;
    for (size_t t = 0; t < (size_t)r->tile_columns * r->tile_rows; ++t) high = fmax(high, r->worst[t]);
    for (int halving = 0; halving < 40; ++halving) {
        double middle = low + (high - low) / 2;
        if (choose_beyond(r, middle) > left / step)
            low = middle;
        else
            high = middle;
    }
    return choose_beyond(r, high) > 0;
}

/* Chooses the pixels of the next lap of a budget. */
static bool choose_by_budget(render *r) {
    size_t tiles = (size_t)r->tile_columns * r->tile_rows;
    for (;;) {
        uint32_t least = UINT32_MAX;
        double worst = 0;
        sf_pool_run(r->pool, tiles, survey_tile, wake, r);
        for (size_t tile = 0; tile < tiles; ++tile) {
            least = r->least[tile] < least ? r->least[tile] : least;
            worst = fmax(worst, r->worst[tile]);
        }
        if (least < UINT32_MAX) {
            r->from = least;
            r->look = sf_stop_next_look(&r->options, r->from);
            return keep_within_samples(r, choose_beyond(r, r->target));
        }
        if (!(worst > 0)) return false;
        r->target = fmin(r->target, worst) * 0.7; /* half the variance, nearly */
    }
}

/* Sets the next lap: its pixels, where it begins and where it looks. False: nothing is left. */
static bool begin_lap(render *r) {
    bool budget = !r->options.spp && !(r->options.relative_tolerance > 0 || r->options.absolute_tolerance > 0);
    if (budget) {
        if (!choose_by_budget(r)) return false;
    } else {
        r->from = r->to;
        r->look = sf_stop_next_look(&r->options, r->from);
        memcpy(r->active, r->open, cell_count(r) * sizeof *r->active);
    }
    r->to = r->from;
    r->lap = sf_stop_lap(&r->options, r->look);
    list_tiles(r);
    r->in_lap = r->tile_count > 0;
    return r->in_lap;
}

/* ---- rounds ---- */

/* Where the next round of the lap ends: with a clock to watch, rounds are short. */
static uint32_t round_end(const render *r) {
    uint32_t end = r->look < most_samples(r) ? r->look : most_samples(r);
    if (r->options.seconds == 0) return end;
    uint32_t step = r->from / 4 / SF_LANES * SF_LANES;
    step = step < SF_LANES ? SF_LANES : step > 256 ? 256 : step;
    uint32_t target = r->from / SF_LANES * SF_LANES + step;
    return target < end ? target : end;
}

/* Closes what is still open: time is up, a budget is spent, or the caller asked to stop. */
static void close_all(render *r) {
    if (sf_atomic_load(&r->state) == RUNNING) sf_atomic_store(&r->state, SPENT);
    r->sampled = sf_atomic_load(&r->state);
    r->film->untouched = (uint8_t)unmet_reason(r, false, r->sampled);
    memcpy(r->active, r->open, cell_count(r) * sizeof *r->active);
    list_tiles(r);
    sf_pool_run(r->pool, r->tile_count, decide_tile, wake, r);
}

/* One round of the lap. A stop within it leaves it as it is, written down. */
static void run_round(render *r) {
    if (r->from == r->to) r->to = round_end(r);
    sample_round(r);
    if (r->sampled != RUNNING) return;
    r->in_lap = !(r->to == r->look || r->to == most_samples(r));
    if (!r->in_lap) decide(r);
    r->from = r->to;
    ++r->film->summary.rounds;
    report_round(r);
    if (sf_atomic_load(&r->state) != RUNNING || checkpoint_is_due(r)) save_checkpoint(r);
}

static void run_rounds(render *r) {
    while (sf_atomic_load(&r->state) == RUNNING) {
        if (!r->in_lap && !begin_lap(r)) {
            r->in_lap = false;
            save_checkpoint(r);
            break;
        }
        run_round(r);
    }
    close_all(r);
    if (r->film->summary.tolerance < 0) r->film->summary.tolerance = 0;
}

/* ---- the whole ---- */

/* The pixels of a cell of which `width` columns and `height` rows lie in the film. */
static uint64_t pixels_inside(uint32_t width, uint32_t height) {
    if (width >= SF_CELL_SIZE && height >= SF_CELL_SIZE) return UINT64_MAX;
    uint64_t inside = 0;
    for (uint32_t m = 0; m < CELL_PIXELS; ++m)
        if (sf_cell_x(m) < width && sf_cell_y(m) < height) inside |= UINT64_C(1) << m;
    return inside;
}

static void open_all(render *r) {
    for (uint32_t y = 0; y < r->cell_rows; ++y)
        for (uint32_t x = 0; x < r->cell_columns; ++x)
            r->open[(size_t)y * r->cell_columns + x] =
                sf_mask_touches_cell(&r->options, r->film->x0 + x * SF_CELL_SIZE, r->film->y0 + y * SF_CELL_SIZE)
                    ? pixels_inside(r->film->width - x * SF_CELL_SIZE, r->film->height - y * SF_CELL_SIZE)
                    : 0;
}

static sf_status lay_out_cells(render *r, sf_error *error) {
    const sf_film *film = r->film;
    r->cell_columns = (film->width + SF_CELL_SIZE - 1) / SF_CELL_SIZE;
    r->cell_rows = (film->height + SF_CELL_SIZE - 1) / SF_CELL_SIZE;
    r->tile_cells = r->options.tile_size / SF_CELL_SIZE;
    uint32_t x0 = film->x0 / SF_CELL_SIZE, y0 = film->y0 / SF_CELL_SIZE;
    r->tile_x0 = x0 / r->tile_cells * r->tile_cells;
    r->tile_y0 = y0 / r->tile_cells * r->tile_cells;
    r->tile_columns = (x0 + r->cell_columns - r->tile_x0 + r->tile_cells - 1) / r->tile_cells;
    r->tile_rows = (y0 + r->cell_rows - r->tile_y0 + r->tile_cells - 1) / r->tile_cells;
    size_t cells = cell_count(r), tiles = (size_t)r->tile_columns * r->tile_rows;
    r->open = malloc(cells * sizeof *r->open);
    r->active = malloc(cells * sizeof *r->active);
    r->tiles = malloc(tiles * sizeof *r->tiles);
    r->least = malloc(tiles * sizeof *r->least);
    r->worst = malloc(tiles * sizeof *r->worst);
    r->chosen = malloc(tiles * sizeof *r->chosen);
    if (!r->open || !r->active || !r->tiles || !r->least || !r->worst || !r->chosen)
        return sf_fail_memory(error, "the lists of cells and tiles", cells * 16 + tiles * 24);
    memset(r->active, 0, cells * sizeof *r->active);
    open_all(r);
    return SF_STATUS_OK;
}

static sf_status hire_workers(render *r, sf_error *error) {
    size_t bytes = r->options.threads * sizeof *r->workers;
    r->workers = sf_aligned_alloc(bytes);
    if (!r->workers) return sf_fail_memory(error, "the threads' batches", bytes);
    memset(r->workers, 0, bytes);
    for (uint32_t i = 0; i < r->options.threads; ++i) {
        uint64_t stream = r->options.seeds == SF_SEEDS_THREAD ? i : 0;
        sf_status status = sf_rng_init(&r->workers[i].stream, SF_RNG_XOSHIRO256PP, r->options.seed, stream, error);
        if (status) return status;
        if (r->context.aovs & SF_AOVS_OF_HITS) r->workers[i].batch.hit_sums = r->film->aovs->hits + (size_t)i * SF_BLOCKS;
    }
    return sf_pool_create(r->options.threads, &r->pool, error);
}

static sf_status prepare(render *r, sf_error *error) {
    const sf_scene *scene = r->context.scene;
    const sf_render_options *o = &r->options;
    sf_status status = sf_coordinates_init(&r->context.coordinates, o->pattern, &scene->plan, o->spp, o->seed, error);
    if (!status) status = sf_film_create(o, &r->film, error);
    r->context.aovs = o->aovs;
    if (!status) status = lay_out_cells(r, error);
    if (!status) status = hire_workers(r, error);
    if (status) return status;
    uint64_t traced = count_pixels(r, r->open);
    if (o->samples && o->samples < traced)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "samples is %" PRIu64 "; at least one for each of %" PRIu64 " pixels is allowed",
                       o->samples, traced);
    r->context.camera = frame_camera(&scene->camera, o->width, o->height);
    r->context.filter = o->pixel_filter;
    r->context.seeds = o->seeds;
    r->context.isa = sf_isa_active();
    r->z = r->film->factor = sf_stop_factor(o);
    r->deadline = o->seconds > 0 ? r->start + o->seconds : 0;
    r->progress.pixels = r->film->counted;
    r->progress.expected_samples = o->spp * count_pixels(r, r->open);
    r->progress.time_limit = o->seconds;
    r->region = count_pixels(r, r->open);
    r->from = r->to = o->start;
    r->film->summary.tolerance = -1;
    r->target = -1;
    return sf_film_identify(r->film, scene, r->context.isa, error);
}

/* The largest index that any pixel's next sample has. */
static uint32_t furthest(const render *r) {
    const sf_film *film = r->film;
    uint64_t most = 0;
    for (size_t i = 0; i < (size_t)film->width * film->height; ++i) {
        if (taken(film->pixels + i) > most) most = taken(film->pixels + i);
    }
    most += r->options.start;
    return most < SF_MAX_SPP ? (uint32_t)most : SF_MAX_SPP;
}

/* What the checkpoint holds becomes the render's. Where more is asked for, every pixel takes part
 * again from the first round on: rounds add nothing to the pixels that have gone beyond them, and
 * decide nothing there, so that a pixel goes on from where it stopped, on the looks of a render
 * that had been asked for as much from the start. */
static void adopt_checkpoint(render *r, const sf_round_state *state, bool extended) {
    sf_film_summary *summary = &r->film->summary;
    r->from = state->from;
    r->to = state->to;
    r->look = state->look;
    r->target = state->target;
    r->in_lap = state->in_lap != 0;
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
        if (r->level_fixed) set_tolerance(r);
    }
    r->lap = sf_stop_lap(&r->options, r->look);
    list_tiles(r);
    r->progress.round = summary->rounds;
    r->workers[0].done = (r->region - count_pixels(r, r->open)) * r->progress.pixels / r->region;
}

static sf_status resume(render *r, sf_error *error) {
    const char *path = r->options.checkpoint_path;
    if (!path) return SF_STATUS_OK;
    sf_checkpoint checkpoint = list_checkpoint(r);
    sf_resume kind;
    sf_status status = sf_checkpoint_restore(&checkpoint, path, &kind, error);
    if (!status && kind != SF_RESUME_NONE) adopt_checkpoint(r, &checkpoint.state, kind == SF_RESUME_EXTENDED);
    r->deadline = r->options.seconds > 0 ? r->start + r->options.seconds : 0;
    r->checkpoint_due = sf_seconds_now() + r->options.checkpoint_seconds;
    return status;
}

static void finish(render *r) {
    sf_film_summary *summary = &r->film->summary;
    summary->traced_samples = samples_traced(r);
    summary->confidence = r->options.confidence;
    summary->threads = r->options.threads;
    if (!r->level_fixed) measure_level(r);
    sf_pool_run(r->pool, r->film->crop_height, resolve_row, wake, r);
    sf_film_summarize_rows(r->film);
    summary->seconds = sf_seconds_now() - r->start;
}

sf_status sf_render(const sf_scene *scene, const sf_render_options *options, sf_film **film, sf_error *error) {
    *film = NULL;
    sf_plan plan;
    sf_status status = sf_scene_get_plan(scene, &plan, error); /* refuses a scene that is not committed */
    if (status) return status;
    render *r = calloc(1, sizeof *r);
    if (!r) return sf_fail_memory(error, "a render", sizeof *r);
    r->start = sf_seconds_now();
    r->context.scene = scene;
    r->options = *options;
    status = sf_render_options_complete(&r->options, error);
    if (!status) status = prepare(r, error);
    if (!status) status = resume(r, error);
    if (!status) {
        run_rounds(r);
        finish(r);
        status = sf_film_describe(r->film, error);
    }
    sf_pool_destroy(r->pool);
    sf_aligned_free(r->workers);
    free(r->open);
    free(r->active);
    free(r->tiles);
    free(r->least);
    free(r->worst);
    free(r->chosen);
    if (status)
        sf_film_destroy(r->film);
    else
        *film = r->film;
    if (!status && r->checkpoint_status) status = sf_fail(error, r->checkpoint_status, "%s", r->checkpoint_error.message);
    free(r);
    return status;
}
