// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Discrepancies in closed form, and the minimum distance. */
#include "sunfleck/uniformity.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>

#include "base/error.h"
#include "base/name.h"
#include "base/parallel.h"
#include "base/platform.h"
#include "uniformity/uniformity_parts.h"

/* Rows of points whose pairs are one item of work. */
#define TILE 32

/* Points that are sorted by the C library at a time, since it cannot be interrupted. */
#define RUN ((size_t)1 << 16)

/* ---- kinds ---- */

/* The discrepancy is mean^dims - 2 S1 / n + S2 / n^2: S1 sums over the points the product of a
 * term of one coordinate, S2 over the pairs that of a term of two. */
typedef struct kind_traits {
    const char *name, *description;
    double mean;
    double (*term)(double x);
} kind_traits;

static double centered_term(double x) {
    double d = fabs(x - 0.5);
    return 1.0 + 0.5 * d * (1.0 - d);
}
static double wraparound_term(double x) {
    (void)x;
    return 4.0 / 3.0;
}
static double mixture_term(double x) {
    double d = fabs(x - 0.5);
    return 5.0 / 3.0 - 0.25 * d * (1.0 + d);
}
static double l2_star_term(double x) { return 0.5 * (1.0 - x * x); }

static const kind_traits kinds[SF_DISCREPANCY_KIND_COUNT] = {
    [SF_DISCREPANCY_CENTERED] = {"centered", "boxes from the nearest corner, squared (Hickernell 1998)", 13.0 / 12.0,
                                 centered_term},
    [SF_DISCREPANCY_WRAPAROUND] = {"wraparound", "boxes on the torus, squared (Hickernell 1998)", 4.0 / 3.0,
                                   wraparound_term},
    [SF_DISCREPANCY_MIXTURE] = {"mixture", "of centered and wraparound, squared (Zhou, Fang & Ning 2013)", 19.0 / 12.0,
                                mixture_term},
    [SF_DISCREPANCY_L2_STAR] = {"l2-star", "boxes from the origin, not squared (Warnock 1972)", 1.0 / 3.0,
                                l2_star_term},
};

const char *sf_discrepancy_kind_name(sf_discrepancy_kind kind) {
    return (unsigned)kind < SF_DISCREPANCY_KIND_COUNT ? kinds[kind].name : NULL;
}
const char *sf_discrepancy_kind_description(sf_discrepancy_kind kind) {
    return (unsigned)kind < SF_DISCREPANCY_KIND_COUNT ? kinds[kind].description : NULL;
}

static const char *name_at(int kind) { return sf_discrepancy_kind_name((sf_discrepancy_kind)kind); }

sf_status sf_discrepancy_kind_find(const char *name, sf_discrepancy_kind *kind, sf_error *error) {
    int index = 0;
    sf_status status = sf_name_find("kind", name, name_at, &index, error);
    if (status == SF_STATUS_OK) *kind = (sf_discrepancy_kind)index;
    return status;
}

/* ---- points ---- */

sf_status sf_uniformity_check(const double *points, size_t count, uint32_t dims, int closed, sf_watch *watch,
                              sf_error *error) {
    if (count < 1 || dims < 1)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "there are %zu points of %" PRIu32 " dimensions; give at least 1 of 1", count, dims);
    for (size_t i = 0; i < count * dims && !sf_watch_item(watch, i); ++i)
        if (!(points[i] >= 0.0 && (closed ? points[i] <= 1.0 : points[i] < 1.0)))
            return sf_fail(error, SF_STATUS_INVALID_VALUE,
                           "coordinate %zu of point %zu is %.17g; give values in [0,1%s", i % dims, i / dims, points[i],
                           closed ? "]" : ")");
    return sf_watch_status(watch, error);
}

sf_status sf_columns_init(sf_columns *columns, const double *points, size_t count, uint32_t dims, const size_t *order,
                          sf_watch *watch, sf_error *error) {
    *columns = (sf_columns){.count = count, .stride = count, .dims = dims};
    columns->values = sf_aligned_alloc(count * dims * sizeof(double));
    if (!columns->values) return sf_fail_memory(error, "the points", count * dims * sizeof(double));
    /* A value to each cache line of its column, whose reading costs some 4 ns. */
    for (size_t i = 0; i < count && !sf_watch_step(watch, 4 * (uint64_t)dims); ++i)
        for (uint32_t k = 0; k < dims; ++k) columns->values[k * count + i] = points[(order ? order[i] : i) * dims + k];
    sf_status status = sf_watch_status(watch, error);
    if (status != SF_STATUS_OK) sf_columns_release(columns);
    return status;
}

void sf_columns_release(sf_columns *columns) {
    sf_aligned_free(columns->values);
    columns->values = NULL;
}

typedef struct keyed_index {
    double key;
    size_t index;
} keyed_index;

static int compare_keys(const void *left, const void *right) {
    const keyed_index *a = left, *b = right;
    if (a->key != b->key) return a->key < b->key ? -1 : 1;
    return a->index < b->index ? -1 : a->index > b->index;
}

/* Merges sorted runs first .. middle - 1 and middle .. end - 1. */
static void merge_runs(const keyed_index *from, size_t first, size_t middle, size_t end, keyed_index *to,
                       sf_watch *watch) {
    size_t left = first, right = middle;
    for (size_t i = first; i < end && !sf_watch_item(watch, i); ++i) {
        int takes_left = left < middle && (right == end || compare_keys(&from[left], &from[right]) < 0);
        to[i] = from[takes_left ? left++ : right++];
    }
}

/* Sorts by the C library in runs, then merges them between the two arrays; returns the one that has the result. */
static keyed_index *sort_keys(keyed_index *keyed, keyed_index *other, size_t count, sf_watch *watch) {
    for (size_t first = 0; first < count && !sf_watch_step(watch, 100 * RUN); first += RUN)
        qsort(keyed + first, count - first < RUN ? count - first : RUN, sizeof *keyed, compare_keys);
    for (size_t run = RUN; run < count && !sf_watch_stopped(watch); run *= 2) {
        for (size_t first = 0; first < count; first += 2 * run) {
            size_t middle = count - first < run ? count : first + run,
                   end = count - middle < run ? count : middle + run;
            merge_runs(keyed, first, middle, end, other, watch);
        }
        keyed_index *merged = other;
        other = keyed;
        keyed = merged;
    }
    return keyed;
}

sf_status sf_order_by_first(const double *points, size_t count, uint32_t dims, size_t **order, sf_watch *watch,
                            sf_error *error) {
    size_t bytes = (count > RUN ? 2 : 1) * count * sizeof(keyed_index);
    keyed_index *keyed = malloc(bytes), *sorted;
    *order = malloc(count * sizeof **order);
    sf_status status = SF_STATUS_OK;
    if (keyed && *order) {
        for (size_t i = 0; i < count && !sf_watch_item(watch, i); ++i) keyed[i] = (keyed_index){points[i * dims], i};
        sorted = sf_watch_stopped(watch) ? keyed : sort_keys(keyed, keyed + (count > RUN ? count : 0), count, watch);
        for (size_t i = 0; i < count && !sf_watch_item(watch, i); ++i) (*order)[i] = sorted[i].index;
        status = sf_watch_status(watch, error);
    } else {
        status = sf_fail_memory(error, "the order of the points", bytes + count * sizeof **order);
    }
    if (status != SF_STATUS_OK) {
        free(*order);
        *order = NULL;
    }
    free(keyed);
    return status;
}

/* ---- discrepancies ---- */

typedef struct pairs_job {
    const sf_columns *points;
    double (*pair_sum)(const sf_columns *, size_t, size_t, size_t);
    double *sums; /* of each tile */
    sf_watch *watch;
} pairs_job;

/* The sum over the rows of a tile and points begin .. end - 1. */
static double sum_rows(const pairs_job *job, unsigned worker, size_t row, size_t rows, size_t begin, size_t end) {
    double total = 0.0;
    for (size_t n; begin < end; begin += n) {
        if (sf_watch_step_of(job->watch, worker, (uint64_t)rows * SF_UNIFORMITY_BLOCK * job->points->dims)) break;
        n = end - begin < SF_UNIFORMITY_BLOCK ? end - begin : SF_UNIFORMITY_BLOCK;
        double block = 0.0;
        for (size_t i = row; i < row + rows; ++i) block += job->pair_sum(job->points, i, begin, n);
        total += block;
    }
    return total;
}

/* A tile's own square, and twice what follows it: the terms are symmetric. */
static void sum_tile(void *user, unsigned worker, size_t item) {
    pairs_job *job = user;
    size_t count = job->points->count, row = item * TILE, rows = count - row < TILE ? count - row : TILE;
    double own = sum_rows(job, worker, row, rows, row, row + rows);
    job->sums[item] = own + 2.0 * sum_rows(job, worker, row, rows, row + rows, count);
}

static sf_status sum_pairs(sf_discrepancy_kind kind, const sf_columns *points, uint32_t threads, double *sum,
                           sf_watch *watch, sf_error *error) {
    size_t tiles = (points->count + TILE - 1) / TILE;
    pairs_job job = {points, sf_uniformity_kernels_at(sf_isa_active())->pair_sum[kind], malloc(tiles * sizeof(double)),
                     watch};
    if (!job.sums) return sf_fail_memory(error, "the sums of pairs", tiles * sizeof(double));
    sf_parallel_for_watched(sf_parallel_threads(threads, tiles), tiles, sum_tile, &job, watch);
    *sum = 0.0;
    for (size_t i = 0; i < tiles && !sf_watch_stopped(watch); ++i) *sum += job.sums[i];
    free(job.sums);
    return sf_watch_status(watch, error);
}

static double sum_points(const kind_traits *kind, const sf_columns *points, sf_watch *watch) {
    double total = 0.0;
    for (size_t i = 0; i < points->count && !sf_watch_step(watch, 4 * (uint64_t)points->dims); ++i) {
        double product = 1.0;
        for (uint32_t k = 0; k < points->dims; ++k) product *= kind->term(points->values[k * points->stride + i]);
        total += product;
    }
    return total;
}

/* base^exponent by squaring: rounds the same everywhere, which libm's pow need not. */
static double power(double base, uint32_t exponent) {
    double result = 1.0;
    for (; exponent; exponent >>= 1, base *= base)
        if (exponent & 1) result *= base;
    return result;
}

sf_status sf_discrepancy(sf_discrepancy_kind kind, const double *points, size_t count, uint32_t dims, uint32_t threads,
                         double *value, const sf_interrupt *interrupt, sf_error *error) {
    if ((unsigned)kind >= SF_DISCREPANCY_KIND_COUNT)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "kind is %d; kinds are 0 .. %d", (int)kind,
                       SF_DISCREPANCY_KIND_COUNT - 1);
    sf_watch watch;
    sf_watch_begin(&watch, interrupt);
    sf_status status = sf_uniformity_check(points, count, dims, 1, &watch, error);
    if (status != SF_STATUS_OK) return status;
    sf_columns columns;
    status = sf_columns_init(&columns, points, count, dims, NULL, &watch, error);
    if (status != SF_STATUS_OK) return status;
    double pairs = 0.0, n = (double)count, mean = power(kinds[kind].mean, dims);
    status = sum_pairs(kind, &columns, threads, &pairs, &watch, error);
    double singles = kind == SF_DISCREPANCY_WRAPAROUND ? n * mean : sum_points(&kinds[kind], &columns, &watch);
    if (status == SF_STATUS_OK) status = sf_watch_status(&watch, error);
    sf_columns_release(&columns);
    if (status != SF_STATUS_OK) return status;
    double square = mean - 2.0 * singles / n + pairs / n / n;
    if (!(fabs(square) <= DBL_MAX) || mean < DBL_MIN)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "d is %" PRIu32 "; the terms of the %s discrepancy of so many are beyond a double", dims,
                       kinds[kind].name);
    *value = kind != SF_DISCREPANCY_L2_STAR ? square : square > 0.0 ? sqrt(square) : 0.0;
    return SF_STATUS_OK;
}

/* ---- minimum distance ---- */

typedef struct distance_job {
    sf_columns points; /* in rising order of the first coordinate */
    double (*nearest)(const sf_columns *, size_t, size_t, size_t);
    int toroidal;
    double least[SF_PARALLEL_MAX_THREADS]; /* squared, that each worker has seen */
    sf_watch watch;
} distance_job;

/* The end of the run, from `begin` to at most `end`, of points whose first coordinates are less than
 * sqrt(least) away from x, directly or across the border: no point beyond is nearer, since gaps
 * grow along the run. */
static size_t run_end(const double *first, double x, size_t begin, size_t end, int across, double least) {
    while (begin < end) {
        size_t middle = begin + (end - begin) / 2;
        double d = across ? 1.0 - (x - first[middle]) : first[middle] - x; /* as the kernel rounds it */
        if (d * d < least)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin;
}

static void search_run(distance_job *job, unsigned worker, size_t i, size_t begin, size_t end, int across,
                       double *least) {
    const double *first = job->points.values;
    for (size_t n; begin < end; begin += n) {
        if (sf_watch_step_of(&job->watch, worker, SF_UNIFORMITY_BLOCK * (uint64_t)job->points.dims)) return;
        end = run_end(first, first[i], begin, end, across, *least);
        if (begin >= end) break;
        n = end - begin < SF_UNIFORMITY_BLOCK ? end - begin : SF_UNIFORMITY_BLOCK;
        double found = job->nearest(&job->points, i, begin, n);
        if (found < *least) *least = found;
    }
}

static void search_tile(void *user, unsigned worker, size_t item) {
    distance_job *job = user;
    size_t count = job->points.count, row = item * TILE, last = count - row < TILE ? count : row + TILE;
    double least = job->least[worker];
    for (size_t i = row; i < last; ++i) {
        search_run(job, worker, i, i + 1, count, 0, &least);
        if (job->toroidal) search_run(job, worker, i, 0, i, 1, &least);
    }
    job->least[worker] = least;
}

sf_status sf_minimum_distance(const double *points, size_t count, uint32_t dims, int toroidal, uint32_t threads,
                              double *distance, const sf_interrupt *interrupt, sf_error *error) {
    if (count < 2) return sf_fail(error, SF_STATUS_INVALID_VALUE, "there are %zu points; a distance needs 2", count);
    distance_job job = {.nearest = sf_uniformity_kernels_at(sf_isa_active())->nearest[toroidal != 0],
                        .toroidal = toroidal};
    sf_watch_begin(&job.watch, interrupt);
    size_t *order, tiles = (count + TILE - 1) / TILE;
    sf_status status = sf_uniformity_check(points, count, dims, 1, &job.watch, error);
    if (status != SF_STATUS_OK) return status;
    status = sf_order_by_first(points, count, dims, &order, &job.watch, error);
    if (status != SF_STATUS_OK) return status;
    status = sf_columns_init(&job.points, points, count, dims, order, &job.watch, error);
    free(order);
    if (status != SF_STATUS_OK) return status;
    unsigned used = sf_parallel_threads(threads, tiles);
    for (unsigned i = 0; i < used; ++i) job.least[i] = INFINITY;
    sf_parallel_for_watched(used, tiles, search_tile, &job, &job.watch);
    double least = INFINITY;
    for (unsigned i = 0; i < used; ++i) least = job.least[i] < least ? job.least[i] : least;
    sf_columns_release(&job.points);
    status = sf_watch_status(&job.watch, error);
    if (status == SF_STATUS_OK) *distance = sqrt(least);
    return status;
}
