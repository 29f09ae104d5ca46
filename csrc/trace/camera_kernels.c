// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Makes the camera rays of a batch: places within the pixel by its filter, origins on the lens. */
#include "trace/camera_kernels.h"

#include <math.h>

#include "sunfleck/mapping.h"
#include "trace/lanes.h"

/* Takes coordinate[0 .. 1] to the filter's places; the arguments after the two coordinates are the filter's. */
#define PLACE(draw, ...)                                             \
    for (uint32_t i = 0; i < sf_batch_paths(b); ++i) {               \
        float place[2];                                              \
        draw(b->coordinate[0][i], b->coordinate[1][i], __VA_ARGS__); \
        b->coordinate[0][i] = place[0];                              \
        b->coordinate[1][i] = place[1];                              \
    }

/* Notes where the filter, a product of its two axes, is negative. */
#define NOTE_SIGNS(axis)                                                                                \
    for (uint32_t block = 0; block < b->block_count; ++block) {                                         \
        SF_ALIGNED(float) value[SF_LANES];                                                              \
        const float *x = b->coordinate[0] + block * b->width, *y = b->coordinate[1] + block * b->width; \
        for (int l = 0; l < SF_LANES; ++l) value[l] = axis(x[l]) * axis(y[l]);                          \
        b->negative[block] = 0;                                                                         \
        for (int l = 0; l < SF_LANES; ++l) b->negative[block] |= (uint32_t)(value[l] < 0) << l;         \
    }

static void apply_filter(sf_batch *b, sf_pixel_filter filter) {
    switch (filter) {
        case SF_PIXEL_FILTER_BOX: break;
        case SF_PIXEL_FILTER_TENT: PLACE(sf_pixel_tent_sample, place) break;
        case SF_PIXEL_FILTER_GAUSSIAN: PLACE(sf_pixel_gaussian_sample, 0.4f, place) break;
        case SF_PIXEL_FILTER_GAUSSIAN_TRUNCATED: PLACE(sf_pixel_gaussian_truncated_sample, 0.4f, 1.5f, place) break;
        case SF_PIXEL_FILTER_BLACKMAN_HARRIS: PLACE(sf_pixel_blackman_harris_sample, 1.5f, place) break;
        case SF_PIXEL_FILTER_MITCHELL:
            PLACE(sf_pixel_mitchell_sample, place)
            NOTE_SIGNS(sf_mitchell)
            break;
        case SF_PIXEL_FILTER_LANCZOS:
            PLACE(sf_pixel_lanczos_sample, place)
            NOTE_SIGNS(sf_lanczos)
            break;
    }
}

/* Directions through the pixels: forward + x right + y up, before they are normalized. */
static inline void aim(size_t width, sf_batch *b, const sf_camera_frame *camera) {
    const sf_camera_frame frame = *camera;
    for (size_t block = 0; block < b->block_count; ++block) {
        float left = (float)b->blocks[block].x - frame.half_width, top = frame.half_height - (float)b->blocks[block].y;
        for (size_t l = 0; l < width; ++l) {
            size_t i = block * width + l;
            float x = (left + b->coordinate[0][i]) * frame.pixel, y = (top - b->coordinate[1][i]) * frame.pixel;
            for (int c = 0; c < 3; ++c) b->direction[c][i] = frame.forward[c] + x * frame.right[c] + y * frame.up[c];
        }
    }
}

static void leave_pinhole(sf_batch *b, const sf_camera_frame *camera) {
    for (uint32_t i = 0; i < sf_batch_paths(b); ++i)
        for (int c = 0; c < 3; ++c) b->origin[c][i] = camera->position[c];
}

/* A point of the lens, and from it to where the pinhole's ray meets the focal plane. */
static void leave_lens(sf_batch *b, const sf_camera_frame *camera, float (*lens)[SF_PATHS]) {
    for (uint32_t i = 0; i < sf_batch_paths(b); ++i) {
        float disk[2];
        sf_disk_concentric_sample(lens[0][i], lens[1][i], disk);
        float x = disk[0] * camera->aperture_radius, y = disk[1] * camera->aperture_radius;
        for (int c = 0; c < 3; ++c) {
            float offset = x * camera->right[c] + y * camera->up[c];
            b->origin[c][i] = camera->position[c] + offset;
            b->direction[c][i] = camera->focus_distance * b->direction[c][i] - offset;
        }
    }
}

static void normalize_directions(sf_batch *b) {
    for (uint32_t i = 0; i < sf_batch_paths(b); ++i) {
        float x = b->direction[0][i], y = b->direction[1][i], z = b->direction[2][i];
        float scale = 1 / sqrtf(x * x + y * y + z * z);
        b->direction[0][i] = x * scale;
        b->direction[1][i] = y * scale;
        b->direction[2][i] = z * scale;
    }
}

static void camera(sf_batch *b, const sf_camera_frame *frame, sf_pixel_filter filter, float (*lens)[SF_PATHS]) {
    apply_filter(b, filter);
    SF_AT_WIDTH(b->width, aim, b, frame)
    if (lens)
        leave_lens(b, frame, lens);
    else
        leave_pinhole(b, frame);
    normalize_directions(b);
}

const sf_camera_kernels SF_AT_ISA(sf_camera_kernels) = {camera};
