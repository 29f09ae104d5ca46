// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What a checkpoint is of: options and scene, as one table that is written, compared and read. A new
 * option is one more line. */

#include "render/checkpoint_identity.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "film/mask.h"
#include "film/render_options.h"
#include "film/stopping.h"

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

/* ---- writing ---- */

static void list_text(sf_array_list *list, const char *name, const char *text) {
    sf_array_list_add(list, name, SF_ARRAY_TEXT, 1, strlen(text), (void *)text, 1); /* that is only read */
}

static size_t option_size(const option_field *field) {
    return field->type == SF_ARRAY_U32 ? 4 * field->width : 8 * field->width;
}

static int enumeration_value(const option_field *field, const sf_render_options *options) {
    int value;
    memcpy(&value, (const char *)options + field->offset, sizeof value);
    return value;
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
    for (size_t i = 0; i < OPTION_COUNT; ++i) {
        const option_field *f = option_fields + i;
        if (f->name_of)
            list_text(list, f->name, f->name_of(enumeration_value(f, &film->options)));
        else
            sf_array_list_add(list, f->name, f->type, f->width, 1, (char *)&film->options + f->offset, option_size(f));
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
static sf_status find_name(const sf_container *file, const option_field *field, sf_render_options *options,
                           sf_error *error) {
    char text[SF_CHECKPOINT_TEXT_SIZE];
    sf_status status = sf_checkpoint_take_text(file, field->name, text, error);
    if (status) return status;
    for (int value = 0; field->name_of(value); ++value) {
        if (strcmp(field->name_of(value), text) != 0) continue;
        memcpy((char *)options + field->offset, &value, sizeof value);
        return SF_STATUS_OK;
    }
    return sf_fail(error, SF_STATUS_IO, "checkpoint '%s' has %s '%s', which this Sunfleck does not know", file->path,
                   field->name, text);
}

sf_status sf_checkpoint_take_options(const sf_container *file, sf_render_options *options, sf_error *error) {
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

static double option_number(const option_field *field, const sf_render_options *options) {
    const char *at = (const char *)options + field->offset;
    if (field->type == SF_ARRAY_F64) return *(const double *)at;
    if (field->type == SF_ARRAY_U64) return (double)*(const uint64_t *)at;
    return *(const uint32_t *)at;
}

static void print_option(char text[SF_CHECKPOINT_TEXT_SIZE], const option_field *field,
                         const sf_render_options *options) {
    const char *at = (const char *)options + field->offset;
    const uint32_t *four = (const uint32_t *)at;
    if (field->name_of)
        snprintf(text, SF_CHECKPOINT_TEXT_SIZE, "%s", field->name_of(enumeration_value(field, options)));
    else if (field->width == 4)
        snprintf(text, SF_CHECKPOINT_TEXT_SIZE, "(%" PRIu32 ", %" PRIu32 ", %" PRIu32 ", %" PRIu32 ")", four[0],
                 four[1], four[2], four[3]);
    else if (field->type == SF_ARRAY_U64)
        snprintf(text, SF_CHECKPOINT_TEXT_SIZE, "%" PRIu64, *(const uint64_t *)at);
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
    char their_text[SF_CHECKPOINT_TEXT_SIZE], our_text[SF_CHECKPOINT_TEXT_SIZE];
    print_option(their_text, field, theirs);
    print_option(our_text, field, ours);
    add_difference(d, field->name + strlen("option."), their_text, our_text);
    d->limits |= field->rule != EQUAL;
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
