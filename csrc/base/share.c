// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "base/share.h"

#include "base/platform.h"

typedef struct share {
    size_t items;
    sf_atomic_size next;
    sf_share_fn work;
    void *user;
} share;

typedef struct worker {
    share *common;
    unsigned number;
    pthread_t thread;
    int started;
} worker;

static void *work_items(void *argument) {
    const worker *self = argument;
    share *common = self->common;
    for (size_t item; (item = sf_atomic_fetch_add(&common->next, 1)) < common->items;)
        common->work(common->user, self->number, item);
    return NULL;
}

unsigned sf_share_threads(uint32_t threads, size_t items) {
    if (threads == 0) threads = sf_processor_count();
    if (threads > SF_SHARE_MAX_THREADS) threads = SF_SHARE_MAX_THREADS;
    if (items < threads) threads = (uint32_t)items;
    return threads ? threads : 1;
}

void sf_share_items(unsigned threads, size_t items, sf_share_fn work, void *user) {
    share common = {.items = items, .work = work, .user = user};
    worker workers[SF_SHARE_MAX_THREADS];
    for (unsigned i = 0; i < threads; ++i) workers[i] = (worker){.common = &common, .number = i};
    for (unsigned i = 1; i < threads; ++i)
        workers[i].started = pthread_create(&workers[i].thread, NULL, work_items, workers + i) == 0;
    work_items(workers);
    for (unsigned i = 1; i < threads; ++i)
        if (workers[i].started) pthread_join(workers[i].thread, NULL);
}
