// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Small scenes with known answers, for the tests of scene and render. */
#ifndef SUNFLECK_TEST_SCENES_H
#define SUNFLECK_TEST_SCENES_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sunfleck/render.h"

#define assert_ok(call)                                                        \
    do {                                                                       \
        sf_error error_ = {0};                                                 \
        sf_error *error = &error_;                                             \
        if ((call) != SF_STATUS_OK) fail_msg("%s: %s", #call, error_.message); \
    } while (0)

/* The call is refused with `code`, and the message has `part` in it. */
#define assert_refused(code, part, call)                                                        \
    do {                                                                                        \
        sf_error error_ = {0};                                                                  \
        sf_error *error = &error_;                                                              \
        assert_int_equal((call), (code));                                                       \
        assert_int_equal(error_.status, (code));                                                \
        if (!strstr(error_.message, (part))) fail_msg("'%s' lacks '%s'", error_.message, part); \
    } while (0)

static const uint32_t quad_triangles[6] = {0, 1, 2, 0, 2, 3};

/* A square of side 2 h at height z that faces up (+1) or down (-1). */
typedef struct square {
    float vertices[12];
} square;
static inline square make_square(float h, float z, int facing) {
    float f = (float)facing;
    return (square){{-h, -h * f, z, h, -h * f, z, h, h * f, z, -h, h * f, z}};
}
static inline sf_mesh square_mesh(const square *s, float albedo, float emission) {
    sf_mesh mesh = sf_mesh_default();
    mesh.vertices = s->vertices;
    mesh.vertex_count = 4;
    mesh.triangles = quad_triangles;
    mesh.triangle_count = 2;
    for (int c = 0; c < 3; ++c) {
        mesh.albedo[c] = albedo;
        mesh.emission[c] = emission;
    }
    return mesh;
}

static inline sf_camera camera_at(float x, float y, float z, float tx, float ty, float tz, float fov) {
    sf_camera camera = sf_camera_default();
    float p[3] = {x, y, z}, t[3] = {tx, ty, tz};
    memcpy(camera.position, p, sizeof p);
    memcpy(camera.target, t, sizeof t);
    camera.vertical_fov = fov;
    return camera;
}

/* A floor of albedo 0.7 under a square light of radiance 10, seen from beside the light. */
typedef struct lit_floor {
    square floor, light;
    sf_scene *scene;
} lit_floor;
static inline void lit_floor_create(lit_floor *s, uint32_t max_bounces) {
    s->floor = make_square(5, 0, 1);
    s->light = make_square(0.5f, 2, -1);
    sf_mesh floor = square_mesh(&s->floor, 0.7f, 0), light = square_mesh(&s->light, 0, 10);
    sf_camera camera = camera_at(0, -4, 1.5f, 0, 0, 0, 30);
    float up[3] = {0, 0, 1};
    memcpy(camera.up, up, sizeof up);
    assert_ok(sf_scene_create(&s->scene, error));
    assert_ok(sf_scene_add_mesh(s->scene, &floor, error));
    assert_ok(sf_scene_add_mesh(s->scene, &light, error));
    assert_ok(sf_scene_set_camera(s->scene, &camera, error));
    assert_ok(sf_scene_set_max_bounces(s->scene, max_bounces, error));
    assert_ok(sf_scene_commit(s->scene, error));
}

static inline sf_film *render(const sf_scene *scene, const sf_render_options *options) {
    sf_film *film;
    assert_ok(sf_render(scene, options, &film, error));
    return film;
}

static inline size_t film_pixels(const sf_film *film) { return (size_t)sf_film_width(film) * sf_film_height(film); }

static inline const void *channel_data(const sf_film *film, const char *name) {
    for (size_t i = 0; i < sf_film_channel_count(film); ++i)
        if (strcmp(sf_film_channel(film, i).name, name) == 0) return sf_film_channel(film, i).data;
    fail_msg("the film has no channel %s", name);
    return NULL;
}

/* Mean of (R+G+B)/3 over the film. */
static inline double film_mean(const sf_film *film) {
    const float *color = channel_data(film, "R");
    size_t n = 3 * film_pixels(film);
    double sum = 0;
    for (size_t i = 0; i < n; ++i) sum += (double)color[i];
    return sum / (double)n;
}

#endif
