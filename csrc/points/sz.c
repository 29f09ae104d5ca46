// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* SZ sequences: a binary net in which every pair of dimensions (2k, 2k + 1) is a (0, 2)-sequence
 * in base 2, every four (4k .. 4k + 3) are a (0, 4)-sequence in base 4, every sixteen a
 * (0, 16)-sequence in base 16, and so on to (0, 65536). Ahmed et al. 2024, "SZ Sequences:
 * Binary-Based (0, 2^q)-Sequences", found such families by search; here is a derivation, whose
 * matrices are not theirs.
 *
 * Only the first sixteen are given out: in steps of 16 matrices are alike to 2^8 points.
 *
 * Let F be the field of 2^q elements, q = 2^r, and read the index in digits of q bits as the
 * polynomial f(t) whose coefficient of t^J is digit J. For a in F let P(a) be the linear map from
 * f(t) to f(t + a), whose matrix is Pascal's, entry (I, J) being binom(J, I) a^(J-I): the digits
 * of f(t + a), mirrored at the point, are Niederreiter's (1987) and Faure's (1982) sequence, and
 * the 2^q values of a give a (0, 2^q)-sequence in base 2^q. P(a + b) = P(a) P(b).
 *
 * The nimbers below 2^q are such a field for every q = 2^r, each within the next, with XOR for its
 * sum, so that a dimension's number is an element of all that are large enough. Write it as the
 * sum of its bit 0, bit 1, bits 2-3, bits 4-7 and bits 8-15, c_0 .. c_4; the matrix of dimension
 * d is then M(d) = V_0(c_0) V_1(c_1) V_2(c_2) V_3(c_3) V_4(c_4), where V_r(c) is P(c^(2^r)) on digits of
 * 2^r bits.
 *
 * Why it holds. Let A be P(b) on digits of q bits. As binom(2J+j, 2I+i) = binom(J, I) binom(j, i)
 * mod 2 (Lucas), A on two digits taken as one of 2q bits is P(b^2) times the matrix binom(j, i)
 * b^(j-i) within each new digit, in either order, since all entries are in one field and commute.
 * A change within digits from the left, S, is a bijection of each digit. So, by induction from V_0,
 * M(a) for a < 2^q is S times P(a^(2^r)) on digits of q bits, and a -> a^(2^r) permutes F: these are
 * the 2^q Niederreiter-Faure matrices. M(a + h), h a multiple of 2^q, is M(a) times factors that
 * do not depend on a, are upper triangular and have an identity for every diagonal block of q
 * bits: they leave a sequence's quality as it is. */
#include <assert.h>

#include "points/points_set.h"
#include "sunfleck/points.h"

/* The nim product of two nimbers below 2^(2 * half): (a + A F)(b + B F) with F = 2^half, whose
 * square is F + F / 2 (Conway 1976, "On Numbers and Games", chapter 6). */
static uint32_t nim_product(uint32_t x, uint32_t y, unsigned half) {
    if (half == 0) return x & y;
    uint32_t mask = (UINT32_C(1) << half) - 1, a = x & mask, b = y & mask, top_a = x >> half, top_b = y >> half;
    if (half == 1) return ((a & top_b) ^ (top_a & b) ^ (top_a & top_b)) << 1 | ((a & b) ^ (top_a & top_b));
    uint32_t low = nim_product(a, b, half / 2), high = nim_product(top_a, top_b, half / 2);
    uint32_t cross = nim_product(a ^ top_a, b ^ top_b, half / 2) ^ low;
    return cross << half | (low ^ nim_product(high, UINT32_C(1) << (half - 1), half / 2));
}

/* One halving of shift_polynomials: adds `factor` times the upper digits of every pair of `width`
 * bits to the lower ones. A digit's product is the sum of those of its bits. */
static void add_upper(uint32_t *digits, unsigned count, uint32_t factor, unsigned bits, unsigned width) {
    uint32_t ones = UINT32_MAX / ((UINT32_C(1) << bits) - 1) & UINT32_MAX / ((UINT32_C(1) << width) + 1);
    uint32_t products[16];
    for (unsigned b = 0; b < bits; ++b) products[b] = nim_product(UINT32_C(1) << b, factor, bits / 2);
    for (unsigned i = 0; i < count; ++i) {
        uint32_t upper = digits[i] >> width, sum = 0;
        for (unsigned b = 0; b < bits; ++b) sum ^= (upper >> b & ones) * products[b];
        digits[i] ^= sum;
    }
}

/* From the digits of f(t) to those of f(t + a), for `count` words. With f = g + t^h k, g of lower
 * degree than h, a power of two, and (t + a)^h = t^h + a^h: the upper half of the digits is that of
 * k(t + a), the lower g(t + a) + a^h k(t + a). */
static void shift_polynomials(uint32_t *digits, unsigned count, uint32_t a, unsigned bits) {
    for (unsigned width = bits; width <= 16; width *= 2) {
        add_upper(digits, count, a, bits, width);
        a = nim_product(a, a, bits / 2);
    }
}

/* From the digits of an index to those of the dimension's point, mirrored, for `count` words. */
static void transform(uint32_t dimension, uint32_t *digits, unsigned count) {
    for (unsigned r = 3; r-- > 0;) { /* c_3 and c_4 are 0 in the first sixteen dimensions */
        unsigned bits = 1u << r;
        uint32_t part = r ? dimension & ((1u << bits) - (1u << bits / 2)) : dimension & 1;
        if (!part) continue;
        for (unsigned k = 0; k < r; ++k) part = nim_product(part, part, bits / 2);
        shift_polynomials(digits, count, part, bits);
    }
}

void sf_sz_matrix(uint32_t dimension, uint32_t columns[32]) {
    assert(dimension < SF_SZ_MAX_DIMS);
    for (unsigned k = 0; k < 32; ++k) columns[k] = UINT32_C(1) << k;
    transform(dimension, columns, 32);
    for (unsigned k = 0; k < 32; ++k) columns[k] = sf_reverse_bits32(columns[k]);
}

uint32_t sf_sz_bits(uint32_t index, uint32_t dimension) {
    assert(dimension < SF_SZ_MAX_DIMS);
    transform(dimension, &index, 1);
    return sf_reverse_bits32(index);
}
