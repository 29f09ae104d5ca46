// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The first four dimensions of an SZ sequence: a binary net in which the pairs (0, 1) and (2, 3) are
 * (0, 2)-sequences in base 2, and all four a (0, 4)-sequence in base 4. Ahmed et al. 2024, "SZ
 * Sequences: Binary-Based (0, 2^q)-Sequences", found families of such by search, which go on to sixteen
 * in base 16 and further; here is a derivation, whose matrices are not theirs.
 *
 * Only four are given out. Of sixteen, in whatever order of their own the fours come, some pairs
 * across fours have the same first digits up to 2^4 points, and nearly so to 2^8: worse than
 * independent points, and than Sobol's.
 *
 * Let F be the field of four elements 0, 1, 2, 3 with XOR for its sum, and read the index in digits of
 * two bits as the polynomial f(t) whose coefficient of t^J is digit J. For a in F let P(a) be the linear
 * map from f(t) to f(t + a), whose matrix is Pascal's, entry (I, J) being binom(J, I) a^(J-I): the digits
 * of f(t + a), mirrored at the point, are Niederreiter's (1987) and Faure's (1982) sequence, and
 * the four values of a give a (0, 4)-sequence in base 4. P(a + b) = P(a) P(b).
 *
 * The bits 0 and 1 are the field of two elements within F. Dimension d is the element of its number; with
 * bit 0 as c and bit 1, as a number 0 or 2, as h, its matrix is V(c) P(h^2), where V(c) is P(c) on single bits.
 *
 * Why it holds. As binom(2J+j, 2I+i) = binom(J, I) binom(j, i) mod 2 (Lucas), V(c) on two bits taken as one
 * digit is P(c^2) times the matrix binom(j, i) c^(j-i) within each digit, in either order. A change
 * within digits from the left is a bijection of each. So all four are, up to such, P(c^2 + h^2) =
 * P(d^2), and squaring permutes F: these are the four Niederreiter-Faure matrices. In base 2, V(0) and V(1)
 * are the same with F of two elements, and P(h^2), common to the pair (2, 3), is upper triangular with an
 * identity for every diagonal block of two bits: it leaves a sequence's quality as it is. */
#include <assert.h>

#include "points/points_set.h"
#include "sunfleck/points.h"

#define LOW_BITS 0x55555555u /* of the digits of two bits */

/* From the bits of f(t) to those of f(t + 1), for polynomials over two elements. With f = g + t^k h,
 * g of lower degree than k, a power of two, and (t + 1)^k = t^k + 1: the upper half is that of h(t + 1),
 * the lower g(t + 1) + h(t + 1). */
static uint32_t shift_by_one(uint32_t bits) {
    bits ^= bits >> 1 & LOW_BITS;
    bits ^= bits >> 2 & 0x33333333u;
    bits ^= bits >> 4 & 0x0f0f0f0fu;
    bits ^= bits >> 8 & 0x00ff00ffu;
    return bits ^ bits >> 16;
}

/* Every digit of two bits times 3: 3 * 1 = 3, 3 * 2 = 1. */
static uint32_t times_three(uint32_t digits) {
    uint32_t low = digits & LOW_BITS, high = digits >> 1 & LOW_BITS;
    return (low ^ high) | low << 1;
}

/* Every digit times 2, the square of 3: 2 * 1 = 2, 2 * 2 = 3. */
static uint32_t times_two(uint32_t digits) {
    uint32_t low = digits & LOW_BITS, high = digits >> 1 & LOW_BITS;
    return high | (low ^ high) << 1;
}

/* From the digits of f(t) to those of f(t + 3), likewise, (t + 3)^k = t^k + 3^k: 3^k is 3, 2, 3, 2 for
 * k of 1, 2, 4, 8 digits. */
static uint32_t shift_by_three(uint32_t digits) {
    digits ^= times_three(digits >> 2 & 0x33333333u);
    digits ^= times_two(digits >> 4 & 0x0f0f0f0fu);
    digits ^= times_three(digits >> 8 & 0x00ff00ffu);
    return digits ^ times_two(digits >> 16);
}

/* From the digits of an index to those of the dimension's point, mirrored. */
static uint32_t transform(uint32_t dimension, uint32_t digits) {
    if (dimension & 2) digits = shift_by_three(digits); /* h^2 = 2 * 2 = 3 */
    return dimension & 1 ? shift_by_one(digits) : digits;
}

void sf_sz_matrix(uint32_t dimension, uint32_t columns[32]) {
    assert(dimension < SF_SZ_MAX_DIMS);
    for (unsigned k = 0; k < 32; ++k) columns[k] = sf_reverse_bits32(transform(dimension, UINT32_C(1) << k));
}

uint32_t sf_sz_bits(uint32_t index, uint32_t dimension) {
    assert(dimension < SF_SZ_MAX_DIMS);
    return sf_reverse_bits32(transform(dimension, index));
}
