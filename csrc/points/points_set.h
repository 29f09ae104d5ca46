// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What points.c and the patterns' own files share. */
#ifndef SUNFLECK_POINTS_SET_H
#define SUNFLECK_POINTS_SET_H

#include "points/net_kernels.h"
#include "points/points_kernels.h"
#include "sunfleck/points.h"

/* How many words a thread makes at a time, of 4 bytes: half of a 32 KiB first cache. */
enum { SF_POINTS_CHUNK_WORDS = 4096 };

/* Words that it takes a thread of a team to be worth waking. */
#define SF_TEAM_LEAST_WORDS ((size_t)1 << 15)

/* Words of a thread's state for each dimension. */
enum { SF_POINTS_STATE_WORDS = 10 };

typedef struct sf_pattern_method sf_pattern_method;
typedef struct sf_halton_tables sf_halton_tables; /* one for each dimension */
typedef struct sf_pad_tables sf_pad_tables;

struct sf_point_set {
    const sf_pattern_method *method;
    sf_points_options options; /* with the default scramble resolved */
    uint32_t *sides;           /* uniform, jittered: of the grid; NULL where the total is not given */
    sf_net_tables *net;
    sf_pad_tables *padded; /* where options.pad is set, instead of `net` */
    sf_halton_tables *halton;
    void *block; /* the tables of the other patterns, one allocation; NULL: none */
};

/* A thread's place in a set: scratch that one call of a pattern's `make` leaves for the next. */
typedef struct sf_points_cursor {
    const sf_point_set *set;
    const sf_points_kernels *kernels;
    uint32_t *state; /* nets: the high part of the block at `next`; halton: a place in each
                        dimension; jittered: cells; orthogonal: runs */
    uint64_t next;   /* index for which `state` holds; UINT64_MAX: none */
    const sf_net_kernels *net_kernels;
} sf_points_cursor;

/* What points.c knows of a pattern. */
struct sf_pattern_method {
    const char *name, *description;
    uint32_t max_dims;
    uint64_t max_count;
    int needs_total;
    sf_scramble default_scramble;
    unsigned scrambles; /* bit s: takes scramble s */
    /* Makes the tables; NULL: there are none. */
    sf_status (*prepare)(sf_point_set *set, sf_error *error);
    /* Words of `rows` points from `first`, row-major; low words too unless `low` is NULL. */
    void (*make)(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low);
};

/* points.c: whether the pattern has so many dimensions, and points first .. first + count - 1. */
sf_status sf_points_check_pattern(sf_pattern pattern, uint32_t dims, sf_error *error);
sf_status sf_points_check_dims(const sf_points_options *options, sf_error *error); /* with `pad` */
sf_status sf_points_check_range(const sf_points_options *options, uint64_t first, uint64_t count, sf_error *error);
/* Checks both for a fill of `count` points, whose number is the total where the pattern needs one and none is given. */
sf_status sf_points_complete(sf_points_options *options, uint64_t count, sf_error *error);

/* points.c: checks all options and makes the tables; frees what a set holds, not the set. */
sf_status sf_point_set_init(sf_point_set *set, const sf_points_options *options, sf_error *error);
void sf_point_set_release(sf_point_set *set);

/* points_fill.c: fills from `first` with up to `threads` threads (0: one for each processor) of the team, or
 * started for the call where it is NULL, whatever the set's own options say; a part of an array of `whole` rows, whose
 * size decides whether it is written past the caches. */
sf_status sf_point_set_fill(const sf_point_set *set, uint32_t threads, sf_thread_team *team, uint64_t first,
                            size_t count, size_t whole, sf_number_type type, void *out, sf_error *error);

/* net.c: sobol and sz. `rows` writes numbers of a type, `make` words with nested scrambling. */
sf_status sf_net_prepare(sf_point_set *set, sf_error *error);
void sf_net_release(sf_net_tables *tables);
void sf_net_rows(sf_points_cursor *cursor, uint64_t first, size_t rows, sf_number_type type, int streams, void *out);
void sf_net_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low);

/* points_pad.c: sobol and sz with `pad`. */
sf_status sf_pad_prepare(sf_point_set *set, sf_error *error);
void sf_pad_release(sf_pad_tables *tables);
void sf_pad_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low);

/* The key by which a padded set shuffles the index; words from 2^32 on are no dimension's. */
static inline uint64_t sf_padded_key(uint64_t seed, uint32_t set) { return sf_hash64(seed, UINT64_C(1) << 32 | set); }

/* halton_fill.c */
sf_status sf_halton_prepare(sf_point_set *set, sf_error *error);
void sf_halton_release(sf_halton_tables *tables, uint32_t dims);
void sf_halton_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low);

sf_status sf_hammersley_prepare(sf_point_set *set, sf_error *error);
void sf_hammersley_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low);

/* points_latin.c */
sf_status sf_latin_prepare(sf_point_set *set, sf_error *error);
void sf_latin_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low);

/* points_multijittered.c */
sf_status sf_multijittered_valid_counts(uint64_t n, uint64_t *below, uint64_t *above);
sf_status sf_multijittered_prepare(sf_point_set *set, sf_error *error);
void sf_multijittered_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low);

/* points_orthogonal.c */
sf_status sf_orthogonal_valid_counts(uint64_t n, uint32_t dims, uint64_t *below, uint64_t *above);
sf_status sf_orthogonal_prepare(sf_point_set *set, sf_error *error);
void sf_orthogonal_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low);

/* points_lattice.c */
sf_status sf_lattice_prepare(sf_point_set *set, sf_error *error);
void sf_lattice_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low);
sf_status sf_r2_prepare(sf_point_set *set, sf_error *error);
void sf_r2_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low);

/* points_grid.c */
sf_status sf_grid_valid_counts(uint64_t n, uint32_t dims, uint64_t *below, uint64_t *above);
sf_status sf_grid_prepare(sf_point_set *set, sf_error *error);
void sf_uniform_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low);
void sf_jittered_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low);
void sf_random_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low);

#endif
