// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "bind_scene.h"

#include <algorithm>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

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

sf_sphere make_sphere(const vector3 &centre, double radius, const vector3 &albedo, const vector3 &emission,
                      const material_values &material) {
    sf_sphere sphere = sf_sphere_default();
    to_floats(centre, sphere.centre);
    sphere.radius = static_cast<float>(radius);
    to_floats(albedo, sphere.albedo);
    to_floats(emission, sphere.emission);
    sphere.material = make_material(material);
    return sphere;
}

sf_disk make_disk(const vector3 &centre, const vector3 &normal, double radius, const vector3 &albedo,
                  const vector3 &emission, const material_values &material) {
    sf_disk disk = sf_disk_default();
    to_floats(centre, disk.centre);
    to_floats(normal, disk.normal);
    disk.radius = static_cast<float>(radius);
    to_floats(albedo, disk.albedo);
    to_floats(emission, disk.emission);
    disk.material = make_material(material);
    return disk;
}

sf_sun make_sun(const vector3 &direction, double angular_radius, const vector3 &irradiance) {
    sf_sun sun = sf_sun_default();
    to_floats(direction, sun.direction);
    sun.angular_radius = static_cast<float>(angular_radius);
    to_floats(irradiance, sun.irradiance);
    return sun;
}

using environment_image = nb::ndarray<const float, nb::shape<-1, -1, 3>, nb::c_contig, nb::device::cpu>;

sf_environment make_environment(const environment_image &image, const vector3 &up, double rotation) {
    sf_environment environment = sf_environment_default();
    environment.pixels = image.data();
    environment.width = static_cast<uint32_t>(std::min<size_t>(image.shape(1), UINT32_MAX));
    environment.height = static_cast<uint32_t>(std::min<size_t>(image.shape(0), UINT32_MAX));
    to_floats(up, environment.up);
    environment.rotation = static_cast<float>(rotation);
    return environment;
}

using mesh_values = std::tuple<vertex_array, triangle_array, vector3, vector3, material_values>;

std::vector<sf_mesh> make_meshes(const std::vector<mesh_values> &values) {
    std::vector<sf_mesh> meshes;
    for (const auto &[vertices, triangles, albedo, emission, material] : values)
        meshes.push_back(make_mesh(vertices, triangles, albedo, emission, material));
    return meshes;
}

using transform_array = nb::ndarray<const float, nb::shape<-1, 3, 4>, nb::c_contig, nb::device::cpu>;
using albedo_array = std::optional<rows_of_three<float>>;

sf_instances make_instances(const transform_array &transforms, const albedo_array &albedos) {
    return {transforms.data(), transforms.shape(0), albedos ? albedos->data() : nullptr};
}

nb::tuple to_tuple(const float *v) { return nb::make_tuple(v[0], v[1], v[2]); }

nb::typed<nb::dict, nb::str, nb::any> info_of(const scene_handle &scene) {
    sf_scene_info info;
    call([&](sf_error *error) { return sf_scene_get_info(scene.scene, &info, error); });
    nb::dict d;
    d["mesh_count"] = info.mesh_count;
    d["sphere_count"] = info.sphere_count;
    d["disk_count"] = info.disk_count;
    d["sun_count"] = info.sun_count;
    d["instance_count"] = info.instance_count;
    d["triangle_count"] = info.triangle_count;
    d["unique_triangle_count"] = info.unique_triangle_count;
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
    away from_python;
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
        "check_sphere",
        [](const vector3 &centre, double radius, const vector3 &albedo, const vector3 &emission,
           const material_values &material) {
            scene_handle scratch;
            sf_sphere sphere = make_sphere(centre, radius, albedo, emission, material);
            call([&](sf_error *error) { return sf_scene_add_sphere(scratch.scene, &sphere, error); });
        },
        "centre"_a, "radius"_a, "albedo"_a, "emission"_a, "material"_a);
    m.def(
        "check_disk",
        [](const vector3 &centre, const vector3 &normal, double radius, const vector3 &albedo, const vector3 &emission,
           const material_values &material) {
            scene_handle scratch;
            sf_disk disk = make_disk(centre, normal, radius, albedo, emission, material);
            call([&](sf_error *error) { return sf_scene_add_disk(scratch.scene, &disk, error); });
        },
        "centre"_a, "normal"_a, "radius"_a, "albedo"_a, "emission"_a, "material"_a);
    m.def(
        "check_instances",
        [](const std::vector<mesh_values> &meshes, transform_array transforms, const albedo_array &albedos) {
            scene_handle scratch;
            std::vector<sf_mesh> made = make_meshes(meshes);
            sf_instances instances = make_instances(transforms, albedos);
            uint32_t prototype;
            call([&](sf_error *error) {
                sf_status status = sf_scene_add_prototype(scratch.scene, made.data(), made.size(), &prototype, error);
                return status ? status : sf_instances_check(&instances, error);
            });
        },
        "meshes"_a, "transforms"_a.noconvert(), "albedos"_a.noconvert().none());
    m.def(
        "check_sun",
        [](const vector3 &direction, double angular_radius, const vector3 &irradiance) {
            scene_handle scratch;
            sf_sun sun = make_sun(direction, angular_radius, irradiance);
            call([&](sf_error *error) { return sf_scene_add_sun(scratch.scene, &sun, error); });
        },
        "direction"_a, "angular_radius"_a, "irradiance"_a);
    m.def(
        "check_environment",
        [](environment_image image, const vector3 &up, double rotation) {
            scene_handle scratch;
            sf_environment environment = make_environment(image, up, rotation);
            call([&](sf_error *error) { return sf_scene_set_environment(scratch.scene, &environment, error); });
        },
        "image"_a.noconvert(), "up"_a, "rotation"_a);
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
            "add_sphere",
            [](scene_handle &self, const vector3 &centre, double radius, const vector3 &albedo, const vector3 &emission,
               const material_values &material) {
                sf_sphere sphere = make_sphere(centre, radius, albedo, emission, material);
                call([&](sf_error *error) { return sf_scene_add_sphere(self.scene, &sphere, error); });
            },
            "centre"_a, "radius"_a, "albedo"_a, "emission"_a, "material"_a)
        .def(
            "add_disk",
            [](scene_handle &self, const vector3 &centre, const vector3 &normal, double radius, const vector3 &albedo,
               const vector3 &emission, const material_values &material) {
                sf_disk disk = make_disk(centre, normal, radius, albedo, emission, material);
                call([&](sf_error *error) { return sf_scene_add_disk(self.scene, &disk, error); });
            },
            "centre"_a, "normal"_a, "radius"_a, "albedo"_a, "emission"_a, "material"_a)
        .def(
            "add_prototype",
            [](scene_handle &self, const std::vector<mesh_values> &meshes) {
                std::vector<sf_mesh> made = make_meshes(meshes);
                uint32_t prototype;
                call([&](sf_error *error) {
                    return sf_scene_add_prototype(self.scene, made.data(), made.size(), &prototype, error);
                });
                for (const mesh_values &values : meshes) {
                    self.arrays.push_back(nb::cast(std::get<0>(values)));
                    self.arrays.push_back(nb::cast(std::get<1>(values)));
                }
                return prototype;
            },
            "meshes"_a)
        .def(
            "add_instances",
            [](scene_handle &self, uint32_t prototype, transform_array transforms, const albedo_array &albedos) {
                sf_instances instances = make_instances(transforms, albedos);
                call([&](sf_error *error) { return sf_scene_add_instances(self.scene, prototype, &instances, error); });
            },
            "prototype"_a, "transforms"_a.noconvert(), "albedos"_a.noconvert().none())
        .def(
            "add_sun",
            [](scene_handle &self, const vector3 &direction, double angular_radius, const vector3 &irradiance) {
                sf_sun sun = make_sun(direction, angular_radius, irradiance);
                call([&](sf_error *error) { return sf_scene_add_sun(self.scene, &sun, error); });
            },
            "direction"_a, "angular_radius"_a, "irradiance"_a)
        .def(
            "set_environment",
            [](scene_handle &self, environment_image image, const vector3 &up, double rotation) {
                sf_environment environment = make_environment(image, up, rotation);
                call([&](sf_error *error) { return sf_scene_set_environment(self.scene, &environment, error); });
            },
            // The renderer reads the pixels for as long as the scene lives.
            nb::keep_alive<1, 2>(), "image"_a.noconvert(), "up"_a, "rotation"_a)
        .def(
            "set_light_sampling",
            [](scene_handle &self, const std::string &name) {
                int k = find_name("light_sampling", name,
                                  [](int i) { return sf_light_sampling_name(static_cast<sf_light_sampling>(i)); });
                call([&](sf_error *error) {
                    return sf_scene_set_light_sampling(self.scene, static_cast<sf_light_sampling>(k), error);
                });
            },
            "light_sampling"_a)
        .def(
            "set_light_choice",
            [](scene_handle &self, const std::string &name) {
                int k = find_name("light_choice", name,
                                  [](int i) { return sf_light_choice_name(static_cast<sf_light_choice>(i)); });
                call([&](sf_error *error) {
                    return sf_scene_set_light_choice(self.scene, static_cast<sf_light_choice>(k), error);
                });
            },
            "light_choice"_a)
        .def(
            "set_solid_angle_ratio",
            [](scene_handle &self, double ratio) {
                call([&](sf_error *error) {
                    return sf_scene_set_solid_angle_ratio(self.scene, static_cast<float>(ratio), error);
                });
            },
            "ratio"_a)
        .def(
            "set_fog",
            [](scene_handle &self, double scattering, double absorption, double g) {
                sf_fog fog = {static_cast<float>(scattering), static_cast<float>(absorption), static_cast<float>(g)};
                call([&](sf_error *error) { return sf_scene_set_fog(self.scene, &fog, error); });
            },
            "scattering"_a, "absorption"_a, "g"_a)
        .def(
            "set_robust",
            [](scene_handle &self, bool robust) {
                call([&](sf_error *error) { return sf_scene_set_robust(self.scene, robust, error); });
            },
            "robust"_a)
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
