// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Pages that outlive a film. The system clears what it gives, page by page, and under a virtual machine may
 * have to fetch it first, which takes up to a hundred times as long as to clear it: the pages of the film destroyed
 * last, up to SF_PAGE_CACHE_KEPT bytes, are the next one's if it is as large. */
#ifndef SUNFLECK_PAGE_CACHE_H
#define SUNFLECK_PAGE_CACHE_H

#include <stddef.h>

#define SF_PAGE_CACHE_KEPT ((size_t)64 << 20)

/* Zero bytes, as from sf_pages_alloc: NULL when there is no memory. Thread-safe. */
void *sf_page_cache_take(size_t bytes);
void sf_page_cache_give(void *memory, size_t bytes);

#endif
