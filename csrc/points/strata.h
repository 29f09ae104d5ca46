// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Random places in the strata of one dimension, [cell / count, (cell + 1) / count). */
#ifndef SUNFLECK_STRATA_H
#define SUNFLECK_STRATA_H

#include "sunfleck/base.h"

/* Up to so many strata a float holds each; beyond, a double does. */
#define SF_FLOAT_STRATA (UINT32_C(1) << 24)

/* ceil(cell * 2^53 / count): the least double that is not below the stratum's border. */
static inline uint64_t sf_stratum_border53(uint64_t cell, uint64_t count) {
    uint64_t top = cell << 32, rest = top % count << 21; /* count is at most 2^32 */
    return (top / count << 21) + rest / count + (rest % count != 0);
}

/* A 32-bit hash of a point and a dimension's key. The multipliers are
 * those of a 32-bit mixer that Wellons 2018, "Prospecting for Hash Functions", found by search. */
static inline uint32_t sf_stratum_hash(uint32_t index, uint32_t key) {
    uint32_t word = (index ^ key) * 0x7feb352du;
    word = ((word ^ word >> 15) + key) * 0x846ca68bu;
    return word ^ word >> 16;
}

/* What continues that hash below its 32 bits. */
static inline uint32_t sf_stratum_low_hash(uint32_t hash, uint32_t key) {
    uint32_t word = (hash ^ key ^ 0x6a09e667u) * 0x297a2d39u;
    word = (word ^ word >> 15) * 0x846ca68bu;
    return word ^ word >> 16;
}

/* The words of a stratum from the first multiple of 2^-24 in it, `begin`, so that their floats too
 * lie in it: returns how many, none of which reaches the stratum's end when it is continued below
 * 2^-32. None where the stratum ends next to `begin`, which takes more than 2^23 strata. `inverse`
 * is 1.0 / count, for counts up to 2^24.
 *
 * cell * 2^24 / count is an integer or at least 2^-24 away from one, and the product with the
 * rounded inverse is off by less than 2^24 * 2^-52, so that adding 1 - 2^-26 and dropping the
 * fraction rounds up exactly; of the end, 2^-18 of a float's step is given away. */
static inline uint32_t sf_stratum_words(uint32_t cell, double inverse, uint32_t *begin) {
    double step = 0x1p24 * inverse, border = (double)(int32_t)cell * step, end = border + step - 0x1p-18;
    int32_t whole = (int32_t)end, part = (int32_t)((end - (double)whole) * 256);
    uint32_t last = (uint32_t)whole << 8 | (uint32_t)part;
    *begin = (uint32_t)(int32_t)(border + (1 - 0x1p-26)) << 8;
    return last > *begin ? last - *begin : 0;
}

static inline uint32_t sf_stratum_word(uint32_t random, uint32_t cell, double inverse) {
    uint32_t begin, words = sf_stratum_words(cell, inverse, &begin);
    return begin + (uint32_t)((uint64_t)random * words >> 32);
}

/* The same of 2^bits strata. */
static inline uint32_t sf_stratum_binary_word(uint32_t random, uint32_t cell, uint32_t bits) {
    return cell << (31 - bits) << 1 | random >> bits;
}

/* The 64-bit word in a stratum of any count up to 2^32: its double lies in it, and up to 2^24 its
 * float. */
static inline uint64_t sf_stratum_place(uint32_t index, uint32_t key, uint32_t cell, uint64_t count) {
    uint32_t random = sf_stratum_hash(index, key), low = sf_stratum_low_hash(random, key), begin, bits = 0;
    if (count > SF_FLOAT_STRATA) {
        uint64_t from = sf_stratum_border53(cell, count), width = sf_stratum_border53(cell + UINT64_C(1), count) - from;
        return (from << 11) + (random * width >> 21); /* the width is at most 2^29 */
    }
    if (count & (count - 1)) {
        double inverse = 1.0 / (double)count;
        uint32_t words = sf_stratum_words(cell, inverse, &begin);
        return (uint64_t)sf_stratum_word(random, cell, inverse) << 32 | (words ? low : 0);
    }
    while (count >> (bits + 1)) ++bits;
    return (uint64_t)sf_stratum_binary_word(random, cell, bits) << 32 | low;
}

#endif
