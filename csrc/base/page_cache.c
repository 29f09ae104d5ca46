// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Keeps the pages of the film destroyed last for the next one. */
#include "base/page_cache.h"

#include "base/platform.h"

static struct {
    pthread_mutex_t mutex;
    void *memory;
    size_t size; /* in whole pages */
} kept = {.mutex = PTHREAD_MUTEX_INITIALIZER};

void *sf_page_cache_take(size_t bytes) {
    void *memory = NULL;
    pthread_mutex_lock(&kept.mutex);
    if (kept.memory && kept.size == sf_pages_size(bytes)) {
        memory = kept.memory;
        kept.memory = NULL;
    }
    pthread_mutex_unlock(&kept.mutex);
    if (!memory) return sf_pages_alloc(bytes);
    memset(memory, 0, bytes);
    return memory;
}

void sf_page_cache_give(void *memory, size_t bytes) {
    size_t size = sf_pages_size(bytes);
    if (memory && size <= SF_PAGE_CACHE_KEPT) {
        pthread_mutex_lock(&kept.mutex);
        void *before = kept.memory;
        size_t size_before = kept.size;
        kept.memory = memory;
        kept.size = size;
        pthread_mutex_unlock(&kept.mutex);
        memory = before;
        bytes = size_before;
    }
    sf_pages_free(memory, bytes);
}
