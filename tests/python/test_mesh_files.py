# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""obj, mtl, ply, stl: every form that the formats have, materials, notices, refusals that name the line, Ctrl-C."""

import logging
import os
import signal
import struct
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sunfleck as sf
from sunfleck.io import text as lines
from sunfleck.io.load import FILE_TYPES
from sunfleck.io.source import Source

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
VERTICES = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [2, 1, 0]], dtype=np.float64)
FACES = [(0, 1, 2, 3), (1, 4, 5), (1, 5, 2), (0, 1, 2, 3)]  # sizes mixed, and the last over the first
AREA = 3.0


def write(folder: Path, name: str, data: str | bytes) -> Path:
    path = folder / name
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    return path


def meshes(path: Path, **options: Any) -> list[sf.Mesh]:
    """What the reader finds, without the light that `load` adds."""
    return [m for m in FILE_TYPES[path.suffix.lower()][0](Source(path, **options)).meshes if isinstance(m, sf.Mesh)]


def area(found: list[sf.Mesh]) -> float:
    total = 0.0
    for mesh in found:
        a, b, c = (mesh.vertices[mesh.triangles[:, k]].astype(np.float64) for k in range(3))
        total += float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2
    return total


@pytest.fixture(name="notices")
def _notices(caplog: pytest.LogCaptureFixture) -> pytest.LogCaptureFixture:
    caplog.set_level(logging.INFO, logger="sunfleck")
    return caplog


# ---- OBJ ----


@pytest.mark.parametrize(
    "faces",
    [
        "f 1 2 3 4\n",
        "f 1/1 2/2 3/3 4/4\n",
        "f 1//1 2//2 3//3 4//4\n",
        "f 1/1/1 2/2/2 3/3/3 4/4/4\n",
        "f 1/1 2//2 3 4/4/4   # mixed, which some programs write\n",
        "f -4 -3 -2 -1\n",
        "f -4/1 2 -2//9 4\n",
        "F\t1  2\t3 4 \n",
        "f 1 2 \\\n 3 4\n",
        "fo 1 2 3 4\n",
        "f 1 2 3\nf 1 3 4",
        "g a\nf 1 2 3\ns off\no b # a name\nf 1 3 4\n",
    ],
)
@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
def test_obj_faces_in_every_form(tmp_path: Path, faces: str, newline: str) -> None:
    found = meshes(write(tmp_path, "a.obj", (SQUARE + faces).replace("\n", newline)))
    assert area(found) == pytest.approx(1)
    assert sum(len(mesh.triangles) for mesh in found) == 2


def test_obj_in_blocks_is_the_same_as_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Negative indices, materials and faces before their vertices go over the borders of blocks."""
    chance = np.random.default_rng(1)
    text = "f 1 2 300\nusemtl b\n"
    for k in range(200):
        text += "".join(f"v {x:.5f} {y:.5f} {z:.5f}\n" for x, y, z in chance.random((3, 3)))
        text += f"usemtl {'abc'[k % 3]}\nf -1/7 -2/8 -3/9\n"
    path = write(tmp_path, "a.obj", text)
    whole = meshes(path)
    monkeypatch.setattr(lines, "BLOCK", 100)
    parts = meshes(path)
    assert len(whole) == len(parts) == 4
    for one, other in zip(whole, parts, strict=True):
        np.testing.assert_array_equal(one.vertices[one.triangles], other.vertices[other.triangles])


def test_obj_with_weights_and_colours_of_some_vertices(tmp_path: Path, notices: pytest.LogCaptureFixture) -> None:
    text = "v 0 0 0\nv 1 0 0 1\nv 1 1 0 .5 .5 .5\nv 0 1 0 1 .5 .5 .5\nf 1 2 3 4\n"
    assert area(meshes(write(tmp_path, "a.obj", text))) == pytest.approx(1)
    assert "colours of vertices are left out" in notices.text


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_names_of_materials_in_every_encoding(tmp_path: Path, encoding: str) -> None:
    write(tmp_path, "m.mtl", "newmtl grün hell\nKd 0 1 0\n".encode(encoding))
    path = write(tmp_path, "a.obj", f"# größer\nmtllib m.mtl\n{SQUARE}usemtl  grün hell \nf 1 2 3\n".encode())
    assert meshes(path)[0].albedo == (0, 1, 0)


@pytest.mark.parametrize(
    "lines",
    ["mtllib a.mtl b.mtl", "mtllib a.mtl\nmtllib b.mtl", "mtllib a.mtl\nmtllib a.mtl b.mtl", "mtllib both of them.mtl"],
)
def test_several_libraries_of_materials(tmp_path: Path, lines: str, notices: pytest.LogCaptureFixture) -> None:
    write(tmp_path, "a.mtl", "newmtl red\nKd 1 0 0\n")
    write(tmp_path, "b.mtl", "newmtl green\nKd 0 1 0\n")
    write(tmp_path, "both of them.mtl", "newmtl red\nKd 1 0 0\nnewmtl green\nKd 0 1 0\n")
    found = meshes(write(tmp_path, "a.obj", f"{lines}\n{SQUARE}usemtl red\nf 1 2 3\nusemtl green\nf 1 3 4\n"))
    assert [mesh.albedo for mesh in found] == [(1, 0, 0), (0, 1, 0)]
    assert "missing" not in notices.text


def test_a_missing_library_and_a_missing_material_are_said(tmp_path: Path, notices: pytest.LogCaptureFixture) -> None:
    found = meshes(write(tmp_path, "a.obj", f"mtllib nowhere.mtl\n{SQUARE}usemtl red\nf 1 2 3\n"))
    assert found[0].albedo == (0.5, 0.5, 0.5)
    assert "'nowhere.mtl' is missing" in notices.text
    assert "'red'" in notices.text
    assert all(record.levelno == logging.INFO for record in notices.records)


def test_a_library_outside_of_the_folder_is_read_on_demand_only(tmp_path: Path) -> None:
    write(tmp_path, "m.mtl", "newmtl red\nKd 1 0 0\n")
    (tmp_path / "inner").mkdir()
    path = write(tmp_path, "inner/a.obj", f"mtllib ../m.mtl\n{SQUARE}usemtl red\nf 1 2 3\n")
    with pytest.raises(ValueError, match="outside of its folder"):
        meshes(path)
    assert meshes(path, allow_outside=True)[0].albedo == (1, 0, 0)


BLENDER = "# Blender 4.2.0 MTL File: 'None'\n"
GREY = (0.5, 0.5, 0.5)


@pytest.mark.parametrize(
    ("text", "material", "albedo"),
    [
        ("Kd .2 .3 .4", None, (0.2, 0.3, 0.4)),
        ("Kd .2", None, (0.2, 0.2, 0.2)),
        ("Ns 10", None, GREY),
        ("Kd .2 .3 .4\nKs .9 .9 .9\nillum 2", None, (0.2, 0.3, 0.4)),
        ("Kd 0 0 0\nKs .9 .8 .7\nNs 1000\nillum 3", sf.Mirror(), (0.9, 0.8, 0.7)),
        ("Ks .9 .8 .7\nillum 3", sf.Mirror(), (0.9, 0.8, 0.7)),
        ("Kd 0 0 0\nKs .9 .8 .7\nillum 5", sf.Conductor(0), (0.9, 0.8, 0.7)),
        ("Kd .8 .8 .8\nKs .1 .1 .1\nillum 3", None, (0.8, 0.8, 0.8)),
        ("Kd 0 0 0\nKs 1 1 1\nNi 1.33\nTf .9 1 .9\nd .1\nillum 7", sf.Dielectric(1.33), (0.9, 1, 0.9)),
        ("Kd .01 .01 .01\nKs .9 .9 .9\nNi 1.4\nillum 6", sf.Dielectric(1.4), (1, 1, 1)),
        ("Kd .8 .8 .8\nTr .9\nillum 4", sf.Dielectric(1.5), (1, 1, 1)),
        # One widespread program writes illum 4 for whatever it has.
        ("illum 4\nKd .5 .4 .3\nKa 0 0 0\nTf 1 1 1\nNi 1", None, (0.5, 0.4, 0.3)),
        ("Kd .8 .8 .8\nKs .5 .5 .5\nillum 7\nTf 0 0 0", None, (0.8, 0.8, 0.8)),
        ("Kd .9 .6 .2\nPm 1\nPr .3", sf.Conductor(0.3), (0.9, 0.6, 0.2)),
        ("Kd .9 .6 .2\nPm 1\nPr .9", None, (0.9, 0.6, 0.2)),
        (BLENDER + "Kd .9 .6 .2\nKa 1 1 1\nKs .5 .5 .5\nNs 640\nillum 3", sf.Conductor(0.2), (0.9, 0.6, 0.2)),
        (BLENDER + "Kd .9 .6 .2\nKa 0 0 0\nKs .5 .5 .5\nillum 3", None, (0.9, 0.6, 0.2)),
        ("Kd 1 1 1\nmap_Kd nope.png", None, GREY),
        ("Kd 1.5 .5 -1", None, (1, 0.5, 0)),
    ],
)
def test_materials_become_the_kind_that_they_are_most_of(
    tmp_path: Path, text: str, material: Any, albedo: Any, notices: pytest.LogCaptureFixture
) -> None:
    head, body = (BLENDER, text.removeprefix(BLENDER)) if text.startswith(BLENDER) else ("", text)
    write(tmp_path, "m.mtl", f"{head}newmtl m\n{body}\nKe 1 2 3\n")
    (mesh,) = meshes(write(tmp_path, "a.obj", f"mtllib m.mtl\n{SQUARE}usemtl m\nf 1 2 3\n"))
    assert mesh.albedo == pytest.approx(albedo)
    assert mesh.emission == (1, 2, 3)
    assert type(mesh.material) is type(material)
    if material is not None and material != sf.Mirror():
        assert vars(mesh.material) == pytest.approx(vars(material))


def test_a_mirror_and_a_ball_of_glass_are_not_black(tmp_path: Path) -> None:
    """Under a white sky a mirror of reflectance 0.9 shows 0.9, and clear glass 1: what enters it comes out again but
    for the paths cut at 32 bounces, of which each crossing leaves no more than some hundredths."""
    write(tmp_path, "m.mtl", "newmtl mirror\nKd 0 0 0\nKs .9 .9 .9\nillum 3\nnewmtl glass\nKd 0 0 0\nd .1\nillum 7\n")
    box = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    sides = "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"
    for name, faces, level in (("mirror", "f 1 2 3 4\n", 0.9), ("glass", sides, 1.0)):
        (mesh,) = meshes(write(tmp_path, "a.obj", f"mtllib m.mtl\n{box}usemtl {name}\n{faces}"))
        camera = sf.Camera((0.5, 0.5, 4), (0.5, 0.5, 0.5), vertical_fov=10)
        scene = sf.Scene([mesh], camera, background=(1, 1, 1), max_bounces=32)
        image = sf.render(scene, 8, 8, spp=64)
        assert image.alpha.min() == 1
        assert image.color.mean() == pytest.approx(level, abs=0.01)


@pytest.mark.parametrize(
    ("statement", "notice"),
    [
        ("p 1 2", "points"),
        ("l 1 2 3", "lines"),
        ("vn 0 0 1", "normals"),
        ("s 1", "smoothing groups"),
        ("curv 0 1 1 2", "free-form"),
        ("call other.obj", "commands"),
        ("f 1 2", "fewer than three corners"),
        ("wobble 3", "'wobble' in line 5"),
    ],
)
def test_what_an_obj_holds_and_the_scene_does_not_is_said_once(
    tmp_path: Path, statement: str, notice: str, notices: pytest.LogCaptureFixture
) -> None:
    meshes(write(tmp_path, "a.obj", f"{SQUARE}{statement}\n{statement}\nf 1 2 3\n"))
    assert [record.getMessage() for record in notices.records if notice in record.getMessage()]
    assert len(notices.records) == 1


@pytest.mark.parametrize(
    ("text", "line", "why"),
    [
        (SQUARE + "f 1 2 3\nf 1 2 9\n", 6, "no vertex 9: the file has 4"),
        (SQUARE + "\n# more\nf 1 2 -9\n", 7, "no vertex -9"),
        (SQUARE + "f 1 0 3\n", 5, "no vertex 0"),
        (SQUARE + "f 1 2.5 3\n", 5, "corners are vertices' numbers"),
        (SQUARE + "f 1 2 x\n", 5, "corners"),
        (SQUARE + "f 1 /2 3\n", 5, "corners"),
        ("v 0 0 0\nv 1 0 \\\n0\nv 1 1\n", 4, "three coordinates"),
        ("v 0 0 0\r\nv 1,5 0 0\r\n", 2, "numbers"),
        ("v 0 0 0\rv 0 nan 0\r", 2, "finite"),
    ],
)
def test_an_obj_is_refused_by_its_line(tmp_path: Path, text: str, line: int, why: str) -> None:
    with pytest.raises(ValueError, match=rf"a\.obj: line {line} is .*{why}"):
        sf.load(write(tmp_path, "a.obj", text))


def test_a_library_is_refused_by_its_line(tmp_path: Path) -> None:
    write(tmp_path, "m.mtl", "newmtl a\nKd red\n")
    with pytest.raises(ValueError, match=r"a\.obj: m\.mtl, line 2 is 'Kd red'"):
        sf.load(write(tmp_path, "a.obj", f"mtllib m.mtl\n{SQUARE}f 1 2 3\n"))


# ---- PLY ----


def ply(
    kind: str, faces: list[tuple[int, ...]], *, length: str = "uchar", extra: bool = False, newline: str = "\n"
) -> bytes:
    """A file with an element of edges and one of faces, with a second list and a flag behind, if `extra`."""
    order = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}[kind]
    head = f"ply\nformat {kind} 1.0\ncomment Körper\nelement edge 2\nproperty int a\nproperty int b\n"
    head += (
        f"element vertex {len(VERTICES)}\nproperty double x\nproperty uchar red\nproperty float y\nproperty float z\n"
    )
    head += f"element face {len(faces)}\n" + ("property float weight\n" if extra else "")
    head += f"property list {length} int vertex_indices\n"
    head += "property list uchar float texcoord\nproperty short flag\n" if extra else ""
    rows: list[tuple[str, list[Any]]] = [("2i", [1, 2]), ("2i", [3, 4])]
    rows += [("dBff", [x, 9, y, z]) for x, y, z in VERTICES.tolist()]
    letter = {"uchar": "B", "int": "i", "short": "h"}[length]
    for k, face in enumerate(faces):
        form: str = f"{letter}{len(face)}i"
        values: list[Any] = [len(face), *face]
        if extra:
            form, values = f"f{form}B{k % 3}fh", [0.5, *values, k % 3, *[0.25] * (k % 3), -7]
        rows.append((form, values))
    text = (head + "end_header\n").replace("\n", newline).encode("latin-1")
    if not order:
        return text + b"".join((" ".join(map(str, values)) + newline).encode() for _, values in rows)
    return text + b"".join(struct.pack(order + form, *values) for form, values in rows)


@pytest.mark.parametrize("kind", ["ascii", "binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize("faces", [FACES, FACES[1:3] * 2, FACES[:1] * 3, [*FACES, (0, 1)]])
@pytest.mark.parametrize("length", ["uchar", "short", "int"])
@pytest.mark.parametrize("extra", [False, True])
@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
def test_ply_in_every_form(tmp_path: Path, kind: str, faces: Any, length: str, extra: bool, newline: str) -> None:
    found = meshes(write(tmp_path, "a.ply", ply(kind, faces, length=length, extra=extra, newline=newline)))
    assert sum(len(mesh.triangles) for mesh in found) == sum(len(face) - 2 for face in faces)
    assert area(found) == pytest.approx({4: AREA, 5: AREA, 3: 3.0}[len(faces)] if faces[0] != FACES[1] else 2.0)


def test_a_binary_ply_whose_data_starts_with_a_line_feed(tmp_path: Path) -> None:
    """Behind "end_header" and a carriage return, a byte 10 is data: here the first of a vertex's x."""
    head = "ply\rformat binary_little_endian 1.0\relement vertex 3\rproperty int x\rproperty int y\rproperty int z\r"
    head += "element face 1\rproperty list uchar uchar vertex_index\rend_header\r"
    data = head.encode() + struct.pack("<9i4B", 10, 0, 0, 12, 0, 0, 10, 1, 0, 3, 0, 1, 2)
    (mesh,) = meshes(write(tmp_path, "a.ply", data))
    assert mesh.vertices.tolist() == [[10, 0, 0], [12, 0, 0], [10, 1, 0]]


@pytest.mark.parametrize("binary", [False, True])
def test_ply_strips_turn_every_second_triangle_and_end_at_minus_one(tmp_path: Path, binary: bool) -> None:
    strips = [0, 1, 3, 2, -1, 4, 1, 5, -1, 2, 2, 1, 5]
    head = f"ply\nformat {'binary_little_endian' if binary else 'ascii'} 1.0\nelement vertex 6\nproperty float x\n"
    head += (
        "property float y\nproperty float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
    )
    data = head.encode()
    if binary:
        data += VERTICES.astype("<f4").tobytes() + struct.pack(f"<{len(strips) + 1}i", len(strips), *strips)
    else:
        data += "\n".join(" ".join(map(str, row)) for row in [*VERTICES.tolist(), [len(strips), *strips]]).encode()
    (mesh,) = meshes(write(tmp_path, "a.ply", data))
    assert mesh.triangles.tolist() == [[0, 1, 3], [1, 2, 3], [4, 1, 5], [2, 5, 1]]


def test_what_a_ply_holds_and_the_scene_does_not_is_said(tmp_path: Path, notices: pytest.LogCaptureFixture) -> None:
    meshes(write(tmp_path, "a.ply", ply("ascii", FACES[:1], extra=True) + b"1 2 3\n"))
    for words in ("elements edge are left out: 2", "colours of elements vertex", "texture coordinates of elements face",
                  "properties of elements face are left out: weight, flag", "vertices without a face are left out: 2",
                  "1 lines behind the last element"):  # fmt: skip
        assert words in notices.text


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (b"plx\n", "starts with b'plx"),
        (b"ply\nformat ascii 1.0\n", "no line 'end_header'"),
        (b"ply\nformat ascii 2.0\nend_header\n", r"line 2 is 'format ascii 2\.0'"),
        (b"ply\nformat ascii 1.0\nelement vertex x\nend_header\n", "line 3"),
        (ply("ascii", FACES).replace(b"double x", b"double w"), "they need x, y and z"),
        (ply("ascii", FACES).replace(b"vertex_indices", b"corners"), "vertex_index is needed"),
        (ply("ascii", FACES).replace(b"3 1 5 2", b"3 1 5"), "line 25 is '3 1 5'"),
        (ply("ascii", FACES).replace(b"3 1 5 2", b"3 1 5 x"), "line 25"),
        (ply("ascii", FACES).replace(b"3 1 5 2", b"3 1 5 7"), "face 2 has vertex index 7; the file has 6"),
        (ply("ascii", FACES).replace(b"3 1 5 2", b"3 1 5 -1"), "face 2 has vertex index -1"),
        (ply("ascii", FACES)[:-10], "cut short: of 4 elements 'face' 3"),
        (ply("binary_big_endian", FACES)[:-9], "cut short"),
        (ply("binary_big_endian", FACES[:1] * 9)[:-9], "cut short"),
        (ply("binary_little_endian", FACES, length="int").replace(b"\3\0\0\0\1", b"\xff" * 5), "length -1"),
        (ply("binary_little_endian", []).replace(b"element vertex 6", b"element vertex 99999"), "cut short"),
        (ply("binary_little_endian", []).replace(b"element vertex 6", b"element vertex 99999999999"), "bytes in all"),
    ],
)  # fmt: skip
def test_a_bad_ply_is_refused_by_what_is_wrong(tmp_path: Path, data: bytes, why: str) -> None:
    with pytest.raises(ValueError, match=rf"a\.ply: .*{why}"):
        sf.load(write(tmp_path, "a.ply", data))


# ---- STL ----


def stl(count: int, stated: int | None = None, header: bytes = b"solid x", attribute: int = 0) -> bytes:
    data = header.ljust(80) + struct.pack("<I", count if stated is None else stated)
    for k in range(count):
        data += struct.pack("<12fH", 0, 0, 1, k, 0, 0, k + 1, 0, 0, k, 1, 0, attribute)
    return data


@pytest.mark.parametrize(
    ("data", "count", "notice"),
    [
        (stl(3), 3, None),
        (stl(2, stated=9), 2, "says 9 triangles, 2 are there"),
        (stl(2, stated=0), 2, "says 0 triangles, 2 are there"),
        (stl(3, stated=2), 2, "50 bytes behind the last triangle"),
        (stl(2) + b"\0" * 7, 2, "7 bytes behind"),
        (stl(2, attribute=0x801F), 2, "attributes of triangles"),
    ],
)
def test_binary_stl_and_its_count(
    tmp_path: Path, data: bytes, count: int, notice: str | None, notices: pytest.LogCaptureFixture
) -> None:
    found = meshes(write(tmp_path, "a.stl", data))
    assert area(found) == pytest.approx(count / 2)
    assert len(notices.records) == (notice is not None)
    assert notice is None or notice in notices.text


LOOP = "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 1 1 0\n endloop\nendfacet\n"


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
def test_stl_as_text(tmp_path: Path, newline: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lines, "BLOCK", 64)
    square = LOOP.replace(" endloop", "  vertex 0 1 0\n endloop")
    text = f"solid größe\n{LOOP}{LOOP.upper()}endsolid\nsolid empty\nendsolid\nsolid b\n{square}endsolid b"
    found = meshes(write(tmp_path, "a.stl", text.replace("\n", newline).encode("latin-1")))
    assert area(found) == pytest.approx(2)
    assert sum(len(mesh.triangles) for mesh in found) == 4


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (stl(2, stated=3)[:-7], "cut short, or no STL file: of 3 triangles 1 are whole, and 43 bytes follow"),
        (b"x" * 20, "it has 20 bytes"),
        (f"solid\n{LOOP}{LOOP.replace('1 1 0', '1 1')}".encode(), "line 13 is 'vertex 1 1'"),
        (f"solid\n{LOOP}{LOOP.replace('1 1 0', '1 1 o')}".encode(), "line 13 is 'vertex 1 1 o'"),
        (f"solid\n{LOOP}{LOOP[:60]}".encode(), "cut short: 2 vertices"),
    ],
)
def test_a_bad_stl_is_refused_by_what_is_wrong(tmp_path: Path, data: bytes, why: str) -> None:
    with pytest.raises(ValueError, match=rf"a\.stl: .*{why}"):
        sf.load(write(tmp_path, "a.stl", data))


# ---- all three ----


def test_limits_are_asked_before_triangles_are_made(tmp_path: Path) -> None:
    few = sf.Limits(triangles=2)
    for name, data in (("a.stl", stl(3)), ("a.ply", ply("ascii", FACES)), ("a.obj", SQUARE + "f 1 2 3\n" * 3)):
        with pytest.raises(ValueError, match="triangles in all"):
            meshes(write(tmp_path, name, data), limits=few)


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="the system has no timers that signal")
def test_ctrl_c_is_heard_while_a_file_loads(tmp_path: Path) -> None:
    """In a process of its own, whose first load it is: what is imported by then must not swallow it either."""
    for name, data in (
        ("a.obj", SQUARE * 40000 + "f 1/1/1 2/2/2 3/3/3\n" * 150000),
        ("a.ply", ply("binary_little_endian", FACES * 60000)),
        ("a.stl", "solid\n" + LOOP * 20000),
    ):
        path = write(tmp_path, name, data)
        code = (
            "import signal, sys\nimport sunfleck as sf\nsignal.signal(signal.SIGINT, signal.default_int_handler)\n"
            "print('ready', flush=True)\nwhile True:\n    sf.load(sys.argv[1])\n"
        )
        for wait in (0.0, 0.05, 0.3):
            command = [sys.executable, "-c", code, os.fspath(path)]
            with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
                assert process.stdout is not None
                process.stdout.readline()
                time.sleep(wait)
                process.send_signal(signal.SIGINT)
                _, errors = process.communicate(timeout=60)
            assert errors.rstrip().endswith("KeyboardInterrupt"), errors
