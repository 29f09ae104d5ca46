// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Checkpoints that somebody made up, with a checksum that is right: each is refused, or it is a film and a
 * render that ends. Under a sanitizer, without one finding. */
#include "scenes.h"

#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/container.h"
#include "film/film_internal.h"

#define FILE_NAME "forged.ckpt"
#define WIDTH 13
#define HEIGHT 10
#define PIXELS (WIDTH * HEIGHT)
#define MOST_ROUNDS 400 /* that a render of these can have */
#define HEADER 24
#define ENTRY 64

/* ---- files ---- */

typedef struct bytes {
    unsigned char *at;
    size_t size;
} bytes;

static bytes read_file(void) {
    FILE *file = fopen(FILE_NAME, "rb");
    assert_non_null(file);
    struct stat about;
    assert_int_equal(fstat(fileno(file), &about), 0);
    bytes b = {.at = malloc((size_t)about.st_size), .size = (size_t)about.st_size};
    assert_non_null(b.at);
    assert_int_equal(fread(b.at, 1, b.size, file), b.size);
    fclose(file);
    return b;
}

/* Writes the bytes with the checksum that container.c gives them. */
static void write_forged(bytes b) {
    uint64_t hash = 0, word;
    for (size_t i = 0; i + 8 < b.size; i += 8) {
        memcpy(&word, b.at + i, 8);
        hash = sf_mix64(hash ^ word) + UINT64_C(0x9e3779b97f4a7c15);
    }
    memcpy(b.at + b.size - 8, &hash, 8);
    FILE *file = fopen(FILE_NAME, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(b.at, 1, b.size, file), b.size);
    assert_int_equal(fclose(file), 0);
}

/* An array of the file. */
typedef struct entry {
    const char *name;
    uint32_t type, width;
    uint64_t rows, offset;
    size_t size; /* of a value */
} entry;

static uint32_t entry_count(bytes b) {
    uint32_t count;
    memcpy(&count, b.at + 12, 4);
    return count;
}

static entry entry_of(bytes b, uint32_t i) {
    static const size_t sizes[] = {1, 1, 4, 8, 4, 8};
    const unsigned char *at = b.at + HEADER + (size_t)i * ENTRY;
    entry e = {.name = (const char *)at};
    memcpy(&e.type, at + 40, 4);
    memcpy(&e.width, at + 44, 4);
    memcpy(&e.rows, at + 48, 8);
    memcpy(&e.offset, at + 56, 8);
    e.size = sizes[e.type];
    return e;
}

static entry find_entry(bytes b, const char *name) {
    for (uint32_t i = 0; i < entry_count(b); ++i)
        if (!strcmp(entry_of(b, i).name, name)) return entry_of(b, i);
    fail_msg("the file has no %s", name);
    return (entry){0};
}

/* Sets value number `index` of an array to the low bytes of `value`. */
static void set_value(bytes b, entry e, uint64_t index, uint64_t value) {
    memcpy(b.at + e.offset + index * e.size, &value, e.size);
}
static void set_all(bytes b, entry e, uint64_t value) {
    for (uint64_t i = 0; i < e.rows * e.width; ++i) set_value(b, e, i, value);
}

/* ---- renders of every kind ---- */

#define KINDS 7
static sf_render_options kind_of_render(int kind) {
    static uint8_t mask[PIXELS];
    for (int i = 0; i < PIXELS; ++i) mask[i] = i % 3 != 0;
    sf_render_options o = sf_render_options_default();
    o.width = WIDTH;
    o.height = HEIGHT;
    o.threads = 2;
    o.checkpoint_path = FILE_NAME;
    o.checkpoint_seconds = 1000;
    o.max_spp = 256;
    if (kind == 0) o.spp = 80;
    if (kind == 0) o.start = 16;
    if (kind == 1) o.relative_tolerance = 0.02;
    if (kind == 2) o.relative_tolerance = 0.01;
    if (kind == 2) o.stop = SF_STOP_RULE_STANDARD_ERROR;
    if (kind == 2) o.aovs = (1u << SF_AOV_COUNT) - 1;
    if (kind == 3) o.relmse = 1e-5;
    if (kind == 3) o.mask = mask;
    if (kind == 3) memcpy(o.crop, (uint32_t[]){1, 2, 13, 9}, sizeof o.crop);
    if (kind == 4) o.samples = 100 * PIXELS;
    if (kind == 4) o.stop = SF_STOP_RULE_REPLICATES;
    if (kind == 5) o.relative_tolerance = 0.02;
    if (kind == 5) o.pixel_filter = SF_PIXEL_FILTER_LANCZOS;
    if (kind == 6) o.samples = 120 * PIXELS;
    o.unbiased = kind >= 5;
    return o;
}

typedef struct visit {
    uint32_t stop_at, calls;
} visit;
static int count_rounds(const sf_progress *progress, void *user) {
    visit *v = user;
    if (progress->round_finished) ++v->calls;
    return progress->round >= v->stop_at;
}

/* A file of the kind, stopped after so many rounds. */
static bytes make_file(const sf_scene *scene, int kind, uint32_t rounds) {
    sf_render_options o = kind_of_render(kind);
    visit v = {.stop_at = rounds};
    unlink(FILE_NAME);
    o.progress = count_rounds;
    o.progress_user = &v;
    sf_film_destroy(render(scene, &o));
    return read_file();
}

/* Loads and resumes what the file is now; returns whether either took it. */
static bool try_file(const sf_scene *scene, int kind) {
    sf_error problem;
    sf_film *film = NULL;
    alarm(60); /* a loop without an end fails here */
    sf_status status = sf_film_load(FILE_NAME, &film, &problem);
    bool taken = status == SF_STATUS_OK;
    if (!taken && status != SF_STATUS_IO) fail_msg("loaded with status %d: %s", (int)status, problem.message);
    assert_true(taken == (film != NULL));
    sf_film_destroy(film);
    sf_render_options o = kind_of_render(kind);
    visit v = {.stop_at = UINT32_MAX};
    o.progress = count_rounds;
    o.progress_user = &v;
    status = sf_render(scene, &o, &film, &problem);
    if (status && status != SF_STATUS_IO && status != SF_STATUS_INVALID_VALUE)
        fail_msg("resumed with status %d: %s", (int)status, problem.message);
    if (v.calls > MOST_ROUNDS) fail_msg("kind %d resumed to %u rounds", kind, v.calls);
    sf_film_destroy(film);
    alarm(0);
    return taken || !status;
}

/* ---- tests ---- */

static void test_a_file_whose_checksum_was_made_anew_is_taken(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    for (int kind = 0; kind < KINDS; ++kind) {
        bytes b = make_file(scene, kind, 1);
        b.at[b.size - 1] ^= 1; /* what follows proves something only if the checksum here is the right one */
        write_forged(b);
        assert_true(try_file(scene, kind));
        free(b.at);
    }
}

static void test_values_outside_their_range_are_named(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    static const struct {
        int kind;
        const char *name, *said;
        uint64_t value;
    } cases[] = {{3, "goal.around", "in goal.around", 0x80000000u},       /* -0.0: a bin beyond the last */
                 {3, "goal.error", "in goal.error", 0xbf800000u},         /* -1 to an unsigned integer */
                 {4, "pixel.count", "in pixel.count", UINT64_C(1) << 63}, /* a loop without an end */
                 {1, "pixel.look", "in pixel.look", 255},                 /* a shift beyond the width */
                 {1, "decay", "in decay", 0x7f7fffffu},                   /* to an integer beyond the largest */
                 {1, "pixel.reason", "in pixel.reason", 200},             /* an element beyond the last */
                 {3, "goal.taken", "contradict one another", 200},        /* a pixel that is never brought on */
                 {1, "state.to", "in state.to", 0xffffffffu},             /* a count that no pixel reaches */
                 {4, "state.traced_samples", "contradict", UINT64_MAX},   /* more than the budget */
                 {5, "pixel.half_width", "in pixel.half_width", 0xff800000u},
                 {3, "mask", "in mask", 2},
                 {0, "option.min_spp", "min_spp is 0", 0},
                 {0, "option.width", "width is 4294967295", 0xffffffffu}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        bytes b = make_file(scene, cases[i].kind, 1);
        sf_film *film;
        set_all(b, find_entry(b, cases[i].name), cases[i].value);
        write_forged(b);
        /* A film alone is read without what a goal notes; a render has a mask of its own. */
        bool noted = !strncmp(cases[i].name, "goal.", 5), masked = !strcmp(cases[i].name, "mask");
        sf_render_options o = kind_of_render(cases[i].kind);
        sf_error problem = {.message = ""};
        sf_status status = noted ? sf_render(scene, &o, &film, &problem) : sf_film_load(FILE_NAME, &film, &problem);
        if (status != SF_STATUS_IO || !strstr(problem.message, cases[i].said))
            fail_msg("%s: status %d, '%s'", cases[i].name, (int)status, problem.message);
        assert_null(film);
        assert_true(try_file(scene, cases[i].kind) == (noted || masked));
        free(b.at);
    }
}

static void test_a_file_asks_for_no_more_memory_than_it_has_pixels(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    bytes b = make_file(scene, 0, 1);
    entry crop = find_entry(b, "option.crop");
    set_all(b, find_entry(b, "option.width"), SF_MAX_IMAGE_SIZE);
    set_all(b, find_entry(b, "option.height"), SF_MAX_IMAGE_SIZE);
    set_value(b, crop, 2, SF_MAX_IMAGE_SIZE);
    set_value(b, crop, 3, SF_MAX_IMAGE_SIZE);
    write_forged(b);
    sf_film *film;
    assert_refused(SF_STATUS_IO, "has fewer pixels than its crop", sf_film_load(FILE_NAME, &film, error));
    free(b.at);
}

/* What is at the edge of a type or of a range, as bits of integers and of floats. */
static const uint64_t values[] = {0,
                                  1,
                                  2,
                                  28,
                                  64,
                                  255,
                                  65535,
                                  UINT64_C(0x7fffffff),
                                  UINT64_C(0x80000000),
                                  UINT64_C(0xffffffff),
                                  UINT64_C(0x100000000),
                                  UINT64_C(0x7fffffffffffffff),
                                  UINT64_C(0x8000000000000000),
                                  UINT64_MAX,
                                  UINT64_C(0x7ff0000000000000),
                                  UINT64_C(0x7ff8000000000000),
                                  UINT64_C(0xfff0000000000000),
                                  UINT64_C(0xbff0000000000000),
                                  UINT64_C(0x7f8000007f800000),
                                  UINT64_C(0x7fc000007fc00000),
                                  UINT64_C(0xbf800000bf800000)};
#define VALUES (sizeof values / sizeof *values)

static uint64_t draw(uint64_t *state, uint64_t below) { return sf_hash64(++*state, 1) % below; }

static void test_every_field_with_every_edge_is_refused_or_ends(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    uint64_t number = 0, tried = 0, taken = 0;
    for (int kind = 0; kind < KINDS; ++kind) {
        bytes good = make_file(scene, kind, 2), b = {.at = malloc(good.size), .size = good.size};
        assert_non_null(b.at);
        for (uint32_t i = 0; i < entry_count(good); ++i)
            for (size_t v = 0; v < VALUES; ++v) {
                if (number++ % (5 + 2 * TEST_STRIDE)) continue; /* prime to VALUES: a third run tries others */
                entry e = entry_of(good, i);
                memcpy(b.at, good.at, good.size);
                if (number % 2)
                    set_all(b, e, values[v]);
                else if (e.rows)
                    set_value(b, e, draw(&number, e.rows * e.width), values[v]);
                write_forged(b);
                taken += try_file(scene, kind);
                ++tried;
            }
        free(good.at);
        free(b.at);
    }
    assert_true(taken > 0 && taken < tried);
}

/* Changes one thing in the table of arrays or in a value. */
static void forge(bytes b, bytes good, uint64_t *state) {
    uint32_t i = (uint32_t)draw(state, entry_count(good));
    entry e = entry_of(good, i);
    uint64_t value = draw(state, 3) ? values[draw(state, VALUES)] : draw(state, 300);
    static const size_t of_entry[] = {40, 44, 48, 56};
    switch (draw(state, 8)) {
        case 0: {
            size_t at = of_entry[draw(state, 4)];
            memcpy(b.at + HEADER + (size_t)i * ENTRY + at, &value, at < 48 ? 4 : 8);
            break;
        }
        case 1: b.at[draw(state, HEADER + (uint64_t)entry_count(good) * ENTRY)] = (unsigned char)value; break;
        case 2: set_all(b, e, value); break;
        default:
            if (e.rows) set_value(b, e, draw(state, e.rows * e.width), value);
    }
}

static void test_a_thousand_forgeries_are_refused_or_end(void **state) {
    const sf_scene *scene = ((lit_floor *)*state)->scene;
    uint64_t random = 0;
    for (int kind = 0; kind < KINDS; ++kind)
        for (uint32_t rounds = 1; rounds < 10; rounds += 4) { /* within the pilot, in the second set, at the end */
            bytes good = make_file(scene, kind, rounds), b = {.at = malloc(good.size), .size = good.size};
            assert_non_null(b.at);
            for (int k = 0; k < (TEST_STRIDE > 1 ? 12 : 50); ++k) {
                memcpy(b.at, good.at, good.size);
                for (uint64_t times = 1 + draw(&random, 3); times > 0; --times) forge(b, good, &random);
                write_forged(b);
                try_file(scene, kind);
            }
            free(good.at);
            free(b.at);
        }
}

/* ---- */

static int enter_folder(void **state) {
    char name[] = "/tmp/sunfleck-forged-XXXXXX";
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
    unlink(FILE_NAME);
    return getcwd(path, sizeof path) && chdir("..") == 0 ? rmdir(path) : -1;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_file_whose_checksum_was_made_anew_is_taken),
        cmocka_unit_test(test_values_outside_their_range_are_named),
        cmocka_unit_test(test_a_file_asks_for_no_more_memory_than_it_has_pixels),
        cmocka_unit_test(test_every_field_with_every_edge_is_refused_or_ends),
        cmocka_unit_test(test_a_thousand_forgeries_are_refused_or_end),
    };
    return cmocka_run_group_tests(tests, enter_folder, leave_folder);
}
