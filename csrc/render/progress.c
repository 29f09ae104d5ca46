// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Reports progress to the caller of a render, who may interrupt it so. */
#include "render/progress.h"

#include <math.h>

#include "render/rounds.h"

uint64_t sf_rounds_samples(const sf_rounds *r) {
    uint64_t samples = 0;
    for (uint32_t i = 0; i < r->options.threads; ++i) samples += sf_atomic_load(&r->workers[i].samples);
    return samples;
}

static void report(sf_rounds *r, bool round_finished) {
    if (!r->options.progress) return;
    sf_progress *p = &r->progress;
    p->samples = sf_rounds_samples(r);
    p->seconds = sf_seconds_now() - r->start;
    p->round_finished = round_finished;
    if (r->options.progress(p, r->options.progress_user) != 0) sf_atomic_store(&r->state, SF_INTERRUPTED);
}

void sf_rounds_wake(void *user) { report(user, false); }

void sf_rounds_report_round(sf_rounds *r) {
    sf_progress *p = &r->progress;
    p->round = r->film->summary.rounds;
    p->pixels_done = p->pixels_met = 0;
    for (uint32_t i = 0; i < r->options.threads; ++i) {
        p->pixels_done += r->workers[i].done;
        p->pixels_met += r->workers[i].met;
    }
    p->tolerance = fmax(r->film->summary.tolerance, 0);
    if (r->goal && !r->second && sf_atomic_load(&r->state) == SF_RUNNING)
        p->pixels_done = p->pixels - (r->beyond < p->pixels ? r->beyond : p->pixels);
    report(r, true);
}

/* ---- phases ---- */

typedef struct phase {
    const sf_rounds *r;
    sf_parallel_fn work;
    void *user;
} phase;

static void work_item(void *user, unsigned worker, size_t item) {
    const phase *p = user;
    p->work(p->user, worker, item);
}

static void wake_phase(void *user) { sf_rounds_wake((sf_rounds *)((const phase *)user)->r); }

void sf_rounds_run_phase(const sf_rounds *r, size_t items, sf_parallel_fn work, void *user) {
    phase p = {r, work, user};
    sf_thread_pool_run(r->pool, items, work_item, wake_phase, &p);
}
