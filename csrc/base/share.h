// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Shares numbered items out among threads that live for one call. */
#ifndef SUNFLECK_SHARE_H
#define SUNFLECK_SHARE_H

#include <stddef.h>
#include <stdint.h>

#define SF_SHARE_MAX_THREADS 256u

/* One item's work. `worker` numbers the thread, from 0. */
typedef void (*sf_share_fn)(void *user, unsigned worker, size_t item);

/* The threads that sf_share_items will use: as many as asked for, one for each processor where
 * that is 0; no more than there are items, nor than SF_SHARE_MAX_THREADS; at least 1. */
unsigned sf_share_threads(uint32_t threads, size_t items);

/* Works items 0 .. items - 1, each once, taken from a counter in rising order; returns when all
 * are done. The caller is worker 0. It cannot fail: what a thread that could not be started would
 * have done, the others do. */
void sf_share_items(unsigned threads, size_t items, sf_share_fn work, void *user);

#endif
