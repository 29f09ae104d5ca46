// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Light from where rays miss: suns, and an environment with the table to draw from it. */

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "scene/scene_input.h"
#include "scene/scene_internal.h"
#include "sunfleck/mapping.h"

#define PI 3.14159265358979323846
#define MOST_SUNS 64
#define MOST_PIXELS 65536u

const char *sf_light_sampling_name(sf_light_sampling sampling) {
    switch (sampling) {
        case SF_LIGHT_SAMPLING_BOTH: return "both";
        case SF_LIGHT_SAMPLING_LIGHT: return "light";
        case SF_LIGHT_SAMPLING_SURFACE: return "surface";
    }
    return NULL;
}

sf_sun sf_sun_default(void) {
    return (sf_sun){.direction = {0, 1, 0}, .angular_radius = 0.265f, .irradiance = {1, 1, 1}};
}

sf_environment sf_environment_default(void) { return (sf_environment){.up = {0, 1, 0}}; }

static sf_status check_direction(const char *what, const float v[3], sf_error *error) {
    sf_status status = sf_scene_check_vector(what, v, error);
    if (!status && !(fabsf(v[0]) + fabsf(v[1]) + fabsf(v[2]) > 1e-15f))
        status = sf_fail(error, SF_STATUS_INVALID_VALUE, "%s is (%g, %g, %g), which is no direction", what,
                         (double)v[0], (double)v[1], (double)v[2]);
    return status;
}

sf_status sf_scene_add_sun(sf_scene *scene, const sf_sun *sun, sf_error *error) {
    sf_status status = sf_scene_refuse_committed(scene, error);
    if (!status) status = check_direction("sun direction", sun->direction, error);
    if (!status) status = sf_scene_check_color("sun irradiance", sun->irradiance, SF_RADIANCE_LIMIT, error);
    if (status) return status;
    if (!(sun->angular_radius == 0 || (sun->angular_radius >= 0.01f && sun->angular_radius <= 89)))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "angular_radius is %g degrees; it must be 0 or in [0.01, 89]",
                       (double)sun->angular_radius);
    if (!(sun->irradiance[0] + sun->irradiance[1] + sun->irradiance[2] > 0))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "sun irradiance is 0; a sun must shine");
    if (scene->info.sun_count == MOST_SUNS)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "the scene has %d suns; there may be no more", MOST_SUNS);
    if (!scene->suns) scene->suns = malloc(MOST_SUNS * sizeof *scene->suns);
    if (!scene->suns) return sf_fail_memory(error, "the suns", MOST_SUNS * sizeof *scene->suns);
    scene->suns[scene->info.sun_count++] = *sun;
    return SF_STATUS_OK;
}

static sf_status check_pixels(const sf_environment *e, sf_error *error) {
    bool bright = false;
    for (size_t i = 0; i < (size_t)e->width * e->height * 3; ++i) {
        if (!(e->pixels[i] >= 0 && e->pixels[i] <= SF_RADIANCE_LIMIT))
            return sf_fail(error, SF_STATUS_INVALID_VALUE,
                           "environment: channel %zu of pixel (%zu, %zu) is %g; it must be in [0, %g]", i % 3,
                           i / 3 % e->width, i / 3 / e->width, (double)e->pixels[i], (double)SF_RADIANCE_LIMIT);
        bright |= e->pixels[i] > 0;
    }
    if (!bright) return sf_fail(error, SF_STATUS_INVALID_VALUE, "environment: all of it is black; leave it out");
    return SF_STATUS_OK;
}

sf_status sf_scene_set_environment(sf_scene *scene, const sf_environment *environment, sf_error *error) {
    sf_status status = sf_scene_refuse_committed(scene, error);
    if (status) return status;
    const sf_environment *e = environment;
    if (!e || !e->pixels) {
        memset(&scene->environment, 0, sizeof scene->environment);
        return SF_STATUS_OK;
    }
    if (e->width < 1 || e->width > MOST_PIXELS || e->height < 1 || e->height > MOST_PIXELS)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "environment: %u x %u pixels; each must be 1 .. %u", e->width,
                       e->height, MOST_PIXELS);
    if (!(fabsf(e->rotation) <= 1e6f))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "rotation is %g; it must be finite and at most 1e6 in size",
                       (double)e->rotation);
    status = check_direction("environment up", e->up, error);
    if (!status) status = check_pixels(e, error);
    if (!status) scene->environment = *e;
    return status;
}

/* ---- at commit ---- */

static void normalize(const double v[3], double out[3]) {
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int c = 0; c < 3; ++c) out[c] = v[c] / length;
}

/* The frame of the environment: up, longitude 0 and 90 degrees, turned by its rotation. */
static void frame_environment(sf_sky *sky) {
    const sf_environment *e = &sky->environment;
    double given[3] = {(double)e->up[0], (double)e->up[1], (double)e->up[2]}, up[3], front[3], left[3];
    normalize(given, up);
    bool along_z = up[0] * up[0] + up[1] * up[1] < 1e-6;
    double reference[3] = {along_z, 0, !along_z}, along = along_z ? up[0] : up[2];
    for (int c = 0; c < 3; ++c) reference[c] -= along * up[c];
    normalize(reference, front);
    for (int c = 0; c < 3; ++c) left[c] = up[(c + 1) % 3] * front[(c + 2) % 3] - up[(c + 2) % 3] * front[(c + 1) % 3];
    double turn = fmod((double)e->rotation, 360) * (PI / 180), cosine = cos(turn), sine = sin(turn);
    for (int c = 0; c < 3; ++c) {
        sky->up[c] = (float)up[c];
        sky->front[c] = (float)(cosine * front[c] + sine * left[c]);
        sky->left[c] = (float)(cosine * left[c] - sine * front[c]);
    }
}

/* The table, whose weights are pixel by pixel R + G + B times the solid angle. */
static sf_status tabulate_environment(sf_sky *sky, sf_error *error) {
    const sf_environment *e = &sky->environment;
    size_t columns = e->width, rows = e->height;
    sky->edges = malloc((rows + 1) * sizeof *sky->edges);
    double *weights = malloc(columns * rows * sizeof *weights);
    if (!sky->edges || !weights) {
        free(weights);
        return sf_fail_memory(error, "the environment's table", columns * rows * sizeof *weights);
    }
    for (size_t r = 0; r <= rows; ++r) sky->edges[r] = cos(PI * (double)r / (double)rows);
    double squares = 0;
    sky->total = 0;
    for (size_t r = 0; r < rows; ++r) {
        double angle = 2 * PI * (sky->edges[r] - sky->edges[r + 1]) / (double)columns;
        for (size_t i = r * columns; i < (r + 1) * columns; ++i) {
            const float *p = e->pixels + 3 * i;
            weights[i] = ((double)p[0] + p[1] + p[2]) * angle;
            sky->total += weights[i];
            squares += weights[i] * weights[i] / angle;
        }
    }
    sky->spread = sky->total * sky->total / (4 * PI * squares);
    sf_status status = sf_piecewise_create_2d(weights, columns, rows, &sky->table, NULL, error);
    free(weights);
    return status;
}

/* A sun of angle 0 has its irradiance for radiance, and no cone. */
static sf_sky_sun sky_sun_of(const sf_sun *sun) {
    sf_sky_sun out = {.height = 0};
    double given[3] = {(double)sun->direction[0], (double)sun->direction[1], (double)sun->direction[2]}, unit[3];
    normalize(given, unit);
    double half = 0.5 * (double)sun->angular_radius * (PI / 180), sine = sin(2 * half);
    out.height = (float)(2 * sin(half) * sin(half));
    double scale = sun->angular_radius > 0 ? 1 / (PI * sine * sine) : 1;
    for (int c = 0; c < 3; ++c) {
        out.direction[c] = (float)unit[c];
        out.radiance[c] = (float)((double)sun->irradiance[c] * scale);
    }
    return out;
}

sf_status sf_sky_build(sf_scene *scene, sf_error *error) {
    sf_sky *sky = &scene->sky;
    const sf_scene_info *info = &scene->info;
    double diagonal = 0;
    for (int c = 0; c < 3; ++c) diagonal += pow((double)info->bounds_upper[c] - info->bounds_lower[c], 2);
    sky->far = diagonal > 0 ? (float)(2 * sqrt(diagonal)) : 1;
    if (info->sun_count) {
        sky->suns = malloc(info->sun_count * sizeof *sky->suns);
        if (!sky->suns) return sf_fail_memory(error, "the suns", info->sun_count * sizeof *sky->suns);
        for (size_t i = 0; i < info->sun_count; ++i) sky->suns[i] = sky_sun_of(scene->suns + i);
        sky->sun_count = info->sun_count;
    }
    sky->environment = scene->environment;
    if (!sky->environment.pixels) return SF_STATUS_OK;
    frame_environment(sky);
    return tabulate_environment(sky, error);
}

void sf_sky_free(sf_sky *sky) {
    free(sky->suns);
    free(sky->edges);
    sf_piecewise_destroy(sky->table);
    memset(sky, 0, sizeof *sky);
}
