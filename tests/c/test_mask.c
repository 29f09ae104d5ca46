// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Masked renders against the full frame's bits, and what is said of the pixels left out. */
#include "scenes.h"

#include "sunfleck/rng.h"

enum { SIZE = 50 };

static sf_render_options options_for(uint32_t spp) {
    sf_render_options options = sf_render_options_default();
    options.width = options.height = SIZE;
    options.spp = spp;
    options.threads = 2;
    options.stop = SF_STOP_RULE_STANDARD_ERROR;
    options.aovs = (1u << SF_AOV_COUNT) - 1;
    return options;
}

/* A disk, a few scattered pixels, or all but one pixel of a cell. */
static void draw_mask(int kind, uint8_t mask[SIZE][SIZE]) {
    for (int y = 0; y < SIZE; ++y)
        for (int x = 0; x < SIZE; ++x) {
            bool scattered = sf_hash64(7, (uint64_t)(y * SIZE + x)) % 97 == 0;
            bool disk = (x - 20) * (x - 20) + (y - 27) * (y - 27) < 121;
            mask[y][x] = kind == 0 ? disk : kind == 1 ? scattered : x != 13 || y != 13;
        }
}

/* Every channel of `film`, that is of `crop`, where the mask leaves it; and nothing elsewhere. */
static void assert_full_frames_bits(const sf_film *film, const sf_film *full, const uint32_t crop[4],
                                    uint8_t mask[SIZE][SIZE]) {
    for (size_t k = 0; k < sf_film_channel_count(film); ++k) {
        sf_channel part = sf_film_channel(film, k), whole = sf_film_channel(full, k);
        size_t bytes = part.type == SF_CHANNEL_UINT8 ? 1 : 4;
        for (uint32_t y = crop[1]; y < crop[3]; ++y)
            for (uint32_t x = crop[0]; x < crop[2]; ++x) {
                const char *ours =
                    (const char *)part.data + (y - crop[1]) * part.row_stride + (x - crop[0]) * part.pixel_stride;
                const char *theirs = (const char *)whole.data + y * whole.row_stride + x * whole.pixel_stride;
                if (mask[y][x] && memcmp(ours, theirs, bytes))
                    fail_msg("%s differs at (%u, %u)", part.name, (unsigned)x, (unsigned)y);
            }
    }
}

static void assert_nothing_outside(const sf_film *film, const uint32_t crop[4], uint8_t mask[SIZE][SIZE]) {
    const float *color = channel_data(film, "R"), *alpha = channel_data(film, "A"), *depth = channel_data(film, "Z");
    const float *half_width = channel_data(film, "half_width"), *half_b = channel_data(film, "half_b.R");
    const uint32_t *samples = channel_data(film, "samples");
    const uint8_t *reason = channel_data(film, "stop_reason");
    size_t i = 0;
    for (uint32_t y = crop[1]; y < crop[3]; ++y)
        for (uint32_t x = crop[0]; x < crop[2]; ++x, ++i) {
            assert_int_equal(reason[i] == SF_STOP_REASON_MASKED, !mask[y][x]);
            if (mask[y][x]) continue;
            assert_true(color[3 * i] == 0 && alpha[i] == 0 && half_b[3 * i] == 0 && samples[i] == 0);
            assert_true(half_width[i] == INFINITY && depth[i] == INFINITY);
        }
}

static void test_masked_pixels_have_the_full_frames_bits(void **state) {
    (void)state;
    static const uint32_t crops[][4] = {{0, 0, SIZE, SIZE}, {5, 3, 39, 37}};
    uint8_t mask[SIZE][SIZE];
    lit_floor s;
    lit_floor_create(&s, 2);
    for (int adaptive = 0; adaptive < 2; ++adaptive) {
        sf_render_options options = options_for(adaptive ? 0 : 40);
        options.absolute_tolerance = adaptive ? 0.02 : 0;
        sf_film *full = render(s.scene, &options);
        for (int kind = 0; kind < 6; ++kind) {
            draw_mask(kind % 3, mask);
            options.mask = mask[0];
            memcpy(options.crop, crops[kind / 3], sizeof options.crop);
            sf_film *film = render(s.scene, &options);
            assert_full_frames_bits(film, full, options.crop, mask);
            assert_nothing_outside(film, options.crop, mask);
            sf_film_destroy(film);
        }
        sf_film_destroy(full);
    }
    sf_scene_destroy(s.scene);
}

static void test_summary_and_level_are_of_the_masks_pixels(void **state) {
    (void)state;
    uint8_t mask[SIZE][SIZE];
    lit_floor s;
    lit_floor_create(&s, 1);
    sf_render_options options = options_for(0);
    options.relative_tolerance = 0.05;
    options.min_spp = 32;
    draw_mask(0, mask);
    options.mask = mask[0];
    sf_film *film = render(s.scene, &options);
    sf_film_summary summary = sf_film_summarize(film);
    const uint32_t *samples = channel_data(film, "samples");
    uint64_t pixels = 0, taken = 0, cells = 0;
    for (int y = 0; y < SIZE; ++y)
        for (int x = 0; x < SIZE; ++x) {
            pixels += mask[y][x];
            taken += samples[y * SIZE + x];
        }
    for (int c = 0; c < 49; ++c) {
        bool touched = false;
        for (int m = 0; m < 64; ++m)
            if (c / 7 * 8 + m / 8 < SIZE && c % 7 * 8 + m % 8 < SIZE)
                touched |= mask[c / 7 * 8 + m / 8][c % 7 * 8 + m % 8];
        cells += touched;
    }
    assert_int_equal(summary.pixels, pixels);
    assert_int_equal(summary.samples, taken);
    assert_int_equal(summary.reasons[SF_STOP_REASON_MASKED], 0);
    assert_int_equal(summary.reasons[SF_STOP_REASON_MET] + summary.reasons[SF_STOP_REASON_MAX_SAMPLES], pixels);
    assert_true(mask[summary.worst_y][summary.worst_x] && isfinite(summary.mean_half_width));
    assert_in_range(summary.traced_samples, summary.samples, cells * 64 * options.max_spp);

    /* The level is the mean over the mask's pixels of the first min_spp samples. */
    options.relative_tolerance = 0;
    options.spp = options.min_spp;
    sf_film *begun = render(s.scene, &options);
    const float *color = channel_data(begun, "R");
    double sum = 0;
    for (int i = 0; i < 3 * SIZE * SIZE; ++i) sum += (double)color[i] / 3; /* 0 outside */
    assert_true(fabs(summary.level - sum / (double)pixels) < 1e-6 * summary.level);
    assert_int_equal(sf_film_summarize(begun).traced_samples, cells * 64 * options.spp);
    sf_film_destroy(begun);
    sf_film_destroy(film);
    sf_scene_destroy(s.scene);
}

static int keep_last(const sf_progress *progress, void *user) {
    *(sf_progress *)user = *progress;
    return 0;
}

static void test_progress_counts_the_masks_pixels_and_those_that_met(void **state) {
    (void)state;
    uint8_t mask[SIZE][SIZE];
    lit_floor s;
    lit_floor_create(&s, 1);
    for (int masked = 0; masked < 2; ++masked) {
        sf_progress last = {0};
        sf_render_options options = options_for(0);
        options.relative_tolerance = 0.03;
        options.max_spp = 100;
        options.progress = keep_last;
        options.progress_user = &last;
        draw_mask(0, mask);
        if (masked) options.mask = mask[0];
        memcpy(options.crop, (uint32_t[]){3, 5, 45, 41}, sizeof options.crop);
        sf_film *film = render(s.scene, &options);
        sf_film_summary summary = sf_film_summarize(film);
        assert_true(summary.reasons[SF_STOP_REASON_MET] > 0 && summary.reasons[SF_STOP_REASON_MAX_SAMPLES] > 0);
        assert_int_equal(last.pixels, summary.pixels);
        assert_int_equal(last.pixels_done, summary.pixels);
        assert_int_equal(last.pixels_met, summary.reasons[SF_STOP_REASON_MET]);
        assert_true(last.tolerance == summary.tolerance);
        sf_film_destroy(film);
    }
    sf_scene_destroy(s.scene);
}

static void test_rows_may_be_apart(void **state) {
    (void)state;
    uint8_t mask[SIZE][SIZE], wide[SIZE][SIZE + 13];
    lit_floor s;
    lit_floor_create(&s, 1);
    sf_render_options options = options_for(17);
    draw_mask(0, mask);
    memset(wide, 1, sizeof wide);
    for (int y = 0; y < SIZE; ++y) memcpy(wide[y], mask[y], SIZE);
    options.mask = mask[0];
    sf_film *packed = render(s.scene, &options);
    options.mask = wide[0];
    options.mask_stride = sizeof wide[0];
    sf_film *apart = render(s.scene, &options);
    assert_memory_equal(channel_data(packed, "samples"), channel_data(apart, "samples"), SIZE * SIZE * 4);
    assert_memory_equal(channel_data(packed, "R"), channel_data(apart, "R"), SIZE * SIZE * 12);
    sf_film_destroy(packed);
    sf_film_destroy(apart);
    sf_scene_destroy(s.scene);
}

static void test_masks_that_leave_nothing_are_refused(void **state) {
    (void)state;
    uint8_t mask[SIZE][SIZE] = {{0}};
    lit_floor s;
    lit_floor_create(&s, 1);
    sf_film *film;
    sf_render_options options = options_for(17);
    options.mask = mask[0];
    assert_refused(SF_STATUS_INVALID_VALUE, "mask leaves no pixel", sf_render(s.scene, &options, &film, error));
    mask[40][40] = 1;
    memcpy(options.crop, (uint32_t[]){0, 0, 40, 50}, sizeof options.crop);
    assert_refused(SF_STATUS_INVALID_VALUE, "(0, 0, 40, 50)", sf_render(s.scene, &options, &film, error));
    options.mask_stride = SIZE - 1;
    assert_refused(SF_STATUS_INVALID_VALUE, "mask_stride is 49", sf_render(s.scene, &options, &film, error));
    sf_scene_destroy(s.scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_masked_pixels_have_the_full_frames_bits),
        cmocka_unit_test(test_summary_and_level_are_of_the_masks_pixels),
        cmocka_unit_test(test_progress_counts_the_masks_pixels_and_those_that_met),
        cmocka_unit_test(test_rows_may_be_apart),
        cmocka_unit_test(test_masks_that_leave_nothing_are_refused),
    };
    return cmocka_run_group_tests_name("mask", tests, NULL, NULL);
}
