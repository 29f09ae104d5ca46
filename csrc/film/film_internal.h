// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The film's accumulators, and what it becomes when the render ends. */
#ifndef SUNFLECK_FILM_INTERNAL_H
#define SUNFLECK_FILM_INTERNAL_H

#include <stdbool.h>

#include "film/pixel.h"
#include "sunfleck/film.h"

/* Pixels of a cell are numbered in Morton order: the even bits of m are x, the odd bits y, so that
 * 16 in a row are a 4 x 4 square. */
static inline uint32_t sf_cell_x(uint32_t m) { return (m & 1u) | (m >> 1 & 2u) | (m >> 2 & 4u); }
static inline uint32_t sf_cell_y(uint32_t m) { return sf_cell_x(m >> 1); }
static inline uint32_t sf_cell_number(uint32_t x, uint32_t y) {
    return (x & 1u) | (x & 2u) << 1 | (x & 4u) << 2 | (y & 1u) << 1 | (y & 2u) << 2 | (y & 4u) << 3;
}

/* What a row of the crop adds to the summary; rows are filled by any thread, and summed in order. */
typedef struct sf_film_row {
    uint64_t samples, nonfinite, reasons[SF_STOP_REASON_COUNT];
    double level; /* sum of (R+G+B)/3 */
    double half_width, worst, relmse;
    uint32_t worst_x;
} sf_film_row;

struct sf_aov_film;
struct sf_signed_pixel;

/* A render that went into the film: films that share a pixel and a seed share its samples. */
typedef struct sf_film_part {
    uint64_t seed;
    uint32_t crop[4];
} sf_film_part;

/* The cells that the crop touches, in pixels of the full frame, and what is kept of them. */
struct sf_film {
    uint32_t x0, y0, width, height; /* of the traced region */
    uint32_t cell_columns, cell_rows;
    size_t stored; /* accumulators: 64 for each cell, also where it is beyond the frame */
    uint32_t crop_x0, crop_y0, crop_width, crop_height;
    void *memory; /* that the arrays below lie in */
    size_t memory_bytes;
    sf_film_pixel *pixels; /* cell by cell, row by row in a cell: one that is sampled lies together */
    float *decay;          /* of variance, by pooling cell; see film_looks.h */
    sf_film_row *rows;     /* crop_height */
    float *color;          /* of the crop, 3 * crop_width * crop_height */
    float *alpha;
    float *half_width;
    uint32_t *samples;
    uint8_t *reason;
    struct sf_signed_pixel *signed_pixels; /* as the pixels; NULL unless the filter has negative lobes */
    double negative_part;                  /* of the filter; see signed_filter.h */
    struct sf_aov_film *aovs;              /* NULL where none was asked for */
    uint8_t *mask;                         /* of the crop: 1 where the pixel counts; NULL: all do */
    uint64_t counted;                      /* pixels of the crop that do */
    uint64_t mask_hash;
    uint8_t untouched;                    /* the sf_stop_reason of pixels without a sample */
    double factors[SF_DYADIC_LEVELS + 1]; /* standard errors in a half-width, see sf_stop_factor */
    double unseen;                        /* -log(1 - confidence); see film_looks.c */
    sf_attribute *attributes;
    size_t attribute_count;
    sf_film_summary summary;
    sf_render_options options; /* complete; without the caller's functions and paths */
    sf_film_part *parts;       /* one, more after a merge */
    size_t part_count;
    uint64_t scene_hash;
    uint32_t embree_version;
    sf_isa isa;
};

static inline size_t sf_film_cell_count(const sf_film *film) { return (size_t)film->cell_columns * film->cell_rows; }

/* Where the pixel (x, y) of the traced region is among the accumulators. */
static inline size_t sf_film_index(const sf_film *film, uint32_t x, uint32_t y) {
    size_t cell = (size_t)(y / SF_CELL_SIZE) * film->cell_columns + x / SF_CELL_SIZE;
    return (cell * SF_CELL_SIZE + y % SF_CELL_SIZE) * SF_CELL_SIZE + x % SF_CELL_SIZE;
}
static inline sf_film_pixel *sf_film_at(const sf_film *film, uint32_t x, uint32_t y) {
    return film->pixels + sf_film_index(film, x, y);
}
/* Whether the pixel (x, y) of the traced region is in a list of cells: bit m of one is its pixel m. */
static inline bool sf_film_is_in(const sf_film *film, const uint64_t *cells, uint32_t x, uint32_t y) {
    uint32_t bit = sf_cell_number(x % SF_CELL_SIZE, y % SF_CELL_SIZE);
    return cells[(size_t)(y / SF_CELL_SIZE) * film->cell_columns + x / SF_CELL_SIZE] >> bit & 1u;
}
/* The pixel (x, y) of the crop. */
static inline sf_film_pixel *sf_film_crop_at(const sf_film *film, uint32_t x, uint32_t y) {
    return sf_film_at(film, x + film->crop_x0 - film->x0, y + film->crop_y0 - film->y0);
}

/* What a render's own film is made of, for the checkpoint and for merging. */
sf_status sf_film_identify(sf_film *film, const sf_scene *scene, sf_isa isa, sf_error *error);

/* Marks the pixels of a pilot whose second set was not begun: their samples are those that decided. */
void sf_film_mark_pilot(sf_film *film);

/* `masked`: with room for a mask, which is the options' where they have one and else still to be filled. */
sf_status sf_film_create(const sf_render_options *options, bool masked, sf_film **film, sf_error *error);

/* Whether pixel (x, y) of the crop counts: the mask does not leave it out. */
static inline int sf_film_is_wanted(const sf_film *film, uint32_t x, uint32_t y) {
    return !film->mask || film->mask[(size_t)y * film->crop_width + x];
}

/* Sums (R+G+B)/3 over row y of the crop, for sf_film_level once all rows are. */
void sf_film_sum_row(sf_film *film, uint32_t y);

/* The mean of (R+G+B)/3 over the pixels of the crop that the mask leaves, summed in the order of
 * the rows. */
double sf_film_level(const sf_film *film);

/* Fills row y of the crop's arrays from the accumulators. */
void sf_film_resolve_row(sf_film *film, uint32_t y);

/* Fills the counts of the summary, once every row is resolved. */
void sf_film_summarize_rows(sf_film *film);

/* The three above for every row, on this thread: for films that no render made. */
void sf_film_resolve(sf_film *film);

/* Records the options as attributes; after sf_film_summarize_rows and with the summary complete. */
sf_status sf_film_describe(sf_film *film, sf_error *error);

#endif
