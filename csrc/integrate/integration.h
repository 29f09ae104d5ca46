// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What the parts of sf_integrate share: the run, its replicates and its components. */
#ifndef SUNFLECK_INTEGRATION_H
#define SUNFLECK_INTEGRATION_H

#include <math.h>

#include "base/error.h"
#include "base/interrupt.h"
#include "base/platform.h"
#include "sunfleck/estimate.h"
#include "sunfleck/integrate.h"

#define INTEGRATION_TAIL 256 /* extreme samples kept of either side, for the tail's index */

#define LOOKS_BACK 3 /* whose half-widths bound the next */

typedef struct replicate {
    uint64_t key;
    sf_point_set *set;
} replicate;

/* What one replicate has seen of one component, in units of the component's. */
typedef struct tally {
    sf_moments moments;
    double least, greatest;
} tally;

/* The largest of the values offered: up to twice as many as are kept, until the rest is dropped. */
typedef struct tail {
    size_t count;
    double floor; /* what is not above it is not among them */
    double value[2 * INTEGRATION_TAIL];
} tail;

/* A look before: points of each replicate, and the half-width as the means had it. */
typedef struct past_look {
    double points, half_width;
} past_look;

/* One component of the function's values. */
typedef struct component {
    tally *tallies;             /* one a replicate */
    tail up, down;              /* of the values and of the negated values, all replicates' */
    double unit;                /* values are kept times this power of two: 1, or less where squares would overflow */
    past_look past[LOOKS_BACK]; /* the latest first */
    sf_confidence_sequence sequence;
    sf_integral *result;
} component;

typedef struct integration {
    sf_integrate_options options;
    sf_integrand function;
    void *user;
    sf_error *error;
    uint32_t components, looks;
    int independent; /* points: each sample is a replicate */
    int grows;       /* later points go on after earlier ones */
    int shifted, folded;
    int offset_in_common; /* of all points of a copy, within their strata, in some dimension */
    uint64_t samples;
    uint64_t points;   /* of each replicate, at the last look */
    size_t block_rows; /* of each replicate in a block */
    double volume;     /* of finite bounds; 1 where an end is infinite */
    double *coordinates, *values, *weights, *column;
    replicate *replicate;
    component *component;
    tally *tallies;
    sf_watch watch;
} integration;

/* ---- points (integrate_points.c) ---- */

sf_status sf_integration_find_randomization(integration *in, uint64_t total);
/* Brings every replicate to `points` points. */
sf_status sf_integration_take_points(integration *in, uint64_t points, int *stopped);

/* ---- values and what they say (integrate_judge.c) ---- */

int sf_integration_range_is_known(const integration *in);
/* Takes `count` values of every component of a replicate, with their weights where there are bounds. */
sf_status sf_integration_take_values(integration *in, uint32_t r, size_t count, const double *values,
                                     const double *weights);
void sf_integration_forget(integration *in);
void sf_integration_estimate(const integration *in, component *c, double *value, double *half_width);
/* The mean of what was seen, NaN where nothing was. */
double sf_integration_mean(const integration *in, const component *c);
int sf_integration_is_suspicious(const integration *in, const component *c);

#endif
