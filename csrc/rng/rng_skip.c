// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Skips draws of congruential generators and of those that are linear over bits, in steps that double. */
#include <assert.h>
#include <string.h>

#include "rng/rng_methods.h"

enum { MAX_WORDS = 4 };

uint64_t sf_lcg_skip(uint64_t x, uint64_t a, uint64_t c, uint64_t m, uint64_t count) {
    /* Compose the map with itself for each bit of the count. */
    uint64_t total_a = 1, total_c = 0;
    for (; count; count >>= 1) {
        if (count & 1) {
            total_a = sf_multiply_add_modulo64(total_a, a, 0, m);
            total_c = sf_multiply_add_modulo64(total_c, a, c, m);
        }
        c = sf_multiply_add_modulo64(c, a, c, m);
        a = sf_multiply_add_modulo64(a, a, 0, m);
    }
    return sf_multiply_add_modulo64(x, total_a, total_c, m);
}

/* p <- p t mod the characteristic polynomial. */
static void multiply_by_t(uint64_t *p, unsigned words, const uint64_t *polynomial) {
    uint64_t carry = p[words - 1] >> 63;
    for (unsigned i = words - 1; i > 0; --i) p[i] = p[i] << 1 | p[i - 1] >> 63;
    p[0] <<= 1;
    for (unsigned i = 0; i < words; ++i) p[i] ^= polynomial[i] & -carry;
}

/* p <- p^2 mod the characteristic polynomial, by Horner's rule over the bits of p. */
static void square(uint64_t *p, unsigned words, const uint64_t *polynomial) {
    uint64_t result[MAX_WORDS] = {0};
    for (unsigned bit = 64 * words; bit-- > 0;) {
        multiply_by_t(result, words, polynomial);
        uint64_t take = -(p[bit / 64] >> (bit % 64) & 1);
        for (unsigned i = 0; i < words; ++i) result[i] ^= p[i] & take;
    }
    memcpy(p, result, words * sizeof *p);
}

void sf_linear_skip(uint64_t *state, unsigned words, const uint64_t *polynomial, void (*step)(uint64_t *state),
                    uint64_t count) {
    assert(words <= MAX_WORDS);
    /* A step M satisfies its characteristic polynomial, so M^count = p(M), p = t^count modulo it
     * (Haramoto et al. 2008, "Efficient Jump Ahead for F2-Linear Random Number Generators"). */
    uint64_t p[MAX_WORDS] = {1};
    for (int bit = 63; bit >= 0; --bit) {
        square(p, words, polynomial);
        if (count >> bit & 1) multiply_by_t(p, words, polynomial);
    }
    /* Add up the states M^k x that p selects. */
    uint64_t sum[MAX_WORDS] = {0};
    for (unsigned bit = 0; bit < 64 * words; ++bit) {
        uint64_t take = -(p[bit / 64] >> (bit % 64) & 1);
        for (unsigned i = 0; i < words; ++i) sum[i] ^= state[i] & take;
        step(state);
    }
    memcpy(state, sum, words * sizeof *state);
}
