// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Fills rows of Halton points: fractions become words, nested scrambles take their steps, columns become rows. */
#include "points/halton_kernels.h"

#include <string.h>

#include "base/platform.h"

enum { RUN = 256 };

/* The upper halves of the fractions, and what the lower halves add to upper * fine. */
static void split(size_t count, const uint64_t *SF_RESTRICT first_parts, uint64_t second, uint32_t fine,
                  uint32_t *SF_RESTRICT upper, uint32_t *SF_RESTRICT carried) {
    for (size_t i = 0; i < count; ++i) {
        uint64_t fraction = sf_halton_join(first_parts[i], second);
        upper[i] = (uint32_t)(fraction >> 32);
        carried[i] = (uint32_t)((fraction & 0xffffffffu) * fine >> 32);
    }
}

/* sf_halton_word in 32 bits: let c be the cells that the lower half adds. The fraction lies
 * (upper fine + c) mod 2^32 above its interval's border, and its last 8 bits of the upper half
 * and the lower half are (upper mod 2^8) fine + c, both in cells / 2^32: cutting those off leaves
 * the interval where the first is less than the second, that is, with or without c, where adding
 * c wraps around or upper fine mod 2^32 < (upper mod 2^8) fine. */
static void round_words(size_t count, const uint32_t *SF_RESTRICT upper, const uint32_t *SF_RESTRICT carried,
                        uint32_t fine, uint32_t *SF_RESTRICT high) {
    for (size_t i = 0; i < count; ++i) {
        uint32_t x = upper[i], above = x * fine, sum = above + carried[i];
        int leaves = (sum < above) | (above < (x & 0xffu) * fine);
        high[i] = leaves ? (x & ~UINT32_C(0xff)) + 0x100 : x;
    }
}

static void words(size_t count, const uint64_t *first_parts, uint64_t second, uint32_t fine, uint32_t *high) {
    SF_ALIGNED(uint32_t) upper[RUN];
    SF_ALIGNED(uint32_t) carried[RUN];
    for (size_t begin = 0, n; begin < count; begin += n) {
        n = count - begin < RUN ? count - begin : RUN;
        split(n, first_parts + begin, second, fine, upper, carried);
        round_words(n, upper, carried, fine, high + begin);
    }
}

static void pairs(size_t count, const uint64_t *SF_RESTRICT first_parts, uint64_t second, uint32_t finer,
                  uint32_t *SF_RESTRICT high, uint32_t *SF_RESTRICT low) {
    for (size_t i = 0; i < count; ++i) {
        uint64_t fraction = sf_halton_join(first_parts[i], second), cut = fraction & 0x7ff;
        /* Cutting leaves the interval where the distance to its border is less than what is cut. */
        uint64_t above = (fraction & 0xffffffffu) * finer + ((fraction >> 32) * finer << 32);
        uint64_t rounded = fraction - cut + (above < cut * finer ? 0x800u : 0u);
        high[i] = (uint32_t)(rounded >> 32);
        low[i] = (uint32_t)rounded;
    }
}

static void owen_step(size_t count, const sf_owen_base *base, const sf_owen_digit *digit, uint64_t *SF_RESTRICT keys,
                      uint64_t *SF_RESTRICT tails, uint64_t *SF_RESTRICT prefixes) {
    sf_owen_base b = *base;
    sf_owen_digit d = *digit;
    for (size_t i = 0; i < count; ++i) {
        sf_owen_node node = {keys[i], tails[i], prefixes[i]};
        node = sf_owen_step(node, &b, &d);
        keys[i] = node.key;
        tails[i] = node.tail;
        prefixes[i] = node.prefix;
    }
}

static void owen_end(size_t count, const sf_owen_base *base, uint32_t power, const uint64_t *SF_RESTRICT tails,
                     const uint64_t *SF_RESTRICT prefixes, uint64_t *SF_RESTRICT fractions) {
    sf_owen_base b = *base;
    for (size_t i = 0; i < count; ++i) {
        sf_owen_node node = {0, tails[i], prefixes[i]};
        node.prefix = node.prefix * power + sf_owen_take(&node.tail, power);
        fractions[i] = sf_owen_fraction(&node, &b);
    }
}

static void owen(size_t count, const sf_owen_node *nodes, const sf_owen_base *base, size_t digits,
                 const sf_owen_digit *digit, uint32_t skipped_power, uint64_t *fractions) {
    SF_ALIGNED(uint64_t) keys[RUN];
    SF_ALIGNED(uint64_t) tails[RUN];
    SF_ALIGNED(uint64_t) prefixes[RUN];
    for (size_t begin = 0, n; begin < count; begin += n) {
        n = count - begin < RUN ? count - begin : RUN;
        for (size_t i = 0; i < n; ++i) {
            keys[i] = nodes[begin + i].key;
            tails[i] = nodes[begin + i].tail;
            prefixes[i] = nodes[begin + i].prefix;
        }
        for (size_t k = 0; k < digits; ++k) owen_step(n, base, digit + k, keys, tails, prefixes);
        owen_end(n, base, skipped_power, tails, prefixes, fractions + begin);
    }
}

/* ---- from columns to rows ---- */

/* Four columns of a run as rows of four words: the compiler interleaves vectors. */
static void weave_4(size_t rows, const uint32_t *SF_RESTRICT columns, uint32_t *SF_RESTRICT woven) {
    enum { C = SF_HALTON_COLUMN };
    for (size_t i = 0; i < rows; ++i) {
        woven[4 * i] = columns[i];
        woven[4 * i + 1] = columns[i + C];
        woven[4 * i + 2] = columns[i + 2 * C];
        woven[4 * i + 3] = columns[i + 3 * C];
    }
}

static void weave(size_t rows, const uint32_t *columns, uint32_t width, uint32_t *out, size_t dims) {
    SF_ALIGNED(uint32_t) woven[4 * SF_HALTON_COLUMN];
    uint32_t k = 0;
    size_t whole = (rows + SF_HALTON_ROOM - 1) / SF_HALTON_ROOM * SF_HALTON_ROOM;
    for (; k + 4 <= width; k += 4) {
        weave_4(whole, columns + k * SF_HALTON_COLUMN, woven);
        for (size_t i = 0; i < rows; ++i) memcpy(out + i * dims + k, woven + 4 * i, 4 * sizeof *woven);
    }
    for (; k < width; ++k)
        for (size_t i = 0; i < rows; ++i) out[i * dims + k] = columns[k * SF_HALTON_COLUMN + i];
}

const sf_halton_kernels SF_AT_ISA(sf_halton_kernels) = {words, pairs, owen, weave};
