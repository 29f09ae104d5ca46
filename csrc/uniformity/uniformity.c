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

static const char *name_at(unsigned kind) { return sf_discrepancy_kind_name((sf_discrepancy_kind)kind); }

sf_status sf_discrepancy_kind_find(const char *name, sf_discrepancy_kind *kind, sf_error *error) {
    unsigned index = 0;
    sf_status status = sf_name_find("kind", name, name_at, &index, error);
    if (status == SF_STATUS_OK) *kind = (sf_discrepancy_kind)index;
    return status;
}

/* ---- points ---- */

sf_status sf_uniformity_check(const double *points, size_t count, uint32_t dims, int closed, sf_error *error) {
    if (count < 1 || dims < 1)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "there are %zu points of %" PRIu32 " dimensions; give at least 1 of 1", count, dims);
    for (size_t i = 0; i < count * dims; ++i)
        if (!(points[i] >= 0.0 && (closed ? points[i] <= 1.0 : points[i] < 1.0)))
            return sf_fail(error, SF_STATUS_INVALID_VALUE,
                           "coordinate %zu of point %zu is %.17g; give values in [0,1%s", i % dims, i / dims, points[i],
                           closed ? "]" : ")");
    return SF_STATUS_OK;
}

sf_status sf_columns_init(sf_columns *columns, const double *points, size_t count, uint32_t dims, const size_t *order,
                          sf_error *error) {
    *columns = (sf_columns){.count = count, .stride = count, .dims = dims};
    columns->values = sf_aligned_alloc(count * dims * sizeof(double));
    if (!columns->values) return sf_fail_memory(error, "the points", count * dims * sizeof(double));
    for (size_t i = 0; i < count; ++i)
        for (uint32_t k = 0; k < dims; ++k) columns->values[k * count + i] = points[(order ? order[i] : i) * dims + k];
    return SF_STATUS_OK;
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

size_t *sf_order_by_first(const double *points, size_t count, uint32_t dims) {
    keyed_index *keyed = malloc(count * sizeof *keyed);
    size_t *order = malloc(count * sizeof *order);
    if (keyed && order) {
        for (size_t i = 0; i < count; ++i) keyed[i] = (keyed_index){points[i * dims], i};
        qsort(keyed, count, sizeof *keyed, compare_keys);
        for (size_t i = 0; i < count; ++i) order[i] = keyed[i].index;
    } else {
        free(order);
        order = NULL;
    }
    free(keyed);
    return order;
}

/* ---- discrepancies ---- */

typedef struct pairs_job {
    const sf_columns *points;
    double (*pair_sum)(const sf_columns *, size_t, size_t, size_t);
    double *sums; /* of each tile */
} pairs_job;

/* The sum over the rows of a tile and points begin .. end - 1. */
static double sum_rows(const pairs_job *job, size_t row, size_t rows, size_t begin, size_t end) {
    double total = 0.0;
    for (size_t n; begin < end; begin += n) {
        n = end - begin < SF_UNIFORMITY_BLOCK ? end - begin : SF_UNIFORMITY_BLOCK;
        double block = 0.0;
        for (size_t i = row; i < row + rows; ++i) block += job->pair_sum(job->points, i, begin, n);
        total += block;
    }
    return total;
}

/* A tile's own square, and twice what follows it: the terms are symmetric. */
static void sum_tile(void *user, unsigned worker, size_t item) {
    (void)worker;
    pairs_job *job = user;
    size_t count = job->points->count, row = item * TILE, rows = count - row < TILE ? count - row : TILE;
    job->sums[item] = sum_rows(job, row, rows, row, row + rows) + 2.0 * sum_rows(job, row, rows, row + rows, count);
}

static sf_status sum_pairs(sf_discrepancy_kind kind, const sf_columns *points, uint32_t threads, double *sum,
                           sf_error *error) {
    size_t tiles = (points->count + TILE - 1) / TILE;
    pairs_job job = {points, sf_uniformity_kernels_at(sf_isa_active())->pair_sum[kind], malloc(tiles * sizeof(double))};
    if (!job.sums) return sf_fail_memory(error, "the sums of pairs", tiles * sizeof(double));
    sf_parallel_for(sf_parallel_threads(threads, tiles), tiles, sum_tile, &job);
    *sum = 0.0;
    for (size_t i = 0; i < tiles; ++i) *sum += job.sums[i];
    free(job.sums);
    return SF_STATUS_OK;
}

static double sum_points(const kind_traits *kind, const sf_columns *points) {
    double total = 0.0;
    for (size_t i = 0; i < points->count; ++i) {
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
                         double *value, sf_error *error) {
    if ((unsigned)kind >= SF_DISCREPANCY_KIND_COUNT)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "kind is %d; kinds are 0 .. %d", (int)kind,
                       SF_DISCREPANCY_KIND_COUNT - 1);
    sf_status status = sf_uniformity_check(points, count, dims, 1, error);
    if (status != SF_STATUS_OK) return status;
    sf_columns columns;
    status = sf_columns_init(&columns, points, count, dims, NULL, error);
    if (status != SF_STATUS_OK) return status;
    double pairs = 0.0, n = (double)count, mean = power(kinds[kind].mean, dims);
    status = sum_pairs(kind, &columns, threads, &pairs, error);
    double singles = kind == SF_DISCREPANCY_WRAPAROUND ? n * mean : sum_points(&kinds[kind], &columns);
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

static void search_run(const distance_job *job, size_t i, size_t begin, size_t end, int across, double *least) {
    const double *first = job->points.values;
    for (size_t n; begin < end; begin += n) {
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
        search_run(job, i, i + 1, count, 0, &least);
        if (job->toroidal) search_run(job, i, 0, i, 1, &least);
    }
    job->least[worker] = least;
}

sf_status sf_minimum_distance(const double *points, size_t count, uint32_t dims, int toroidal, uint32_t threads,
                              double *distance, sf_error *error) {
    if (count < 2) return sf_fail(error, SF_STATUS_INVALID_VALUE, "there are %zu points; a distance needs 2", count);
    sf_status status = sf_uniformity_check(points, count, dims, 1, error);
    if (status != SF_STATUS_OK) return status;
    size_t *order = sf_order_by_first(points, count, dims), tiles = (count + TILE - 1) / TILE;
    if (!order) return sf_fail_memory(error, "the order of the points", count * sizeof *order);
    distance_job job = {.nearest = sf_uniformity_kernels_at(sf_isa_active())->nearest[toroidal != 0],
                        .toroidal = toroidal};
    status = sf_columns_init(&job.points, points, count, dims, order, error);
    free(order);
    if (status != SF_STATUS_OK) return status;
    unsigned used = sf_parallel_threads(threads, tiles);
    for (unsigned i = 0; i < used; ++i) job.least[i] = INFINITY;
    sf_parallel_for(used, tiles, search_tile, &job);
    double least = INFINITY;
    for (unsigned i = 0; i < used; ++i) least = job.least[i] < least ? job.least[i] : least;
    sf_columns_release(&job.points);
    *distance = sqrt(least);
    return SF_STATUS_OK;
}
