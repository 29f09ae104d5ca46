// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Halton's coordinates from fractions of 2^64 to words, and steps of nested scrambling. */
#ifndef SUNFLECK_HALTON_KERNELS_H
#define SUNFLECK_HALTON_KERNELS_H

#include "base/isa_dispatch.h"

/* ---- permuted digits ----
 *
 * The permutation of a place: a random affine map after a mix. Affine maps of a prime field take
 * every pair of digits to every other pair equally often, as all permutations together do, so
 * that the variance of a mean is that of fully random permutations; the mix removes the lines
 * that affine maps alone would leave among the points of large bases. */

/* A mix of 0 .. base - 1: an invertible hash on the next power of two, mask + 1, walked until it
 * lands below the base (Kensler 2013, "Correlated Multi-Jittered Sampling", section 3, takes this
 * way). A step of it. */
static inline uint32_t sf_halton_mix_step(uint32_t digit, uint32_t mask, uint64_t key) {
    digit = (digit * ((uint32_t)key | 1) + (uint32_t)(key >> 40)) & mask;
    digit ^= digit >> 2 ^ digit >> 5;
    digit = digit * ((uint32_t)(key >> 32) | 1) & mask;
    return digit ^ digit >> 1 ^ digit >> 7;
}

/* The affine map by the place's key, still to be taken modulo the base. */
static inline uint32_t sf_halton_affine(uint32_t mixed, uint32_t base, uint64_t key) {
    uint32_t factor = 1 + (uint32_t)((key & 0xffffffffu) * (base - 1) >> 32);
    uint32_t offset = (uint32_t)((key >> 32) * base >> 32);
    return mixed * factor + offset; /* at most (base - 1)^2 + base - 1, and base < 2^16 */
}

/* ---- rounding ---- */

/* floor(fraction / 2^64 * cells), exactly. */
static inline uint32_t sf_halton_cell(uint64_t fraction, uint32_t cells) {
    return (uint32_t)(((fraction >> 32) * cells + ((fraction & 0xffffffffu) * cells >> 32)) >> 32);
}

/* The fraction with its last `dropped` bits cleared, or, where that would leave the elementary
 * interval, one of `cells`, the next such number: it lies inside, as intervals are not narrower
 * than the step. */
static inline uint64_t sf_halton_round_inside(uint64_t fraction, uint32_t cells, unsigned dropped) {
    uint64_t step = UINT64_C(1) << dropped, below = fraction & ~(step - 1);
    return sf_halton_cell(below, cells) < sf_halton_cell(fraction, cells) ? below + step : below;
}

/* The word of a coordinate; `fine` is the greatest power of the base up to 2^24. */
static inline uint32_t sf_halton_word(uint64_t fraction, uint32_t fine) {
    uint64_t rounded = sf_halton_round_inside(fraction, fine, 40);
    return (uint32_t)((rounded > fraction ? rounded : fraction) >> 32);
}

/* Both parts being rounded up, their sum could reach 1 where every digit is the last. */
static inline uint64_t sf_halton_join(uint64_t first, uint64_t second) {
    uint64_t sum = first + second;
    return sum < first ? UINT64_MAX : sum;
}

/* ---- nested uniform scrambling ----
 *
 * A node of the tree of scrambled digits: `prefix` holds the digits so far, `tail` what follows
 * them if all further digits of the index are zero, a uniform fraction of 2^64. As long as they
 * are, the tail's digits are the scrambled ones. At a digit that is not zero the node's
 * permutation must take 0 to the tail's digit u and the digit elsewhere: it is the affine map
 * u + factor * mix(digit), its factor from the node's key, `mix` a permutation of 1 .. base - 1 for
 * the place. Below that the tree has a new key. So a coordinate costs a step for each digit
 * that is not zero, and each node's map is uniform among affine ones, under which all pairs of
 * digits are equally likely, as under all permutations. */
typedef struct sf_owen_node {
    uint64_t key, tail, prefix;
} sf_owen_node;

/* What the nodes of a base share. */
typedef struct sf_owen_base {
    uint32_t base, inverse;  /* inverse = floor(2^32 / base) */
    uint32_t cells;          /* the greatest power of the base below 2^32, */
    unsigned places;         /* and its exponent */
    uint64_t width;          /* floor(2^64 / cells) */
    uint32_t width_fraction; /* and the 32 bits that follow */
} sf_owen_base;

/* A digit that is not zero, after `skipped` zeros; the same for all nodes of a loop. */
typedef struct sf_owen_digit {
    uint32_t power; /* base^skipped, below 2^32 */
    uint32_t digit, mixed;
    uint32_t place;
} sf_owen_digit;

/* node.tail <- the fraction, and returns the integer, of tail * power. */
static inline uint64_t sf_owen_take(uint64_t *tail, uint64_t power) {
    uint64_t low = (*tail & 0xffffffffu) * power, high = (*tail >> 32) * power + (low >> 32);
    *tail = high << 32 | (low & 0xffffffffu);
    return high >> 32;
}

static inline sf_owen_node sf_owen_step(sf_owen_node node, const sf_owen_base *base, const sf_owen_digit *at) {
    uint64_t b = base->base, prefix = node.prefix * at->power + sf_owen_take(&node.tail, at->power);
    uint64_t u = sf_owen_take(&node.tail, b);
    uint64_t hash = sf_mix64(node.key ^ (at->place + UINT64_C(1)) * UINT64_C(0x9e3779b97f4a7c15));
    uint64_t factor = 1 + ((hash >> 32) * (b - 1) >> 32);
    /* Reduce the image modulo the base: the quotient is at most one short. */
    uint64_t image = u + factor * at->mixed, quotient = image * base->inverse >> 32;
    image -= quotient * b;
    image = image >= b ? image - b : image;
    node.prefix = prefix * b + image;
    node.key = node.tail = sf_mix64(hash + at->digit);
    return node;
}

/* The fraction of 2^64 of a node at depth `places`: in the interval of its prefix, however the
 * interval's border and width are rounded. Here prefix / cells is found to less than one unit
 * below, and moved up by two. */
static inline uint64_t sf_owen_fraction(const sf_owen_node *node, const sf_owen_base *base) {
    uint64_t width = base->width - 2, tail = node->tail >> 32;
    uint64_t border = node->prefix * base->width + (node->prefix * base->width_fraction >> 32) + 2;
    return border + tail * (width >> 32) + (tail * (width & 0xffffffffu) >> 32);
}

/* Coordinates are made by dimension, a run of rows of some dimensions, and then woven into rows.
 * What is made may overrun its count up to a whole vector: columns leave room for that. */
enum {
    SF_HALTON_RUN = 256,
    SF_HALTON_ROOM = 16,
    SF_HALTON_COLUMN = SF_HALTON_RUN + SF_HALTON_ROOM,
    SF_HALTON_WIDTH = 16 /* dimensions side by side */
};

typedef struct sf_halton_kernels {
    /* Words of first parts and the second part that they share. */
    void (*words)(size_t count, const uint64_t *first_parts, uint64_t second, uint32_t fine, uint32_t *high);
    /* Both words of a double, in an interval of `finer`. */
    void (*pairs)(size_t count, const uint64_t *first_parts, uint64_t second, uint32_t finer, uint32_t *high,
                  uint32_t *low);
    /* Steps of `count` nodes by the same digits, and from there to depth `places`, `skipped` zeros
     * on, to fractions. */
    void (*owen)(size_t count, const sf_owen_node *nodes, const sf_owen_base *base, size_t digits,
                 const sf_owen_digit *digit, uint32_t skipped_power, uint64_t *fractions);
    /* out[row * dims + k] = columns[k * SF_HALTON_COLUMN + row] for k below `width`, at most
     * SF_HALTON_WIDTH, and rows below `rows`, at most SF_HALTON_RUN. */
    void (*weave)(size_t rows, const uint32_t *columns, uint32_t width, uint32_t *out, size_t dims);
} sf_halton_kernels;

SF_KERNELS(sf_halton_kernels)

#endif
