// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* How long work asks its caller whether to stop: by the clock, on the caller's thread alone. */
#ifndef SUNFLECK_INTERRUPT_H
#define SUNFLECK_INTERRUPT_H

#include "base/platform.h"
#include "sunfleck/base.h"

/* One call's work: whom to ask, when it was last asked, and whether it said stop. */
typedef struct sf_watch {
    const sf_interrupt *interrupt; /* NULL: never stops */
    double asked;                  /* seconds; the caller's thread alone reads and writes it, */
    uint64_t steps;                /* and the steps since the clock was read */
    sf_atomic_size stopped;        /* read by every thread */
} sf_watch;

void sf_watch_begin(sf_watch *watch, const sf_interrupt *interrupt);

/* Reads the clock and asks, if it is time; returns whether the work must stop. For the caller's thread. */
int sf_watch_ask(sf_watch *watch);

/* Whether the work must stop, for any thread. */
static inline int sf_watch_stopped(const sf_watch *watch) { return sf_atomic_load(&watch->stopped) != 0; }

/* The same after `steps` steps of about a nanosecond, asking where enough of them have come together. For the
 * caller's thread. */
static inline int sf_watch_step(sf_watch *watch, uint64_t steps) {
    enum { STEPS_BETWEEN_CLOCKS = 1 << 18 };
    watch->steps += steps;
    if (watch->steps < STEPS_BETWEEN_CLOCKS) return sf_watch_stopped(watch);
    watch->steps = 0;
    return sf_watch_ask(watch);
}

/* The same at item i of a loop over items of a few nanoseconds: it looks at every 2^16th. */
static inline int sf_watch_item(sf_watch *watch, size_t i) {
    enum { ITEMS = 1 << 16, STEPS_OF_AN_ITEM = 4 };
    return i % ITEMS == ITEMS - 1 && sf_watch_step(watch, (uint64_t)ITEMS * STEPS_OF_AN_ITEM);
}

/* For worker `worker` of sf_parallel_for_watched, of which 0 is the caller's thread. */
static inline int sf_watch_step_of(sf_watch *watch, unsigned worker, uint64_t steps) {
    return worker == 0 ? sf_watch_step(watch, steps) : sf_watch_stopped(watch);
}

/* SF_STATUS_INTERRUPTED with its message where the work was told to stop, else SF_STATUS_OK. */
sf_status sf_watch_status(const sf_watch *watch, sf_error *error);

#endif
