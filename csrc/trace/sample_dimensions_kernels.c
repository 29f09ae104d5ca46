// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Fills the sample coordinates of blocks, for each pattern in a loop of its own. */
#include "trace/sample_dimensions_kernels.h"

#include <stdbool.h>

#include "base/platform.h"
#include "trace/lanes.h"
#include "trace/sample_dimensions_halton_kernels.h"

/* The key of a set of dimensions in one block, and from it of each dimension. */
static uint64_t set_key(uint64_t block_key, uint32_t set) {
    return sf_mix64(block_key + (set + 1) * UINT64_C(0x9e3779b97f4a7c15));
}
static uint64_t dimension_key(uint64_t key, uint32_t dimension) {
    return sf_mix64(key + (dimension + 1) * UINT64_C(0xd1342543de82ef95));
}

/* ---- sobol ---- */

/* The table's sum over all but the last four bits of an index. */
static uint32_t sobol_start(const uint32_t table[4][256], uint32_t index) {
    return table[0][index & 0xf0u] ^ table[1][index >> 8 & 255u] ^ table[2][index >> 16 & 255u] ^ table[3][index >> 24];
}

/* Of 0 .. 15, their four bits reversed, at the top. */
static const uint32_t reversed_lanes[SF_LANES] = {
    0x0u << 28, 0x8u << 28, 0x4u << 28, 0xcu << 28, 0x2u << 28, 0xau << 28, 0x6u << 28, 0xeu << 28,
    0x1u << 28, 0x9u << 28, 0x5u << 28, 0xdu << 28, 0x3u << 28, 0xbu << 28, 0x7u << 28, 0xfu << 28};

/* What is of a block, for its lanes; in those past the end, up to a whole packet, 0. */
static inline void spread(const uint32_t *SF_RESTRICT values, uint32_t count, uint32_t width,
                          uint32_t *SF_RESTRICT out) {
    for (uint32_t b = 0; b < count; ++b)
        for (uint32_t l = 0; l < width; ++l) out[b * width + l] = values[b];
    for (uint32_t l = count * width; l % SF_LANES; ++l) out[l] = 0;
}

/* Sixteen floats of words with their bits reversed. */
static inline void scramble_packet(const uint32_t *SF_RESTRICT words, const uint32_t *SF_RESTRICT seeds,
                                   float *SF_RESTRICT out) {
    SF_ALIGNED(uint32_t) bits[SF_LANES];
    for (uint32_t l = 0; l < SF_LANES; ++l) bits[l] = sf_owen_hash32(words[l], seeds[l]);
    sf_reverse_bits_each(bits, SF_LANES);
    for (uint32_t l = 0; l < SF_LANES; ++l) out[l] = sf_float_from_bits(bits[l]);
}

/* What the lanes' last four bits add to the words of their blocks, by indices that are given with their
 * bits reversed. */
static inline void add_lanes(const uint32_t table[256], const uint32_t *SF_RESTRICT reversed, uint32_t count,
                             uint32_t *SF_RESTRICT words) {
    uint32_t column0 = table[1], column1 = table[2], column2 = table[4], column3 = table[8];
    for (uint32_t l = 0; l < count; ++l) {
        uint32_t i = reversed[l];
        words[l] ^= ((0u - (i >> 31)) & column0) ^ ((0u - (i >> 30 & 1u)) & column1) ^
                    ((0u - (i >> 29 & 1u)) & column2) ^ ((0u - (i >> 28 & 1u)) & column3);
    }
}

/* The samples of blocks that have the same indices, in the set's own order: packets differ by their
 * seeds alone. */
static inline void fill_in_step(const uint32_t table[4][256], uint32_t base, const uint32_t *SF_RESTRICT seeds,
                                uint32_t lanes, uint32_t width, uint32_t first_sample, float *SF_RESTRICT out) {
    SF_ALIGNED(uint32_t) words[SF_LANES];
    uint32_t start = sobol_start(table, base);
    for (uint32_t l = 0; l < SF_LANES; ++l) words[l] = start ^ table[0][first_sample + l % width];
    for (uint32_t l = 0; l < lanes; l += SF_LANES) scramble_packet(words, seeds + l, out + l);
}

/* The samples first_sample .. first_sample + width - 1 of the blocks, which share packets where they are
 * fewer than 16. The set's order keeps the 16 samples of a block together: they differ in the last four
 * bits of their indices, and the rest of an index hangs on the rest of it alone. What is of the
 * blocks is made for the whole batch, and then what is of the lanes, so that no packet waits for it. */
static inline void fill_sobol(uint32_t width, const sf_sample_dimensions *coordinates,
                              const sf_coordinate_source *source, const sf_block *blocks, uint32_t count,
                              uint32_t first_sample, float (*SF_RESTRICT out)[SF_PATHS]) {
    uint64_t keys[SF_BLOCKS];
    uint32_t bases[SF_BLOCKS], seeds[SF_BLOCKS], starts[SF_BLOCKS], indices[SF_BLOCKS], differ = source->set;
    SF_ALIGNED(uint32_t) reversed[SF_PATHS];
    SF_ALIGNED(uint32_t) lane_seeds[SF_PATHS];
    SF_ALIGNED(uint32_t) words[SF_PATHS];
    uint32_t lanes = count * width;
    for (uint32_t b = 0; b < count; ++b) {
        keys[b] = set_key(blocks[b].key, source->set);
        differ |= blocks[b].base ^ blocks[0].base;
    }
    if (differ)
        for (uint32_t b = 0; b < count; ++b) {
            bases[b] = sf_reverse_bits32(blocks[b].base);
            seeds[b] = (uint32_t)(keys[b] >> 32);
            indices[b] = sf_reverse_bits32(source->set ? sf_owen_hash32(bases[b], seeds[b]) : bases[b]);
            for (uint32_t l = 0; l < width; ++l) reversed[b * width + l] = bases[b] | reversed_lanes[first_sample + l];
        }
    if (source->set) {
        spread(seeds, count, width, lane_seeds);
        for (uint32_t l = 0; l < lanes; ++l) reversed[l] = sf_owen_hash32(reversed[l], lane_seeds[l]);
    }
    for (uint32_t d = 0; d < source->count; ++d) {
        const uint32_t (*table)[256] = coordinates->sobol[source->dimension + d];
        for (uint32_t b = 0; b < count; ++b) seeds[b] = (uint32_t)dimension_key(keys[b], source->dimension + d);
        spread(seeds, count, width, lane_seeds);
        if (!differ) {
            fill_in_step(table, blocks[0].base, lane_seeds, lanes, width, first_sample, out[d]);
            continue;
        }
        for (uint32_t b = 0; b < count; ++b) starts[b] = sobol_start(table, indices[b]);
        spread(starts, count, width, words);
        add_lanes(table[0], reversed, lanes, words);
        for (uint32_t l = 0; l < lanes; l += SF_LANES) scramble_packet(words + l, lane_seeds + l, out[d] + l);
    }
}

/* ---- random ---- */

/* Two rounds of a 32-bit mix, a half of the key before each (the mix: Wellons 2018, "Prospecting
 * for Hash Functions", lowbias32). */
static uint32_t mix32(uint32_t x) {
    x = (x ^ x >> 16) * 0x7feb352du;
    x = (x ^ x >> 15) * 0x846ca68bu;
    return x ^ x >> 16;
}
static float random_float(uint32_t index, uint64_t key) {
    return sf_float_from_bits(mix32(mix32(index ^ (uint32_t)key) + (uint32_t)(key >> 32)));
}

static void fill_random(const sf_coordinate_source *source, const sf_block *blocks, uint32_t block_count,
                        float (*SF_RESTRICT out)[SF_PATHS]) {
    for (uint32_t b = 0; b < block_count; ++b)
        for (uint32_t d = 0; d < source->count; ++d) {
            uint64_t key = dimension_key(set_key(blocks[b].key, 0), source->first + d);
            for (uint32_t l = 0; l < SF_LANES; ++l) out[d][SF_LANES * b + l] = random_float(blocks[b].base + l, key);
        }
}

/* ---- uniform and jittered ---- */

/* A permutation of 0 .. length - 1, different for every key: an invertible mix on the next power
 * of two, walked until it lands inside (Kensler 2013, "Correlated Multi-Jittered Sampling",
 * takes this way; the mix here is four xorshift-multiply rounds). */
static uint32_t permute(uint32_t index, uint32_t length, uint64_t key) {
    uint32_t mask = length - 1;
    for (int shift = 1; shift < 32; shift *= 2) mask |= mask >> shift;
    do {
        for (int round = 0; round < 4; ++round) {
            uint32_t k = (uint32_t)(key >> 16 * round);
            index = (index + k) & mask;
            index = (index * (k << 1 | 1u)) & mask;
            index ^= (index & mask) >> 3;
            index ^= (index & mask) >> 1;
        }
    } while (index >= length);
    return index;
}

/* The cell of the grid and the place in it: jittered within the cell, or at its centre. Every
 * `cells` samples fill the grid once, in an order of their own for each set of dimensions, so
 * that two sets never run in step; uniform's orders and points are the same for every pixel. */
static void fill_cells(const sf_sample_dimensions *coordinates, const sf_coordinate_source *source,
                       const sf_block *blocks, uint32_t block_count, float (*SF_RESTRICT out)[SF_PATHS]) {
    bool jittered = coordinates->pattern == SF_PATTERN_JITTERED;
    uint32_t columns = source->count == 2 ? coordinates->sides[0] : coordinates->cells;
    for (uint32_t b = 0; b < block_count; ++b) {
        uint64_t pixel = jittered ? blocks[b].key : coordinates->seed;
        for (uint32_t l = 0; l < SF_LANES; ++l) {
            uint32_t index = blocks[b].base + l, turn = index / coordinates->cells;
            uint64_t order = sf_hash64(pixel ^ source->first, turn);
            uint32_t cell = permute(index % coordinates->cells, coordinates->cells, order);
            uint32_t place[2] = {cell % columns, cell / columns};
            for (uint32_t d = 0; d < source->count; ++d) {
                uint32_t side = d ? coordinates->sides[1] : columns;
                float u = jittered ? random_float(index, dimension_key(pixel, source->first + d)) : 0.5f;
                float x = ((float)place[d] + u) / (float)side;
                out[d][SF_LANES * b + l] = x < 1 ? x : 0x1.fffffep-1f;
            }
        }
    }
}

static void fill(const sf_sample_dimensions *coordinates, const sf_coordinate_source *source, const sf_block *blocks,
                 uint32_t block_count, float (*out)[SF_PATHS]) {
    switch (coordinates->pattern) {
        case SF_PATTERN_UNIFORM:
        case SF_PATTERN_JITTERED: fill_cells(coordinates, source, blocks, block_count, out); break;
        case SF_PATTERN_HALTON:
            SF_AT_ISA(sf_sample_dimensions_halton_kernels).fill(source, blocks, block_count, out);
            break;
        case SF_PATTERN_SOBOL: fill_sobol(SF_LANES, coordinates, source, blocks, block_count, 0, out); break;
        default: fill_random(source, blocks, block_count, out); break;
    }
}

static void fill_narrow(const sf_sample_dimensions *coordinates, const sf_coordinate_source *source,
                        const sf_block *blocks, uint32_t block_count, uint32_t width, uint32_t first_sample,
                        float (*scratch)[SF_PATHS], float (*out)[SF_PATHS]) {
    if (coordinates->pattern == SF_PATTERN_SOBOL) {
        SF_AT_WIDTH(width, fill_sobol, coordinates, source, blocks, block_count, first_sample, out)
        return;
    }
    /* Others are made whole, and their lanes moved together. */
    fill(coordinates, source, blocks, block_count, scratch);
    for (uint32_t d = 0; d < source->count; ++d)
        for (uint32_t b = 0; b < block_count; ++b)
            for (uint32_t l = 0; l < width; ++l) out[d][b * width + l] = scratch[d][b * SF_LANES + first_sample + l];
}

const sf_sample_dimensions_kernels SF_AT_ISA(sf_sample_dimensions_kernels) = {fill, fill_narrow};
