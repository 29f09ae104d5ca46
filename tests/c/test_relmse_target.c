// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A goal for the whole picture: that it is reached, and by samples that are where they lower it most. */
#include "scenes.h"

#include <string.h>

static sf_render_options options_for(double relmse) {
    sf_render_options options = sf_render_options_default();
    options.width = 40;
    options.height = 36;
    options.relmse = relmse;
    options.threads = 2;
    options.max_spp = 65536;
    return options;
}

static int create_scene(void **state) {
    static lit_floor scene;
    lit_floor_create(&scene, 1);
    *state = &scene;
    return 0;
}
static int destroy_scene(void **state) {
    sf_scene_destroy(((lit_floor *)*state)->scene);
    return 0;
}

static void assert_same_film(const sf_film *a, const sf_film *b) {
    static const char *const channels[] = {"R", "samples", "half_width", "stop_reason"};
    static const size_t bytes[] = {12, 4, 4, 1};
    for (int c = 0; c < 4; ++c)
        assert_memory_equal(channel_data(a, channels[c]), channel_data(b, channels[c]), film_pixels(a) * bytes[c]);
}

static void test_it_is_reached_and_every_pixel_met(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    double samples = 0;
    for (double goal = 1e-4; goal > 1e-8; goal /= 30) {
        sf_render_options options = options_for(goal);
        sf_film *film = render(scene, &options);
        sf_film_summary summary = sf_film_summarize(film);
        assert_true(summary.relmse <= goal && summary.relmse > 0);
        assert_int_equal(summary.reasons[SF_STOP_REASON_MET], film_pixels(film));
        assert_true((double)summary.samples > samples);
        samples = (double)summary.samples;
        sf_film_destroy(film);
    }
}

static void test_it_is_the_mean_of_what_the_half_widths_say(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    sf_render_options options = options_for(0);
    options.spp = 64;
    options.stop = SF_STOP_RULE_STANDARD_ERROR;
    options.pattern = SF_PATTERN_RANDOM;
    sf_film *film = render(scene, &options);
    const float *color = channel_data(film, "R"), *half_width = channel_data(film, "half_width");
    double sum = 0, z = 1.959963984540054;
    for (size_t i = 0; i < film_pixels(film); ++i)
        for (int c = 0; c < 3; ++c) {
            double error = (double)half_width[i] / z, x = (double)color[3 * i + c];
            sum += error * error / (x * x + 0.01) / 3;
        }
    double expected = sum / (double)film_pixels(film);
    assert_true(fabs(sf_film_summarize(film).relmse - expected) < 1e-5 * expected);
    sf_film_destroy(film);
}

static void test_no_bit_depends_on_threads_or_tiles(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    for (int rule = 0; rule < 3; ++rule) {
        sf_render_options options = options_for(2e-6);
        options.stop = (sf_stop_rule)rule;
        options.crop[0] = 3;
        options.crop[1] = 5;
        options.crop[2] = 40;
        options.crop[3] = 31;
        sf_film *film = render(scene, &options);
        for (uint32_t threads = 1; threads <= 3; threads += 2) {
            options.threads = threads;
            options.tile_size = 8 * threads;
            sf_film *other = render(scene, &options);
            assert_same_film(film, other);
            sf_film_destroy(other);
        }
        sf_film_destroy(film);
    }
}

static void test_it_ends_at_the_most_samples(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    sf_render_options options = options_for(1e-12);
    options.max_spp = 100;
    sf_film *film = render(scene, &options);
    sf_film_summary summary = sf_film_summarize(film);
    const uint32_t *samples = channel_data(film, "samples");
    assert_true(summary.relmse > 1e-12);
    assert_int_equal(summary.reasons[SF_STOP_REASON_MET], 0);
    for (size_t i = 0; i < film_pixels(film); ++i) assert_int_equal(samples[i], 100);
    sf_film_destroy(film);
}

static int stop_at_once(const sf_progress *progress, void *user) {
    *(double *)user = progress->relmse;
    return progress->round >= 2;
}

static void test_an_early_end_says_so(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    double seen = 0;
    sf_render_options options = options_for(1e-9);
    options.progress = stop_at_once;
    options.progress_user = &seen;
    sf_film *film = render(scene, &options);
    assert_int_equal(sf_film_summarize(film).reasons[SF_STOP_REASON_INTERRUPTED], film_pixels(film));
    assert_true(seen > 1e-9 && seen < 1);
    sf_film_destroy(film);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_it_is_reached_and_every_pixel_met),
        cmocka_unit_test(test_it_is_the_mean_of_what_the_half_widths_say),
        cmocka_unit_test(test_no_bit_depends_on_threads_or_tiles),
        cmocka_unit_test(test_it_ends_at_the_most_samples),
        cmocka_unit_test(test_an_early_end_says_so),
    };
    return cmocka_run_group_tests(tests, create_scene, destroy_scene);
}
