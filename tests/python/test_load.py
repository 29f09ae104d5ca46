# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""load: OBJ, PLY, STL; default camera and light; bad files; Debian's whole folder of models."""

import logging
import random
import struct
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sunfleck as sf

MODELS = Path("/usr/share/assimp/models")
ALLOWED = (ValueError, OSError, NotImplementedError, TypeError, MemoryError, sf.Error)

OBJ = """mtllib m.mtl
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
usemtl wall
f 1 2 3
usemtl lamp
f 1 3 4
"""
MTL = "newmtl wall\nKd 0.1 0.2 0.3\nnewmtl lamp\nKd 0 0 0\nKe 4 5 6\n"
PLY = """ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
3 0 1 2
"""
STL = """solid s
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 0
endloop
endfacet
endsolid s
"""


def write(folder: Path, name: str, text: str | bytes) -> Path:
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def binary_stl() -> bytes:
    return b"\0" * 80 + struct.pack("<I", 1) + struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)


def test_obj_with_materials(tmp_path: Path) -> None:
    write(tmp_path, "m.mtl", MTL)
    scene = sf.load(write(tmp_path, "square.obj", OBJ))
    lamp, wall = sorted(scene.meshes, key=lambda mesh: mesh.albedo)
    assert wall.albedo == (0.1, 0.2, 0.3)
    assert lamp.emission == (4, 5, 6)
    assert scene.info.bounds_upper == (1, 1, 0)
    assert scene.max_bounces == 5


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "latin-1"])
def test_obj_in_other_encodings(tmp_path: Path, encoding: str) -> None:
    scene = sf.load(write(tmp_path, "square.obj", f"# größer\n{OBJ}".encode(encoding)))
    assert len(scene.meshes[0].triangles) + len(scene.meshes[1].triangles) >= 2


@pytest.mark.parametrize(
    ("name", "data"), [("t.ply", PLY), ("t.stl", STL), ("t.stl", binary_stl()), ("T.STL", binary_stl())]
)
def test_ply_and_stl(tmp_path: Path, name: str, data: str | bytes) -> None:
    scene = sf.load(str(write(tmp_path, name, data)))
    assert len(scene.meshes[0].triangles) == 1
    assert scene.meshes[0].albedo == (0.5, 0.5, 0.5)
    assert scene.camera.up == (0, 0, 1)


def test_a_file_without_camera_and_light_gets_stated_ones(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    corner = (1e3, 2e3, 3e3)
    text = "".join(f"v {corner[0] + x} {corner[1] + y} {corner[2] + z}\n" for x, y, z in np.ndindex(2, 2, 2))
    with caplog.at_level(logging.INFO, logger="sunfleck"):
        scene = sf.load(write(tmp_path, "box.obj", text + "f 1 2 3\nf 6 7 8\n"))
    assert "no camera in it" in caplog.text
    assert "no light in it" in caplog.text
    assert all(record.levelno == logging.INFO for record in caplog.records if record.name == "sunfleck")
    light = scene.meshes[-1]
    assert light.emission == (10, 10, 10)
    centre, radius = np.array([1000.5, 2000.5, 3000.5]), np.sqrt(3) / 2
    assert np.linalg.norm(light.vertices.mean(axis=0) - centre) == pytest.approx(2.5 * radius, rel=1e-3)
    assert np.linalg.norm(light.vertices[1] - light.vertices[0]) == pytest.approx(1.5 * radius, rel=1e-3)
    assert np.linalg.norm(scene.camera.position - centre) == pytest.approx(radius / np.sin(np.radians(20)), rel=1e-3)
    # The light shines on the model, and the model is in the middle of the picture.
    a, b, c = light.vertices[light.triangles[0]]
    assert np.cross(b - a, c - a) @ (centre - light.vertices.mean(axis=0)) > 0
    image = sf.render(scene, 32, 32, spp=16)
    assert 0 < np.count_nonzero(image.alpha) < 32 * 32
    assert image.color.max() > 0


@pytest.mark.parametrize(
    ("name", "data", "error", "match"),
    [
        ("t.fbx", "x", ValueError, r"\.fbx.*\.obj, \.ply, \.stl, \.gltf, \.glb"),
        ("noending", "x", ValueError, "obj"),
        ("t.obj", "", ValueError, "no triangles"),
        ("t.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n", ValueError, "no triangles"),
        ("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", ValueError, "t.obj"),
        ("t.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", ValueError, "nan"),
        ("t.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", ValueError, "one point"),
        ("t.ply", "not a ply", ValueError, "t.ply"),
        ("t.ply", PLY.replace("vertex 3", "vertex 3000000000"), (ValueError, MemoryError), "."),
        ("t.ply", PLY.replace("3 0 1 2", "3 0 1 7"), ValueError, "t.ply"),
        ("t.stl", b"", ValueError, "t.stl"),
        ("t.stl", binary_stl()[:100], ValueError, "t.stl"),
        ("t.stl", b"\0" * 80 + struct.pack("<I", 2**32 - 1), (ValueError, MemoryError), "."),
        ("t.gltf", "{", ValueError, "t.gltf"),
        ("t.gltf", "[]", ValueError, "t.gltf"),
        ("t.glb", b"glTF", ValueError, "t.glb"),
    ],
)
def test_a_bad_file_is_refused_and_named(tmp_path: Path, name: str, data: Any, error: Any, match: str) -> None:
    with pytest.raises(error, match=match):
        sf.load(write(tmp_path, name, data))


def test_paths_that_are_none(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="missing"):
        sf.load(tmp_path / "missing.obj")
    (tmp_path / "folder.obj").mkdir()
    with pytest.raises(OSError, match="not a file"):
        sf.load(tmp_path / "folder.obj")
    with pytest.raises(TypeError):
        sf.load(3)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="path"):
        sf.load(b"t.obj")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="null"):
        sf.load("t\0.obj")


def test_damaged_files_raise_nothing_else(tmp_path: Path) -> None:
    """Bytes changed, cut and repeated at fixed seeds: a scene, or one of the exceptions that are promised."""
    folder = MODELS / "glTF2"
    originals = [("t.obj", OBJ.encode()), ("t.ply", PLY.encode()), ("t.stl", STL.encode()), ("t.stl", binary_stl())]
    glb = folder / "BoxTextured-glTF-Binary" / "BoxTextured.glb"
    embedded = folder / "BoxTextured-glTF-Embedded" / "BoxTextured.gltf"
    originals += [(path.name, path.read_bytes()) for path in (glb, embedded) if path.exists()]
    outcomes = {"scene": 0, "refused": 0}
    for seed in range(600):
        chance = random.Random(seed)
        name, data = chance.choice(originals)
        damaged = bytearray(data)
        for _ in range(chance.choice((1, 3, 20))):
            at = chance.randrange(len(damaged))
            damaged[at : at + chance.choice((0, 1, 1, 40))] = chance.choice(
                (b"", b"-", b"9999999999", b"nan", b"\0\xff", bytes([chance.randrange(256)]), damaged[:20])
            )
        path = write(tmp_path, name, bytes(damaged))
        try:
            sf.load(path)
            outcomes["scene"] += 1
        except ALLOWED:
            outcomes["refused"] += 1
    assert min(outcomes.values()) > 50, outcomes


@pytest.mark.skipif(not MODELS.exists(), reason="Debian's assimp-testmodels is not installed")
def test_the_whole_folder_of_models_loads_and_renders_or_is_refused() -> None:
    start, loaded, refused = time.monotonic(), 0, 0
    for path in sorted(MODELS.rglob("*")):
        if not path.is_file():
            continue
        try:
            scene = sf.load(path)
        except ALLOWED:
            refused += 1
            continue
        image = sf.render(scene, 16, 16)
        assert np.isfinite(image.color).all()
        loaded += 1
    assert loaded >= 55
    assert refused >= 500
    assert time.monotonic() - start < 50


@pytest.mark.parametrize("kind", [sf.Error, MemoryError])
def test_what_embree_refuses_is_not_the_file_s_fault(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: type[Exception]
) -> None:
    path = tmp_path / "triangle.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")

    def refuse(*_: object) -> None:
        raise kind("Embree could not")

    monkeypatch.setattr("sunfleck._core.check_mesh", refuse)
    with pytest.raises(kind, match=r"^Embree could not$"):
        sf.load(path)
