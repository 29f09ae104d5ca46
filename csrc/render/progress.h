// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What a render tells of its progress while it runs. */
#ifndef SUNFLECK_PROGRESS_H
#define SUNFLECK_PROGRESS_H

#include "base/parallel.h"

struct sf_rounds;

/* Paths traced so far. */
uint64_t sf_rounds_samples(const struct sf_rounds *r);

/* Reports progress while a phase runs: an sf_parallel_wait_fn. */
void sf_rounds_wake(void *user);

/* Reports the round that has ended. */
void sf_rounds_report_round(struct sf_rounds *r);

/* Runs `work` over the items on the render's threads, and meanwhile reports progress, which is all that changes
 * of the rounds. */
void sf_rounds_run_phase(const struct sf_rounds *r, size_t items, sf_parallel_fn work, void *user);

#endif
