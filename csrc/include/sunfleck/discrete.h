// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* discrete: sampling in proportion to weights that are given by data: one of n things (alias
 * table), a place on a line or in a square with a piecewise constant density (environment maps).
 *
 * Objects are made once (`create`), never change, and may be read by any number of threads;
 * `destroy(NULL)` is legal. Weights are finite and at least 0, one of them at least positive; what
 * has weight 0 is never drawn, not even by the largest u. The bulk calls refuse what is not in
 * range before they write anything; f32 and f64 give u's type. */
#ifndef SUNFLECK_DISCRETE_H
#define SUNFLECK_DISCRETE_H

#include "sunfleck/base.h"

#ifdef __cplusplus
extern "C" {
#endif

#include "sunfleck/exact_begin.h"

/* ---- alias table: one of n in constant time ---- */

/* Fills the columns of an alias table: column i keeps its own entry below keep[i] and has alias[i]
 * above. Walker 1977, in the linear-time form of Vose 1991.
 *
 * weights  count values; their sum may overflow
 * keep     count floats in [0,1]; a probability is off by 2^-25 / count at most
 * alias    count indices, of entries whose weight is positive; i itself where keep is 1
 * count    1 .. 2^32 - 1
 *
 * Takes 12 bytes an entry while it runs. Thread-safe. */
SF_API sf_status sf_alias_build(const double *weights, size_t count, float *keep, uint32_t *alias, sf_error *error);

/* The entry for u in [0,1). `rest`, which may not be NULL, is what u has left: uniform in [0,1) again,
 * with log2(count) bits fewer. */
static inline uint32_t sf_alias_pick(const float *keep, const uint32_t *alias, uint32_t count, float u, float *rest) {
    float scaled = u * (float)count;
    uint32_t column = (uint32_t)(int64_t)scaled, own;
    column = column < count - 1 ? column : count - 1;
    float within = scaled - (float)column, part = keep[column];
    own = within < part;
    float low = own ? 0.0f : part, width = own ? part : 1.0f - part;
    float left = (within - low) / (width > 0.0f ? width : 1.0f);
    *rest = left < 0x1.fffffep-1f ? left : 0x1.fffffep-1f;
    return own ? column : alias[column];
}

typedef struct sf_alias_table sf_alias_table;

/* Copies what it needs of the weights: 16 bytes an entry. There is no table where `interrupt` (NULL: none) says stop.
 */
SF_API sf_status sf_alias_table_create(const double *weights, size_t count, sf_alias_table **table,
                                       const sf_interrupt *interrupt, sf_error *error);
SF_API void sf_alias_table_destroy(sf_alias_table *table);
SF_API size_t sf_alias_table_count(const sf_alias_table *table);

/* Entries for `count` values u in [0,1). f32 takes tables of up to 2^24 entries, since a float has
 * no more values. */
SF_API sf_status sf_alias_table_sample_fill_f32(const sf_alias_table *table, size_t count, const float *u,
                                                uint32_t *index, sf_error *error);
SF_API sf_status sf_alias_table_sample_fill_f64(const sf_alias_table *table, size_t count, const double *u,
                                                uint32_t *index, sf_error *error);
/* The probability of each index: its weight over the sum of all. */
SF_API sf_status sf_alias_table_pdf_fill(const sf_alias_table *table, size_t count, const uint32_t *index, double *pdf,
                                         sf_error *error);
/* For each index the middle of the values u, in its own column, that sample takes to it. An index of
 * weight 0 is refused. */
SF_API sf_status sf_alias_table_invert_fill(const sf_alias_table *table, size_t count, const uint32_t *index, double *u,
                                            sf_error *error);

/* ---- piecewise constant densities ---- */

typedef struct sf_piecewise sf_piecewise;

/* On the unit interval: `count` cells of equal width, 1 .. 2^24. On the unit square: rows of
 * `columns` cells, row 0 at y = 0, each 1 .. 2^24. They keep 12 bytes a cell. A cell of less than
 * 2^-53 of its row's weight has density 0. There is no density where `interrupt` (NULL: none) says stop. */
SF_API sf_status sf_piecewise_create_1d(const double *weights, size_t count, sf_piecewise **piecewise,
                                        const sf_interrupt *interrupt, sf_error *error);
SF_API sf_status sf_piecewise_create_2d(const double *weights, size_t columns, size_t rows, sf_piecewise **piecewise,
                                        const sf_interrupt *interrupt, sf_error *error);
SF_API void sf_piecewise_destroy(sf_piecewise *piecewise);

/* Values in a point of it: 1 or 2. */
SF_API size_t sf_piecewise_width(const sf_piecewise *piecewise);

/* Maps `count` points of `width` values. sample: u in [0,1) to x in [0,1), monotone along each axis (the
 * row by the last value, then the place in it), so that strata stay whole; pdf: the density at x
 * in [0,1), whose mean over the unit interval or square is 1; invert: x back to u. Time: a guide
 * table (Chen & Asau 1974) leads to within a step or two of the cell, and never more than the
 * logarithm of the row's length. */
SF_API sf_status sf_piecewise_sample_fill_f32(const sf_piecewise *piecewise, size_t count, const float *u, float *x,
                                              sf_error *error);
SF_API sf_status sf_piecewise_sample_fill_f64(const sf_piecewise *piecewise, size_t count, const double *u, double *x,
                                              sf_error *error);
SF_API sf_status sf_piecewise_pdf_fill_f32(const sf_piecewise *piecewise, size_t count, const float *x, float *pdf,
                                           sf_error *error);
SF_API sf_status sf_piecewise_pdf_fill_f64(const sf_piecewise *piecewise, size_t count, const double *x, double *pdf,
                                           sf_error *error);
SF_API sf_status sf_piecewise_invert_fill_f32(const sf_piecewise *piecewise, size_t count, const float *x, float *u,
                                              sf_error *error);
SF_API sf_status sf_piecewise_invert_fill_f64(const sf_piecewise *piecewise, size_t count, const double *x, double *u,
                                              sf_error *error);

#include "sunfleck/exact_end.h"

#ifdef __cplusplus
}
#endif
#endif
