// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Selects the pixels of the next lap: all that are open, or those beyond the falling target of a budget. */
#include "render/pixel_selection.h"

#include <math.h>
#include <string.h>

#include "render/progress.h"
#include "render/relmse_target.h"
#include "render/rounds.h"

/* A selection for a budget. */
typedef struct selection {
    const sf_rounds *r;
    uint64_t *active;
    uint32_t from; /* pixels that have so many samples */
    double target; /* and half-widths beyond it */
} selection;

static void survey_cell(void *user, unsigned worker, uint32_t cell) {
    const selection *s = user;
    sf_rounds_worker *sums = s->r->workers + worker;
    for (uint32_t m = 0; m < SF_CELL_PIXELS; ++m) {
        if (!(s->r->open[cell] >> m & 1u)) continue;
        const sf_film_pixel *pixel = sf_rounds_pixel(s->r, cell, m);
        double width = (double)pixel->half_width;
        sums->worst = width > sums->worst ? width : sums->worst;
        if (width > s->target && sf_film_taken(pixel) < sums->least) sums->least = (uint32_t)sf_film_taken(pixel);
    }
}

/* Activates a cell's open pixels that have `from` samples and are beyond the target. */
static void choose_cell(void *user, unsigned worker, uint32_t cell) {
    const selection *s = user;
    for (uint32_t m = 0; m < SF_CELL_PIXELS; ++m) {
        if (!(s->r->open[cell] >> m & 1u)) continue;
        const sf_film_pixel *pixel = sf_rounds_pixel(s->r, cell, m);
        if (sf_film_taken(pixel) != s->from || !((double)pixel->half_width > s->target)) continue;
        s->active[cell] |= UINT64_C(1) << m;
        ++s->r->workers[worker].chosen;
    }
}

static void survey_tile(void *user, unsigned worker, size_t tile) {
    const sf_rounds *r = ((const selection *)user)->r;
    sf_rounds_each_cell(r, (uint32_t)tile, r->open, survey_cell, user, worker);
}

static void choose_tile(void *user, unsigned worker, size_t tile) {
    const sf_rounds *r = ((const selection *)user)->r;
    sf_rounds_each_cell(r, (uint32_t)tile, r->open, choose_cell, user, worker);
}

static size_t all_tiles(const sf_rounds *r) { return (size_t)r->tile_columns * r->tile_rows; }

/* The least count among the open pixels beyond the target, UINT32_MAX where there is none, and the
 * largest half-width of all that are open. Neither depends on which thread saw which pixel. */
static uint32_t survey(selection *s, double *worst) {
    const sf_rounds *r = s->r;
    uint32_t least = UINT32_MAX;
    *worst = 0;
    for (uint32_t i = 0; i < r->options.threads; ++i) {
        r->workers[i].least = UINT32_MAX;
        r->workers[i].worst = 0;
    }
    sf_rounds_run_phase(r, all_tiles(r), survey_tile, s);
    for (uint32_t i = 0; i < r->options.threads; ++i) {
        least = r->workers[i].least < least ? r->workers[i].least : least;
        *worst = fmax(*worst, r->workers[i].worst);
    }
    return least;
}

static uint64_t choose_beyond(selection *s, double target) {
    const sf_rounds *r = s->r;
    uint64_t count = 0;
    s->target = target;
    memset(s->active, 0, sf_film_cell_count(r->film) * sizeof *s->active);
    for (uint32_t i = 0; i < r->options.threads; ++i) r->workers[i].chosen = 0;
    sf_rounds_run_phase(r, all_tiles(r), choose_tile, s);
    for (uint32_t i = 0; i < r->options.threads; ++i) count += r->workers[i].chosen;
    return count;
}

/* Keeps, of the chosen pixels, as many as a budget of samples still pays for: those with the
 * largest half-widths, `worst` being the largest of all. False: of none. */
static bool keep_within_samples(selection *s, sf_lap *lap, uint64_t count, double worst) {
    const sf_rounds *r = s->r;
    if (!r->options.samples) return true;
    uint64_t budget = sf_rounds_budget(r), spent = sf_rounds_samples(r), left = budget > spent ? budget - spent : 0;
    uint32_t step = lap->look - lap->from;
    if (lap->from == 0 && left < count) return false;
    if (lap->from == 0 && left / count < step) { /* not even a first look: as far as it goes, together */
        lap->look = (uint32_t)(left / count);
        return true;
    }
    if (count <= left / step) return true;
    double low = s->target, high = worst;
    for (int halving = 0; halving < 40; ++halving) {
        double middle = low + (high - low) / 2;
        if (choose_beyond(s, middle) > left / step)
            low = middle;
        else
            high = middle;
    }
    return choose_beyond(s, high) > 0;
}

/* The next lap of a budget. */
static sf_lap select_by_budget(const sf_rounds *r, uint64_t *active) {
    selection s = {.r = r, .active = active, .target = r->target};
    sf_lap lap = {.begins = false};
    for (;;) {
        double worst;
        s.from = survey(&s, &worst);
        if (s.from < UINT32_MAX) {
            lap.from = s.from;
            lap.look = sf_stop_next_look(&r->options, s.from);
            lap.begins = keep_within_samples(&s, &lap, choose_beyond(&s, s.target), worst);
            break;
        }
        if (!(worst > 0)) break;
        s.target = fmin(s.target, worst) * 0.7; /* half the variance, nearly */
    }
    lap.target = s.target;
    return lap;
}

/* The least count at which an open pixel has its second set. */
static uint32_t least_planned(const sf_rounds *r) {
    double least = SF_MAX_SPP;
    for (uint32_t cell = 0; cell < sf_film_cell_count(r->film); ++cell)
        for (uint32_t m = 0; m < SF_CELL_PIXELS; ++m)
            if (r->open[cell] >> m & 1u) least = fmin(least, sf_rounds_pixel(r, cell, m)->evidence.planned);
    return (uint32_t)least;
}

/* All open pixels, from where they are together. */
static sf_lap select_all(const sf_rounds *r, uint64_t *active) {
    memcpy(active, r->open, sf_film_cell_count(r->film) * sizeof *active);
    sf_lap lap = {.begins = sf_rounds_count_pixels(r, active) > 0, .from = r->to, .target = r->target};
    if (lap.begins) lap.look = r->second ? least_planned(r) : sf_stop_next_look(&r->options, lap.from);
    return lap;
}

sf_lap sf_select_lap(const sf_rounds *r, uint64_t *active) {
    if (r->second || sf_moves_together(&r->options)) return select_all(r, active);
    return r->goal ? sf_relmse_target_select(r->goal, r, active) : select_by_budget(r, active);
}
