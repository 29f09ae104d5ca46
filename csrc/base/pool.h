// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Threads that work through numbered items together, one phase after another, while the thread
 * that called waits and is woken at intervals. */
#ifndef SUNFLECK_POOL_H
#define SUNFLECK_POOL_H

#include <stdbool.h>
#include <stddef.h>

#include "sunfleck/base.h"

typedef struct sf_pool sf_pool;

/* One item's work. `worker` numbers the thread, from 0. */
typedef void (*sf_pool_work_fn)(void *user, unsigned worker, size_t item);

/* Called about every 50 ms, from the thread that waits, while a phase runs. */
typedef void (*sf_pool_wait_fn)(void *user);

/* Starts `threads` threads. Fails with SF_STATUS_OUT_OF_MEMORY where they can't be had. */
sf_status sf_pool_create(unsigned threads, sf_pool **pool, sf_error *error);

/* Works items 0 .. count - 1, each once, taken from a counter; returns when all are done. */
void sf_pool_run(sf_pool *pool, size_t count, sf_pool_work_fn work, sf_pool_wait_fn wait, void *user);

/* Joins the threads; NULL is allowed. */
void sf_pool_destroy(sf_pool *pool);

#endif
