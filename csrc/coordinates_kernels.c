// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "coordinates_kernels.h"

#include <stdbool.h>

#include "coordinates_halton_kernels.h"
#include "platform.h"

/* The key of a set of dimensions in one block, and from it of each dimension. */
static uint64_t set_key(const sf_block *block, uint32_t set) {
    return sf_mix64(block->key + (set + 1) * UINT64_C(0x9e3779b97f4a7c15));
}
static uint64_t dimension_key(uint64_t key, uint32_t dimension) {
    return sf_mix64(key + (dimension + 1) * UINT64_C(0xd1342543de82ef95));
}

/* ---- sobol ---- */

/* The set's order: sample base + l is point high + low[l], low a permutation of 0 .. 15. */
static uint32_t shuffle_block(uint32_t base, uint32_t set, uint64_t key, uint32_t low[SF_LANES]) {
    uint32_t index[SF_LANES], seed = (uint32_t)(key >> 32);
    if (set == 0) {
        for (uint32_t l = 0; l < SF_LANES; ++l) low[l] = l;
        return base;
    }
    for (uint32_t l = 0; l < SF_LANES; ++l) index[l] = sf_owen_scramble32(base + l, seed);
    for (uint32_t l = 0; l < SF_LANES; ++l) low[l] = index[l] & 15u;
    return index[0] & ~15u;
}

static void sobol_block(const uint32_t table[4][256], uint32_t high, const uint32_t low[SF_LANES], uint32_t seed,
                        float *SF_RESTRICT out) {
    uint32_t start =
        table[0][high & 0xf0u] ^ table[1][high >> 8 & 255u] ^ table[2][high >> 16 & 255u] ^ table[3][high >> 24];
    uint32_t column0 = table[0][1], column1 = table[0][2], column2 = table[0][4], column3 = table[0][8];
    for (int l = 0; l < SF_LANES; ++l) {
        uint32_t x = start ^ ((0u - (low[l] & 1u)) & column0) ^ ((0u - (low[l] >> 1 & 1u)) & column1) ^
                     ((0u - (low[l] >> 2 & 1u)) & column2) ^ ((0u - (low[l] >> 3)) & column3);
        out[l] = sf_owen_float(x, seed);
    }
}

static void fill_sobol(const sf_coordinates *coordinates, const sf_coordinate_source *source, const sf_block *blocks,
                       uint32_t block_count, float (*SF_RESTRICT out)[SF_PATHS]) {
    for (uint32_t b = 0; b < block_count; ++b) {
        uint32_t low[SF_LANES];
        uint64_t key = set_key(blocks + b, source->set);
        uint32_t high = shuffle_block(blocks[b].base, source->set, key, low);
        for (uint32_t d = 0; d < source->count; ++d)
            sobol_block(coordinates->sobol[source->dimension + d], high, low,
                        (uint32_t)dimension_key(key, source->dimension + d), out[d] + SF_LANES * b);
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
            uint64_t key = dimension_key(set_key(blocks + b, 0), source->first + d);
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
static void fill_cells(const sf_coordinates *coordinates, const sf_coordinate_source *source, const sf_block *blocks,
                       uint32_t block_count, float (*SF_RESTRICT out)[SF_PATHS]) {
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

static void fill(const sf_coordinates *coordinates, const sf_coordinate_source *source, const sf_block *blocks,
                 uint32_t block_count, float (*out)[SF_PATHS]) {
    switch (coordinates->pattern) {
        case SF_PATTERN_UNIFORM:
        case SF_PATTERN_JITTERED: fill_cells(coordinates, source, blocks, block_count, out); break;
        case SF_PATTERN_HALTON:
            SF_AT_LEVEL(sf_coordinates_halton_kernels).fill(source, blocks, block_count, out);
            break;
        case SF_PATTERN_SOBOL: fill_sobol(coordinates, source, blocks, block_count, out); break;
        default: fill_random(source, blocks, block_count, out); break;
    }
}

const sf_coordinates_kernels SF_AT_LEVEL(sf_coordinates_kernels) = {fill};
