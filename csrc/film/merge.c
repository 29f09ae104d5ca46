// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Films of one scene into one film, from their accumulators. */

#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/error.h"
#include "film/film_internal.h"
#include "film/signed_filter.h"

static uint32_t smaller(uint32_t a, uint32_t b) { return a < b ? a : b; }
static uint32_t larger(uint32_t a, uint32_t b) { return a > b ? a : b; }

/* ---- what may be merged ---- */

static sf_status refuse(size_t i, const char *what, const char *a, const char *b, sf_error *error) {
    return sf_fail(error, SF_STATUS_INVALID_VALUE, "film 1 has %s %s and film %zu has %s; they must be the same", what,
                   a, i + 1, b);
}

static sf_status check_alike(const sf_film *a, const sf_film *b, size_t i, sf_error *error) {
    const sf_render_options *p = &a->options, *q = &b->options;
    if (a->scene_hash != b->scene_hash)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "film 1 is of scene %016" PRIx64 " and film %zu of scene %016" PRIx64 "; they must be the same",
                       a->scene_hash, i + 1, b->scene_hash);
    if (p->width != q->width || p->height != q->height)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "film 1 is of a frame of %u x %u pixels and film %zu of %u x %u; they must be the same",
                       p->width, p->height, i + 1, q->width, q->height);
    if (p->confidence != q->confidence)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "film 1 has confidence %g and film %zu has %g; they must be the same", p->confidence, i + 1,
                       q->confidence);
    if (p->pattern != q->pattern)
        return refuse(i, "pattern", sf_pattern_name(p->pattern), sf_pattern_name(q->pattern), error);
    if (p->pixel_filter != q->pixel_filter)
        return refuse(i, "pixel_filter", sf_pixel_filter_name(p->pixel_filter), sf_pixel_filter_name(q->pixel_filter),
                      error);
    if (!p->unbiased != !q->unbiased)
        return refuse(i, "unbiased", p->unbiased ? "true" : "false", q->unbiased ? "true" : "false", error);
    if (p->stop != q->stop) return refuse(i, "stop", sf_stop_rule_name(p->stop), sf_stop_rule_name(q->stop), error);
    return SF_STATUS_OK;
}

/* Two parts with one seed hold the same samples wherever they overlap. */
static sf_status check_parts(const sf_film *a, size_t i, const sf_film *b, size_t k, sf_error *error) {
    for (size_t p = 0; p < a->part_count; ++p)
        for (size_t q = 0; q < b->part_count; ++q) {
            const uint32_t *m = a->parts[p].crop, *n = b->parts[q].crop;
            uint32_t x = larger(m[0], n[0]), y = larger(m[1], n[1]);
            if (a->parts[p].seed != b->parts[q].seed || x >= smaller(m[2], n[2]) || y >= smaller(m[3], n[3])) continue;
            return sf_fail(
                error, SF_STATUS_INVALID_VALUE,
                "films %zu and %zu both have seed %" PRIu64
                " at pixel (%u, %u), so that their samples are not independent; give each replicate a seed of its own",
                i + 1, k + 1, a->parts[p].seed, x, y);
        }
    return SF_STATUS_OK;
}

static sf_status check_films(const sf_film *const *films, size_t count, sf_error *error) {
    if (count == 0) return sf_fail(error, SF_STATUS_INVALID_VALUE, "there are no films to merge; give at least one");
    sf_status status = SF_STATUS_OK;
    for (size_t i = 0; !status && i < count; ++i) {
        status = check_alike(films[0], films[i], i, error);
        if (!status && films[i]->mask)
            status = sf_fail(error, SF_STATUS_UNSUPPORTED, "film %zu has a mask; films with masks do not merge", i + 1);
        for (size_t k = 0; !status && k < i; ++k) status = check_parts(films[k], k, films[i], i, error);
    }
    return status;
}

/* ---- a pixel ---- */

/* How little a reason says the pixel is done: the least final of several holds for the merged. */
static int openness(uint8_t reason) {
    static const int order[SF_STOP_REASON_COUNT] = {[SF_STOP_REASON_FIXED] = 0,       [SF_STOP_REASON_MET] = 1,
                                                    [SF_STOP_REASON_MAX_SAMPLES] = 2, [SF_STOP_REASON_OUT_OF_TIME] = 3,
                                                    [SF_STOP_REASON_INTERRUPTED] = 4, [SF_STOP_REASON_SUSPICIOUS] = 5};
    return order[reason];
}

/* A film's pixel at (x, y) of the frame; NULL where it has none. */
static const sf_film_pixel *pixel_at(const sf_film *film, uint32_t x, uint32_t y) {
    if (x < film->crop_x0 || y < film->crop_y0) return NULL;
    if (x - film->crop_x0 >= film->crop_width || y - film->crop_y0 >= film->crop_height) return NULL;
    return sf_film_crop_at(film, x - film->crop_x0, y - film->crop_y0);
}

/* Adds the films' pixels in their order; false where none has it. Errors of independent estimates
 * add in squares: the mean is sum n_i m_i / N, its half-width sqrt(sum (n_i h_i)^2) / N, and so with the
 * variances of their looks. */
static bool merge_pixel(const sf_film *const *films, size_t count, uint32_t x, uint32_t y, sf_film *merged,
                        sf_film_pixel *out) {
    double square = 0, variance = 0;
    size_t found = 0, sampled = 0, looked_at = 0;
    for (size_t i = 0; i < count; ++i) {
        const sf_film_pixel *pixel = pixel_at(films[i], x, y);
        if (!pixel) continue;
        if (pixel->moments.count) {
            double n = (double)pixel->moments.count, weighted = n * (double)pixel->half_width;
            square += weighted * weighted;
            variance += n * n * (double)pixel->variance;
            looked_at += pixel->look > 0;
            ++sampled;
        }
        uint8_t reason = found && openness(out->reason) > openness(pixel->reason) ? out->reason : pixel->reason;
        if (found++ == 0)
            *out = *pixel;
        else {
            if (!out->moments.count) out->half_width = pixel->half_width;
            sf_film_merge_pixel(out, pixel);
        }
        if (merged->signed_pixels)
            sf_signed_merge(out, merged->signed_pixels + (out - merged->pixels),
                            films[i]->signed_pixels + (pixel - films[i]->pixels), merged->negative_part);
        out->reason = reason;
    }
    if (sampled > 1) {
        double n = (double)out->moments.count;
        out->half_width = (float)(sqrt(square) / n);
        out->variance = (float)(variance / n / n);
        if (looked_at < sampled) out->look = 0;
    }
    return found > 0;
}

/* ---- the film ---- */

static sf_render_options merged_options(const sf_film *const *films, size_t count) {
    sf_render_options options = films[0]->options;
    options.aovs = 0; /* AOVs do not merge */
    for (size_t i = 1; i < count; ++i) {
        const uint32_t *crop = films[i]->options.crop;
        for (int k = 0; k < 2; ++k) options.crop[k] = smaller(options.crop[k], crop[k]);
        for (int k = 2; k < 4; ++k) options.crop[k] = larger(options.crop[k], crop[k]);
    }
    return options;
}

static sf_status gather_parts(sf_film *film, const sf_film *const *films, size_t count, sf_error *error) {
    size_t total = 0;
    for (size_t i = 0; i < count; ++i) total += films[i]->part_count;
    sf_film_part *parts = realloc(film->parts, total * sizeof *parts);
    if (!parts) return sf_fail_memory(error, "the films' parts", total * sizeof *parts);
    film->parts = parts;
    film->part_count = 0;
    for (size_t i = 0; i < count; ++i)
        for (size_t k = 0; k < films[i]->part_count; ++k) film->parts[film->part_count++] = films[i]->parts[k];
    return SF_STATUS_OK;
}

static void gather_summaries(sf_film *film, const sf_film *const *films, size_t count) {
    sf_film_summary *s = &film->summary;
    for (size_t i = 0; i < count; ++i) {
        const sf_film_summary *other = &films[i]->summary;
        if (other->tolerance > 0 && !(s->tolerance > 0 && s->tolerance < other->tolerance))
            s->tolerance = other->tolerance;
        s->traced_samples += other->traced_samples;
        s->seconds += other->seconds;
        s->threads = larger(s->threads, other->threads);
        s->rounds = larger(s->rounds, other->rounds);
    }
    s->confidence = film->options.confidence;
    film->scene_hash = films[0]->scene_hash;
    film->embree_version = films[0]->embree_version;
    film->isa = films[0]->isa;
}

static sf_status merge_pixels(sf_film *film, const sf_film *const *films, size_t count, sf_error *error) {
    double tolerance = film->summary.tolerance;
    for (uint32_t y = 0; y < film->crop_height; ++y)
        for (uint32_t x = 0; x < film->crop_width; ++x) {
            sf_film_pixel *pixel = sf_film_crop_at(film, x, y);
            uint32_t frame_x = x + film->crop_x0, frame_y = y + film->crop_y0;
            if (!merge_pixel(films, count, frame_x, frame_y, film, pixel))
                return sf_fail(error, SF_STATUS_INVALID_VALUE,
                               "pixel (%u, %u) is in none of the films; their crops must fill a rectangle", frame_x,
                               frame_y);
            if (sf_film_taken(pixel) > UINT32_MAX)
                return sf_fail(error, SF_STATUS_INVALID_VALUE, "pixel (%u, %u) would have more than %u samples",
                               frame_x, frame_y, UINT32_MAX);
            bool met = tolerance > 0 && (double)pixel->half_width <= tolerance;
            if (met && pixel->reason != SF_STOP_REASON_SUSPICIOUS) pixel->reason = SF_STOP_REASON_MET;
        }
    return SF_STATUS_OK;
}

sf_status sf_film_merge(const sf_film *const *films, size_t count, sf_film **merged, sf_error *error) {
    *merged = NULL;
    sf_film *film = NULL;
    sf_status status = check_films(films, count, error);
    if (status) return status;
    sf_render_options options = merged_options(films, count);
    status = sf_film_create(&options, false, &film, error);
    if (!status) status = gather_parts(film, films, count, error);
    if (!status) gather_summaries(film, films, count);
    if (!status) status = merge_pixels(film, films, count, error);
    if (!status) {
        sf_film_resolve(film);
        film->summary.level = sf_film_level(film);
        status = sf_film_describe(film, error);
    }
    if (status)
        sf_film_destroy(film);
    else
        *merged = film;
    return status;
}
