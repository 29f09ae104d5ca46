# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""stl: the triangles of an STL file, in binary or text; all solids become one mesh.

Normals of facets are not read: they follow from the corners. Reference: 3D Systems 1988, "StereoLithography Interface
Specification"; the two bytes behind each triangle, unused there, hold colours in some programs' files.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sunfleck.io.contents import Contents
from sunfleck.io.notices import Notices
from sunfleck.io.polygon import triangulate
from sunfleck.io.source import Source
from sunfleck.io.text import BadLine, Lines, blocks, decoded, refusal, with_newlines
from sunfleck.scene.mesh import Mesh

__all__ = ["read_stl"]

_HEADER, _FACET = 84, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_stl(source: Source) -> Contents:
    """The file's triangles, as one mesh.

    Raises
    ------
    ValueError
        The file is cut short, or a line can't be read, which is named.
    OSError
        The file can't be read.
    """
    data, note = source.read(), Notices(source.path)
    mesh = _read_text(source, with_newlines(data), note) if _is_text(data) else _read_binary(source, data, note)
    return Contents([] if mesh is None else [mesh])


def _is_text(data: bytes) -> bool:
    """By the size, if that is what a binary file's header says: many of those start with "solid", too."""
    if len(data) >= _HEADER and len(data) == _HEADER + _FACET.itemsize * _stated_count(data):
        return False
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return True
    head = data[:1024].removeprefix(b"\xef\xbb\xbf").lstrip().lower()
    return head.startswith((b"solid", b"facet")) and b"\0" not in data[_HEADER:1024]


def _stated_count(data: bytes) -> int:
    return int.from_bytes(data[_HEADER - 4 : _HEADER], "little")


def _read_binary(source: Source, data: bytes, note: Notices) -> Mesh | None:
    if len(data) < _HEADER:
        raise ValueError(f"it has {len(data)} bytes and no text; an STL file has {_HEADER} before the first triangle")
    stated, size = _stated_count(data), len(data) - _HEADER
    whole, part = divmod(size, _FACET.itemsize)
    count = min(stated, whole) if stated else whole
    if stated > whole and (part or not whole):
        raise ValueError(
            f"it is cut short, or no STL file: of {stated} triangles {whole} are whole, and {part} bytes follow; "
            f"a file of {stated} has {_HEADER + _FACET.itemsize * stated:,} bytes, this one {len(data):,}"
        )
    if stated != count:
        note(f"its header says {stated} triangles, {count} are there, which are read")
    if size > count * _FACET.itemsize:
        note(f"{size - count * _FACET.itemsize} bytes behind the last triangle are left out")
    source.take_triangles(count)
    source.take_bytes(48 * count)
    facets = np.frombuffer(data, _FACET, count, _HEADER)
    if facets["attribute"].any():
        note("attributes of triangles are left out, which are colours in some programs' files")
    return _mesh(facets["corners"])


def _read_text(source: Source, text: bytes, note: Notices) -> Mesh | None:
    corners: list[NDArray[np.float64]] = []
    counts: list[NDArray[np.int64]] = []
    open_loop = 0  # corners of a loop that a block before began
    for start, block in blocks(text):
        lines = Lines(block)
        try:
            is_corner, is_end = lines.starting_with(b"vertex"), lines.starting_with(b"endloop")
            _check_words(lines, is_corner, is_end, note)
            lines.blank(is_corner, 6)
            few = is_corner & (lines.words != 3)
            if few.any():
                raise BadLine(int(np.argmax(few)), "a vertex has three coordinates")
            corners.append(lines.numbers(is_corner, np.float64, "a vertex is given by numbers").reshape(-1, 3))
        except BadLine as bad:
            raise refusal(text, start + int(lines.starts[bad.index]), bad.why) from None
        seen = np.cumsum(is_corner)
        ends = seen[is_end]
        sizes = np.diff(ends, prepend=0)
        if len(sizes):
            sizes[0] += open_loop
            open_loop = 0
        open_loop += int(seen[-1] - (ends[-1] if len(ends) else 0))
        counts.append(sizes)
    if open_loop:
        raise ValueError(f"it is cut short: {open_loop} vertices follow the last endloop")
    return _of_loops(source, corners, counts, note)


def _check_words(lines: Lines, is_corner: NDArray[np.bool_], is_end: NDArray[np.bool_], note: Notices) -> None:
    known = is_corner | is_end | (lines.words == 0)
    for word in (b"facet", b"outer", b"endfacet", b"solid", b"endsolid", b"color"):
        known |= lines.starting_with(word)
    if lines.starting_with(b"color").any():
        note("colours are left out")
    # The header of some files goes on for several lines; a facet that is no facet is a mistake.
    strange = np.flatnonzero(~known)
    if len(strange):
        note(f"lines that are no part of STL are left out, as {decoded(lines.line(int(strange[0])))[:40]!r}")


def _of_loops(
    source: Source, corners: list[NDArray[np.float64]], counts: list[NDArray[np.int64]], note: Notices
) -> Mesh | None:
    vertices = np.concatenate(corners or [np.empty((0, 3))])
    sizes = np.concatenate(counts or [np.empty(0, np.int64)])
    if not len(vertices):
        return None
    wrong = int((sizes != 3).sum())
    if wrong:
        note(f"facets that are no triangles, which STL does not have, are cut into some: {wrong}")
    source.take_triangles(int(np.maximum(sizes - 2, 0).sum()))
    cut = triangulate(vertices, np.arange(len(vertices)), sizes, note)
    return _mesh(vertices[cut.triangles]) if len(cut.triangles) else None


def _mesh(corners: NDArray[np.floating]) -> Mesh | None:
    """Of triangles (n, 3, 3), which share no vertices."""
    if not len(corners):
        return None
    vertices = np.ascontiguousarray(corners, np.float32).reshape(-1, 3)
    return Mesh(vertices, np.arange(len(vertices), dtype=np.uint32).reshape(-1, 3))
