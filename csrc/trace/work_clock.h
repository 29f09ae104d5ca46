// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What a thread's time goes to. One clock for each thread, read where its work changes: some fifteen
 * times a batch of 1,024 paths, and not at all where nobody asked. */
#ifndef SUNFLECK_WORK_CLOCK_H
#define SUNFLECK_WORK_CLOCK_H

#include <stdbool.h>

#include "base/platform.h"
#include "sunfleck/film.h"

typedef struct sf_work_clock {
    bool runs;
    sf_work at;
    double since;
    double seconds[SF_WORK_COUNT];
} sf_work_clock;

/* From here on the thread does `work`. */
static inline void sf_work_begin(sf_work_clock *clock, sf_work work) {
    if (!clock->runs) return;
    double now = sf_seconds_now();
    clock->seconds[clock->at] += now - clock->since;
    clock->since = now;
    clock->at = work;
}

/* What passed since the clock was last read is nobody's. */
static inline void sf_work_resume(sf_work_clock *clock) {
    if (clock->runs) clock->since = sf_seconds_now();
}

#endif
