// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Renders that stop and go on, files that are whole or refused, and films that merge. */
#include "scenes.h"

#include <dirent.h>
#include <signal.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/container.h"
#include "base/platform.h"
#include "film/film_internal.h"

#define FILE_NAME "render.ckpt"
#define Z 1.959963985

/* Every test works in a folder of its own, which goes with what is in it. */
static int enter_folder(void **state) {
    char name[] = "/tmp/sunfleck-checkpoint-XXXXXX";
    lit_floor *s = malloc(sizeof *s);
    if (!s || !mkdtemp(name) || chdir(name) != 0) return -1;
    lit_floor_create(s, 2);
    *state = s;
    return 0;
}
static int leave_folder(void **state) {
    lit_floor *s = *state;
    char path[4096];
    sf_scene_destroy(s->scene);
    free(s);
    if (!getcwd(path, sizeof path) || chdir("..") != 0) return -1;
    char command[4200];
    snprintf(command, sizeof command, "rm -rf '%s'", path);
    return system(command);
}

static sf_render_options options_for(uint32_t size, uint32_t spp) {
    sf_render_options options = sf_render_options_default();
    options.width = options.height = size;
    options.spp = spp;
    options.threads = 2;
    options.checkpoint_seconds = 1000;
    return options;
}

static void assert_same_film(const sf_film *a, const sf_film *b) {
    size_t pixels = film_pixels(a);
    assert_int_equal(pixels, film_pixels(b));
    for (size_t i = 0; i < sf_film_channel_count(a); ++i) {
        sf_channel p = sf_film_channel(a, i), q = sf_film_channel(b, i);
        if (i != 1 && i != 2) assert_memory_equal(p.data, q.data, pixels * p.pixel_stride);
    }
    /* All that is accumulated, to the last bit. */
    for (uint32_t y = 0; y < sf_film_height(a); ++y)
        for (uint32_t x = 0; x < sf_film_width(a); ++x) {
            const sf_film_pixel *p = sf_film_crop_at(a, x, y), *q = sf_film_crop_at(b, x, y);
            assert_memory_equal(&p->moments, &q->moments, sizeof p->moments);
        }
}

static void remove_file(void) { unlink(FILE_NAME); }

/* The file's bytes, to be freed. */
static unsigned char *read_bytes(size_t *size) {
    FILE *file = fopen(FILE_NAME, "rb");
    assert_non_null(file);
    struct stat about;
    assert_int_equal(fstat(fileno(file), &about), 0);
    *size = (size_t)about.st_size;
    unsigned char *bytes = malloc(*size);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    fclose(file);
    return bytes;
}
static void write_bytes(const unsigned char *bytes, size_t size) {
    FILE *file = fopen(FILE_NAME, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static uint32_t file_value(const char *name) {
    sf_container file;
    uint32_t value = 0;
    sf_array array = {name, SF_ARRAY_U32, 1, 1, &value, 4};
    assert_ok(sf_container_open(&file, FILE_NAME, error));
    assert_ok(sf_container_take(&file, &array, error));
    sf_container_close(&file);
    return value;
}

static int stop_at_round(const sf_progress *progress, void *user) { return progress->round >= *(const uint32_t *)user; }

/* ---- resuming ---- */

#define MASK_SIZE 100
static const uint8_t *disk_mask(void) {
    static uint8_t mask[MASK_SIZE * MASK_SIZE];
    for (int y = 0; y < MASK_SIZE; ++y)
        for (int x = 0; x < MASK_SIZE; ++x) mask[y * MASK_SIZE + x] = (x - 20) * (x - 20) + (y - 22) * (y - 22) < 300;
    return mask;
}

/* A fixed count, a tolerance and a budget by the default rule; the two other rules; two stages, by
 * tolerance with all AOVs and a mask, and by a budget; a goal of the whole picture. */
#define KINDS 8
static sf_render_options kind_of_render(int kind) {
    sf_render_options options = options_for(42, kind == 0 ? 400 : 0);
    if (kind == 1) options.relative_tolerance = 0.002;
    if (kind == 2) options.absolute_tolerance = 0.01;
    if (kind == 2) options.stop = SF_STOP_RULE_STANDARD_ERROR;
    if (kind == 2) options.min_spp = 21; /* rounds end within blocks */
    if (kind == 2) options.max_spp = 203;
    if (kind == 3) options.samples = 100 * 42 * 42;
    if (kind == 4) options.stop = SF_STOP_RULE_REPLICATES;
    if (kind == 4) options.absolute_tolerance = 0.0005;
    if (kind == 5) options.relative_tolerance = 0.004;
    if (kind == 5) options.aovs = (1u << SF_AOV_COUNT) - 1;
    if (kind == 5) options.mask = disk_mask();
    if (kind == 5) options.mask_stride = MASK_SIZE;
    if (kind == 6) options.samples = 150 * 42 * 42;
    if (kind == 7) options.relmse = 1e-7;
    options.unbiased = kind == 5 || kind == 6;
    return options;
}

static void test_a_render_stopped_at_any_round_ends_as_one_that_never_stopped(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    for (int kind = 0; kind < KINDS; ++kind) {
        sf_render_options options = kind_of_render(kind);
        sf_film *whole = render(scene, &options);
        uint32_t rounds = sf_film_summarize(whole).rounds;
        if (rounds < 3) fail_msg("kind %d has %u rounds", kind, rounds);
        options.checkpoint_path = FILE_NAME;
        for (uint32_t stop = 1; stop < rounds; stop += 1 + TEST_STRIDE / 4) {
            remove_file();
            options.threads = 1 + stop % 3;
            options.tile_size = 8u << stop % 2;
            options.progress = stop_at_round;
            options.progress_user = &stop;
            sf_film *part = render(scene, &options);
            assert_true(sf_film_summarize(part).rounds == stop);
            options.threads = 1 + (stop + kind) % 3;
            options.progress = NULL;
            sf_film *resumed = render(scene, &options);
            assert_same_film(whole, resumed);
            assert_true(sf_film_summarize(resumed).rounds == rounds);
            assert_true(sf_film_summarize(resumed).traced_samples == sf_film_summarize(whole).traced_samples);
            assert_true(sf_film_summarize(resumed).level == sf_film_summarize(whole).level);
            sf_film_destroy(part);
            sf_film_destroy(resumed);
        }
        sf_film_destroy(whole);
        remove_file();
    }
}

static void test_stops_within_rounds_change_no_bit(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    size_t within = 0;
    for (int kind = 0; kind < KINDS; ++kind) {
        sf_render_options options = kind_of_render(kind);
        if (options.unbiased) continue; /* a pilot that is out of time is over: what it has decided stays */
        if (TEST_STRIDE > 1 && kind % 2) continue;
        options.width = options.height = 100;
        sf_film *whole = render(scene, &options);
        options.checkpoint_path = FILE_NAME;
        size_t stops = 0;
        bool done = false;
        for (double spent = 0; !done; ++stops) {
            options.seconds = spent + 0.001 * TEST_STRIDE * (double)(1 + stops); /* slow machines get there too */
            options.threads = 1 + stops % 3;
            sf_film *film = render(scene, &options);
            spent = sf_film_summarize(film).seconds;
            within += file_value("state.from") < file_value("state.to");
            done = sf_film_summarize(film).reasons[SF_STOP_REASON_OUT_OF_TIME] == 0;
            if (done) assert_same_film(whole, film);
            sf_film_destroy(film);
        }
        assert_true(stops > 1);
        sf_film_destroy(whole);
        remove_file();
    }
    assert_true(within > 0);
}

static int look_at_file(const sf_progress *progress, void *user) {
    if (progress->round > 0 || access(FILE_NAME, F_OK) != 0) return 0;
    *(uint32_t *)user += file_value("state.from") < file_value("state.to");
    return 0;
}

static void test_a_long_round_is_written_down_while_it_runs(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    uint32_t seen = 0;
    sf_render_options options = options_for(64, 0);
    options.absolute_tolerance = 1e-6;
    options.min_spp = options.max_spp = 1500 / (1 + TEST_STRIDE / 6); /* one round of some 6 million paths */
    options.seed = 5;
    sf_film *whole = render(scene, &options);
    options.checkpoint_path = FILE_NAME;
    options.checkpoint_seconds = 0;
    options.progress = look_at_file;
    options.progress_user = &seen;
    sf_film *film = render(scene, &options);
    assert_true(seen > 0);
    assert_same_film(whole, film);
    sf_film_destroy(film);
    sf_film_destroy(whole);
}

static void test_a_finished_render_is_returned_as_it_was(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    sf_render_options options = kind_of_render(1);
    options.checkpoint_path = FILE_NAME;
    sf_film *first = render(scene, &options), *again = render(scene, &options), *loaded;
    assert_ok(sf_film_load(FILE_NAME, &loaded, error));
    assert_same_film(first, again);
    assert_same_film(first, loaded);
    sf_film_summary a = sf_film_summarize(first), b = sf_film_summarize(loaded);
    assert_memory_equal(a.reasons, b.reasons, sizeof a.reasons);
    assert_true(a.level == b.level && a.tolerance == b.tolerance && a.samples == b.samples);
    assert_int_equal(sf_film_attribute_count(first), sf_film_attribute_count(loaded));
    for (size_t i = 0; i < sf_film_attribute_count(first); ++i)
        if (strcmp(sf_film_attribute(first, i).name, "render_seconds") != 0) /* taken before the last write */
            assert_string_equal(sf_film_attribute(first, i).text, sf_film_attribute(loaded, i).text);
    sf_film_destroy(first);
    sf_film_destroy(again);
    sf_film_destroy(loaded);
}

static void test_a_crop_goes_on_too(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    static const uint32_t crop[4] = {5, 3, 29, 17};
    sf_render_options options = kind_of_render(2);
    memcpy(options.crop, crop, sizeof crop);
    sf_film *whole = render(scene, &options);
    uint32_t stop = 2;
    options.checkpoint_path = FILE_NAME;
    options.progress = stop_at_round;
    options.progress_user = &stop;
    sf_film_destroy(render(scene, &options));
    options.progress = NULL;
    sf_film *film = render(scene, &options), *loaded;
    assert_same_film(whole, film);
    assert_ok(sf_film_load(FILE_NAME, &loaded, error));
    assert_same_film(whole, loaded);
    sf_film_destroy(whole);
    sf_film_destroy(film);
    sf_film_destroy(loaded);
}

/* ---- asking for more ---- */

static void test_a_fixed_count_grows_to_the_bits_of_the_larger_one(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    static const sf_pattern patterns[] = {SF_PATTERN_RANDOM, SF_PATTERN_HALTON, SF_PATTERN_SOBOL};
    for (int i = 0; i < 3; ++i) {
        sf_render_options options = options_for(17, 48);
        options.pattern = patterns[i];
        options.start = 32u * (unsigned)i;
        options.checkpoint_path = FILE_NAME;
        sf_film_destroy(render(scene, &options));
        options.spp = 200;
        sf_film *grown = render(scene, &options);
        options.checkpoint_path = NULL;
        sf_film *fresh = render(scene, &options);
        assert_same_film(fresh, grown);
        sf_film_destroy(grown);
        sf_film_destroy(fresh);
        remove_file();
    }
}

static void test_a_count_that_ends_within_a_block_grows_to_the_same_samples(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    sf_render_options options = options_for(33, 37);
    options.checkpoint_path = FILE_NAME;
    sf_film_destroy(render(scene, &options));
    options.spp = 96;
    sf_film *grown = render(scene, &options);
    options.checkpoint_path = NULL;
    sf_film *fresh = render(scene, &options);
    const float *a = channel_data(grown, "R"), *b = channel_data(fresh, "R");
    /* The same 96 values of double, added in two orders, then rounded to float. */
    for (size_t i = 0; i < 3 * film_pixels(fresh); ++i) assert_true(fabsf(a[i] - b[i]) <= 0x1p-23f * b[i]);
    sf_film_destroy(grown);
    sf_film_destroy(fresh);
}

static void test_a_tighter_tolerance_goes_on_to_the_bits_of_a_fresh_render(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    sf_render_options options = options_for(50, 0);
    options.relative_tolerance = 0.06;
    options.stop = SF_STOP_RULE_STANDARD_ERROR;
    options.max_spp = 112;
    options.checkpoint_path = FILE_NAME;
    sf_film *easy = render(scene, &options);
    assert_true(sf_film_summarize(easy).reasons[SF_STOP_REASON_MET] > 0);
    assert_true(sf_film_summarize(easy).reasons[SF_STOP_REASON_MAX_SAMPLES] > 0);
    options.relative_tolerance = 0.02;
    options.max_spp = 1008;
    uint32_t stop = 3; /* and the extension may be stopped as well, while it catches up or later */
    options.progress = stop_at_round;
    options.progress_user = &stop;
    sf_film_destroy(render(scene, &options));
    options.progress = NULL;
    sf_film *tight = render(scene, &options);
    options.checkpoint_path = NULL;
    sf_film *fresh = render(scene, &options);
    assert_true(sf_film_summarize(fresh).samples > sf_film_summarize(easy).samples);
    assert_same_film(fresh, tight);
    sf_film_destroy(easy);
    sf_film_destroy(tight);
    sf_film_destroy(fresh);
}

/* Whether time is left is what counts here, not how long the machine takes for it. */
static void test_more_time_adds_to_what_was_spent(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    sf_render_options options = options_for(32, 0);
    options.seconds = 0.05;
    options.checkpoint_path = FILE_NAME;
    sf_film *first = render(scene, &options), *again = render(scene, &options);
    sf_film_summary spent = sf_film_summarize(first), none = sf_film_summarize(again);
    assert_true(spent.seconds >= 0.05 && spent.reasons[SF_STOP_REASON_OUT_OF_TIME] > 0);
    /* Of the time asked for nothing is left: a batch of each thread, at the most, is added. */
    assert_true(none.seconds >= 0.05 && none.reasons[SF_STOP_REASON_OUT_OF_TIME] > 0);
    assert_true(none.samples - spent.samples <= 2 * 1024);
    /* With an hour more it goes on, until it is told to stop. */
    uint32_t stop = none.rounds + 2;
    options.seconds = 3600;
    options.progress = stop_at_round;
    options.progress_user = &stop;
    sf_film *longer = render(scene, &options);
    sf_film_summary more = sf_film_summarize(longer);
    assert_true(more.rounds == stop && more.samples > none.samples && more.seconds >= 0.05);
    assert_true(more.reasons[SF_STOP_REASON_OUT_OF_TIME] == 0 && more.reasons[SF_STOP_REASON_INTERRUPTED] > 0);
    sf_film_destroy(first);
    sf_film_destroy(again);
    sf_film_destroy(longer);
}

/* ---- refusals ---- */

static void test_what_differs_is_named_and_the_file_is_left(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    sf_render_options made = options_for(24, 0);
    made.relative_tolerance = 0.1;
    made.max_spp = 128;
    made.stop = SF_STOP_RULE_STANDARD_ERROR;
    made.seed = 1;
    made.checkpoint_path = FILE_NAME;
    sf_film_destroy(render(scene, &made));
    size_t size, size_after;
    unsigned char *before = read_bytes(&size);
    sf_film *film;
#define REFUSED(change, part)                                                              \
    do {                                                                                   \
        sf_render_options o = made;                                                        \
        change;                                                                            \
        assert_refused(SF_STATUS_INVALID_VALUE, part, sf_render(scene, &o, &film, error)); \
        assert_null(film);                                                                 \
    } while (0)
    REFUSED(o.seed = 2, "'render.ckpt' was made with seed 1; this render has seed 2");
    REFUSED(o.width = 25, "width 24, crop (0, 0, 24, 24); this render has width 25, crop (0, 0, 25, 24)");
    REFUSED(o.height = 16, "height 24");
    REFUSED(o.crop[2] = o.crop[3] = 16, "crop (0, 0, 24, 24); this render has crop (0, 0, 16, 16)");
    REFUSED(o.pattern = SF_PATTERN_RANDOM, "pattern sobol; this render has pattern random");
    REFUSED(o.pixel_filter = SF_PIXEL_FILTER_TENT, "pixel_filter box; this render has pixel_filter tent");
    REFUSED(o.confidence = 0.9, "confidence 0.95; this render has confidence 0.9");
    REFUSED(o.min_spp = 16, "min_spp 32");
    REFUSED(o.max_spp = 64, "max_spp 128; this render has max_spp 64 (counts may only grow");
    REFUSED(o.relative_tolerance = 0.2, "relative_tolerance 0.1; this render has relative_tolerance 0.2");
    REFUSED(o.relative_tolerance = 0; o.spp = 64, "spp 0, relative_tolerance 0.1; this render has spp 64");
    REFUSED(o.seed = 2; o.pattern = SF_PATTERN_HALTON, "pattern sobol, seed 1; this render has pattern halton, seed 2");
    REFUSED(o.seeds = SF_SEEDS_THREAD, "checkpoint needs seeds pixel");
    REFUSED(o.checkpoint_seconds = -1, "checkpoint_seconds is -1");
    REFUSED(o.checkpoint_path = "", "empty path");
    lit_floor other;
    lit_floor_create(&other, 3);
    assert_refused(SF_STATUS_INVALID_VALUE, "was made with scene ", sf_render(other.scene, &made, &film, error));
    sf_scene_destroy(other.scene);
    if (sf_isa_active() != SF_ISA_BASELINE) {
        setenv("SUNFLECK_ISA", "baseline", 1);
        assert_refused(SF_STATUS_INVALID_VALUE, "this render has instruction set baseline",
                       sf_render(scene, &made, &film, error));
        unsetenv("SUNFLECK_ISA");
    }
    unsigned char *after = read_bytes(&size_after);
    assert_int_equal(size, size_after);
    assert_memory_equal(before, after, size);
    free(before);
    free(after);
}

static void test_every_option_that_a_film_describes_is_in_its_file(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene; /* one that is not would not be compared */
    sf_render_options options = options_for(8, 16);
    options.checkpoint_path = FILE_NAME;
    sf_film *film = render(scene, &options);
    sf_container file;
    assert_ok(sf_container_open(&file, FILE_NAME, error));
    size_t found = 0;
    for (size_t i = 3; strcmp(sf_film_attribute(film, i).name, "level") != 0; ++i, ++found) {
        char name[64];
        bool there = false;
        if (!strcmp(sf_film_attribute(film, i).name, "mask")) continue; /* refused beside a checkpoint */
        snprintf(name, sizeof name, "option.%s", sf_film_attribute(film, i).name);
        for (uint32_t k = 0; k < file.count; ++k)
            there |= !strcmp((const char *)file.bytes + 24 + 64 * (size_t)k, name);
        if (!there) fail_msg("the file has no %s", name);
    }
    assert_true(found >= 17);
    sf_container_close(&file);
    sf_film_destroy(film);
}

static void test_patterns_that_place_all_points_at_once_do_not_grow(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    sf_render_options options = options_for(16, 16);
    options.pattern = SF_PATTERN_JITTERED;
    options.checkpoint_path = FILE_NAME;
    sf_film_destroy(render(scene, &options));
    sf_film *film;
    options.spp = 64;
    assert_refused(SF_STATUS_INVALID_VALUE, "pattern jittered, which places all at once",
                   sf_render(scene, &options, &film, error));
}

static void test_every_changed_byte_and_every_missing_one_is_noticed(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    sf_render_options options = options_for(8, 16);
    options.checkpoint_path = FILE_NAME;
    sf_film_destroy(render(scene, &options));
    size_t size;
    unsigned char *bytes = read_bytes(&size);
    sf_film *film;
    sf_error problem;
    for (size_t i = 0; i < size; i += TEST_STRIDE) {
        bytes[i] ^= (unsigned char)(1u << i % 8);
        write_bytes(bytes, size);
        bytes[i] ^= (unsigned char)(1u << i % 8);
        assert_int_equal(sf_film_load(FILE_NAME, &film, &problem), SF_STATUS_IO);
        assert_null(film);
        bool header = i < 24; /* magic, version, sizes: what the message can be more precise about */
        if (!header) assert_non_null(strstr(problem.message, "is damaged"));
    }
    for (size_t length = 0; length < size; length += length < 64 ? 1 : 37) {
        write_bytes(bytes, length);
        const char *part = length < 24 ? "is not a checkpoint" : "is cut short";
        assert_refused(SF_STATUS_IO, part, sf_film_load(FILE_NAME, &film, error));
    }
    write_bytes(bytes, size);
    bytes[8] = 99;
    write_bytes(bytes, size);
    assert_refused(SF_STATUS_IO, "version 99", sf_render(scene, &options, &film, error));
    assert_refused(SF_STATUS_IO, "No such file", sf_film_load("nowhere", &film, error));
    assert_refused(SF_STATUS_IO, "not a file", sf_film_load(".", &film, error));
    options.checkpoint_path = "nowhere/render.ckpt";
    assert_refused(SF_STATUS_IO, "No such file", sf_render(scene, &options, &film, error));
    free(bytes);
}

/* ---- writing ---- */

static void count_notice(const char *message, void *user) {
    assert_non_null(strstr(message, FILE_NAME));
    ++*(int *)user;
}

static void test_a_full_disk_keeps_the_old_file_and_the_film(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    sf_render_options options = options_for(32, 16);
    options.checkpoint_path = FILE_NAME;
    sf_film_destroy(render(scene, &options));
    size_t size, size_after;
    unsigned char *before = read_bytes(&size);
    options.spp = 64;
    int notices = 0;
    options.notice = count_notice;
    options.notice_user = &notices;
    /* No file may grow beyond half of what this one needs: the write fails as on a full disk. */
    struct rlimit unlimited, limit;
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &unlimited), 0);
    limit = unlimited;
    limit.rlim_cur = size / 2;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    sf_film *film;
    assert_refused(SF_STATUS_IO, FILE_NAME, sf_render(scene, &options, &film, error));
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &unlimited), 0);
    assert_int_equal(notices, 1);
    assert_non_null(film);
    assert_int_equal(sf_film_summarize(film).samples, 64 * 32 * 32);
    unsigned char *after = read_bytes(&size_after);
    assert_int_equal(size, size_after);
    assert_memory_equal(before, after, size);
    assert_int_not_equal(access(FILE_NAME ".part", F_OK), 0);
    sf_film *again = render(scene, &options); /* the disk has room again: on from the old file */
    assert_same_film(film, again);
    sf_film_destroy(film);
    sf_film_destroy(again);
    free(before);
    free(after);
}

/* Writes files of one value, repeated, as fast as it can; ends at a write that fails, if told to. */
static void write_for_ever(bool strict) {
    enum { VALUES = 40000 };
    static uint64_t values[VALUES];
    sf_array array = {"values", SF_ARRAY_U64, 1, VALUES, values, sizeof *values};
    for (uint64_t n = 1;; ++n) {
        for (size_t i = 0; i < VALUES; ++i) values[i] = n;
        if (sf_container_write(FILE_NAME, &array, 1, NULL) && strict) _exit(1);
    }
}

static void test_a_kill_while_writing_leaves_a_whole_file(void **state) {
    (void)state;
    enum { VALUES = 40000 };
    static uint64_t values[VALUES];
    sf_array array = {"values", SF_ARRAY_U64, 1, VALUES, values, sizeof *values};
    size_t beside = 0;
    for (int round = 0; round < 40; ++round) {
        pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0) write_for_ever(true);
        while (access(FILE_NAME, F_OK) != 0) usleep(200);
        usleep((useconds_t)(round * 731 % 9000)); /* some lengths of a write */
        int status;
        assert_int_equal(kill(child, SIGKILL), 0);
        assert_int_equal(waitpid(child, &status, 0), child);
        assert_true(WIFSIGNALED(status)); /* it did not end by itself: every write went well */
        beside += access(FILE_NAME ".part", F_OK) == 0;
        sf_container file;
        assert_ok(sf_container_open(&file, FILE_NAME, error));
        assert_ok(sf_container_take(&file, &array, error));
        sf_container_close(&file);
        for (size_t i = 1; i < VALUES; ++i) assert_true(values[i] == values[0]);
    }
    assert_true(beside > 0); /* some were killed in the midst of it */
}

static void test_two_writers_do_not_mix(void **state) {
    (void)state;
    uint64_t value = 1;
    sf_array array = {"value", SF_ARRAY_U64, 1, 1, &value, sizeof value};
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) write_for_ever(false);
    while (access(FILE_NAME, F_OK) != 0) usleep(200);
    size_t written = 0, busy = 0;
    for (int i = 0; i < 300 && !(written && busy); ++i) {
        sf_error problem;
        sf_status status = sf_container_write(FILE_NAME, &array, 1, &problem);
        if (status == SF_STATUS_OK) ++written;
        if (status == SF_STATUS_IO) ++busy;
        sf_container file;
        assert_ok(sf_container_open(&file, FILE_NAME, error));
        sf_container_close(&file);
    }
    kill(child, SIGKILL);
    waitpid(child, NULL, 0);
    assert_true(busy > 0);
}

static void test_columns_of_structs_come_back(void **state) {
    (void)state;
    typedef struct row {
        double value[3];
        uint32_t number;
        unsigned char byte;
    } row;
    static row rows[3000], read[3000];
    for (size_t i = 0; i < 3000; ++i)
        rows[i] = (row){.value = {(double)i, -1.0 / (double)(i + 1), INFINITY},
                        .number = (uint32_t)(i * i),
                        .byte = (unsigned char)i};
    for (int way = 0; way < 2; ++way) {
        row *at = way ? read : rows;
        sf_array arrays[] = {{"value", SF_ARRAY_F64, 3, 3000, at->value, sizeof *at},
                             {"byte", SF_ARRAY_U8, 1, 2999, &at->byte, sizeof *at}, /* not a multiple of 8 */
                             {"number", SF_ARRAY_U32, 1, 3000, &at->number, sizeof *at},
                             {"empty", SF_ARRAY_TEXT, 1, 0, NULL, 1}};
        sf_container file;
        if (way == 0) assert_ok(sf_container_write(FILE_NAME, arrays, 4, error));
        assert_ok(sf_container_open(&file, FILE_NAME, error));
        for (int i = 0; way && i < 4; ++i) assert_ok(sf_container_take(&file, arrays + i, error));
        if (way) {
            arrays[1].rows = 3000;
            assert_refused(SF_STATUS_IO, "no byte of the expected size", sf_container_take(&file, arrays + 1, error));
        }
        sf_container_close(&file);
    }
    read[2999].byte = rows[2999].byte;
    for (size_t i = 0; i < 3000; ++i) {
        assert_memory_equal(rows[i].value, read[i].value, sizeof rows[i].value);
        assert_int_equal(rows[i].number, read[i].number);
        assert_int_equal(rows[i].byte, read[i].byte);
    }
    size_t size;
    unsigned char *bytes = read_bytes(&size);
    /* The format as docs/checkpoint.md has it: magic, version 3, 4 arrays, little-endian. */
    static const unsigned char head[16] = {0x89, 'S', 'F', 'C', 'K', 13, 10, 26, 3, 0, 0, 0, 4, 0, 0, 0};
    assert_memory_equal(bytes, head, 16);
    assert_int_equal(size, 24 + 4 * 64 + 72000 + 3000 + 12000 + 8);
    assert_memory_equal(bytes + 24 + 4 * 64 + 24, rows[1].value, 24);
    free(bytes);
}

/* ---- merging ---- */

static sf_film *merge(sf_film *const *films, size_t count) {
    sf_film *merged;
    assert_ok(sf_film_merge((const sf_film *const *)films, count, &merged, error));
    return merged;
}

static void test_replicates_merge_by_their_counts(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    static const uint32_t counts[3] = {16, 48, 160};
    sf_film *films[3];
    for (int i = 0; i < 3; ++i) {
        sf_render_options options = options_for(30, counts[i]);
        options.seed = (uint64_t)i;
        films[i] = render(scene, &options);
    }
    sf_film *merged = merge(films, 3), *first = merge(films, 2), *chained;
    chained = merge((sf_film *[]){first, films[2]}, 2);
    for (size_t p = 0; p < film_pixels(merged); ++p) {
        double mean = 0, square = 0;
        for (int i = 0; i < 3; ++i) {
            mean += counts[i] * (double)((const float *)channel_data(films[i], "R"))[3 * p];
            double weighted = counts[i] * (double)((const float *)channel_data(films[i], "half_width"))[p];
            square += weighted * weighted;
        }
        double found = (double)((const float *)channel_data(merged, "R"))[3 * p];
        double width = (double)((const float *)channel_data(merged, "half_width"))[p];
        /* Four roundings to float. */
        assert_true(fabs(found - mean / 224) <= 4 * 0x1p-24 * found);
        assert_true(fabs(width - sqrt(square) / 224) <= 4 * 0x1p-24 * width);
        assert_int_equal(((const uint32_t *)channel_data(merged, "samples"))[p], 224);
        assert_int_equal(((const uint8_t *)channel_data(merged, "stop_reason"))[p], SF_STOP_REASON_FIXED);
        double chained_width = (double)((const float *)channel_data(chained, "half_width"))[p];
        assert_true(fabs(chained_width - width) <= 4 * 0x1p-24 * width);
    }
    sf_film *none;
    assert_refused(SF_STATUS_INVALID_VALUE, "films 1 and 2 both have seed 1 at pixel (0, 0)",
                   sf_film_merge((const sf_film *[]){first, films[1]}, 2, &none, error));
    assert_refused(SF_STATUS_INVALID_VALUE, "films 1 and 3 both have seed 0",
                   sf_film_merge((const sf_film *[]){films[0], films[1], films[0]}, 3, &none, error));
    for (int i = 0; i < 3; ++i) sf_film_destroy(films[i]);
    sf_film_destroy(merged);
    sf_film_destroy(first);
    sf_film_destroy(chained);
}

static void test_merged_half_widths_cover_as_they_claim(void **state) {
    (void)state; /* independent samples over one place: the truth is the mean of all of them */
    lit_floor *s = *state;
    enum { FILMS = 8 };
    sf_film *films[FILMS];
    sf_render_options options = options_for(64, 64);
    options.pattern = SF_PATTERN_RANDOM;
    for (int i = 0; i < FILMS; ++i) {
        options.seed = 100 + (uint64_t)i;
        options.spp = 32u << i % 3;
        films[i] = render(s->scene, &options);
    }
    options.spp = 2048;
    options.seed = 1;
    options.pattern = SF_PATTERN_SOBOL; /* its error is some hundredth of theirs */
    sf_film *truth = render(s->scene, &options), *merged = merge(films, FILMS);
    const float *a = channel_data(merged, "R"), *b = channel_data(truth, "R"), *h = channel_data(merged, "half_width");
    size_t covered = 0, pixels = film_pixels(merged);
    for (size_t i = 0; i < pixels; ++i) {
        double error = 0;
        for (int c = 0; c < 3; ++c) error += ((double)a[3 * i + c] - (double)b[3 * i + c]) / 3;
        covered += fabs(error) <= (double)h[i];
    }
    double share = (double)covered / (double)pixels;
    /* At least 0.95, within five standard errors of a share of 4,096 pixels. At most 0.99: the rule's
     * half-widths hold at looks of the rule's own choice, and are 1.2 to 1.36 times as wide as a fixed
     * count needs, 0.979 for the merged. */
    double deviation = sqrt(0.95 * 0.05 / (double)pixels);
    assert_true(share > 0.95 - 5 * deviation && share < 0.99);
    for (int i = 0; i < FILMS; ++i) sf_film_destroy(films[i]);
    sf_film_destroy(truth);
    sf_film_destroy(merged);
}

static void test_tiles_merge_to_the_full_frame(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    static const uint32_t crops[4][4] = {{0, 0, 19, 13}, {19, 0, 40, 13}, {0, 13, 11, 40}, {11, 13, 40, 40}};
    sf_film *tiles[4], *none;
    sf_render_options options = options_for(40, 24);
    sf_film *full = render(scene, &options);
    for (int i = 0; i < 4; ++i) {
        memcpy(options.crop, crops[i], sizeof options.crop);
        options.checkpoint_path = i < 2 ? FILE_NAME : NULL; /* from memory, and from files */
        tiles[i] = render(scene, &options);
        if (i < 2) {
            sf_film_destroy(tiles[i]);
            assert_ok(sf_film_load(FILE_NAME, &tiles[i], error));
            remove_file();
        }
    }
    sf_film *merged = merge(tiles, 4);
    assert_same_film(full, merged);
    assert_int_equal(sf_film_summarize(merged).samples, 24 * 40 * 40);
    assert_refused(SF_STATUS_INVALID_VALUE, "pixel (19, 0) is in none of the films",
                   sf_film_merge((const sf_film *[]){tiles[0], tiles[2], tiles[3]}, 3, &none, error));
    assert_refused(SF_STATUS_INVALID_VALUE, "films 1 and 2 both have seed 0 at pixel (0, 0)",
                   sf_film_merge((const sf_film *[]){merged, tiles[0]}, 2, &none, error));
    assert_refused(SF_STATUS_INVALID_VALUE, "at least one", sf_film_merge(NULL, 0, &none, error));
    for (int i = 0; i < 4; ++i) sf_film_destroy(tiles[i]);
    sf_film_destroy(full);
    sf_film_destroy(merged);
}

static void test_films_that_are_not_of_one_picture_do_not_merge(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    sf_render_options options = options_for(16, 16);
    sf_film *film = render(scene, &options), *none;
    lit_floor other;
    lit_floor_create(&other, 3);
#define NOT_MERGED(of, change, part)                                                     \
    do {                                                                                 \
        sf_render_options o = options;                                                   \
        o.seed = 9;                                                                      \
        change;                                                                          \
        sf_film *with = render(of, &o);                                                  \
        assert_refused(SF_STATUS_INVALID_VALUE, part,                                    \
                       sf_film_merge((const sf_film *[]){film, with}, 2, &none, error)); \
        assert_null(none);                                                               \
        sf_film_destroy(with);                                                           \
    } while (0)
    NOT_MERGED(other.scene, (void)0, "film 1 is of scene");
    NOT_MERGED(scene, o.width = 17, "frame of 16 x 16 pixels and film 2 of 17 x 16");
    NOT_MERGED(scene, o.pattern = SF_PATTERN_RANDOM, "pattern sobol and film 2 has random");
    NOT_MERGED(scene, o.pixel_filter = SF_PIXEL_FILTER_TENT, "pixel_filter box and film 2 has tent");
    NOT_MERGED(scene, o.confidence = 0.9, "confidence 0.95 and film 2 has 0.9");
    sf_scene_destroy(other.scene);
    sf_film_destroy(film);
}

/* A film of 1 x 1 pixel whose accumulators the test fills. */
static sf_film *empty_film(uint64_t seed) {
    sf_render_options options = options_for(1, 16);
    options.crop[2] = options.crop[3] = 1;
    options.seed = seed;
    sf_film *film;
    assert_ok(sf_film_create(&options, false, &film, error));
    return film;
}

static void test_a_thousand_million_samples_lose_no_accuracy(void **state) {
    (void)state;
    /* Blocks of 16 of which 8 are 1000 + 1/4 and 8 are 1000 - 1/4, but 3/4 in the third channel of
     * the second kind: means 1000, 1000, 1000 - 1/4 and m2 per sample 1/16 + 1/16 + 1/4 exactly. */
    enum { BLOCKS = 62500000 / 2 };
    sf_block_statistics block = {.moments = {.count = 16, .mean = {1000, 1000, 999.75}, .m2 = 16 * 0.375}, .hits = 16};
    sf_film *films[2] = {empty_film(1), empty_film(2)};
    for (int i = 0; i < 2; ++i)
        for (int k = 0; k < BLOCKS; ++k) sf_film_add(films[i]->pixels, &block);
    for (int i = 0; i < 2; ++i) films[i]->pixels->half_width = sf_film_half_width(films[i]->pixels, Z);
    sf_film *merged = merge(films, 2);
    const sf_film_pixel *pixel = merged->pixels;
    assert_true(pixel->moments.count == 1000000000 && pixel->hits == 1000000000);
    for (int c = 0; c < 3; ++c) assert_true(pixel->moments.mean[c] == (c < 2 ? 1000 : 999.75));
    assert_true(pixel->moments.m2 == 0.375e9); /* every partial sum is a multiple of 6 below 2^53 */
    double expected = Z * sqrt(0.375 / (3 * 1e9));
    assert_true(fabs((double)pixel->half_width - expected) < 1e-6 * expected);
    /* Blocks that differ: a tenth, as no binary fraction is, drifting by parts in 2^24. The mean of
     * k / 2^24 over the blocks is known; 31 million merges of a Welford mean may each round by
     * 2^-53 of it, which as a random walk is 2^-53 sqrt(n) / n ..., at worst n 2^-53 / n. */
    sf_film *drift = empty_film(3);
    for (int k = 0; k < BLOCKS; ++k) {
        for (int c = 0; c < 3; ++c) block.moments.mean[c] = 0.1 + (k & 1023) * 0x1p-24;
        sf_film_add(drift->pixels, &block);
    }
    int last = BLOCKS % 1024; /* the sum over whole runs of 1,024, and over the rest */
    double mean = (BLOCKS / 1024 * 1023 * 512.0 + last * (last - 1) / 2.0) / BLOCKS * 0x1p-24 + 0.1;
    assert_true(fabs(drift->pixels->moments.mean[0] - mean) < 1e-13);
    sf_film_destroy(merged);
    sf_film_destroy(drift);
    for (int i = 0; i < 2; ++i) sf_film_destroy(films[i]);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, enter_folder, leave_folder)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(test_a_render_stopped_at_any_round_ends_as_one_that_never_stopped),
        TEST(test_stops_within_rounds_change_no_bit),
        TEST(test_a_long_round_is_written_down_while_it_runs),
        TEST(test_a_finished_render_is_returned_as_it_was),
        TEST(test_a_crop_goes_on_too),
        TEST(test_a_fixed_count_grows_to_the_bits_of_the_larger_one),
        TEST(test_a_count_that_ends_within_a_block_grows_to_the_same_samples),
        TEST(test_a_tighter_tolerance_goes_on_to_the_bits_of_a_fresh_render),
        TEST(test_more_time_adds_to_what_was_spent),
        TEST(test_what_differs_is_named_and_the_file_is_left),
        TEST(test_every_option_that_a_film_describes_is_in_its_file),
        TEST(test_patterns_that_place_all_points_at_once_do_not_grow),
        TEST(test_every_changed_byte_and_every_missing_one_is_noticed),
        TEST(test_a_full_disk_keeps_the_old_file_and_the_film),
        TEST(test_a_kill_while_writing_leaves_a_whole_file),
        TEST(test_two_writers_do_not_mix),
        TEST(test_columns_of_structs_come_back),
        TEST(test_replicates_merge_by_their_counts),
        TEST(test_merged_half_widths_cover_as_they_claim),
        TEST(test_tiles_merge_to_the_full_frame),
        TEST(test_films_that_are_not_of_one_picture_do_not_merge),
        TEST(test_a_thousand_million_samples_lose_no_accuracy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
