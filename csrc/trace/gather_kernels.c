// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Gathers the radiance of a batch's paths into statistics of its blocks. */
#include "trace/gather_kernels.h"

#include <math.h>

#include "trace/lanes.h"

/* keep[l] = 1 where the sample was asked for and is finite, else 0. Returns how many are kept. */
static inline uint32_t choose_samples(const sf_batch *b, uint32_t first, uint32_t wanted, uint32_t width,
                                      uint32_t *keep) {
    uint32_t count = 0;
    SF_ROLLED
    for (uint32_t l = 0; l < width; ++l) {
        float sum = b->radiance[0][first + l] + b->radiance[1][first + l] + b->radiance[2][first + l];
        keep[l] = (uint32_t)(fabsf(sum) <= 3.4e38f) & wanted >> l;
        count += keep[l] &= 1u;
    }
    return count;
}

/* Mean and squares of the lanes kept, which are `count`: all, or those that `keep` says. The lanes of a
 * block are summed as if there were 16, those that it lacks being 0. */
static inline void sum_samples(const sf_batch *b, uint32_t first, uint32_t width, uint32_t count, bool all,
                               const uint32_t *keep, sf_vector_moments *out) {
    SF_ALIGNED(double) value[SF_LANES], squares[SF_LANES] = {0};
    double inverse = count > 0 ? 1 / (double)count : 0;
    for (int c = 0; c < 3; ++c) {
        const float *radiance = b->radiance[c] + first;
        SF_ROLLED
        for (uint32_t l = 0; l < width; ++l) value[l] = (double)(all || keep[l] ? radiance[l] : 0.0f);
        double mean = out->mean[c] = sf_sum_lanes(value, width) * inverse;
        SF_ROLLED
        for (uint32_t l = 0; l < width; ++l) {
            double off = all || keep[l] ? value[l] - mean : 0.0;
            squares[l] += off * off;
        }
    }
    out->count = count;
    out->m2 = sf_sum_lanes(squares, width);
}

static inline void gather_lanes(uint32_t width, const sf_batch *b, uint32_t block, uint32_t wanted,
                                sf_block_statistics *out) {
    uint32_t first = block * width, hits = 0;
    SF_ALIGNED(uint32_t) keep[SF_LANES];
    uint32_t count = choose_samples(b, first, wanted, width, keep);
    if (count == width)
        sum_samples(b, first, width, width, true, keep, &out->moments);
    else
        sum_samples(b, first, width, count, false, keep, &out->moments);
    SF_ROLLED
    for (uint32_t l = 0; l < width; ++l) hits += keep[l] & (uint32_t)(b->covered[first + l] > 0);
    out->hits = hits;
    out->moments.nonfinite = sf_count_bits(wanted) - count;
}

static void gather_block(const sf_batch *b, uint32_t block, uint32_t wanted, sf_block_statistics *out) {
    SF_AT_WIDTH(b->width, gather_lanes, b, block, wanted, out)
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

const sf_gather_kernels SF_AT_ISA(sf_gather_kernels) = {gather_statistics, gather_by_sign};
