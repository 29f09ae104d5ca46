// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The star discrepancy: exactly where that is affordable, else between bounds. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/platform.h"
#include "uniformity/uniformity_parts.h"

#define EXACT_STEPS 0x1.1p32 /* some seconds */
#define MAX_BOXES (UINT64_C(1) << 20)
#define MAX_COVER_DIMS 32 /* 2^16 boxes have a weight of 0.75 there; beyond, bounds say next to nothing */

static double larger(double a, double b) { return a > b ? a : b; }

/* ---- exactly ----
 *
 * The share of points in a box less its volume is greatest for a closed box whose every upper
 * side touches a point; the volume less the share, for an open box whose every upper side touches
 * a point or the cube's. Coordinates dims - 1 down to 2 are enumerated, the points inside kept;
 * in the last two a sweep along coordinate 0 keeps coordinate 1 sorted (Bundschuh & Zhu 1993 give
 * the sweep's formula in 2 dimensions). */

typedef struct exact_search {
    const sf_columns *points; /* in rising order of coordinate 0 */
    const sf_uniformity_kernels *kernels;
    int closed;
    double best;
    double *closed_share, *open_share; /* (j + 1) / n and j / n, j = 0 .. n */
    double *sorted;                    /* coordinate 1 of the points swept, rising; then 1 */
    double *sides;                     /* [dims][count + 1]: the sides tried in each dimension */
    uint32_t *inside;                  /* [dims][count]: the points inside, in the order of coordinate 0 */
    sf_watch *watch;
} exact_search;

static int compare_doubles(const void *left, const void *right) {
    double a = *(const double *)left, b = *(const double *)right;
    return a < b ? -1 : a > b;
}

static void insert(double *sorted, size_t count, double value) {
    size_t begin = 0, end = count;
    while (begin < end) {
        size_t middle = begin + (end - begin) / 2;
        if (sorted[middle] < value)
            begin = middle + 1;
        else
            end = middle;
    }
    memmove(sorted + begin + 1, sorted + begin, (count - begin) * sizeof *sorted);
    sorted[begin] = value;
}

/* The boxes of sides x and each of those in `sorted`, of which `swept` are points'. */
static void try_column(exact_search *s, size_t swept, double volume) {
    double greatest, least;
    if (s->closed) {
        s->kernels->extremes(swept, s->closed_share, s->sorted, volume, &greatest, &least);
        s->best = larger(s->best, greatest);
    } else {
        s->kernels->extremes(swept + 1, s->open_share, s->sorted, volume, &greatest, &least);
        s->best = larger(s->best, -least);
    }
}

/* All boxes over coordinates 0 and 1 of the `count` points listed; `volume` is that of the others. */
static void sweep(exact_search *s, const uint32_t *inside, size_t count, double volume) {
    const double *x = s->points->values, *y = x + s->points->stride;
    s->sorted[0] = 1.0;
    for (size_t i = 0; i < count && !sf_watch_step(s->watch, i + 32);) {
        double side = x[inside[i]];
        if (!s->closed) try_column(s, i, volume * side);
        for (; i < count && x[inside[i]] == side; ++i) insert(s->sorted, i + 1, y[inside[i]]);
        if (s->closed) try_column(s, i, volume * side);
    }
    if (!s->closed) try_column(s, count, volume);
}

/* The sides to try in a dimension, without repeats, rising. */
static size_t list_sides(exact_search *s, uint32_t dimension, const uint32_t *inside, size_t count) {
    double *sides = s->sides + dimension * (s->points->count + 1);
    const double *x = s->points->values + dimension * s->points->stride;
    size_t distinct = 0;
    for (size_t i = 0; i < count; ++i) sides[i] = x[inside[i]];
    qsort(sides, count, sizeof *sides, compare_doubles);
    for (size_t i = 0; i < count; ++i)
        if (i == 0 || sides[i] != sides[i - 1]) sides[distinct++] = sides[i];
    if (!s->closed) sides[distinct++] = 1.0;
    return distinct;
}

static void visit(exact_search *s, uint32_t dimension, const uint32_t *inside, size_t count, double volume) {
    if (dimension < 2) {
        sweep(s, inside, count, volume);
        return;
    }
    const double *x = s->points->values + dimension * s->points->stride;
    double *sides = s->sides + dimension * (s->points->count + 1);
    uint32_t *kept = s->inside + dimension * s->points->count;
    for (size_t i = 0, n = list_sides(s, dimension, inside, count); i < n; ++i) {
        size_t within = 0;
        if (sf_watch_step(s->watch, count)) return;
        for (size_t k = 0; k < count; ++k) {
            kept[within] = inside[k];
            within += s->closed ? x[inside[k]] <= sides[i] : x[inside[k]] < sides[i];
        }
        /* No box in here can beat its share of points, if closed, or its volume. */
        double most = s->closed ? (double)within / (double)s->points->count : volume * sides[i];
        if (most > s->best) visit(s, dimension - 1, kept, within, volume * sides[i]);
    }
}

/* In one dimension, of sorted points: Niederreiter 1992, "Random number generation and quasi-Monte
 * Carlo methods", theorem 2.6. */
static void scan(exact_search *s) {
    enum { RUN = 1 << 16 };
    for (size_t first = 0, n; first < s->points->count && !sf_watch_step(s->watch, RUN); first += n) {
        double greatest, least;
        n = s->points->count - first < RUN ? s->points->count - first : RUN;
        s->kernels->extremes(n, s->closed_share + first, s->points->values + first, 1.0, &greatest, &least);
        s->best = larger(s->best, greatest);
        s->kernels->extremes(n, s->open_share + first, s->points->values + first, 1.0, &greatest, &least);
        s->best = larger(s->best, -least);
    }
}

static sf_status search_exactly(const sf_columns *points, double *star, sf_watch *watch, sf_error *error) {
    size_t n = points->count, row = n + 1;
    size_t bytes = (3 + points->dims) * row * sizeof(double) + (points->dims + 1) * n * sizeof(uint32_t);
    double *memory = malloc(bytes);
    if (!memory) return sf_fail_memory(error, "the boxes of the star discrepancy", bytes);
    exact_search s = {.points = points, .kernels = sf_uniformity_kernels_at(sf_isa_active()), .watch = watch};
    s.closed_share = memory;
    s.open_share = memory + row;
    s.sorted = memory + 2 * row;
    s.sides = memory + 3 * row;
    s.inside = (uint32_t *)(void *)(s.sides + points->dims * row);
    uint32_t *all = s.inside + points->dims * n;
    for (size_t j = 0; j < n; ++j) all[j] = (uint32_t)j;
    for (size_t j = 0; j <= n && !sf_watch_item(watch, j); ++j) {
        s.closed_share[j] = (double)(j + 1) / (double)n;
        s.open_share[j] = (double)j / (double)n;
    }
    if (points->dims == 1) scan(&s);
    for (s.closed = 0; points->dims > 1 && s.closed < 2; ++s.closed) visit(&s, points->dims - 1, all, n, 1.0);
    free(memory);
    sf_status status = sf_watch_status(watch, error);
    if (status == SF_STATUS_OK) *star = s.best;
    return status;
}

/* ---- between bounds ----
 *
 * Thiemard 2001: a cover of the cube by boxes [low, high] with volume(high) - volume(low) <= weight.
 * For a box [0,y) with y in one of them, the points in [0,low) are inside and those not in
 * [0,high) are outside. */

typedef struct cover {
    const sf_columns *points; /* NULL: only count the boxes */
    uint32_t dims;
    double weight;
    uint64_t boxes, most; /* so far; where to give up */
    double *low, *high;
    uint32_t *candidates; /* the points; those below `high` come first */
    double lower, upper;
    sf_watch *watch; /* asked with every box; the cover is then cut short */
} cover;

static double coordinate(const cover *c, uint32_t point, uint32_t k) {
    return c->points->values[k * c->points->stride + point];
}

/* A box of the cover, of whose points below `high` there are `count`. */
static void take_box(cover *c, size_t count, double low_volume, double high_volume) {
    size_t inside = 0;
    double n = (double)c->points->count, tight = 1.0;
    for (size_t i = 0; i < count; ++i) {
        uint32_t k = 0;
        while (k < c->dims && coordinate(c, c->candidates[i], k) < c->low[k]) ++k;
        inside += k == c->dims;
    }
    /* The closed box that the points below `high` just fill. */
    for (uint32_t k = 0; k < c->dims && (double)count / n > c->lower; ++k) {
        double side = 0.0;
        for (size_t i = 0; i < count; ++i) side = larger(side, coordinate(c, c->candidates[i], k));
        tight *= side;
    }
    c->upper = larger(c->upper, larger((double)count / n - low_volume, high_volume - (double)inside / n));
    c->lower = larger(c->lower, larger((double)count / n - tight, high_volume - (double)count / n));
    c->lower = larger(c->lower, larger(low_volume - (double)inside / n, (double)inside / n - low_volume));
}

/* Moves the candidates below `side` in dimension k to the front; returns how many. */
static size_t keep_below(cover *c, size_t count, uint32_t k, double side) {
    size_t below = 0;
    for (size_t i = 0; c->points && i < count; ++i) {
        uint32_t point = c->candidates[i];
        if (!(coordinate(c, point, k) < side)) continue;
        c->candidates[i] = c->candidates[below];
        c->candidates[below++] = point;
    }
    return below;
}

/* Covers [low, high], where low is 0 from dimension `first` on: one box of the full weight at the
 * upper corner, and a slab below it in each of those dimensions. */
static void cover_box(cover *c, uint32_t first, size_t count) {
    uint64_t values = (uint64_t)c->dims * ((c->points ? count : 0) + 8);
    if (sf_watch_step(c->watch, values)) return;
    double fixed = 1.0, volume = 1.0;
    for (uint32_t k = 0; k < c->dims; ++k) {
        if (k < first) fixed *= c->low[k];
        volume *= c->high[k];
    }
    double low_volume = 0.0, shrink = 0.0;
    if (volume > c->weight) {
        double movable = fixed;
        for (uint32_t k = first; k < c->dims; ++k) movable *= c->high[k];
        shrink = pow((volume - c->weight) / movable, 1.0 / (double)(c->dims - first));
        low_volume = volume - c->weight;
    }
    for (uint32_t k = first; shrink > 0.0 && k < c->dims && c->boxes < c->most; ++k) {
        double side = c->high[k], below = side * shrink;
        c->high[k] = below;
        cover_box(c, k, keep_below(c, count, k, below));
        c->high[k] = side;
        c->low[k] = below;
    }
    ++c->boxes;
    if (c->points) take_box(c, count, low_volume, volume);
    for (uint32_t k = first; k < c->dims; ++k) c->low[k] = 0.0;
}

static void cover_cube(cover *c, double weight) {
    c->weight = weight;
    c->boxes = 0;
    for (uint32_t k = 0; k < c->dims; ++k) {
        c->low[k] = 0.0;
        c->high[k] = 1.0;
    }
    cover_box(c, 0, c->points ? c->points->count : 0);
}

/* The least weight, to within 2 %, at which `boxes` boxes are enough. */
static double find_weight(cover *c, uint64_t boxes) {
    double enough = 1.0, few = 1.0;
    if (c->dims > MAX_COVER_DIMS) return 1.0;
    c->most = boxes + 1;
    do {
        enough = few;
        few *= 0.5;
        cover_cube(c, few);
    } while (c->boxes <= boxes && !sf_watch_stopped(c->watch));
    while (enough - few > 0.02 * few && !sf_watch_stopped(c->watch)) {
        double middle = 0.5 * (enough + few);
        cover_cube(c, middle);
        *(c->boxes <= boxes ? &enough : &few) = middle;
    }
    return enough;
}

static sf_status search_bounds(const sf_columns *points, uint64_t boxes, double *lower, double *upper, sf_watch *watch,
                               sf_error *error) {
    size_t bytes = 2 * points->dims * sizeof(double) + points->count * sizeof(uint32_t);
    double *memory = malloc(bytes);
    if (!memory) return sf_fail_memory(error, "the cover of the star discrepancy", bytes);
    cover c = {.dims = points->dims, .low = memory, .high = memory + points->dims, .watch = watch};
    c.candidates = (uint32_t *)(void *)(memory + 2 * points->dims);
    for (size_t i = 0; i < points->count; ++i) c.candidates[i] = (uint32_t)i;
    double weight = find_weight(&c, boxes);
    c.points = points;
    c.most = UINT64_MAX;
    cover_cube(&c, weight);
    free(memory);
    sf_status status = sf_watch_status(watch, error);
    if (status != SF_STATUS_OK) return status;
    *lower = c.lower;
    *upper = c.upper < 1.0 ? c.upper : 1.0;
    return SF_STATUS_OK;
}

/* A sweep costs about (count + 32)^2, and there is one for each choice of the other sides. */
static double exact_steps(size_t count, uint32_t dims) {
    double steps = dims < 2 ? 1.0 : ((double)count + 32.0) * ((double)count + 32.0);
    for (uint32_t k = 2; k < dims && steps <= EXACT_STEPS; ++k) steps *= (double)count + 1.0;
    return steps;
}

sf_status sf_star_discrepancy(const double *points, size_t count, uint32_t dims, uint64_t boxes, double *lower,
                              double *upper, const sf_interrupt *interrupt, sf_error *error) {
    sf_watch watch;
    sf_watch_begin(&watch, interrupt);
    sf_status status = sf_uniformity_check(points, count, dims, 0, &watch, error);
    if (status != SF_STATUS_OK) return status;
    if (count > UINT32_MAX)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "there are %zu points; give at most 4294967295", count);
    if (boxes < 1 || boxes > MAX_BOXES)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "boxes is %" PRIu64 "; give 1 to %" PRIu64, boxes, MAX_BOXES);
    size_t *order;
    status = sf_order_by_first(points, count, dims, &order, &watch, error);
    if (status != SF_STATUS_OK) return status;
    sf_columns columns;
    status = sf_columns_init(&columns, points, count, dims, order, &watch, error);
    free(order);
    if (status != SF_STATUS_OK) return status;
    if (exact_steps(count, dims) <= EXACT_STEPS) {
        status = search_exactly(&columns, lower, &watch, error);
        if (status == SF_STATUS_OK) *upper = *lower;
    } else {
        status = search_bounds(&columns, boxes, lower, upper, &watch, error);
    }
    sf_columns_release(&columns);
    return status;
}
