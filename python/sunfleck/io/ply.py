# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""ply: the faces of a PLY file, in text or binary of either order of bytes, as one mesh.

Read: vertices' x, y and z of any type; faces of any shape, of mixed sizes, and triangle strips. Every other property
and element is passed over, and what of it shows in a picture is said. Reference: Turk 1994, "The PLY Polygon File
Format"; triangle strips, of which -1 ends one, are those of the Stanford models.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sunfleck.io.contents import Contents
from sunfleck.io.notices import Notices
from sunfleck.io.ply_rows import BinaryBody, Element, Lists, Property, TextBody
from sunfleck.io.polygon import compact, triangulate
from sunfleck.io.source import Source
from sunfleck.io.text import with_newlines
from sunfleck.scene.mesh import Mesh

__all__ = ["read_ply"]

_Indices = NDArray[np.int64]

_TYPES = dict(
    zip(("char", "uchar", "short", "ushort", "int", "uint"), ("i1", "u1", "i2", "u2", "i4", "u4"), strict=True)
)
_TYPES |= {f"int{n}": f"i{n // 8}" for n in (8, 16, 32, 64)} | {f"uint{n}": f"u{n // 8}" for n in (8, 16, 32, 64)}
_TYPES |= {"float": "f4", "double": "f8", "float32": "f4", "float64": "f8"}
_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": "="}
_INDEX_NAMES = ("vertex_indices", "vertex_index")
_FACES, _STRIPS = ("face", "faces"), ("tristrips", "tristrip")

# What properties say that a picture would show, by the words that their names start with.
_SHOWN = [
    (("red", "green", "blue", "alpha", "r", "g", "b", "a", "diffuse_", "ambient_", "specular_"), "colours"),
    (("nx", "ny", "nz", "normal"), "normals"),
    (("s", "t", "u", "v", "texture_", "texcoord", "texnumber", "texture"), "texture coordinates"),
]


def read_ply(source: Source) -> Contents:
    """The file's faces and triangle strips, as one mesh.

    Raises
    ------
    ValueError
        The header, a line or a row can't be read, which is named; the file is cut short.
    OSError
        The file can't be read.
    """
    data, note = source.read(), Notices(source.path)
    header, body = _split(data)
    kind, elements = _read_header(header, note)
    _note_properties(elements, note)
    wanted = {e.name for e in elements if e.name in ("vertex", *_FACES, *_STRIPS)}
    reader: TextBody | BinaryBody
    if kind == "ascii":
        text = with_newlines(data)
        reader = TextBody(text, len(text) - len(with_newlines(body)))
    else:
        reader = BinaryBody(body, _ORDERS[kind])
    vertices: NDArray[Any] | None = None
    corners: list[NDArray[Any]] = []
    counts: list[_Indices] = []
    for element in elements:
        source.take_bytes(8 * element.count * max(1, len(element.properties)))
        if element.name not in wanted:
            reader.skip(element)
        elif element.name == "vertex":
            vertices = np.stack(reader.scalars(element, ("x", "y", "z")), axis=1)
        else:
            lists = reader.lists(element, next(p.name for p in element.properties if p.name in _INDEX_NAMES))
            if element.name in _STRIPS:
                lists = _strips(lists)
            corners.append(lists.values)
            counts.append(lists.counts)
    left = reader.left()
    if left:
        note(f"{left} behind the last element are left out")
    if vertices is None or not corners:
        return Contents([])
    return Contents([*_meshes(source, vertices, _joined(corners), _joined(counts), note)])


def _joined(parts: list[NDArray[Any]]) -> NDArray[Any]:
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def _meshes(
    source: Source, vertices: NDArray[Any], corners: NDArray[Any], counts: _Indices, note: Callable[[str], None]
) -> list[Mesh]:
    if len(corners) and not 0 <= corners.min() <= corners.max() < len(vertices):
        at = int(np.argmax((corners < 0) | (corners >= len(vertices))))
        face = int(np.searchsorted(np.cumsum(counts), at, side="right"))
        raise ValueError(
            f"face {face} has vertex index {corners[at]}; the file has {len(vertices)} vertices, from 0 on"
        )
    few = int((counts < 3).sum())
    if few:
        note(f"faces of fewer than three corners are left out: {few}")
    source.take_triangles(int(np.maximum(counts - 2, 0).sum()))
    cut = triangulate(vertices, corners, counts, note)
    if not len(cut.triangles):
        return []
    used, triangles = compact(vertices, cut.triangles)
    if len(used) < len(vertices):
        note(f"vertices without a face are left out: {len(vertices) - len(used)}")
    return [Mesh(used, triangles)]


def _strips(lists: Lists) -> Lists:
    """Triangles of strips; every second one is wound the other way, from each strip's start on."""
    values, counts = lists.values.astype(np.int64), lists.counts
    starts = np.zeros(len(values) + 1, np.bool_)  # where a strip starts: at a list's, and behind each -1
    starts[np.concatenate([[0], np.cumsum(counts)])] = True
    starts[1:] |= values == -1
    first = np.flatnonzero(starts)[np.cumsum(starts[:-1]) - 1] if len(values) else np.empty(0, np.int64)
    # A triangle begins at each corner that has two more of its own strip behind it.
    begins = np.flatnonzero(
        (values[:-2] >= 0) & (values[1:-1] >= 0) & (values[2:] >= 0) & ~starts[1:-2] & ~starts[2:-1]
    )
    odd = (begins - first[begins]) % 2
    triangles = np.stack([values[begins], values[begins + 1 + odd], values[begins + 2 - odd]], axis=1)
    # Strips repeat a corner to turn; such triangles are no part of the surface.
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    return Lists(triangles.ravel(), np.full(len(triangles), 3, np.int64))


# ---- header ----


def _split(data: bytes) -> tuple[list[str], bytes]:
    """The header's lines without the last, and what follows it. Lines end as the first does."""
    first = re.match(rb"\s*ply[ \t]*(\r\n|\n|\r)", data)
    if not first:
        raise ValueError(f"it starts with {data[:12]!r}; a PLY file starts with a line 'ply'")
    newline = first[1]
    # A carriage return alone at a line's end may be followed by a byte 10 of data, so the first line decides.
    last = re.compile(rb"(?:\r\n|\n|\r)end_header[ \t]*" + (rb"(?:\r\n|\r)" if newline == b"\r\n" else newline)).search(
        data
    )
    if not last:
        raise ValueError("it has no line 'end_header'")
    lines = data[: last.start()].decode("latin-1").replace("\r\n", "\n").replace("\r", "\n").split("\n")
    return lines, data[last.end() :]


def _read_header(lines: list[str], note: Callable[[str], None]) -> tuple[str, list[Element]]:
    kind, elements = "", []
    for number, line in enumerate(lines, 1):
        try:
            match line.split():
                case ["format", name, version]:
                    kind = name
                    if name not in _ORDERS or version != "1.0":
                        raise ValueError(f"formats are {', '.join(_ORDERS)}, of version 1.0")
                case ["element", name, count] if count.isascii() and count.isdigit():
                    elements.append(Element(name, int(count), []))
                case ["property", "list", length, value, name] if elements and {length, value} <= set(_TYPES):
                    elements[-1].properties.append(Property(name, _TYPES[value], _TYPES[length]))
                case ["property", value, name] if elements and value in _TYPES:
                    elements[-1].properties.append(Property(name, _TYPES[value], None))
                case ["comment", "TextureFile", *_]:
                    note("textures are not read: surfaces are 0.5 grey")
                case [] | ["ply"] | ["comment" | "obj_info", *_]:
                    pass
                case [word, *_] if word not in ("format", "element", "property"):
                    note(f"line {number} of the header is left out: {line.strip()[:60]!r}")
                case _:
                    raise ValueError(
                        "format KIND 1.0, element NAME COUNT and then property TYPE NAME or property list "
                        f"TYPE TYPE NAME are allowed, with the types {', '.join(_TYPES)}"
                    )
        except ValueError as error:
            raise ValueError(f"line {number} is {line.strip()[:60]!r}: {error}") from None
    if not kind:
        raise ValueError("its header has no line 'format'")
    _check(elements)
    return kind, elements


def _check(elements: list[Element]) -> None:
    for element in elements:
        single = {p.name for p in element.properties if p.length is None}
        lists = {p.name for p in element.properties if p.length is not None}
        if element.name == "vertex" and not {"x", "y", "z"} <= single:
            raise ValueError(f"its vertices have {', '.join(sorted(single)) or 'nothing'}; they need x, y and z")
        if element.name in (*_FACES, *_STRIPS) and not lists & set(_INDEX_NAMES):
            raise ValueError(
                f"its element {element.name} has the lists {', '.join(sorted(lists)) or 'none'}; "
                f"{' or '.join(_INDEX_NAMES)} is needed"
            )
    names = [element.name for element in elements]
    if names.count("vertex") > 1:
        raise ValueError("it has more than one element 'vertex'")


def _note_properties(elements: list[Element], note: Callable[[str], None]) -> None:
    for element in elements:
        if element.name in ("vertex", *_FACES, *_STRIPS):
            names = [p.name for p in element.properties if p.name not in ("x", "y", "z", *_INDEX_NAMES)]
            for words, what in _SHOWN:
                hit = [
                    n for n in names if n in words or any(n.startswith(w) for w in words if w[-1] == "_" or len(w) > 5)
                ]
                names = [n for n in names if n not in hit]
                if hit:
                    note(f"{what} of elements {element.name} are left out: {', '.join(hit)}")
            if names:
                note(f"properties of elements {element.name} are left out: {', '.join(names)}")
        elif element.count:
            note(f"elements {element.name} are left out: {element.count}")
