// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What the measures of uniformity share: checked points, laid out by columns. Each function ends early, with
 * SF_STATUS_INTERRUPTED, where its watch says stop. */
#ifndef SUNFLECK_UNIFORMITY_PARTS_H
#define SUNFLECK_UNIFORMITY_PARTS_H

#include "base/interrupt.h"
#include "uniformity/uniformity_kernels.h"

/* Refuses no points, no dimensions, and a coordinate that is not in [0,1), or in [0,1] where
 * `closed`. */
sf_status sf_uniformity_check(const double *points, size_t count, uint32_t dims, int closed, sf_watch *watch,
                              sf_error *error);

/* The checked points by columns, those of one value of `order` (NULL: as they come) first; freed
 * with sf_columns_release. */
sf_status sf_columns_init(sf_columns *columns, const double *points, size_t count, uint32_t dims, const size_t *order,
                          sf_watch *watch, sf_error *error);
void sf_columns_release(sf_columns *columns);

/* Makes the indices 0 .. count - 1 in rising order of their points' first coordinates, equal ones by
 * index; freed with free. */
sf_status sf_order_by_first(const double *points, size_t count, uint32_t dims, size_t **order, sf_watch *watch,
                            sf_error *error);

#endif
