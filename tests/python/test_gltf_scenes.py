# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""gltf: instances, emitters of two sides, hidden nodes, cameras, what is told, and what files may ask for."""

from __future__ import annotations

import base64
import itertools
import json
import os
import resource
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sunfleck as sf
from gltf_files import CAMERA, SQUARE, WHITE, box, glow, write_gltf


def icosphere(levels: int) -> tuple[np.ndarray, np.ndarray]:
    """20 * 4^levels triangles of radius 1."""
    golden = (1 + 5**0.5) / 2
    vertices = [(x, y * golden, 0) for x in (-1, 1) for y in (-1, 1)]
    vertices = [tuple(np.roll(v, k)) for k in range(3) for v in vertices]
    points = np.array(vertices)
    threes = itertools.combinations(range(12), 3)
    near = [t for t in threes if np.allclose([np.linalg.norm(points[t[k]] - points[t[k - 1]]) for k in range(3)], 2)]
    corners = points[np.array(near)]
    outward = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.einsum("nc,nc->n", outward, corners[:, 0]) < 0
    corners[inward] = corners[inward][:, ::-1]
    for _ in range(levels):
        a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        corners = np.concatenate([np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    flat = (corners / np.linalg.norm(corners, axis=2, keepdims=True)).reshape(-1, 3)
    return flat, np.arange(len(flat)).reshape(-1, 3)


BALL = icosphere(4)
N = 5120  # triangles of it, of which twice as many are copied, and no more


def color_of(scene: sf.Scene, spp: int = 64) -> np.ndarray:
    return np.asarray(sf.render(scene, 32, 32, spp=spp).color)


# ---- instances ----


def places(count: int) -> list[dict[str, Any]]:
    half = 0.5**0.5
    turn = [0, half, 0, half]
    return [
        {"mesh": 0, "translation": [3 * k, 0, 0], "scale": [(-1) ** k, 1, 1 + 0.1 * k], "rotation": turn}
        for k in range(count)
    ]


def test_nodes_that_share_a_mesh_of_many_triangles_are_instances_and_the_same_picture(tmp_path: Path) -> None:
    mesh = [(*BALL, 0)]
    camera = sf.Camera((9, 4, 14), (9, 0, 0))
    scene = sf.load(write_gltf(tmp_path, mesh, places(7)))
    assert (scene.info.instance_count, scene.info.triangle_count) == (7, 7 * N + 2)
    assert scene.info.unique_triangle_count == N + 2
    one_by_one = [sf.load(write_gltf(tmp_path, mesh, [node])).meshes[0] for node in places(7)]
    sky = (1.0, 1.0, 1.0)
    instanced = sf.Scene([shape for shape in scene.shapes if isinstance(shape, sf.Instances)], camera, sky, 2)
    flat = sf.Scene(one_by_one, camera, sky, 2)
    assert flat.info.instance_count == 0
    # The same paths, but for hits that rounding moves over an edge.
    assert np.abs(color_of(instanced) - color_of(flat)).max() < 0.05
    assert np.abs(color_of(instanced) - color_of(flat)).mean() < 2e-4


def test_few_triangles_are_copied_rather_than_instanced(tmp_path: Path) -> None:
    scene = sf.load(write_gltf(tmp_path, [(*BALL, 0)], places(2)))
    assert (scene.info.instance_count, scene.info.triangle_count) == (0, 2 * N + 2)


def test_emitters_are_instanced_too(tmp_path: Path) -> None:
    scene = sf.load(write_gltf(tmp_path, [(*BALL, 0)], places(7), [glow(3)]))
    assert (scene.info.instance_count, scene.info.light_count) == (7, 7 * N)
    mirrored = color_of(sf.Scene(scene.shapes, sf.Camera((9, 0, 14), (9, 0, 0), vertical_fov=5)))
    assert mirrored.min() == 3  # node 3, whose scale mirrors it, shines outwards


def test_singular_placements_are_flattened(tmp_path: Path) -> None:
    flat = [{"mesh": 0, "scale": [1, 0, 1], "translation": [3 * k, 0, 0]} for k in range(7)]
    scene = sf.load(write_gltf(tmp_path, [(*BALL, 0)], [*places(7), *flat]))
    assert (scene.info.instance_count, scene.info.triangle_count) == (7, 14 * N + 2)


def test_the_instancing_extension(tmp_path: Path) -> None:
    half = 0.5**0.5
    rows = [np.array([[0, 0, 0], [4, 0, 0], [8, 0, 0]]), np.array([[0, 0, 0, 1], [0, 0, half, half], [0, 0, 0, 2]])]
    scales = np.array([[1, 1, 1], [2, 1, 1], [0, 0, 0]])
    attributes = {"TRANSLATION": 2, "ROTATION": 3, "SCALE": 4}
    node = {
        "mesh": 0,
        "translation": [0, 0, 5],
        "extensions": {"EXT_mesh_gpu_instancing": {"attributes": attributes}},
    }
    path = write_gltf(tmp_path, [([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], 0)], [node], arrays=[*rows, scales])
    first, second, _ = sf.load(path).meshes  # the third is of scale 0; then the lamp
    assert first.vertices.tolist() == [[0, 0, 5], [1, 0, 5], [0, 1, 5]]
    assert np.allclose(second.vertices, [[4, 0, 5], [4, 2, 5], [3, 0, 5]], atol=1e-6)
    node["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 2, "SCALE": 0}}}
    path = write_gltf(tmp_path, [(*BALL, 0)], [node], arrays=rows)
    with pytest.raises(ValueError, match=r"\[3, 15360\] rows"):
        sf.load(path)


# ---- emitters of two sides ----

BELOW: list[dict[str, Any]] = [{"mesh": 0}, {"mesh": 1, "translation": [0, 2, 0]}]


def under_a_lamp(folder: Path, lamp: Any, **more: Any) -> sf.Scene:
    return sf.load(write_gltf(folder, [(*SQUARE, 0), (*lamp, 1)], BELOW, [WHITE, glow(5, **more)]))


def floor_seen(scene: sf.Scene) -> float:
    """The mean radiance of the middle of the floor, seen from the side beneath the lamp."""
    camera = sf.Camera((0, 0.5, 3), (0, 0, 0), vertical_fov=10)
    return float(color_of(sf.Scene(scene.shapes, camera, max_bounces=1), 256)[12:20].mean())


def test_a_double_sided_emitter_shines_on_both_sides_alike(tmp_path: Path) -> None:
    turned = (SQUARE[0], np.array(SQUARE[1])[:, ::-1])
    down = floor_seen(under_a_lamp(tmp_path, turned))
    assert down > 0.1
    assert floor_seen(under_a_lamp(tmp_path, SQUARE, doubleSided=True)) == pytest.approx(down, rel=0.02)
    assert floor_seen(under_a_lamp(tmp_path, turned, doubleSided=True)) == pytest.approx(down, rel=0.02)


@pytest.mark.parametrize("away", [0.0, 1e4])
@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("height", [3, -3])
def test_both_sides_are_seen_without_gaps(tmp_path: Path, scale: float, away: float, height: float) -> None:
    path = write_gltf(
        tmp_path,
        [(*SQUARE, 0)],
        [{"mesh": 0, "scale": [scale] * 3, "translation": [away * scale, 0, 0]}],
        [glow(5, doubleSided=True)],
    )
    camera = sf.Camera((away * scale, height * scale, 0), (away * scale, 0, 0), up=(0, 0, 1), vertical_fov=10)
    assert (color_of(sf.Scene(sf.load(path).shapes, camera)) == 5).all()


def test_closed_emitters_shine_inwards_only_where_something_is(tmp_path: Path) -> None:
    bulb = box((-0.2, 1, -0.2), (0.2, 1.4, 0.2))
    floor = (*SQUARE, 0)
    alone = write_gltf(tmp_path, [floor, (*bulb, 1)], (), [WHITE, glow(5, doubleSided=True)])
    assert sf.load(alone).info.light_count == 6
    dome = box((-9, -9, -9), (9, 9, 9))
    around = write_gltf(tmp_path, [floor, (*dome, 1)], (), [WHITE, glow(5, doubleSided=True)])
    scene = sf.load(around)
    assert scene.info.light_count == 12
    assert (color_of(sf.Scene(scene.shapes, sf.Camera((0, 5, 0), (0, 9, 1)))) == 5).all()
    eye: list[dict[str, Any]] = [{"mesh": 0}, {"camera": 0}]
    seen = sf.load(write_gltf(tmp_path, [(*dome, 0)], eye, [glow(5, doubleSided=True)], cameras=[CAMERA]))
    assert (color_of(seen) == 5).all()


# ---- what is hidden, what is missing ----


@pytest.mark.parametrize("scale", [[0, 0, 0], [0, 0, 1]])
def test_nodes_of_scale_zero_hide_what_is_below_them(
    tmp_path: Path, scale: list[float], caplog: pytest.LogCaptureFixture
) -> None:
    half = 0.5**0.5
    nodes: list[dict[str, Any]] = [
        {"mesh": 0},
        {"children": [2], "scale": scale},
        {"mesh": 1, "rotation": [0, half, 0, half]},
    ]
    path = write_gltf(tmp_path, [(*SQUARE, 0), (*BALL, 1)], nodes, [WHITE, glow(5)], scenes=[{"nodes": [0, 1]}])
    with caplog.at_level("INFO", "sunfleck"):
        scene = sf.load(path)
    assert scene.info.triangle_count == 2 + 2  # and the lamp
    assert "1 nodes are hidden" in caplog.text


def test_a_node_that_is_flattened_is_seen(tmp_path: Path) -> None:
    scene = sf.load(write_gltf(tmp_path, [(*BALL, 0)], [{"mesh": 0, "scale": [1, 0, 1]}]))
    assert scene.info.bounds_upper[0] > 0.9
    assert len(scene.meshes[0].triangles) == N


def test_invisible_nodes_are_hidden(tmp_path: Path) -> None:
    nodes: list[dict[str, Any]] = [{"mesh": 0}, {"mesh": 1, "extensions": {"KHR_node_visibility": {"visible": False}}}]
    scene = sf.load(write_gltf(tmp_path, [(*SQUARE, 0), (*BALL, 0)], nodes))
    assert scene.info.triangle_count == 4


def changed(path: Path, **accessor: Any) -> Path:
    """The file with an accessor instead of the first mesh's positions."""
    tree = json.loads(path.read_text())
    tree["accessors"][0] = {"componentType": 5126, "type": "VEC3", **accessor}
    path.write_text(json.dumps(tree))
    return path


def test_an_accessor_without_a_buffer_view_is_zeros(tmp_path: Path) -> None:
    path = changed(write_gltf(tmp_path, [(*SQUARE, 0), (*SQUARE, 0)]), count=4)
    assert (sf.load(path).meshes[0].vertices == 0).all()


# ---- cameras ----


@pytest.fixture
def three_cameras(tmp_path: Path) -> Path:
    nodes: list[dict[str, Any]] = [
        {"mesh": 0},
        {"camera": 0, "translation": [0, 1, 4], "name": "front"},
        {"camera": 0, "translation": [0, 1, -4], "rotation": [0, 1, 0, 0], "name": "back"},
        {"camera": 1, "translation": [0, 9, 4]},
    ]
    ours = {**CAMERA, "name": "own"}
    return write_gltf(tmp_path, [(*BALL, 0)], nodes, cameras=[CAMERA, ours])


@pytest.mark.parametrize(
    ("wanted", "position"),
    [
        (None, (0, 1, 4)),
        (0, (0, 1, 4)),
        ("back", (0, 1, -4)),
        (np.int64(1), (0, 1, -4)),
        ("1", (0, 1, -4)),
        ("own", (0, 9, 4)),
    ],
)
def test_a_camera_by_name_or_number(three_cameras: Path, wanted: Any, position: Any) -> None:
    assert sf.load(three_cameras, camera=wanted).camera.position == position


def test_cameras_are_told_where_there_is_a_choice(three_cameras: Path, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level("INFO", "sunfleck"):
        sf.load(three_cameras)
    assert "3 cameras: 0 'front', 1 'back', 2 'own'" in caplog.text


@pytest.mark.parametrize("wanted", ["left", 3, -1, "3", ""])
def test_a_camera_that_is_not_there_is_refused(three_cameras: Path, wanted: Any) -> None:
    with pytest.raises(ValueError, match=r"no one camera .*0 'front', 1 'back', 2 'own'"):
        sf.load(three_cameras, camera=wanted)


def test_a_camera_of_the_wrong_kind_or_of_another_file_is_refused(three_cameras: Path, tmp_path: Path) -> None:
    for wrong in (True, 1.0, ["front"]):
        with pytest.raises(TypeError, match="camera is"):
            sf.load(three_cameras, camera=wrong)  # type: ignore[arg-type]
    path = tmp_path / "t.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    with pytest.raises(ValueError, match="the file has none"):
        sf.load(path, camera=0)


# ---- notices ----


def told(folder: Path, caplog: pytest.LogCaptureFixture, attribute: str, rows: np.ndarray) -> str:
    path = write_gltf(folder, [(*BALL, 0)], arrays=[rows])
    tree = json.loads(path.read_text())
    tree["meshes"][0]["primitives"][0]["attributes"][attribute] = 2
    path.write_text(json.dumps(tree))
    with caplog.at_level("INFO", "sunfleck"):
        sf.load(path)
    return caplog.text


def test_smooth_normals_are_told(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    assert "normals of vertices are not read" in told(tmp_path, caplog, "NORMAL", BALL[0])


def test_flat_normals_are_not_told(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    a, b, c = (BALL[0][k::3] for k in range(3))
    flat = np.cross(b - a, c - a)
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    assert "normals of vertices" not in told(tmp_path, caplog, "NORMAL", np.repeat(flat, 3, axis=0))


@pytest.mark.parametrize(("color", "said"), [(0.5, True), (1.0, False)])
def test_colours_of_vertices_are_told_unless_white(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, color: float, said: bool
) -> None:
    text = told(tmp_path, caplog, "COLOR_0", np.full((len(BALL[0]), 4), color))
    assert ("colours of vertices are not read" in text) == said


def test_attributes_that_are_not_shown_are_no_reason_to_refuse_a_file(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = write_gltf(tmp_path, [(*BALL, 0)])
    tree = json.loads(path.read_text())
    tree["meshes"][0]["primitives"][0]["attributes"] |= {"NORMAL": 99, "COLOR_0": 1}
    path.write_text(json.dumps(tree))
    with caplog.at_level("INFO", "sunfleck"):
        sf.load(path)
    assert "NORMAL of vertices is passed over" in caplog.text


def test_extensions_and_animations_are_told_and_harmless_ones_may_be_required(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    names = ["KHR_texture_transform", "KHR_materials_unlit", "KHR_materials_variants"]
    path = write_gltf(
        tmp_path,
        [(*BALL, 0)],
        materials=[{**WHITE, "extensions": {"KHR_materials_unlit": {}}}],
        extensionsUsed=[*names, "ACME_smell"],
        extensionsRequired=names,
        animations=[{}, {}],
    )
    with caplog.at_level("INFO", "sunfleck"):
        sf.load(path)
    assert "not read: ACME_smell, KHR_texture_transform" in caplog.text
    assert "KHR_materials_unlit of materials is not read" in caplog.text
    assert "2 animations are left out" in caplog.text


# ---- what files may ask for, and where ----


def test_uris_outside_of_the_folder_are_refused(tmp_path: Path) -> None:
    (tmp_path / "model").mkdir()
    path = write_gltf(tmp_path / "model", [(*SQUARE, 0)])
    tree = json.loads(path.read_text())
    data = base64.b64decode(tree["buffers"][0]["uri"].partition(",")[2])
    secret = tmp_path / "secret.bin"
    secret.write_bytes(data)
    (tmp_path / "model" / "link.bin").symlink_to(secret)
    absolute = (str(secret), f"file://{secret}", f"file://localhost{secret}")
    for uri in (*absolute, "../secret.bin", "%2e%2e/secret.bin", "link.bin"):
        tree["buffers"][0]["uri"] = uri
        path.write_text(json.dumps(tree))
        with pytest.raises(ValueError, match="outside of its folder"):
            sf.load(path)
        assert sf.load(path, allow_outside=True).info.triangle_count == 4
    tree["buffers"][0]["uri"] = f"file://elsewhere{secret}"
    path.write_text(json.dumps(tree))
    with pytest.raises(NotImplementedError, match="fetched from elsewhere"):
        sf.load(path, allow_outside=True)


def load_within(path: Path, gigabytes: float, code: str) -> subprocess.CompletedProcess[str]:
    """Loads it in a process that can't have more memory."""
    size = int(gigabytes * 2**30)
    return subprocess.run(
        [sys.executable, "-c", f"import sunfleck as sf; path = {str(path)!r}\n{code}"],
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size)),
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


BOMBS: dict[str, dict[str, Any]] = {
    "zeros": {"count": 400_000_000},
    "sparse": {
        "count": 400_000_000,
        "sparse": {"count": 1, "indices": {"bufferView": 1, "componentType": 5125}, "values": {"bufferView": 0}},
    },
}


@pytest.mark.parametrize("bomb", BOMBS)
def test_a_small_file_that_asks_for_gigabytes_is_refused_before_they_are_taken(tmp_path: Path, bomb: str) -> None:
    path = changed(write_gltf(tmp_path, [(*SQUARE, 0)]), **BOMBS[bomb])
    result = load_within(path, 3, "try: sf.load(path)\nexcept ValueError as error: print(error)")
    assert "asks for" in result.stdout, result.stderr
    assert "bytes in all" in result.stdout


def test_a_file_may_ask_for_more_where_the_caller_says_so(tmp_path: Path) -> None:
    path = write_gltf(tmp_path, [(*BALL, 0)], places(7))
    for limits, what in (
        (sf.Limits(triangles=N - 1), "5,120 triangles"),
        (sf.Limits(instances=6), "7 instances"),
        (sf.Limits(bytes=10_000), "bytes in all"),
    ):
        with pytest.raises(ValueError, match=f"t.gltf: it asks for .*{what}"):
            sf.load(path, limits=limits)
    assert sf.load(path, limits=sf.Limits(triangles=N, instances=7)).info.instance_count == 7


def test_many_nodes_of_one_mesh_take_the_memory_of_one(tmp_path: Path) -> None:
    ball = icosphere(5)  # 20,480 triangles, which 3,000 times are 5 GB
    nodes = [{"mesh": 0, "translation": [3 * (k % 60), 0, 3 * (k // 60)]} for k in range(3000)]
    path = write_gltf(tmp_path, [(*ball, 0)], nodes)
    result = load_within(path, 3, "print(sf.load(path).info.triangle_count)")
    assert result.stdout == f"{3000 * 20480 + 2}\n", result.stderr


def test_copies_of_emitters_count_as_triangles(tmp_path: Path) -> None:
    path = write_gltf(tmp_path, [(*BALL, 0)], places(7), [glow(1)])
    with pytest.raises(ValueError, match="35,840 triangles"):
        sf.load(path, limits=sf.Limits(triangles=7 * N - 1))
    double = write_gltf(tmp_path, [(*SQUARE, 0)], (), [glow(1, doubleSided=True)])
    with pytest.raises(ValueError, match="4 triangles"):
        sf.load(double, limits=sf.Limits(triangles=3))


def test_a_pipe_for_a_buffer_is_refused_at_once(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.bin")
    path = write_gltf(tmp_path, [(*SQUARE, 0)])
    tree = json.loads(path.read_text())
    tree["buffers"][0]["uri"] = "pipe.bin"
    path.write_text(json.dumps(tree))
    with pytest.raises(OSError, match="is not a file"):
        sf.load(path)
