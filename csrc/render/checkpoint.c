// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A checkpoint is a table of fields, written and read: the options in checkpoint_identity.c, the round's
 * state and the columns of the pixels in checkpoint_fields.c, with what is allowed in each. */

#include "render/checkpoint.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/atomic_file.h"
#include "base/container.h"
#include "base/error.h"
#include "film/film_looks.h"
#include "film/mask.h"
#include "film/render_options.h"
#include "render/checkpoint_fields.h"
#include "render/checkpoint_identity.h"

#define TEXT_SIZE SF_CHECKPOINT_TEXT_SIZE

/* What the render has come to, for writing and for reading. */
static void list_progress(sf_array_list *list, const sf_checkpoint *c) {
    for (size_t i = 0; i < sf_checkpoint_field_count(); ++i)
        if (sf_checkpoint_field(c, i, list->arrays + list->count)) ++list->count;
}

sf_status sf_checkpoint_save(const sf_checkpoint *checkpoint, const char *path, sf_error *error) {
    sf_checkpoint c = *checkpoint;
    sf_array_list list = {.count = 0};
    sf_checkpoint_list_identity(&list, c.film);
    list_progress(&list, &c);
    return sf_container_write(path, list.arrays, list.count, error);
}

/* ---- a film that has ended ---- */

/* What only a film's own file has: a render does not go on from it. */
static void list_parts(sf_array_list *list, sf_film *film) {
    sf_array_list_add(list, "parts.seed", SF_ARRAY_U64, 1, film->part_count, &film->parts->seed, sizeof *film->parts);
    sf_array_list_add(list, "parts.crop", SF_ARRAY_U32, 4, film->part_count, film->parts->crop, sizeof *film->parts);
    sf_array_list_add(list, "untouched", SF_ARRAY_U8, 1, 1, &film->untouched, 1);
}

/* The state of a render in which no pixel is open any more. A second set has taken what the pilot had not. */
static sf_round_state ended_state(const sf_film *film) {
    const sf_film_summary *summary = &film->summary;
    uint64_t taken = 0;
    for (size_t i = 0; i < film->stored; ++i) taken += sf_film_taken(film->pixels + i);
    return (sf_round_state){.from = film->options.start,
                            .to = film->options.start,
                            .target = -1,
                            .rounds = summary->rounds,
                            .level_fixed = 1,
                            .level = summary->level,
                            .tolerance = summary->tolerance,
                            .seconds = summary->seconds,
                            .traced_samples = summary->traced_samples,
                            .second = film->options.unbiased && taken != summary->traced_samples};
}

sf_status sf_film_save(const sf_film *film, const char *path, sf_error *error) {
    sf_film *listed = (sf_film *)film; /* that is only read */
    uint64_t *none = calloc(sf_film_cell_count(film), sizeof *none);
    if (!none) return sf_fail_memory(error, "the list of cells", sf_film_cell_count(film) * sizeof *none);
    sf_checkpoint c = {.film = listed, .open = none, .active = none, .state = ended_state(film)};
    sf_array_list list = {.count = 0};
    sf_checkpoint_list_identity(&list, listed);
    list_parts(&list, listed);
    list_progress(&list, &c);
    sf_status status = sf_container_write(path, list.arrays, list.count, error);
    free(none);
    return status;
}

/* ---- reading ---- */

/* Fills the accumulators and the state, and refuses what no render writes: the file may be a forged one. */
static sf_status take_progress(const sf_container *file, sf_checkpoint *c, sf_error *error) {
    size_t cells = sf_film_cell_count(c->film);
    uint64_t *layout = malloc(cells * sizeof *layout); /* the pixels that there are */
    if (!layout) return sf_fail_memory(error, "the list of cells", cells * sizeof *layout);
    memcpy(layout, c->open, cells * sizeof *layout);
    sf_array_list list = {.count = 0};
    sf_status status = SF_STATUS_OK;
    list_progress(&list, c);
    for (size_t i = 0; !status && i < list.count; ++i) status = sf_container_take(file, list.arrays + i, error);
    if (!status) status = sf_checkpoint_check(c, layout, file->path, error);
    free(layout);
    return status;
}

/* Whether a file can be written there, before there is anything to write. */
static sf_status check_writable(const char *path, sf_error *error) {
    sf_atomic_file trial;
    sf_status status = sf_atomic_file_open(&trial, path, error);
    if (!status) sf_atomic_file_abandon(&trial);
    return status;
}

sf_status sf_checkpoint_restore(sf_checkpoint *c, const char *path, sf_resume *resume, sf_error *error) {
    sf_container file;
    bool more = false;
    *resume = SF_RESUME_NONE;
    if (access(path, F_OK) != 0 && errno == ENOENT) return check_writable(path, error);
    sf_status status = sf_container_open(&file, path, error);
    if (status) return status;
    uint64_t parts;
    sf_round_state state = {0};
    sf_array fixed = {"state.level_fixed", SF_ARRAY_U32, 1, 1, &state.level_fixed, 4};
    sf_array level = {"state.level", SF_ARRAY_F64, 1, 1, &state.level, 8};
    if (sf_container_find(&file, "parts.seed", SF_ARRAY_U64, 1, &parts))
        status = sf_fail(error, SF_STATUS_INVALID_VALUE,
                         "'%s' holds a picture that has ended, and no render that could go on", path);
    if (!status) status = sf_container_take(&file, &fixed, error);
    if (!status) status = sf_container_take(&file, &level, error);
    if (!status) status = sf_checkpoint_match(&file, c->film, &state, &more, error);
    if (!status) status = take_progress(&file, c, error);
    if (!status) status = check_writable(path, error);
    sf_container_close(&file);
    *resume = more ? SF_RESUME_EXTENDED : SF_RESUME_SAME;
    return status;
}

/* ---- a film without its render ---- */

/* The pixels of a cell that were still on their way have no decision of their own yet. */
static void mark_unfinished(sf_film *film, const uint64_t *open, bool second) {
    for (uint32_t y = 0; y < film->height; ++y)
        for (uint32_t x = 0; x < film->width; ++x) {
            if (!sf_film_is_in(film, open, x, y)) continue;
            sf_film_pixel *pixel = sf_film_at(film, x, y);
            pixel->half_width = second ? sf_film_half_width(pixel, sf_normal_factor(film->options.confidence))
                                       : sf_film_half_width_at(film, x, y);
            pixel->reason = pixel->moments.nonfinite ? SF_STOP_REASON_SUSPICIOUS : SF_STOP_REASON_INTERRUPTED;
        }
}

static void adopt_state(sf_film *film, const sf_round_state *state) {
    sf_film_summary *summary = &film->summary;
    summary->tolerance = state->tolerance > 0 ? state->tolerance : 0;
    summary->confidence = film->options.confidence;
    summary->rounds = state->rounds;
    summary->seconds = state->seconds;
    summary->traced_samples = state->traced_samples;
    summary->threads = film->options.threads;
    sf_film_resolve(film);
    summary->level = state->level_fixed ? state->level : sf_film_level(film);
}

static sf_isa find_isa(const char *name) {
    for (int isa = SF_ISA_BASELINE; isa <= SF_ISA_AVX512; ++isa)
        if (strcmp(name, sf_isa_name((sf_isa)isa)) == 0) return (sf_isa)isa;
    return SF_ISA_BASELINE;
}

/* Whether the file has the pixels that its options speak of: before memory is asked for them. */
static sf_status check_room(const sf_container *file, const sf_render_options *options, sf_error *error) {
    uint64_t rows, pixels = (uint64_t)(options->crop[2] - options->crop[0]) * (options->crop[3] - options->crop[1]);
    if (sf_container_find(file, "pixel.count", SF_ARRAY_U64, 1, &rows) && rows >= pixels) return SF_STATUS_OK;
    return sf_fail(error, SF_STATUS_IO, "checkpoint '%s' has fewer pixels than its crop, which has %" PRIu64,
                   file->path, pixels);
}

/* A film with room for what the file holds, and its identity. */
static sf_status make_film(const sf_container *file, sf_film **film, sf_error *error) {
    sf_render_options options;
    char isa[TEXT_SIZE];
    uint64_t mask;
    sf_status status = sf_checkpoint_take_options(file, &options, error);
    if (!status) status = check_room(file, &options, error);
    if (!status) status = sf_checkpoint_take_text(file, "instruction_set", isa, error);
    if (!status) status = sf_checkpoint_take_u64(file, "mask_hash", &mask, error);
    if (!status) status = sf_film_create(&options, mask != 0, film, error);
    if (status) return status;
    (*film)->isa = find_isa(isa);
    (*film)->mask_hash = mask;
    status = sf_checkpoint_take_u64(file, "scene_hash", &(*film)->scene_hash, error);
    if (!status) status = sf_checkpoint_take_u32(file, "embree_version", &(*film)->embree_version, error);
    if (status || !mask) return status;
    sf_array_list list = {.count = 0};
    sf_checkpoint_list_mask(&list, *film);
    status = sf_container_take(file, list.arrays, error);
    if (!status) status = sf_checkpoint_check_mask(*film, file->path, error);
    return status;
}

static bool is_ended(const sf_container *file, uint64_t *parts) {
    return sf_container_find(file, "parts.seed", SF_ARRAY_U64, 1, parts) && *parts > 0;
}

/* The parts of a film that has ended; a checkpoint has none. */
static sf_status take_parts(const sf_container *file, sf_film *film, sf_error *error) {
    uint64_t count;
    if (!is_ended(file, &count)) return SF_STATUS_OK;
    sf_film_part *parts = realloc(film->parts, (size_t)count * sizeof *parts);
    if (!parts) return sf_fail_memory(error, "the film's parts", (size_t)count * sizeof *parts);
    film->parts = parts;
    film->part_count = (size_t)count;
    sf_array_list list = {.count = 0};
    list_parts(&list, film);
    sf_status status = SF_STATUS_OK;
    for (size_t i = 0; !status && i < list.count; ++i) status = sf_container_take(file, list.arrays + i, error);
    if (status || film->untouched < SF_STOP_REASON_COUNT) return status;
    return sf_fail(error, SF_STATUS_IO, "checkpoint '%s' holds values that no render writes, in untouched", file->path);
}

/* Fills the film from the file, and draws the conclusions. */
static sf_status fill_film(const sf_container *file, sf_checkpoint *c, sf_error *error) {
    uint64_t parts;
    size_t cells = sf_film_cell_count(c->film);
    c->active = malloc(cells * sizeof *c->active);
    c->open = malloc(cells * sizeof *c->open);
    if (!c->active || !c->open) return sf_fail_memory(error, "the list of cells", cells * sizeof *c->active);
    memset(c->open, 0xff, cells * sizeof *c->open);
    sf_status status = take_parts(file, c->film, error);
    if (!status) status = take_progress(file, c, error);
    if (status) return status;
    c->film->summary.level = c->state.level; /* half-widths may refer to them */
    c->film->summary.tolerance = c->state.tolerance;
    mark_unfinished(c->film, c->open, c->state.second);
    bool pilot = c->film->options.unbiased && !c->state.second;
    if (pilot && !is_ended(file, &parts)) sf_film_mark_pilot(c->film);
    adopt_state(c->film, &c->state);
    return sf_film_describe(c->film, error);
}

static sf_status load_film(const sf_container *file, sf_film **out, sf_error *error) {
    sf_checkpoint c = {.film = NULL};
    sf_status status = make_film(file, &c.film, error);
    if (!status) status = fill_film(file, &c, error);
    free(c.active);
    free(c.open);
    if (status) sf_film_destroy(c.film);
    if (!status) *out = c.film;
    return status;
}

sf_status sf_film_load(const char *path, sf_film **film, sf_error *error) {
    sf_container file;
    *film = NULL;
    sf_status status = sf_container_open(&file, path, error);
    if (status) return status;
    status = load_film(&file, film, error);
    sf_container_close(&file);
    return status;
}
