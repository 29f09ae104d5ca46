# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""polygon: polygons of any shape as triangles, many at a time.

Convex polygons become fans. The others lose one ear after the other (Meisters 1975, "Polygons have ears"), in the
plane that Newell's normal is nearest to, the best-shaped ear first. A polygon of n corners always becomes n - 2
triangles; some have no area where corners coincide or lie on one line. Polygons may touch themselves, as those do
that reach a hole through a bridge: an ear is refused where an edge leads into it, not where a corner merely lies
on its border.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Triangulation", "compact", "triangulate"]

_Floats = NDArray[np.float64]
_Coordinates = NDArray[Any]  # real numbers of any type
_Indices = NDArray[np.int64]
_Mask = NDArray[np.bool_]

# Twice an area below this, relative to the square of the polygon's extent, counts as 0. Coordinates in decimals miss
# a common line by 2^-53 of their size; a sliver of this relative height is far below what float32 vertices hold.
_FLAT = 1e-12
_CORNERS_AT_ONCE = 1 << 17  # which bounds the memory to some tens of megabytes

# Scores of ears, the best first; a quality of shape in (0, 1] is added to the first two of ears with area.
_SPIKE, _EAR, _TOUCHING, _CROSSED, _STRAIGHT, _REFLEX = 5.0, 3.0, 2.0, 1.0, 0.5, 0.0


@dataclass(frozen=True)
class Triangulation:
    """Triangles of vertex indices, shape (m, 3), and the polygon that each is of, shape (m,)."""

    triangles: NDArray[Any]
    polygons: _Indices


def compact(vertices: _Coordinates, triangles: NDArray[Any]) -> tuple[_Coordinates, NDArray[Any]]:
    """Only the vertices that the triangles use, in their order, and the triangles over them."""
    if 8 * triangles.size < len(vertices):
        used, inverse = np.unique(triangles, return_inverse=True)
        return vertices[used], inverse.reshape(triangles.shape)
    mask = np.zeros(len(vertices), np.bool_)
    mask[triangles] = True
    if mask.all():
        return vertices, triangles
    return vertices[mask], (np.cumsum(mask) - 1)[triangles]


def triangulate(
    vertices: _Coordinates, corners: NDArray[Any], counts: _Indices, note: Callable[[str], None]
) -> Triangulation:
    """Polygons as triangles, in the polygons' order and wound as they are.

    Parameters
    ----------
    vertices : ndarray, shape (n, 3), real
        Positions, in any unit.
    corners : ndarray, shape (k,), integer
        The polygons' vertex indices, each in [0, n), one polygon after the other.
    counts : ndarray, shape (p,), int64
        Corners of each polygon, which sum to k. Polygons of fewer than three become nothing.
    note : callable
        Is told how many polygons cross themselves: no triangles fit them.

    Returns
    -------
    Triangulation
    """
    if len(counts) and (counts == 3).all():
        return Triangulation(corners.reshape(-1, 3), np.arange(len(counts)))
    sizes = np.maximum(counts - 2, 0)
    first_corner, first_triangle = np.cumsum(counts) - counts, np.cumsum(sizes) - sizes
    triangles = np.empty((int(sizes.sum()), 3), np.int64)
    crossing = 0
    for n in np.unique(counts[counts >= 3]).tolist():
        of_size = np.flatnonzero(counts == n)
        step = max(_CORNERS_AT_ONCE // n, 1)
        for start in range(0, len(of_size), step):
            rows = of_size[start : start + step]
            index = corners[first_corner[rows, None] + np.arange(n)]
            if n == 3:
                cut: _Indices = np.broadcast_to(np.arange(3), (len(rows), 1, 3))
            else:
                cut, crossed = _cut(vertices[index].astype(np.float64))
                crossing += int(crossed.sum())
            parts = np.take_along_axis(index, cut.reshape(len(rows), -1), axis=1).reshape(cut.shape)
            triangles[first_triangle[rows, None] + np.arange(n - 2)] = parts
    if crossing:
        note(f"polygons that cross themselves, and may be filled another way than elsewhere: {crossing}")
    return Triangulation(triangles, np.repeat(np.arange(len(counts)), sizes))


def _flattened(points: _Floats) -> tuple[_Floats, _Floats, _Floats]:
    """Shape (b, n, 3) as plane coordinates (b, n) that run counter-clockwise, and what area counts as none (b,).

    One coordinate is left out rather than the plane turned, so that what coincides goes on to do so.
    """
    points = points - points[:, :1]
    normal = np.cross(points, np.roll(points, -1, axis=1)).sum(axis=1)  # Newell: the sum over all edges
    axis = np.argmax(np.abs(normal), axis=1)
    rows = np.arange(len(points))
    x, y = points[rows, :, (axis + 1) % 3], points[rows, :, (axis + 2) % 3]
    x = np.where(normal[rows, axis][:, None] < 0, -x, x)
    extent = np.maximum(np.abs(x).max(axis=1), np.abs(y).max(axis=1))
    return x, y, _FLAT * extent * extent


def _cut(points: _Floats) -> tuple[_Indices, _Mask]:
    """Triangles (b, n - 2, 3) of polygons (b, n, 3) of one size, as numbers of corners; which cross themselves."""
    count, n, _ = points.shape
    x, y, flat = _flattened(points)
    fan = np.stack([np.zeros(n - 2, np.int64), np.arange(1, n - 1), np.arange(2, n)], axis=1)
    cut: _Indices = np.broadcast_to(fan, (count, n - 2, 3)).copy()
    before, after = np.roll(np.arange(n), 1), np.roll(np.arange(n), -1)
    turn = _turn(x[:, before], y[:, before], x, y, x[:, after], y[:, after])
    of_fan = _turn(x[:, fan[:, 0]], y[:, fan[:, 0]], x[:, fan[:, 1]], y[:, fan[:, 1]], x[:, fan[:, 2]], y[:, fan[:, 2]])
    convex = (turn >= -flat[:, None]).all(axis=1) & (of_fan > flat[:, None]).all(axis=1)
    crossed = np.zeros(count, np.bool_)
    rest = np.flatnonzero(~convex)
    if len(rest):
        ears = _Ears(x[rest], y[rest], flat[rest])
        cut[rest] = ears.clip()
        crossed[rest] = ears.crossed
    return cut, crossed


def _turn(ax: _Floats, ay: _Floats, bx: _Floats, by: _Floats, cx: _Floats, cy: _Floats) -> _Floats:
    """Twice the signed area of a triangle: above 0 where c lies to the left of the line from a to b."""
    result: _Floats = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    return result


def _at(values: NDArray[Any], index: _Indices) -> NDArray[Any]:
    return np.take_along_axis(values, index, axis=1)


class _Ears:
    """Polygons (b, n) of one size in the plane, counter-clockwise, that lose ears in step."""

    def __init__(self, x: _Floats, y: _Floats, flat: _Floats) -> None:
        count, n = x.shape
        self.x, self.y, self.flat = x, y, flat[:, None]
        self.before = np.tile(np.roll(np.arange(n), 1), (count, 1))
        self.after = np.tile(np.roll(np.arange(n), -1), (count, 1))
        self.alive = np.ones((count, n), np.bool_)
        self.score = np.full((count, n), -np.inf)
        self.crossed = np.zeros(count, np.bool_)
        self.given_up = np.zeros(count, np.bool_)

    def clip(self) -> _Indices:
        """The triangles, (b, n - 2, 3)."""
        count, n = self.x.shape
        everyone = np.arange(count)
        triangles = np.empty((count, n - 2, 3), np.int64)
        self._judge_all(everyone)
        for k in range(n - 2):
            best = self._best()
            a, c = self.before[everyone, best], self.after[everyone, best]
            triangles[:, k] = np.stack([a, best, c], axis=1)
            self.alive[everyone, best] = False
            self.score[everyone, best] = -np.inf
            self.after[everyone, a], self.before[everyone, c] = c, a
            if k < n - 3:
                self._judge(everyone, a)
                self._judge(everyone, c)
        return triangles

    def _best(self) -> _Indices:
        """The corner that each polygon loses next."""
        best: _Indices = self.score.argmax(axis=1)
        value = self.score[np.arange(len(best)), best]
        # What blocked an ear may have gone since it was judged. Where even a new look finds none, the polygon is
        # straight or crosses itself, and no further look would help.
        stuck = np.flatnonzero((value < _TOUCHING) & ~self.given_up)
        if len(stuck):
            self._judge_all(stuck)
            best[stuck] = self.score[stuck].argmax(axis=1)
            value[stuck] = self.score[stuck, best[stuck]]
            self.given_up[stuck] = value[stuck] < _TOUCHING
        self.crossed |= (value < _TOUCHING) & (value != _STRAIGHT)
        return best

    def _judge_all(self, rows: _Indices) -> None:
        for corner in range(self.x.shape[1]):
            some = rows[self.alive[rows, corner]]
            self._judge(some, np.full(len(some), corner))

    def _judge(self, rows: _Indices, corner: _Indices) -> None:
        """The score of one corner of each of those polygons."""
        if not len(rows):
            return
        x, y, flat = self.x[rows], self.y[rows], self.flat[rows]
        before, after = self.before[rows], self.after[rows]
        b = corner[:, None]
        a, c = _at(before, b), _at(after, b)
        ax, ay, bx, by, cx, cy = (_at(of, at) for at in (a, b, c) for of in (x, y))
        area = _turn(ax, ay, bx, by, cx, cy)
        sides = [
            _turn(px, py, qx, qy, x, y) for px, py, qx, qy in ((ax, ay, bx, by), (bx, by, cx, cy), (cx, cy, ax, ay))
        ]
        inside = [side > flat for side in sides]
        within = self.alive[rows] & np.logical_and.reduce([side >= -flat for side in sides])
        # An edge leads into the triangle from a corner of the polygon within it, or from one on its border if its
        # other end is on the inner side of the border's lines there.
        blocked = np.zeros(len(rows), np.bool_)
        for neighbour in (before, after):
            leads_in = np.logical_and.reduce([on | _at(on, neighbour) for on in inside])
            blocked |= (within & leads_in).any(axis=1)
        touching = (within & inside[0] & inside[1] & ~inside[2]).any(axis=1)  # on the diagonal from c to a
        longest = (ax - bx) ** 2 + (ay - by) ** 2 + (bx - cx) ** 2 + (by - cy) ** 2 + (cx - ax) ** 2 + (cy - ay) ** 2
        with np.errstate(invalid="ignore", divide="ignore"):
            quality = np.nan_to_num(2 * np.sqrt(3) * area / longest)[:, 0]
        spike = ((ax - bx) * (cx - bx) + (ay - by) * (cy - by) >= 0)[:, 0]  # its two edges run the same way
        area, flat = area[:, 0], flat[:, 0]
        score = np.where(touching, _TOUCHING, _EAR) + quality
        score = np.where(blocked, _CROSSED, score)
        score = np.where(area <= flat, np.where(spike, _SPIKE, _STRAIGHT), score)
        self.score[rows, corner] = np.where(area < -flat, _REFLEX, score)
