// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* AOVs against what the scene says, the halves against renders of their samples, and the same
 * bits however the work is divided. */
#include "film/film_internal.h"
#include "scenes.h"

#include "film/aov.h"
#include "trace/aov_kernels.h"

#define ALL_AOVS ((1u << SF_AOV_COUNT) - 1)

static sf_render_options options_for(uint32_t size, uint32_t spp, uint32_t aovs) {
    sf_render_options options = sf_render_options_default();
    options.width = options.height = size;
    options.spp = spp;
    options.threads = 2;
    options.aovs = aovs;
    return options;
}

/* ---- first hits ---- */

/* A square of half-side 1 at z = 0 that faces +z, glows, and is seen from (0, 0, z). */
static sf_film *render_square(float z, float aperture, uint32_t spp) {
    square s = make_square(1, 0, 1);
    sf_mesh mesh = square_mesh(&s, 0, 5);
    mesh.albedo[0] = 0.25f;
    mesh.albedo[1] = 0.5f;
    sf_camera camera = camera_at(0, 0, z, 0, 0, 0, 40);
    camera.aperture_radius = aperture;
    sf_scene *scene;
    assert_ok(sf_scene_create(&scene, error));
    assert_ok(sf_scene_add_mesh(scene, &mesh, error));
    assert_ok(sf_scene_set_camera(scene, &camera, error));
    assert_ok(sf_scene_commit(scene, error));
    sf_render_options options = options_for(21, spp, SF_AOVS_OF_HITS);
    sf_film *film = render(scene, &options);
    sf_scene_destroy(scene);
    return film;
}

static void assert_square_seen_from(float z, float aperture) {
    sf_film *film = render_square(z, aperture, 24);
    const float *alpha = channel_data(film, "A"), *albedo = channel_data(film, "albedo.R");
    const float *normal = channel_data(film, "normal.X"), *depth = channel_data(film, "Z");
    size_t whole = 0, partly = 0;
    for (size_t i = 0; i < film_pixels(film); ++i) {
        whole += alpha[i] == 1;
        partly += alpha[i] > 0 && alpha[i] < 1;
        /* Averages over all samples, of which the share alpha hit: to a float's rounding. */
        assert_true(fabsf(albedo[3 * i] - 0.25f * alpha[i]) <= 1e-7f);
        assert_true(fabsf(albedo[3 * i + 1] - 0.5f * alpha[i]) <= 1e-7f);
        assert_true(albedo[3 * i + 2] == 0);
        assert_true(fabsf(normal[3 * i]) <= 1e-7f && fabsf(normal[3 * i + 1]) <= 1e-7f);
        assert_true(fabsf(normal[3 * i + 2] - copysignf(alpha[i], z)) <= 1e-6f);
        /* Along the axis the square is as far everywhere; along the rays it would be 6 % farther at
         * the frame's corners. Embree's distances are floats. */
        if (alpha[i] > 0) assert_true(fabsf(depth[i] - fabsf(z)) <= 2e-6f * fabsf(z));
        if (alpha[i] == 0) assert_true(depth[i] == INFINITY);
    }
    assert_true(whole > 10 && partly > 10 && whole + partly < film_pixels(film));
    sf_film_destroy(film);
}

static void test_first_hits_are_averaged_and_face_the_viewer(void **state) {
    (void)state; /* a glowing mesh has its own albedo */
    assert_square_seen_from(6, 0);
    assert_square_seen_from(-6, 0);
}

static void test_depth_on_a_lens_is_along_the_axis_too(void **state) {
    (void)state;
    assert_square_seen_from(6, 0.2f);
}

/* ---- halves and variance ---- */

static void test_halves_are_alternate_blocks_of_sixteen(void **state) {
    (void)state;
    lit_floor s;
    lit_floor_create(&s, 2);
    uint32_t halves = 1u << SF_AOV_HALF_A | 1u << SF_AOV_HALF_B;
    sf_render_options options = options_for(24, 32, halves), first = options_for(24, 16, 0);
    sf_film *film = render(s.scene, &options), *begun = render(s.scene, &first);
    size_t values = 3 * film_pixels(film);
    assert_memory_equal(channel_data(film, "half_a.R"), channel_data(begun, "R"), values * sizeof(float));
    assert_memory_not_equal(channel_data(film, "half_b.R"), channel_data(begun, "R"), values * sizeof(float));
    sf_film_destroy(film);

    options.spp = 40; /* samples 0-15 and 32-39; 16-31 */
    film = render(s.scene, &options);
    const float *a = channel_data(film, "half_a.R"), *b = channel_data(film, "half_b.R"),
                *color = channel_data(film, "R");
    for (size_t i = 0; i < values; ++i)
        assert_true(fabsf((24 * a[i] + 16 * b[i]) / 40 - color[i]) <= 4e-7f * color[i]); /* four roundings of floats */
    sf_film_destroy(film);
    sf_film_destroy(begun);
    sf_scene_destroy(s.scene);
}

static void test_variance_is_that_of_the_pixels_mean(void **state) {
    (void)state;
    enum { SIZE = 32, SEEDS = 24 };
    lit_floor s;
    lit_floor_create(&s, 1);
    sf_render_options options = options_for(SIZE, 64, 1u << SF_AOV_VARIANCE);
    options.pattern = SF_PATTERN_RANDOM;
    options.stop = SF_STOP_RULE_STANDARD_ERROR; /* exact for independent samples; dyadic adds its margin */
    static sf_moments means[SIZE * SIZE];
    double claimed = 0, found = 0;
    memset(means, 0, sizeof means);
    for (options.seed = 0; options.seed < SEEDS; ++options.seed) {
        sf_film *film = render(s.scene, &options);
        const float *color = channel_data(film, "R"), *variance = channel_data(film, "variance");
        for (size_t i = 0; i < SIZE * SIZE; ++i) {
            sf_moments_add(means + i, ((double)color[3 * i] + (double)color[3 * i + 1] + (double)color[3 * i + 2]) / 3);
            claimed += (double)variance[i] / SEEDS;
        }
        sf_film_destroy(film);
    }
    for (size_t i = 0; i < SIZE * SIZE; ++i) found += means[i].m2 / (SEEDS - 1);
    /* A variance of 24 has a relative deviation of sqrt(2 / 23) = 0.29; the sum of 1,024 of which at
     * least a tenth carry the weight, of 0.03: five of these. */
    assert_true(claimed > 0 && fabs(found / claimed - 1) < 0.15);
    sf_scene_destroy(s.scene);
}

/* ---- the same bits ---- */

static void assert_same_aovs(const sf_film *a, const sf_film *b) {
    for (int k = 0; k < SF_AOV_COUNT; ++k) {
        sf_channel x, y;
        int components = sf_film_aov(a, (sf_aov)k, &x);
        assert_int_equal(sf_film_aov(b, (sf_aov)k, &y), components);
        assert_memory_equal(x.data, y.data, film_pixels(a) * (size_t)components * sizeof(float));
    }
}

static void test_threads_tiles_and_rounds_change_no_bit(void **state) {
    (void)state;
    lit_floor s;
    lit_floor_create(&s, 2);
    sf_render_options options = options_for(50, 0, ALL_AOVS);
    options.absolute_tolerance = 0.02;
    options.threads = 1;
    sf_film *first = render(s.scene, &options);
    for (uint32_t threads = 2; threads <= 3; ++threads)
        for (uint32_t tile = 8; tile <= 64; tile *= 8) {
            options.threads = threads;
            options.tile_size = tile;
            sf_film *film = render(s.scene, &options);
            assert_same_aovs(first, film);
            sf_film_destroy(film);
        }
    sf_film_destroy(first);
    sf_scene_destroy(s.scene);
}

static void test_asking_changes_nothing_else_and_not_asking_keeps_nothing(void **state) {
    (void)state;
    lit_floor s;
    lit_floor_create(&s, 2);
    sf_render_options options = options_for(20, 40, 0);
    sf_film *plain = render(s.scene, &options);
    assert_null(plain->aovs);
    assert_int_equal(sf_film_channel_count(plain), 7);
    sf_channel channel;
    for (int k = 0; k < SF_AOV_COUNT; ++k) {
        assert_int_equal(sf_film_aov(plain, (sf_aov)k, &channel), 0);
        options.aovs = 1u << k;
        sf_film *film = render(s.scene, &options);
        int components = sf_film_aov(film, (sf_aov)k, &channel);
        assert_int_equal(sf_film_channel_count(film), 7 + components);
        assert_string_equal(sf_film_channel(film, 7).name, channel.name);
        assert_ptr_equal(sf_film_channel(film, 7).data, channel.data);
        assert_int_equal(sf_film_channel(film, 7).row_stride, 20 * (size_t)components * sizeof(float));
        assert_memory_equal(channel_data(film, "R"), channel_data(plain, "R"), 3 * film_pixels(film) * sizeof(float));
        sf_film_destroy(film);
    }
    assert_int_equal(sf_film_aov(plain, SF_AOV_COUNT, &channel), 0);
    assert_null(sf_aov_name(SF_AOV_COUNT));
    sf_film_destroy(plain);
    sf_scene_destroy(s.scene);
}

static void test_each_level_sums_first_hits_alike_and_keeps_nan_out(void **state) {
    (void)state;
    float column[3] = {0.5f, 0.125f, 0}; /* two meshes and the miss */
    sf_mesh_table meshes = {.columns = {column, column, column}, .miss = 2};
    const float forward[3] = {0, 0, -1};
    sf_batch *batch = sf_aligned_alloc(sizeof *batch);
    assert_non_null(batch);
    memset(batch, 0, sizeof *batch);
    batch->block_count = 2;
    batch->width = SF_LANES;
    for (uint32_t i = 0; i < 2 * SF_LANES; ++i) {
        batch->mesh[i] = i % 3;
        batch->distance[i] = i % 3 == 2 ? INFINITY : 3 + 0.1f * (float)i;
        batch->direction[0][i] = 0.6f;
        batch->direction[2][i] = -0.8f;
        batch->hit_normal[0][i] = i % 3 == 2 ? NAN : 0;
        batch->hit_normal[2][i] = i % 2 ? 7.0f : -1e-30f; /* whose square no float holds */
    }
    batch->hit_normal[1][3] = NAN;
    batch->hit_normal[1][4] = INFINITY;
    batch->hit_normal[2][6] = 0;
    sf_hit_sums sums[3][2];
    memset(sums, 0, sizeof sums);
    for (int isa = SF_ISA_BASELINE; isa <= (int)sf_isa_active(); ++isa) {
        const sf_aov_kernels *kernels = sf_aov_kernels_at((sf_isa)isa);
        kernels->albedo(batch, &meshes, sums[isa]);
        kernels->normal(batch, &meshes, sums[isa]);
        kernels->depth(batch, &meshes, forward, sums[isa]);
        assert_memory_equal(sums[isa], sums[0], sizeof sums[0]);
    }
    /* Lanes 0 .. 15: 6 of mesh 0, 5 of mesh 1, 5 misses; lanes 3, 4 and 6 have no normal. */
    assert_true(sums[0][0].albedo[1] == 6 * 0.5 + 5 * 0.125);
    assert_true(sums[0][0].hits == 11);
    assert_true(sums[0][0].normal[0] == 0 && sums[0][0].normal[1] == 0 && fabs(sums[0][0].normal[2] - 8) < 1e-12);
    double depth = 0;
    for (int i = 0; i < SF_LANES; ++i) depth += i % 3 == 2 ? 0 : (3 + 0.1 * i) * 0.8;
    assert_true(fabs(sums[0][0].depth - depth) < 1e-5);
    sf_aligned_free(batch);
}

static void test_bad_aovs_are_refused(void **state) {
    (void)state;
    lit_floor s;
    lit_floor_create(&s, 1);
    sf_film *film;
    sf_render_options options = options_for(8, 32, 1u << SF_AOV_COUNT);
    assert_refused(SF_STATUS_INVALID_VALUE, "aovs is 0x40", sf_render(s.scene, &options, &film, error));
    options = options_for(8, 16, 1u << SF_AOV_HALF_B);
    assert_refused(SF_STATUS_INVALID_VALUE, "spp is 16", sf_render(s.scene, &options, &film, error));
    sf_scene_destroy(s.scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_first_hits_are_averaged_and_face_the_viewer),
        cmocka_unit_test(test_depth_on_a_lens_is_along_the_axis_too),
        cmocka_unit_test(test_halves_are_alternate_blocks_of_sixteen),
        cmocka_unit_test(test_variance_is_that_of_the_pixels_mean),
        cmocka_unit_test(test_threads_tiles_and_rounds_change_no_bit),
        cmocka_unit_test(test_asking_changes_nothing_else_and_not_asking_keeps_nothing),
        cmocka_unit_test(test_each_level_sums_first_hits_alike_and_keeps_nan_out),
        cmocka_unit_test(test_bad_aovs_are_refused),
    };
    return cmocka_run_group_tests_name("aov", tests, NULL, NULL);
}
