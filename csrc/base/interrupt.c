// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Asks callers whether to go on. */
#include "base/interrupt.h"

#include "base/error.h"

#define ASK_SECONDS 25e-3 /* between two questions: an eighth of what a person notices as a delay */

void sf_watch_begin(sf_watch *watch, const sf_interrupt *interrupt) {
    watch->interrupt = interrupt;
    watch->asked = interrupt ? sf_seconds_now() : 0.0;
    watch->steps = 0;
    sf_atomic_store(&watch->stopped, 0);
}

int sf_watch_ask(sf_watch *watch) {
    if (sf_watch_stopped(watch)) return 1;
    if (!watch->interrupt || sf_seconds_now() - watch->asked < ASK_SECONDS) return 0;
    if (watch->interrupt->asked(watch->interrupt->user)) sf_atomic_store(&watch->stopped, 1);
    watch->asked = sf_seconds_now();
    return sf_watch_stopped(watch);
}

sf_status sf_watch_status(const sf_watch *watch, sf_error *error) {
    if (!sf_watch_stopped(watch)) return SF_STATUS_OK;
    return sf_fail(error, SF_STATUS_INTERRUPTED, "interrupted by the caller");
}
