# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""scene: rays neither meet the surface that they leave nor slip between triangles, at any scale and place."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

import sunfleck as sf

WHITE = (1.0, 1.0, 1.0)
Points = NDArray[np.float64]


def rotation(seed: int) -> Points:
    q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    turned: Points = q if q[2, 2] > 0 else -q
    return turned


def box(n: int) -> tuple[Points, NDArray[np.uint32]]:
    """The cube [-1, 1]^3 of n x n x 2 triangles a side; sides share positions, not vertices."""
    grid = np.linspace(-1, 1, n + 1)
    a, b = (x.ravel() for x in np.meshgrid(grid, grid, indexing="ij"))
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    side = first[:, None, None] + np.array([[0, 1, n + 2], [0, n + 2, n + 1]])
    points: list[Points] = []
    triangles: list[NDArray[np.int64]] = []
    for axis in range(3):
        for end in (-1, 1):
            triangles.append(side.reshape(-1, 3) + (n + 1) ** 2 * len(points))
            points.append(np.roll(np.stack([np.full(a.shape, end), a, b], axis=1), axis, axis=1))
    return np.concatenate(points), np.concatenate(triangles).astype(np.uint32)


def camera(position: Points, target: Points, up: Points, fov: float) -> sf.Camera:
    px, tx, ux = ((float(v[0]), float(v[1]), float(v[2])) for v in (position, target, up))
    return sf.Camera(px, tx, up=ux, vertical_fov=fov)


def room(scale: float, move: float) -> sf.Scene:
    """A box without a front, with a lamp, a glass ball, a metal ball and a disk; corners in multiples of 1/128."""

    def quad(corners: list[list[float]], **options: object) -> sf.Mesh:
        points = np.float32(np.array(corners) * scale + move)
        return sf.Mesh(points, [[0, 1, 2], [0, 2, 3]], **options)  # type: ignore[arg-type]

    def at(x: float, y: float, z: float) -> tuple[float, float, float]:
        return (x * scale + move, y * scale + move, z * scale + move)

    shapes: list[sf.Mesh | sf.Sphere | sf.Disk] = [
        quad([[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]], albedo=(0.7, 0.7, 0.7)),
        quad([[-2, 2, 0], [2, 2, 0], [2, 2, 3], [-2, 2, 3]], albedo=(0.6, 0.3, 0.3)),
        quad([[-2, -2, 0], [-2, 2, 0], [-2, 2, 3], [-2, -2, 3]], albedo=(0.3, 0.6, 0.3)),
        quad([[-0.5, -0.5, 2.5], [-0.5, 0.5, 2.5], [0.5, 0.5, 2.5], [0.5, -0.5, 2.5]], emission=(9, 9, 9)),
        sf.Sphere(at(-0.75, 0, 0.5), 0.5 * scale, material=sf.Dielectric(1.5), albedo=WHITE),
        sf.Sphere(at(0.75, 0.5, 0.75), 0.75 * scale, material=sf.Conductor(0.3), albedo=(0.9, 0.7, 0.4)),
        sf.Disk(at(0.5, -1, 0.25), (0, -1, 1), 0.25 * scale, albedo=(0.2, 0.4, 0.8)),
    ]
    view = sf.Camera(at(0.5, -4, 2), at(0, 0, 0.75), up=(0, 0, 1), vertical_fov=45)
    return sf.Scene(shapes, view, background=(0.1, 0.1, 0.1), max_bounces=3)


@pytest.fixture(scope="module")
def reference() -> sf.Image:
    return sf.render(room(1, 0), 48, 48, spp=128, seed=1)


@pytest.fixture(scope="module")
def long_reference() -> sf.Image:
    return sf.render(room(1, 0), 48, 48, spp=1024, seed=1)


@pytest.mark.parametrize(("scale", "move"), [(1e-4, 0), (1e6, 0), (1, 1e5), (1, -1e5)])
def test_scaled_and_moved_scenes_are_the_same_picture(
    reference: sf.Image, long_reference: sf.Image, scale: float, move: float
) -> None:
    """With the same seed only paths that graze an edge differ: less than the noise, by far."""
    image = sf.render(room(scale, move), 48, 48, spp=128, seed=1)
    error = np.hypot(image.half_width.astype(float), reference.half_width)
    difference = np.abs(image.color - reference.color).mean(axis=2)
    assert (difference <= error).mean() > 0.99
    assert image.color.mean() == pytest.approx(reference.color.mean(), rel=1e-3)
    # Independent samples: at 1,024 a pixel two means differ by 9e-4, one standard deviation.
    other = sf.render(room(scale, move), 48, 48, spp=1024, seed=2)
    assert other.color.mean() == pytest.approx(long_reference.color.mean(), rel=5e-3)


@pytest.mark.parametrize("triangle", [False, True])
@pytest.mark.parametrize(("size", "scale"), [(10, 1e-4), (10, 1), (10, 1e6), (1e3, 1), (1e5, 1), (1e6, 1)])
def test_a_white_plane_does_not_shade_itself(size: float, scale: float, triangle: bool) -> None:
    """Under an even sky it is 1 wherever no ray meets it again; tilted, and seen from a distance of 1."""
    corners = (
        [[-1.3, -1, 0], [2, -1, 0], [-0.3, 2, 0]] if triangle else [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
    )
    triangles = [[0, 1, 2]] if triangle else [[0, 1, 2], [0, 2, 3]]
    for seed in range(3):
        turn = rotation(seed)
        points = np.float32(np.array(corners) * size @ turn.T * scale)
        view = camera(turn @ [0.1, 0.2, 1] * scale, turn @ [0.15, 0.25, 0] * scale, turn[:, 0], 60)
        scene = sf.Scene([sf.Mesh(points, triangles, albedo=WHITE)], view, background=WHITE, max_bounces=2)
        assert (sf.render(scene, 32, 32, spp=16).color == 1).all()


@pytest.mark.parametrize(("radius", "move"), [(1e-4, 0), (1, 0), (1e6, 0), (1, 1e5), (1024, 1e9)])
def test_a_white_sphere_does_not_shade_itself(radius: float, move: float) -> None:
    """At 10^9 floats lie 64 apart."""
    ball = sf.Sphere((move, move, move), radius, albedo=WHITE)
    view = camera(np.array([3.0, 2, 1]) * radius + move, np.full(3, move), np.array([0.0, 0, 1]), 20)
    scene = sf.Scene([ball], view, background=WHITE, max_bounces=2)
    assert (sf.render(scene, 32, 32, spp=32).color == 1).all()


def test_large_tilted_lights_do_not_shade_themselves() -> None:
    """A ceiling 1,000 times as wide as its height lights the floor at its middle by pi times its radiance."""
    turn = rotation(4)
    half = 1000.0
    floor = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * 10
    ceiling = np.array([[-half, -half, 1], [-half, half, 1], [half, half, 1], [half, -half, 1]])
    shapes = [
        sf.Mesh(np.float32(floor @ turn.T), [[0, 1, 2], [0, 2, 3]], albedo=WHITE),
        sf.Mesh(np.float32(ceiling @ turn.T), [[0, 1, 2], [0, 2, 3]], albedo=(0, 0, 0), emission=WHITE),
    ]
    view = camera(turn @ [0, -0.5, 0.5], turn @ [0, 0, 0.0], turn[:, 2], 10)
    image = sf.render(sf.Scene(shapes, view, max_bounces=1), 16, 16, spp=256)
    # Its middle sees all but a rim: 1 - (slope of 1/1000)^2; by solid angle from up there.
    assert image.color.mean() == pytest.approx(1, abs=0.01)


def edge_light(n: int, scale: float, move: float, robust: bool) -> float:
    """The light within a closed box under a bright sky, of rays aimed at places where triangles meet."""
    points, triangles = box(n)
    turn = np.eye(3) if move else rotation(5)
    walls = sf.Mesh(np.float32(points @ turn.T * scale + move), triangles, albedo=(0.9, 0.9, 0.9))
    total = 0.0
    for target in ([1, 1, 0.3], [0.25, -1, -1], [1, 0.5, 0.25], [-1, -1, -1], [0.5, 1, 0.1]):
        view = camera(
            turn @ [0.3, 0.2, -0.5] * scale + move,
            turn @ np.array(target) * scale + move,
            np.array([0.1, 0.2, 1]),
            1e-4,
        )
        scene = sf.Scene([walls], view, background=(1e6,) * 3, max_bounces=3, robust=robust)
        total += float(sf.render(scene, 32, 32, spp=64).color.sum())
    return total


@pytest.mark.parametrize(("scale", "move"), [(1e-4, 0), (1, 0), (1e6, 0), (1, 1e5)])
def test_a_closed_box_is_black_inside(scale: float, move: float) -> None:
    assert edge_light(8, scale, move, robust=True) == 0


def test_without_robust_some_rays_at_edges_escape() -> None:
    """What the test above would miss otherwise."""
    assert edge_light(8, 1, 0, robust=False) > 0


def test_scenes_near_the_origin_are_read_in_place_and_far_ones_copied() -> None:
    points, triangles = box(1)
    view = sf.Camera((0, 0, 0), (1, 0, 0), up=(0, 0, 1))
    assert sf.Scene([sf.Mesh(np.float32(points), triangles)], view, WHITE).info.copied_bytes == 0
    far = sf.Scene([sf.Mesh(np.float32(points + 100), triangles)], view, WHITE).info
    assert far.copied_bytes == 24 * 12
    assert far.bounds_lower == pytest.approx((99, 99, 99))


def test_robust_is_true_or_false() -> None:
    points, triangles = box(1)
    with pytest.raises(TypeError, match="robust is 1; give True or False"):
        sf.Scene([sf.Mesh(np.float32(points), triangles)], sf.Camera((0, 0, 0), (1, 0, 0)), robust=1)  # type: ignore[arg-type]
