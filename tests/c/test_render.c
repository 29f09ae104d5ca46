// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Radiance against closed forms. Where a tolerance is statistical it is a number of standard
 * errors that the film itself reports: 5 of them are exceeded once in 1.7 million. */
#include "scenes.h"

#include "base/page_cache.h"
#include "film/pixel.h"
#include "trace/batch.h"
#include "trace/gather_kernels.h"

#define PI 3.14159265358979323846

static sf_render_options options_for(uint32_t size, uint32_t spp) {
    sf_render_options options = sf_render_options_default();
    options.width = options.height = size;
    options.spp = spp;
    options.threads = 2;
    return options;
}

/* Standard error of the film's mean, its pixels being independent. */
static double mean_error(const sf_film *film, double z) {
    const float *half_width = channel_data(film, "half_width");
    double sum = 0;
    for (size_t i = 0; i < film_pixels(film); ++i) sum += (double)half_width[i] * (double)half_width[i];
    return sqrt(sum) / z / (double)film_pixels(film);
}

static void assert_same_channels(const sf_film *a, const sf_film *b) {
    assert_int_equal(sf_film_width(a), sf_film_width(b));
    assert_int_equal(sf_film_height(a), sf_film_height(b));
    size_t pixels = film_pixels(a);
    assert_memory_equal(channel_data(a, "R"), channel_data(b, "R"), pixels * 12);
    assert_memory_equal(channel_data(a, "A"), channel_data(b, "A"), pixels * 4);
    assert_memory_equal(channel_data(a, "samples"), channel_data(b, "samples"), pixels * 4);
    assert_memory_equal(channel_data(a, "half_width"), channel_data(b, "half_width"), pixels * 4);
    assert_memory_equal(channel_data(a, "stop_reason"), channel_data(b, "stop_reason"), pixels);
}

/* ---- closed forms ---- */

/* Share of the cosine-weighted hemisphere above a point that the rectangle [0,a] x [0,b] at
 * height h takes up, the point being below its corner (Siegel & Howell, configuration 4 of
 * their appendix of view factors). Odd in a and in b, so that corners add up to any rectangle. */
static double corner_view_factor(double a, double b, double h) {
    double x = a / h, y = b / h, p = sqrt(1 + x * x), q = sqrt(1 + y * y);
    return (x / p * atan(y / p) + y / q * atan(x / q)) / (2 * PI);
}

/* Radiance of the floor of lit_floor at (x, y): albedo times light times view factor. */
static double lit_floor_radiance(double x, double y) {
    const double h = 0.5, z = 2;
    double f = corner_view_factor(h - x, h - y, z) - corner_view_factor(-h - x, h - y, z) -
               corner_view_factor(h - x, -h - y, z) + corner_view_factor(-h - x, -h - y, z);
    return 0.7 * 10 * f;
}

/* A camera whose rays all meet the same point of the floor, to a float's last bit. */
static sf_camera spot_camera(float x, float y) {
    sf_camera camera = camera_at(0, -4, 1.5f, x, y, 0, 1e-9f);
    camera.up[1] = 0;
    camera.up[2] = 1;
    return camera;
}

static sf_scene *spot_scene(lit_floor *s, float x, float y, uint32_t max_bounces) {
    sf_scene *scene;
    sf_mesh floor = square_mesh(&s->floor, 0.7f, 0), light = square_mesh(&s->light, 0, 10);
    sf_camera camera = spot_camera(x, y);
    assert_ok(sf_scene_create(&scene, error));
    assert_ok(sf_scene_add_mesh(scene, &floor, error));
    assert_ok(sf_scene_add_mesh(scene, &light, error));
    assert_ok(sf_scene_set_camera(scene, &camera, error));
    assert_ok(sf_scene_set_max_bounces(scene, max_bounces, error));
    assert_ok(sf_scene_commit(scene, error));
    return scene;
}

static void test_floor_under_a_rectangle_light_has_its_analytic_radiance(void **state) {
    (void)state;
    static const float places[][2] = {{0, 0}, {0.8f, -0.3f}, {-1.5f, 1.2f}};
    static const sf_pattern patterns[] = {SF_PATTERN_UNIFORM, SF_PATTERN_RANDOM, SF_PATTERN_JITTERED, SF_PATTERN_HALTON,
                                          SF_PATTERN_SOBOL};
    lit_floor s = {make_square(5, 0, 1), make_square(0.5f, 2, -1), NULL};
    for (int i = 0; i < 3; ++i)
        for (size_t p = 0; p < sizeof patterns / sizeof *patterns; ++p) {
            sf_scene *scene = spot_scene(&s, places[i][0], places[i][1], 1);
            sf_render_options options = options_for(16, 256);
            options.pattern = patterns[p];
            sf_film *film = render(scene, &options);
            double expected = lit_floor_radiance((double)places[i][0], (double)places[i][1]);
            double bound = 5 * mean_error(film, 1.959963985) + 1e-5 * expected;
            assert_true(fabs(film_mean(film) - expected) < bound);
            sf_film_destroy(film);
            sf_scene_destroy(scene);
        }
}

static void test_weighting_light_with_surface_rays_leaves_the_radiance(void **state) {
    (void)state; /* with 2 bounces the first vertex has both kinds of ray, and the light, being
                    black, ends the path */
    lit_floor s = {make_square(5, 0, 1), make_square(0.5f, 2, -1), NULL};
    sf_scene *scene = spot_scene(&s, 0.4f, 0.1f, 2);
    sf_plan plan;
    assert_ok(sf_scene_get_plan(scene, &plan, error));
    assert_true(plan.stages >> SF_STAGE_WEIGHT & 1u);
    sf_render_options options = options_for(32, 256);
    options.pattern = SF_PATTERN_RANDOM;
    sf_film *film = render(scene, &options);
    double expected = lit_floor_radiance((double)0.4f, (double)0.1f);
    assert_true(mean_error(film, 1.959963985) < 0.002 * expected);
    assert_true(fabs(film_mean(film) - expected) < 5 * mean_error(film, 1.959963985));
    sf_film_destroy(film);
    sf_scene_destroy(scene);
}

/* The inside of a cube of side 2, all walls with the same albedo and emission. */
static sf_scene *furnace(float albedo, float emission, uint32_t max_bounces) {
    static const float corners[24] = {-1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1,
                                      -1, -1, 1,  1, -1, 1,  1, 1, 1,  -1, 1, 1};
    static const uint32_t walls[36] = {0, 1, 2, 0, 2, 3, 4, 7, 6, 4, 6, 5, 0, 4, 5, 0, 5, 1,
                                       1, 5, 6, 1, 6, 2, 2, 6, 7, 2, 7, 3, 3, 7, 4, 3, 4, 0};
    sf_mesh mesh = sf_mesh_default();
    mesh.vertices = corners;
    mesh.vertex_count = 8;
    mesh.triangles = walls;
    mesh.triangle_count = 12;
    for (int c = 0; c < 3; ++c) {
        mesh.albedo[c] = albedo;
        mesh.emission[c] = emission;
    }
    sf_camera camera = camera_at(0.1f, -0.2f, 0.3f, 1, 0.4f, -0.1f, 60);
    sf_scene *scene;
    assert_ok(sf_scene_create(&scene, error));
    assert_ok(sf_scene_add_mesh(scene, &mesh, error));
    assert_ok(sf_scene_set_camera(scene, &camera, error));
    assert_ok(sf_scene_set_max_bounces(scene, max_bounces, error));
    assert_ok(sf_scene_commit(scene, error));
    return scene;
}

static void test_furnace_sums_the_geometric_series(void **state) {
    (void)state;
    double expected = 0;
    for (uint32_t bounces = 0; bounces <= 4; ++bounces) {
        expected += pow(0.5, bounces); /* emission 1, albedo 1/2 */
        for (int sobol = 0; sobol < 2; ++sobol) {
            sf_scene *scene = furnace(0.5f, 1, bounces);
            sf_render_options options = options_for(32, 256);
            options.pattern = sobol ? SF_PATTERN_SOBOL : SF_PATTERN_RANDOM;
            options.seed = 3;
            sf_film *film = render(scene, &options);
            /* The last vertex has shadow rays only, whose variance near an edge is infinite; a
             * bounce that went missing would be 2^-bounces. */
            double bound = 5 * mean_error(film, 1.959963985) + 1e-6;
            assert_true(bound < (bounces == 1 ? 0.2 : 0.01) * expected);
            assert_true(fabs(film_mean(film) - expected) < bound);
            sf_film_destroy(film);
            sf_scene_destroy(scene);
        }
    }
}

static void test_background_lights_a_lone_floor_by_its_albedo(void **state) {
    (void)state; /* a plane sees half the sky and nothing of itself: radiance = albedo x sky, exactly
                    by cosine-weighted directions, whatever the number of bounces */
    square ground = make_square(1e4f, 0, 1);
    sf_mesh mesh = square_mesh(&ground, 0.3f, 0);
    sf_camera camera = camera_at(0, -4, 4, 0, 0, 0, 40);
    const float sky[3] = {2, 1, 0.5f};
    camera.up[2] = 1;
    for (uint32_t bounces = 1; bounces <= 3; bounces += 2) {
        sf_scene *scene;
        assert_ok(sf_scene_create(&scene, error));
        assert_ok(sf_scene_add_mesh(scene, &mesh, error));
        assert_ok(sf_scene_set_camera(scene, &camera, error));
        assert_ok(sf_scene_set_background(scene, sky, error));
        assert_ok(sf_scene_set_max_bounces(scene, bounces, error));
        assert_ok(sf_scene_commit(scene, error));
        sf_render_options options = options_for(16, 32);
        sf_film *film = render(scene, &options);
        const float *color = channel_data(film, "R");
        for (size_t i = 0; i < 3 * film_pixels(film); ++i) assert_true(fabsf(color[i] - 0.3f * sky[i % 3]) < 1e-5f);
        sf_film_destroy(film);
        sf_scene_destroy(scene);
    }
}

static void test_every_filter_and_lens_keeps_a_constant_image(void **state) {
    (void)state;
    square behind = make_square(1, -10, 1);
    sf_mesh mesh = square_mesh(&behind, 0.5f, 0);
    const float sky[3] = {0.25f, 0.5f, 3};
    for (int lens = 0; lens < 2; ++lens)
        for (sf_pixel_filter filter = SF_PIXEL_FILTER_BOX; sf_pixel_filter_name(filter); ++filter) {
            sf_camera camera = camera_at(0, 0, 1, 0, 0, 2, 40); /* looks away */
            camera.aperture_radius = lens ? 0.1f : 0;
            sf_scene *scene;
            assert_ok(sf_scene_create(&scene, error));
            assert_ok(sf_scene_add_mesh(scene, &mesh, error));
            assert_ok(sf_scene_set_camera(scene, &camera, error));
            assert_ok(sf_scene_set_background(scene, sky, error));
            assert_ok(sf_scene_commit(scene, error));
            const uint32_t counts[] = {1, 3, 16, 100};
            for (int k = 0; k < 4; ++k) {
                sf_render_options options = options_for(13, counts[k]);
                options.pixel_filter = filter;
                sf_film *film = render(scene, &options);
                const float *color = channel_data(film, "R"), *alpha = channel_data(film, "A");
                for (size_t i = 0; i < film_pixels(film); ++i) {
                    assert_memory_equal(color + 3 * i, sky, sizeof sky);
                    assert_true(alpha[i] == 0);
                }
                sf_film_destroy(film);
            }
            sf_scene_destroy(scene);
        }
}

/* ---- camera ---- */

/* A glowing square of half-side h at (x, y, 0), facing a camera at (0, 0, 10). */
static sf_film *render_square(float x, float y, float h, const sf_camera *camera, uint32_t size, uint32_t spp) {
    square s = make_square(h, 0, 1);
    for (int v = 0; v < 4; ++v) {
        s.vertices[3 * v] += x;
        s.vertices[3 * v + 1] += y;
    }
    sf_mesh mesh = square_mesh(&s, 0, 1);
    sf_scene *scene;
    assert_ok(sf_scene_create(&scene, error));
    assert_ok(sf_scene_add_mesh(scene, &mesh, error));
    assert_ok(sf_scene_set_camera(scene, camera, error));
    assert_ok(sf_scene_set_max_bounces(scene, 0, error));
    assert_ok(sf_scene_commit(scene, error));
    sf_render_options options = options_for(size, spp);
    sf_film *film = render(scene, &options);
    sf_scene_destroy(scene);
    return film;
}

static void test_row_0_is_the_top_and_right_is_forward_cross_up(void **state) {
    (void)state;
    sf_camera camera = camera_at(0, 0, 10, 0, 0, 0, 40); /* up is +y, forward -z, right +x */
    sf_film *film = render_square(1.5f, 2, 0.5f, &camera, 16, 4);
    const float *alpha = channel_data(film, "A");
    double x = 0, y = 0, sum = 0, scale = 8 / (10 * tan(20 * PI / 180)); /* pixels per unit at z = 0 */
    for (int i = 0; i < 256; ++i) {
        x += (double)alpha[i] * (i % 16 + 0.5);
        y += (double)alpha[i] * (i / 16 + 0.5);
        sum += (double)alpha[i];
    }
    /* Borders are known to the samples' own spacing, a quarter of a pixel. */
    assert_true(fabs(x / sum - (8 + 1.5 * scale)) < 0.25);
    assert_true(fabs(y / sum - (8 - 2 * scale)) < 0.25);
    assert_true(fabs(sqrt(sum) - scale) < 0.5);
    sf_film_destroy(film);
}

static size_t partly_covered(const sf_film *film) {
    const float *alpha = channel_data(film, "A");
    size_t count = 0;
    for (size_t i = 0; i < film_pixels(film); ++i) count += alpha[i] > 0 && alpha[i] < 1;
    return count;
}

static void test_lens_is_sharp_in_its_focal_plane_and_blurs_by_the_circle_of_confusion(void **state) {
    (void)state;
    enum { SIZE = 64 };
    sf_camera camera = camera_at(0, 0, 10, 0, 0, 0, 40);
    double scale = SIZE / 2 / (10 * tan(20 * PI / 180));
    camera.aperture_radius = 1;
    sf_film *sharp = render_square(0, 0, (float)(16 / scale), &camera, SIZE, 64); /* borders on pixels' */
    assert_true(partly_covered(sharp) <= 4 * 33); /* rounding may touch one row of pixels */
    camera.focus_distance = 5;
    /* A point at 10 is spread over a disk of radius aperture x (10 - 5) / 5 in its own plane. */
    double radius = 1.0 * (10 - 5) / 5 * scale;
    sf_film *blurred = render_square(0, 0, (float)(16 / scale), &camera, SIZE, 64);
    const float *alpha = channel_data(blurred, "A");
    double sum = 0, sharp_sum = 0;
    const float *sharp_alpha = channel_data(sharp, "A");
    for (int i = 0; i < SIZE * SIZE; ++i) {
        double x = fabs(i % SIZE + 0.5 - SIZE / 2), y = fabs(i / SIZE + 0.5 - SIZE / 2);
        if ((x > y ? x : y) > 16 + radius + 1) assert_true(alpha[i] == 0);
        if ((x > y ? x : y) < 16 - radius - 1) assert_true(alpha[i] == 1);
        sum += (double)alpha[i];
        sharp_sum += (double)sharp_alpha[i];
    }
    /* The edge's middle is half covered, and blurring keeps the total. */
    assert_true(fabs((double)alpha[SIZE / 2 * SIZE + 15] + (double)alpha[SIZE / 2 * SIZE + 16] - 1) < 0.1);
    assert_true(fabs(sum - sharp_sum) < 0.01 * sharp_sum);
    sf_film_destroy(sharp);
    sf_film_destroy(blurred);
}

static void test_alpha_is_the_share_of_samples_that_hit(void **state) {
    (void)state;
    sf_camera camera = camera_at(0, 0, 10, 0, 0, 0, 40);
    sf_film *film = render_square(0, 0, 1, &camera, 5, 1024);
    const float *alpha = channel_data(film, "A");
    double sum = 0, scale = 2.5 / (10 * tan(20 * PI / 180));
    for (int i = 0; i < 25; ++i) sum += (double)alpha[i];
    assert_true(fabs(sum - 4 * scale * scale) < 0.002); /* 1,024 points of a net: error below 1/512 a pixel */
    sf_film_destroy(film);
}

/* ---- the same bits ---- */

static void test_threads_and_tiles_change_no_bit(void **state) {
    (void)state;
    lit_floor s;
    lit_floor_create(&s, 3);
    for (int adaptive = 0; adaptive < 2; ++adaptive) {
        sf_render_options options = options_for(50, adaptive ? 0 : 20);
        options.relative_tolerance = adaptive ? 0.1 : 0;
        options.threads = 1;
        sf_film *first = render(s.scene, &options);
        static const uint32_t threads[] = {1, 2, 3}, tiles[] = {8, 16, 64};
        for (int i = 0; i < 9; ++i) {
            options.threads = threads[i / 3];
            options.tile_size = tiles[i % 3];
            sf_film *film = render(s.scene, &options);
            assert_same_channels(first, film);
            sf_film_destroy(film);
        }
        sf_film_destroy(first);
    }
    sf_scene_destroy(s.scene);
}

static void test_crop_has_the_full_frames_bits(void **state) {
    (void)state;
    static const uint32_t crops[][4] = {{0, 0, 8, 8}, {5, 3, 29, 17}, {49, 49, 50, 50}, {13, 0, 14, 50}};
    lit_floor s;
    lit_floor_create(&s, 2);
    for (int adaptive = 0; adaptive < 2; ++adaptive) {
        sf_render_options options = options_for(50, adaptive ? 0 : 20);
        options.absolute_tolerance = adaptive ? 0.02 : 0;
        sf_film *full = render(s.scene, &options);
        const float *whole = channel_data(full, "R");
        for (int i = 0; i < 4; ++i) {
            memcpy(options.crop, crops[i], sizeof options.crop);
            sf_film *film = render(s.scene, &options);
            const float *part = channel_data(film, "R");
            uint32_t width = crops[i][2] - crops[i][0];
            assert_int_equal(sf_film_width(film), width);
            for (uint32_t y = crops[i][1]; y < crops[i][3]; ++y)
                assert_memory_equal(part + (size_t)(y - crops[i][1]) * width * 3, whole + (y * 50 + crops[i][0]) * 3,
                                    width * 12);
            sf_film_destroy(film);
        }
        sf_film_destroy(full);
    }
    sf_scene_destroy(s.scene);
}

static void test_a_count_reached_in_more_rounds_is_the_same_film(void **state) {
    (void)state; /* the clock makes rounds shorter; the samples are the same */
    lit_floor s;
    lit_floor_create(&s, 2);
    sf_render_options options = options_for(24, 150);
    sf_film *once = render(s.scene, &options);
    options.seconds = 1000;
    sf_film *rounds = render(s.scene, &options);
    assert_true(sf_film_summarize(rounds).rounds > sf_film_summarize(once).rounds);
    assert_same_channels(once, rounds);
    sf_film_destroy(once);
    sf_film_destroy(rounds);
    sf_scene_destroy(s.scene);
}

static void test_levels_agree(void **state) {
    (void)state; /* Embree's own kernels differ from level to level, in the last bits */
    lit_floor s;
    lit_floor_create(&s, 2);
    sf_render_options options = options_for(32, 64);
    sf_film *best = render(s.scene, &options);
    for (int isa = SF_ISA_BASELINE; isa <= SF_ISA_AVX512; ++isa) {
        setenv("SUNFLECK_ISA", sf_isa_name((sf_isa)isa), 1);
        sf_film *film = render(s.scene, &options);
        const float *a = channel_data(best, "R"), *b = channel_data(film, "R");
        for (size_t i = 0; i < 3 * film_pixels(film); ++i) assert_true(fabsf(a[i] - b[i]) <= 1e-4f * (1 + a[i]));
        sf_film_destroy(film);
    }
    unsetenv("SUNFLECK_ISA");
    sf_film_destroy(best);
    sf_scene_destroy(s.scene);
}

/* ---- seeds ---- */

static int compare_floats(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Pixels whose red equals another's to the last bit. */
static size_t repeated_pixels(const sf_film *film) {
    size_t pixels = film_pixels(film), repeated = 0;
    const float *color = channel_data(film, "R");
    float *red = malloc(pixels * sizeof *red);
    assert_non_null(red);
    for (size_t i = 0; i < pixels; ++i) red[i] = color[3 * i];
    qsort(red, pixels, sizeof *red, compare_floats);
    for (size_t i = 1; i < pixels; ++i) repeated += red[i] == red[i - 1];
    free(red);
    return repeated;
}

static void test_shared_seeds_repeat_the_noise_of_other_threads_and_others_do_not(void **state) {
    (void)state;
    enum { SIZE = 256 };
    lit_floor s = {make_square(5, 0, 1), make_square(0.5f, 2, -1), NULL};
    sf_scene *scene = spot_scene(&s, 0.4f, 0.1f, 1); /* every pixel sees the same place: only seeds differ */
    sf_render_options options = options_for(SIZE, 16);
    options.pattern = SF_PATTERN_RANDOM;
    options.tile_size = 8;
    /* 65,536 means of 16 spread over some 10^6 floats: a thousand meet by chance. Two threads that
     * draw alike repeat as many pixels as the slower of them made, up to half. */
    size_t repeated[3];
    for (int policy = SF_SEEDS_PIXEL; policy <= SF_SEEDS_SHARED; ++policy) {
        options.seeds = (sf_seed_policy)policy;
        sf_film *film = render(scene, &options);
        repeated[policy] = repeated_pixels(film);
        sf_film_destroy(film);
    }
    assert_true(repeated[SF_SEEDS_PIXEL] < SIZE * SIZE / 16);
    assert_true(repeated[SF_SEEDS_THREAD] < SIZE * SIZE / 16);
    assert_true(repeated[SF_SEEDS_SHARED] > SIZE * SIZE / 8);
    sf_scene_destroy(scene);
}

static void test_another_seed_is_another_noise_about_the_same_mean(void **state) {
    (void)state;
    lit_floor s;
    lit_floor_create(&s, 1);
    sf_render_options options = options_for(32, 64);
    options.pattern = SF_PATTERN_RANDOM;
    sf_film *a = render(s.scene, &options);
    options.seed = UINT64_MAX;
    sf_film *b = render(s.scene, &options);
    assert_int_not_equal(memcmp(channel_data(a, "R"), channel_data(b, "R"), film_pixels(a) * 12), 0);
    assert_true(fabs(film_mean(a) - film_mean(b)) < 5 * sqrt(2) * mean_error(a, 1.959963985));
    sf_film_destroy(a);
    sf_film_destroy(b);
    sf_scene_destroy(s.scene);
}

/* ---- accuracy and stopping ---- */

static void test_half_widths_of_independent_samples_cover_the_truth(void **state) {
    (void)state;
    lit_floor s = {make_square(5, 0, 1), make_square(0.5f, 2, -1), NULL};
    sf_scene *scene = spot_scene(&s, 0.4f, 0.1f, 1);
    sf_render_options options = options_for(64, 64);
    options.pattern = SF_PATTERN_RANDOM;
    options.stop = SF_STOP_RULE_STANDARD_ERROR;
    double expected = lit_floor_radiance((double)0.4f, (double)0.1f);
    static const double confidences[] = {0.5, 0.95, 0.99};
    for (int i = 0; i < 3; ++i) {
        options.confidence = confidences[i];
        options.seed = (uint64_t)i;
        sf_film *film = render(scene, &options);
        const float *color = channel_data(film, "R"), *half_width = channel_data(film, "half_width");
        size_t covered = 0, pixels = film_pixels(film);
        for (size_t k = 0; k < pixels; ++k) covered += fabs((double)color[3 * k] - expected) <= (double)half_width[k];
        /* Five standard errors of a share of 4,096, and 1 % for s of 64 samples in place of sigma. */
        double share = (double)covered / (double)pixels, p = confidences[i];
        assert_true(fabs(share - p) < 5 * sqrt(p * (1 - p) / (double)pixels) + 0.01);
        sf_film_destroy(film);
    }
    sf_scene_destroy(scene);
}

static void test_adaptive_pixels_say_why_they_stopped(void **state) {
    (void)state;
    lit_floor s;
    lit_floor_create(&s, 1);
    sf_render_options options = options_for(64, 0);
    options.relative_tolerance = 0.02;
    options.stop = SF_STOP_RULE_STANDARD_ERROR;
    options.min_spp = 48;
    options.max_spp = 500;
    sf_film *film = render(s.scene, &options);
    sf_film_summary summary = sf_film_summarize(film);
    const float *half_width = channel_data(film, "half_width");
    const uint32_t *samples = channel_data(film, "samples");
    const uint8_t *reason = channel_data(film, "stop_reason");
    uint64_t counted[SF_STOP_REASON_COUNT] = {0}, total = 0;
    for (size_t i = 0; i < film_pixels(film); ++i) {
        ++counted[reason[i]];
        total += samples[i];
        assert_in_range(samples[i], 48, 500);
        if (reason[i] == SF_STOP_REASON_MET) assert_true((double)half_width[i] <= summary.tolerance);
        if (reason[i] == SF_STOP_REASON_MAX_SAMPLES) {
            assert_int_equal(samples[i], 500);
            assert_true((double)half_width[i] > summary.tolerance);
        }
    }
    assert_true(counted[SF_STOP_REASON_MET] > 0 && counted[SF_STOP_REASON_MAX_SAMPLES] > 0);
    assert_int_equal(counted[SF_STOP_REASON_MET] + counted[SF_STOP_REASON_MAX_SAMPLES], film_pixels(film));
    assert_memory_equal(counted, summary.reasons, sizeof counted);
    assert_true(total == summary.samples && total == summary.traced_samples);
    assert_true(summary.tolerance == 0.02 * summary.level);
    sf_film_destroy(film);
    sf_scene_destroy(s.scene);
}

static void test_black_scene_stops_at_the_minimum(void **state) {
    (void)state;
    square ground = make_square(1, 0, 1);
    sf_mesh mesh = square_mesh(&ground, 0.5f, 0);
    sf_camera camera = camera_at(0, -1, 3, 0, 0, 0, 40);
    sf_scene *scene;
    assert_ok(sf_scene_create(&scene, error));
    assert_ok(sf_scene_add_mesh(scene, &mesh, error));
    assert_ok(sf_scene_set_camera(scene, &camera, error));
    assert_ok(sf_scene_commit(scene, error));
    sf_render_options options = options_for(16, 0);
    sf_film *film = render(scene, &options);
    sf_film_summary summary = sf_film_summarize(film);
    assert_int_equal(summary.reasons[SF_STOP_REASON_MET], 256);
    assert_int_equal(summary.samples, 256 * options.min_spp);
    assert_true(film_mean(film) == 0 && summary.level == 0);
    sf_film_destroy(film);
    sf_scene_destroy(scene);
}

static void test_samples_that_are_not_finite_are_counted_and_left_out(void **state) {
    (void)state; /* scenes are bounded so that none should arise; the film is not to trust that */
    sf_batch *batch = sf_aligned_alloc(sizeof *batch);
    assert_non_null(batch);
    for (int isa = SF_ISA_BASELINE; isa <= (int)sf_isa_active(); ++isa) {
        memset(batch, 0, sizeof *batch);
        batch->block_count = 2;
        batch->width = SF_LANES;
        for (uint32_t i = 0; i < 2 * SF_LANES; ++i)
            for (int c = 0; c < 3; ++c) batch->radiance[c][i] = (float)(c + 1);
        batch->blocks[0].active = 0xffff;
        batch->blocks[1].active = 0x00ff;
        batch->radiance[0][3] = NAN;
        batch->radiance[1][5] = INFINITY;
        batch->radiance[2][7] = -INFINITY;
        batch->radiance[0][SF_LANES + 12] = NAN; /* not asked for */
        sf_gather_kernels_at((sf_isa)isa)->gather_statistics(batch);
        sf_film_pixel pixel = {.half_width = 0};
        for (int block = 0; block < 2; ++block) sf_film_add(&pixel, batch->statistics + block);
        assert_int_equal(pixel.moments.count, 13 + 8);
        assert_int_equal(pixel.moments.nonfinite, 3);
        for (int c = 0; c < 3; ++c) assert_true(pixel.moments.mean[c] == c + 1);
        assert_true(pixel.moments.m2 == 0);
    }
    sf_aligned_free(batch);
}

static void test_scenes_of_any_scale_have_the_same_radiance(void **state) {
    (void)state;
    static const float scales[] = {1e-12f, 1e-6f, 1e-3f, 1, 1e6f, 1e11f};
    for (int i = 0; i < 6; ++i) {
        float k = scales[i];
        lit_floor s = {make_square(5 * k, 0, 1), make_square(0.5f * k, 2 * k, -1), NULL};
        sf_mesh floor = square_mesh(&s.floor, 0.7f, 0), light = square_mesh(&s.light, 0, 10);
        sf_camera camera = camera_at(0, -4 * k, 1.5f * k, 0.4f * k, 0.1f * k, 0, 1e-5f);
        camera.up[1] = 0;
        camera.up[2] = 1;
        assert_ok(sf_scene_create(&s.scene, error));
        assert_ok(sf_scene_add_mesh(s.scene, &floor, error));
        assert_ok(sf_scene_add_mesh(s.scene, &light, error));
        assert_ok(sf_scene_set_camera(s.scene, &camera, error));
        assert_ok(sf_scene_set_max_bounces(s.scene, 2, error));
        assert_ok(sf_scene_commit(s.scene, error));
        sf_render_options options = options_for(16, 256);
        sf_film *film = render(s.scene, &options);
        double expected = lit_floor_radiance((double)0.4f, (double)0.1f);
        assert_true(fabs(film_mean(film) - expected) < 5 * mean_error(film, 1.959963985) + 1e-4 * expected);
        assert_int_equal(sf_film_summarize(film).nonfinite_samples, 0);
        sf_film_destroy(film);
        sf_scene_destroy(s.scene);
    }
}

/* ---- limits and interruption ---- */

static void test_time_limit_is_kept_and_said(void **state) {
    (void)state;
    lit_floor s;
    lit_floor_create(&s, 1);
    for (int tolerance = 0; tolerance < 2; ++tolerance) {
        sf_render_options options = options_for(64, 0);
        options.seconds = 0.1;
        options.relative_tolerance = tolerance ? 1e-9 : 0;
        options.max_spp = SF_MAX_SPP;
        sf_film *film = render(s.scene, &options);
        sf_film_summary summary = sf_film_summarize(film);
        /* Pixels that see no surface have half-width 0, which meets any tolerance. */
        assert_int_equal(summary.reasons[SF_STOP_REASON_OUT_OF_TIME] + summary.reasons[SF_STOP_REASON_MET], 64 * 64);
        assert_true(summary.reasons[SF_STOP_REASON_OUT_OF_TIME] > 2048);
        if (!tolerance) assert_int_equal(summary.reasons[SF_STOP_REASON_MET], 0);
        assert_true(summary.seconds >= 0.1);
        assert_true(summary.seconds < 2); /* on a machine busy with other tests */
        sf_film_destroy(film);
    }
    sf_scene_destroy(s.scene);
}

static int stop_at_round(const sf_progress *progress, void *user) { return progress->round >= *(const uint32_t *)user; }

static void test_progress_can_stop_the_render_which_keeps_what_it_has(void **state) {
    (void)state;
    lit_floor s;
    lit_floor_create(&s, 1);
    uint32_t rounds = 2;
    sf_render_options options = options_for(32, SF_MAX_SPP);
    options.progress = stop_at_round;
    options.progress_user = &rounds;
    sf_film *film = render(s.scene, &options);
    sf_film_summary summary = sf_film_summarize(film);
    assert_int_equal(summary.reasons[SF_STOP_REASON_INTERRUPTED], 32 * 32);
    assert_true(summary.samples > 0 && film_mean(film) > 0);
    sf_film_destroy(film);
    sf_scene_destroy(s.scene);
}

/* ---- bad input ---- */

static void test_bad_options_are_refused_by_name(void **state) {
    (void)state;
    lit_floor s;
    lit_floor_create(&s, 1);
    sf_film *film;
    const sf_render_options good = options_for(8, 4);
#define REFUSED(part, assignment)                                                                  \
    do {                                                                                           \
        sf_render_options options = good;                                                          \
        assignment;                                                                                \
        film = (sf_film *)&s;                                                                      \
        assert_refused(SF_STATUS_INVALID_VALUE, part, sf_render(s.scene, &options, &film, error)); \
        assert_null(film);                                                                         \
    } while (0)
    REFUSED("width is 0", options.width = 0);
    REFUSED("height is 65537", options.height = 65537);
    REFUSED("crop is (0, 0, 9, 8)", (options.crop[2] = 9, options.crop[3] = 8));
    REFUSED("crop is (4, 0, 4, 8)", (options.crop[0] = 4, options.crop[2] = 4, options.crop[3] = 8));
    REFUSED("spp is 2147483649", options.spp = SF_MAX_SPP + 1);
    REFUSED("spp is 4 and a tolerance", options.relative_tolerance = 0.1);
    REFUSED("relative_tolerance is -0.1", (options.spp = 0, options.relative_tolerance = -0.1));
    REFUSED("absolute_tolerance is nan", (options.spp = 0, options.absolute_tolerance = NAN));
    REFUSED("absolute_tolerance is inf", (options.spp = 0, options.absolute_tolerance = INFINITY));
    REFUSED("relmse is -1", (options.spp = 0, options.relmse = -1));
    REFUSED("relmse is 0.1 beside spp", options.relmse = 0.1);
    REFUSED("relmse is 0.1 beside spp", (options.spp = 0, options.relmse = 0.1, options.samples = 1000));
    REFUSED("confidence is 0", options.confidence = 0);
    REFUSED("confidence is 1", options.confidence = 1);
    REFUSED("confidence is nan", options.confidence = NAN);
    REFUSED("min_spp is 1", options.min_spp = 1);
    REFUSED("min_spp is 65", (options.min_spp = 65, options.max_spp = 64));
    REFUSED("max_spp is 0", options.max_spp = 0);
    REFUSED("seconds is -1", options.seconds = -1);
    REFUSED("seconds is nan", options.seconds = NAN);
    REFUSED("pattern is 99", options.pattern = (sf_pattern)99);
    REFUSED("pixel_filter is 7", options.pixel_filter = (sf_pixel_filter)7);
    REFUSED("stop is 7", options.stop = (sf_stop_rule)7);
    REFUSED("seeds is 3", options.seeds = (sf_seed_policy)3);
    REFUSED("threads is 1025", options.threads = 1025);
    REFUSED("tile_size is 12", options.tile_size = 12);
    REFUSED("tile_size is 0", options.tile_size = 0);
    REFUSED("tile_size is 2048", options.tile_size = 2048);
    REFUSED("uniform needs to know its total", (options.spp = 0, options.pattern = SF_PATTERN_UNIFORM));
    REFUSED("17 points are no grid", (options.spp = 17, options.pattern = SF_PATTERN_JITTERED));
#undef REFUSED
    sf_scene_destroy(s.scene);
}

static void test_scene_that_is_not_committed_is_refused(void **state) {
    (void)state;
    sf_scene *scene;
    sf_film *film;
    sf_render_options options = options_for(8, 1);
    assert_ok(sf_scene_create(&scene, error));
    assert_refused(SF_STATUS_INVALID_VALUE, "commit", sf_render(scene, &options, &film, error));
    assert_null(film);
    sf_scene_destroy(scene);
    sf_film_destroy(NULL);
}

static void test_pages_of_the_last_film_come_back_as_zeros(void **state) {
    (void)state;
    size_t size = 5 << 20;
    unsigned char *first = sf_page_cache_take(size), *other, *again;
    memset(first, 0xa5, size);
    sf_page_cache_give(first, size);
    other = sf_page_cache_take(2 * size); /* of another size: not these */
    again = sf_page_cache_take(size);
    assert_ptr_equal(again, first);
    assert_ptr_not_equal(other, first);
    for (size_t i = 0; i < size; ++i)
        if (again[i] || other[i]) fail_msg("byte %zu is not 0", i);
    sf_page_cache_give(other, 2 * size);
    sf_page_cache_give(again, size);
    other = sf_page_cache_take(2 * size); /* the last alone is kept */
    for (size_t i = 0; i < 2 * size; ++i) assert_true(other[i] == 0);
    sf_page_cache_give(other, 2 * size);
    other = sf_page_cache_take(SF_PAGE_CACHE_KEPT + 1);
    other[SF_PAGE_CACHE_KEPT] = 1;
    sf_page_cache_give(other, SF_PAGE_CACHE_KEPT + 1); /* too large to be kept */
    sf_page_cache_give(NULL, size);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_floor_under_a_rectangle_light_has_its_analytic_radiance),
        cmocka_unit_test(test_weighting_light_with_surface_rays_leaves_the_radiance),
        cmocka_unit_test(test_furnace_sums_the_geometric_series),
        cmocka_unit_test(test_background_lights_a_lone_floor_by_its_albedo),
        cmocka_unit_test(test_every_filter_and_lens_keeps_a_constant_image),
        cmocka_unit_test(test_row_0_is_the_top_and_right_is_forward_cross_up),
        cmocka_unit_test(test_lens_is_sharp_in_its_focal_plane_and_blurs_by_the_circle_of_confusion),
        cmocka_unit_test(test_alpha_is_the_share_of_samples_that_hit),
        cmocka_unit_test(test_threads_and_tiles_change_no_bit),
        cmocka_unit_test(test_crop_has_the_full_frames_bits),
        cmocka_unit_test(test_a_count_reached_in_more_rounds_is_the_same_film),
        cmocka_unit_test(test_levels_agree),
        cmocka_unit_test(test_shared_seeds_repeat_the_noise_of_other_threads_and_others_do_not),
        cmocka_unit_test(test_another_seed_is_another_noise_about_the_same_mean),
        cmocka_unit_test(test_half_widths_of_independent_samples_cover_the_truth),
        cmocka_unit_test(test_adaptive_pixels_say_why_they_stopped),
        cmocka_unit_test(test_black_scene_stops_at_the_minimum),
        cmocka_unit_test(test_samples_that_are_not_finite_are_counted_and_left_out),
        cmocka_unit_test(test_scenes_of_any_scale_have_the_same_radiance),
        cmocka_unit_test(test_time_limit_is_kept_and_said),
        cmocka_unit_test(test_progress_can_stop_the_render_which_keeps_what_it_has),
        cmocka_unit_test(test_pages_of_the_last_film_come_back_as_zeros),
        cmocka_unit_test(test_bad_options_are_refused_by_name),
        cmocka_unit_test(test_scene_that_is_not_committed_is_refused),
    };
    return cmocka_run_group_tests_name("render", tests, NULL, NULL);
}
