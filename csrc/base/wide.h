// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#ifndef SUNFLECK_WIDE_H
#define SUNFLECK_WIDE_H

#include "sunfleck/base.h"

/* 128-bit words, in C99, for what is done once and not in a loop over draws. */
typedef struct sf_wide {
    uint64_t high, low;
} sf_wide;

static inline sf_wide sf_wide_add(sf_wide a, sf_wide b) {
    uint64_t low = a.low + b.low;
    return (sf_wide){a.high + b.high + (low < a.low), low};
}

static inline sf_wide sf_wide_multiply(sf_wide a, sf_wide b) {
    return (sf_wide){sf_multiply_high64(a.low, b.low) + a.high * b.low + a.low * b.high, a.low * b.low};
}

/* The quotient, for a.high < divisor, by long division. */
static inline uint64_t sf_wide_divide(sf_wide a, uint64_t divisor) {
    for (int i = 0; i < 64; ++i) {
        uint64_t carry = a.high >> 63;
        a.high = a.high << 1 | a.low >> 63;
        a.low <<= 1;
        if (carry || a.high >= divisor) {
            a.high -= divisor;
            a.low |= 1;
        }
    }
    return a.low;
}

#endif
