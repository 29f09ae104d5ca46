// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "scenes.h"

#include "scene/scene_internal.h"

static sf_scene *new_scene(void) {
    sf_scene *scene;
    assert_ok(sf_scene_create(&scene, error));
    return scene;
}

static bool runs(const sf_plan *plan, sf_stage stage) { return plan->stages >> stage & 1u; }

static sf_plan plan_of(const sf_scene *scene) {
    sf_plan plan;
    assert_ok(sf_scene_get_plan(scene, &plan, error));
    return plan;
}

static void test_mesh_with_a_nan_vertex_is_refused_with_its_number(void **state) {
    (void)state;
    sf_scene *scene = new_scene();
    square s = make_square(1, 0, 1);
    s.vertices[7] = NAN;
    sf_mesh mesh = square_mesh(&s, 0.5f, 0);
    assert_refused(SF_STATUS_INVALID_VALUE, "coordinate 1 of vertex 2 is nan", sf_scene_add_mesh(scene, &mesh, error));
    sf_scene_destroy(scene);
}

static void test_mesh_bad_values_are_refused(void **state) {
    (void)state;
    sf_scene *scene = new_scene();
    square s = make_square(1, 0, 1);
    const uint32_t beyond[6] = {0, 1, 2, 0, 2, 4};
    sf_mesh mesh = square_mesh(&s, 0.5f, 0), good = mesh;
    mesh.triangles = beyond;
    assert_refused(SF_STATUS_INVALID_VALUE, "triangle 1 has vertex index 4; the mesh has 4",
                   sf_scene_add_mesh(scene, &mesh, error));
    mesh = good;
    mesh.albedo[1] = 1.5f;
    assert_refused(SF_STATUS_INVALID_VALUE, "albedo[1] is 1.5", sf_scene_add_mesh(scene, &mesh, error));
    mesh = good;
    mesh.emission[2] = -1;
    assert_refused(SF_STATUS_INVALID_VALUE, "emission[2] is -1", sf_scene_add_mesh(scene, &mesh, error));
    mesh = good;
    mesh.emission[0] = NAN;
    assert_refused(SF_STATUS_INVALID_VALUE, "emission[0] is nan", sf_scene_add_mesh(scene, &mesh, error));
    mesh = good;
    mesh.triangle_count = 0;
    assert_refused(SF_STATUS_INVALID_VALUE, "has 0 triangles", sf_scene_add_mesh(scene, &mesh, error));
    mesh = good;
    mesh.vertices = NULL;
    assert_refused(SF_STATUS_INVALID_VALUE, "has 0 vertices", sf_scene_add_mesh(scene, &mesh, error));
    sf_scene_destroy(scene);
}

static void test_material_bad_values_are_refused(void **state) {
    (void)state;
    sf_scene *scene = new_scene();
    square s = make_square(1, 0, 1);
    sf_mesh mesh = square_mesh(&s, 0.5f, 0);
    const sf_material_kind rough[] = {SF_MATERIAL_DIELECTRIC, SF_MATERIAL_CONDUCTOR};
    for (int i = 0; i < 2; ++i) {
        mesh.material = (sf_material){.kind = rough[i], .ior = 1.5f, .roughness = 1.25f};
        assert_refused(SF_STATUS_INVALID_VALUE, "roughness is 1.25", sf_scene_add_mesh(scene, &mesh, error));
        mesh.material.roughness = NAN;
        assert_refused(SF_STATUS_INVALID_VALUE, "roughness is nan", sf_scene_add_mesh(scene, &mesh, error));
    }
    mesh.material = (sf_material){.kind = SF_MATERIAL_DIELECTRIC};
    assert_refused(SF_STATUS_INVALID_VALUE, "ior is 0; it must be in [0.1, 10]",
                   sf_scene_add_mesh(scene, &mesh, error));
    mesh.material.kind = (sf_material_kind)4;
    assert_refused(SF_STATUS_INVALID_VALUE, "material kind is 4", sf_scene_add_mesh(scene, &mesh, error));
    mesh.material = (sf_material){.kind = SF_MATERIAL_DIFFUSE, .ior = NAN, .roughness = 7}; /* not read */
    assert_ok(sf_scene_add_mesh(scene, &mesh, error));
    sf_scene_destroy(scene);
}

static void test_light_without_area_is_refused_and_one_with_some_is_taken(void **state) {
    (void)state;
    sf_scene *scene = new_scene();
    const uint32_t flat[6] = {0, 1, 1, 2, 2, 2}, half[6] = {0, 1, 1, 0, 2, 3};
    square s = make_square(1, 0, 1);
    sf_mesh mesh = square_mesh(&s, 0, 1);
    mesh.triangles = flat;
    assert_refused(SF_STATUS_INVALID_VALUE, "a light needs an area", sf_scene_add_mesh(scene, &mesh, error));
    mesh.triangles = half;
    assert_ok(sf_scene_add_mesh(scene, &mesh, error));
    assert_ok(sf_scene_commit(scene, error));
    sf_scene_info info;
    assert_ok(sf_scene_get_info(scene, &info, error));
    assert_int_equal(info.degenerate_count, 1);
    assert_int_equal(info.light_count, 1);
    assert_int_equal(info.rectangle_light_count, 0);
    sf_scene_destroy(scene);
}

static void test_camera_bad_values_are_refused(void **state) {
    (void)state;
    sf_scene *scene = new_scene();
    sf_camera camera = sf_camera_default();
    camera.target[2] = 1;
    assert_refused(SF_STATUS_INVALID_VALUE, "looks at itself", sf_scene_set_camera(scene, &camera, error));
    camera = sf_camera_default();
    camera.up[1] = 0;
    camera.up[2] = 3;
    assert_refused(SF_STATUS_INVALID_VALUE, "along the line of sight", sf_scene_set_camera(scene, &camera, error));
    const float angles[] = {0, 180, -1, NAN};
    for (size_t i = 0; i < 4; ++i) {
        camera = sf_camera_default();
        camera.vertical_fov = angles[i];
        assert_refused(SF_STATUS_INVALID_VALUE, "vertical_fov", sf_scene_set_camera(scene, &camera, error));
    }
    camera = sf_camera_default();
    camera.aperture_radius = -0.1f;
    assert_refused(SF_STATUS_INVALID_VALUE, "aperture_radius is -0.1", sf_scene_set_camera(scene, &camera, error));
    camera = sf_camera_default();
    camera.focus_distance = -1;
    assert_refused(SF_STATUS_INVALID_VALUE, "focus_distance is -1", sf_scene_set_camera(scene, &camera, error));
    camera = sf_camera_default();
    camera.position[0] = INFINITY;
    assert_refused(SF_STATUS_INVALID_VALUE, "camera position[0] is inf", sf_scene_set_camera(scene, &camera, error));
    sf_scene_destroy(scene);
}

static void test_scene_in_the_wrong_state_is_refused(void **state) {
    (void)state;
    sf_scene *scene = new_scene();
    sf_plan plan;
    assert_refused(SF_STATUS_INVALID_VALUE, "no mesh", sf_scene_commit(scene, error));
    assert_refused(SF_STATUS_INVALID_VALUE, "not committed", sf_scene_get_plan(scene, &plan, error));
    assert_refused(SF_STATUS_INVALID_VALUE, "max_bounces is 65", sf_scene_set_max_bounces(scene, 65, error));
    square s = make_square(1, 0, 1);
    sf_mesh mesh = square_mesh(&s, 0.5f, 1);
    assert_ok(sf_scene_add_mesh(scene, &mesh, error));
    assert_ok(sf_scene_commit(scene, error));
    assert_refused(SF_STATUS_INVALID_VALUE, "is committed", sf_scene_commit(scene, error));
    assert_refused(SF_STATUS_INVALID_VALUE, "is committed", sf_scene_add_mesh(scene, &mesh, error));
    sf_scene_destroy(scene);
    sf_scene_destroy(NULL);
}

static void test_coplanar_pair_is_one_rectangle_light_however_it_is_indexed(void **state) {
    (void)state;
    /* The same square by four shared vertices, by six of its own, and split along the other diagonal. */
    const float apart[18] = {0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 0, 0, 2, 1, 0, 0, 1, 0};
    const uint32_t six[6] = {0, 1, 2, 3, 4, 5}, other[6] = {1, 2, 3, 1, 3, 0};
    square s = make_square(1, 0, 1);
    sf_mesh meshes[3] = {square_mesh(&s, 0, 1), square_mesh(&s, 0, 1), square_mesh(&s, 0, 1)};
    meshes[1].vertices = apart;
    meshes[1].vertex_count = 6;
    meshes[1].triangles = six;
    meshes[2].triangles = other;
    for (int i = 0; i < 3; ++i) {
        sf_scene *scene = new_scene();
        assert_ok(sf_scene_add_mesh(scene, &meshes[i], error));
        assert_ok(sf_scene_commit(scene, error));
        sf_scene_info info;
        assert_ok(sf_scene_get_info(scene, &info, error));
        assert_int_equal(info.light_count, 1);
        assert_int_equal(info.rectangle_light_count, 1);
        sf_scene_destroy(scene);
    }
}

static void test_folded_pair_and_kite_are_two_triangle_lights(void **state) {
    (void)state;
    const float folded[12] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0.5f},
                kite[12] = {-1, -1, 0, 1, -1, 0, 2, 2, 0, -1, 1, 0};
    const float *shapes[] = {folded, kite};
    for (int i = 0; i < 2; ++i) {
        sf_scene *scene = new_scene();
        square s;
        memcpy(s.vertices, shapes[i], sizeof s.vertices);
        sf_mesh mesh = square_mesh(&s, 0, 1);
        assert_ok(sf_scene_add_mesh(scene, &mesh, error));
        assert_ok(sf_scene_commit(scene, error));
        assert_int_equal(scene->lights.count, 2);
        assert_int_equal(scene->lights.rectangle_count, 0);
        sf_scene_destroy(scene);
    }
}

/* The alias table's probability of each piece, summed over its columns, is area x radiance. */
static void test_lights_are_drawn_in_proportion_to_area_times_radiance(void **state) {
    (void)state;
    sf_scene *scene = new_scene();
    square s[5];
    double power[5], total = 0, drawn[5] = {0};
    for (int i = 0; i < 5; ++i) {
        s[i] = make_square(0.3f * (float)(i + 1), (float)i, 1);
        float radiance = i == 2 ? 100 : 1 + (float)i;
        sf_mesh mesh = square_mesh(&s[i], 0, radiance);
        assert_ok(sf_scene_add_mesh(scene, &mesh, error));
        power[i] = 0.36 * (i + 1) * (i + 1) * (double)radiance;
        total += power[i];
    }
    assert_ok(sf_scene_commit(scene, error));
    const sf_light_table *lights = &scene->lights;
    assert_int_equal(lights->count, 5);
    for (size_t i = 0; i < 5; ++i) {
        double keep = (double)lights->pieces[i][SF_LIGHT_KEEP];
        drawn[i] += keep / 5;
        drawn[lights->alias[i]] += (1 - keep) / 5;
    }
    for (int i = 0; i < 5; ++i) {
        assert_true(fabs(drawn[i] - power[i] / total) < 1e-6); /* float probabilities, five terms */
        double area = 0.36 * (i + 1) * (i + 1);
        assert_true(fabs((double)lights->pieces[i][SF_LIGHT_PDF] * area / drawn[i] - 1) < 1e-5);
    }
    sf_scene_destroy(scene);
}

static void test_plan_of_direct_light_has_four_dimensions_and_one_shadow_ray(void **state) {
    (void)state;
    lit_floor s;
    lit_floor_create(&s, 1);
    sf_plan plan = plan_of(s.scene);
    assert_int_equal(plan.dimensions_per_path, 4);
    assert_int_equal(plan.shadow_rays, 1);
    assert_int_equal(plan.surface_rays, 0);
    assert_true(runs(&plan, SF_STAGE_CAMERA) && runs(&plan, SF_STAGE_LIGHT) && runs(&plan, SF_STAGE_EMISSION));
    assert_false(runs(&plan, SF_STAGE_LENS) || runs(&plan, SF_STAGE_MISS) || runs(&plan, SF_STAGE_CHOOSE_LIGHT));
    assert_false(runs(&plan, SF_STAGE_SURFACE) || runs(&plan, SF_STAGE_LAST_SURFACE) || runs(&plan, SF_STAGE_WEIGHT));
    sf_scene_destroy(s.scene);
}

static void test_plan_of_no_bounces_has_the_pixel_only(void **state) {
    (void)state;
    lit_floor s;
    lit_floor_create(&s, 0);
    sf_plan plan = plan_of(s.scene);
    assert_int_equal(plan.dimensions_per_path, 2);
    assert_int_equal(plan.shadow_rays + plan.surface_rays, 0);
    sf_scene_destroy(s.scene);
}

static void test_plan_grows_with_lens_lights_background_and_bounces(void **state) {
    (void)state;
    sf_scene *scene = new_scene();
    square floor = make_square(5, 0, 1), a = make_square(1, 3, -1), b = make_square(1, 4, -1);
    sf_mesh meshes[3] = {square_mesh(&floor, 0.5f, 0), square_mesh(&a, 0, 1), square_mesh(&b, 0, 1)};
    for (int i = 0; i < 3; ++i) assert_ok(sf_scene_add_mesh(scene, &meshes[i], error));
    sf_camera camera = camera_at(0, -4, 2, 0, 0, 0, 30);
    camera.aperture_radius = 0.1f;
    const float sky[3] = {0, 0, 1};
    assert_ok(sf_scene_set_camera(scene, &camera, error));
    assert_ok(sf_scene_set_background(scene, sky, error));
    assert_ok(sf_scene_set_max_bounces(scene, 3, error));
    assert_ok(sf_scene_commit(scene, error));
    sf_plan plan = plan_of(scene);
    /* pixel 2, lens 2, and at each of three vertices light 2, choice 1, surface 2 */
    assert_int_equal(plan.dimensions_per_path, 2 + 2 + 3 * 5);
    assert_int_equal(plan.shadow_rays, 3);
    assert_int_equal(plan.surface_rays, 3);
    for (int stage = 0; stage < SF_STAGE_COUNT; ++stage)
        assert_int_equal(runs(&plan, (sf_stage)stage),
                         stage != SF_STAGE_CAMERA && stage != SF_STAGE_INSTANCES && stage != SF_STAGE_QUADRIC &&
                             stage != SF_STAGE_SKY && stage != SF_STAGE_LIGHT_SHAPES && stage != SF_STAGE_SCATTER &&
                             stage != SF_STAGE_FOG && stage != SF_STAGE_LIGHT_TREE);
    sf_scene_destroy(scene);
}

static void test_plan_of_a_scene_without_light_traces_camera_rays_only(void **state) {
    (void)state;
    sf_scene *scene = new_scene();
    square floor = make_square(5, 0, 1);
    sf_mesh mesh = square_mesh(&floor, 0.5f, 0);
    assert_ok(sf_scene_add_mesh(scene, &mesh, error));
    assert_ok(sf_scene_commit(scene, error));
    sf_plan plan = plan_of(scene);
    assert_int_equal(plan.stages, 1u << SF_STAGE_CAMERA | 1u << SF_STAGE_INTERSECT);
    assert_int_equal(plan.dimensions_per_path, 2);
    sf_scene_destroy(scene);
}

static void test_hash_sees_every_value_that_decides_the_picture(void **state) {
    (void)state;
    uint64_t hashes[10];
    for (int change = 0; change < 10; ++change) {
        sf_scene *scene = new_scene();
        square s = make_square(1, 0, 1);
        if (change == 1) s.vertices[11] = 0x1p-140f;
        sf_mesh mesh = square_mesh(&s, change == 2 ? 0.25f : 0.5f, 1);
        if (change >= 6) mesh.material.kind = change < 9 ? SF_MATERIAL_DIELECTRIC : SF_MATERIAL_MIRROR;
        if (change == 7) mesh.material.ior = 1.25f;
        if (change == 8) mesh.material.roughness = 0.5f;
        sf_camera camera = sf_camera_default();
        if (change == 3) camera.vertical_fov = 41;
        const float background[3] = {0, change == 4 ? 1.0f : 0.0f, 0};
        assert_ok(sf_scene_add_mesh(scene, &mesh, error));
        assert_ok(sf_scene_set_camera(scene, &camera, error));
        assert_ok(sf_scene_set_background(scene, background, error));
        assert_ok(sf_scene_set_max_bounces(scene, change == 5 ? 4 : 5, error));
        assert_ok(sf_scene_commit(scene, error));
        sf_scene_info info;
        assert_ok(sf_scene_get_info(scene, &info, error));
        hashes[change] = info.hash;
        for (int other = 0; other < change; ++other) assert_true(hashes[other] != hashes[change]);
        sf_scene_destroy(scene);
    }
}

/* An array that ends with its page is copied, every other is read in place. */
static void test_arrays_are_copied_only_where_embree_would_read_past_the_page(void **state) {
    (void)state;
    char *pages = NULL;
    assert_int_equal(posix_memalign((void **)&pages, 4096, 4096), 0);
    for (int in_place = 0; in_place < 2; ++in_place) {
        square s = make_square(1, 0, 1);
        float *vertices = (float *)(pages + 4096 - sizeof s.vertices) - in_place;
        memcpy(vertices, s.vertices, sizeof s.vertices);
        sf_scene *scene = new_scene();
        sf_mesh mesh = square_mesh(&s, 0.5f, 1);
        mesh.vertices = vertices;
        assert_ok(sf_scene_add_mesh(scene, &mesh, error));
        assert_ok(sf_scene_commit(scene, error));
        sf_scene_info info;
        assert_ok(sf_scene_get_info(scene, &info, error));
        assert_int_equal(info.copied_bytes, in_place ? 0 : sizeof s.vertices);
        sf_scene_destroy(scene);
    }
    free(pages);
}

static void test_embrees_lack_of_memory_is_told_as_such(void **state) {
    (void)state;
    sf_error error;
    assert_int_equal(sf_fail_embree(&error, RTC_ERROR_OUT_OF_MEMORY, "refused shape %d", 7), SF_STATUS_OUT_OF_MEMORY);
    assert_string_equal(error.message, "out of memory: Embree refused shape 7");
    assert_int_equal(sf_fail_embree(&error, RTC_ERROR_INVALID_OPERATION, "refused shape %d", 7), SF_STATUS_BACKEND);
    assert_string_equal(error.message, "Embree refused shape 7 (its error 3)");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_embrees_lack_of_memory_is_told_as_such),
        cmocka_unit_test(test_mesh_with_a_nan_vertex_is_refused_with_its_number),
        cmocka_unit_test(test_mesh_bad_values_are_refused),
        cmocka_unit_test(test_material_bad_values_are_refused),
        cmocka_unit_test(test_light_without_area_is_refused_and_one_with_some_is_taken),
        cmocka_unit_test(test_camera_bad_values_are_refused),
        cmocka_unit_test(test_scene_in_the_wrong_state_is_refused),
        cmocka_unit_test(test_coplanar_pair_is_one_rectangle_light_however_it_is_indexed),
        cmocka_unit_test(test_folded_pair_and_kite_are_two_triangle_lights),
        cmocka_unit_test(test_lights_are_drawn_in_proportion_to_area_times_radiance),
        cmocka_unit_test(test_plan_of_direct_light_has_four_dimensions_and_one_shadow_ray),
        cmocka_unit_test(test_plan_of_no_bounces_has_the_pixel_only),
        cmocka_unit_test(test_plan_grows_with_lens_lights_background_and_bounces),
        cmocka_unit_test(test_plan_of_a_scene_without_light_traces_camera_rays_only),
        cmocka_unit_test(test_hash_sees_every_value_that_decides_the_picture),
        cmocka_unit_test(test_arrays_are_copied_only_where_embree_would_read_past_the_page),
    };
    return cmocka_run_group_tests_name("scene", tests, NULL, NULL);
}
