// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Which pixels the next lap brings on. */

#include <math.h>
#include <string.h>

#include "render/rounds.h"

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

static void survey_cell(sf_rounds *r, sf_rounds_worker *worker, uint32_t cell) {
    for (uint32_t m = 0; m < SF_CELL_PIXELS; ++m) {
        if (!(r->open[cell] >> m & 1u)) continue;
        const sf_film_pixel *pixel = sf_rounds_pixel(r, cell, m);
        double width = (double)pixel->half_width;
        worker->worst = width > worker->worst ? width : worker->worst;
        if (width > r->target && sf_film_taken(pixel) < worker->least) worker->least = (uint32_t)sf_film_taken(pixel);
    }
}

/* Activates a cell's open pixels that have `from` samples and are beyond the target. */
static void choose_cell(sf_rounds *r, sf_rounds_worker *worker, uint32_t cell) {
    for (uint32_t m = 0; m < SF_CELL_PIXELS; ++m) {
        if (!(r->open[cell] >> m & 1u)) continue;
        const sf_film_pixel *pixel = sf_rounds_pixel(r, cell, m);
        if (sf_film_taken(pixel) != r->from || !((double)pixel->half_width > r->target)) continue;
        r->active[cell] |= UINT64_C(1) << m;
        ++worker->chosen;
    }
}

static void survey_tile(void *user, unsigned worker, size_t tile) {
    sf_rounds *r = user;
    sf_rounds_each_cell(r, worker, (uint32_t)tile, r->open, survey_cell);
}

static void choose_tile(void *user, unsigned worker, size_t tile) {
    sf_rounds *r = user;
    sf_rounds_each_cell(r, worker, (uint32_t)tile, r->open, choose_cell);
}

static size_t all_tiles(const sf_rounds *r) { return (size_t)r->tile_columns * r->tile_rows; }

/* The least count among the open pixels beyond the target, UINT32_MAX where there is none, and the
 * largest half-width of all that are open. Neither depends on which thread saw which pixel. */
static uint32_t survey(sf_rounds *r, double *worst) {
    uint32_t least = UINT32_MAX;
    *worst = 0;
    for (uint32_t i = 0; i < r->options.threads; ++i) {
        r->workers[i].least = UINT32_MAX;
        r->workers[i].worst = 0;
    }
    sf_thread_pool_run(r->pool, all_tiles(r), survey_tile, sf_rounds_wake, r);
    for (uint32_t i = 0; i < r->options.threads; ++i) {
        least = r->workers[i].least < least ? r->workers[i].least : least;
        *worst = fmax(*worst, r->workers[i].worst);
    }
    return least;
}

static uint64_t choose_beyond(sf_rounds *r, double target) {
    uint64_t count = 0;
    r->target = target;
    memset(r->active, 0, sf_film_cell_count(r->film) * sizeof *r->active);
    for (uint32_t i = 0; i < r->options.threads; ++i) r->workers[i].chosen = 0;
    sf_thread_pool_run(r->pool, all_tiles(r), choose_tile, sf_rounds_wake, r);
    for (uint32_t i = 0; i < r->options.threads; ++i) count += r->workers[i].chosen;
    return count;
}

/* Keeps, of the chosen pixels, as many as a budget of samples still pays for: those with the
 * largest half-widths, `worst` being the largest of all. False: of none. */
static bool keep_within_samples(sf_rounds *r, uint64_t count, double worst) {
    if (!r->options.samples) return true;
    uint64_t budget = sf_rounds_budget(r), spent = sf_rounds_samples(r), left = budget > spent ? budget - spent : 0;
    uint32_t step = r->look - r->from;
    if (r->from == 0 && left < count) return false;
    if (r->from == 0 && left / count < step) { /* not even a first look: as far as it goes, together */
        r->look = (uint32_t)(left / count);
        return true;
    }
    if (count <= left / step) return true;
    double low = r->target, high = worst;
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
static bool choose_by_budget(sf_rounds *r) {
    for (;;) {
        double worst;
        uint32_t least = survey(r, &worst);
        if (least < UINT32_MAX) {
            r->from = least;
            r->look = sf_stop_next_look(&r->options, r->from);
            return keep_within_samples(r, choose_beyond(r, r->target), worst);
        }
        if (!(worst > 0)) return false;
        r->target = fmin(r->target, worst) * 0.7; /* half the variance, nearly */
    }
}

/* The least count at which an open pixel has its second set. */
static uint32_t least_planned(const sf_rounds *r) {
    double least = SF_MAX_SPP;
    for (uint32_t cell = 0; cell < sf_film_cell_count(r->film); ++cell)
        for (uint32_t m = 0; m < SF_CELL_PIXELS; ++m)
            if (r->open[cell] >> m & 1u) least = fmin(least, sf_rounds_pixel(r, cell, m)->evidence.planned);
    return (uint32_t)least;
}

/* Sets the next lap: its pixels, where it begins and where it looks. False: nothing is left. */
bool sf_rounds_begin_lap(sf_rounds *r) {
    bool chosen = !sf_moves_together(&r->options);
    if (chosen && !r->second) {
        bool any = r->goal ? sf_relmse_target_choose(r) : choose_by_budget(r);
        if (!any) r->from = r->to; /* no lap has begun */
        if (!any) return false;
    } else {
        memcpy(r->active, r->open, sf_film_cell_count(r->film) * sizeof *r->active);
        r->from = r->to;
    }
    sf_rounds_list_tiles(r);
    r->in_lap = r->tile_count > 0;
    if (!r->in_lap) return false; /* after the last sample there is no look */
    if (r->second)
        r->look = least_planned(r);
    else if (!chosen)
        r->look = sf_stop_next_look(&r->options, r->from);
    r->to = r->from;
    r->pairing = r->second ? (sf_pairing){0, 0} : sf_stop_pairing(&r->options, r->look);
    return true;
}
