// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A round's samples: blocks of the cells' pixels gathered into batches, run, and added to the film. */

#include "film/film_blocks.h"
#include "render/rounds.h"

/* What tells the keys of a second set from the pilot's, and from replicates', which are 1 to 8. */
#define SECOND_SET (UINT64_C(1) << 32)

/* Runs the blocks gathered so far and adds them to the film, in their order. */
static void flush_batch(sf_rounds *r, sf_rounds_worker *worker) {
    sf_batch *batch = &worker->batch;
    if (batch->block_count == 0) return;
    sf_batch_run(batch, &r->context);
    sf_work_begin(&batch->clock, SF_WORK_FILM);
    size_t samples = 0;
    for (uint32_t i = 0; i < batch->block_count; ++i) samples += sf_count_bits(batch->blocks[i].active);
    sf_film_round round = {.from = r->from, .pairing = r->pairing, .second = r->second};
    sf_film_blocks blocks = {batch->block_count, batch->blocks, batch->statistics, batch->negative_moments,
                             batch->hit_sums};
    sf_film_add_blocks(r->film, &round, &blocks);
    batch->block_count = 0;
    sf_atomic_fetch_add(&worker->samples, samples);
    if (r->deadline > 0 && sf_seconds_now() >= r->deadline)
        (void)sf_atomic_replace(&r->state, SF_RUNNING, SF_OUT_OF_TIME); /* an interruption stays */
}

/* The block of pixel (x, y) of the film that starts at sample `n`. */
static sf_block make_block(const sf_rounds *r, uint32_t x, uint32_t y, uint64_t key, uint32_t n) {
    uint32_t base = n / SF_LANES * SF_LANES, end = r->to - base < SF_LANES ? r->to - base : SF_LANES;
    sf_block block = {.key = key,
                      .base = base,
                      .active = ((1u << end) - 1) & ~((1u << (n - base)) - 1),
                      .x = x + r->film->x0,
                      .y = y + r->film->y0,
                      .pixel = (uint32_t)sf_film_index(r->film, x, y),
                      .number = base / SF_LANES};
    if (r->options.stop == SF_STOP_RULE_REPLICATES) { /* replicates take turns by the block */
        block.key = sf_hash64(key, block.number % SF_REPLICATES + 1);
        block.base = block.number / SF_REPLICATES * SF_LANES;
    }
    return block;
}

/* Where the block of pixel m that holds sample `n` goes on: after the samples that the pixel took
 * before a pause or a stop. At or past the block's end there is nothing left to take. */
static uint32_t skip_taken(const sf_rounds *r, uint32_t cell, uint32_t m, uint32_t n) {
    if (r->from >= r->ahead) return n;
    uint64_t next = r->options.start + sf_film_taken(sf_rounds_pixel(r, cell, m));
    return next > n ? (uint32_t)next : n;
}

static uint32_t block_end(const sf_rounds *r, uint32_t n) {
    uint32_t end = n / SF_LANES * SF_LANES + SF_LANES;
    return end < r->to ? end : r->to;
}

static void choose_keys(sf_rounds *r, sf_rounds_worker *worker, uint32_t cell, uint64_t active,
                        uint64_t keys[SF_CELL_PIXELS]) {
    for (uint32_t m = 0; m < SF_CELL_PIXELS; ++m) {
        if (!(active >> m & 1u)) continue;
        uint64_t x = sf_rounds_x(r, cell, m) + r->film->x0, y = sf_rounds_y(r, cell, m) + r->film->y0;
        keys[m] = r->options.seeds == SF_SEEDS_PIXEL ? sf_hash64(r->options.seed, y << 32 | x)
                                                     : sf_rng_next_raw(&worker->stream);
        if (r->second) keys[m] = sf_hash64(keys[m], SECOND_SET);
    }
}

typedef struct block_layout {
    uint32_t width, first_sample;
} block_layout;

/* How the round's blocks that begin with sample `n` lie in the batch: as wide as the samples wanted
 * of them are many. */
static block_layout lay_out_blocks(const sf_rounds *r, uint32_t n) {
    uint32_t last = block_end(r, n) - 1, width = 1;
    while (n / width != last / width) width *= 2;
    return (block_layout){width, n % SF_LANES / width * width};
}

static void sample_cell(void *user, unsigned number, uint32_t cell) {
    sf_rounds *r = user;
    sf_rounds_worker *worker = r->workers + number;
    if (sf_atomic_load(&r->state) != SF_RUNNING) return;
    uint64_t active = r->active[cell], keys[SF_CELL_PIXELS];
    uint32_t x = sf_rounds_x(r, cell, 0), y = sf_rounds_y(r, cell, 0);
    sf_batch *batch = &worker->batch;
    sf_work_resume(&batch->clock);
    choose_keys(r, worker, cell, active, keys);
    for (uint32_t n = r->from; n < r->to; n = n / SF_LANES * SF_LANES + SF_LANES) {
        block_layout layout = lay_out_blocks(r, n);
        if (batch->width != layout.width) flush_batch(r, worker);
        batch->width = layout.width;
        batch->first_sample = layout.first_sample;
        for (uint32_t m = 0; m < SF_CELL_PIXELS; ++m) {
            if (!(active >> m & 1u)) continue;
            uint32_t first = skip_taken(r, cell, m, n);
            if (first >= block_end(r, n)) continue;
            batch->blocks[batch->block_count++] = make_block(r, x + sf_cell_x(m), y + sf_cell_y(m), keys[m], first);
            if (batch->block_count < SF_BLOCKS) continue;
            flush_batch(r, worker);
            if (sf_atomic_load(&r->state) != SF_RUNNING) return;
        }
    }
    flush_batch(r, worker);
    sf_work_begin(&batch->clock, SF_WORK_FILM);
}

void sf_rounds_sample_tile(void *user, unsigned worker, size_t item) {
    sf_rounds *r = user;
    if (sf_atomic_load(&r->state) == SF_RUNNING)
        sf_rounds_each_cell(r, r->tiles[item], r->active, sample_cell, r, worker);
}
