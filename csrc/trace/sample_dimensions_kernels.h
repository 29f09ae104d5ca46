// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#ifndef SUNFLECK_SAMPLE_DIMENSIONS_KERNELS_H
#define SUNFLECK_SAMPLE_DIMENSIONS_KERNELS_H

#include "base/isa_dispatch.h"
#include "film/block.h"
#include "trace/sample_dimensions.h"

typedef struct sf_sample_dimensions_kernels {
    /* Fills out[d][16 b + l] with coordinate d of the source for sample l of block b. */
    void (*fill)(const sf_sample_dimensions *coordinates, const sf_coordinate_source *source, const sf_block *blocks,
                 uint32_t block_count, float (*out)[SF_PATHS]);
    /* Fills out[d][width b + l] with that for sample first_sample + l, l below `width`, a power of two;
     * lanes past the blocks', up to a whole packet, with any number in [0, 1). */
    void (*fill_narrow)(const sf_sample_dimensions *coordinates, const sf_coordinate_source *source,
                        const sf_block *blocks, uint32_t block_count, uint32_t width, uint32_t first_sample,
                        float (*scratch)[SF_PATHS], float (*out)[SF_PATHS]);
} sf_sample_dimensions_kernels;
SF_KERNELS(sf_sample_dimensions_kernels)

#endif
