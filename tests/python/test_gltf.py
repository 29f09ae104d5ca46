# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""gltf: nodes, cameras, materials, accessors of all kinds, and what is refused."""

import base64
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sunfleck as sf

POSITIONS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [2, 0, 0]], dtype=np.float32)


class Document:
    """A glTF with one buffer, built up by accessor."""

    def __init__(self) -> None:
        self.data = b""
        self.tree: dict[str, Any] = {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "accessors": [],
            "bufferViews": [],
        }
        self.tree["meshes"] = [{"primitives": [{"attributes": {"POSITION": self.accessor(POSITIONS[:3])}}]}]

    @property
    def primitive(self) -> dict[str, Any]:
        primitive: dict[str, Any] = self.tree["meshes"][0]["primitives"][0]
        return primitive

    def view(self, data: bytes, **more: Any) -> int:
        self.data += b"\0" * (-len(self.data) % 4)
        self.tree["bufferViews"].append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data), **more})
        self.data += data
        return len(self.tree["bufferViews"]) - 1

    def accessor(self, values: np.ndarray, **more: Any) -> int:
        component = {"int8": 5120, "uint8": 5121, "int16": 5122, "uint16": 5123, "uint32": 5125, "float32": 5126}
        self.tree["accessors"].append(
            {
                "bufferView": self.view(values.tobytes()),
                "componentType": component[values.dtype.name],
                "count": len(values),
                "type": "SCALAR" if values.ndim == 1 else f"VEC{values.shape[1]}",
                **more,
            }
        )
        return len(self.tree["accessors"]) - 1

    def material(self, **material: Any) -> None:
        self.tree.setdefault("materials", []).append(material)
        self.primitive["material"] = len(self.tree["materials"]) - 1

    def finished(self) -> dict[str, Any]:
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        return {**self.tree, "buffers": [{"byteLength": len(self.data), "uri": uri}]}

    def load(self, folder: Path) -> sf.Scene:
        path = folder / "t.gltf"
        path.write_text(json.dumps(self.finished()))
        return sf.load(path)


@pytest.fixture
def document() -> Document:
    return Document()


def corners(scene: sf.Scene, mesh: int = 0) -> list[Any]:
    found = scene.meshes[mesh]
    values: list[Any] = found.vertices[found.triangles].tolist()
    return values


# ---- accessors and primitives ----


def test_a_triangle_without_indices(document: Document, tmp_path: Path) -> None:
    assert corners(document.load(tmp_path)) == [POSITIONS[:3].tolist()]


@pytest.mark.parametrize("dtype", ["uint8", "uint16", "uint32"])
def test_indices(document: Document, tmp_path: Path, dtype: str) -> None:
    document.primitive["indices"] = document.accessor(np.array([2, 0, 1], dtype=dtype))
    assert corners(document.load(tmp_path)) == [POSITIONS[[2, 0, 1]].tolist()]


@pytest.mark.parametrize(
    ("mode", "expected"),
    [(4, [[0, 1, 2]]), (5, [[0, 1, 2], [1, 3, 2], [2, 3, 4]]), (6, [[1, 2, 0], [2, 3, 0], [3, 4, 0]])],
)
def test_modes_of_triangles(document: Document, tmp_path: Path, mode: int, expected: list[list[int]]) -> None:
    document.primitive["attributes"]["POSITION"] = document.accessor(POSITIONS)
    document.primitive["mode"] = mode
    assert corners(document.load(tmp_path)) == POSITIONS[expected].tolist()


def test_a_buffer_view_with_a_stride(document: Document, tmp_path: Path) -> None:
    wide = np.full((3, 5), 99, dtype=np.float32)
    wide[:, 1:4] = POSITIONS[:3]
    view = document.view(wide.tobytes(), byteStride=20)
    document.tree["accessors"][0].update(bufferView=view, byteOffset=4)
    assert corners(document.load(tmp_path)) == [POSITIONS[:3].tolist()]


@pytest.mark.parametrize("base", [True, False])
def test_sparse_accessors(document: Document, tmp_path: Path, base: bool) -> None:
    accessor = document.tree["accessors"][0]
    if not base:
        del accessor["bufferView"]
    accessor["sparse"] = {
        "count": 2,
        "indices": {"bufferView": document.view(np.array([1, 2], dtype=np.uint16).tobytes()), "componentType": 5123},
        "values": {"bufferView": document.view(np.array([[5, 0, 0], [0, 6, 0]], dtype=np.float32).tobytes())},
    }
    assert corners(document.load(tmp_path)) == [[[0, 0, 0], [5, 0, 0], [0, 6, 0]]]


def test_quantized_positions(document: Document, tmp_path: Path) -> None:
    document.tree["extensionsRequired"] = ["KHR_mesh_quantization"]
    quantized = np.array([[0, 0, 0], [32767, 0, 0], [0, -32768, 0]], dtype=np.int16)
    document.primitive["attributes"]["POSITION"] = document.accessor(quantized, normalized=True)
    assert corners(document.load(tmp_path)) == [[[0, 0, 0], [1, 0, 0], [0, -1, 0]]]
    document.tree["accessors"][-1]["normalized"] = False
    assert corners(document.load(tmp_path))[0][1] == [32767, 0, 0]


def test_lines_and_points_are_left_out(document: Document, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    document.tree["meshes"][0]["primitives"].append({"attributes": {"POSITION": 0}, "mode": 1})
    with caplog.at_level("INFO", logger="sunfleck"):
        assert len(document.load(tmp_path).meshes) == 2  # the triangle, and the light it is given
    assert "points and lines are left out" in caplog.text


# ---- nodes ----


def test_transforms_of_a_chain_of_nodes(document: Document, tmp_path: Path) -> None:
    half = np.sqrt(0.5)
    document.tree["nodes"] = [
        {"children": [1], "translation": [10, 0, 0], "scale": [2, 2, 2]},
        {"children": [2], "rotation": [0, 0, half, half]},  # a quarter turn about z
        {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1]},
    ]
    assert np.allclose(corners(document.load(tmp_path)), [[[10, 0, 10], [10, 2, 10], [8, 0, 10]]], atol=1e-6)


def test_a_mirror_turns_triangles_over(document: Document, tmp_path: Path) -> None:
    document.tree["nodes"] = [{"mesh": 0, "scale": [-1, 1, 1]}]
    a, b, c = np.array(corners(document.load(tmp_path))[0])
    assert np.cross(b - a, c - a)[2] > 0


def test_a_mesh_may_be_shown_twice_and_only_the_scene_counts(document: Document, tmp_path: Path) -> None:
    document.tree["nodes"] = [{"mesh": 0}, {"mesh": 0, "translation": [0, 0, 3]}, {"mesh": 0}]
    document.tree["scenes"] = [{"nodes": [2]}, {"nodes": [0, 1]}]
    document.tree["scene"] = 1
    scene = document.load(tmp_path)
    assert len(scene.meshes) == 3
    assert corners(scene, 1)[0][0] == [0, 0, 3]


def test_without_scenes_the_roots_are_shown(document: Document, tmp_path: Path) -> None:
    del document.tree["scenes"], document.tree["scene"]
    document.tree["nodes"] = [{"mesh": 0}, {"children": [0], "translation": [0, 0, 3]}]
    scene = document.load(tmp_path)
    assert len(scene.meshes) == 2
    assert corners(scene)[0][0] == [0, 0, 3]


# ---- cameras ----


def test_a_camera_deep_in_the_tree(document: Document, tmp_path: Path) -> None:
    half = np.sqrt(0.5)
    document.tree["cameras"] = [
        {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 1}},
        {"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}},
    ]
    document.tree["nodes"] = [
        {"mesh": 0},
        {"camera": 0},
        {"children": [3], "rotation": [0, half, 0, half], "translation": [7, 0, 0]},  # -z becomes -x
        {"camera": 1, "translation": [0, 0, 1]},
    ]
    document.tree["scenes"] = [{"nodes": [0, 1, 2]}]
    camera = document.load(tmp_path).camera
    assert np.allclose(camera.position, (8, 0, 0))
    direction = np.subtract(camera.target, camera.position)
    assert np.allclose(direction / np.linalg.norm(direction), (-1, 0, 0), atol=1e-6)
    assert np.allclose(camera.up, (0, 1, 0))
    assert camera.vertical_fov == pytest.approx(np.degrees(0.5))


# ---- materials ----


def test_base_colour_and_emission(document: Document, tmp_path: Path) -> None:
    document.material(
        pbrMetallicRoughness={"baseColorFactor": [0.1, 0.2, 0.3, 1]},
        emissiveFactor=[1, 0.5, 0],
        extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 20}},
    )
    document.tree["extensionsRequired"] = ["KHR_materials_emissive_strength"]
    scene = document.load(tmp_path)
    assert scene.meshes[0].albedo == (0.1, 0.2, 0.3)
    assert scene.meshes[0].emission == (20, 10, 0)
    assert len(scene.meshes) == 1  # it has a light of its own


def test_directional_lights_are_suns_and_others_are_counted(
    document: Document, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    lights = [{"type": "point"}, {"type": "directional", "color": [1, 0.5, 0], "intensity": 4}, {"type": "spot"}]
    document.tree["extensions"] = {"KHR_lights_punctual": {"lights": lights}}
    document.tree["extensionsRequired"] = ["KHR_lights_punctual"]
    turned = [0, 2**-0.5, 0, 2**-0.5]  # by 90 degrees about y: -z becomes -x
    for index in range(3):
        document.tree["nodes"].append({"rotation": turned, "extensions": {"KHR_lights_punctual": {"light": index}}})
    document.tree["scenes"][0]["nodes"] = [0, 1, 2, 3]
    with caplog.at_level("INFO", "sunfleck"):
        scene = document.load(tmp_path)
    [sun] = scene.suns
    assert sun.direction == pytest.approx((1, 0, 0), abs=1e-7)  # where the light comes from
    assert (sun.angular_radius, sun.irradiance) == (0, (4, 2, 0))
    assert len(scene.meshes) == 1  # the sun is light enough
    assert "2 point and spot lights are left out" in caplog.text


def test_no_material_is_mid_grey(document: Document, tmp_path: Path) -> None:
    assert document.load(tmp_path).meshes[0].albedo == (0.5, 0.5, 0.5)


def test_textures_are_said_not_to_be_read(document: Document, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    document.material(
        pbrMetallicRoughness={"baseColorTexture": {"index": 0}, "baseColorFactor": [1, 0.5, 1, 1]},
        emissiveFactor=[1, 1, 1],
        emissiveTexture={"index": 0},
    )
    with caplog.at_level("INFO", logger="sunfleck"):
        mesh = document.load(tmp_path).meshes[0]
    assert (mesh.albedo, mesh.emission) == ((0.5, 0.25, 0.5), (0, 0, 0))
    assert "textures are not read" in caplog.text
    assert "emissive textures are not read" in caplog.text


# ---- files ----


def glb(document: Document) -> bytes:
    tree = {**document.tree, "buffers": [{"byteLength": len(document.data)}]}
    text, data = json.dumps(tree).encode(), document.data
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


def test_glb(document: Document, tmp_path: Path) -> None:
    path = tmp_path / "t.glb"
    path.write_bytes(glb(document))
    assert corners(sf.load(path)) == [POSITIONS[:3].tolist()]


def test_a_buffer_in_a_file_beside(document: Document, tmp_path: Path) -> None:
    (tmp_path / "with space.bin").write_bytes(document.data)
    tree = {**document.tree, "buffers": [{"byteLength": len(document.data), "uri": "with%20space.bin"}]}
    path = tmp_path / "t.gltf"
    path.write_text(json.dumps(tree))
    assert corners(sf.load(path)) == [POSITIONS[:3].tolist()]
    tree["buffers"][0]["uri"] = "missing.bin"
    path.write_text(json.dumps(tree))
    with pytest.raises(FileNotFoundError, match=r"missing\.bin"):
        sf.load(path)
    tree["buffers"][0]["uri"] = "https://example.org/a.bin"
    path.write_text(json.dumps(tree))
    with pytest.raises(NotImplementedError, match=r"example\.org"):
        sf.load(path)


def change(path: str, value: Any) -> Any:
    """Sets one place of a document's tree: "accessors/0/count"."""

    def changed(document: Document) -> None:
        *where, last = path.split("/")
        place: Any = document.tree
        for key in where:
            place = place[int(key) if isinstance(place, list) else key]
        place[int(last) if isinstance(place, list) else last] = value

    return changed


@pytest.mark.parametrize(
    ("spoil", "error", "match"),
    [
        (change("asset", {"version": "1.0"}), NotImplementedError, "version 1.0"),
        (change("asset", {}), ValueError, "version"),
        (change("extensionsRequired", ["KHR_draco_mesh_compression"]), NotImplementedError, "draco"),
        (change("accessors/0/count", 4), ValueError, "buffer"),
        (change("accessors/0/count", 2**62), (ValueError, MemoryError), "."),
        (change("accessors/0/count", -1), ValueError, "-1"),
        (change("accessors/0/count", "3"), ValueError, "malformed"),
        (change("accessors/0/componentType", 1), ValueError, "1"),
        (change("accessors/0/byteOffset", 4), ValueError, "buffer"),
        (change("accessors/0/byteOffset", -4), ValueError, "reaches beyond"),
        (change("accessors/0", {"count": 3, "componentType": 5126, "type": "VEC3"}), ValueError, "one point"),
        (change("bufferViews/0/byteLength", 10**9), ValueError, "reaches beyond"),
        (change("bufferViews/0/buffer", 7), ValueError, r"buffers\[7\]"),
        (change("bufferViews/0/byteStride", 4), ValueError, "4 bytes apart"),
        (change("nodes/0", {"mesh": 5}), ValueError, r"meshes\[5\]"),
        (change("nodes/0", {"mesh": -1}), ValueError, r"meshes\[-1\]"),
        (change("nodes/0", {"children": [0]}), ValueError, "twice over"),
        (change("nodes/0", {"mesh": 0, "matrix": [1, 2, 3]}), ValueError, "reshape"),
        (change("nodes/0", {"mesh": 0, "rotation": [0, 0, 0, 0]}), ValueError, "nan"),
        (change("nodes/0", {"mesh": 0, "scale": [1e30, 1, 1]}), ValueError, "1e.30"),
        (change("nodes/0", []), ValueError, "not an object"),
        (change("scene", 3), ValueError, r"scenes\[3\]"),
        (change("meshes/0/primitives/0/mode", 9), ValueError, "mode 9"),
        (change("meshes/0/primitives/0/material", 0), ValueError, r"materials\[0\]"),
        (change("meshes/0/primitives", []), ValueError, "no triangles"),
    ],
)
def test_what_is_malformed_is_refused(document: Document, tmp_path: Path, spoil: Any, error: Any, match: str) -> None:
    spoil(document)
    with pytest.raises(error, match=match):
        document.load(tmp_path)


@pytest.mark.parametrize("factor", [[2, 0, 0, 1], [-1, 0, 0, 1], ["a", 0, 0, 1], [1], None])
def test_a_bad_base_colour_is_refused(document: Document, tmp_path: Path, factor: Any) -> None:
    document.material(pbrMetallicRoughness={"baseColorFactor": factor})
    with pytest.raises(ValueError, match=r"t\.gltf"):
        document.load(tmp_path)
