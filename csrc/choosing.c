// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Which pixels the next lap brings on. */

#include <math.h>
#include <string.h>

#include "rounds.h"

static bool tile_has(const sf_rounds *r, uint32_t tile, const uint64_t *cells) {
    sf_cell_range range = sf_rounds_tile(r, tile);
    for (uint32_t y = range.y0; y < range.y1; ++y)
        for (uint32_t x = range.x0; x < range.x1; ++x)
            if (cells[(size_t)y * r->cell_columns + x]) return true;
    return false;
}

void sf_rounds_list_tiles(sf_rounds *r) {
    r->tile_count = 0;
    for (uint32_t tile = 0; tile < r->tile_columns * r->tile_rows; ++tile)
        if (tile_has(r, tile, r->active)) r->tiles[r->tile_count++] = tile;
}

/* The least count and the largest half-width among a tile's open pixels beyond the target. */
static void survey_tile(void *user, unsigned worker, size_t tile) {
    (void)worker;
    sf_rounds *r = user;
    sf_cell_range range = sf_rounds_tile(r, (uint32_t)tile);
    uint32_t least = UINT32_MAX;
    double worst = 0;
    for (uint32_t y = range.y0; y < range.y1; ++y)
        for (uint32_t x = range.x0; x < range.x1; ++x) {
            uint32_t cell = y * r->cell_columns + x;
            for (uint32_t m = 0; m < SF_CELL_PIXELS; ++m) {
                if (!(r->open[cell] >> m & 1u)) continue;
                const sf_film_pixel *pixel = sf_rounds_pixel(r, cell, m);
                double width = (double)pixel->half_width;
                worst = width > worst ? width : worst;
                if (width > r->target && sf_film_taken(pixel) < least) least = (uint32_t)sf_film_taken(pixel);
            }
        }
    r->least[tile] = least;
    r->worst[tile] = worst;
}

/* Activates a tile's open pixels that have `from` samples and are beyond the target. */
static void choose_tile(void *user, unsigned worker, size_t tile) {
    (void)worker;
    sf_rounds *r = user;
    sf_cell_range range = sf_rounds_tile(r, (uint32_t)tile);
    r->chosen[tile] = 0;
    for (uint32_t y = range.y0; y < range.y1; ++y)
        for (uint32_t x = range.x0; x < range.x1; ++x) {
            uint32_t cell = y * r->cell_columns + x;
            r->active[cell] = 0;
            for (uint32_t m = 0; m < SF_CELL_PIXELS; ++m) {
                if (!(r->open[cell] >> m & 1u)) continue;
                const sf_film_pixel *pixel = sf_rounds_pixel(r, cell, m);
                if (sf_film_taken(pixel) != r->from || !((double)pixel->half_width > r->target)) continue;
                r->active[cell] |= UINT64_C(1) << m;
                ++r->chosen[tile];
            }
        }
}

static uint64_t choose_beyond(sf_rounds *r, double target) {
    size_t tiles = (size_t)r->tile_columns * r->tile_rows;
    uint64_t count = 0;
    r->target = target;
    sf_pool_run(r->pool, tiles, choose_tile, sf_rounds_wake, r);
    for (size_t tile = 0; tile < tiles; ++tile) count += r->chosen[tile];
    return count;
}

/* Keeps, of the chosen pixels, as many as a budget of samples still pays for: those with the
 * largest half-widths. False: of none. */
static bool keep_within_samples(sf_rounds *r, uint64_t count) {
    if (!r->options.samples) return true;
    uint64_t left = r->options.samples - sf_rounds_samples(r);
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
static bool choose_by_budget(sf_rounds *r) {
    size_t tiles = (size_t)r->tile_columns * r->tile_rows;
    for (;;) {
        uint32_t least = UINT32_MAX;
        double worst = 0;
        sf_pool_run(r->pool, tiles, survey_tile, sf_rounds_wake, r);
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
bool sf_rounds_begin_lap(sf_rounds *r) {
    bool budget = !r->options.spp && !(r->options.relative_tolerance > 0 || r->options.absolute_tolerance > 0);
    if (budget) {
        if (!choose_by_budget(r)) return false;
    } else {
        r->from = r->to;
        r->look = sf_stop_next_look(&r->options, r->from);
        memcpy(r->active, r->open, sf_rounds_cell_count(r) * sizeof *r->active);
    }
    r->to = r->from;
    r->lap = sf_stop_lap(&r->options, r->look);
    sf_rounds_list_tiles(r);
    r->in_lap = r->tile_count > 0;
    return r->in_lap;
}
