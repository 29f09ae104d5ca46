// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#ifndef SUNFLECK_MAPPING_KERNELS_H
#define SUNFLECK_MAPPING_KERNELS_H

#include "base/isa_dispatch.h"
#include "sunfleck/mapping.h"

#define SF_MAPPING_MAX_COMPONENTS 12 /* of all parameters of a mapping together */

typedef enum sf_mapping_verb {
    SF_MAPPING_SAMPLE = 0,
    SF_MAPPING_PDF,
    SF_MAPPING_INVERT,
    SF_MAPPING_WEIGHT,
    SF_MAPPING_VERB_COUNT
} sf_mapping_verb;

/* One bulk call, checked. Rows are packed; parameter k has `components[k]` values every
 * `strides[k]`, at a pointer to the values' type. */
typedef struct sf_mapping_job {
    sf_mapping mapping;
    sf_mapping_verb verb;
    size_t count, in_width, out_width; /* widths 1 .. 3 */
    const void *in;
    void *out;
    size_t parameter_count;
    size_t components[SF_MAPPING_MAX_PARAMETERS], strides[SF_MAPPING_MAX_PARAMETERS];
    const void *parameters[SF_MAPPING_MAX_PARAMETERS];
} sf_mapping_job;

typedef struct sf_mapping_kernels {
    void (*run_f32)(const sf_mapping_job *job);
    void (*run_f64)(const sf_mapping_job *job);
    /* The first of `count` values that is not in [low, high] (NaN is not); count if all are. */
    size_t (*outside_f32)(size_t count, const float *values, float low, float high);
    size_t (*outside_f64)(size_t count, const double *values, double low, double high);
} sf_mapping_kernels;

SF_KERNELS(sf_mapping_kernels)

#endif
