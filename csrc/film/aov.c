// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Sums and values of the AOVs, and the channels that show them. */
#include "film/aov.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/platform.h"
#include "film/film_internal.h"
#include "film/stopping.h"

/* An AOV's components; those without sums of their own are told from the film's statistics. */
static const struct {
    const char *name;
    uint32_t components;
    bool summed;
    const char *channels[3];
} forms[SF_AOV_COUNT] = {
    [SF_AOV_ALBEDO] = {"albedo", 3, true, {"albedo.R", "albedo.G", "albedo.B"}},
    [SF_AOV_NORMAL] = {"normal", 3, true, {"normal.X", "normal.Y", "normal.Z"}},
    [SF_AOV_DEPTH] = {"depth", 1, true, {"Z", NULL, NULL}},
    [SF_AOV_VARIANCE] = {"variance", 1, false, {"variance", NULL, NULL}},
    [SF_AOV_HALF_A] = {"half_a", 3, true, {"half_a.R", "half_a.G", "half_a.B"}},
    [SF_AOV_HALF_B] = {"half_b", 3, true, {"half_b.R", "half_b.G", "half_b.B"}},
};

const char *sf_aov_name(sf_aov aov) { return (unsigned)aov < SF_AOV_COUNT ? forms[aov].name : NULL; }

static bool wants(const sf_aov_film *aovs, int aov) { return aovs->wanted >> aov & 1u; }

/* ---- memory ---- */

static size_t round_up(size_t bytes) { return (bytes + SF_ALIGNMENT - 1) / SF_ALIGNMENT * SF_ALIGNMENT; }

/* Gives the arrays their places in a block of pages, and returns its size; a first call with
 * memory = NULL only measures. */
static size_t place_arrays(sf_aov_film *aovs, const sf_film *film, uint32_t threads, char *memory) {
    size_t crop = (size_t)film->crop_width * film->crop_height, used = 0;
#define PLACE(array, bytes)                            \
    do {                                               \
        if (memory) (array) = (void *)(memory + used); \
        used += round_up(bytes);                       \
    } while (0)
    PLACE(aovs->sums, film->stored * aovs->sums_per_pixel * sizeof *aovs->sums);
    if (aovs->wanted & SF_AOVS_OF_HITS) PLACE(aovs->hits, (size_t)threads * SF_BLOCKS * sizeof *aovs->hits);
    for (int k = 0; k < SF_AOV_COUNT; ++k)
        if (wants(aovs, k)) PLACE(aovs->values[k], crop * forms[k].components * sizeof(float));
#undef PLACE
    return used;
}

sf_status sf_aov_create(const sf_render_options *options, sf_film *film, sf_error *error) {
    sf_aov_film *aovs = calloc(1, sizeof *aovs);
    if (!aovs) return sf_fail_memory(error, "a film's AOVs", sizeof *aovs);
    film->aovs = aovs;
    aovs->wanted = options->aovs;
    for (int k = 0; k < SF_AOV_COUNT; ++k) {
        aovs->first_sum[k] = aovs->sums_per_pixel;
        if (wants(aovs, k) && forms[k].summed) aovs->sums_per_pixel += forms[k].components + 1;
    }
    aovs->memory_bytes = place_arrays(aovs, film, options->threads, NULL);
    aovs->memory = sf_pages_alloc(aovs->memory_bytes);
    if (!aovs->memory) return sf_fail_memory(error, "the film's AOVs", aovs->memory_bytes);
    place_arrays(aovs, film, options->threads, aovs->memory);
    return SF_STATUS_OK;
}

void sf_aov_destroy(sf_aov_film *aovs) {
    if (!aovs) return;
    sf_pages_free(aovs->memory, aovs->memory_bytes);
    free(aovs);
}

/* ---- sums ---- */

void sf_aov_reset(sf_film *film) {
    sf_aov_film *aovs = film->aovs;
    memset(aovs->sums, 0, film->stored * aovs->sums_per_pixel * sizeof *aovs->sums);
}

static void add_vector(double *sums, const double value[3], double factor, double count) {
    for (int c = 0; c < 3; ++c) sums[c] += value[c] * factor;
    sums[3] += count;
}

static void add_hits(const sf_aov_film *aovs, double *sums, const sf_hit_sums *hits, double samples) {
    if (wants(aovs, SF_AOV_ALBEDO)) add_vector(sums + aovs->first_sum[SF_AOV_ALBEDO], hits->albedo, 1, samples);
    if (wants(aovs, SF_AOV_NORMAL)) add_vector(sums + aovs->first_sum[SF_AOV_NORMAL], hits->normal, 1, samples);
    if (!wants(aovs, SF_AOV_DEPTH)) return;
    sums[aovs->first_sum[SF_AOV_DEPTH]] += hits->depth;
    sums[aovs->first_sum[SF_AOV_DEPTH] + 1] += hits->hits;
}

void sf_aov_add(sf_aov_film *aovs, uint32_t count, const sf_block *blocks, const sf_block_statistics *statistics,
                const sf_hit_sums *hits) {
    for (uint32_t i = 0; i < count; ++i) {
        const sf_vector_moments *moments = &statistics[i].moments;
        double *sums = aovs->sums + (size_t)blocks[i].pixel * aovs->sums_per_pixel, samples = (double)moments->count;
        int half = blocks[i].number % 2 ? SF_AOV_HALF_B : SF_AOV_HALF_A;
        if (wants(aovs, half)) add_vector(sums + aovs->first_sum[half], moments->mean, samples, samples);
        if (hits) add_hits(aovs, sums, hits + i, sf_count_bits(blocks[i].active));
    }
}

/* ---- values ---- */

/* Of the mean of (R+G+B)/3: what the half-width is made of. */
static float variance_of_mean(const sf_film *film, const sf_film_pixel *pixel, size_t i) {
    double error = (double)film->half_width[i] / sf_stop_factor(film->factors, &film->options, pixel);
    return (float)(error * error);
}

/* Of pixel i of the crop; `pixel` is NULL where the mask leaves it out. The values began as zeros. */
static void resolve_pixel(const sf_film *film, const sf_film_pixel *pixel, size_t i) {
    const sf_aov_film *aovs = film->aovs;
    if (!pixel) {
        if (wants(aovs, SF_AOV_DEPTH)) aovs->values[SF_AOV_DEPTH][i] = INFINITY;
        if (wants(aovs, SF_AOV_VARIANCE)) aovs->values[SF_AOV_VARIANCE][i] = INFINITY;
        return;
    }
    const double *sums = aovs->sums + (size_t)(pixel - film->pixels) * aovs->sums_per_pixel;
    for (int k = 0; k < SF_AOV_COUNT; ++k) {
        if (!wants(aovs, k)) continue;
        float *value = aovs->values[k] + i * forms[k].components;
        if (!forms[k].summed) {
            *value = variance_of_mean(film, pixel, i);
            continue;
        }
        const double *sum = sums + aovs->first_sum[k];
        double count = sum[forms[k].components];
        float nothing = k == SF_AOV_DEPTH ? INFINITY : 0;
        for (uint32_t c = 0; c < forms[k].components; ++c) value[c] = count > 0 ? (float)(sum[c] / count) : nothing;
    }
}

void sf_aov_resolve_row(sf_film *film, uint32_t y) {
    for (uint32_t x = 0; x < film->crop_width; ++x)
        resolve_pixel(film, sf_film_is_wanted(film, x, y) ? sf_film_crop_at(film, x, y) : NULL,
                      (size_t)y * film->crop_width + x);
}

/* ---- channels ---- */

size_t sf_aov_channel_count(const sf_aov_film *aovs) {
    size_t count = 0;
    for (int k = 0; aovs && k < SF_AOV_COUNT; ++k)
        if (wants(aovs, k)) count += forms[k].components;
    return count;
}

static sf_channel channel_of(const sf_aov_film *aovs, int aov, size_t component) {
    return (sf_channel){.name = forms[aov].channels[component],
                        .type = SF_CHANNEL_FLOAT32,
                        .data = aovs->values[aov] + component,
                        .pixel_stride = forms[aov].components * sizeof(float)};
}

sf_channel sf_aov_channel(const sf_aov_film *aovs, size_t index) {
    for (int k = 0; k < SF_AOV_COUNT; ++k) {
        if (!wants(aovs, k)) continue;
        if (index < forms[k].components) return channel_of(aovs, k, index);
        index -= forms[k].components;
    }
    return (sf_channel){0};
}

int sf_film_aov(const sf_film *film, sf_aov aov, sf_channel *first) {
    if ((unsigned)aov >= SF_AOV_COUNT || !film->aovs || !wants(film->aovs, (int)aov)) return 0;
    *first = channel_of(film->aovs, (int)aov, 0);
    first->row_stride = first->pixel_stride * film->crop_width;
    return (int)forms[aov].components;
}
