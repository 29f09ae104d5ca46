// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Two patterns that step along one vector modulo 1: a rank-1 lattice, taken in the order of the
 * radical inverse in base 2 so that it can go on (Hickernell, Hong, L'Ecuyer & Lemieux 2000,
 * "Extensible Lattice Sequences for Quasi-Monte Carlo Quadrature"), and R2 (Roberts 2018, "The
 * Unreasonable Effectiveness of Quasirandom Sequences"). Both are exact fractions of 2^64. */
#include "points/points_lattice_kernels.h"

#include <assert.h>

#include "base/error.h"
#include "base/platform.h"
#include "points/points_set.h"
#include "points/tables/lattice_table.h"

/* ---- R2's increments, in fractions of 2^128 ---- */

typedef struct fraction128 {
    uint64_t high, low;
} fraction128;

static uint64_t multiply_high(uint64_t a, uint64_t b) {
    uint64_t a0 = a & 0xffffffffu, a1 = a >> 32, b0 = b & 0xffffffffu, b1 = b >> 32;
    uint64_t middle = (a0 * b0 >> 32) + (a1 * b0 & 0xffffffffu) + a0 * b1;
    return a1 * b1 + (a1 * b0 >> 32) + (middle >> 32);
}

/* a b, off by less than 4 units of the last place. */
static fraction128 multiply(fraction128 a, fraction128 b) {
    fraction128 r = {a.high * b.high, a.high * b.high};
    uint64_t low = r.low, part = multiply_high(a.high, b.low), other = multiply_high(a.low, b.high);
    r.high = multiply_high(a.high, b.high);
    low += part;
    r.high += low < part;
    low += other;
    r.high += low < other;
    r.low = low;
    return r;
}

static fraction128 power(fraction128 base, uint32_t exponent) {
    fraction128 result = {UINT64_MAX, UINT64_MAX}; /* 1, but for a unit */
    for (; exponent; exponent >>= 1, base = multiply(base, base))
        if (exponent & 1u) result = multiply(result, base);
    return result;
}

/* The root g of g^d + g^(d+1) = 1 in (0, 1), a bit at a time: 1 / g is the generalized golden
 * ratio, the root of x^(d+1) = x + 1. */
static fraction128 golden_inverse(uint32_t dims) {
    fraction128 g = {0, 0};
    for (int bit = 127; bit >= 0; --bit) {
        fraction128 trial = g;
        if (bit >= 64)
            trial.high |= UINT64_C(1) << (bit - 64);
        else
            trial.low |= UINT64_C(1) << bit;
        fraction128 p = power(trial, dims), next = multiply(p, trial);
        uint64_t low = p.low + next.low, carry = low < p.low, high = p.high + next.high;
        int over = high < p.high || (carry && high == UINT64_MAX);
        if (!over) g = trial;
    }
    return g;
}

void sf_r2_increments(uint32_t dims, uint64_t *increments) {
    assert(dims >= 1 && dims <= SF_POINTS_MAX_DIMS);
    fraction128 g = golden_inverse(dims), p = g;
    for (uint32_t d = 0; d < dims; ++d, p = multiply(p, g)) increments[d] = p.high + (p.low >> 63);
}

/* ---- points ---- */

uint64_t sf_shift_bits(uint64_t seed, uint32_t dimension) { return sf_hash64(seed, dimension); }

uint64_t sf_lattice_bits(uint64_t index, uint32_t dimension) {
    assert(dimension < SF_LATTICE_MAX_DIMS);
    return sf_reverse_bits64(index) * sf_lattice_vector[dimension];
}

float sf_lattice_sample(uint64_t index, uint32_t dimension) {
    return sf_float_from_bits((uint32_t)(sf_lattice_bits(index, dimension) >> 32));
}

float sf_lattice_shifted_sample(uint64_t index, uint32_t dimension, uint64_t seed) {
    return sf_float_from_bits((uint32_t)((sf_lattice_bits(index, dimension) + sf_shift_bits(seed, dimension)) >> 32));
}

/* Roberts starts at one half, and from point 1. */
static const uint64_t r2_begin = UINT64_C(1) << 63;

float sf_r2_sample(uint64_t index, uint64_t increment) {
    return sf_float_from_bits((uint32_t)((r2_begin + (index + 1) * increment) >> 32));
}

float sf_r2_shifted_sample(uint64_t index, uint32_t dimension, uint64_t seed, uint64_t increment) {
    return sf_float_from_bits((uint32_t)((sf_shift_bits(seed, dimension) + (index + 1) * increment) >> 32));
}

/* The block of a set: [dims] where each dimension begins, then [dims] its steps. */
static sf_status prepare(sf_point_set *set, uint64_t begin, const char *what, sf_error *error) {
    uint32_t dims = set->options.dims;
    size_t bytes = 2 * (size_t)dims * sizeof(uint64_t);
    uint64_t *begins = set->block = sf_aligned_alloc(bytes);
    if (!begins) return sf_fail_memory(error, what, bytes);
    int shifted = set->options.scramble == SF_SCRAMBLE_SHIFT;
    for (uint32_t d = 0; d < dims; ++d) begins[d] = shifted ? sf_shift_bits(set->options.seed, d) : begin;
    return SF_STATUS_OK;
}

sf_status sf_lattice_prepare(sf_point_set *set, sf_error *error) {
    sf_status status = prepare(set, 0, "the tables of lattice", error);
    if (status != SF_STATUS_OK) return status;
    uint64_t *steps = (uint64_t *)set->block + set->options.dims;
    for (uint32_t d = 0; d < set->options.dims; ++d) steps[d] = sf_lattice_vector[d];
    return SF_STATUS_OK;
}

sf_status sf_r2_prepare(sf_point_set *set, sf_error *error) {
    sf_status status = prepare(set, r2_begin, "the tables of r2", error);
    if (status == SF_STATUS_OK) sf_r2_increments(set->options.dims, (uint64_t *)set->block + set->options.dims);
    return status;
}

static void make(sf_points_cursor *cursor, uint64_t first, size_t rows, int reversed, uint32_t *high, uint32_t *low) {
    uint64_t factors[256];
    uint32_t dims = cursor->set->options.dims;
    const uint64_t *begins = cursor->set->block;
    const sf_lattice_kernels *kernels = sf_lattice_kernels_at(sf_isa_active());
    for (size_t n; rows; rows -= n, first += n) {
        n = rows < 256 ? rows : 256;
        for (size_t i = 0; i < n; ++i) factors[i] = reversed ? sf_reverse_bits64(first + i) : first + i + 1;
        kernels->fill(factors, n, begins, begins + dims, dims, high, low);
        high += n * dims;
        if (low) low += n * dims;
    }
}

void sf_lattice_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low) {
    make(cursor, first, rows, 1, high, low);
}

void sf_r2_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low) {
    make(cursor, first, rows, 0, high, low);
}
