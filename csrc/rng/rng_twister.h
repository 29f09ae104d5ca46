// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#ifndef SUNFLECK_RNG_TWISTER_H
#define SUNFLECK_RNG_TWISTER_H

#include <stdint.h>

/* Polynomials over two elements modulo the characteristic one of a Mersenne Twister; bit i of the
 * limbs is the coefficient of t^i. */
enum { SF_TWISTER_DEGREE = 19937, SF_TWISTER_LIMBS = 312 };

/* n, m, w, r and a of Matsumoto & Nishimura 1998. */
typedef struct sf_twister_shape {
    unsigned length, middle, bits, separation;
    uint64_t twist;
} sf_twister_shape;

/* p = t^exponent modulo the characteristic polynomial. Some milliseconds. */
void sf_twister_power(const sf_twister_shape *shape, uint64_t exponent, uint64_t p[SF_TWISTER_LIMBS]);

#endif
