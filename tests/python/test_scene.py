# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""scene: arrays in place, what a scene holds, the plan, bad input."""

import gc
from typing import Any, cast

import numpy as np
import pytest

import sunfleck as sf

VERTICES = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=np.float32)
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.uint32)
CAMERA = sf.Camera((0, 0, 3), (0, 0, 0))


def quad(**options: Any) -> sf.Mesh:
    return sf.Mesh(VERTICES, TRIANGLES, **options)


def lamp(z: float = 2) -> sf.Mesh:
    """Faces down."""
    return sf.Mesh(
        VERTICES + np.array([0, 0, z], dtype=np.float32), TRIANGLES[:, ::-1], albedo=(0, 0, 0), emission=(1, 1, 1)
    )


# ---- materials ----


def test_a_material_s_albedo_is_white_unless_given() -> None:
    assert quad().albedo == (0.5, 0.5, 0.5)
    assert quad().material is None
    assert quad(material=sf.Dielectric()).albedo == (1.0, 1.0, 1.0)
    assert quad(material=sf.Conductor(), albedo=(0.9, 0.6, 0.3)).albedo == (0.9, 0.6, 0.3)


@pytest.mark.parametrize(
    ("make", "kind", "message"),
    [
        (lambda: sf.Dielectric(ior=0), ValueError, r"ior is 0; it must be in \[0.1, 10\]"),
        (lambda: sf.Dielectric(ior=float("nan")), ValueError, "ior is nan"),
        (lambda: sf.Dielectric(roughness=-0.5), ValueError, "roughness is -0.5"),
        (lambda: sf.Conductor(cast("Any", "rough")), TypeError, "roughness is 'rough'"),
        (lambda: quad(material="mirror"), TypeError, "material is 'mirror'; give a Mirror"),
        (lambda: quad(material=sf.Mirror), TypeError, "give a Mirror"),
    ],
)
def test_bad_materials_are_refused(make: Any, kind: type[Exception], message: str) -> None:
    with pytest.raises(kind, match=message):
        make()


def test_scenes_of_different_materials_have_different_hashes() -> None:
    materials = [None, sf.Mirror(), sf.Dielectric(), sf.Dielectric(1.33), sf.Dielectric(roughness=0.1), sf.Conductor()]
    meshes = [quad(albedo=(1, 1, 1), material=material) for material in materials]
    assert len({sf.Scene([mesh], CAMERA).info.hash for mesh in meshes}) == len(materials)


# ---- meshes ----


def test_arrays_of_the_right_kind_are_used_in_place() -> None:
    mesh = quad()
    assert mesh.vertices is VERTICES
    assert mesh.triangles is TRIANGLES


@pytest.mark.parametrize("dtype", ["float64", "float16", "int32", ">f4"])
def test_other_vertices_are_converted(dtype: str) -> None:
    mesh = sf.Mesh(VERTICES.astype(dtype), TRIANGLES)
    assert mesh.vertices.dtype == np.float32
    assert np.array_equal(mesh.vertices, VERTICES)


@pytest.mark.parametrize("dtype", ["int64", "int32", "uint8", "uint64", ">u4"])
def test_other_indices_are_converted(dtype: str) -> None:
    mesh = sf.Mesh(VERTICES, TRIANGLES.astype(dtype))
    assert mesh.triangles.dtype == np.uint32
    assert np.array_equal(mesh.triangles, TRIANGLES)


def test_lists_and_strided_arrays_are_converted() -> None:
    assert np.array_equal(sf.Mesh(VERTICES.tolist(), TRIANGLES.tolist()).vertices, VERTICES)
    strided = np.repeat(VERTICES, 2, axis=0)[::2]
    assert np.array_equal(sf.Mesh(strided, TRIANGLES).vertices, VERTICES)


def changed(row: int, column: int, value: float) -> np.ndarray:
    vertices = VERTICES.astype("float64")
    vertices[row, column] = value
    return vertices


@pytest.mark.parametrize(
    ("arguments", "error", "match"),
    [
        ((changed(2, 1, np.nan), TRIANGLES), ValueError, "coordinate 1 of vertex 2 is .*nan"),
        ((changed(3, 0, np.inf), TRIANGLES), ValueError, "vertex 3 is inf"),
        ((changed(3, 0, 1e300), TRIANGLES), ValueError, "vertex 3 is inf"),
        ((changed(3, 0, 1e19), TRIANGLES), ValueError, "1e.19"),
        ((VERTICES[:2], [[0, 1, 1]]), ValueError, "2 vertices"),
        ((VERTICES[:, :2], TRIANGLES), ValueError, r"vertices has shape \(4, 2\)"),
        ((VERTICES.ravel(), TRIANGLES), ValueError, r"vertices has shape \(12,\)"),
        (([["a", "b", "c"]] * 3, TRIANGLES), TypeError, "vertices has dtype"),
        ((VERTICES + 0j, TRIANGLES), TypeError, "complex"),
        ((VERTICES > 0, TRIANGLES), TypeError, "bool"),
        (([[0, 0, 0], [1, 1]], TRIANGLES), ValueError, "vertices is not a regular array"),
        ((None, TRIANGLES), TypeError, "object"),
        ((VERTICES, TRIANGLES.astype(float)), TypeError, "triangles has dtype float64"),
        ((VERTICES, "012"), TypeError, "triangles has dtype"),
        ((VERTICES, TRIANGLES.ravel()), ValueError, r"triangles has shape \(6,\)"),
        ((VERTICES, np.zeros((0, 3), dtype=np.uint32)), ValueError, "0 triangles"),
        ((VERTICES, [[0, 1, 4]]), ValueError, "triangle 0 .*4.* 4 vertices"),
        ((VERTICES, np.array([[0, 1, 2], [0, 1, 4]], dtype=np.uint32)), ValueError, "triangle 1 .*4.* 4 vertices"),
        ((VERTICES, [[0, 1, -1]]), ValueError, "-1"),
        ((VERTICES, np.array([[0, 1, 2**32]])), ValueError, "4294967296"),
        ((VERTICES, TRIANGLES, (1.5, 0, 0)), ValueError, r"albedo\[0\] is 1.5"),
        ((VERTICES, TRIANGLES, (0, -0.1, 0)), ValueError, r"albedo\[1\] is -0.1"),
        ((VERTICES, TRIANGLES, (0, 0, np.nan)), ValueError, r"albedo\[2\] is .*nan"),
        ((VERTICES, TRIANGLES, 0.5), ValueError, "albedo"),
        ((VERTICES, TRIANGLES, "red"), TypeError, "albedo"),
        ((VERTICES, TRIANGLES, (0.5, 0.5)), ValueError, "albedo"),
        ((VERTICES, TRIANGLES, (0, 0, 0), (0, -1, 0)), ValueError, r"emission\[1\] is -1"),
        ((VERTICES, TRIANGLES, (0, 0, 0), (0, np.inf, 0)), ValueError, r"emission\[1\] is inf"),
        ((VERTICES, [[0, 0, 0]], (0, 0, 0), (1, 1, 1)), ValueError, "area"),
    ],
)
def test_a_bad_mesh_is_refused_and_named(arguments: Any, error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=match):
        sf.Mesh(*arguments)


# ---- camera ----


@pytest.mark.parametrize(
    ("options", "error", "match"),
    [
        ({"target": (0, 0, 3)}, ValueError, "looks at itself"),
        ({"up": (0, 0, 1)}, ValueError, "up"),
        ({"up": (0, 0, 0)}, ValueError, "up"),
        ({"position": (0, np.nan, 0)}, ValueError, "position"),
        ({"position": (0, 0)}, ValueError, "position has shape"),
        ({"position": "here"}, TypeError, "position"),
        ({"vertical_fov": 0}, ValueError, "vertical_fov is 0"),
        ({"vertical_fov": 180}, ValueError, "vertical_fov is 180"),
        ({"vertical_fov": np.nan}, ValueError, "vertical_fov"),
        ({"vertical_fov": "wide"}, TypeError, "vertical_fov"),
        ({"vertical_fov": 10**400}, ValueError, "vertical_fov"),
        ({"aperture_radius": -0.1}, ValueError, "aperture_radius is -0.1"),
        ({"focus_distance": 0}, ValueError, "focus_distance is 0"),
        ({"focus_distance": -1}, ValueError, "focus_distance is -1"),
    ],
)
def test_a_bad_camera_is_refused_and_named(options: dict[str, Any], error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=match):
        sf.Camera(**{"position": (0, 0, 3), "target": (0, 0, 0), **options})


def test_camera_defaults() -> None:
    assert (CAMERA.up, CAMERA.vertical_fov, CAMERA.aperture_radius) == ((0, 1, 0), 40, 0)
    assert CAMERA.focus_distance is None


# ---- scenes ----


@pytest.mark.parametrize(
    ("arguments", "error", "match"),
    [
        (([], CAMERA), ValueError, "no mesh"),
        ((quad(), CAMERA), TypeError, "meshes"),
        ((3, CAMERA), TypeError, "meshes"),
        (([quad(), VERTICES], CAMERA), TypeError, "meshes holds"),
        (([quad()], None), TypeError, "camera"),
        (([quad()], CAMERA, (0, -1, 0)), ValueError, r"background\[1\] is -1"),
        (([quad()], CAMERA, 1), ValueError, "background"),
        (([quad()], CAMERA, (0, 0, 0), 65), ValueError, "max_bounces is 65"),
        (([quad()], CAMERA, (0, 0, 0), -1), ValueError, "max_bounces is -1"),
        (([quad()], CAMERA, (0, 0, 0), 1.5), TypeError, "max_bounces"),
    ],
)
def test_a_bad_scene_is_refused_and_named(arguments: Any, error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=match):
        sf.Scene(*arguments)


def test_a_scene_looks_again_at_arrays_that_may_have_changed() -> None:
    vertices = VERTICES.copy()
    mesh = sf.Mesh(vertices, TRIANGLES)
    vertices[0, 0] = np.nan
    with pytest.raises(ValueError, match="vertex 0"):
        sf.Scene([mesh], CAMERA)


def test_info_says_what_a_scene_holds() -> None:
    info = sf.Scene([quad(), lamp()], CAMERA).info
    assert (info.mesh_count, info.triangle_count, info.light_count, info.rectangle_light_count) == (2, 4, 1, 1)
    assert (info.degenerate_count, info.copied_bytes) == (0, 0)
    assert (info.bounds_lower, info.bounds_upper) == ((-1, -1, 0), (1, 1, 2))


def test_equal_scenes_have_equal_hashes_and_others_do_not() -> None:
    first = sf.Scene([quad()], CAMERA)
    assert sf.Scene([quad()], CAMERA).info.hash == first.info.hash
    others = [
        sf.Scene([quad(albedo=(0.5, 0.5, 0.4))], CAMERA),
        sf.Scene([quad()], CAMERA, background=(0, 0, 1)),
        sf.Scene([quad()], CAMERA, max_bounces=4),
        sf.Scene([quad()], sf.Camera((0, 0, 3), (0, 0, 0), vertical_fov=41)),
    ]
    assert len({first.info.hash, *(scene.info.hash for scene in others)}) == 5


def test_degenerate_triangles_are_counted_and_said(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level("INFO", logger="sunfleck"):
        scene = sf.Scene([sf.Mesh(VERTICES, [[0, 1, 2], [0, 0, 3]])], CAMERA)
    assert scene.info.degenerate_count == 1
    assert "1 of 2 triangles have no area" in caplog.text


def test_a_scene_keeps_its_arrays_alive() -> None:
    scene = sf.Scene([sf.Mesh(VERTICES * 1, TRIANGLES * 1, emission=(1, 1, 1))], CAMERA, max_bounces=0)
    before = sf.render(scene, 16, 16, spp=2).color.copy()
    gc.collect()
    noise = [np.full_like(VERTICES, 1e6) for _ in range(1000)]
    assert np.array_equal(sf.render(scene, 16, 16, spp=2).color, before)
    assert len(noise) == 1000


def test_a_scene_says_what_it_was_made_of() -> None:
    mesh = quad()
    scene = sf.Scene([mesh], CAMERA, background=(0, 0, 1), max_bounces=3)
    assert (scene.meshes, scene.camera, scene.background, scene.max_bounces) == ((mesh,), CAMERA, (0, 0, 1), 3)
    with pytest.raises(AttributeError):
        scene.max_bounces = 4  # type: ignore[misc]


# ---- the plan ----


def names(scene: sf.Scene) -> list[str]:
    return [group.name for group in scene.plan().dimensions]


def test_a_scene_plans_what_it_needs_and_nothing_else() -> None:
    lens = sf.Camera((0, 0, 3), (0, 0, 0), aperture_radius=0.1)
    assert names(sf.Scene([quad()], CAMERA)) == ["pixel"]
    assert names(sf.Scene([quad()], lens)) == ["pixel", "lens"]
    assert names(sf.Scene([quad(), lamp()], CAMERA, max_bounces=0)) == ["pixel"]
    assert names(sf.Scene([quad(), lamp()], CAMERA, max_bounces=1)) == ["pixel", "light 1"]
    assert names(sf.Scene([quad(), lamp(), lamp(1)], CAMERA, max_bounces=1)) == ["pixel", "light 1", "choice 1"]
    assert names(sf.Scene([quad()], CAMERA, (1, 1, 1), 1)) == ["pixel", "surface 1"]
    both = sf.Scene([quad(), lamp()], CAMERA, max_bounces=2).plan()
    assert (both.camera_rays, both.shadow_rays, both.surface_rays, both.rays_per_path) == (1, 2, 1, 4)
    assert "miss" not in both.stages
    assert "miss" in sf.Scene([quad()], CAMERA, (0, 1, 0)).plan().stages


def test_a_plan_s_dimensions_follow_one_another() -> None:
    plan = sf.scenes.cornell().plan()
    first = 0
    for group in plan.dimensions:
        assert group.first == first
        first += group.count
    assert first == plan.dimensions_per_path


def test_a_plan_prints_as_a_table() -> None:
    table = str(sf.scenes.defocus().plan())
    assert "lens, intersect, emission, light" in table
    assert "at most 2 a path: 1 camera, 1 shadow, 0 surface" in table
    assert "4-5       light 1" in table
