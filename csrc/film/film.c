// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A film from its making to its end: its arrays, what they show of the pixels, and its description. */
#include "film/film_internal.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/page_cache.h"
#include "base/platform.h"
#include "film/aov.h"
#include "film/film_looks.h"
#include "film/mask.h"
#include "film/option_table.h"
#include "film/signed_filter.h"
#include "scene/scene_internal.h"

#define OWN_CHANNELS 7
#define MAX_ATTRIBUTES 40
#define TEXT_SIZE 96

static uint32_t round_up(uint32_t x) { return (x + SF_CELL_SIZE - 1) / SF_CELL_SIZE * SF_CELL_SIZE; }
static uint32_t smaller(uint32_t a, uint32_t b) { return a < b ? a : b; }

/* The next `bytes` of the block at *memory, on cache lines of its own. */
static void *take(char **memory, size_t bytes) {
    char *taken = *memory;
    *memory += (bytes + SF_ALIGNMENT - 1) / SF_ALIGNMENT * SF_ALIGNMENT;
    return taken;
}

/* Takes every array from one block of pages, which starts as zeros. */
static sf_status allocate_arrays(sf_film *film, bool masked, sf_error *error) {
    size_t traced = film->stored, pixels = (size_t)film->crop_width * film->crop_height;
    size_t rows = film->crop_height * sizeof *film->rows;
    size_t pools = sf_film_pool_count(film) * sizeof *film->decay;
    size_t parts = film->negative_part > 0 ? traced * sizeof *film->signed_pixels : 0;
    film->memory_bytes =
        traced * sizeof *film->pixels + pools + rows + parts + pixels * (6 * 4 + 1 + masked) + 10 * SF_ALIGNMENT;
    film->memory = sf_page_cache_take(film->memory_bytes);
    if (!film->memory) return sf_fail_memory(error, "the film", film->memory_bytes);
    char *memory = film->memory;
    film->pixels = take(&memory, traced * sizeof *film->pixels);
    film->decay = take(&memory, pools);
    film->rows = take(&memory, rows);
    film->color = take(&memory, pixels * 3 * sizeof *film->color);
    film->alpha = take(&memory, pixels * sizeof *film->alpha);
    film->half_width = take(&memory, pixels * sizeof *film->half_width);
    film->samples = take(&memory, pixels * sizeof *film->samples);
    film->reason = take(&memory, pixels);
    film->mask = masked ? take(&memory, pixels) : NULL;
    film->signed_pixels = parts ? take(&memory, parts) : NULL;
    return SF_STATUS_OK;
}

/* The region that is traced: whole cells about the crop, within the frame. */
static void lay_out(sf_film *film, const sf_render_options *options) {
    const uint32_t *crop = options->crop;
    film->crop_x0 = crop[0];
    film->crop_y0 = crop[1];
    film->crop_width = crop[2] - crop[0];
    film->crop_height = crop[3] - crop[1];
    film->x0 = crop[0] / SF_CELL_SIZE * SF_CELL_SIZE;
    film->y0 = crop[1] / SF_CELL_SIZE * SF_CELL_SIZE;
    film->width = smaller(round_up(crop[2]), options->width) - film->x0;
    film->height = smaller(round_up(crop[3]), options->height) - film->y0;
    film->cell_columns = (film->width + SF_CELL_SIZE - 1) / SF_CELL_SIZE;
    film->cell_rows = (film->height + SF_CELL_SIZE - 1) / SF_CELL_SIZE;
    film->stored = sf_film_cell_count(film) * SF_CELL_SIZE * SF_CELL_SIZE;
}

/* All but the caller's functions and paths. */
static void keep_options(sf_film *film, const sf_render_options *options) {
    film->options = *options;
    film->options.progress = NULL;
    film->options.progress_user = NULL;
    film->options.notice = NULL;
    film->options.notice_user = NULL;
    film->options.checkpoint_path = NULL;
    film->options.mask = NULL;
}

sf_status sf_film_create(const sf_render_options *options, bool masked, sf_film **out, sf_error *error) {
    sf_film *film = calloc(1, sizeof *film);
    if (!film) return sf_fail_memory(error, "a film", sizeof *film);
    lay_out(film, options);
    keep_options(film, options);
    film->negative_part = sf_filter_negative_part(options->pixel_filter);
    sf_stop_set_factors(options, film->factors);
    film->unseen = sf_stop_unseen(options);
    film->parts = malloc(sizeof *film->parts);
    film->part_count = 1;
    sf_status status =
        film->parts ? allocate_arrays(film, masked, error) : sf_fail_memory(error, "a film", sizeof *film->parts);
    if (!status && options->aovs) status = sf_aov_create(options, film, error);
    if (!status) sf_mask_apply(options, film);
    if (!status) {
        film->parts[0].seed = options->seed;
        memcpy(film->parts[0].crop, options->crop, sizeof film->parts[0].crop);
    } else {
        sf_film_destroy(film);
        film = NULL;
    }
    *out = film;
    return status;
}

void sf_film_mark_pilot(sf_film *film) {
    for (size_t i = 0; i < film->stored; ++i) {
        sf_film_pixel *pixel = film->pixels + i;
        if (sf_film_taken(pixel) && pixel->reason != SF_STOP_REASON_SUSPICIOUS)
            pixel->reason = SF_STOP_REASON_INTERRUPTED;
    }
}

void sf_film_destroy(sf_film *film) {
    if (!film) return;
    sf_aov_destroy(film->aovs);
    sf_page_cache_give(film->memory, film->memory_bytes);
    for (size_t i = 0; i < film->attribute_count; ++i) free((char *)film->attributes[i].text);
    free(film->attributes);
    free(film->parts);
    free(film);
}

sf_status sf_film_identify(sf_film *film, const sf_scene *scene, sf_isa isa, sf_error *error) {
    sf_scene_info info;
    sf_status status = sf_scene_get_info(scene, &info, error);
    if (status) return status;
    film->scene_hash = info.hash;
    film->embree_version = (uint32_t)rtcGetDeviceProperty(scene->device, RTC_DEVICE_PROPERTY_VERSION);
    film->isa = isa;
    return SF_STATUS_OK;
}

void sf_film_sum_row(sf_film *film, uint32_t y) {
    double sum = 0;
    for (uint32_t x = 0; x < film->crop_width; ++x) {
        if (!sf_film_is_wanted(film, x, y)) continue;
        sum += sf_film_level_of(&sf_film_crop_at(film, x, y)->moments);
    }
    film->rows[y].level = sum;
}

double sf_film_level(const sf_film *film) {
    double sum = 0;
    for (uint32_t y = 0; y < film->crop_height; ++y) sum += film->rows[y].level;
    return sum / (double)film->counted;
}

/* A pixel that the mask leaves out. The arrays began as zeros. */
static void leave_out(sf_film *film, size_t i) {
    film->half_width[i] = INFINITY;
    film->reason[i] = SF_STOP_REASON_MASKED;
}

/* A pixel without a sample. The arrays began as zeros; to leave pages alone saves the half second
 * in which an interrupted render of a large frame has to end. */
static void resolve_untouched(sf_film *film, const sf_film_pixel *pixel, size_t i) {
    film->half_width[i] = INFINITY;
    film->reason[i] = pixel->reason ? pixel->reason : film->untouched;
}

static void resolve_pixel(sf_film *film, const sf_film_pixel *pixel, size_t i) {
    if (sf_film_taken(pixel) == 0) {
        resolve_untouched(film, pixel, i);
        return;
    }
    const sf_vector_moments *moments = &pixel->moments;
    for (int c = 0; c < 3; ++c) film->color[3 * i + c] = (float)moments->mean[c];
    film->alpha[i] = moments->count ? (float)((double)pixel->hits / (double)moments->count) : 0;
    film->half_width[i] = pixel->half_width;
    film->samples[i] = (uint32_t)(moments->count < UINT32_MAX ? moments->count : UINT32_MAX);
    film->reason[i] = pixel->reason;
}

void sf_film_resolve_row(sf_film *film, uint32_t y) {
    sf_film_row row = {.level = film->rows[y].level, .worst = -1};
    for (uint32_t x = 0; x < film->crop_width; ++x) {
        const sf_film_pixel *pixel = sf_film_crop_at(film, x, y);
        size_t i = (size_t)y * film->crop_width + x;
        if (!sf_film_is_wanted(film, x, y)) {
            leave_out(film, i);
            continue;
        }
        resolve_pixel(film, pixel, i);
        row.samples += sf_film_taken(pixel);
        row.nonfinite += pixel->moments.nonfinite;
        ++row.reasons[film->reason[i]];
        row.half_width += (double)film->half_width[i];
        row.relmse += sf_film_relative_error(film, pixel);
        if (!((double)film->half_width[i] > row.worst)) continue;
        row.worst = (double)film->half_width[i];
        row.worst_x = x + film->crop_x0;
    }
    film->rows[y] = row;
    if (film->aovs) sf_aov_resolve_row(film, y);
}

void sf_film_summarize_rows(sf_film *film) {
    sf_film_summary *summary = &film->summary;
    summary->pixels = film->counted;
    summary->worst_half_width = -1;
    for (uint32_t y = 0; y < film->crop_height; ++y) {
        const sf_film_row *row = film->rows + y;
        summary->samples += row->samples;
        summary->nonfinite_samples += row->nonfinite;
        for (int reason = 0; reason < SF_STOP_REASON_COUNT; ++reason) summary->reasons[reason] += row->reasons[reason];
        summary->mean_half_width += row->half_width / (double)summary->pixels;
        summary->relmse += row->relmse / (double)summary->pixels;
        if (!(row->worst > summary->worst_half_width)) continue;
        summary->worst_half_width = row->worst;
        summary->worst_x = row->worst_x;
        summary->worst_y = y + film->crop_y0;
    }
}

void sf_film_resolve(sf_film *film) {
    for (uint32_t y = 0; y < film->crop_height; ++y) sf_film_sum_row(film, y);
    for (uint32_t y = 0; y < film->crop_height; ++y) sf_film_resolve_row(film, y);
    sf_film_summarize_rows(film);
}

uint32_t sf_film_width(const sf_film *film) { return film->crop_width; }
uint32_t sf_film_height(const sf_film *film) { return film->crop_height; }
size_t sf_film_channel_count(const sf_film *film) { return OWN_CHANNELS + sf_aov_channel_count(film->aovs); }

sf_channel sf_film_channel(const sf_film *film, size_t index) {
    static const char *const colors[] = {"R", "G", "B"};
    sf_channel channel = {.type = SF_CHANNEL_FLOAT32, .pixel_stride = 4};
    switch (index) {
        case 0:
        case 1:
        case 2:
            channel.name = colors[index];
            channel.data = film->color + index;
            channel.pixel_stride = 12;
            break;
        case 3:
            channel.name = "A";
            channel.data = film->alpha;
            break;
        case 4:
            channel.name = "samples";
            channel.type = SF_CHANNEL_UINT32;
            channel.data = film->samples;
            break;
        case 5:
            channel.name = "half_width";
            channel.data = film->half_width;
            break;
        case 6:
            channel.name = "stop_reason";
            channel.type = SF_CHANNEL_UINT8;
            channel.data = film->reason;
            channel.pixel_stride = 1;
            break;
        default: channel = sf_aov_channel(film->aovs, index - OWN_CHANNELS); break;
    }
    channel.row_stride = channel.pixel_stride * film->crop_width;
    return channel;
}

size_t sf_film_attribute_count(const sf_film *film) { return film->attribute_count; }

sf_attribute sf_film_attribute(const sf_film *film, size_t index) { return film->attributes[index]; }

sf_film_summary sf_film_summarize(const sf_film *film) { return film->summary; }

/* Adds an attribute; `film->attributes` has room for MAX_ATTRIBUTES. A missing text is seen at
 * the end, by sf_film_describe. */
static void describe(sf_film *film, const char *name, const char *format, ...) SF_PRINTF(3, 4);
static void describe(sf_film *film, const char *name, const char *format, ...) {
    char *text = malloc(TEXT_SIZE);
    film->attributes[film->attribute_count++] = (sf_attribute){name, text};
    if (!text) return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, TEXT_SIZE, format, arguments);
    va_end(arguments);
}

static void describe_options(sf_film *film, const sf_render_options *o) {
    char text[SF_OPTION_TEXT_SIZE], mask[SF_MASK_TEXT_SIZE];
    const sf_option *option;
    for (size_t i = 0; (option = sf_render_option(i)); ++i) {
        sf_option_print(option, o, text);
        describe(film, option->name, "%s", text);
    }
    sf_mask_describe(film, mask);
    describe(film, "mask", "%s", mask);
}

static void describe_outcome(sf_film *film) {
    const sf_film_summary *s = &film->summary;
    describe(film, "level", "%.17g", s->level);
    describe(film, "tolerance", "%.17g", s->tolerance);
    describe(film, "total_samples", "%" PRIu64, s->samples);
    describe(film, "traced_samples", "%" PRIu64, s->traced_samples);
    describe(film, "nonfinite_samples", "%" PRIu64, s->nonfinite_samples);
    describe(film, "worst_half_width", "%.9g", s->worst_half_width);
    describe(film, "worst_pixel", "%" PRIu32 " %" PRIu32, s->worst_x, s->worst_y);
    describe(film, "estimated_relmse", "%.9g", s->relmse);
    describe(film, "rounds", "%" PRIu32, s->rounds);
    describe(film, "render_seconds", "%.6g", s->seconds);
}

/* The seeds of a merged film's parts, in order. */
static void describe_parts(sf_film *film) {
    size_t size = film->part_count * 21 + 1, used = 0;
    char *text = malloc(size);
    film->attributes[film->attribute_count++] = (sf_attribute){"merged_seeds", text};
    for (size_t i = 0; text && i < film->part_count; ++i)
        used += (size_t)snprintf(text + used, size - used, i ? " %" PRIu64 : "%" PRIu64, film->parts[i].seed);
}

sf_status sf_film_describe(sf_film *film, sf_error *error) {
    film->attributes = malloc(MAX_ATTRIBUTES * sizeof *film->attributes);
    if (!film->attributes)
        return sf_fail_memory(error, "the film's attributes", MAX_ATTRIBUTES * sizeof *film->attributes);
    describe(film, "version", "%s", sf_version());
    describe(film, "instruction_set", "%s", sf_isa_name(film->isa));
    describe(film, "scene_hash", "%016" PRIx64, film->scene_hash);
    describe_options(film, &film->options);
    describe_outcome(film);
    if (film->part_count > 1) describe_parts(film);
    for (size_t i = 0; i < film->attribute_count; ++i)
        if (!film->attributes[i].text) return sf_fail_memory(error, "the film's attributes", TEXT_SIZE);
    return SF_STATUS_OK;
}
