// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#ifndef SUNFLECK_SAMPLE_DIMENSIONS_HALTON_KERNELS_H
#define SUNFLECK_SAMPLE_DIMENSIONS_HALTON_KERNELS_H

#include "base/isa_dispatch.h"
#include "film/block.h"
#include "trace/sample_dimensions.h"

typedef struct sf_sample_dimensions_halton_kernels {
    /* Fills out[d][16 b + l] with sf_halton_sample(base + l, first + d, key) of block b, bit for bit.
     * Per call some 40 divisions for each dimension; per block and dimension 20 to 48 permuted
     * digits. */
    void (*fill)(const sf_coordinate_source *source, const sf_block *blocks, uint32_t block_count,
                 float (*out)[SF_PATHS]);
} sf_sample_dimensions_halton_kernels;
SF_KERNELS(sf_sample_dimensions_halton_kernels)

#endif
