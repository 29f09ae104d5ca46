// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Alias tables, and the checks of sunfleck/discrete.h. */

#include <math.h>
#include <stdlib.h>

#include "base/error.h"
#include "mapping/discrete_values.h"
#include "mapping/mapping_kernels.h"
#include "sunfleck/discrete.h"
#include "sunfleck/elementary.h"

sf_status sf_check_weights(const char *who, const double *weights, size_t count, double *largest, sf_watch *watch,
                           sf_error *error) {
    *largest = 0.0;
    for (size_t i = 0; i < count; ++i) {
        if (!(weights[i] >= 0.0 && weights[i] < (double)INFINITY))
            return sf_fail(error, SF_STATUS_INVALID_VALUE,
                           "%s: weights[%zu] is %.17g; it must be finite and at least 0", who, i, weights[i]);
        if (weights[i] > *largest) *largest = weights[i];
        if (sf_watch_item(watch, i)) return sf_watch_status(watch, error);
    }
    if (*largest > 0.0) return SF_STATUS_OK;
    return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s: all %zu weights are 0; one must be positive", who, count);
}

sf_status sf_check_unit_f32(const char *who, const char *name, const float *values, size_t count, sf_error *error) {
    size_t i = sf_mapping_kernels_at(sf_isa_active())->outside_f32(count, values, 0.0f, SF_UNIT_MAX_F);
    if (i == count) return SF_STATUS_OK;
    return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s: value %zu of %s is %.9g; it must be in [0,1)", who, i, name,
                   (double)values[i]);
}

sf_status sf_check_unit_f64(const char *who, const char *name, const double *values, size_t count, sf_error *error) {
    size_t i = sf_mapping_kernels_at(sf_isa_active())->outside_f64(count, values, 0.0, SF_UNIT_MAX);
    if (i == count) return SF_STATUS_OK;
    return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s: value %zu of %s is %.17g; it must be in [0,1)", who, i, name,
                   values[i]);
}

/* Fills up the columns of `share`, whose mean is 1: those below 1 take what they lack from one that
 * has more, which may then lack itself. `order` has room for n. Ends early where the watch says stop. */
static void fill_columns(double *share, size_t n, uint32_t *order, float *keep, uint32_t *alias, sf_watch *watch) {
    size_t small = 0, large = n, most = 0; /* small ones from the front of `order`, large from the back */
    for (size_t i = 0; i < n; ++i) {
        order[share[i] < 1.0 ? small++ : --large] = (uint32_t)i;
        if (share[i] > share[most]) most = i;
        if (sf_watch_item(watch, i)) return;
    }
    for (size_t filled = 0; small > 0 && large < n; ++filled) {
        uint32_t s = order[--small], l = order[large];
        keep[s] = (float)share[s];
        alias[s] = l;
        share[l] -= 1.0 - share[s];
        if (share[l] < 1.0) {
            ++large;
            order[small++] = l;
        }
        if (sf_watch_item(watch, filled)) return;
    }
    /* What is left is full, but for rounding. A column that lost its whole weight must not come
     * back: it goes to the heaviest. */
    while (large < n) {
        uint32_t l = order[large++];
        keep[l] = 1.0f;
        alias[l] = l;
    }
    while (small > 0) {
        uint32_t s = order[--small];
        keep[s] = share[s] > 0.5 ? 1.0f : 0.0f;
        alias[s] = share[s] > 0.5 ? s : (uint32_t)most;
    }
}

/* Each weight over the largest, and their sum. */
static double scale_weights(const double *weights, size_t count, double largest, double *scaled, sf_watch *watch) {
    double total = 0.0;
    for (size_t i = 0; i < count && !sf_watch_item(watch, i); ++i) total += scaled[i] = weights[i] / largest;
    return total;
}

static sf_status check(const double *weights, size_t count, double *largest, sf_watch *watch, sf_error *error) {
    if (count < 1 || count > UINT32_MAX)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "alias table: count is %zu; it must be 1 .. 2^32 - 1", count);
    return sf_check_weights("alias table", weights, count, largest, watch, error);
}

/* Of weights that are checked. */
static sf_status build(const double *weights, size_t count, double largest, float *keep, uint32_t *alias,
                       sf_watch *watch, sf_error *error) {
    sf_status status;
    double *share = malloc(count * sizeof *share);
    uint32_t *order = malloc(count * sizeof *order);
    if (share && order) {
        double total = scale_weights(weights, count, largest, share, watch);
        for (size_t i = 0; i < count && !sf_watch_item(watch, i); ++i) share[i] *= (double)count / total;
        if (!sf_watch_stopped(watch)) fill_columns(share, count, order, keep, alias, watch);
        status = sf_watch_status(watch, error);
    } else {
        status = sf_fail_memory(error, "an alias table", count * (sizeof *share + sizeof *order));
    }
    free(share);
    free(order);
    return status;
}

sf_status sf_alias_build(const double *weights, size_t count, float *keep, uint32_t *alias, sf_error *error) {
    double largest;
    sf_watch watch;
    sf_watch_begin(&watch, NULL);
    sf_status status = check(weights, count, &largest, &watch, error);
    return status ? status : build(weights, count, largest, keep, alias, &watch, error);
}

/* ---- the table as an object ---- */

struct sf_alias_table {
    size_t count;
    float *keep;
    uint32_t *alias;
    double *pdf;
};

void sf_alias_table_destroy(sf_alias_table *table) {
    if (!table) return;
    free(table->keep);
    free(table->alias);
    free(table->pdf);
    free(table);
}

sf_status sf_alias_table_create(const double *weights, size_t count, sf_alias_table **table,
                                const sf_interrupt *interrupt, sf_error *error) {
    *table = NULL;
    double largest;
    sf_watch watch;
    sf_watch_begin(&watch, interrupt);
    sf_status status = check(weights, count, &largest, &watch, error);
    if (status) return status;
    sf_alias_table *made = calloc(1, sizeof *made);
    if (!made) return sf_fail_memory(error, "an alias table", sizeof *made);
    made->count = count;
    made->keep = malloc(count * sizeof *made->keep);
    made->alias = malloc(count * sizeof *made->alias);
    made->pdf = malloc(count * sizeof *made->pdf);
    if (!made->keep || !made->alias || !made->pdf)
        status = sf_fail_memory(error, "an alias table", count * 16);
    else
        status = build(weights, count, largest, made->keep, made->alias, &watch, error);
    if (!status) {
        double total = scale_weights(weights, count, largest, made->pdf, &watch);
        for (size_t i = 0; i < count && !sf_watch_item(&watch, i); ++i) made->pdf[i] /= total;
        status = sf_watch_status(&watch, error);
    }
    if (status)
        sf_alias_table_destroy(made);
    else
        *table = made;
    return status;
}

size_t sf_alias_table_count(const sf_alias_table *table) { return table->count; }

sf_status sf_alias_table_sample_fill_f32(const sf_alias_table *table, size_t count, const float *u, uint32_t *index,
                                         sf_error *error) {
    sf_status status = sf_check_unit_f32("alias table", "u", u, count, error);
    if (!status && table->count > ((size_t)1 << 24))
        status = sf_fail(error, SF_STATUS_INVALID_VALUE,
                         "alias table: %zu entries; a float reaches 2^24 at most, give doubles", table->count);
    float rest;
    if (!status)
        for (size_t i = 0; i < count; ++i)
            index[i] = sf_alias_pick(table->keep, table->alias, (uint32_t)table->count, u[i], &rest);
    return status;
}

sf_status sf_alias_table_sample_fill_f64(const sf_alias_table *table, size_t count, const double *u, uint32_t *index,
                                         sf_error *error) {
    sf_status status = sf_check_unit_f64("alias table", "u", u, count, error);
    for (size_t i = 0; !status && i < count; ++i) {
        double scaled = u[i] * (double)table->count;
        size_t column = (size_t)scaled < table->count ? (size_t)scaled : table->count - 1;
        index[i] = scaled - (double)column < (double)table->keep[column] ? (uint32_t)column : table->alias[column];
    }
    return status;
}

static sf_status check_indices(const sf_alias_table *table, size_t count, const uint32_t *index, int must_have_weight,
                               sf_error *error) {
    for (size_t i = 0; i < count; ++i) {
        if (index[i] >= table->count)
            return sf_fail(error, SF_STATUS_INVALID_VALUE, "alias table: index %zu is %u; it must be 0 .. %zu", i,
                           (unsigned)index[i], table->count - 1);
        if (must_have_weight && !(table->keep[index[i]] > 0.0f))
            return sf_fail(error, SF_STATUS_INVALID_VALUE,
                           "alias table: index %zu is %u, whose weight is 0; no u leads to it", i, (unsigned)index[i]);
    }
    return SF_STATUS_OK;
}

sf_status sf_alias_table_pdf_fill(const sf_alias_table *table, size_t count, const uint32_t *index, double *pdf,
                                  sf_error *error) {
    sf_status status = check_indices(table, count, index, 0, error);
    for (size_t i = 0; !status && i < count; ++i) pdf[i] = table->pdf[index[i]];
    return status;
}

sf_status sf_alias_table_invert_fill(const sf_alias_table *table, size_t count, const uint32_t *index, double *u,
                                     sf_error *error) {
    sf_status status = check_indices(table, count, index, 1, error);
    for (size_t i = 0; !status && i < count; ++i)
        u[i] = ((double)index[i] + 0.5 * (double)table->keep[index[i]]) / (double)table->count;
    return status;
}
