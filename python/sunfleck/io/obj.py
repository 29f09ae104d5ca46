# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""obj: the faces of a Wavefront OBJ file, one mesh for each material.

Read: v, f (of any shape, indices from the front or, negative, from the back), usemtl, mtllib (several, by `mtl`), lines
that go on after a backslash, text in UTF-8, UTF-16 and Latin-1. What else shows in a picture is left out and said:
normals, smoothing groups, colours of vertices, points, lines, free-form curves and surfaces.
Reference: Wavefront Technologies 1995, "Advanced Visualizer: Object Files (.obj)", appendix B1.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sunfleck.io.contents import Contents
from sunfleck.io.mtl import Materials
from sunfleck.io.notices import Notices
from sunfleck.io.polygon import compact, triangulate
from sunfleck.io.source import Source
from sunfleck.io.text import BadLine, Lines, blocks, decoded, line_number, refusal, with_newlines
from sunfleck.scene.mesh import Mesh

__all__ = ["read_obj"]

_Indices = NDArray[np.int64]
_Mask = NDArray[np.bool_]

_FREE_FORM = "free-form curves and surfaces are left out"
_LEFT_OUT = {
    "p": "points are left out",
    "l": "lines are left out",
    **dict.fromkeys(("vp", "curv", "curv2", "surf", "bzp", "bsp", "cdc", "cdp", "res"), _FREE_FORM),
    **dict.fromkeys(("call", "csh"), "commands (call, csh) are not carried out"),
    **dict.fromkeys(("shadow_obj", "trace_obj"), "files of shadows and reflections are left out"),
    **dict.fromkeys(("maplib", "usemap"), "texture maps of faces (usemap) are left out"),
}
# Names and groups show nowhere; the others belong to free-form statements.
_WITHOUT_EFFECT = {
    *("g", "o", "mg", "bevel", "lod", "c_interp", "d_interp", "ctech", "stech", "bmat", "step", "cstype", "deg"),
    *("parm", "trim", "hole", "scrv", "sp", "end", "con"),
}


def read_obj(source: Source) -> Contents:
    """The file's faces as meshes, in the order in which materials are first used.

    Raises
    ------
    ValueError
        A line that can't be read, which is named; a reference to a file outside of the folder.
    OSError
        The file, or a library of materials that is there, can't be read.
    """
    return Contents([*_Reader(source).read()])


class _Reader:
    def __init__(self, source: Source) -> None:
        self._source = source
        self._note = Notices(source.path)
        self._text = with_newlines(source.read())
        self._positions: list[NDArray[np.float64]] = []
        self._vertex_count = 0
        self._corners: list[_Indices] = []
        self._counts: list[_Indices] = []
        self._offsets: list[_Indices] = []  # of faces' lines, for refusals
        self._materials: list[_Indices] = []
        self._numbers: dict[str, int] = {"": 0}  # of materials; "" for faces before any is named
        self._current = 0
        self._libraries: dict[str, None] = {}
        self._unknown: dict[str, int] = {}

    def read(self) -> list[Mesh]:
        # Of the same length, so that an offset leads to the line of the file.
        joined = self._text.replace(b"\\\n", b"  ") if b"\\\n" in self._text else self._text
        for start, block in blocks(joined):
            lines = Lines(block)
            try:
                self._read_block(lines, start)
            except BadLine as bad:
                raise refusal(self._text, start + int(lines.starts[bad.index]), bad.why) from None
        if self._unknown:
            words = ", ".join(f"{word!r} in line {line}" for word, line in list(self._unknown.items())[:5])
            self._note(f"lines that start with no statement of OBJ are left out: {words}")
        return self._meshes() if self._corners else []

    # ---- lines ----

    def _read_block(self, lines: Lines, start: int) -> None:
        is_vertex, is_face = lines.starting_with(b"v"), lines.starting_with(b"f")
        is_outline = lines.starting_with(b"fo")  # an older word for f
        lines.without_comments(is_vertex | is_face | is_outline)
        is_normal = lines.starting_with(b"vn")
        if is_normal.any():
            self._note("normals are left out: surfaces are shaded flat")
        others = (lines.words > 0) & (lines.bytes[lines.first] != ord("#"))
        others &= ~(is_vertex | is_face | is_outline | is_normal | lines.starting_with(b"vt"))
        carried = self._current
        changes = [(-1, carried), *self._statements(lines, others, start)]
        lines.blank(is_vertex | is_face, 1)
        lines.blank(is_outline, 2)
        self._read_vertices(lines, is_vertex)
        self._read_faces(lines, is_vertex, is_face | is_outline, changes, start)

    def _statements(self, lines: Lines, chosen: _Mask, start: int) -> Iterator[tuple[int, int]]:
        """The lines that change the material, with its number; what the others hold is noted."""
        for index in np.flatnonzero(chosen).tolist():
            word, rest = [*decoded(lines.line(index)).split(None, 1), ""][:2]
            keyword = word.lower()
            if keyword == "usemtl":
                self._current = self._numbers.setdefault(rest, len(self._numbers))
                yield index, self._current
            elif keyword == "mtllib":
                self._libraries[rest] = None
            elif keyword in _LEFT_OUT:
                self._note(_LEFT_OUT[keyword])
            elif keyword == "s":
                if rest.lower() not in ("off", "0", ""):
                    self._note("smoothing groups are left out: surfaces are shaded flat")
            elif keyword not in _WITHOUT_EFFECT and word not in self._unknown:
                self._unknown[word] = line_number(self._text, start + int(lines.starts[index]))

    def _read_vertices(self, lines: Lines, chosen: _Mask) -> None:
        words = lines.words[chosen]
        if not len(words):
            return
        if (words < 3).any():
            raise BadLine(int(np.flatnonzero(chosen & (lines.words < 3))[0]), "a vertex has three coordinates")
        if (words >= 6).any():
            self._note("colours of vertices are left out")
        values = lines.numbers(chosen, np.float64, "a vertex is given by numbers")
        if (words == words[0]).all():
            positions = values.reshape(len(words), -1)[:, :3]
        else:
            positions = values[(np.cumsum(words) - words)[:, None] + np.arange(3)]
        finite = np.isfinite(positions).all(axis=1)
        if not finite.all():
            raise BadLine(int(np.flatnonzero(chosen)[np.argmin(finite)]), "coordinates must be finite")
        self._positions.append(positions)

    def _read_faces(
        self, lines: Lines, is_vertex: _Mask, chosen: _Mask, changes: list[tuple[int, int]], start: int
    ) -> None:
        known = self._vertex_count + np.cumsum(is_vertex)
        self._vertex_count = int(known[-1])
        rows = np.flatnonzero(chosen)
        if not len(rows):
            return
        indices = lines.numbers(chosen, np.int64, "corners are vertices' numbers, as 7, 7/1, 7//3 or 7/1/3")
        counts = lines.words[rows]
        if (indices <= 0).any():
            of_corner = np.repeat(rows, counts)
            # Counted back from the last vertex before the face; 0 is none.
            corners = np.where(indices > 0, indices - 1, np.where(indices < 0, known[of_corner] + indices, -1))
            if (corners < 0).any():
                at = int(np.argmax(corners < 0))
                row = int(of_corner[at])
                raise BadLine(row, f"there is no vertex {indices[at]}: {known[row]} stand before this line")
        else:
            corners = indices - 1
        self._corners.append(corners)
        self._counts.append(counts)
        self._offsets.append(start + lines.starts[rows])
        at_lines, numbers = np.array(changes).T
        self._materials.append(numbers[np.searchsorted(at_lines, rows, side="right") - 1])

    # ---- meshes ----

    def _meshes(self) -> list[Mesh]:
        corners, counts = np.concatenate(self._corners), np.concatenate(self._counts)
        if len(corners) and corners.max() >= self._vertex_count:  # also where vertices follow the faces
            at = int(np.argmax(corners >= self._vertex_count))
            face = int(np.searchsorted(np.cumsum(counts), at, side="right"))
            offset = int(np.concatenate(self._offsets)[face])
            raise refusal(
                self._text, offset, f"there is no vertex {corners[at] + 1}: the file has {self._vertex_count}"
            )
        few = int((counts < 3).sum())
        if few:
            self._note(f"faces of fewer than three corners are left out: {few}")
        self._source.take_triangles(int(np.maximum(counts - 2, 0).sum()))
        vertices = np.concatenate(self._positions or [np.empty((0, 3))])
        cut = triangulate(vertices, corners, counts, self._note)
        of_triangle = np.concatenate(self._materials)[cut.polygons]
        numbers, first = np.unique(of_triangle, return_index=True)
        names = list(self._numbers)
        used = [(names[number], number) for number in numbers[np.argsort(first)].tolist()]
        materials = Materials(self._source, list(self._libraries), self._note)
        materials.miss({name for name, _ in used} - {""})
        return [
            Mesh(*compact(vertices, cut.triangles[of_triangle == number]), **materials.of(name))
            for name, number in used
        ]
