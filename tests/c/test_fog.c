// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Fog: Beer and Lambert's law, single scattering against its integral along the ray, and what is refused. */

#include "scenes.h"

#define PI 3.14159265358979323846

/* At height `distance` over a camera at the origin that looks up. */
static square wall_at(float distance) { return make_square(50, distance, -1); }

static sf_camera looking_up(void) {
    sf_camera camera = camera_at(0, 0, 0, 0, 0, 1, 1e-3f); /* all of its rays are along +z */
    return camera;
}

static sf_fog fog_of(float scattering, float absorption, float g) {
    sf_fog fog = sf_fog_default();
    fog.scattering = scattering;
    fog.absorption = absorption;
    fog.g = g;
    return fog;
}

/* A wall, perhaps a sphere, and fog. */
static sf_scene *foggy_scene(const sf_mesh *wall, const sf_sphere *sphere, const sf_fog *fog, uint32_t max_bounces) {
    sf_scene *scene;
    sf_camera camera = looking_up();
    assert_ok(sf_scene_create(&scene, error));
    assert_ok(sf_scene_add_mesh(scene, wall, error));
    if (sphere) assert_ok(sf_scene_add_sphere(scene, sphere, error));
    assert_ok(sf_scene_set_fog(scene, fog, error));
    assert_ok(sf_scene_set_camera(scene, &camera, error));
    assert_ok(sf_scene_set_max_bounces(scene, max_bounces, error));
    assert_ok(sf_scene_commit(scene, error));
    return scene;
}

/* The mean of 32 x 32 independent pixels, and its standard error. */
static double measure(const sf_scene *scene, uint32_t spp, double *standard_error) {
    sf_render_options options = sf_render_options_default();
    options.width = options.height = 32;
    options.spp = spp;
    options.pattern = SF_PATTERN_RANDOM;
    sf_film *film = render(scene, &options);
    const float *color = channel_data(film, "R");
    size_t n = film_pixels(film);
    double mean = 0, square_sum = 0;
    for (size_t i = 0; i < n; ++i) mean += (double)color[3 * i] / (double)n;
    for (size_t i = 0; i < n; ++i) square_sum += ((double)color[3 * i] - mean) * ((double)color[3 * i] - mean);
    *standard_error = sqrt(square_sum / (double)(n - 1) / (double)n);
    sf_film_destroy(film);
    return mean;
}

static void test_what_is_seen_through_fog_is_beer_and_lambert_s(void **state) {
    (void)state;
    const float parts[3][2] = {{0, 0.3f}, {0.3f, 0}, {0.1f, 0.2f}}, distances[2] = {1, 7};
    for (int p = 0; p < 3; ++p)
        for (int d = 0; d < 2; ++d) {
            square corners = wall_at(distances[d]);
            sf_mesh wall = square_mesh(&corners, 0, 1);
            sf_fog fog = fog_of(parts[p][0], parts[p][1], 0);
            sf_scene *scene = foggy_scene(&wall, NULL, &fog, 0);
            double error, got = measure(scene, 128, &error), expected = exp(-0.3 * (double)distances[d]);
            assert_true(fabs(got - expected) < 5 * error);
            assert_true(error < 0.02 * expected);
            sf_scene_destroy(scene);
        }
}

/* Of a ray along z up to the wall, from a sphere of radiance 1 at (side, 0, ahead): at each height what is
 * scattered there, Henyey & Greenstein 1941, times the solid angle of the sphere and what arrives of it.
 * Simpson's rule; to the sphere's surface it is, in the mean over its cone, 2/3 of the radius less. */
static double single_scattering(const sf_fog *fog, double distance, double side, double ahead, double radius) {
    const int steps = 4096;
    double g = (double)fog->g, extinction = (double)fog->scattering + (double)fog->absorption, sum = 0;
    for (int i = 0; i <= steps; ++i) {
        double z = distance * i / steps, far = hypot(side, ahead - z), cosine = (ahead - z) / far;
        double phase = (1 - g * g) / (4 * PI * pow(1 + g * g - 2 * g * cosine, 1.5));
        double angle = 2 * PI * (1 - sqrt(1 - radius / far * (radius / far)));
        double at = (double)fog->scattering * phase * angle * exp(-extinction * (z + far - 2.0 / 3 * radius));
        sum += at * (i == 0 || i == steps ? 1 : i % 2 ? 4 : 2);
    }
    return sum * distance / steps / 3;
}

static void test_single_scattering_is_the_integral_along_the_ray(void **state) {
    (void)state;
    const float gs[3] = {0, 0.7f, -0.5f};
    square corners = wall_at(6);
    sf_mesh wall = square_mesh(&corners, 0, 0);
    sf_sphere lamp = sf_sphere_default();
    lamp.centre[0] = 1;
    lamp.centre[2] = 2;
    lamp.radius = 0.05f; /* over it phase and distance vary by 1e-3 of themselves, whose odd part cancels */
    for (int c = 0; c < 3; ++c) {
        lamp.albedo[c] = 0;
        lamp.emission[c] = 100;
    }
    for (int k = 0; k < 3; ++k) {
        sf_fog fog = fog_of(0.2f, 0.1f, gs[k]);
        sf_scene *scene = foggy_scene(&wall, &lamp, &fog, 1);
        double error, got = measure(scene, 256, &error), expected = 100 * single_scattering(&fog, 6, 1, 2, 0.05);
        assert_true(fabs(got - expected) < 5 * error + 2e-3 * expected);
        assert_true(error < 0.02 * expected);
        sf_scene_destroy(scene);
    }
}

static void test_a_fog_of_zero_is_none(void **state) {
    (void)state;
    square corners = wall_at(3);
    sf_mesh wall = square_mesh(&corners, 0.5f, 1);
    sf_fog none = sf_fog_default(), some = fog_of(0.1f, 0, 0.5f);
    sf_scene *plain = foggy_scene(&wall, NULL, NULL, 2), *zero = foggy_scene(&wall, NULL, &none, 2);
    sf_scene *foggy = foggy_scene(&wall, NULL, &some, 2);
    sf_scene_info info[3];
    sf_plan plan[3];
    sf_scene *scenes[3] = {plain, zero, foggy};
    for (int k = 0; k < 3; ++k) {
        assert_ok(sf_scene_get_info(scenes[k], &info[k], error));
        assert_ok(sf_scene_get_plan(scenes[k], &plan[k], error));
        assert_int_equal(plan[k].stages >> SF_STAGE_FOG & 1u, k == 2);
        sf_scene_destroy(scenes[k]);
    }
    assert_true(info[0].hash == info[1].hash);
    assert_true(info[0].hash != info[2].hash);
    assert_int_equal(plan[0].dimensions_per_path, plan[1].dimensions_per_path);
    assert_true(plan[2].dimensions_per_path > plan[1].dimensions_per_path);
}

static void test_bad_values_are_refused(void **state) {
    (void)state;
    const struct {
        sf_fog fog;
        const char *part;
    } cases[] = {
        {{-0.1f, 0, 0}, "scattering is -0.1"}, {{NAN, 0, 0}, "scattering is nan"},  {{2e12f, 0, 0}, "[0, 1e+12]"},
        {{0, -1, 0}, "absorption is -1"},      {{0, INFINITY, 0}, "absorption is"}, {{1, 0, 1}, "g is 1"},
        {{1, 0, -0.995f}, "[-0.99, 0.99]"},    {{1, 0, NAN}, "g is nan"},
    };
    sf_scene *scene;
    assert_ok(sf_scene_create(&scene, error));
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i)
        assert_refused(SF_STATUS_INVALID_VALUE, cases[i].part, sf_scene_set_fog(scene, &cases[i].fog, error));
    sf_scene_destroy(scene);
}

/* Until one of the two is taken away. */
static void test_fog_with_light_from_infinity_is_refused(void **state) {
    (void)state;
    square corners = wall_at(3);
    sf_mesh wall = square_mesh(&corners, 0.5f, 0);
    sf_fog fog = fog_of(0.1f, 0, 0);
    const float sky[3] = {1, 1, 1}, black[3] = {0, 0, 0};
    sf_sun sun = sf_sun_default();
    sf_scene *scene;
    assert_ok(sf_scene_create(&scene, error));
    assert_ok(sf_scene_add_mesh(scene, &wall, error));
    assert_ok(sf_scene_set_fog(scene, &fog, error));
    assert_ok(sf_scene_set_background(scene, sky, error));
    assert_refused(SF_STATUS_INVALID_VALUE, "a background", sf_scene_commit(scene, error));
    assert_ok(sf_scene_set_background(scene, black, error));
    assert_ok(sf_scene_add_sun(scene, &sun, error));
    assert_refused(SF_STATUS_INVALID_VALUE, "a sun", sf_scene_commit(scene, error));
    assert_ok(sf_scene_set_fog(scene, NULL, error));
    assert_ok(sf_scene_commit(scene, error));
    assert_refused(SF_STATUS_INVALID_VALUE, "committed", sf_scene_set_fog(scene, &fog, error));
    sf_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_what_is_seen_through_fog_is_beer_and_lambert_s),
        cmocka_unit_test(test_single_scattering_is_the_integral_along_the_ray),
        cmocka_unit_test(test_a_fog_of_zero_is_none),
        cmocka_unit_test(test_bad_values_are_refused),
        cmocka_unit_test(test_fog_with_light_from_infinity_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
