// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Instances: the film of the flattened scene, what the scene says of them, and what is refused. */

#include "scenes.h"

/* A tetrahedron with outward normals. */
static const float corners[12] = {1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1};
static const uint32_t faces[12] = {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2};

static sf_mesh tetrahedron(float albedo) {
    sf_mesh mesh = sf_mesh_default();
    mesh.vertices = corners;
    mesh.vertex_count = 4;
    mesh.triangles = faces;
    mesh.triangle_count = 4;
    for (int c = 0; c < 3; ++c) mesh.albedo[c] = albedo;
    return mesh;
}

/* Powers of two, quarter turns and mirrors: flattened corners are exact. */
static const float transforms[3][12] = {
    {0.5f, 0, 0, -1.5f, 0, 0.5f, 0, 0, 0, 0, 0.25f, 0.5f},
    {0, -0.25f, 0, 0, 0.5f, 0, 0, 0.5f, 0, 0, 0.5f, 1},
    {-0.5f, 0, 0, 1.5f, 0, 0.25f, 0, 0, 0, 0, 0.5f, 0.75f},
};
static const sf_instances three = {.transforms = transforms[0], .count = 3};

typedef struct flat_mesh {
    float vertices[12];
    uint32_t triangles[12];
} flat_mesh;

/* What a placement stands for; the third transform mirrors, and turns the corners round. */
static sf_mesh flatten(flat_mesh *flat, const sf_mesh *mesh, int k) {
    const float *t = transforms[k];
    sf_mesh out = *mesh;
    for (size_t i = 0; i < mesh->vertex_count; ++i)
        for (size_t r = 0; r < 3; ++r) {
            const float *v = mesh->vertices + 3 * i;
            flat->vertices[3 * i + r] = t[4 * r] * v[0] + t[4 * r + 1] * v[1] + t[4 * r + 2] * v[2] + t[4 * r + 3];
        }
    for (size_t i = 0; i < 3 * mesh->triangle_count; ++i)
        flat->triangles[i] = mesh->triangles[k < 2 || i % 3 == 0 ? i : i % 3 == 1 ? i + 1 : i - 1];
    out.vertices = flat->vertices;
    out.triangles = flat->triangles;
    return out;
}

static sf_scene *scene_over(const square *floor) {
    sf_scene *scene;
    sf_mesh ground = square_mesh(floor, 0.7f, 0);
    sf_camera camera = camera_at(0, -5, 2, 0, 0, 0.5f, 45);
    camera.up[1] = 0;
    camera.up[2] = 1;
    assert_ok(sf_scene_create(&scene, error));
    assert_ok(sf_scene_add_mesh(scene, &ground, error));
    assert_ok(sf_scene_set_camera(scene, &camera, error));
    assert_ok(sf_scene_set_max_bounces(scene, 3, error));
    return scene;
}

static sf_film *film_of(const sf_scene *scene, uint32_t threads) {
    sf_render_options options = sf_render_options_default();
    options.width = options.height = 40;
    options.spp = 64;
    options.threads = threads;
    return render(scene, &options);
}

/* A dark mesh and one that emits, placed; and the same flattened. */
static void test_the_film_is_that_of_the_flattened_scene(void **state) {
    (void)state;
    square floor = make_square(5, -0.5f, 1), lamp = make_square(0.5f, 1.5f, -1);
    sf_mesh meshes[2] = {square_mesh(&lamp, 0, 5), tetrahedron(0.6f)};
    flat_mesh flat[3][2];
    sf_scene *few = scene_over(&floor), *many = scene_over(&floor);
    uint32_t prototype;
    assert_ok(sf_scene_add_prototype(few, meshes, 2, &prototype, error));
    assert_ok(sf_scene_add_instances(few, prototype, &three, error));
    assert_ok(sf_scene_commit(few, error));
    for (int k = 0; k < 3; ++k)
        for (int m = 0; m < 2; ++m) {
            sf_mesh mesh = flatten(&flat[k][m], &meshes[m], k);
            assert_ok(sf_scene_add_mesh(many, &mesh, error));
        }
    assert_ok(sf_scene_commit(many, error));
    sf_film *a = film_of(few, 1), *b = film_of(many, 1), *threaded = film_of(few, 4);
    const float *x = channel_data(a, "R"), *y = channel_data(b, "R");
    size_t different = 0;
    for (size_t i = 0; i < 3 * film_pixels(a); ++i) different += !(fabsf(x[i] - y[i]) <= 1e-4f * (1 + y[i]));
    assert_true(different < film_pixels(a) / 20); /* paths that graze an edge */
    assert_true(fabs(film_mean(a) / film_mean(b) - 1) < 1e-3);
    assert_true(film_mean(b) > 0.02); /* not black */
    assert_memory_equal(x, channel_data(threaded, "R"), 12 * film_pixels(a));
    sf_film_destroy(a);
    sf_film_destroy(b);
    sf_film_destroy(threaded);
    sf_scene_destroy(few);
    sf_scene_destroy(many);
}

static void test_info_plan_and_hash(void **state) {
    (void)state;
    square floor = make_square(5, -0.5f, 1), lamp = make_square(0.5f, 1.5f, -1);
    sf_mesh meshes[2] = {square_mesh(&lamp, 0, 5), tetrahedron(0.6f)};
    const float albedos[9] = {0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f, 0.7f, 0.8f, 0.9f};
    sf_instances colored = three;
    colored.albedos = albedos;
    sf_scene_info info[3];
    for (int k = 0; k < 3; ++k) {
        sf_scene *scene = scene_over(&floor);
        sf_plan plan;
        uint32_t prototype;
        assert_ok(sf_scene_add_prototype(scene, meshes, 2, &prototype, error));
        assert_ok(sf_scene_add_instances(scene, prototype, k == 2 ? &colored : &three, error));
        assert_ok(sf_scene_commit(scene, error));
        assert_ok(sf_scene_get_info(scene, &info[k], error));
        assert_ok(sf_scene_get_plan(scene, &plan, error));
        assert_true(plan.stages >> SF_STAGE_INSTANCES & 1u);
        sf_scene_destroy(scene);
    }
    assert_int_equal(info[0].mesh_count, 3); /* the floor's, and two of the prototype */
    assert_int_equal(info[0].instance_count, 3);
    assert_int_equal(info[0].triangle_count, 2 + 3 * 4 + 3 * 2);
    assert_int_equal(info[0].unique_triangle_count, 2 + 4 + 3 * 2); /* lights are copied */
    assert_int_equal(info[0].light_count, 3);                       /* rectangles */
    assert_true(info[0].bounds_upper[2] == 1.75f);                  /* the second lamp's */
    assert_true(info[0].hash == info[1].hash);
    assert_true(info[0].hash != info[2].hash);
}

static void test_bad_values_are_refused(void **state) {
    (void)state;
    square floor = make_square(5, -0.5f, 1);
    sf_scene *scene = scene_over(&floor);
    sf_mesh mesh = tetrahedron(0.5f), bad = tetrahedron(2);
    uint32_t prototype = 9;
    assert_refused(SF_STATUS_INVALID_VALUE, "0 meshes", sf_scene_add_prototype(scene, &mesh, 0, &prototype, error));
    assert_refused(SF_STATUS_INVALID_VALUE, "albedo[0] is 2",
                   sf_scene_add_prototype(scene, &bad, 1, &prototype, error));
    assert_int_equal(prototype, 9);
    assert_refused(SF_STATUS_INVALID_VALUE, "the scene has 0", sf_scene_add_instances(scene, 0, &three, error));
    assert_ok(sf_scene_add_prototype(scene, &mesh, 1, &prototype, error));
    float t[2][12];
    const sf_instances two = {.transforms = t[0], .count = 2}, none = {.transforms = t[0]};
    assert_refused(SF_STATUS_INVALID_VALUE, "0 transforms", sf_scene_add_instances(scene, prototype, &none, error));
    const struct {
        int at;
        float value;
        const char *part;
    } cases[] = {
        {3, NAN, "transform 1: row 0, column 3 is nan"},
        {6, 2e12f, "transform 1: row 1, column 2 is 2e+12"},
        {10, 0, "transform 1 is singular"},
        {10, 1e-7f, "transform 1 is singular"},
        {11, 1e12f, "transform 1 takes its prototype to coordinates of"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        memcpy(t, transforms, sizeof t);
        t[1][0] = t[1][5] = 1;
        t[1][1] = t[1][4] = 0;
        t[1][10] = 1e5f;
        if (cases[i].at != 11) t[1][10] = 1;
        t[1][cases[i].at] = cases[i].value;
        assert_refused(SF_STATUS_INVALID_VALUE, cases[i].part, sf_scene_add_instances(scene, prototype, &two, error));
    }
    assert_ok(sf_scene_commit(scene, error)); /* nothing was added */
    sf_scene_info info;
    assert_ok(sf_scene_get_info(scene, &info, error));
    assert_int_equal(info.instance_count, 0);
    assert_refused(SF_STATUS_INVALID_VALUE, "committed", sf_scene_add_instances(scene, prototype, &three, error));
    assert_refused(SF_STATUS_INVALID_VALUE, "committed", sf_scene_add_prototype(scene, &mesh, 1, &prototype, error));
    sf_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_film_is_that_of_the_flattened_scene),
        cmocka_unit_test(test_info_plan_and_hash),
        cmocka_unit_test(test_bad_values_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
