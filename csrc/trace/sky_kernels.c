// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Adds the radiance of suns and the environment to rays that miss. */
#include "trace/sky_kernels.h"

#include <math.h>

#include "sunfleck/mapping.h"
#include "trace/rays.h"

/* Whether the direction w lies in the sun's cone: |w - middle|^2 is twice its depth from the pole. */
static inline bool sees_sun(const sf_sky_sun *sun, const float w[3]) {
    float x = w[0] - sun->direction[0], y = w[1] - sun->direction[1], z = w[2] - sun->direction[2];
    return (x * x + y * y) + z * z <= 2 * sun->height && sun->height > 0;
}

/* The pixel of the environment in the direction w. */
static inline const float *look_up(const sf_sky *sky, const float w[3]) {
    const sf_environment *e = &sky->environment;
    float ahead = sf_dot3(w, sky->front), aside = sf_dot3(w, sky->left), up = sf_dot3(w, sky->up);
    float longitude = sf_angle_2pi(aside, ahead), u = longitude > 0.5f ? 1.5f - longitude : 0.5f - longitude;
    float v = 2 * sf_angle_2pi(sqrtf(ahead * ahead + aside * aside), up);
    uint32_t column = (uint32_t)(u * (float)e->width), row = (uint32_t)(v * (float)e->height);
    column = column < e->width ? column : e->width - 1;
    row = row < e->height ? row : e->height - 1;
    return e->pixels + 3 * ((size_t)row * e->width + column);
}

static inline void add_scaled(float out[3], const float radiance[3], float weight) {
    for (int c = 0; c < 3; ++c) out[c] += radiance[c] * weight;
}

static void gather_sky(const sf_sky *sky, const float w[3], sf_found_share share, float pdf, float out[3]) {
    for (size_t k = 0; k < sky->sun_count; ++k)
        if (sees_sun(sky->suns + k, w))
            add_scaled(out, sky->suns[k].radiance, sf_found_weight(share, pdf, sky->suns[k].pdf));
    if (!sky->environment.pixels) return;
    const float *radiance = look_up(sky, w);
    float light_pdf = sky->pdf * ((radiance[0] + radiance[1]) + radiance[2]);
    add_scaled(out, radiance, sf_found_weight(share, pdf, light_pdf));
}

static void first(sf_batch *b, const sf_scene *scene) {
    uint32_t miss = scene->mesh_table.miss;
    for (uint32_t i = 0; i < sf_batch_paths(b); ++i) {
        if (b->mesh[i] != miss) continue;
        const float w[3] = {b->direction[0][i], b->direction[1][i], b->direction[2][i]};
        float radiance[3] = {0, 0, 0};
        gather_sky(&scene->sky, w, SF_FOUND_ALL, 1, radiance);
        for (int c = 0; c < 3; ++c) b->radiance[c][i] += radiance[c];
    }
}

static void later(sf_batch *b, const sf_scene *scene, uint32_t count) {
    uint32_t miss = scene->mesh_table.miss;
    sf_found_share share = sf_share_found(&scene->plan);
    for (uint32_t i = 0; i < count; ++i) {
        if (b->mesh[i] != miss) continue;
        const float w[3] = {b->direction[0][i], b->direction[1][i], b->direction[2][i]};
        float radiance[3] = {0, 0, 0};
        gather_sky(&scene->sky, w, share, b->pdf[i], radiance);
        for (int c = 0; c < 3; ++c) b->emission[c][i] += b->throughput[c][i] * radiance[c];
    }
}

const sf_sky_kernels SF_AT_ISA(sf_sky_kernels) = {first, later};
