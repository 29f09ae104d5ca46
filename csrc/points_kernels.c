// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "points_kernels.h"

#include <string.h>

#include "platform.h"

static void f32(size_t count, const uint32_t *SF_RESTRICT high, float *SF_RESTRICT out) {
    for (size_t i = 0; i < count; ++i) out[i] = sf_float_from_bits(high[i]);
}

static void f64(size_t count, const uint32_t *SF_RESTRICT high, const uint32_t *SF_RESTRICT low,
                double *SF_RESTRICT out) {
    /* 32 bits and 21 bits, each and their sum exact. The offset makes the word a signed one,
     * which every level can convert. */
    for (size_t i = 0; i < count; ++i) {
        double top = (double)(int32_t)(high[i] ^ 0x80000000u) + 0x1p31;
        out[i] = top * 0x1p-32 + (double)(int32_t)(low[i] >> 11) * 0x1p-53;
    }
}

static void xor_words(size_t count, const uint32_t *SF_RESTRICT a, const uint32_t *SF_RESTRICT b,
                      uint32_t *SF_RESTRICT out) {
    for (size_t i = 0; i < count; ++i) out[i] = a[i] ^ b[i];
}

static void owen_words(size_t count, const uint32_t *SF_RESTRICT a, const uint32_t *SF_RESTRICT b,
                       const uint32_t *SF_RESTRICT keys, uint32_t *SF_RESTRICT out) {
    for (size_t i = 0; i < count; ++i) out[i] = sf_reverse_bits32(sf_owen_hash32(a[i] ^ b[i], keys[i]));
}

/* Rows begin .. end - 1 of the block whose high bits are `state`. */
static void sobol_block(const sf_sobol_tables *t, size_t begin, size_t end, const uint32_t *state, uint32_t *out) {
    size_t word = begin * t->dims, last = end * t->dims;
    while (word < last) {
        size_t offset = word % t->period, count = t->period - offset;
        if (count > last - word) count = last - word;
        if (t->keys)
            owen_words(count, t->low + word, state + offset, t->keys + offset, out);
        else
            xor_words(count, t->low + word, state + offset, out);
        word += count;
        out += count;
    }
}

static void sobol(const sf_sobol_tables *t, uint64_t first, size_t rows, uint32_t *state, uint32_t *out) {
    size_t block = (size_t)1 << t->block_bits;
    while (rows) {
        size_t begin = (size_t)(first & (block - 1)), count = block - begin < rows ? block - begin : rows;
        sobol_block(t, begin, begin + count, state, out);
        first += count;
        rows -= count;
        out += count * t->dims;
        if (first & (block - 1)) continue;
        /* Counting up flips the trailing ones of the block's number and the zero above them. */
        uint64_t number = first >> t->block_bits;
        unsigned carry = 0;
        while (!(number >> carry & 1)) ++carry;
        if (carry < 32 - t->block_bits) {
            const uint32_t *SF_RESTRICT step = t->steps + (size_t)carry * t->period;
            for (uint32_t i = 0; i < t->period; ++i) state[i] ^= step[i];
        }
    }
}

static void owen_low(size_t count, const uint32_t *SF_RESTRICT high, const uint32_t *SF_RESTRICT keys,
                     uint32_t period, uint32_t *SF_RESTRICT low) {
    for (size_t begin = 0; begin < count; begin += period) {
        size_t n = count - begin < period ? count - begin : period;
        for (size_t i = 0; i < n; ++i) low[begin + i] = sf_owen_low_word(high[begin + i], keys[i]);
    }
}

static void row_keys(uint64_t seed, uint64_t first, size_t rows, uint64_t *SF_RESTRICT keys) {
    for (size_t i = 0; i < rows; ++i) keys[i] = sf_hash64(seed, first + i);
}

enum { RUN = 512 }; /* words whose 64-bit state is held at a time */

static void random_words(const uint64_t *SF_RESTRICT keys, size_t rows, uint32_t dims, uint32_t *SF_RESTRICT high,
                         uint32_t *SF_RESTRICT low) {
    uint64_t states[RUN];
    size_t count = rows * dims, row = 0;
    uint32_t dimension = 0;
    for (size_t begin = 0, n; begin < count; begin += n) {
        n = count - begin < RUN ? count - begin : RUN;
        for (size_t i = 0; i < n;) {
            size_t left = dims - dimension < n - i ? dims - dimension : n - i;
            for (size_t k = 0; k < left; ++k)
                states[i + k] = keys[row] + (dimension + k + 1) * UINT64_C(0x9e3779b97f4a7c15);
            i += left;
            dimension += (uint32_t)left;
            if (dimension == dims) {
                dimension = 0;
                ++row;
            }
        }
        for (size_t i = 0; i < n; ++i) states[i] = sf_mix64(states[i]);
        for (size_t i = 0; i < n; ++i) high[begin + i] = (uint32_t)(states[i] >> 32);
        for (size_t i = 0; low && i < n; ++i) low[begin + i] = (uint32_t)states[i];
    }
}

static void place(size_t rows, uint32_t dims, const uint32_t *sides, const uint32_t *cells, uint32_t *high,
                  uint32_t *low) {
    for (size_t row = 0, i = 0; row < rows; ++row)
        for (uint32_t d = 0; d < dims; ++d, ++i) {
            uint64_t random = (uint64_t)high[i] << 32 | low[i];
            uint64_t word = sf_place_in_cell(random, cells[i], sides[d]);
            high[i] = (uint32_t)(word >> 32);
            low[i] = (uint32_t)word;
        }
}

const sf_points_kernels SF_AT_LEVEL(sf_points_kernels) = {f32,      f64,      sobol,        owen_low,
                                                          row_keys, random_words, place};
