// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Powers of t modulo the characteristic polynomial of a Mersenne Twister, for skipping. */
#include <assert.h>
#include <string.h>

#include "rng/rng_twister.h"

enum { LIMBS = SF_TWISTER_LIMBS, DEGREE = SF_TWISTER_DEGREE, MAX_TERMS = 512 };

/* The exponents of the characteristic polynomial below the leading one. It has few terms: 135
 * for 32 bits, 285 for 64, of degrees that are at least 64 lower, so that a limb is reduced by
 * as many shifted additions. */
typedef struct modulus {
    unsigned count;
    uint16_t exponents[MAX_TERMS];
} modulus;

/* to ^= from t^shift, for `count` limbs of `from`. */
static void add_shifted(uint64_t *to, const uint64_t *from, unsigned count, unsigned shift) {
    unsigned limb = shift / 64, bits = shift % 64;
    for (unsigned i = 0; i < count; ++i) {
        to[limb + i] ^= from[i] << bits;
        if (bits) to[limb + i + 1] ^= from[i] >> (64 - bits);
    }
}

/* v <- v (t^high + t^low) + constant; `limbs` of v are in use and grow with its degree. */
static void multiply_by_binomial(uint64_t v[LIMBS + 1], unsigned degree, unsigned high, unsigned low,
                                 unsigned constant) {
    uint64_t old[LIMBS];
    memcpy(old, v, sizeof old);
    memset(v, 0, (LIMBS + 1) * sizeof *v);
    add_shifted(v, old, degree / 64 + 1, high);
    add_shifted(v, old, degree / 64 + 1, low);
    v[0] ^= constant;
}

/* Matsumoto & Nishimura 1998, appendix A, by Horner's rule: from Q = t^(n-1) + t^(m-1), r times
 * v Q + a_i, then w - r times v P + a_i with P = t^n + t^m. */
static void find_modulus(const sf_twister_shape *s, modulus *out) {
    uint64_t v[LIMBS + 2] = {1};
    unsigned degree = 0;
    for (unsigned i = 0; i < s->bits; ++i) {
        unsigned back = i < s->separation;
        multiply_by_binomial(v, degree, s->length - back, s->middle - back, s->twist >> i & 1);
        degree += s->length - back;
    }
    assert(degree == DEGREE);
    out->count = 0;
    for (unsigned e = 0; e < DEGREE; ++e)
        if (v[e / 64] >> (e % 64) & 1) {
            assert(out->count < MAX_TERMS && e + 64 <= DEGREE);
            out->exponents[out->count++] = (uint16_t)e;
        }
}

/* Replaces the limb at t^(DEGREE + above) by what it is modulo the polynomial. */
static void fold_limb(uint64_t *p, uint64_t limb, unsigned above, const modulus *m) {
    for (unsigned i = 0; i < m->count; ++i) {
        unsigned place = above + m->exponents[i], bits = place % 64;
        p[place / 64] ^= limb << bits;
        if (bits) p[place / 64 + 1] ^= limb >> (64 - bits);
    }
}

/* The bits of the low half, apart by one. */
static uint64_t spread(uint64_t x) {
    x &= 0xffffffffu;
    x = (x | x << 16) & UINT64_C(0x0000ffff0000ffff);
    x = (x | x << 8) & UINT64_C(0x00ff00ff00ff00ff);
    x = (x | x << 4) & UINT64_C(0x0f0f0f0f0f0f0f0f);
    x = (x | x << 2) & UINT64_C(0x3333333333333333);
    return (x | x << 1) & UINT64_C(0x5555555555555555);
}

/* Squares over two elements only spread the bits; then reduce from the top. */
static void square(uint64_t p[LIMBS], const modulus *m) {
    uint64_t wide[2 * LIMBS + 1];
    for (unsigned i = 0; i < LIMBS; ++i) {
        wide[2 * i] = spread(p[i]);
        wide[2 * i + 1] = spread(p[i] >> 32);
    }
    wide[2 * LIMBS] = 0;
    for (unsigned i = 2 * LIMBS; i-- > LIMBS;) {
        uint64_t limb = wide[i];
        wide[i] = 0;
        if (limb) fold_limb(wide, limb, 64 * i - DEGREE, m);
    }
    uint64_t rest = wide[LIMBS - 1] >> (DEGREE % 64);
    wide[LIMBS - 1] ^= rest << (DEGREE % 64);
    fold_limb(wide, rest, 0, m);
    memcpy(p, wide, LIMBS * sizeof *p);
}

static void multiply_by_t(uint64_t p[LIMBS], const modulus *m) {
    for (unsigned i = LIMBS - 1; i > 0; --i) p[i] = p[i] << 1 | p[i - 1] >> 63;
    p[0] <<= 1;
    if (!(p[DEGREE / 64] >> (DEGREE % 64) & 1)) return;
    p[DEGREE / 64] ^= UINT64_C(1) << (DEGREE % 64);
    for (unsigned i = 0; i < m->count; ++i) p[m->exponents[i] / 64] ^= UINT64_C(1) << (m->exponents[i] % 64);
}

void sf_twister_power(const sf_twister_shape *shape, uint64_t exponent, uint64_t p[LIMBS]) {
    modulus m;
    find_modulus(shape, &m);
    memset(p, 0, LIMBS * sizeof *p);
    p[0] = 1;
    for (int bit = 63; bit >= 0; --bit) {
        if (exponent >> bit >> 1) square(p, &m);
        if (exponent >> bit & 1) multiply_by_t(p, &m);
    }
}
