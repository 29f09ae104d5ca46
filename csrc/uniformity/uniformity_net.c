// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The t-value of a net, by counting points in elementary intervals. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/platform.h"
#include "uniformity/uniformity_parts.h"

enum { BLOCK = 1024, MAX_LEVELS = 33 };

#define STEPS_OF_EFFORT 0x1p30
#define STEPS_OF_A_THREAD 0x1p18 /* below, starting one takes longer */

typedef struct net {
    const sf_uniformity_kernels *kernels;
    size_t count; /* base^levels */
    uint32_t dims, base;
    unsigned levels, bits; /* bits: of a digit, where the base is 2^bits; else 0 */
    uint32_t powers[MAX_LEVELS];
    uint32_t *digits;                /* [dims][count]: the first `levels` digits of each coordinate */
    uint32_t *scratch;               /* [threads][count + dims] */
    unsigned threads, shares, level; /* shares: of a level's shapes, one a thread at work */
    sf_atomic_size failed;           /* 1 once an interval of the level has been found wrong */
    sf_watch watch;
} net;

static sf_status measure_count(net *n, sf_error *error) {
    uint64_t size = 1;
    while (size < n->count && n->levels + 1 < MAX_LEVELS) {
        n->powers[n->levels++] = (uint32_t)size;
        size *= n->base;
    }
    if (size == n->count && size <= UINT32_MAX) {
        n->powers[n->levels] = (uint32_t)size;
        return SF_STATUS_OK;
    }
    return sf_fail(error, SF_STATUS_INVALID_VALUE,
                   "there are %zu points; a net in base %" PRIu32 " has %" PRIu64 " or %" PRIu64, n->count, n->base,
                   size / n->base, size);
}

/* The digits of a coordinate as one number. In a base that is no power of 2, a border's double is
 * within 2^-53 of it and the product rounds by as much: 2^-50 of 1 is beyond both. */
static uint32_t digits_of(const net *n, double x) {
    double scaled = x * (double)n->count;
    if (n->bits) return (uint32_t)(int64_t)scaled;
    scaled += (double)n->count * 0x1p-50;
    return scaled < (double)n->count ? (uint32_t)(int64_t)scaled : (uint32_t)(n->count - 1);
}

/* Whether all intervals of base^-digits[k] in dimension k hold the same number of points; either where the watch
 * says stop. */
static int is_balanced(net *n, unsigned worker, const uint32_t *digits, uint32_t *counts) {
    uint32_t cells[BLOCK], held = n->powers[n->levels - n->level];
    memset(counts, 0, n->powers[n->level] * sizeof *counts);
    for (size_t first = 0; first < n->count; first += BLOCK) {
        size_t rows = n->count - first < BLOCK ? n->count - first : BLOCK;
        if (sf_watch_step_of(&n->watch, worker, BLOCK * (uint64_t)n->dims)) return 0;
        memset(cells, 0, sizeof cells);
        for (uint32_t k = 0; k < n->dims; ++k) {
            const uint32_t *column = n->digits + k * n->count + first;
            unsigned rest = n->levels - digits[k];
            if (digits[k] == 0) continue;
            if (n->bits)
                n->kernels->append_bits(rows, column, rest * n->bits, digits[k] * n->bits, cells);
            else
                n->kernels->append(rows, column, n->powers[rest], n->powers[digits[k]], cells);
        }
        for (size_t i = 0; i < rows; ++i) ++counts[cells[i]];
    }
    /* The counts add up to all points: where none is too large, none is too small. */
    uint32_t most = 0;
    for (size_t i = 0; i < n->powers[n->level]; ++i) most = counts[i] > most ? counts[i] : most;
    return most == held;
}

/* The next shape of the same number of digits in colexicographic order; 0 after the last. */
static int advance(uint32_t *digits, uint32_t dims) {
    uint32_t k = 0;
    while (k < dims && digits[k] == 0) ++k;
    if (k + 1 >= dims) return 0;
    uint32_t moved = digits[k] - 1;
    digits[k] = 0;
    digits[0] = moved;
    ++digits[k + 1];
    return 1;
}

/* Tests every shape of the level whose number is that of the share, modulo the shares. */
static void test_share(void *user, unsigned worker, size_t share) {
    net *n = user;
    uint32_t *counts = n->scratch + worker * (n->count + n->dims), *digits = counts + n->count;
    memset(digits, 0, n->dims * sizeof *digits);
    digits[0] = n->level;
    size_t shape = 0;
    do {
        if (shape++ % n->shares != share) continue;
        if (!is_balanced(n, worker, digits, counts)) sf_atomic_store(&n->failed, 1);
    } while (!sf_atomic_load(&n->failed) && advance(digits, n->dims));
}

/* C(level + dims - 1, level), the shapes of a level. */
static double shapes_of(unsigned level, uint32_t dims) {
    double shapes = 1.0;
    for (unsigned i = 1; i <= level; ++i) shapes = shapes * (double)(dims - 1 + i) / i;
    return shapes;
}

/* Raises the level until one fails, or all have passed. */
static sf_status climb(net *n, uint32_t effort, uint32_t *t, sf_error *error) {
    double steps = 0.0, most = effort * STEPS_OF_EFFORT;
    for (n->level = 1; n->level <= n->levels; ++n->level) {
        double level_steps = shapes_of(n->level, n->dims) * (double)n->dims * (double)n->count;
        steps += level_steps;
        if (effort && steps > most)
            return sf_fail(error, SF_STATUS_UNSUPPORTED,
                           "t is at most %u; to know more takes %.3g steps, of the %.3g that an effort of %" PRIu32
                           " allows",
                           n->levels - n->level + 1, level_steps, most, effort);
        n->shares = level_steps < STEPS_OF_A_THREAD ? 1 : n->threads;
        sf_parallel_for_watched(n->shares, n->shares, test_share, n, &n->watch);
        if (sf_watch_stopped(&n->watch)) return sf_watch_status(&n->watch, error);
        if (sf_atomic_load(&n->failed)) break;
    }
    *t = n->levels - n->level + 1;
    return SF_STATUS_OK;
}

static sf_status allocate(net *n, const double *points, sf_error *error) {
    size_t rows = n->count * n->dims, bytes = (rows + n->threads * (n->count + n->dims)) * sizeof(uint32_t);
    n->digits = sf_aligned_alloc(bytes);
    if (!n->digits) return sf_fail_memory(error, "the digits of the points", bytes);
    n->scratch = n->digits + rows;
    for (size_t i = 0; i < n->count && !sf_watch_step(&n->watch, 4 * (uint64_t)n->dims); ++i)
        for (uint32_t k = 0; k < n->dims; ++k) n->digits[k * n->count + i] = digits_of(n, points[i * n->dims + k]);
    return SF_STATUS_OK;
}

sf_status sf_net_t_value(const double *points, size_t count, uint32_t dims, uint32_t base, uint32_t effort,
                         uint32_t threads, uint32_t *t, const sf_interrupt *interrupt, sf_error *error) {
    if (base < 2 || base > 65536)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "base is %" PRIu32 "; give 2 to 65536", base);
    net n = {.kernels = sf_uniformity_kernels_at(sf_isa_active()), .count = count, .dims = dims, .base = base};
    sf_watch_begin(&n.watch, interrupt);
    sf_status status = sf_uniformity_check(points, count, dims, 0, &n.watch, error);
    if (status != SF_STATUS_OK) return status;
    status = measure_count(&n, error);
    if (status != SF_STATUS_OK) return status;
    for (uint32_t power = base; (power & 1) == 0; power >>= 1) ++n.bits;
    if (1u << n.bits != base) n.bits = 0;
    n.threads = sf_parallel_threads(threads, SF_PARALLEL_MAX_THREADS);
    status = allocate(&n, points, error);
    if (status != SF_STATUS_OK) return status;
    status = climb(&n, effort, t, error);
    sf_aligned_free(n.digits);
    return status;
}
