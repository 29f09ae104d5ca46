// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "base/pool.h"

#include <errno.h>

#include "base/error.h"
#include "base/platform.h"

#define WAIT_NANOSECONDS 50000000L

struct sf_pool {
    pthread_mutex_t mutex;
    pthread_cond_t start, finish;
    pthread_t *threads;
    unsigned count;      /* threads running */
    unsigned working;    /* of these, still in the phase */
    unsigned long phase; /* counts up as phases start */
    bool ending;
    size_t items;
    sf_atomic_size next;
    sf_pool_work_fn work;
    void *user;
};

typedef struct worker {
    sf_pool *pool;
    unsigned number;
} worker;

static void *work_phases(void *argument) {
    worker self = *(worker *)argument;
    free(argument);
    sf_pool *pool = self.pool;
    unsigned mode = sf_flush_denormals();
    unsigned long seen = 0;
    pthread_mutex_lock(&pool->mutex);
    for (;;) {
        while (pool->phase == seen && !pool->ending) pthread_cond_wait(&pool->start, &pool->mutex);
        if (pool->ending) break;
        seen = pool->phase;
        pthread_mutex_unlock(&pool->mutex);
        for (size_t item; (item = sf_atomic_fetch_add(&pool->next, 1)) < pool->items;)
            pool->work(pool->user, self.number, item);
        pthread_mutex_lock(&pool->mutex);
        if (--pool->working == 0) pthread_cond_signal(&pool->finish);
    }
    pthread_mutex_unlock(&pool->mutex);
    sf_restore_denormals(mode);
    return NULL;
}

static bool start_thread(sf_pool *pool) {
    worker *self = malloc(sizeof *self);
    if (!self) return false;
    *self = (worker){pool, pool->count};
    if (pthread_create(pool->threads + pool->count, NULL, work_phases, self) != 0) {
        free(self);
        return false;
    }
    ++pool->count;
    return true;
}

sf_status sf_pool_create(unsigned threads, sf_pool **out, sf_error *error) {
    *out = NULL;
    sf_pool *pool = calloc(1, sizeof *pool);
    if (!pool) return sf_fail_memory(error, "the threads", sizeof *pool);
    pthread_condattr_t clock;
    pthread_condattr_init(&clock);
    pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
    pthread_mutex_init(&pool->mutex, NULL);
    pthread_cond_init(&pool->start, NULL);
    pthread_cond_init(&pool->finish, &clock);
    pthread_condattr_destroy(&clock);
    pool->threads = malloc(threads * sizeof *pool->threads);
    while (pool->threads && pool->count < threads && start_thread(pool)) continue;
    if (pool->count < threads) {
        unsigned started = pool->count;
        sf_pool_destroy(pool);
        return sf_fail(error, SF_STATUS_OUT_OF_MEMORY, "only %u of %u threads could be started; ask for fewer", started,
                       threads);
    }
    *out = pool;
    return SF_STATUS_OK;
}

void sf_pool_run(sf_pool *pool, size_t count, sf_pool_work_fn work, sf_pool_wait_fn wait, void *user) {
    if (count == 0) return;
    pthread_mutex_lock(&pool->mutex);
    pool->items = count;
    pool->work = work;
    pool->user = user;
    pool->working = pool->count;
    sf_atomic_store(&pool->next, 0);
    ++pool->phase;
    pthread_cond_broadcast(&pool->start);
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

void sf_pool_destroy(sf_pool *pool) {
    if (!pool) return;
    pthread_mutex_lock(&pool->mutex);
    pool->ending = true;
    pthread_cond_broadcast(&pool->start);
    pthread_mutex_unlock(&pool->mutex);
    for (unsigned i = 0; i < pool->count; ++i) pthread_join(pool->threads[i], NULL);
    pthread_cond_destroy(&pool->start);
    pthread_cond_destroy(&pool->finish);
    pthread_mutex_destroy(&pool->mutex);
    free(pool->threads);
    free(pool);
}
