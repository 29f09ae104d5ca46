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
 * release, on every instruction set.
 */
#ifndef SUNFLECK_RNG_H
#define SUNFLECK_RNG_H

#include "sunfleck/base.h"
#include "sunfleck/rng_congruential.h"
#include "sunfleck/rng_counter.h"
#include "sunfleck/rng_linear.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The generators by number. The numbers may change between releases, the names do not. */
typedef enum sf_rng_kind {
    SF_RNG_MINSTD = 0,
    SF_RNG_LCG32,
    SF_RNG_LCG64,
    SF_RNG_RANDU,
    SF_RNG_RAN1,
    SF_RNG_RAN2,
    SF_RNG_XORSHIFT64,
    SF_RNG_XORSHIFT64_LRL,
    SF_RNG_COMBINED,
    SF_RNG_MT19937,
    SF_RNG_MT19937_64,
    SF_RNG_PCG32,
    SF_RNG_PCG64DXSM,
    SF_RNG_XOSHIRO256PP,
    SF_RNG_SFC64,
    SF_RNG_PHILOX4X32,
    SF_RNG_PHILOX4X64,
    SF_RNG_SPLITMIX64,
    SF_RNG_COUNT
} sf_rng_kind;

/* Any generator. The union is as large as the Mersenne Twister, 2.6 KB, so that this too is a
 * value: no heap, no destroy, copied by assignment. The state is last, and no function here
 * touches more of it than the method has, so that a small generator pays for the size only in
 * address space, and in assignments (some 40 ns). Where generators are kept by the thousand, keep
 * the method's own struct (pcg32: 16 bytes). */
typedef struct sf_rng {
    sf_rng_kind kind;
    uint32_t pending; /* the high half of a 64-bit draw whose low half was given out */
    int has_pending;
    uint64_t seed, stream; /* as given to sf_rng_init */
    uint64_t spawned;      /* children so far */
    union {
        sf_minstd minstd;
        sf_lcg32 lcg32;
        sf_lcg64 lcg64;
        sf_randu randu;
        sf_ran1 ran1;
        sf_ran2 ran2;
        sf_xorshift64 xorshift64; /* both orders */
        sf_combined combined;
        sf_mt19937 mt19937;
        sf_mt19937_64 mt19937_64;
        sf_pcg32 pcg32;
        sf_pcg64dxsm pcg64dxsm;
        sf_xoshiro256pp xoshiro256pp;
        sf_sfc64 sfc64;
        sf_philox4x32 philox4x32;
        sf_philox4x64 philox4x64;
        sf_splitmix64 splitmix64;
    } as;
} sf_rng;

/* "minstd", "xorshift64-lrl", …, and a line about each; NULL beyond the last, so that they can
 * be listed. Thread-safe. */
SF_API const char *sf_rng_name(sf_rng_kind kind);
SF_API const char *sf_rng_description(sf_rng_kind kind);

/* The generator called `name`; the error lists the names. Thread-safe. */
SF_API sf_status sf_rng_find(const char *name, sf_rng_kind *kind, sf_error *error);

/* Bits in a native draw: 31 (minstd, randu, ran1, ran2), 32 (lcg32, mt19937, pcg32, philox4x32) or
 * 64. 0 for an unknown kind. */
SF_API unsigned sf_rng_native_bits(sf_rng_kind kind);

/* Seeds `rng`. With stream 0 a generator is seeded as its reference is, so that published
 * vectors hold:
 *
 *   minstd, ran1                the state is the seed, 1 .. 2^31 - 2
 *   ran2                        both states are the seed, 1 .. 2147483398
 *   randu                       the state is the seed, odd, below 2^31
 *   lcg32, lcg64                the state is the seed, below the modulus; with increment 0 it must
 *                               share no factor with the modulus, else it must not be a fixed point
 *   xorshift64, xorshift64-lrl  the state is the seed, not 0
 *   combined                    both states are drawn from SplitMix64 of the seed
 *   mt19937                     init_genrand(seed), below 2^32
 *   mt19937-64                  init_genrand64(seed)
 *   pcg32                       pcg32_srandom_r(seed, 0)
 *   pcg64dxsm                   cm_setseq_dxsm_128_64(seed, stream): every stream is its own
 *   xoshiro256++                four draws of SplitMix64 of the seed, as its authors ask
 *   sfc64                       a = b = c = seed, counter 1, 12 draws thrown away
 *   philox4x32                  key = seed, counter = stream 2^64: every stream is its own
 *   philox4x64                  key = (seed, stream), counter = 0: every stream is its own
 *   splitmix64                  the state is the seed
 *
 * Where the method has no streams, stream s > 0 is seeded from sf_hash64(seed, s) reduced to
 * what the method takes (mt19937, mt19937-64: by init_by_array of seed and stream; sfc64: three
 * words drawn from SplitMix64 of that hash, then 12 draws thrown away): distinct streams are then
 * distinct points of one cycle, and overlap with the probability that chance gives. pcg32 has
 * streams of its own, but those of one seed correlate when they are interleaved: with h =
 * sf_hash64(seed, s), stream s > 0 is pcg32_srandom_r(sf_hash64(h, 0), sf_hash64(h, 1)), for
 * s < 2^63. Refuses a seed that the method cannot take, naming its range; with stream > 0 every
 * seed is taken. */
SF_API sf_status sf_rng_init(sf_rng *rng, sf_rng_kind kind, uint64_t seed, uint64_t stream, sf_error *error);

/* The constants of a general linear congruential generator, lcg32 or lcg64. */
typedef struct sf_lcg_parameters {
    uint64_t multiplier; /* 1 .. modulus - 1, without a common factor with it; not 1 if increment = 0 */
    uint64_t increment;  /* 0 .. modulus - 1 */
    uint64_t modulus;    /* lcg32: 2 .. 2^32; lcg64: 2^32 + 1 .. 2^64 - 1, or 0 for 2^64 */
} sf_lcg_parameters;

/* The constants that sf_rng_init gives lcg32 and lcg64 (see sf_lcg32, sf_lcg64). */
SF_API sf_lcg_parameters sf_lcg_parameters_default(sf_rng_kind kind);

/* sf_rng_init for lcg32 and lcg64 with constants of your own. Constants under which the sequence
 * would collapse to few states are refused; those that are merely bad are not. A draw is the
 * state; floats come from state / modulus (see the fills). Children and streams keep the
 * constants. */
SF_API sf_status sf_rng_init_lcg(sf_rng *rng, sf_rng_kind kind, const sf_lcg_parameters *parameters, uint64_t seed,
                                 uint64_t stream, sf_error *error);

/* Starts again, as sf_rng_init or sf_rng_init_lcg did; children are counted from 0 again. */
SF_API void sf_rng_reset(sf_rng *rng);

/* The next native draw, in 31, 32 or 64 bits. */
SF_API uint64_t sf_rng_next_raw(sf_rng *rng);

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
 * Draws x of lcg32 and lcg64 with a modulus m other than 2^32 and 2^64 become floats as
 * x 2^32 / m and x 2^64 / m, rounded down, would, one draw of lcg64 to a float of either kind;
 * u32 and u64 give x itself.
 *
 * u64 and f64 leave a waiting half where it is, as NumPy's generators do. Cannot fail. */
SF_API void sf_rng_fill_u32(sf_rng *rng, size_t count, uint32_t *out);
SF_API void sf_rng_fill_u64(sf_rng *rng, size_t count, uint64_t *out);
SF_API void sf_rng_fill_f32(sf_rng *rng, size_t count, float *out);
SF_API void sf_rng_fill_f64(sf_rng *rng, size_t count, double *out);

/* One value of the fill of that name. */
SF_API uint32_t sf_rng_next_u32(sf_rng *rng);
SF_API uint64_t sf_rng_next_u64(sf_rng *rng);
SF_API float sf_rng_next_f32(sf_rng *rng);
SF_API double sf_rng_next_f64(sf_rng *rng);

/* Words of which every bit is random, for algorithms that need them, such as NumPy's
 * distributions: of 31-bit methods the top 16 bits of two draws; of lcg32 and lcg64 with another
 * modulus the fractions that floats are made of. 64 bits from methods of 31 and 32 are two such
 * words, the first in the high half, as NumPy composes those of its MT19937. */
SF_API uint32_t sf_rng_next_full32(sf_rng *rng);
SF_API uint64_t sf_rng_next_full64(sf_rng *rng);

/* The functions of those names made for one kind, for callers that keep pointers to functions, as
 * NumPy's bitgen_t does; `rng` is a sf_rng of that kind. */
typedef struct sf_rng_callbacks {
    uint64_t (*next_full64)(void *rng);
    uint32_t (*next_full32)(void *rng);
    double (*next_f64)(void *rng);
    uint64_t (*next_raw)(void *rng);
} sf_rng_callbacks;
SF_API sf_rng_callbacks sf_rng_callbacks_of(sf_rng_kind kind);

/* Passes over `count` native draws, and drops a waiting half word. Takes O(log count) steps: about
 * a microsecond for methods that count or are congruential, 20 µs for xorshift64 and combined,
 * 300 µs for xoshiro256++, 8 ms for the Mersenne Twisters (which walk some 2^22 draws instead).
 * SF_STATUS_UNSUPPORTED, with `rng` unchanged, for ran1, ran2 (their tables depend on all draws
 * before) and sfc64 (no closed form is known). */
SF_API sf_status sf_rng_skip(sf_rng *rng, uint64_t count, sf_error *error);

/* Makes `count` independent generators of the parent's kind: child number k (counted over the
 * parent's life) has seed sf_hash64(h, 2 k) and stream sf_hash64(h, 2 k + 1) | 1 (within the
 * method's range), where h = sf_hash64(seed, stream) of the parent. The parent's own draws do
 * not move, so that children do not depend on how much it was used. */
SF_API void sf_rng_spawn(sf_rng *parent, size_t count, sf_rng *children);

/* The whole state as words: first the method's own, in the order of its struct, then
 * has_pending << 32 | pending, seed, stream, spawned. */
#define SF_RNG_STATE_MAX 1024
SF_API size_t sf_rng_state_size(sf_rng_kind kind); /* words, at most SF_RNG_STATE_MAX; 0 for an unknown kind */
SF_API void sf_rng_get_state(const sf_rng *rng, uint64_t *words);

/* Restores a state; a wrong count, or a state that the method cannot be in (all zero, out of
 * range), is refused and leaves `rng` as it was. */
SF_API sf_status sf_rng_set_state(sf_rng *rng, sf_rng_kind kind, const uint64_t *words, size_t count, sf_error *error);

#ifdef __cplusplus
}
#endif
#endif
