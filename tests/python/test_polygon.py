# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""polygon: triangles of any polygon cover what it covers."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sunfleck.io.polygon import compact, triangulate

U = [(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)]
DART = [(2, -1), (1, 0), (2, 1), (0, 0)]
# A square whose contour goes over a bridge to its hole, and back.
HOLE = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)]
TWO_HOLES = [
    *((0, 0), (9, 0), (9, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)),
    *((6, 1), (6, 3), (8, 3), (8, 1), (6, 1), (1, 1)),
]
PINCH = [(0, 0), (2, 1), (4, 0), (4, 4), (2, 1), (0, 4)]  # one corner is the middle twice
TOUCH = [(0, 0), (4, 0), (4, 4), (2, 0), (0, 4)]  # a corner on another edge
STRAIGHT = [(0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
DOUBLE = [(0, 0), (2, 0), (2, 0), (2, 2), (2, 2), (1, 1), (0, 2)]
SPIKE_OUT = [(0, 0), (4, 0), (4, 4), (2, 4), (2, 6), (2, 4), (0, 4)]
SPIKE_IN = [(0, 0), (4, 0), (4, 4), (2, 4), (2, 2), (2, 4), (0, 4)]


def rotation(seed: int) -> NDArray[np.float64]:
    q: NDArray[np.float64] = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    return q


def cut(*polygons: Any) -> tuple[NDArray[np.float64], NDArray[Any], NDArray[Any], list[str]]:
    """Corners of each polygon's own, the triangles, of which polygon they are, and the notices."""
    vertices = np.concatenate([np.asarray(p, np.float64) for p in polygons])
    if vertices.shape[1] == 2:
        vertices = np.c_[vertices, np.zeros(len(vertices))]
    counts = np.array([len(p) for p in polygons])
    notices: list[str] = []
    found = triangulate(vertices, np.arange(len(vertices)), counts, notices.append)
    return vertices, found.triangles, found.polygons, notices


def normals(vertices: NDArray[np.float64], triangles: NDArray[Any]) -> NDArray[np.float64]:
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    result: NDArray[np.float64] = np.cross(b - a, c - a) / 2
    return result


@pytest.mark.parametrize(
    ("polygon", "area"),
    [
        (U, 5), (DART, 1), (HOLE, 12), (TWO_HOLES, 28), (PINCH, 8), (TOUCH, 8), (STRAIGHT, 4), (DOUBLE, 3),
        (SPIKE_OUT, 16), (SPIKE_IN, 16),
    ],
)  # fmt: skip
@pytest.mark.parametrize("seed", range(3))
def test_triangles_cover_the_polygon_and_are_wound_as_it_is(polygon: list[Any], area: float, seed: int) -> None:
    """From any first corner, in either direction, in any plane. A rotation rounds by 2^-53 of the size, so that
    what touches in the plane may miss or cross by that in space; the area then is off by that times the length."""
    for first in range(len(polygon)):
        turned = polygon[first:] + polygon[:first]
        flat = np.c_[np.array(turned, np.float64), np.zeros(len(turned))]
        for placed in (flat, flat[::-1], (flat @ rotation(seed).T)[::-1]):
            vertices, triangles, _, notices = cut(placed)
            assert len(triangles) == len(polygon) - 2
            areas = normals(vertices, triangles)
            assert np.linalg.norm(areas, axis=1).sum() == pytest.approx(area, rel=1e-9)
            assert np.linalg.norm(areas.sum(axis=0)) == pytest.approx(area, rel=1e-9)
            assert not notices


def test_stars_of_every_size_are_covered_and_nothing_twice() -> None:
    """Random star-shaped polygons in space; sums of signed and unsigned areas agree only without overlap."""
    chance = np.random.default_rng(7)
    polygons, wanted = [], []
    for k in range(120):
        n = int(chance.integers(4, 40))
        angles = 2 * np.pi * (np.arange(n) + 0.8 * chance.random(n)) / n
        radii = 0.1 + 0.9 * chance.random(n)
        x, y = radii * np.cos(angles), radii * np.sin(angles)
        wanted.append(0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
        polygons.append(np.c_[x, y, np.zeros(n)] @ rotation(k).T + chance.normal(size=3))
    vertices, triangles, owners, notices = cut(*polygons)
    areas = normals(vertices, triangles)
    unsigned = np.bincount(owners, np.linalg.norm(areas, axis=1))
    signed = [np.linalg.norm(areas[owners == k].sum(axis=0)) for k in range(len(polygons))]
    np.testing.assert_allclose(unsigned, wanted, rtol=1e-9)
    np.testing.assert_allclose(signed, wanted, rtol=1e-9)
    assert not notices


def test_convex_polygons_are_fans_in_the_order_of_the_file() -> None:
    square, dart, triangle = [(0, 0), (1, 0), (1, 1), (0, 1)], DART, [(0, 0), (1, 0), (0, 1)]
    _, triangles, owners, _ = cut(square, dart, triangle, square)
    assert owners.tolist() == [0, 0, 1, 1, 2, 3, 3]
    assert triangles[:2].tolist() == [[0, 1, 2], [0, 2, 3]]
    assert triangles[4:].tolist() == [[8, 9, 10], [11, 12, 13], [11, 13, 14]]


def test_corners_on_a_straight_edge_stay_corners_of_triangles_with_area() -> None:
    vertices, triangles, _, _ = cut(STRAIGHT)
    assert (np.linalg.norm(normals(vertices, triangles), axis=1) > 0).all()
    assert set(triangles.ravel().tolist()) == set(range(8))


def test_a_polygon_that_crosses_itself_is_filled_and_said() -> None:
    _, triangles, _, notices = cut([(0, 0), (3, 2), (3, 0), (0, 1)], U)
    assert len(triangles) == 2 + 6
    assert len(notices) == 1
    assert "cross themselves" in notices[0]
    assert notices[0].endswith(": 1")


def test_polygons_without_area_or_corners_break_nothing() -> None:
    _, triangles, owners, _ = cut([(0, 0)], [(0, 0), (1, 0)], [(0, 0)] * 5, [(0, 0), (1, 0), (2, 0), (3, 0)], U)
    assert owners.tolist() == [2] * 3 + [3] * 2 + [4] * 6
    assert len(triangles) == 11


def test_compact_keeps_what_is_used() -> None:
    vertices = np.arange(300.0).reshape(100, 3)
    for triangles in (np.array([[5, 99, 7]]), np.arange(3, 99).reshape(-1, 3), np.arange(99).reshape(-1, 3)[::-1]):
        kept, renumbered = compact(vertices, triangles)
        assert len(kept) == len(np.unique(triangles))
        np.testing.assert_array_equal(kept[renumbered], vertices[triangles])
