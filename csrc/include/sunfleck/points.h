// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* points: patterns, rules that place n points in [0,1)^d.
 *
 * A point is a pure function of (pattern, options, seed, index, dimension): any part of a
 * pattern can be made at any time, in any order, on any thread, with the same bits on every
 * instruction set. Every function is thread-safe unless it says otherwise.
 *
 * A coordinate is a 32-bit word; the float is its top 24 bits, never 1. The double's top 32
 * bits are that word too, and its further 21 bits continue it. Where a pattern has strata or
 * elementary intervals whose borders are not multiples of 2^-24, the word is rounded so that the
 * float still lies inside its own. (Of halton and hammersley, float and double are rounded each by
 * itself: the double is the exact fraction to 53 bits; the word is the float's, which may be 2^-24
 * above the double's top bits.)
 *
 * Messages call `dims` d, as formulas do.
 */
#ifndef SUNFLECK_POINTS_H
#define SUNFLECK_POINTS_H

#include "sunfleck/base.h"

#ifdef __cplusplus
extern "C" {
#endif

#include "sunfleck/exact_begin.h"

#define SF_SOBOL_MAX_DIMS 21201u /* Joe & Kuo's table */
#define SF_HALTON_MAX_DIMS 6542u /* the primes below 2^16; hammersley has one more */
#define SF_SZ_MAX_DIMS 4u        /* of one (0, 4)-sequence in base 4; pad makes more of them */
#define SF_ORTHOGONAL_MAX_DIMS 4097u
#define SF_LATTICE_MAX_DIMS 4391u /* of Kuo's generating vector */
#define SF_POINTS_MAX_DIMS 65536u /* of the patterns without a table */

typedef enum sf_pattern {
    SF_PATTERN_UNIFORM = 0,   /* centres of a regular grid; needs its total */
    SF_PATTERN_RANDOM,        /* independent points */
    SF_PATTERN_JITTERED,      /* a random point in each cell of a grid; needs its total */
    SF_PATTERN_LATIN,         /* latin hypercube: one point in each of n strata of each dimension;
                                 needs its total */
    SF_PATTERN_MULTIJITTERED, /* jittered and latin at once, correlated (Kensler 2013), for each
                                 pair of dimensions; needs its total */
    SF_PATTERN_ORTHOGONAL,    /* latin hypercube on an orthogonal array of strength 2: of n = q^2
                                 points, one in each of q x q cells of every two dimensions (Tang
                                 1993); needs its total */
    SF_PATTERN_HALTON,        /* radical inverses in the first d primes */
    SF_PATTERN_HAMMERSLEY,    /* i / n, and halton in the other dimensions; needs its total */
    SF_PATTERN_SOBOL,         /* Joe & Kuo's direction numbers, in the natural order of the index */
    SF_PATTERN_SZ,            /* (0, 2)-sequences in base 2 side by side; four dimensions a (0, 4)-sequence
                                 in base 4, sixteen (0, 16) in base 16 (after Ahmed et al. 2024) */
    SF_PATTERN_LATTICE,       /* rank-1 lattice in the order of the radical inverse in base 2, Kuo's
                                 generating vector for 2^10 .. 2^20 points (Cools, Kuo & Nuyens
                                 2006); beyond, it gets hardly better */
    SF_PATTERN_R2,            /* 1/2 + (i + 1) g^(d+1) modulo 1, 1 / g the generalized golden ratio of
                                 the dimensions (Roberts 2018): a point depends on `dims` */
    SF_PATTERN_COUNT
} sf_pattern;

/* How a deterministic pattern is randomized. */
typedef enum sf_scramble {
    SF_SCRAMBLE_DEFAULT = 0, /* owen for sobol and sz, permuted for halton, none for the others */
    SF_SCRAMBLE_NONE,        /* the plain pattern: the seed is not used (patterns that are random
                                by nature draw on it all the same) */
    SF_SCRAMBLE_PERMUTED,    /* halton, hammersley: each digit, to infinity, by a random permutation of its place;
                                hammersley's first dimension at a random place in its stratum */
    SF_SCRAMBLE_SHIFT,       /* one random word a dimension, XORed into every point's (sobol, sz) or
                                added to it modulo 1 (lattice, r2) */
    SF_SCRAMBLE_LMS,         /* sobol, sz: a random lower triangular matrix a dimension, and a shift
                                (Matousek 1998) */
    SF_SCRAMBLE_OWEN,        /* sobol, sz: nested uniform scrambling by a hash (Burley 2020, with
                                Vegdahl's 2021 constants); halton, hammersley: each digit by a
                                permutation that depends on all before it (Owen 2017), exact in
                                the law of pairs */
    SF_SCRAMBLE_NESTED,      /* sobol, sz: nested uniform scrambling (Owen 1995), 64-bit keys */
    SF_SCRAMBLE_COUNT
} sf_scramble;

/* The names "uniform", "owen", … and a line about each; NULL beyond the last, so that they can
 * be listed. SF_SCRAMBLE_DEFAULT is called "default". */
SF_API const char *sf_pattern_name(sf_pattern pattern);
SF_API const char *sf_pattern_description(sf_pattern pattern);
SF_API const char *sf_scramble_name(sf_scramble scramble);
SF_API const char *sf_scramble_description(sf_scramble scramble);

/* The value called `name`; the error lists the names. */
SF_API sf_status sf_pattern_find(const char *name, sf_pattern *pattern, sf_error *error);
SF_API sf_status sf_scramble_find(const char *name, sf_scramble *scramble, sf_error *error);

/* What a pattern can do: the largest dims and index + 1, whether it needs its total ahead, the
 * scramble that SF_SCRAMBLE_DEFAULT stands for, and whether it takes the one asked about. */
SF_API uint32_t sf_pattern_max_dims(sf_pattern pattern);
SF_API uint64_t sf_pattern_max_count(sf_pattern pattern); /* UINT64_MAX: no limit but the index's type */
SF_API int sf_pattern_needs_total(sf_pattern pattern);
SF_API sf_scramble sf_pattern_default_scramble(sf_pattern pattern);
/* The scramble for one who wants a random set whatever the pattern: the default where that uses the
 * seed, else the first that the pattern takes: shift for lattice and r2, permuted for hammersley;
 * SF_SCRAMBLE_NONE where there is none, of patterns that are random by nature and of uniform. */
SF_API sf_scramble sf_pattern_random_scramble(sf_pattern pattern);
/* Whether the pattern without a scramble still depends on the seed. */
SF_API int sf_pattern_is_random(sf_pattern pattern);
SF_API int sf_pattern_takes_scramble(sf_pattern pattern, sf_scramble scramble);

/* The nearest counts that the pattern takes at or below n and at or above it; 0 where there is
 * none. Both are n where n itself is valid, as it always is for patterns that need no total.
 * uniform and jittered take the product of `dims` integers of which the largest is at most
 * twice the smallest, up to 2^32: ("jittered", 2, 997) gives 992 = 32 x 31 and 999 = 37 x 27.
 * multijittered takes such products of two integers up to 2^24, whatever the dimensions;
 * orthogonal q^2, q a prime or a power of two, dims - 1 .. 4096; latin and hammersley any from 1. */
SF_API sf_status sf_pattern_valid_counts(sf_pattern pattern, uint32_t dims, uint64_t n, uint64_t *below,
                                         uint64_t *above, sf_error *error);

/* The sides of the grid that uniform and jittered use for n cells: dims integers with product n,
 * none above twice the least, the most even such, in falling order. Refuses another n, naming
 * the nearest valid counts. */
SF_API sf_status sf_grid_sides(uint64_t n, uint32_t dims, uint32_t *sides, sf_error *error);

/* Threads that stay between fills, for arrays so small that to start threads takes as long as to
 * fill them. A team is empty at first and grows as fills ask; its threads sleep when there has
 * been no work for 50 µs. Not across fork. Safe to share: a fill that finds the team at work for
 * another starts threads of its own. Destroy it when no fill uses it; NULL is legal. */
typedef struct sf_thread_team sf_thread_team;
#define SF_THREAD_TEAM_MAX 255u /* threads */

SF_API sf_status sf_thread_team_create(sf_thread_team **team, sf_error *error);
SF_API void sf_thread_team_destroy(sf_thread_team *team);

typedef struct sf_points_options {
    sf_pattern pattern;   /* default sobol */
    sf_scramble scramble; /* default SF_SCRAMBLE_DEFAULT: the pattern's own */
    uint32_t dims;        /* 1 .. sf_pattern_max_dims (more with pad); default 2 */
    uint32_t pad;         /* 2 or 4: dimension d is dimension d % pad of a set of its own, for any
                             dims up to SF_POINTS_MAX_DIMS; sobol and sz, scramble owen or nested.
                             Set 0 is as without padding, the others have shuffled indices (Burley
                             2020). 0 (default): none */
    uint64_t seed;        /* any; default 0 */
    uint64_t first;       /* index of the first point; first + count at most sf_pattern_max_count;
                             default 0 */
    uint64_t total;       /* how many points there will be, for patterns that need to know: first +
                             count at most total; 0 (default): first + count */
    uint32_t threads;     /* 1 (default) ..; 0: one for each processor. Changes no bit */
    sf_thread_team *team; /* where they come from; NULL (default): started for the call */
} sf_points_options;

SF_API sf_points_options sf_points_options_default(void);

/* Fills `out` with points first .. first + count - 1.
 *
 * out     count * dims values, row-major. f32: in [0,1), 24 bits; f64: in [0,1), 53 bits; u32:
 *         the 32-bit words. count = 0 is allowed and touches nothing
 *
 * Refuses bad options with a message before any work. */
SF_API sf_status sf_points_fill_f32(const sf_points_options *options, size_t count, float *out, sf_error *error);
SF_API sf_status sf_points_fill_f64(const sf_points_options *options, size_t count, double *out, sf_error *error);
SF_API sf_status sf_points_fill_u32(const sf_points_options *options, size_t count, uint32_t *out, sf_error *error);

/* A pattern with its tables made, for those who ask for a few points at a time: sf_points_fill_…
 * makes them anew each call, 6 ms for 21,201 dimensions of Sobol, of which a point then takes
 * 0.04 ms. `first` of the options is not used. Immutable once made, so that threads may share it. */
typedef struct sf_point_set sf_point_set;

SF_API sf_status sf_point_set_create(const sf_points_options *options, sf_point_set **set, sf_error *error);
SF_API void sf_point_set_destroy(sf_point_set *set); /* NULL is legal */

/* As sf_points_fill_…, from index `first`. A pattern that needs its total must have been given it. */
SF_API sf_status sf_point_set_fill_f32(const sf_point_set *set, uint64_t first, size_t count, float *out,
                                       sf_error *error);
SF_API sf_status sf_point_set_fill_f64(const sf_point_set *set, uint64_t first, size_t count, double *out,
                                       sf_error *error);
SF_API sf_status sf_point_set_fill_u32(const sf_point_set *set, uint64_t first, size_t count, uint32_t *out,
                                       sf_error *error);

/* Fills one after another, with what is worth keeping between them: threads that sleep meanwhile (a team, made
 * when a fill first asks for more than one), and the tables of the last pattern, which for a few dimensions cost
 * as much as 2^16 values; those of more than 256 dimensions, or of a pattern that needs its total, are not kept.
 * Thread-safe: fills may run at once, and one that finds the team at work starts threads of its own, one that
 * finds the tables taken makes its own. Safe across fork where the parent was in no call of create or
 * destroy: the child makes a team anew, and what the parent's took stays allocated. Destroy it when no fill uses it;
 * NULL is legal. */
typedef struct sf_point_filler sf_point_filler;

SF_API sf_status sf_point_filler_create(sf_point_filler **filler, sf_error *error);
SF_API void sf_point_filler_destroy(sf_point_filler *filler);

/* As sf_points_fill_… of the same options, bit for bit, with options->threads threads of the filler's team, or of
 * options->team where that is given. Where `interrupt` says stop, some of `out` has been written. */
SF_API sf_status sf_point_filler_fill_f32(sf_point_filler *filler, const sf_points_options *options, size_t count,
                                          float *out, const sf_interrupt *interrupt, sf_error *error);
SF_API sf_status sf_point_filler_fill_f64(sf_point_filler *filler, const sf_points_options *options, size_t count,
                                          double *out, const sf_interrupt *interrupt, sf_error *error);
SF_API sf_status sf_point_filler_fill_u32(sf_point_filler *filler, const sf_points_options *options, size_t count,
                                          uint32_t *out, const sf_interrupt *interrupt, sf_error *error);

/* ---- one coordinate at a time ----
 *
 * Each equals the fill with the default scramble and the same seed. The preconditions are
 * asserted. */

SF_API float sf_random_sample(uint64_t index, uint32_t dimension, uint64_t seed);

/* `sides` as sf_grid_sides gives them, index below their product, dimension < dims. */
SF_API float sf_uniform_sample(uint64_t index, uint32_t dimension, uint32_t dims, const uint32_t *sides);
SF_API float sf_jittered_sample(uint64_t index, uint32_t dimension, uint64_t seed, uint32_t dims,
                                const uint32_t *sides);

/* total 1 .. 2^32, index < total. */
SF_API float sf_latin_sample(uint64_t index, uint32_t dimension, uint64_t seed, uint64_t total);

/* `sides` as sf_grid_sides gives them for two dimensions, their product at most 2^24, index below it. */
SF_API float sf_multijittered_sample(uint64_t index, uint32_t dimension, uint64_t seed, const uint32_t sides[2]);

/* levels a prime or a power of two, 2 .. 4096; index < levels^2; dimension <= levels. */
SF_API float sf_orthogonal_sample(uint64_t index, uint32_t dimension, uint64_t seed, uint32_t levels);

SF_API float sf_halton_sample(uint64_t index, uint32_t dimension, uint64_t seed); /* dimension < SF_HALTON_MAX_DIMS */
SF_API float sf_halton_owen_sample(uint64_t index, uint32_t dimension, uint64_t seed); /* the fill with that scramble */

/* total 1 .. 2^32, index < total, dimension <= SF_HALTON_MAX_DIMS. */
SF_API float sf_hammersley_sample(uint64_t index, uint32_t dimension, uint64_t total);

/* dimension < SF_LATTICE_MAX_DIMS. */
SF_API float sf_lattice_sample(uint64_t index, uint32_t dimension);
SF_API float sf_lattice_shifted_sample(uint64_t index, uint32_t dimension, uint64_t seed); /* the fill with shift */

/* increments[d] of a point's dims: the (d + 1)-th power of g, the root of g^dims + g^(dims + 1) = 1,
 * as a fraction of 2^64, correctly rounded but for ties nearer than 2^-100. Some 0.1 ms. */
SF_API void sf_r2_increments(uint32_t dims, uint64_t *increments);

/* increment: sf_r2_increments' of the dimension. */
SF_API float sf_r2_sample(uint64_t index, uint64_t increment);
SF_API float sf_r2_shifted_sample(uint64_t index, uint32_t dimension, uint64_t seed, uint64_t increment);

SF_API float sf_sobol_sample(uint32_t index, uint32_t dimension, uint64_t seed); /* dimension < SF_SOBOL_MAX_DIMS */
SF_API float sf_sz_sample(uint32_t index, uint32_t dimension, uint64_t seed);    /* dimension < SF_SZ_MAX_DIMS */

/* The same with a scramble (default, none, shift, lms, owen, nested) and a pad (0, 2, 4) of one's
 * own: any dimension where pad is not 0, which then takes the default, owen or nested. */
SF_API float sf_sobol_sample_with(uint32_t index, uint32_t dimension, uint64_t seed, sf_scramble scramble,
                                  uint32_t pad);
SF_API float sf_sz_sample_with(uint32_t index, uint32_t dimension, uint64_t seed, sf_scramble scramble, uint32_t pad);

/* The 32-bit words of the unscrambled sequences. */
SF_API uint32_t sf_sobol_bits(uint32_t index, uint32_t dimension);
SF_API uint32_t sf_sz_bits(uint32_t index, uint32_t dimension);
SF_API uint32_t sf_halton_bits(uint64_t index, uint32_t dimension);
SF_API uint64_t sf_lattice_bits(uint64_t index, uint32_t dimension); /* of 64 bits, exact */

/* What "shift" adds to lattice and r2, as a fraction of 2^64; r2 then begins at 0, not at 1/2. */
SF_API uint64_t sf_shift_bits(uint64_t seed, uint32_t dimension);

/* A coordinate's 64 bits, for sf_float_from_bits of the upper 32 and sf_double_from_bits: `word` of
 * an unscrambled net in base 2, scrambled as a dimension of sobol or sz is. The bits below 32
 * continue each scramble: a shift's own, further rows of the random matrix, further flips. */
SF_API uint64_t sf_scramble_word(uint32_t word, uint32_t dimension, uint64_t seed, sf_scramble scramble);

/* The index that a padded set has in the place of `index`: its own for set 0. */
SF_API uint32_t sf_padded_index(uint32_t index, uint32_t set, uint64_t seed, sf_scramble scramble);

/* ---- the parts, for kernels of one's own ---- */

/* The 32 direction numbers of a dimension: column k is what bit k of the index XORs into the
 * point, as a fraction of 2^32 (column 0 is 2^31 in every dimension). */
SF_API void sf_sobol_matrix(uint32_t dimension, uint32_t columns[32]);
SF_API void sf_sz_matrix(uint32_t dimension, uint32_t columns[32]);

/* The key with which a dimension of a pattern of that seed is scrambled. */
static inline uint32_t sf_owen_seed(uint64_t seed, uint32_t dimension) {
    return (uint32_t)(sf_hash64(seed, dimension) >> 32);
}

/* Owen's nested uniform scrambling of a word given and returned with its bits reversed: a bit is
 * flipped by a hash of the seed and the bits below it. Vegdahl 2021, "Building a Better LK Hash":
 * x ^= x * even and x * odd carry only upwards, so that the map is nested. */
static inline uint32_t sf_owen_hash32(uint32_t reversed, uint32_t seed) {
    reversed ^= reversed * 0x3d20adeau;
    reversed += seed;
    reversed *= seed >> 16 | 1u;
    reversed ^= reversed * 0x05526c56u;
    reversed ^= reversed * 0x53a22864u;
    return reversed;
}

/* The same of a word in its usual order. Also shuffles an index: every aligned block of 2^k
 * indices maps onto an aligned block of 2^k (Burley 2020, "Practical Hash-based Owen
 * Scrambling"). */
static inline uint32_t sf_owen_scramble32(uint32_t word, uint32_t seed) {
    return sf_reverse_bits32(sf_owen_hash32(sf_reverse_bits32(word), seed));
}

#include "sunfleck/exact_end.h"

#ifdef __cplusplus
}
#endif
#endif
