// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The arithmetic of one dimension of Halton's sequence.
 *
 * Plain or permuted, a coordinate is made as a fraction of 2^64 in two parts, the `low_digits`
 * least digits of the index and the others: the first part repeats, and is tabulated where that
 * pays; the second changes once in base^low_digits points. Each is rounded up, so that a point
 * which is the lower border of an elementary interval stays in it. */
#ifndef SUNFLECK_HALTON_H
#define SUNFLECK_HALTON_H

#include "points/halton_kernels.h"
#include "sunfleck/points.h"

/* One dimension, and the key of its permutations. */
typedef struct sf_halton_axis {
    uint32_t base, block;        /* block = base^low_digits: at most 1024, or the base itself */
    unsigned low_digits, digits; /* digits: base^digits is at least 2^64 */
    uint32_t fine, finer;        /* the greatest powers of the base up to 2^24 and below 2^32 */
    sf_scramble scramble;
    uint64_t key;
    sf_owen_base owen; /* with that scramble */
} sf_halton_axis;

/* The sum of digits / base^(place + 1) over the places from some place on, cut off at 2^-64, and
 * whether anything was cut off. */
typedef struct sf_halton_sum {
    uint64_t fraction;
    uint32_t inexact;
} sf_halton_sum;

sf_halton_axis sf_halton_axis_make(uint32_t base, uint32_t dimension, sf_scramble scramble, uint64_t seed);

static inline int sf_is_prime(uint32_t n) {
    for (uint32_t factor = 3; factor * factor <= n; factor += 2)
        if (n % factor == 0) return 0;
    return n == 2 || n % 2;
}

/* The prime after n. */
static inline uint32_t sf_next_prime(uint32_t n) {
    if (n < 2) return 2;
    do n += 1 + n % 2;
    while (!sf_is_prime(n));
    return n;
}

/* The digit that stands at a place for `digit`. */
uint32_t sf_halton_digit(const sf_halton_axis *axis, unsigned place, uint32_t digit);

/* The sum over the places from `first` on, as if that were place 0: `number` holds their digits. */
sf_halton_sum sf_halton_tail(const sf_halton_axis *axis, uint64_t number, unsigned first);

/* The first part of block number `number` mod block. */
uint64_t sf_halton_first_part(const sf_halton_axis *axis, uint32_t number);

/* (digit + fraction) / base, cut off. */
static inline sf_halton_sum sf_halton_divide(sf_halton_sum sum, uint32_t digit, uint32_t base) {
    uint64_t top = (uint64_t)digit << 32 | sum.fraction >> 32;
    uint64_t rest = top % base << 32 | (sum.fraction & 0xffffffffu);
    return (sf_halton_sum){top / base << 32 | rest / base, sum.inexact | (rest % base != 0)};
}

/* The second part: the digits from place low_digits on, moved to their places and rounded up. */
static inline uint64_t sf_halton_second_part(const sf_halton_axis *axis, sf_halton_sum tail) {
    uint64_t fraction = tail.fraction / axis->block;
    return fraction + (tail.inexact || fraction * axis->block != tail.fraction);
}

/* The mix of 0 .. base - 1 for a key, walked to its end. */
static inline uint32_t sf_halton_mix(uint32_t digit, uint32_t base, uint64_t key) {
    uint32_t mask = base - 1;
    for (int shift = 1; shift < 32; shift *= 2) mask |= mask >> shift;
    do digit = sf_halton_mix_step(digit, mask, key);
    while (digit >= base);
    return digit;
}

/* halton_owen.c: nested uniform scrambling, see halton_kernels.h. */
sf_owen_node sf_halton_owen_root(const sf_halton_axis *axis);

/* The node below `node`, of depth `from`, at depth `to`: `number` holds the digits between. */
sf_owen_node sf_halton_owen_descend(const sf_halton_axis *axis, sf_owen_node node, unsigned from, unsigned to,
                                    uint64_t number);

/* The coordinate as a fraction of 2^64: `number` holds all digits from place `from` on. */
uint64_t sf_halton_owen_fraction(const sf_halton_axis *axis, sf_owen_node node, unsigned from, uint64_t number);

/* The digits of `number` that are not zero, from place `from` on, for the kernel's steps, and the
 * power that skips the zeros from the last to depth `places`. Returns how many, or -1 where the
 * number goes deeper. */
int sf_halton_owen_digits(const sf_halton_axis *axis, unsigned from, uint64_t number, sf_owen_digit digits[32],
                          uint32_t *skipped_power);

#endif
