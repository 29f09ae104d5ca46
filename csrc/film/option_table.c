// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The options of a render as one table, which defaults, checks, metadata, checkpoints, bindings and commands read.
 * A new option is its field in film.h, its line here, and what honours it. */
#include "film/option_table.h"

#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/platform.h"
#include "film/aov.h"
#include "film/block.h"

static const char *name_pattern(int value) { return sf_pattern_name((sf_pattern)value); }
static const char *name_filter(int value) { return sf_pixel_filter_name((sf_pixel_filter)value); }
static const char *name_stop(int value) { return sf_stop_rule_name((sf_stop_rule)value); }
static const char *name_seeds(int value) { return sf_seed_policy_name((sf_seed_policy)value); }
static const char *name_aov(int value) { return sf_aov_name((sf_aov)value); }

#define OPTION(field, type, resume, otherwise, lowest, highest, allowed, text) \
    {#field,                                                                   \
     SF_OPTION_##type,                                                         \
     SF_RESUME_##resume,                                                       \
     offsetof(sf_render_options, field),                                       \
     otherwise,                                                                \
     lowest,                                                                   \
     highest,                                                                  \
     allowed,                                                                  \
     NULL,                                                                     \
     text}
#define NAMED(field, type, otherwise, name_of, text)                                                                \
    {#field, SF_OPTION_##type, SF_RESUME_EQUAL, offsetof(sf_render_options, field), otherwise, 0, 0, NULL, name_of, \
     text}

#define NO_LIMIT "(0, 1e9], or 0 for no limit"
#define TOLERANCES "[0, 1e18]"
#define BOUNCES "2 to 64, or 0 for none"

static const sf_option table[] = {
    OPTION(width, UINT32, EQUAL, 512, 1, SF_MAX_IMAGE_SIZE, NULL, "of the full frame, in pixels"),
    OPTION(height, UINT32, EQUAL, 512, 1, SF_MAX_IMAGE_SIZE, NULL, "of the full frame, in pixels"),
    OPTION(crop, RECTANGLE, EQUAL, 0, 0, SF_MAX_IMAGE_SIZE, NULL,
           "x0, y0, x1, y1, half open, in pixels of the full frame"),
    OPTION(spp, UINT32, LARGER, 0, 0, SF_MAX_SPP, NULL, "a fixed count of samples a pixel; not with a tolerance"),
    OPTION(start, UINT32, EQUAL, 0, 0, SF_MAX_SPP, NULL, "index of each pixel's first sample, with spp"),
    OPTION(relative_tolerance, FLOAT64, TOLERANCE, 0, 0, 1e18, TOLERANCES,
           "a pixel is done when its half-width is so much of the mean level"),
    OPTION(absolute_tolerance, FLOAT64, TOLERANCE, 0, 0, 1e18, TOLERANCES, "or when it is so much, in linear radiance"),
    OPTION(relmse, FLOAT64, TOLERANCE, 0, 0, 1e18, TOLERANCES,
           "instead, the relative mean square error of the whole picture"),
    OPTION(confidence, FLOAT64, EQUAL, 0.95, 0x1p-1074, 1 - 0x1p-53, "(0, 1)", "of the half-widths"),
    OPTION(min_spp, UINT32, EQUAL, 32, 2, SF_MAX_SPP, NULL, "samples of a pixel before the first decision"),
    OPTION(max_spp, UINT32, LARGER, 4096, 2, SF_MAX_SPP, NULL, "samples of a pixel at the most"),
    OPTION(samples, UINT64, LARGER, 0, 0, 0x1p64, NULL, "a budget of samples, alone or with seconds"),
    OPTION(seconds, FLOAT64, FREE, 0, 0, 1e9, NO_LIMIT, "a time limit; alone, a budget that is spent on every pixel"),
    NAMED(pattern, CHOICE, SF_PATTERN_SOBOL, name_pattern, "of each pixel's samples"),
    NAMED(pixel_filter, CHOICE, SF_PIXEL_FILTER_BOX, name_filter, "by which a pixel weighs what lies about it"),
    NAMED(stop, CHOICE, SF_STOP_RULE_DYADIC, name_stop, "the rule by which half-widths are told"),
    OPTION(unbiased, FLAG, EQUAL, 0, 0, 1, NULL, "a pilot decides the counts, a second set is shown; costs twice"),
    NAMED(seeds, CHOICE, SF_SEEDS_PIXEL, name_seeds, "what has random numbers of its own"),
    OPTION(seed, UINT64, EQUAL, 0, 0, 0x1p64, NULL, "of all random numbers"),
    OPTION(threads, UINT32, FREE, 0, 0, SF_MAX_THREADS, NULL, "0: one for each processor"),
    OPTION(tile_size, UINT32, FREE, 16, SF_CELL_SIZE, 1024, NULL, "pixels a side of what a thread takes at a time"),
    OPTION(roulette, UINT32, EQUAL, 0, 2, SF_MAX_BOUNCES, BOUNCES, "Russian roulette from so many bounces on; 0: none"),
    NAMED(aovs, NAMES, 0, name_aov, "what the film keeps beside the colours"),
};

const sf_option *sf_render_option(size_t index) { return index < sizeof table / sizeof *table ? table + index : NULL; }

/* ---- values ---- */

static const void *field(const sf_option *option, const sf_render_options *options) {
    return (const char *)options + option->offset;
}

size_t sf_option_size(const sf_option *option) {
    switch (option->type) {
        case SF_OPTION_UINT64:
        case SF_OPTION_FLOAT64: return 8;
        case SF_OPTION_RECTANGLE: return 4 * sizeof(uint32_t);
        case SF_OPTION_CHOICE: return sizeof(int);
        default: return sizeof(uint32_t);
    }
}

double sf_option_number(const sf_option *option, const sf_render_options *options) {
    const void *at = field(option, options);
    if (option->type == SF_OPTION_FLOAT64) return *(const double *)at;
    if (option->type == SF_OPTION_UINT64) return (double)*(const uint64_t *)at;
    return *(const uint32_t *)at;
}

int sf_option_choice(const sf_option *option, const sf_render_options *options) {
    int value;
    memcpy(&value, field(option, options), sizeof value);
    return value;
}

void sf_options_set_defaults(sf_render_options *options) {
    const sf_option *option;
    for (size_t i = 0; (option = sf_render_option(i)); ++i) {
        char *at = (char *)options + option->offset;
        int choice = (int)option->otherwise;
        if (option->type == SF_OPTION_FLOAT64)
            *(double *)(void *)at = option->otherwise;
        else if (option->type == SF_OPTION_UINT64)
            *(uint64_t *)(void *)at = (uint64_t)option->otherwise;
        else if (option->type == SF_OPTION_CHOICE)
            memcpy(at, &choice, sizeof choice);
        else if (option->type != SF_OPTION_RECTANGLE)
            *(uint32_t *)(void *)at = (uint32_t)option->otherwise;
    }
}

static void print_names(const sf_option *option, uint32_t wanted, char text[SF_OPTION_TEXT_SIZE]) {
    size_t used = 0;
    text[0] = 0;
    for (int k = 0; option->name_of(k); ++k)
        if (wanted >> k & 1u)
            used +=
                (size_t)snprintf(text + used, SF_OPTION_TEXT_SIZE - used, "%s%s", used ? "," : "", option->name_of(k));
    if (!used) snprintf(text, SF_OPTION_TEXT_SIZE, "none");
}

void sf_option_print(const sf_option *option, const sf_render_options *options, char text[SF_OPTION_TEXT_SIZE]) {
    const uint32_t *integers = field(option, options);
    switch (option->type) {
        case SF_OPTION_UINT32: snprintf(text, SF_OPTION_TEXT_SIZE, "%" PRIu32, *integers); break;
        case SF_OPTION_UINT64:
            snprintf(text, SF_OPTION_TEXT_SIZE, "%" PRIu64, *(const uint64_t *)field(option, options));
            break;
        case SF_OPTION_FLOAT64: snprintf(text, SF_OPTION_TEXT_SIZE, "%.17g", sf_option_number(option, options)); break;
        case SF_OPTION_FLAG: snprintf(text, SF_OPTION_TEXT_SIZE, "%s", *integers ? "true" : "false"); break;
        case SF_OPTION_CHOICE:
            snprintf(text, SF_OPTION_TEXT_SIZE, "%s", option->name_of(sf_option_choice(option, options)));
            break;
        case SF_OPTION_NAMES: print_names(option, *integers, text); break;
        case SF_OPTION_RECTANGLE:
            snprintf(text, SF_OPTION_TEXT_SIZE, "%" PRIu32 " %" PRIu32 " %" PRIu32 " %" PRIu32, integers[0],
                     integers[1], integers[2], integers[3]);
            break;
    }
}

/* ---- ranges ---- */

static sf_status check_number(const sf_option *option, const sf_render_options *options, sf_error *error) {
    double value = sf_option_number(option, options);
    bool none = value == 0 && option->otherwise == 0; /* what is not asked for */
    if (none || (value >= option->lowest && value <= option->highest)) return SF_STATUS_OK;
    char allowed[SF_OPTION_TEXT_SIZE], given[SF_OPTION_TEXT_SIZE];
    snprintf(allowed, sizeof allowed, "%.0f to %.0f", option->lowest, option->highest);
    sf_option_print(option, options, given);
    if (option->type == SF_OPTION_FLOAT64) snprintf(given, sizeof given, "%g", value);
    return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s is %s; it must be %s%s", option->name, given,
                   option->type == SF_OPTION_FLOAT64 ? "in " : "", option->allowed ? option->allowed : allowed);
}

static sf_status check_names(const sf_option *option, const sf_render_options *options, sf_error *error) {
    int count = 0;
    while (option->name_of(count)) ++count;
    uint32_t wanted = *(const uint32_t *)field(option, options);
    if (!(wanted >> count)) return SF_STATUS_OK;
    return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s is 0x%x; it must be a union of bits 0 to %d", option->name,
                   wanted, count - 1);
}

static sf_status check_option(const sf_option *option, const sf_render_options *options, sf_error *error) {
    switch (option->type) {
        case SF_OPTION_CHOICE:
            if (option->name_of(sf_option_choice(option, options))) return SF_STATUS_OK;
            return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s is %d; it must be one of the enumeration's values",
                           option->name, sf_option_choice(option, options));
        case SF_OPTION_NAMES: return check_names(option, options, error);
        case SF_OPTION_FLAG:
        case SF_OPTION_RECTANGLE: return SF_STATUS_OK; /* any number is a flag; the frame bounds a crop */
        default: return check_number(option, options, error);
    }
}

sf_status sf_options_check_ranges(const sf_render_options *options, sf_error *error) {
    sf_status status = SF_STATUS_OK;
    const sf_option *option;
    for (size_t i = 0; !status && (option = sf_render_option(i)); ++i) status = check_option(option, options, error);
    return status;
}
