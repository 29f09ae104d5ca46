// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The Halton sequence: in dimension j the digits of the index in the j-th prime, mirrored at the
 * point; permuted by their places, or scrambled. One dimension, one coordinate. */
#include "points/halton.h"

#include <assert.h>

enum { MAX_BLOCK = 1024 }; /* base^low_digits is at most this, or the base itself */

/* ---- primes ---- */

/* The primes of the dimensions that a renderer asks for one at a time. */
static const uint16_t first_primes[] = {2,   3,   5,   7,   11,  13,  17,  19,  23,  29,  31,  37,  41,  43,  47,  53,
                                        59,  61,  67,  71,  73,  79,  83,  89,  97,  101, 103, 107, 109, 113, 127, 131,
                                        137, 139, 149, 151, 157, 163, 167, 173, 179, 181, 191, 193, 197, 199, 211, 223};
enum { FIRST_PRIMES = sizeof first_primes / sizeof *first_primes };

static uint32_t prime(uint32_t dimension) {
    if (dimension < FIRST_PRIMES) return first_primes[dimension];
    uint32_t p = first_primes[FIRST_PRIMES - 1];
    for (uint32_t d = FIRST_PRIMES - 1; d < dimension; ++d) p = sf_next_prime(p);
    return p;
}

/* ---- digits ---- */

static uint32_t power_up_to(uint32_t base, uint64_t limit, unsigned *exponent) {
    uint64_t power = 1;
    *exponent = 0;
    while (power * base <= limit) {
        power *= base;
        ++*exponent;
    }
    return (uint32_t)power;
}

static sf_owen_base owen_base(uint32_t base) {
    sf_owen_base owen = {.base = base, .inverse = (uint32_t)((UINT64_C(1) << 32) / base)};
    owen.cells = power_up_to(base, UINT32_MAX, &owen.places);
    /* Divide 2^64 - 1, which has the same quotient as 2^64 unless the cells are a power of two. */
    owen.width = UINT64_MAX / owen.cells + (base == 2);
    uint64_t rest = UINT64_MAX - owen.width * owen.cells + 1;
    owen.width_fraction = (uint32_t)((rest << 32) / owen.cells);
    return owen;
}

sf_halton_axis sf_halton_axis_make(uint32_t base, uint32_t dimension, sf_scramble scramble, uint64_t seed) {
    sf_halton_axis axis = {.base = base, .scramble = scramble, .key = sf_hash64(seed, dimension)};
    unsigned unused;
    axis.block = power_up_to(base, base > MAX_BLOCK ? base : MAX_BLOCK, &axis.low_digits);
    axis.fine = power_up_to(base, UINT64_C(1) << 24, &unused);
    axis.finer = power_up_to(base, UINT32_MAX, &unused);
    if (scramble == SF_SCRAMBLE_OWEN) axis.owen = owen_base(base);
    uint64_t left = UINT64_MAX;
    for (; left; left /= base) ++axis.digits;
    return axis;
}

static uint32_t permute_digit(const sf_halton_axis *axis, unsigned place, uint32_t digit) {
    uint64_t key = sf_hash64(axis->key, place);
    return sf_halton_affine(sf_halton_mix(digit, axis->base, sf_mix64(key)), axis->base, key) % axis->base;
}

uint32_t sf_halton_digit(const sf_halton_axis *axis, unsigned place, uint32_t digit) {
    return axis->scramble == SF_SCRAMBLE_PERMUTED ? permute_digit(axis, place, digit) : digit;
}

/* The digits of `number` stand at the places first .. last - 1. */
static sf_halton_sum sum_of(const sf_halton_axis *axis, uint64_t number, unsigned first, unsigned last) {
    uint32_t digits[64];
    unsigned places = 0;
    int permuted = axis->scramble == SF_SCRAMBLE_PERMUTED;
    for (; first + places < last && (number || permuted); ++places, number /= axis->base)
        digits[places] = sf_halton_digit(axis, first + places, (uint32_t)(number % axis->base));
    /* Divide digit.fraction by the base, from the last place up: floor of a floor is exact. */
    sf_halton_sum sum = {0, 0};
    while (places-- > 0) sum = sf_halton_divide(sum, digits[places], axis->base);
    return sum;
}

sf_halton_sum sf_halton_tail(const sf_halton_axis *axis, uint64_t number, unsigned first) {
    return sum_of(axis, number, first, axis->digits);
}

uint64_t sf_halton_first_part(const sf_halton_axis *axis, uint32_t number) {
    sf_halton_sum sum = sum_of(axis, number, 0, axis->low_digits);
    return sum.fraction + sum.inexact;
}

/* ---- one coordinate ---- */

static uint64_t fraction_of(const sf_halton_axis *axis, uint64_t index) {
    if (axis->scramble == SF_SCRAMBLE_OWEN) return sf_halton_owen_fraction(axis, sf_halton_owen_root(axis), 0, index);
    uint64_t first = sf_halton_first_part(axis, (uint32_t)(index % axis->block));
    sf_halton_sum tail = sf_halton_tail(axis, index / axis->block, axis->low_digits);
    return sf_halton_join(first, sf_halton_second_part(axis, tail));
}

static uint32_t word_at(uint64_t index, uint32_t dimension, sf_scramble scramble, uint64_t seed) {
    assert(dimension < SF_HALTON_MAX_DIMS);
    sf_halton_axis axis = sf_halton_axis_make(prime(dimension), dimension, scramble, seed);
    return sf_halton_word(fraction_of(&axis, index), axis.fine);
}

uint32_t sf_halton_bits(uint64_t index, uint32_t dimension) { return word_at(index, dimension, SF_SCRAMBLE_NONE, 0); }

float sf_halton_sample(uint64_t index, uint32_t dimension, uint64_t seed) {
    return sf_float_from_bits(word_at(index, dimension, SF_SCRAMBLE_PERMUTED, seed));
}

float sf_halton_owen_sample(uint64_t index, uint32_t dimension, uint64_t seed) {
    return sf_float_from_bits(word_at(index, dimension, SF_SCRAMBLE_OWEN, seed));
}
