// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What a checkpoint is of: the options of the table of options, and the scene; written, compared and read. */

#include "render/checkpoint_identity.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/name.h"
#include "film/film_internal.h"
#include "film/mask.h"
#include "film/option_table.h"
#include "film/render_options.h"
#include "film/stopping.h"

/* ---- options in a container: "option." before the name ---- */

typedef struct option_array {
    char name[48];
    sf_array_type type;
    uint32_t width;
} option_array;

static option_array array_of(const sf_option *option) {
    option_array array = {.type = option->type == SF_OPTION_FLOAT64  ? SF_ARRAY_F64
                                  : option->type == SF_OPTION_UINT64 ? SF_ARRAY_U64
                                  : option->type == SF_OPTION_CHOICE ? SF_ARRAY_TEXT
                                                                     : SF_ARRAY_U32,
                          .width = option->type == SF_OPTION_RECTANGLE ? 4 : 1};
    snprintf(array.name, sizeof array.name, "option.%s", option->name);
    return array;
}

/* ---- writing ---- */

static void list_text(sf_array_list *list, const char *name, const char *text) {
    sf_array_list_add(list, name, SF_ARRAY_TEXT, 1, strlen(text), (void *)text, 1); /* that is only read */
}

void sf_checkpoint_list_mask(sf_array_list *list, sf_film *film) {
    sf_array_list_add(list, "mask", SF_ARRAY_U8, 1, (uint64_t)film->crop_width * film->crop_height, film->mask, 1);
}

/* What identifies the picture, for writing. */
void sf_checkpoint_list_identity(sf_array_list *list, sf_film *film) {
    list_text(list, "version", sf_version());
    list_text(list, "instruction_set", sf_isa_name(film->isa));
    sf_array_list_add(list, "embree_version", SF_ARRAY_U32, 1, 1, &film->embree_version, 4);
    sf_array_list_add(list, "scene_hash", SF_ARRAY_U64, 1, 1, &film->scene_hash, 8);
    sf_array_list_add(list, "mask_hash", SF_ARRAY_U64, 1, 1, &film->mask_hash, 8);
    if (film->mask) sf_checkpoint_list_mask(list, film);
    const sf_option *option;
    for (size_t i = 0; (option = sf_render_option(i)); ++i) {
        option_array array = array_of(option);
        const char *name = sf_array_list_name(list, array.name);
        if (array.type == SF_ARRAY_TEXT)
            list_text(list, name, option->name_of(sf_option_choice(option, &film->options)));
        else
            sf_array_list_add(list, name, array.type, array.width, 1, (char *)&film->options + option->offset,
                              sf_option_size(option));
    }
}

/* ---- reading ---- */

sf_status sf_checkpoint_take_text(const sf_container *file, const char *name, char text[SF_CHECKPOINT_TEXT_SIZE],
                                  sf_error *error) {
    uint64_t length;
    if (!sf_container_find(file, name, SF_ARRAY_TEXT, 1, &length) || length >= SF_CHECKPOINT_TEXT_SIZE)
        return sf_fail(error, SF_STATUS_IO, "checkpoint '%s' has no %s", file->path, name);
    sf_array array = {name, SF_ARRAY_TEXT, 1, length, text, 1};
    text[length] = 0;
    return sf_container_take(file, &array, error);
}

/* The enumeration's value of that name. */
static sf_status find_name(const sf_container *file, const sf_option *option, const char *name,
                           sf_render_options *options, sf_error *error) {
    char text[SF_CHECKPOINT_TEXT_SIZE];
    sf_status status = sf_checkpoint_take_text(file, name, text, error);
    if (status) return status;
    int value;
    if (sf_name_find(option->name, text, option->name_of, &value, NULL))
        return sf_fail(error, SF_STATUS_IO, "checkpoint '%s' has %s '%s', which this Sunfleck does not know",
                       file->path, name, text);
    memcpy((char *)options + option->offset, &value, sizeof value);
    return SF_STATUS_OK;
}

sf_status sf_checkpoint_take_options(const sf_container *file, sf_render_options *options, sf_error *error) {
    *options = sf_render_options_default();
    const sf_option *option;
    for (size_t i = 0; (option = sf_render_option(i)); ++i) {
        option_array kept = array_of(option);
        sf_array array = {
            kept.name, kept.type, kept.width, 1, (char *)options + option->offset, sf_option_size(option)};
        sf_status status = kept.type == SF_ARRAY_TEXT ? find_name(file, option, kept.name, options, error)
                                                      : sf_container_take(file, &array, error);
        if (status) return status;
    }
    sf_error problem;
    sf_status status = sf_render_options_complete(options, &problem);
    if (!status) return status;
    return sf_fail(error, SF_STATUS_IO, "checkpoint '%s' holds an option that no render has: %s", file->path,
                   problem.message);
}

sf_status sf_checkpoint_take_u64(const sf_container *file, const char *name, uint64_t *value, sf_error *error) {
    sf_array array = {name, SF_ARRAY_U64, 1, 1, value, sizeof *value};
    return sf_container_take(file, &array, error);
}
sf_status sf_checkpoint_take_u32(const sf_container *file, const char *name, uint32_t *value, sf_error *error) {
    sf_array array = {name, SF_ARRAY_U32, 1, 1, value, sizeof *value};
    return sf_container_take(file, &array, error);
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
static void print_number(char text[SF_CHECKPOINT_TEXT_SIZE], double value) {
    snprintf(text, SF_CHECKPOINT_TEXT_SIZE, "%.15g", value);
    if (strtod(text, NULL) != value) snprintf(text, SF_CHECKPOINT_TEXT_SIZE, "%.17g", value);
}

static void print_option(char text[SF_CHECKPOINT_TEXT_SIZE], const sf_option *option,
                         const sf_render_options *options) {
    const uint32_t *four = (const uint32_t *)(const void *)((const char *)options + option->offset);
    if (option->type == SF_OPTION_FLOAT64)
        print_number(text, sf_option_number(option, options));
    else if (option->type == SF_OPTION_RECTANGLE)
        snprintf(text, SF_CHECKPOINT_TEXT_SIZE, "(%" PRIu32 ", %" PRIu32 ", %" PRIu32 ", %" PRIu32 ")", four[0],
                 four[1], four[2], four[3]);
    else
        sf_option_print(option, options, text);
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
static bool count_allows(const sf_option *option, const sf_render_options *theirs, const sf_render_options *ours) {
    double a = sf_option_number(option, theirs), b = sf_option_number(option, ours);
    return b > a && a > 0;
}

static void compare_option(differences *d, const sf_option *option, const sf_render_options *theirs,
                           const sf_render_options *ours, const sf_round_state *state) {
    if (option->resume == SF_RESUME_FREE ||
        !memcmp((const char *)theirs + option->offset, (const char *)ours + option->offset, sf_option_size(option)))
        return;
    if (option->offset == offsetof(sf_render_options, samples) && count_allows(option, theirs, ours)) return;
    if ((option->resume == SF_RESUME_LARGER && count_allows(option, theirs, ours)) ||
        (option->resume == SF_RESUME_TOLERANCE && tolerance_allows(theirs, ours, state))) {
        d->more = true;
        return;
    }
    char their_text[SF_CHECKPOINT_TEXT_SIZE], our_text[SF_CHECKPOINT_TEXT_SIZE];
    print_option(their_text, option, theirs);
    print_option(our_text, option, ours);
    add_difference(d, option->name, their_text, our_text);
    d->limits |= option->resume != SF_RESUME_EQUAL;
}

/* "none", or the hash. */
static void print_mask(char text[SF_CHECKPOINT_TEXT_SIZE], uint64_t hash) {
    snprintf(text, SF_CHECKPOINT_TEXT_SIZE, hash ? "%016" PRIx64 : "none", hash);
}

static sf_status compare_identity(differences *d, const sf_container *file, const sf_film *film, sf_error *error) {
    char version[SF_CHECKPOINT_TEXT_SIZE], isa[SF_CHECKPOINT_TEXT_SIZE], theirs[SF_CHECKPOINT_TEXT_SIZE],
        ours[SF_CHECKPOINT_TEXT_SIZE];
    uint64_t hash, mask;
    uint32_t embree;
    sf_status status = sf_checkpoint_take_text(file, "version", version, error);
    if (!status) status = sf_checkpoint_take_text(file, "instruction_set", isa, error);
    if (!status) status = sf_checkpoint_take_u32(file, "embree_version", &embree, error);
    if (!status) status = sf_checkpoint_take_u64(file, "scene_hash", &hash, error);
    if (!status) status = sf_checkpoint_take_u64(file, "mask_hash", &mask, error);
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

sf_status sf_checkpoint_match(const sf_container *file, const sf_film *film, const sf_round_state *state, bool *more,
                              sf_error *error) {
    differences d = {.more = false};
    sf_render_options theirs;
    sf_status status = sf_checkpoint_take_options(file, &theirs, error);
    if (!status) status = compare_identity(&d, file, film, error);
    if (status) return status;
    const sf_option *option;
    for (size_t i = 0; (option = sf_render_option(i)); ++i) compare_option(&d, option, &theirs, &film->options, state);
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
