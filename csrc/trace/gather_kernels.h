// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What a batch's paths brought, as statistics. */
#ifndef SUNFLECK_GATHER_KERNELS_H
#define SUNFLECK_GATHER_KERNELS_H

#include "base/isa_dispatch.h"
#include "trace/batch.h"

typedef struct sf_gather_kernels {
    /* The statistics of every block from radiance and covered. */
    void (*gather_statistics)(sf_batch *batch);
    /* The same under a filter with negative lobes: the samples where it is negative go to
     * negative_moments, the others, and the hits of both, to statistics. */
    void (*gather_by_sign)(sf_batch *batch);
} sf_gather_kernels;
SF_KERNELS(sf_gather_kernels)

#endif
