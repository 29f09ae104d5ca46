// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What alias.c and piecewise.c share: their checks of weights and of values in [0,1). */
#ifndef SUNFLECK_DISCRETE_VALUES_H
#define SUNFLECK_DISCRETE_VALUES_H

#include "base/interrupt.h"

/* Refuses weights that are negative or not finite, or all 0; gives the largest. Ends early, interrupted, where the
 * watch says stop. */
sf_status sf_check_weights(const char *who, const double *weights, size_t count, double *largest, sf_watch *watch,
                           sf_error *error);

/* Refuses the first of `count` values that is not in [0,1). */
sf_status sf_check_unit_f32(const char *who, const char *name, const float *values, size_t count, sf_error *error);
sf_status sf_check_unit_f64(const char *who, const char *name, const double *values, size_t count, sf_error *error);

#endif
