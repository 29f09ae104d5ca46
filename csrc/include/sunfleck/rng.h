// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* rng: generators of random bits.
 *
 * Each method is a small struct that holds its whole state, is copied by assignment, and has an
 * inline `next`: use it directly where the method is known. sf_rng is any of them, chosen by
 * name at run time, with bulk fills that cost the switch once.
 *
 * Every function is safe on distinct objects: one generator must not be drawn from by two
 * threads at once. Streams are frozen: a generator, seed and stream give the same words in every
 * release, on every instruction-set level.
 */
#ifndef SUNFLECK_RNG_H
#define SUNFLECK_RNG_H

#include "sunfleck/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Park & Miller 1988, "minimal standard": x = 16807 x mod 2^31 - 1. A draw is 1 .. 2^31 - 2, and
 * the period is 2^31 - 2: seconds of a render. State 0 is refused. */
typedef struct sf_minstd {
    uint32_t state; /* 1 .. 2^31 - 2 */
} sf_minstd;

static inline uint32_t sf_minstd_next(sf_minstd *g) {
    /* Reduce modulo 2^31 - 1 by adding the high part to the low, as 2^31 = 1 there. */
    uint64_t product = UINT64_C(16807) * g->state;
    uint32_t x = (uint32_t)(product & 0x7fffffffu) + (uint32_t)(product >> 31);
    return g->state = x >= 0x7fffffffu ? x - 0x7fffffffu : x;
}

/* Marsaglia 2003, "Xorshift RNGs", 64 bits, shifts 21-35-4: right, left, right. Period
 * 2^64 - 1; linear over bits; state 0 would stay 0 and is refused. */
typedef struct sf_xorshift64 {
    uint64_t state; /* not 0 */
} sf_xorshift64;

static inline uint64_t sf_xorshift64_next(sf_xorshift64 *g) {
    uint64_t x = g->state;
    x ^= x >> 21;
    x ^= x << 35;
    x ^= x >> 4;
    return g->state = x;
}

/* The same in the order left, right, left. */
static inline uint64_t sf_xorshift64_lrl_next(sf_xorshift64 *g) {
    uint64_t x = g->state;
    x ^= x << 21;
    x ^= x >> 35;
    x ^= x << 4;
    return g->state = x;
}

/* The lecture's combination: the shift-XOR above, XORed with the linear congruential
 * x = 6364136223846793005 x + 1442695040888963407 mod 2^64 (Knuth's MMIX constants). The LCG's
 * low bits are weak and the shift-XOR is linear; neither shows through the other. Period
 * 2^64 (2^64 - 1). */
typedef struct sf_combined {
    uint64_t lcg;
    uint64_t xorshift; /* not 0 */
} sf_combined;

static inline uint64_t sf_combined_next(sf_combined *g) {
    sf_xorshift64 shifter = {g->xorshift};
    g->lcg = g->lcg * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    g->xorshift = sf_xorshift64_next(&shifter);
    return g->lcg ^ g->xorshift;
}

/* O'Neill 2014, PCG-XSH-RR 64/32: period 2^64 in each of 2^63 streams. */
typedef struct sf_pcg32 {
    uint64_t state;
    uint64_t increment; /* odd: 2 stream + 1 */
} sf_pcg32;

/* Seeded as the reference's pcg32_srandom_r(seed, stream); the top bit of `stream` is lost. */
static inline sf_pcg32 sf_pcg32_seeded(uint64_t seed, uint64_t stream) {
    sf_pcg32 g;
    g.increment = stream << 1 | 1;
    g.state = (g.increment + seed) * UINT64_C(6364136223846793005) + g.increment;
    return g;
}

static inline uint32_t sf_pcg32_next(sf_pcg32 *g) {
    uint64_t x = g->state;
    g->state = x * UINT64_C(6364136223846793005) + g->increment;
    uint32_t folded = (uint32_t)((x >> 18 ^ x) >> 27), turn = (uint32_t)(x >> 59);
    return folded >> turn | folded << (-turn & 31);
}

/* Blackman & Vigna 2019, xoshiro256++ 1.0: period 2^256 - 1; state 0 would stay 0. */
typedef struct sf_xoshiro256pp {
    uint64_t s[4]; /* not all 0 */
} sf_xoshiro256pp;

static inline uint64_t sf_xoshiro256pp_next(sf_xoshiro256pp *g) {
    uint64_t sum = g->s[0] + g->s[3], result = (sum << 23 | sum >> 41) + g->s[0], t = g->s[1] << 17;
    g->s[2] ^= g->s[0];
    g->s[3] ^= g->s[1];
    g->s[1] ^= g->s[2];
    g->s[0] ^= g->s[3];
    g->s[2] ^= t;
    g->s[3] = g->s[3] << 45 | g->s[3] >> 19;
    return result;
}

/* Steele, Lea & Flood 2014, SplitMix64: a counter in steps of the golden ratio, mixed. Period
 * 2^64, each 64-bit word once. */
typedef struct sf_splitmix64 {
    uint64_t state;
} sf_splitmix64;

static inline uint64_t sf_splitmix64_next(sf_splitmix64 *g) {
    return sf_mix64(g->state += UINT64_C(0x9e3779b97f4a7c15));
}

/* ---- any of them ---- */

/* The generators by number. The numbers may change between releases, the names do not. */
typedef enum sf_rng_kind {
    SF_RNG_MINSTD = 0,
    SF_RNG_XORSHIFT64,
    SF_RNG_XORSHIFT64_LRL,
    SF_RNG_COMBINED,
    SF_RNG_PCG32,
    SF_RNG_XOSHIRO256PP,
    SF_RNG_SPLITMIX64,
    SF_RNG_COUNT
} sf_rng_kind;

typedef struct sf_rng {
    sf_rng_kind kind;
    uint32_t pending;     /* the high half of a 64-bit draw whose low half was given out */
    int has_pending;
    uint64_t seed, stream; /* as given to sf_rng_init */
    uint64_t spawned;      /* children so far */
    union {
        sf_minstd minstd;
        sf_xorshift64 xorshift64; /* both orders */
        sf_combined combined;
        sf_pcg32 pcg32;
        sf_xoshiro256pp xoshiro256pp;
        sf_splitmix64 splitmix64;
    } as;
} sf_rng;

/* "minstd", "xorshift64-lrl", …, and a line about each; NULL beyond the last, so that they can
 * be listed. Thread-safe. */
const char *sf_rng_name(sf_rng_kind kind);
const char *sf_rng_description(sf_rng_kind kind);

/* The generator called `name`; the error lists the names. Thread-safe. */
sf_status sf_rng_find(const char *name, sf_rng_kind *kind, sf_error *error);

/* Bits in a native draw: 31 (minstd), 32 (pcg32) or 64. 0 for an unknown kind. */
unsigned sf_rng_native_bits(sf_rng_kind kind);

/* Seeds `rng`. With stream 0 a generator is seeded as its reference is, so that published
 * vectors hold:
 *
 *   minstd                      the state is the seed, 1 .. 2^31 - 2
 *   xorshift64, xorshift64-lrl  the state is the seed, not 0
 *   combined                    both states are drawn from SplitMix64 of the seed
 *   pcg32                       pcg32_srandom_r(seed, stream): every stream is the method's own;
 *                               stream < 2^63
 *   xoshiro256++                four draws of SplitMix64 of the seed, as its authors ask
 *   splitmix64                  the state is the seed
 *
 * Where the method has no streams, stream s > 0 is seeded from sf_hash64(seed, s) reduced to
 * what the method takes: distinct streams are then distinct points of one cycle, and overlap
 * with the probability that chance gives. Refuses a seed that the method cannot take, naming
 * its range; with stream > 0 every seed is taken. */
sf_status sf_rng_init(sf_rng *rng, sf_rng_kind kind, uint64_t seed, uint64_t stream, sf_error *error);

/* The next native draw, in 31, 32 or 64 bits. */
uint64_t sf_rng_next_raw(sf_rng *rng);

/* Bulk fills. Calls may be split at any place with the same words.
 *
 * u32  raw draws in order: a 31-bit method gives its 31 bits, a 64-bit method its low half
 *      first (an unpaired high half waits for the next 32-bit or float draw)
 * u64  raw draws in order; from 31- and 32-bit methods two draws, the first in the low half
 * f32  in [0,1): the top 24 bits of each word of `u32` (31-bit words count from their own
 *      top bit), so that one 64-bit draw gives two floats
 * f64  in [0,1): the top 53 bits of a 64-bit draw; from two draws a, b of 31 or 32 bits, the top
 *      27 bits of a above the top 26 of b (genrand_res53 of the Mersenne Twister's authors)
 *
 * u64 and f64 leave a waiting half where it is, as NumPy's generators do. Cannot fail. */
void sf_rng_fill_u32(sf_rng *rng, size_t count, uint32_t *out);
void sf_rng_fill_u64(sf_rng *rng, size_t count, uint64_t *out);
void sf_rng_fill_f32(sf_rng *rng, size_t count, float *out);
void sf_rng_fill_f64(sf_rng *rng, size_t count, double *out);

/* One value of the fill of that name. */
static inline uint32_t sf_rng_next_u32(sf_rng *rng) {
    uint32_t value;
    sf_rng_fill_u32(rng, 1, &value);
    return value;
}
static inline uint64_t sf_rng_next_u64(sf_rng *rng) {
    uint64_t value;
    sf_rng_fill_u64(rng, 1, &value);
    return value;
}
static inline float sf_rng_next_f32(sf_rng *rng) {
    float value;
    sf_rng_fill_f32(rng, 1, &value);
    return value;
}
static inline double sf_rng_next_f64(sf_rng *rng) {
    double value;
    sf_rng_fill_f64(rng, 1, &value);
    return value;
}

/* Passes over `count` native draws in O(log count), and drops a waiting half word.
 * SF_STATUS_UNSUPPORTED, with `rng` unchanged, for a method that has no such skip. */
sf_status sf_rng_skip(sf_rng *rng, uint64_t count, sf_error *error);

/* Makes `count` independent generators of the parent's kind: child number k (counted over the
 * parent's life) has seed sf_hash64(h, 2 k) and stream sf_hash64(h, 2 k + 1) | 1 (within the
 * method's range), where h = sf_hash64(seed, stream) of the parent. The parent's own draws do
 * not move, so that children do not depend on how much it was used. */
void sf_rng_spawn(sf_rng *parent, size_t count, sf_rng *children);

/* The whole state as words: first the method's own, in the order of its struct, then
 * has_pending << 32 | pending, seed, stream, spawned. */
#define SF_RNG_STATE_MAX 1024
size_t sf_rng_state_size(sf_rng_kind kind); /* words, at most SF_RNG_STATE_MAX; 0 for an unknown kind */
void sf_rng_get_state(const sf_rng *rng, uint64_t *words);

/* Restores a state; a wrong count, or a state that the method cannot be in (all zero, out of
 * range), is refused and leaves `rng` as it was. */
sf_status sf_rng_set_state(sf_rng *rng, sf_rng_kind kind, const uint64_t *words, size_t count, sf_error *error);

#ifdef __cplusplus
}
#endif
#endif
