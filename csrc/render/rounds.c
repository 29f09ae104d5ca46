// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Rounds over tiles, decisions between them, and the checkpoints that either leaves. */
#include "render/rounds.h"

#include <math.h>
#include <string.h>

#include "film/aov.h"
#include "film/film_looks.h"
#include "render/checkpoint.h"
#include "render/pixel_selection.h"
#include "render/progress.h"
#include "render/relmse_target.h"

/* ---- checkpoints ---- */

sf_checkpoint sf_rounds_checkpoint(sf_rounds *r) {
    return (sf_checkpoint){
        .film = r->film, .open = r->open, .active = r->active, .notes = sf_relmse_target_notes(r->goal)};
}

/* Writes the state; a failure is a notice, and the next write is tried in its time. */
static void save_checkpoint(sf_rounds *r) {
    const sf_render_options *o = &r->options;
    if (!o->checkpoint_path) return;
    const sf_film_summary *summary = &r->film->summary;
    sf_checkpoint checkpoint = sf_rounds_checkpoint(r);
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
                                        .traced_samples = sf_rounds_samples(r),
                                        .second = r->second};
    r->checkpoint_status = sf_checkpoint_save(&checkpoint, o->checkpoint_path, &r->checkpoint_error);
    if (r->checkpoint_status && o->notice) o->notice(r->checkpoint_error.message, o->notice_user);
    r->checkpoint_due = sf_seconds_now() + o->checkpoint_seconds;
}

static bool checkpoint_is_due(const sf_rounds *r) {
    return r->options.checkpoint_path && sf_seconds_now() >= r->checkpoint_due;
}

static void wake_sampling(void *user) {
    sf_rounds *r = user;
    sf_rounds_wake(r);
    if (checkpoint_is_due(r) && sf_atomic_load(&r->state) == SF_RUNNING) sf_atomic_store(&r->state, SF_PAUSED);
}

/* Takes the round's samples. A stop leaves the round where it is and writes that down, before
 * anything is decided on it; so does a checkpoint that is due, after which the round goes on. */
static void sample_round(sf_rounds *r) {
    for (;;) {
        sf_thread_pool_run(r->pool, r->tile_count, sf_rounds_sample_tile, wake_sampling, r);
        r->sampled = sf_atomic_load(&r->state);
        if (r->sampled == SF_RUNNING) return;
        r->ahead = r->to > r->ahead ? r->to : r->ahead;
        save_checkpoint(r);
        if (r->sampled != SF_PAUSED) return;
        sf_atomic_store(&r->state, SF_RUNNING);
    }
}

/* ---- decisions ---- */

static bool pool_is_active(const sf_rounds *r, uint32_t pool) {
    sf_pool_range range = sf_film_pool_range(r->film, pool);
    for (uint32_t y = range.y0 / SF_CELL_SIZE; y * SF_CELL_SIZE < range.y1; ++y)
        for (uint32_t x = range.x0 / SF_CELL_SIZE; x * SF_CELL_SIZE < range.x1; ++x)
            if (r->active[(size_t)y * r->film->cell_columns + x]) return true;
    return false;
}

static void look_at_pool(void *user, unsigned worker, size_t item) {
    (void)worker;
    sf_rounds *r = user;
    if (!pool_is_active(r, (uint32_t)item)) return;
    sf_film_look_at_pool(r->film, (uint32_t)item, r->look, r->pairing);
}

/* Why a pixel that is not met is closed. */
static sf_stop_reason unmet_reason(const sf_rounds *r, bool full, size_t state) {
    if (full) return r->options.spp ? SF_STOP_REASON_FIXED : SF_STOP_REASON_MAX_SAMPLES;
    if (state == SF_OUT_OF_TIME) return SF_STOP_REASON_OUT_OF_TIME;
    return state == SF_INTERRUPTED ? SF_STOP_REASON_INTERRUPTED
                                   : SF_STOP_REASON_MAX_SAMPLES; /* a budget of samples is spent */
}

/* Whether the pixel's second set is done; half-width and reason are the pilot's, but where it is not. */
static bool decide_second(const sf_rounds *r, sf_film_pixel *pixel, size_t state) {
    bool full = sf_stop_second_is_full(pixel);
    if (!full && state == SF_RUNNING) return false;
    if (sf_film_taken(pixel) == 0) pixel->reason = 0; /* to be told as untouched */
    if (!full && sf_film_taken(pixel)) {
        pixel->half_width = sf_film_half_width(pixel, sf_normal_factor(r->options.confidence));
        pixel->look = 0; /* it is no look's */
        pixel->reason = (uint8_t)unmet_reason(r, false, state);
    }
    if (pixel->moments.nonfinite) pixel->reason = SF_STOP_REASON_SUSPICIOUS;
    return true;
}

/* Whether the pixel is done, and why. */
static bool decide_pixel(sf_rounds *r, uint32_t x, uint32_t y, size_t state) {
    sf_film_pixel *pixel = sf_film_at(r->film, x, y);
    const sf_render_options *o = &r->options;
    const sf_film_summary *summary = &r->film->summary;
    if (r->second) return decide_second(r, pixel, state);
    bool full = sf_film_taken(pixel) + o->start >= sf_rounds_most(r);
    if (o->start + sf_film_taken(pixel) > r->to && state == SF_RUNNING)
        return false;                                                  /* decided here before, by an easier tolerance */
    if (sf_film_taken(pixel) == 0 && state != SF_RUNNING) return true; /* not a page of it is touched; see close_all */
    pixel->half_width = sf_film_half_width_at(r->film, x, y);
    bool met = !o->spp && summary->tolerance >= 0 && sf_film_taken(pixel) >= o->min_spp &&
               (double)pixel->half_width <= summary->tolerance;
    if (r->goal) { /* no pixel is met before the whole picture is */
        sf_relmse_target_take_note(r->goal, r->film, x, y);
        met = state == SF_SPENT && sf_relmse_target_is_reached(r->goal);
    }
    if (!met && !full && state == SF_RUNNING) return false;
    sf_stop_reason reason = met ? SF_STOP_REASON_MET : unmet_reason(r, full, state);
    bool doubted = pixel->doubt && (reason == SF_STOP_REASON_MAX_SAMPLES || reason == SF_STOP_REASON_OUT_OF_TIME);
    pixel->reason = (uint8_t)(pixel->moments.nonfinite || doubted ? SF_STOP_REASON_SUSPICIOUS : reason);
    return true;
}

/* Closes the pixels that are done, and counts those of the picture. */
static void decide_cell(void *user, unsigned worker, uint32_t cell) {
    sf_rounds *r = user;
    uint32_t x0 = sf_rounds_x(r, cell, 0), y0 = sf_rounds_y(r, cell, 0);
    for (uint32_t y = y0; y < y0 + SF_CELL_SIZE; ++y) /* row by row, as they lie in memory */
        for (uint32_t x = x0; x < x0 + SF_CELL_SIZE; ++x) {
            uint64_t bit = UINT64_C(1) << sf_cell_number(x, y);
            if (!(r->active[cell] & bit) || !decide_pixel(r, x, y, r->sampled)) continue;
            r->open[cell] &= ~bit;
            if (!sf_rounds_in_picture(r, x, y)) continue;
            ++r->workers[worker].done;
            r->workers[worker].met += sf_film_at(r->film, x, y)->reason == SF_STOP_REASON_MET;
        }
}

static void decide_tile(void *user, unsigned worker, size_t item) {
    sf_rounds *r = user;
    sf_rounds_each_cell(r, r->tiles[item], r->active, decide_cell, r, worker);
}

static void sum_row(void *user, unsigned worker, size_t item) {
    (void)worker;
    sf_film_sum_row(((sf_rounds *)user)->film, (uint32_t)item);
}

void sf_rounds_measure_level(sf_rounds *r) {
    sf_thread_pool_run(r->pool, r->film->crop_height, sum_row, sf_rounds_wake, r);
    r->film->summary.level = sf_film_level(r->film);
}

/* The tolerance at the level that was fixed. A negative one: none was asked. */
void sf_rounds_set_tolerance(sf_rounds *r) {
    const sf_render_options *o = &r->options;
    sf_film_summary *summary = &r->film->summary;
    if (sf_has_tolerance(o)) summary->tolerance = fmax(o->absolute_tolerance, o->relative_tolerance * summary->level);
}

/* Fixes level and tolerance after the first min_spp samples. */
static void fix_tolerance(sf_rounds *r) {
    const sf_render_options *o = &r->options;
    if ((r->to < o->min_spp && r->to < sf_rounds_most(r)) || r->level_fixed) return;
    r->level_fixed = true;
    sf_rounds_measure_level(r);
    sf_rounds_set_tolerance(r);
}

/* Looks at the lap's pixels where the rule can, and closes those that are done. */
static void decide(sf_rounds *r) {
    fix_tolerance(r);
    if (r->pairing.levels && r->to == r->look && sf_stop_is_look(&r->options, r->look))
        sf_thread_pool_run(r->pool, sf_film_pool_count(r->film), look_at_pool, sf_rounds_wake, r);
    if (r->options.spp && r->to < sf_rounds_most(r))
        return; /* of a fixed count there is nothing to tell before its end */
    sf_thread_pool_run(r->pool, r->tile_count, decide_tile, sf_rounds_wake, r);
}

/* ---- laps ---- */

static bool tile_has(const sf_rounds *r, uint32_t tile, const uint64_t *cells) {
    sf_cell_range range = sf_rounds_tile(r, tile);
    for (uint32_t y = range.y0; y < range.y1; ++y)
        for (uint32_t x = range.x0; x < range.x1; ++x)
            if (cells[(size_t)y * r->film->cell_columns + x]) return true;
    return false;
}

void sf_rounds_list_tiles(sf_rounds *r) {
    r->tile_count = 0;
    for (uint32_t tile = 0; tile < r->tile_columns * r->tile_rows; ++tile)
        if (tile_has(r, tile, r->active)) r->tiles[r->tile_count++] = tile;
}

/* Begins the lap that the selection returns. False: nothing is left. */
static bool begin_lap(sf_rounds *r) {
    sf_lap lap = sf_select_lap(r, r->active);
    r->target = lap.target;
    if (r->goal) r->progress.relmse = sf_relmse_target_estimate(r->goal);
    if (r->goal) r->beyond = sf_relmse_target_beyond(r->goal);
    r->in_lap = lap.begins;
    r->from = lap.begins ? lap.from : r->to;
    if (!lap.begins) return false;
    sf_rounds_list_tiles(r);
    r->to = r->from;
    r->look = lap.look;
    r->pairing = r->second ? (sf_pairing){0, 0} : sf_stop_pairing(&r->options, r->look);
    return true;
}

/* ---- rounds ---- */

/* Where the next round of the lap ends: with a clock to watch, rounds are short. */
static uint32_t round_end(const sf_rounds *r) {
    uint32_t end = r->look < sf_rounds_most(r) ? r->look : sf_rounds_most(r);
    if (r->options.seconds == 0) return end;
    uint32_t target = sf_stop_quarter_more(r->from);
    return target < end ? target : end;
}

/* Closes what is still open: time is up, a budget is spent, or the caller asked to stop. */
static void close_all(sf_rounds *r) {
    if (sf_atomic_load(&r->state) == SF_RUNNING) sf_atomic_store(&r->state, SF_SPENT);
    r->sampled = sf_atomic_load(&r->state);
    bool spent = r->second && r->sampled == SF_SPENT; /* what the pilot left out keeps its reason */
    if (!spent) r->film->untouched = (uint8_t)unmet_reason(r, false, r->sampled);
    memcpy(r->active, r->open, sf_film_cell_count(r->film) * sizeof *r->active);
    sf_rounds_list_tiles(r);
    sf_thread_pool_run(r->pool, r->tile_count, decide_tile, sf_rounds_wake, r);
}

/* One round of the lap. A stop within it leaves it as it is, written down. */
static void run_round(sf_rounds *r) {
    if (r->from == r->to) r->to = round_end(r);
    sample_round(r);
    if (r->sampled != SF_RUNNING) return;
    r->in_lap = !(r->to == r->look || r->to == sf_rounds_most(r));
    if (!r->in_lap) decide(r);
    r->from = r->to;
    ++r->film->summary.rounds;
    sf_rounds_report_round(r);
    if (sf_atomic_load(&r->state) != SF_RUNNING || checkpoint_is_due(r)) save_checkpoint(r);
}

/* Laps until no pixel is open, or the state is no longer running; closes the rest. */
static void run_stage(sf_rounds *r) {
    while (sf_atomic_load(&r->state) == SF_RUNNING) {
        if (!r->in_lap && !begin_lap(r)) {
            save_checkpoint(r);
            break;
        }
        run_round(r);
    }
    close_all(r);
}

/* From the pilot to the second set: every pixel is to have as many samples again, and begins anew. */
static void begin_second(sf_rounds *r) {
    sf_film *film = r->film;
    for (uint32_t cell = 0; cell < sf_film_cell_count(r->film); ++cell) {
        for (uint32_t m = 0; m < SF_CELL_PIXELS; ++m) {
            uint32_t x = sf_rounds_x(r, cell, m), y = sf_rounds_y(r, cell, m);
            if (x >= film->width || y >= film->height) continue;
            sf_film_pixel *pixel = sf_film_at(film, x, y);
            uint64_t planned = sf_film_taken(pixel);
            if (planned == 0) continue;
            memset(&pixel->moments, 0, sizeof pixel->moments);
            memset(&pixel->evidence, 0, sizeof pixel->evidence);
            pixel->hits = 0;
            pixel->evidence.planned = (double)planned;
            r->open[cell] |= UINT64_C(1) << m;
        }
    }
    if (film->aovs) sf_aov_reset(film);
    for (uint32_t i = 0; i < r->options.threads; ++i) r->workers[i].done = r->workers[i].met = 0;
    r->second = true;
    r->from = r->to = r->ahead = 0;
    r->in_lap = false;
    sf_rounds_set_deadline(r);
    sf_atomic_store(&r->state, SF_RUNNING);
}

void sf_rounds_run(sf_rounds *r) {
    bool pilot = r->options.unbiased && !r->second;
    run_stage(r);
    if (pilot && (r->sampled == SF_INTERRUPTED || sf_atomic_load(&r->state) == SF_INTERRUPTED)) {
        sf_film_mark_pilot(r->film);
    } else if (pilot) {
        begin_second(r);
        run_stage(r);
    }
    if (r->film->summary.tolerance < 0) r->film->summary.tolerance = 0;
}
