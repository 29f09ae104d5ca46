// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Threads that work through numbered items: for one call, or kept from one phase of work to the next. */
#ifndef SUNFLECK_PARALLEL_H
#define SUNFLECK_PARALLEL_H

#include <stddef.h>
#include <stdint.h>

#include "base/interrupt.h"

#define SF_PARALLEL_MAX_THREADS 256u

/* One item's work. `worker` numbers the thread, from 0. */
typedef void (*sf_parallel_fn)(void *user, unsigned worker, size_t item);

/* The threads that sf_parallel_for will use: as many as asked for, one for each processor where
 * that is 0; no more than there are items, nor than SF_PARALLEL_MAX_THREADS; at least 1. */
unsigned sf_parallel_threads(uint32_t threads, size_t items);

/* Works items 0 .. items - 1, each once, taken from a counter in rising order; returns when all
 * are done. The caller is worker 0, and the other threads, at most SF_PARALLEL_MAX_THREADS - 1, live
 * for the call. It cannot fail: what a thread that could not be started would have done, the others do. */
void sf_parallel_for(unsigned threads, size_t items, sf_parallel_fn work, void *user);

/* The same until the watch says stop: then no item is begun, and `work` must return soon by the watch, which
 * worker 0 alone may ask. The caller asks, too, while it waits for the others. */
void sf_parallel_for_watched(unsigned threads, size_t items, sf_parallel_fn work, void *user, sf_watch *watch);

/* Threads that are kept, while the one that called waits and is woken at intervals. */
typedef struct sf_thread_pool sf_thread_pool;

/* Called about every 50 ms, from the thread that waits, while a phase runs. */
typedef void (*sf_parallel_wait_fn)(void *user);

/* Starts `threads` threads. Fails with SF_STATUS_OUT_OF_MEMORY where they can't be had. */
sf_status sf_thread_pool_create(unsigned threads, sf_thread_pool **pool, sf_error *error);

/* Works items 0 .. items - 1, each once, taken from a counter; returns when all are done. */
void sf_thread_pool_run(sf_thread_pool *pool, size_t items, sf_parallel_fn work, sf_parallel_wait_fn wait, void *user);

/* Joins the threads; NULL is allowed. */
void sf_thread_pool_destroy(sf_thread_pool *pool);

#endif
