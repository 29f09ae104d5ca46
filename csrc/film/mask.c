// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Checks, copies, counts and describes the mask of pixels that a render traces. */
#include "film/mask.h"

#include <inttypes.h>
#include <stdio.h>

#include "base/error.h"
#include "film/film_internal.h"

static bool traced(const sf_render_options *o, uint32_t x, uint32_t y) {
    return !o->mask || o->mask[(size_t)y * o->mask_stride + x] != 0;
}

static uint64_t count_traced(const sf_render_options *o) {
    uint64_t count = 0;
    for (uint32_t y = o->crop[1]; y < o->crop[3]; ++y)
        for (uint32_t x = o->crop[0]; x < o->crop[2]; ++x) count += traced(o, x, y);
    return count;
}

sf_status sf_mask_complete(sf_render_options *o, sf_error *error) {
    if (!o->mask) return SF_STATUS_OK;
    if (o->mask_stride == 0) o->mask_stride = o->width;
    if (o->mask_stride < o->width)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "mask_stride is %zu; it must be at least the width, %" PRIu32,
                       o->mask_stride, o->width);
    if (count_traced(o) > 0) return SF_STATUS_OK;
    return sf_fail(error, SF_STATUS_INVALID_VALUE,
                   "mask leaves no pixel of the crop (%" PRIu32 ", %" PRIu32 ", %" PRIu32 ", %" PRIu32
                   "); set at least one",
                   o->crop[0], o->crop[1], o->crop[2], o->crop[3]);
}

bool sf_mask_touches_cell(const sf_render_options *o, uint32_t x, uint32_t y) {
    if (!o->mask) return true;
    for (uint32_t row = y; row < y + SF_CELL_SIZE && row < o->height; ++row)
        for (uint32_t column = x; column < x + SF_CELL_SIZE && column < o->width; ++column)
            if (traced(o, column, row)) return true;
    return false;
}

/* Of the traced pixels' places in the frame, in order. */
static uint64_t hash_mask(const sf_render_options *o) {
    uint64_t hash = 0;
    for (uint32_t y = 0; y < o->height; ++y)
        for (uint32_t x = 0; x < o->width; ++x)
            if (traced(o, x, y)) hash = sf_hash64(hash, (uint64_t)y << 32 | x);
    return hash;
}

void sf_mask_apply(const sf_render_options *o, sf_film *film) {
    film->counted = (uint64_t)film->crop_width * film->crop_height;
    if (!o->mask) return;
    film->mask_hash = hash_mask(o);
    for (uint32_t y = 0; y < film->crop_height; ++y)
        for (uint32_t x = 0; x < film->crop_width; ++x)
            film->mask[(size_t)y * film->crop_width + x] = traced(o, x + film->crop_x0, y + film->crop_y0);
    sf_mask_count(film);
}

void sf_mask_count(sf_film *film) {
    film->counted = 0;
    for (uint32_t y = 0; y < film->crop_height; ++y)
        for (uint32_t x = 0; x < film->crop_width; ++x) film->counted += (uint64_t)sf_film_is_wanted(film, x, y);
}

void sf_mask_describe(const sf_film *film, char text[SF_MASK_TEXT_SIZE]) {
    if (film->mask)
        snprintf(text, SF_MASK_TEXT_SIZE, "%" PRIu64 " pixels, hash %016" PRIx64, film->counted, film->mask_hash);
    else
        snprintf(text, SF_MASK_TEXT_SIZE, "none");
}
