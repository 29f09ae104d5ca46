// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Spheres, disks, suns, environments and light by solid angle: the same bits however the work is
 * cut, no acne at any scale, and what is refused. */

#include "scenes.h"

static sf_sphere ball(float x, float y, float z, float radius, float albedo, float emission) {
    sf_sphere s = sf_sphere_default();
    s.centre[0] = x;
    s.centre[1] = y;
    s.centre[2] = z;
    s.radius = radius;
    for (int c = 0; c < 3; ++c) {
        s.albedo[c] = albedo;
        s.emission[c] = emission;
    }
    return s;
}

static const float sky_pixels[4 * 2 * 3] = {0, 0, 1, 2, 2, 2, 0, 1, 0, 1, 0, 0, 1, 1, 1, 0, 0, 0, 3, 2, 1, 0, 1, 2};

/* One of everything that there is to sample, under a low ceiling light. */
static sf_scene *everything(const square *floor, const square *light) {
    sf_scene *scene;
    sf_mesh meshes[2] = {square_mesh(floor, 0.7f, 0), square_mesh(light, 0.2f, 1)};
    sf_sphere spheres[2] = {ball(0.5f, 0, 0.5f, 0.5f, 0.6f, 0), ball(-0.8f, -0.5f, 0.3f, 0.2f, 0.1f, 8)};
    sf_disk disk = sf_disk_default();
    disk.centre[2] = 0.9f;
    disk.normal[0] = 1;
    disk.radius = 0.4f;
    disk.emission[1] = 3;
    sf_sun suns[2] = {sf_sun_default(), sf_sun_default()};
    suns[0].direction[1] = -1;
    suns[0].direction[2] = 1;
    suns[0].angular_radius = 10;
    suns[1].angular_radius = 0;
    sf_environment environment = sf_environment_default();
    environment.pixels = sky_pixels;
    environment.width = 4;
    environment.height = 2;
    sf_camera camera = camera_at(0, -3, 0.8f, 0, 0, 0.4f, 50);
    camera.up[1] = 0;
    camera.up[2] = 1;
    assert_ok(sf_scene_create(&scene, error));
    for (int i = 0; i < 2; ++i) {
        assert_ok(sf_scene_add_mesh(scene, &meshes[i], error));
        assert_ok(sf_scene_add_sphere(scene, &spheres[i], error));
        assert_ok(sf_scene_add_sun(scene, &suns[i], error));
    }
    assert_ok(sf_scene_add_disk(scene, &disk, error));
    assert_ok(sf_scene_set_environment(scene, &environment, error));
    assert_ok(sf_scene_set_camera(scene, &camera, error));
    assert_ok(sf_scene_set_max_bounces(scene, 3, error));
    assert_ok(sf_scene_commit(scene, error));
    return scene;
}

static sf_render_options options_for(uint32_t size, uint32_t spp) {
    sf_render_options options = sf_render_options_default();
    options.width = options.height = size;
    options.spp = spp;
    return options;
}

static void test_threads_tiles_and_crops_change_no_bit(void **state) {
    (void)state;
    square floor = make_square(5, 0, 1), light = make_square(1.5f, 1.5f, -1);
    sf_scene *scene = everything(&floor, &light);
    sf_render_options options = options_for(40, 20);
    options.threads = 1;
    sf_film *whole = render(scene, &options);
    const float *color = channel_data(whole, "R");
    options.threads = 3;
    options.tile_size = 8;
    sf_film *again = render(scene, &options);
    assert_memory_equal(color, channel_data(again, "R"), 40 * 40 * 12);
    const uint32_t crop[4] = {5, 11, 30, 23};
    memcpy(options.crop, crop, sizeof crop);
    sf_film *part = render(scene, &options);
    for (size_t y = 11; y < 23; ++y)
        assert_memory_equal((const float *)channel_data(part, "R") + (y - 11) * 25 * 3, color + (y * 40 + 5) * 3, 300);
    sf_film_destroy(whole);
    sf_film_destroy(again);
    sf_film_destroy(part);
    sf_scene_destroy(scene);
}

/* Embree's own kernels differ from level to level in the last bits, and the edge of a sphere, a
 * sun or a pixel of the sky turns that into another path: in few pixels. */
static void test_levels_agree(void **state) {
    (void)state;
    square floor = make_square(5, 0, 1), light = make_square(1.5f, 1.5f, -1);
    sf_scene *scene = everything(&floor, &light);
    sf_render_options options = options_for(32, 32);
    sf_film *best = render(scene, &options);
    for (int isa = SF_ISA_BASELINE; isa <= SF_ISA_AVX512; ++isa) {
        setenv("SUNFLECK_ISA", sf_isa_name((sf_isa)isa), 1);
        sf_film *film = render(scene, &options);
        const float *a = channel_data(best, "R"), *b = channel_data(film, "R");
        size_t different = 0;
        for (size_t i = 0; i < 3 * film_pixels(film); ++i) different += !(fabsf(a[i] - b[i]) <= 1e-4f * (1 + a[i]));
        assert_true(different < film_pixels(film) / 20);
        assert_true(fabs(film_mean(film) / film_mean(best) - 1) < 1e-3);
        sf_film_destroy(film);
    }
    unsetenv("SUNFLECK_ISA");
    sf_film_destroy(best);
    sf_scene_destroy(scene);
}

/* A white sphere in a white world is white: a ray that meets the sphere again where it left it
 * would show as dark. And from inside of a sphere nothing of the world is seen. */
static void test_spheres_have_no_acne_and_do_not_leak_at_any_scale_and_place(void **state) {
    (void)state;
    static const float scales[] = {1e-4f, 1, 1e6f}, moves[] = {0, 1e3f}; /* in radii */
    const float white[3] = {1, 1, 1};
    for (int k = 0; k < 12; ++k) {
        float radius = scales[k % 3], at = moves[k / 3 % 2] * radius;
        bool inside = k >= 6;
        sf_sphere sphere = ball(at, at, at, radius, 1, 0);
        sf_camera camera = camera_at(at + (inside ? 0.5f : 3) * radius, at, at, at, at, at, inside ? 120 : 42);
        sf_scene *scene;
        assert_ok(sf_scene_create(&scene, error));
        assert_ok(sf_scene_add_sphere(scene, &sphere, error));
        assert_ok(sf_scene_set_camera(scene, &camera, error));
        assert_ok(sf_scene_set_background(scene, white, error));
        assert_ok(sf_scene_set_max_bounces(scene, inside ? 3 : 1, error));
        assert_ok(sf_scene_commit(scene, error));
        sf_render_options options = options_for(64, 64);
        sf_film *film = render(scene, &options);
        const float *color = channel_data(film, "R");
        for (size_t i = 0; i < 3 * film_pixels(film); ++i)
            assert_true(inside ? color[i] == 0 : fabsf(color[i] - 1) < 1e-5f);
        sf_film_destroy(film);
        sf_scene_destroy(scene);
    }
}

static sf_plan plan_of(const sf_scene *scene) {
    sf_plan plan;
    assert_ok(sf_scene_get_plan(scene, &plan, error));
    return plan;
}

static void test_solid_angle_is_planned_where_a_surface_is_near_and_else_not(void **state) {
    (void)state;
    static const struct {
        float height, ratio;
        bool planned;
    } cases[] = {/* the light's diagonal is 2.83 */
                 {2.7f, 1, true},
                 {2.9f, 1, false},
                 {2.9f, 1.1f, true},
                 {0.1f, 0, false},
                 {100, INFINITY, true}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        square floor = make_square(50, 0, 1), light = make_square(1, cases[i].height, -1);
        sf_mesh meshes[2] = {square_mesh(&floor, 0.7f, 0), square_mesh(&light, 0, 1)};
        sf_scene *scene;
        assert_ok(sf_scene_create(&scene, error));
        for (int m = 0; m < 2; ++m) assert_ok(sf_scene_add_mesh(scene, &meshes[m], error));
        assert_ok(sf_scene_set_solid_angle_ratio(scene, cases[i].ratio, error));
        assert_ok(sf_scene_commit(scene, error));
        assert_int_equal(plan_of(scene).stages >> SF_STAGE_LIGHT_SHAPES & 1u, cases[i].planned);
        sf_scene_destroy(scene);
    }
}

static void test_bad_values_are_refused_by_name(void **state) {
    (void)state;
    sf_scene *scene;
    assert_ok(sf_scene_create(&scene, error));
    sf_sphere sphere = ball(0, 0, 0, 0, 0.5f, 0);
    assert_refused(SF_STATUS_INVALID_VALUE, "radius is 0", sf_scene_add_sphere(scene, &sphere, error));
    sphere = ball(0, NAN, 0, 1, 0.5f, 0);
    assert_refused(SF_STATUS_INVALID_VALUE, "sphere centre[1]", sf_scene_add_sphere(scene, &sphere, error));
    sphere = ball(0, 0, 0, 1, 1.5f, 0);
    assert_refused(SF_STATUS_INVALID_VALUE, "albedo[0] is 1.5", sf_scene_add_sphere(scene, &sphere, error));
    sf_disk disk = sf_disk_default();
    disk.normal[2] = 0;
    assert_refused(SF_STATUS_INVALID_VALUE, "no direction", sf_scene_add_disk(scene, &disk, error));
    sf_sun sun = sf_sun_default();
    sun.angular_radius = 0.001f;
    assert_refused(SF_STATUS_INVALID_VALUE, "[0.01, 89]", sf_scene_add_sun(scene, &sun, error));
    sun = sf_sun_default();
    memset(sun.irradiance, 0, sizeof sun.irradiance);
    assert_refused(SF_STATUS_INVALID_VALUE, "must shine", sf_scene_add_sun(scene, &sun, error));
    sf_environment e = sf_environment_default();
    float pixels[6] = {0, 0, 0, 0, -1, 0};
    e.pixels = pixels;
    e.width = 2;
    e.height = 1;
    assert_refused(SF_STATUS_INVALID_VALUE, "channel 1 of pixel (1, 0) is -1",
                   sf_scene_set_environment(scene, &e, error));
    pixels[4] = 0;
    assert_refused(SF_STATUS_INVALID_VALUE, "black", sf_scene_set_environment(scene, &e, error));
    assert_refused(SF_STATUS_INVALID_VALUE, "is -1", sf_scene_set_solid_angle_ratio(scene, -1, error));
    assert_refused(SF_STATUS_INVALID_VALUE, "is 7", sf_scene_set_light_sampling(scene, (sf_light_sampling)7, error));
    assert_refused(SF_STATUS_INVALID_VALUE, "no mesh, sphere or disk", sf_scene_commit(scene, error));
    sf_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_threads_tiles_and_crops_change_no_bit),
        cmocka_unit_test(test_levels_agree),
        cmocka_unit_test(test_spheres_have_no_acne_and_do_not_leak_at_any_scale_and_place),
        cmocka_unit_test(test_solid_angle_is_planned_where_a_surface_is_near_and_else_not),
        cmocka_unit_test(test_bad_values_are_refused_by_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
