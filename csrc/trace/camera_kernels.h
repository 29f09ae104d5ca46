// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* How a batch's paths begin. */
#ifndef SUNFLECK_CAMERA_KERNELS_H
#define SUNFLECK_CAMERA_KERNELS_H

#include "base/isa_dispatch.h"
#include "trace/batch.h"

typedef struct sf_camera_kernels {
    /* Camera rays of every lane of the blocks, from coordinate[0 .. 1], and on a lens from
     * lens[0 .. 1]; NULL for a pinhole. */
    void (*camera)(sf_batch *batch, const sf_camera_frame *camera, sf_pixel_filter filter, float (*lens)[SF_PATHS]);
} sf_camera_kernels;
SF_KERNELS(sf_camera_kernels)

#endif
