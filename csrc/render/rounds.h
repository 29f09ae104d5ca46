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
 * brought on, the least sampled first, until none is, and the target falls. So it is with a goal
 * for the whole picture, whose threshold of gain is told from it; see relmse_target.h. */
#ifndef SUNFLECK_ROUNDS_H
#define SUNFLECK_ROUNDS_H

#include "base/parallel.h"
#include "film/film_internal.h"
#include "film/stopping.h"
#include "sunfleck/rng.h"
#include "trace/batch.h"

struct sf_checkpoint;
struct sf_relmse_target;

#define SF_CELL_PIXELS (SF_CELL_SIZE * SF_CELL_SIZE)

enum { SF_RUNNING = 0, SF_OUT_OF_TIME, SF_INTERRUPTED, SF_SPENT, SF_PAUSED };

/* What belongs to one thread, on cache lines of its own. */
typedef struct sf_rounds_worker {
    SF_ALIGNED(sf_atomic_size) samples; /* traced so far */
    uint64_t done, met;                 /* pixels of the picture, by its decisions */
    double worst;                       /* these three are pixel_selection.c's, of the pixels it surveyed */
    uint32_t least;
    uint64_t chosen;
    sf_rng stream; /* seeds = thread, shared */
    sf_batch batch;
} sf_rounds_worker;

typedef struct sf_rounds {
    sf_render_context context;
    sf_render_options options;
    sf_film *film;
    sf_thread_pool *pool;
    sf_rounds_worker *workers;
    uint64_t *open;   /* pixels that are not done, by cell of the film: bit m is pixel m of the cell in
                         Morton order */
    uint64_t *active; /* of these, the ones that the lap brings on */
    uint32_t tile_columns, tile_rows;
    uint32_t tile_x0, tile_y0; /* of the first tile, in cells of the frame */
    uint32_t tile_cells;       /* a side */
    uint32_t *tiles;           /* those with active pixels */
    size_t tile_count;
    uint32_t from, to;             /* the round's sample counts; equal between rounds */
    uint32_t ahead;                /* after a pause or a resume pixels may have up to so many samples already */
    uint64_t region;               /* pixels traced */
    bool in_lap;                   /* a lap has begun and not ended */
    uint32_t look;                 /* where the lap ends, unless the render does */
    sf_pairing pairing;            /* of the lap's blocks */
    double target;                 /* of a budget: half-widths beyond it are to be lowered */
    struct sf_relmse_target *goal; /* of the whole picture; NULL where there is none */
    uint64_t beyond;               /* pixels that the goal still wants more samples of */
    bool level_fixed;
    bool second; /* the pilot is over: the set that the picture shows is taken */
    double start, deadline;
    sf_progress progress;
    sf_atomic_size state;
    size_t sampled; /* the state in which the round's sampling ended: what decisions go by */
    double checkpoint_due;
    sf_status checkpoint_status; /* of the last write */
    sf_error checkpoint_error;
} sf_rounds;

static inline uint64_t sf_rounds_count_pixels(const sf_rounds *r, const uint64_t *cells) {
    uint64_t count = 0;
    for (size_t i = 0; i < sf_film_cell_count(r->film); ++i)
        count += sf_count_bits((uint32_t)cells[i]) + sf_count_bits((uint32_t)(cells[i] >> 32));
    return count;
}

static inline uint32_t sf_rounds_x(const sf_rounds *r, uint32_t cell, uint32_t m) {
    return cell % r->film->cell_columns * SF_CELL_SIZE + sf_cell_x(m);
}
static inline uint32_t sf_rounds_y(const sf_rounds *r, uint32_t cell, uint32_t m) {
    return cell / r->film->cell_columns * SF_CELL_SIZE + sf_cell_y(m);
}
static inline sf_film_pixel *sf_rounds_pixel(const sf_rounds *r, uint32_t cell, uint32_t m) {
    return sf_film_at(r->film, sf_rounds_x(r, cell, m), sf_rounds_y(r, cell, m));
}

/* Whether a pixel of the film is of the picture, not of the margin that was traced with it. */
static inline bool sf_rounds_in_picture(const sf_rounds *r, uint32_t x, uint32_t y) {
    const sf_film *film = r->film;
    uint32_t u = x + film->x0 - film->crop_x0, v = y + film->y0 - film->crop_y0;
    return u < film->crop_width && v < film->crop_height && sf_film_is_wanted(film, u, v);
}

static inline uint32_t sf_rounds_most(const sf_rounds *r) { return sf_stop_most(&r->options); }

/* The cells of a tile that are in the film: columns x0 .. x1 - 1, rows y0 .. y1 - 1 of it. */
typedef struct sf_cell_range {
    uint32_t x0, y0, x1, y1;
} sf_cell_range;

static inline uint32_t clamp_below(uint32_t value, uint32_t offset) { return value > offset ? value - offset : 0; }
static inline uint32_t at_most(uint32_t value, uint32_t limit) { return value < limit ? value : limit; }

static inline sf_cell_range sf_rounds_tile(const sf_rounds *r, uint32_t tile) {
    uint32_t x0 = r->film->x0 / SF_CELL_SIZE, y0 = r->film->y0 / SF_CELL_SIZE;
    uint32_t left = r->tile_x0 + tile % r->tile_columns * r->tile_cells;
    uint32_t top = r->tile_y0 + tile / r->tile_columns * r->tile_cells;
    return (sf_cell_range){.x0 = clamp_below(left, x0),
                           .y0 = clamp_below(top, y0),
                           .x1 = at_most(left + r->tile_cells - x0, r->film->cell_columns),
                           .y1 = at_most(top + r->tile_cells - y0, r->film->cell_rows)};
}

/* Calls `visit` for every cell of the tile that has a pixel in `cells`, r->active or r->open. */
static inline void sf_rounds_each_cell(const sf_rounds *r, uint32_t tile, const uint64_t *cells,
                                       void (*visit)(void *user, unsigned worker, uint32_t cell), void *user,
                                       unsigned worker) {
    sf_cell_range range = sf_rounds_tile(r, tile);
    for (uint32_t y = range.y0; y < range.y1; ++y)
        for (uint32_t x = range.x0; x < range.x1; ++x)
            if (cells[(size_t)y * r->film->cell_columns + x]) visit(user, worker, y * r->film->cell_columns + x);
}

/* tile_sampling.c: takes the round's samples of a tile; an sf_parallel_fn over the tiles listed. */
void sf_rounds_sample_tile(void *user, unsigned worker, size_t item);

/* Lists the tiles that have an active pixel. */
void sf_rounds_list_tiles(sf_rounds *r);

/* What a checkpoint of the render holds, but for its state. */
struct sf_checkpoint sf_rounds_checkpoint(sf_rounds *r);

/* The budget of samples of the stage at work: a pilot has half. */
static inline uint64_t sf_rounds_budget(const sf_rounds *r) {
    return r->options.unbiased && !r->second ? r->options.samples / 2 : r->options.samples;
}

/* Sets the deadline: a pilot has half of the time. */
static inline void sf_rounds_set_deadline(sf_rounds *r) {
    double seconds = r->options.unbiased && !r->second ? r->options.seconds / 2 : r->options.seconds;
    r->deadline = r->options.seconds > 0 ? r->start + seconds : 0;
}

/* Fills the summary's level from the film as it stands, and the tolerance from the level. */
void sf_rounds_measure_level(sf_rounds *r);
void sf_rounds_set_tolerance(sf_rounds *r);

/* All rounds, until every pixel is closed. */
void sf_rounds_run(sf_rounds *r);

#endif
