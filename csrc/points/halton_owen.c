// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Nested uniform scrambling of Halton's digits (Owen 1995, "Randomly Permuted (t,m,s)-Nets and
 * (t,s)-Sequences"; in all bases, Owen 2017, "A Randomized Halton Algorithm in R"): each digit by a
 * permutation that depends on all the digits before it. The way of it: halton_kernels.h. */
#include "points/halton.h"

sf_owen_node sf_halton_owen_root(const sf_halton_axis *axis) {
    uint64_t key = sf_hash64(axis->key, UINT64_MAX);
    return (sf_owen_node){key, key, 0};
}

static sf_owen_digit digit_at(const sf_halton_axis *axis, unsigned place, uint32_t power, uint32_t digit) {
    uint32_t mixed = 1 + sf_halton_mix(digit - 1, axis->base - 1, sf_hash64(axis->key, place));
    return (sf_owen_digit){power, digit, mixed, place};
}

static void skip(sf_owen_node *node, uint32_t power) {
    node->prefix = node->prefix * power + sf_owen_take(&node->tail, power);
}

sf_owen_node sf_halton_owen_descend(const sf_halton_axis *axis, sf_owen_node node, unsigned from, unsigned to,
                                    uint64_t number) {
    uint32_t power = 1;
    for (unsigned place = from; place < to; ++place, number /= axis->base) {
        uint32_t digit = (uint32_t)(number % axis->base);
        if (digit == 0) {
            power *= axis->base;
            continue;
        }
        sf_owen_digit step = digit_at(axis, place, power, digit);
        node = sf_owen_step(node, &axis->owen, &step);
        power = 1;
    }
    skip(&node, power);
    return node;
}

uint64_t sf_halton_owen_fraction(const sf_halton_axis *axis, sf_owen_node node, unsigned from, uint64_t number) {
    unsigned places = axis->owen.places;
    uint64_t rest = number;
    for (unsigned place = from; place < places; ++place) rest /= axis->base;
    node = sf_halton_owen_descend(axis, node, from, places, number);
    if (rest) {
        /* Deeper digits move the point inside its interval, of less than 2^-21: as many again
         * are scrambled, to less than 2^-42, and what then is left of the index picks a tail. */
        sf_owen_node below =
            sf_halton_owen_descend(axis, (sf_owen_node){node.key, node.tail, 0}, places, 2 * places, rest);
        if (rest >= axis->owen.cells) below.tail = sf_hash64(below.key, rest / axis->owen.cells);
        node.tail = sf_halton_divide((sf_halton_sum){below.tail, 0}, (uint32_t)below.prefix, axis->owen.cells).fraction;
    }
    return sf_owen_fraction(&node, &axis->owen);
}

int sf_halton_owen_digits(const sf_halton_axis *axis, unsigned from, uint64_t number, sf_owen_digit digits[32],
                          uint32_t *skipped_power) {
    int count = 0;
    uint32_t power = 1;
    for (unsigned place = from; place < axis->owen.places; ++place, number /= axis->base) {
        uint32_t digit = (uint32_t)(number % axis->base);
        if (digit == 0) {
            power *= axis->base;
            continue;
        }
        digits[count++] = digit_at(axis, place, power, digit);
        power = 1;
    }
    *skipped_power = power;
    return number ? -1 : count;
}
