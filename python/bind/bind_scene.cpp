// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "bind_scene.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

namespace {

using vertex_array = rows_of_three<float>;
using triangle_array = rows_of_three<uint32_t>;

// Kind, ior, roughness.
using material_values = std::tuple<std::string, double, double>;

sf_material make_material(const material_values &values) {
    const auto &[kind, ior, roughness] = values;
    int k = 0;
    while (sf_material_kind_name(static_cast<sf_material_kind>(k)) &&
           kind != sf_material_kind_name(static_cast<sf_material_kind>(k)))
        ++k;
    return {static_cast<sf_material_kind>(k), static_cast<float>(ior), static_cast<float>(roughness)};
}

sf_mesh make_mesh(const vertex_array &vertices, const triangle_array &triangles, const vector3 &albedo,
                  const vector3 &emission, const material_values &material) {
    sf_mesh mesh = sf_mesh_default();
    mesh.vertices = vertices.data();
    mesh.vertex_count = vertices.shape(0);
    mesh.triangles = triangles.data();
    mesh.triangle_count = triangles.shape(0);
    to_floats(albedo, mesh.albedo);
    to_floats(emission, mesh.emission);
    mesh.material = make_material(material);
    return mesh;
}

sf_camera make_camera(const vector3 &position, const vector3 &target, const vector3 &up, double vertical_fov,
                      double aperture_radius, double focus_distance) {
    sf_camera camera = sf_camera_default();
    to_floats(position, camera.position);
    to_floats(target, camera.target);
    to_floats(up, camera.up);
    camera.vertical_fov = static_cast<float>(vertical_fov);
    camera.aperture_radius = static_cast<float>(aperture_radius);
    camera.focus_distance = static_cast<float>(focus_distance);
    return camera;
}

nb::tuple to_tuple(const float *v) { return nb::make_tuple(v[0], v[1], v[2]); }

nb::typed<nb::dict, nb::str, nb::any> info_of(const scene_handle &scene) {
    sf_scene_info info;
    call([&](sf_error *error) { return sf_scene_get_info(scene.scene, &info, error); });
    nb::dict d;
    d["mesh_count"] = info.mesh_count;
    d["triangle_count"] = info.triangle_count;
    d["light_count"] = info.light_count;
    d["rectangle_light_count"] = info.rectangle_light_count;
    d["degenerate_count"] = info.degenerate_count;
    d["copied_bytes"] = info.copied_bytes;
    d["bounds_lower"] = to_tuple(info.bounds_lower);
    d["bounds_upper"] = to_tuple(info.bounds_upper);
    d["hash"] = info.hash;
    return d;
}

nb::typed<nb::dict, nb::str, nb::any> plan_of(const scene_handle &scene) {
    sf_plan plan;
    call([&](sf_error *error) { return sf_scene_get_plan(scene.scene, &plan, error); });
    nb::list stages, dimensions;
    for (int k = 0; k < SF_STAGE_COUNT; ++k)
        if (plan.stages >> k & 1) stages.append(sf_stage_name(static_cast<sf_stage>(k)));
    for (uint32_t i = 0; i < plan.dimension_group_count; ++i) {
        const sf_plan_dimensions &group = plan.dimensions[i];
        dimensions.append(nb::make_tuple(sf_dimension_use_name(group.use), group.bounce, group.first, group.count));
    }
    nb::dict d;
    d["stages"] = stages;
    d["dimensions"] = dimensions;
    d["dimensions_per_path"] = plan.dimensions_per_path;
    d["camera_rays"] = plan.camera_rays;
    d["shadow_rays"] = plan.shadow_rays;
    d["surface_rays"] = plan.surface_rays;
    d["max_bounces"] = plan.max_bounces;
    return d;
}

}  // namespace

scene_handle::scene_handle() {
    call([&](sf_error *error) { return sf_scene_create(&scene, error); });
}

scene_handle::~scene_handle() {
    nb::gil_scoped_release released;
    sf_scene_destroy(scene);
}

void bind_scene(nb::module_ &m) {
    // C checks a mesh or a camera when a scene takes it; a scene of its own is the way to ask early.
    m.def(
        "check_mesh",
        [](vertex_array vertices, triangle_array triangles, const vector3 &albedo, const vector3 &emission,
           const material_values &material) {
            scene_handle scratch;
            sf_mesh mesh = make_mesh(vertices, triangles, albedo, emission, material);
            call([&](sf_error *error) { return sf_scene_add_mesh(scratch.scene, &mesh, error); });
        },
        "vertices"_a.noconvert(), "triangles"_a.noconvert(), "albedo"_a, "emission"_a, "material"_a);
    m.def(
        "check_material",
        [](const material_values &values) {
            sf_material material = make_material(values);
            call([&](sf_error *error) { return sf_material_check(&material, error); });
        },
        "material"_a);
    m.def(
        "check_camera",
        [](const vector3 &position, const vector3 &target, const vector3 &up, double vertical_fov,
           double aperture_radius, double focus_distance) {
            scene_handle scratch;
            sf_camera camera = make_camera(position, target, up, vertical_fov, aperture_radius, focus_distance);
            call([&](sf_error *error) { return sf_scene_set_camera(scratch.scene, &camera, error); });
        },
        "position"_a, "target"_a, "up"_a, "vertical_fov"_a, "aperture_radius"_a, "focus_distance"_a);

    nb::class_<scene_handle>(m, "Scene")
        .def(nb::init<>())
        .def(
            "add_mesh",
            [](scene_handle &self, vertex_array vertices, triangle_array triangles, const vector3 &albedo,
               const vector3 &emission, const material_values &material) {
                sf_mesh mesh = make_mesh(vertices, triangles, albedo, emission, material);
                call([&](sf_error *error) { return sf_scene_add_mesh(self.scene, &mesh, error); });
            },
            // Embree reads both arrays for as long as the scene lives.
            nb::keep_alive<1, 2>(), nb::keep_alive<1, 3>(), "vertices"_a.noconvert(), "triangles"_a.noconvert(),
            "albedo"_a, "emission"_a, "material"_a)
        .def(
            "set_camera",
            [](scene_handle &self, const vector3 &position, const vector3 &target, const vector3 &up,
               double vertical_fov, double aperture_radius, double focus_distance) {
                sf_camera camera = make_camera(position, target, up, vertical_fov, aperture_radius, focus_distance);
                call([&](sf_error *error) { return sf_scene_set_camera(self.scene, &camera, error); });
            },
            "position"_a, "target"_a, "up"_a, "vertical_fov"_a, "aperture_radius"_a, "focus_distance"_a)
        .def(
            "set_background",
            [](scene_handle &self, const vector3 &background) {
                float radiance[3];
                to_floats(background, radiance);
                call([&](sf_error *error) { return sf_scene_set_background(self.scene, radiance, error); });
            },
            "background"_a)
        .def(
            "set_max_bounces",
            [](scene_handle &self, uint32_t max_bounces) {
                call([&](sf_error *error) { return sf_scene_set_max_bounces(self.scene, max_bounces, error); });
            },
            "max_bounces"_a)
        .def("commit",
             [](scene_handle &self) { call([&](sf_error *error) { return sf_scene_commit(self.scene, error); }); })
        .def("info", &info_of)
        .def("plan", &plan_of);
}
