# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""gltf_material: which material of the renderer each kind of glTF's becomes, and what is refused."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sunfleck as sf
from sunfleck.scene.material import Material

WHITE = (1.0, 1.0, 1.0)
GLASS = "KHR_materials_transmission"


TRIANGLE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=np.float32)


def load(folder: Path, *materials: Any, positions: np.ndarray = TRIANGLE, required: Any = ()) -> sf.Scene:
    """A file of the same triangles in each material; without one, in none."""
    data = positions.tobytes()
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    primitives: list[dict[str, Any]] = [{"material": index} for index in range(len(materials))] or [{}]
    tree = {
        "asset": {"version": "2.0"},
        "extensionsRequired": list(required),
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, **more} for more in primitives]}],
        "materials": materials,
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(positions), "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": len(data)}],
        "buffers": [{"byteLength": len(data), "uri": uri}],
    }
    path = folder / "t.gltf"
    path.write_text(json.dumps(tree))
    return sf.load(path)


def surface(folder: Path, pbr: Any, required: Any = (), **material: Any) -> Material | None:
    """What a file's mesh is made of; None for ``pbr`` leaves pbrMetallicRoughness out."""
    material = material if pbr is None else {"pbrMetallicRoughness": pbr, **material}
    return load(folder, material, required=required).meshes[0].material


@pytest.mark.parametrize(
    ("pbr", "expected"),
    [
        ({}, None),  # the specification's defaults: a metal so rough that it is nearer to diffuse
        ({"roughnessFactor": 0.6}, sf.Conductor(0.6)),
        ({"roughnessFactor": 0.61}, None),
        ({"roughnessFactor": 0.3, "metallicRoughnessTexture": {"index": 0}}, None),
        ({"roughnessFactor": 0.3}, sf.Conductor(0.3)),
        ({"metallicFactor": 1, "roughnessFactor": 0}, sf.Conductor(0.0)),
        ({"metallicFactor": 0.5, "roughnessFactor": 0.25}, sf.Conductor(0.25)),
        ({"metallicFactor": 0.49, "roughnessFactor": 0.25}, None),
        ({"metallicFactor": 0, "roughnessFactor": 0}, None),
        (None, None),
    ],
)
def test_metal_from_half_on(tmp_path: Path, pbr: Any, expected: Any) -> None:
    assert surface(tmp_path, pbr) == expected


@pytest.mark.parametrize(
    ("pbr", "extensions", "expected"),
    [
        ({"metallicFactor": 0}, {GLASS: {}}, None),  # transmissionFactor is 0 by default
        ({"metallicFactor": 0}, {GLASS: {"transmissionFactor": 0.49}}, None),
        ({"metallicFactor": 0, "roughnessFactor": 0}, {GLASS: {"transmissionFactor": 0.5}}, sf.Dielectric(1.5, 0)),
        ({"metallicFactor": 0.2}, {GLASS: {"transmissionFactor": 1}}, sf.Dielectric(1.5, 1)),
        (
            {"metallicFactor": 0, "roughnessFactor": 0.4},
            {GLASS: {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 1.33}},
            sf.Dielectric(1.33, 0.4),
        ),
        ({"metallicFactor": 0}, {GLASS: {"transmissionFactor": 1}, "KHR_materials_ior": {}}, sf.Dielectric(1.5, 1)),
        ({"metallicFactor": 0}, {"KHR_materials_ior": {"ior": 2}}, None),
        ({"metallicFactor": 0}, {"KHR_materials_ior": {"ior": 0}}, None),  # legal; the surface does not use it
        (None, {GLASS: {"transmissionFactor": 1}}, sf.Dielectric(1.5, 1)),
        ({"roughnessFactor": 0.1}, {GLASS: {"transmissionFactor": 1}}, sf.Conductor(0.1)),  # metal lets nothing through
    ],
)
def test_glass_from_half_on(tmp_path: Path, pbr: Any, extensions: Any, expected: Any) -> None:
    assert surface(tmp_path, pbr, required=sorted(extensions), extensions=extensions) == expected


def test_a_mesh_without_a_material_is_grey(tmp_path: Path) -> None:
    mesh = load(tmp_path).meshes[0]
    assert (mesh.material, mesh.albedo) == (None, (0.5, 0.5, 0.5))


def test_a_material_without_the_object_is_white_and_diffuse(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level("INFO", logger="sunfleck"):
        mesh = load(tmp_path, {"name": "says nothing"}).meshes[0]
    assert (mesh.material, mesh.albedo) == (None, WHITE)
    assert "without pbrMetallicRoughness are taken as diffuse" in caplog.text


def test_emission_goes_with_any_material(tmp_path: Path) -> None:
    pbr = {"baseColorFactor": [0.9, 0.6, 0.3, 1], "roughnessFactor": 0.5}
    mesh = load(tmp_path, {"pbrMetallicRoughness": pbr, "emissiveFactor": [1, 0, 0.5]}).meshes[0]
    assert (mesh.material, mesh.albedo, mesh.emission) == (sf.Conductor(0.5), (0.9, 0.6, 0.3), (1, 0, 0.5))


@pytest.mark.parametrize(
    ("material", "message"),
    [
        ({"pbrMetallicRoughness": {"metallicFactor": 0.7}}, "metallicFactor 0.5 or more are metal"),
        ({"pbrMetallicRoughness": {"metallicRoughnessTexture": {"index": 0}}}, "taken as no metal"),
        ({"pbrMetallicRoughness": {}}, "beyond 0.6 is taken as diffuse"),
        ({"extensions": {GLASS: {"transmissionFactor": 0.7}}}, "transmissionFactor 0.5 or more are glass"),
        ({"extensions": {GLASS: {"transmissionTexture": {"index": 0}}}}, "transmissionFactor stands alone"),
        ({"extensions": {"KHR_materials_clearcoat": {}}}, "KHR_materials_clearcoat of materials is not read"),
        ({"extensions": {"KHR_materials_volume": {}}}, "KHR_materials_volume of materials is not read"),
        ({"normalTexture": {"index": 0}}, "normal maps are not read"),
        ({"alphaMode": "BLEND"}, "materials of alphaMode BLEND are opaque"),
        ({"alphaMode": "MASK"}, "materials of alphaMode MASK are opaque"),
    ],
)
def test_what_is_assumed_is_said_once(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, material: Any, message: str
) -> None:
    with caplog.at_level("INFO", logger="sunfleck"):
        load(tmp_path, material, material)
    assert caplog.text.count(message) == 1


def test_an_opaque_diffuse_material_is_said_nothing_of(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level("INFO", logger="sunfleck"):
        surface(tmp_path, {"metallicFactor": 0}, alphaMode="OPAQUE")
    assert [record.getMessage() for record in caplog.records if "material" in record.getMessage()] == []


@pytest.mark.parametrize(
    ("material", "match"),
    [
        ({"pbrMetallicRoughness": {"metallicFactor": 2}}, r"metallicFactor is 2\.0; it must be in \[0, 1\]"),
        ({"pbrMetallicRoughness": {"metallicFactor": -0.1}}, r"metallicFactor is -0\.1"),
        ({"pbrMetallicRoughness": {"metallicFactor": float("nan")}}, "metallicFactor is nan"),
        ({"pbrMetallicRoughness": {"metallicFactor": "a"}}, "metallicFactor is 'a'; give a number"),
        ({"pbrMetallicRoughness": {"metallicFactor": None}}, "metallicFactor is None"),
        ({"pbrMetallicRoughness": {"metallicFactor": True}}, "metallicFactor is True"),
        ({"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 1.5}}, r"roughnessFactor is 1\.5"),
        ({"pbrMetallicRoughness": {"roughnessFactor": []}}, r"roughnessFactor is \[\]"),
        ({"pbrMetallicRoughness": []}, "malformed"),
        ({"extensions": {GLASS: {"transmissionFactor": 1.1}}}, r"transmissionFactor is 1\.1"),
        ({"extensions": {GLASS: {"transmissionFactor": "1"}}}, "transmissionFactor is '1'"),
        ({"extensions": {GLASS: 1}}, "malformed"),
        ({"extensions": {GLASS: {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 0}}}, r"ior is 0; .*0\.1"),
        ({"extensions": {GLASS: {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 11}}}, "ior is 11"),
        ({"extensions": {"KHR_materials_ior": {"ior": "1.5"}}}, r"ior is '1\.5'; give a number"),
        ({"extensions": []}, "malformed"),
    ],
)
def test_bad_values_are_refused(tmp_path: Path, material: Any, match: str) -> None:
    with pytest.raises(ValueError, match=rf"t\.gltf: .*{match}"):
        load(tmp_path, material)


# ---- rendered ----

SQUARE = np.array([[-5, -5], [5, -5], [5, 5], [-5, -5], [5, 5], [-5, 5]], dtype=np.float32)


def level(folder: Path, material: Any, heights: list[float], spp: int) -> np.ndarray:
    """Seen along the normal, before a white background: squares at those heights, wound to face up, down, up, ..."""
    faces = [np.column_stack([SQUARE[:: -1 if i % 2 else 1], np.full(6, z, np.float32)]) for i, z in enumerate(heights)]
    camera = sf.Camera((0, 0, 10), (0, 0, 0), up=(0, 1, 0), vertical_fov=0.01)
    scene = sf.Scene(
        load(folder, material, positions=np.concatenate(faces)).meshes[:1], camera, background=WHITE, max_bounces=16
    )
    color: np.ndarray = sf.render(scene, 8, 8, spp=spp).color.mean(axis=(0, 1))
    return color


def test_metal_reflects_its_base_colour_at_normal_incidence(tmp_path: Path) -> None:
    """A smooth one: every path's value is the colour itself, as Schlick's (1 - cos)^5 is below 1e-35 so near the
    normal; what remains is the rounding of float32 and of the sum."""
    metal = {"pbrMetallicRoughness": {"baseColorFactor": [0.9, 0.6, 0.3, 1], "roughnessFactor": 0}}
    assert level(tmp_path, metal, [0], spp=16) == pytest.approx([0.9, 0.6, 0.3], abs=1e-5)


@pytest.mark.parametrize("ior", [None, 2.0])
def test_glass_lets_light_through(tmp_path: Path, ior: float | None) -> None:
    """A pane of colour c in a white surrounding: F + (1 - F) c^2, of what is reflected by Fresnel's
    equations at its front, untinted, and what crosses two borders after any number of reflections inside.

    A path brings 1 with probability F, else c^2: its deviation is sqrt(F (1 - F)) (1 - c^2), at most 0.315 (F = 1/9,
    c = 0), and of 65,536 paths' mean 0.00123; the tolerance is 5 of it. Diffuse panes would bring c < 1, opaque ones F.
    """
    extensions: dict[str, Any] = {GLASS: {"transmissionFactor": 1}}
    if ior is not None:
        extensions["KHR_materials_ior"] = {"ior": ior}
    pbr = {"metallicFactor": 0, "roughnessFactor": 0, "baseColorFactor": [1, 0.5, 0, 1]}
    glass = {"pbrMetallicRoughness": pbr, "extensions": extensions}
    reflected = ((ior or 1.5) - 1) ** 2 / ((ior or 1.5) + 1) ** 2
    expected = [reflected + (1 - reflected) * c**2 for c in (1, 0.5, 0)]
    assert level(tmp_path, glass, [0, -1], spp=1024) == pytest.approx(expected, abs=0.0062)
