// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Runs numbered items on threads, which take them from a counter, phase after phase. */
#include "base/parallel.h"

#include <errno.h>
#if defined(__linux__)
#include <sched.h>
#endif
#include <stdbool.h>
#include <unistd.h>

#include "base/error.h"
#include "base/platform.h"

#define WAIT_NANOSECONDS 50000000L

typedef struct worker {
    sf_thread_pool *pool;
    unsigned number;
    pthread_t thread;
} worker;

struct sf_thread_pool {
    pthread_mutex_t mutex;
    pthread_cond_t start, finish;
    unsigned count;      /* threads running */
    unsigned working;    /* of these, still in the phase */
    unsigned long phase; /* counts up as phases start */
    bool traces;         /* threads handle denormals as Embree asks */
    bool ending;
    size_t items;
    sf_atomic_size next;
    sf_parallel_fn work;
    void *user;
    const sf_watch *watch; /* NULL: none */
    worker *workers;
};

static void work_items(sf_thread_pool *pool, unsigned number) {
    for (size_t item; (item = sf_atomic_fetch_add(&pool->next, 1)) < pool->items;) {
        if (pool->watch && sf_watch_stopped(pool->watch)) return;
        pool->work(pool->user, number, item);
    }
}

static void *work_phases(void *argument) {
    const worker *self = argument;
    sf_thread_pool *pool = self->pool;
    unsigned mode = pool->traces ? sf_flush_denormals() : 0;
    unsigned long seen = 0;
    pthread_mutex_lock(&pool->mutex);
    for (;;) {
        while (pool->phase == seen && !pool->ending) pthread_cond_wait(&pool->start, &pool->mutex);
        if (pool->phase == seen) break;
        seen = pool->phase;
        pthread_mutex_unlock(&pool->mutex);
        work_items(pool, self->number);
        pthread_mutex_lock(&pool->mutex);
        if (--pool->working == 0) pthread_cond_signal(&pool->finish);
    }
    pthread_mutex_unlock(&pool->mutex);
    if (pool->traces) sf_restore_denormals(mode);
    return NULL;
}

/* Starts up to `threads` threads, numbered from `first` on. */
static void start_threads(sf_thread_pool *pool, unsigned threads, unsigned first) {
    pthread_condattr_t clock;
    pthread_condattr_init(&clock);
    pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
    pthread_mutex_init(&pool->mutex, NULL);
    pthread_cond_init(&pool->start, NULL);
    pthread_cond_init(&pool->finish, &clock);
    pthread_condattr_destroy(&clock);
    for (unsigned i = 0; i < threads; ++i) {
        worker *fresh = &pool->workers[i];
        *fresh = (worker){.pool = pool, .number = first + i};
        if (pthread_create(&fresh->thread, NULL, work_phases, fresh) != 0) return;
        ++pool->count;
    }
}

static void begin_phase(sf_thread_pool *pool, size_t items, sf_parallel_fn work, void *user) {
    pthread_mutex_lock(&pool->mutex);
    pool->items = items;
    pool->work = work;
    pool->user = user;
    pool->working = pool->count;
    sf_atomic_store(&pool->next, 0);
    ++pool->phase;
    pthread_cond_broadcast(&pool->start);
    pthread_mutex_unlock(&pool->mutex);
}

/* Ends the threads, when they have ended the phase that has begun. */
static void join_threads(sf_thread_pool *pool) {
    pthread_mutex_lock(&pool->mutex);
    pool->ending = true;
    pthread_cond_broadcast(&pool->start);
    pthread_mutex_unlock(&pool->mutex);
    for (unsigned i = 0; i < pool->count; ++i) pthread_join(pool->workers[i].thread, NULL);
    pthread_cond_destroy(&pool->start);
    pthread_cond_destroy(&pool->finish);
    pthread_mutex_destroy(&pool->mutex);
}

unsigned sf_processor_count(void) {
#if defined(__linux__)
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) > 0) return (unsigned)CPU_COUNT(&set);
#endif
    long count = sysconf(_SC_NPROCESSORS_ONLN);
    return count > 0 ? (unsigned)count : 1;
}

unsigned sf_parallel_threads(uint32_t threads, size_t items) {
    if (threads == 0) threads = sf_processor_count();
    if (threads > SF_PARALLEL_MAX_THREADS) threads = SF_PARALLEL_MAX_THREADS;
    if (items < threads) threads = (uint32_t)items;
    return threads ? threads : 1;
}

/* Returns when the phase has ended, and calls `wait` meanwhile. */
static void wait_for_phase(sf_thread_pool *pool, sf_parallel_wait_fn wait, void *user) {
    pthread_mutex_lock(&pool->mutex);
    while (pool->working > 0) {
        struct timespec until;
        clock_gettime(CLOCK_MONOTONIC, &until);
        until.tv_nsec += WAIT_NANOSECONDS;
        if (until.tv_nsec >= 1000000000L) {
            until.tv_nsec -= 1000000000L;
            ++until.tv_sec;
        }
        if (pthread_cond_timedwait(&pool->finish, &pool->mutex, &until) != ETIMEDOUT || pool->working == 0) continue;
        pthread_mutex_unlock(&pool->mutex);
        wait(user);
        pthread_mutex_lock(&pool->mutex);
    }
    pthread_mutex_unlock(&pool->mutex);
}

static void ask(void *watch) { sf_watch_ask(watch); }

void sf_parallel_for_watched(unsigned threads, size_t items, sf_parallel_fn work, void *user, sf_watch *watch) {
    if (threads > SF_PARALLEL_MAX_THREADS) threads = SF_PARALLEL_MAX_THREADS;
    worker workers[SF_PARALLEL_MAX_THREADS];
    sf_thread_pool pool = {.watch = watch, .workers = workers};
    start_threads(&pool, threads < 2 ? 0 : threads - 1, 1);
    begin_phase(&pool, items, work, user);
    work_items(&pool, 0);
    if (watch && watch->interrupt) wait_for_phase(&pool, ask, watch);
    join_threads(&pool);
}

void sf_parallel_for(unsigned threads, size_t items, sf_parallel_fn work, void *user) {
    if (threads < 2) {
        for (size_t item = 0; item < items; ++item) work(user, 0, item);
        return;
    }
    sf_parallel_for_watched(threads, items, work, user, NULL);
}

sf_status sf_thread_pool_create(unsigned threads, sf_thread_pool **out, sf_error *error) {
    *out = NULL;
    size_t bytes = sizeof(sf_thread_pool) + threads * sizeof(worker);
    sf_thread_pool *pool = calloc(1, bytes);
    if (!pool) return sf_fail_memory(error, "the threads", bytes);
    pool->traces = true;
    pool->workers = (worker *)(pool + 1);
    start_threads(pool, threads, 0);
    if (pool->count < threads) {
        unsigned started = pool->count;
        sf_thread_pool_destroy(pool);
        return sf_fail(error, SF_STATUS_OUT_OF_MEMORY, "only %u of %u threads could be started; ask for fewer", started,
                       threads);
    }
    *out = pool;
    return SF_STATUS_OK;
}

void sf_thread_pool_run(sf_thread_pool *pool, size_t items, sf_parallel_fn work, sf_parallel_wait_fn wait, void *user) {
    if (items == 0) return;
    begin_phase(pool, items, work, user);
    wait_for_phase(pool, wait, user);
}

void sf_thread_pool_destroy(sf_thread_pool *pool) {
    if (!pool) return;
    join_threads(pool);
    free(pool);
}
