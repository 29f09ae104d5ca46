// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "gather_kernels.h"

#include <math.h>

#include "lanes.h"

/* keep[l] = 1 where the sample was asked for and is finite, else 0. */
static inline void choose_samples(const sf_batch *b, uint32_t first, uint32_t wanted, uint32_t width, float *keep) {
    SF_ROLLED
    for (uint32_t l = 0; l < width; ++l) {
        float sum = b->radiance[0][first + l] + b->radiance[1][first + l] + b->radiance[2][first + l];
        float asked = (float)(int)(wanted >> l & 1u);
        keep[l] = fabsf(sum) <= 3.4e38f ? asked : 0.0f;
    }
}

/* The lanes of a block are summed as if there were 16, those that it lacks being 0. */
static inline void gather_lanes(const sf_batch *b, uint32_t block, uint32_t wanted, uint32_t width,
                                sf_block_statistics *out) {
    uint32_t first = block * width;
    SF_ALIGNED(float) keep[SF_LANES];
    SF_ALIGNED(double) value[SF_LANES], squares[SF_LANES] = {0};
    choose_samples(b, first, wanted, width, keep);
    SF_ROLLED
    for (uint32_t l = 0; l < width; ++l) value[l] = (double)keep[l];
    double count = sf_sum_lanes(value, width), inverse = count > 0 ? 1 / count : 0;
    for (int c = 0; c < 3; ++c) {
        const float *radiance = b->radiance[c] + first;
        SF_ROLLED
        for (uint32_t l = 0; l < width; ++l) value[l] = (double)(keep[l] > 0 ? radiance[l] : 0.0f);
        double mean = out->moments.mean[c] = sf_sum_lanes(value, width) * inverse;
        SF_ROLLED
        for (uint32_t l = 0; l < width; ++l) {
            double off = (double)keep[l] * (value[l] - mean);
            squares[l] += off * off;
        }
    }
    SF_ROLLED
    for (uint32_t l = 0; l < width; ++l) value[l] = (double)(keep[l] * b->covered[first + l]);
    out->hits = (uint32_t)(int)sf_sum_lanes(value, width);
    out->moments.m2 = sf_sum_lanes(squares, width);
    out->moments.count = (uint64_t)(int)count;
    out->moments.nonfinite = (uint64_t)sf_count_bits(wanted) - out->moments.count;
}

/* Each width with loops of its own. */
static void gather_block(const sf_batch *b, uint32_t block, uint32_t wanted, sf_block_statistics *out) {
    switch (b->width) {
        case 1: gather_lanes(b, block, wanted, 1, out); break;
        case 2: gather_lanes(b, block, wanted, 2, out); break;
        case 4: gather_lanes(b, block, wanted, 4, out); break;
        case 8: gather_lanes(b, block, wanted, 8, out); break;
        default: gather_lanes(b, block, wanted, SF_LANES, out); break;
    }
}

static void gather_statistics(sf_batch *b) {
    for (uint32_t block = 0; block < b->block_count; ++block)
        gather_block(b, block, sf_batch_wanted(b, block), b->statistics + block);
}

static void gather_by_sign(sf_batch *b) {
    for (uint32_t block = 0; block < b->block_count; ++block) {
        sf_block_statistics negative;
        uint32_t active = sf_batch_wanted(b, block);
        gather_block(b, block, active & ~b->negative[block], b->statistics + block);
        gather_block(b, block, active & b->negative[block], &negative);
        b->statistics[block].hits += negative.hits;
        b->negative_moments[block] = negative.moments;
    }
}

const sf_gather_kernels SF_AT_LEVEL(sf_gather_kernels) = {gather_statistics, gather_by_sign};
