// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A checkpoint is a table of fields. The options are in the table below, which is written, compared and
 * read; the round's state and the columns of the pixels are in checkpoint_fields.c, with what is
 * allowed in each. A new field is one more line. */

#include "checkpoint.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "checkpoint_fields.h"
#include "container.h"
#include "error.h"
#include "mask.h"
#include "render_options.h"
#include "replacement.h"
#include "stopping.h"

#define TEXT_SIZE 96
#define MAX_ARRAYS 112 /* in a list */

/* ---- the tables ---- */

/* How an option of a render may differ from the checkpoint's. */
typedef enum rule {
    EQUAL,     /* not at all */
    LARGER,    /* larger is more of the same */
    TOLERANCE, /* the tolerance that results may be smaller */
    FREE       /* decides no bit of the picture */
} rule;

/* An option: a value, several, or a name that stands for an enumeration's. */
typedef struct option_field {
    const char *name; /* in the file; without "option." in messages */
    size_t offset;
    sf_array_type type;
    uint32_t width;
    rule rule;
    const char *(*name_of)(int); /* type SF_ARRAY_TEXT only */
} option_field;

static const char *name_pattern(int value) { return sf_pattern_name((sf_pattern)value); }
static const char *name_filter(int value) { return sf_pixel_filter_name((sf_pixel_filter)value); }
static const char *name_stop(int value) { return sf_stop_rule_name((sf_stop_rule)value); }
static const char *name_seeds(int value) { return sf_seed_policy_name((sf_seed_policy)value); }

#define OPTION(field, type, width, rule) {"option." #field, offsetof(sf_render_options, field), type, width, rule, NULL}
#define OPTION_NAME(field, name_of) \
    {"option." #field, offsetof(sf_render_options, field), SF_ARRAY_TEXT, 1, EQUAL, name_of}

static const option_field option_fields[] = {
    OPTION(width, SF_ARRAY_U32, 1, EQUAL),
    OPTION(height, SF_ARRAY_U32, 1, EQUAL),
    OPTION(crop, SF_ARRAY_U32, 4, EQUAL),
    OPTION(spp, SF_ARRAY_U32, 1, LARGER),
    OPTION(start, SF_ARRAY_U32, 1, EQUAL),
    OPTION(relative_tolerance, SF_ARRAY_F64, 1, TOLERANCE),
    OPTION(absolute_tolerance, SF_ARRAY_F64, 1, TOLERANCE),
    OPTION(relmse, SF_ARRAY_F64, 1, TOLERANCE),
    OPTION(confidence, SF_ARRAY_F64, 1, EQUAL),
    OPTION(min_spp, SF_ARRAY_U32, 1, EQUAL),
    OPTION(max_spp, SF_ARRAY_U32, 1, LARGER),
    OPTION(samples, SF_ARRAY_U64, 1, LARGER),
    OPTION(aovs, SF_ARRAY_U32, 1, EQUAL),
    OPTION(seconds, SF_ARRAY_F64, 1, FREE),
    OPTION_NAME(pattern, name_pattern),
    OPTION_NAME(pixel_filter, name_filter),
    OPTION_NAME(stop, name_stop),
    OPTION(unbiased, SF_ARRAY_U32, 1, EQUAL),
    OPTION_NAME(seeds, name_seeds),
    OPTION(seed, SF_ARRAY_U64, 1, EQUAL),
    OPTION(threads, SF_ARRAY_U32, 1, FREE),
    OPTION(tile_size, SF_ARRAY_U32, 1, FREE),
    OPTION(roulette, SF_ARRAY_U32, 1, EQUAL),
};

#define OPTION_COUNT (sizeof option_fields / sizeof *option_fields)

/* ---- arrays of a checkpoint ---- */

typedef struct array_list {
    sf_array arrays[MAX_ARRAYS];
    size_t count;
} array_list;

static void list_array(array_list *list, const char *name, sf_array_type type, uint32_t width, uint64_t rows,
                       void *data, size_t stride) {
    list->arrays[list->count++] = (sf_array){name, type, width, rows, data, stride};
}

static void list_text(array_list *list, const char *name, const char *text) {
    list_array(list, name, SF_ARRAY_TEXT, 1, strlen(text), (void *)text, 1); /* that is only read */
}

static size_t option_size(const option_field *field) {
    return field->type == SF_ARRAY_U32 ? 4 * field->width : 8 * field->width;
}

static int enumeration_value(const option_field *field, const sf_render_options *options) {
    int value;
    memcpy(&value, (const char *)options + field->offset, sizeof value);
    return value;
}

static void list_mask(array_list *list, sf_film *film) {
    list_array(list, "mask", SF_ARRAY_U8, 1, (uint64_t)film->crop_width * film->crop_height, film->mask, 1);
}

/* What identifies the picture, for writing. */
static void list_identity(array_list *list, sf_film *film) {
    list_text(list, "version", sf_version());
    list_text(list, "instruction_set", sf_isa_name(film->isa));
    list_array(list, "embree_version", SF_ARRAY_U32, 1, 1, &film->embree_version, 4);
    list_array(list, "scene_hash", SF_ARRAY_U64, 1, 1, &film->scene_hash, 8);
    list_array(list, "mask_hash", SF_ARRAY_U64, 1, 1, &film->mask_hash, 8);
    if (film->mask) list_mask(list, film);
    for (size_t i = 0; i < OPTION_COUNT; ++i) {
        const option_field *f = option_fields + i;
        if (f->name_of)
            list_text(list, f->name, f->name_of(enumeration_value(f, &film->options)));
        else
            list_array(list, f->name, f->type, f->width, 1, (char *)&film->options + f->offset, option_size(f));
    }
}

/* What the render has come to, for writing and for reading. */
static void list_progress(array_list *list, const sf_checkpoint *c) {
    for (size_t i = 0; i < sf_checkpoint_field_count(); ++i)
        if (sf_checkpoint_field(c, i, list->arrays + list->count)) ++list->count;
}

sf_status sf_checkpoint_save(const sf_checkpoint *checkpoint, const char *path, sf_error *error) {
    sf_checkpoint c = *checkpoint;
    array_list list = {.count = 0};
    list_identity(&list, c.film);
    list_progress(&list, &c);
    return sf_container_write(path, list.arrays, list.count, error);
}

/* ---- reading ---- */

static sf_status take_text(const sf_container *file, const char *name, char text[TEXT_SIZE], sf_error *error) {
    uint64_t length;
    if (!sf_container_find(file, name, SF_ARRAY_TEXT, 1, &length) || length >= TEXT_SIZE)
        return sf_fail(error, SF_STATUS_IO, "checkpoint '%s' has no %s", file->path, name);
    sf_array array = {name, SF_ARRAY_TEXT, 1, length, text, 1};
    text[length] = 0;
    return sf_container_take(file, &array, error);
}

/* The enumeration's value of that name. */
static sf_status find_name(const sf_container *file, const option_field *field, sf_render_options *options,
                           sf_error *error) {
    char text[TEXT_SIZE];
    sf_status status = take_text(file, field->name, text, error);
    if (status) return status;
    for (int value = 0; field->name_of(value); ++value) {
        if (strcmp(field->name_of(value), text) != 0) continue;
        memcpy((char *)options + field->offset, &value, sizeof value);
        return SF_STATUS_OK;
    }
    return sf_fail(error, SF_STATUS_IO, "checkpoint '%s' has %s '%s', which this Sunfleck does not know", file->path,
                   field->name, text);
}

static sf_status take_options(const sf_container *file, sf_render_options *options, sf_error *error) {
    *options = sf_render_options_default();
    for (size_t i = 0; i < OPTION_COUNT; ++i) {
        const option_field *f = option_fields + i;
        sf_array array = {f->name, f->type, f->width, 1, (char *)options + f->offset, option_size(f)};
        sf_status status = f->name_of ? find_name(file, f, options, error) : sf_container_take(file, &array, error);
        if (status) return status;
    }
    sf_error problem;
    sf_status status = sf_render_options_complete(options, &problem);
    if (!status) return status;
    return sf_fail(error, SF_STATUS_IO, "checkpoint '%s' holds an option that no render has: %s", file->path,
                   problem.message);
}

static sf_status take_u64(const sf_container *file, const char *name, uint64_t *value, sf_error *error) {
    sf_array array = {name, SF_ARRAY_U64, 1, 1, value, sizeof *value};
    return sf_container_take(file, &array, error);
}
static sf_status take_u32(const sf_container *file, const char *name, uint32_t *value, sf_error *error) {
    sf_array array = {name, SF_ARRAY_U32, 1, 1, value, sizeof *value};
    return sf_container_take(file, &array, error);
}

/* Fills the accumulators and the state, and refuses what no render writes: the file may be a forged one. */
static sf_status take_progress(const sf_container *file, sf_checkpoint *c, sf_error *error) {
    size_t cells = sf_film_cell_count(c->film);
    uint64_t *layout = malloc(cells * sizeof *layout); /* the pixels that there are */
    if (!layout) return sf_fail_memory(error, "the list of cells", cells * sizeof *layout);
    memcpy(layout, c->open, cells * sizeof *layout);
    array_list list = {.count = 0};
    sf_status status = SF_STATUS_OK;
    list_progress(&list, c);
    for (size_t i = 0; !status && i < list.count; ++i) status = sf_container_take(file, list.arrays + i, error);
    if (!status) status = sf_checkpoint_check(c, layout, file->path, error);
    free(layout);
    return status;
}

/* ---- matching ---- */

/* What differs, as two lists: "seed 1, pattern sobol" and "seed 2, pattern random". */
typedef struct differences {
    char theirs[176], ours[176];
    bool limits; /* among them one that may differ, but not this way */
    bool more;   /* more is asked for than the file has */
} differences;

static void append(char list[176], const char *name, const char *text) {
    size_t used = strlen(list);
    snprintf(list + used, 176 - used, "%s%s %s", used ? ", " : "", name, text);
}

static void add_difference(differences *d, const char *name, const char *theirs, const char *ours) {
    append(d->theirs, name, theirs);
    append(d->ours, name, ours);
}

/* The shortest of two that reads back as the same number. */
static void print_number(char text[TEXT_SIZE], double value) {
    snprintf(text, TEXT_SIZE, "%.15g", value);
    if (strtod(text, NULL) != value) snprintf(text, TEXT_SIZE, "%.17g", value);
}

static double option_number(const option_field *field, const sf_render_options *options) {
    const char *at = (const char *)options + field->offset;
    if (field->type == SF_ARRAY_F64) return *(const double *)at;
    if (field->type == SF_ARRAY_U64) return (double)*(const uint64_t *)at;
    return *(const uint32_t *)at;
}

static void print_option(char text[TEXT_SIZE], const option_field *field, const sf_render_options *options) {
    const char *at = (const char *)options + field->offset;
    const uint32_t *four = (const uint32_t *)at;
    if (field->name_of)
        snprintf(text, TEXT_SIZE, "%s", field->name_of(enumeration_value(field, options)));
    else if (field->width == 4)
        snprintf(text, TEXT_SIZE, "(%" PRIu32 ", %" PRIu32 ", %" PRIu32 ", %" PRIu32 ")", four[0], four[1], four[2],
                 four[3]);
    else if (field->type == SF_ARRAY_U64)
        snprintf(text, TEXT_SIZE, "%" PRIu64, *(const uint64_t *)at);
    else
        print_number(text, option_number(field, options));
}

/* Whether our tolerance is at most theirs; before the level is known no decision has used it. */
static bool tolerance_allows(const sf_render_options *theirs, const sf_render_options *ours,
                             const sf_round_state *state) {
    if (sf_has_tolerance(theirs) != sf_has_tolerance(ours) || (theirs->relmse > 0) != (ours->relmse > 0)) return false;
    if (ours->relmse > theirs->relmse) return false;
    double level = state->level;
    return !state->level_fixed || fmax(ours->absolute_tolerance, ours->relative_tolerance * level) <=
                                      fmax(theirs->absolute_tolerance, theirs->relative_tolerance * level);
}

/* A larger count; but a fixed count is not a larger open one. */
static bool count_allows(const option_field *field, const sf_render_options *theirs, const sf_render_options *ours) {
    double a = option_number(field, theirs), b = option_number(field, ours);
    return b > a && a > 0;
}

static void compare_option(differences *d, const option_field *field, const sf_render_options *theirs,
                           const sf_render_options *ours, const sf_round_state *state) {
    size_t size = field->name_of ? sizeof(int) : option_size(field);
    if (field->rule == FREE || !memcmp((const char *)theirs + field->offset, (const char *)ours + field->offset, size))
        return;
    if (field->offset == offsetof(sf_render_options, samples) && count_allows(field, theirs, ours)) return;
    if ((field->rule == LARGER && count_allows(field, theirs, ours)) ||
        (field->rule == TOLERANCE && tolerance_allows(theirs, ours, state))) {
        d->more = true;
        return;
    }
    char their_text[TEXT_SIZE], our_text[TEXT_SIZE];
    print_option(their_text, field, theirs);
    print_option(our_text, field, ours);
    add_difference(d, field->name + strlen("option."), their_text, our_text);
    d->limits |= field->rule != EQUAL;
}

/* "none", or the hash. */
static void print_mask(char text[TEXT_SIZE], uint64_t hash) {
    snprintf(text, TEXT_SIZE, hash ? "%016" PRIx64 : "none", hash);
}

static sf_status compare_identity(differences *d, const sf_container *file, const sf_film *film, sf_error *error) {
    char version[TEXT_SIZE], isa[TEXT_SIZE], theirs[TEXT_SIZE], ours[TEXT_SIZE];
    uint64_t hash, mask;
    uint32_t embree;
    sf_status status = take_text(file, "version", version, error);
    if (!status) status = take_text(file, "instruction_set", isa, error);
    if (!status) status = take_u32(file, "embree_version", &embree, error);
    if (!status) status = take_u64(file, "scene_hash", &hash, error);
    if (!status) status = take_u64(file, "mask_hash", &mask, error);
    if (status) return status;
    if (strcmp(version, sf_version()) != 0) add_difference(d, "version", version, sf_version());
    if (strcmp(isa, sf_isa_name(film->isa)) != 0) add_difference(d, "instruction set", isa, sf_isa_name(film->isa));
    snprintf(theirs, sizeof theirs, "%" PRIu32, embree);
    snprintf(ours, sizeof ours, "%" PRIu32, film->embree_version);
    if (embree != film->embree_version) add_difference(d, "Embree version", theirs, ours);
    snprintf(theirs, sizeof theirs, "%016" PRIx64, hash);
    snprintf(ours, sizeof ours, "%016" PRIx64, film->scene_hash);
    if (hash != film->scene_hash) add_difference(d, "scene", theirs, ours);
    print_mask(theirs, mask);
    print_mask(ours, film->mask_hash);
    if (mask != film->mask_hash) add_difference(d, "mask", theirs, ours);
    return SF_STATUS_OK;
}

/* A pattern that spreads its spp points over the pixel at once has no point after the last. */
static bool is_closed(sf_pattern pattern) { return pattern == SF_PATTERN_UNIFORM || pattern == SF_PATTERN_JITTERED; }

static sf_status match(const sf_container *file, const sf_film *film, const sf_round_state *state, bool *more,
                       sf_error *error) {
    differences d = {.more = false};
    sf_render_options theirs;
    sf_status status = take_options(file, &theirs, error);
    if (!status) status = compare_identity(&d, file, film, error);
    if (status) return status;
    for (size_t i = 0; i < OPTION_COUNT; ++i) compare_option(&d, option_fields + i, &theirs, &film->options, state);
    *more = d.more;
    if (d.theirs[0])
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "checkpoint '%.100s' was made with %s; this render has %s%s",
                       file->path, d.theirs, d.ours,
                       d.limits ? " (counts may only grow, the tolerance only shrink)" : "");
    if (film->options.unbiased && (*more || theirs.samples != film->options.samples))
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "checkpoint '%s' has unbiased set, and its second set does not grow: samples, max_spp and the "
                       "tolerance must be the file's",
                       file->path);
    if (theirs.spp != film->options.spp && is_closed(theirs.pattern))
        return sf_fail(
            error, SF_STATUS_INVALID_VALUE,
            "checkpoint '%s' has the %u samples of pattern %s, which places all at once: spp can't grow to %u",
            file->path, theirs.spp, sf_pattern_name(theirs.pattern), film->options.spp);
    return SF_STATUS_OK;
}

/* Whether a file can be written there, before there is anything to write. */
static sf_status check_writable(const char *path, sf_error *error) {
    sf_replacement trial;
    sf_status status = sf_replacement_open(&trial, path, error);
    if (!status) sf_replacement_abandon(&trial);
    return status;
}

sf_status sf_checkpoint_restore(sf_checkpoint *c, const char *path, sf_resume *resume, sf_error *error) {
    sf_container file;
    bool more = false;
    *resume = SF_RESUME_NONE;
    if (access(path, F_OK) != 0 && errno == ENOENT) return check_writable(path, error);
    sf_status status = sf_container_open(&file, path, error);
    if (status) return status;
    sf_round_state state = {0};
    sf_array fixed = {"state.level_fixed", SF_ARRAY_U32, 1, 1, &state.level_fixed, 4};
    sf_array level = {"state.level", SF_ARRAY_F64, 1, 1, &state.level, 8};
    status = sf_container_take(&file, &fixed, error);
    if (!status) status = sf_container_take(&file, &level, error);
    if (!status) status = match(&file, c->film, &state, &more, error);
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
                                       : sf_stop_half_width(film, &film->options, x, y);
            pixel->reason = pixel->moments.nonfinite ? SF_STOP_SUSPICIOUS : SF_STOP_INTERRUPTED;
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
    sf_status status = take_options(file, &options, error);
    if (!status) status = check_room(file, &options, error);
    if (!status) status = take_text(file, "instruction_set", isa, error);
    if (!status) status = take_u64(file, "mask_hash", &mask, error);
    if (!status) status = sf_film_create(&options, mask != 0, film, error);
    if (status) return status;
    (*film)->isa = find_isa(isa);
    (*film)->mask_hash = mask;
    status = take_u64(file, "scene_hash", &(*film)->scene_hash, error);
    if (!status) status = take_u32(file, "embree_version", &(*film)->embree_version, error);
    if (status || !mask) return status;
    array_list list = {.count = 0};
    list_mask(&list, *film);
    status = sf_container_take(file, list.arrays, error);
    if (!status) status = sf_checkpoint_check_mask(*film, file->path, error);
    return status;
}

/* Fills the film from the file, and draws the conclusions. */
static sf_status fill_film(const sf_container *file, sf_checkpoint *c, sf_error *error) {
    size_t cells = sf_film_cell_count(c->film);
    c->active = malloc(cells * sizeof *c->active);
    c->open = malloc(cells * sizeof *c->open);
    if (!c->active || !c->open) return sf_fail_memory(error, "the list of cells", cells * sizeof *c->active);
    memset(c->open, 0xff, cells * sizeof *c->open);
    sf_status status = take_progress(file, c, error);
    if (status) return status;
    c->film->summary.level = c->state.level; /* half-widths may refer to them */
    c->film->summary.tolerance = c->state.tolerance;
    mark_unfinished(c->film, c->open, c->state.second);
    if (c->film->options.unbiased && !c->state.second) sf_film_mark_pilot(c->film);
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
