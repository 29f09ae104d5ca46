# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""instances: the picture of the flattened scene, with the triangles held once."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import sunfleck as sf

BLACK = (0.0, 0.0, 0.0)
WHITE = (1.0, 1.0, 1.0)
Array = NDArray[np.float64]


def hull(n: int) -> tuple[Array, NDArray[np.uint32]]:
    """A convex, closed mesh with outward normals: the unit sphere in 2 n x n facets, without poles' slivers."""
    grid = np.linspace(-1, 1, n + 1)
    a, b = (x.ravel() for x in np.meshgrid(grid, grid, indexing="ij"))
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    side = (first[:, None, None] + np.array([[0, n + 1, n + 2], [0, n + 2, 1]])).reshape(-1, 3)
    points: list[Array] = []
    triangles: list[NDArray[np.int64]] = []
    for axis in range(3):
        for end in (-1, 1):
            triangles.append((side if end > 0 else side[:, ::-1]) + (n + 1) ** 2 * len(points))
            points.append(np.roll(np.stack([np.full(a.shape, end), a, b], axis=1), axis, axis=1))
    all_points = np.concatenate(points)
    all_points /= np.linalg.norm(all_points, axis=1)[:, None]
    return all_points, np.concatenate(triangles).astype(np.uint32)


POINTS, TRIANGLES = hull(8)
SINGLES = POINTS.astype(np.float32)


def square(half: float, height: float, down: bool = False, **options: object) -> sf.Mesh:
    corners = [[-half, -half, height], [half, -half, height], [half, half, height], [-half, half, height]]
    triangles = [[0, 2, 1], [0, 3, 2]] if down else [[0, 1, 2], [0, 2, 3]]
    return sf.Mesh(np.array(corners, dtype=np.float32), triangles, **options)  # type: ignore[arg-type]


def transforms(count: int, seed: int, mirror: bool = False, spread: float = 2) -> NDArray[np.float32]:
    """Rotations, scales of 0.3 to 1 along three axes, rotations, and places within a box."""
    rng = np.random.default_rng(seed)
    out = np.zeros((count, 3, 4))
    for one in out:
        turns = [np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in range(2)]
        linear = turns[0] @ np.diag(rng.uniform(0.3, 1, 3)) @ turns[1]
        one[:, :3] = linear * np.sign(np.linalg.det(linear)) * (-1 if mirror else 1)
        one[:, 3] = rng.uniform(-spread, spread, 3)
    return out.astype(np.float32)


def flattened(meshes: list[sf.Mesh], placed: NDArray[np.float32]) -> list[sf.Mesh]:
    """What the instances stand for: vertices transformed, corners turned round by a mirror."""
    flat = []
    for one in placed.astype(float):
        for mesh in meshes:
            points = np.float32(mesh.vertices.astype(float) @ one[:, :3].T + one[:, 3])
            mirror = np.linalg.det(one[:, :3]) < 0
            triangles = np.ascontiguousarray(mesh.triangles[:, [0, 2, 1]] if mirror else mesh.triangles)
            flat.append(sf.Mesh(points, triangles, mesh.albedo, mesh.emission, mesh.material))
    return flat


VIEW = sf.Camera((0, -9, 2), (0, 0, 0), up=(0, 0, 1), vertical_fov=40)


def pair(meshes: list[sf.Mesh], placed: NDArray[np.float32], **options: object) -> tuple[sf.Scene, sf.Scene]:
    ground = square(6, -2.5, albedo=(0.6, 0.6, 0.6))
    shapes: list[list[sf.Mesh | sf.Sphere | sf.Disk | sf.Instances]] = [
        [ground, sf.Sphere((0, 0, 0), 0.5), sf.Instances(meshes, placed)],
        [ground, sf.Sphere((0, 0, 0), 0.5), *flattened(meshes, placed)],
    ]
    few, many = (sf.Scene(s, VIEW, max_bounces=3, **options) for s in shapes)  # type: ignore[arg-type]
    return few, many


GROUPS = {
    "diffuse": [sf.Mesh(SINGLES, TRIANGLES, (0.7, 0.5, 0.3))],
    "two": [sf.Mesh(SINGLES, TRIANGLES, (0.7, 0.5, 0.3)), square(1.5, 0, albedo=(0.2, 0.7, 0.3))],
    "glass": [sf.Mesh(SINGLES, TRIANGLES, material=sf.Dielectric(1.5))],  # its outside is where normals point
    "metal": [sf.Mesh(SINGLES, TRIANGLES, (0.9, 0.8, 0.6), material=sf.Conductor(0.4))],
    "lamp": [square(1, 0.2, albedo=BLACK, emission=(4, 3, 2)), sf.Mesh(SINGLES * np.float32(0.2), TRIANGLES)],
}


@pytest.mark.parametrize("mirror", [False, True])
@pytest.mark.parametrize("group", list(GROUPS))
def test_the_picture_is_that_of_the_flattened_scene(group: str, mirror: bool) -> None:
    """With the same seed only paths that graze an edge differ, and those of many bounces off glass."""
    few, many = pair(GROUPS[group], transforms(12, 3, mirror), background=(0.3, 0.4, 0.5))
    got, expected = (
        sf.render(scene, 48, 48, spp=64, seed=1, aovs=("normal", "albedo", "depth")) for scene in (few, many)
    )
    error = np.hypot(got.half_width.astype(float), expected.half_width)
    difference = np.abs(got.color - expected.color).mean(axis=2)
    assert (difference <= error).mean() > 0.99
    assert np.median(difference) < 1e-5
    assert got.color.mean() == pytest.approx(expected.color.mean(), rel=2e-3 if group == "glass" else 1e-4)
    # A share of 2^-12 of the first hits may fall on the other side of an edge.
    for name, allowed in (("normal", 1e-3), ("albedo", 1e-3), ("depth", 3e-3)):
        a, b = got.aovs[name], expected.aovs[name]
        hit = np.isfinite(a) & np.isfinite(b)  # the depth of a pixel without surfaces is infinite
        assert (np.isfinite(a) == np.isfinite(b)).mean() > 0.995
        assert np.abs(a[hit] - b[hit]).mean() < allowed
    assert few.info.triangle_count == many.info.triangle_count
    assert few.info.light_count == many.info.light_count
    assert [stage for stage in few.plan().stages if stage != "instances"] == many.plan().stages


def test_normals_go_by_the_inverse_transposed() -> None:
    """A tilted plane, stretched along z only, faces along A^-T n."""
    normal, linear = np.array([0.0, -1, 1]), np.diag([1, 1, 4.0])
    tilted = sf.Mesh([[-9, -9, -9], [9, -9, -9], [9, 9, 9], [-9, 9, 9]], [[0, 1, 2], [0, 2, 3]])
    for sign in (1, -1):  # and mirrored
        placed = np.zeros((3, 4))
        placed[:, :3] = np.diag([sign, 1, 1]) @ linear
        scene = sf.Scene([sf.Instances(tilted, placed)], sf.Camera((0, -5, 0), (0, 0, 0), up=(0, 0, 1)))
        got = sf.render(scene, 4, 4, spp=16, aovs="normal").aovs["normal"]
        expected = np.linalg.inv(linear).T @ normal
        assert got == pytest.approx(np.broadcast_to(expected / np.linalg.norm(expected), got.shape), abs=1e-6)


@pytest.mark.parametrize(("a", "b", "turn"), [(1, 1, 0), (0.5, 2, 30), (-0.5, 2, 30), (-1, -0.3, 70)])
def test_the_irradiance_of_placed_lamps_is_the_rectangle_s(a: float, b: float, turn: float) -> None:
    """Under the middle of a 2a x 2b rectangle at height h, four times that under a corner (Howell's C-11 form)."""
    height, c, s = 1.5, math.cos(math.radians(turn)), math.sin(math.radians(turn))
    rotation = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    placed = np.column_stack([rotation @ np.diag([a, b, 1]), [0, 0, height]])
    lamp = sf.Instances(square(1, 0, down=True, albedo=BLACK, emission=WHITE), placed)
    floor = square(3, 0, albedo=WHITE)
    view = sf.Camera((2.9, 0, 0.05), (0, 0, 0), up=(0, 0, 1), vertical_fov=1e-3)
    scene = sf.Scene([floor, lamp], view, max_bounces=1)
    image = sf.render(scene, 16, 16, spp=256, pattern="random").color[..., 0].astype(float)
    p, q = math.hypot(a, height), math.hypot(b, height)
    expected = 4 * 0.5 * (abs(a) / p * math.atan(abs(b) / p) + abs(b) / q * math.atan(abs(a) / q)) / math.pi
    assert abs(image.mean() - expected) < 5 * image.std() / 16
    assert image.std() / 16 < 0.01 * expected
    assert scene.info.light_count == 1  # as one parallelogram


@pytest.mark.parametrize(("scale", "move"), [(1e-4, 0), (1e6, 0), (1, 1e5)])
@pytest.mark.parametrize("within", [False, True])  # the move is of the meshes, undone and done again by transforms
def test_scaled_and_moved_scenes_are_the_same_picture(scale: float, move: float, within: bool) -> None:
    def scene(size: float, off: float) -> sf.Scene:
        placed = transforms(12, 5).astype(float)
        placed[..., 3] = np.round(placed[..., 3] * 64) / 64  # so that moving rounds nothing
        placed[..., 3] *= size
        points = np.round(POINTS * 128) / 128
        if within:  # x = A ((p + off) - off) + t
            points = points * size + off
            placed[..., 3] -= off * placed[..., :3].sum(axis=2)
        else:
            placed[..., :3] *= size
        placed[..., 3] += off
        ground = square(6, -2.5, albedo=(0.6, 0.6, 0.6))
        ground = sf.Mesh(np.float32(ground.vertices * size + off), ground.triangles)
        ball = sf.Mesh(np.float32(points), TRIANGLES, (0.7, 0.7, 0.7))
        view = sf.Camera((off, -9 * size + off, 2 * size + off), (off, off, off), up=(0, 0, 1))
        return sf.Scene([ground, sf.Instances(ball, placed)], view, (0.5, 0.5, 0.5), max_bounces=3)

    expected, got = (sf.render(scene(*at), 48, 48, spp=64, seed=1) for at in ((1, 0), (scale, move)))
    error = np.hypot(got.half_width.astype(float), expected.half_width)
    difference = np.abs(got.color - expected.color).mean(axis=2)
    # Transforms of floats at 10^5 place things by 2^-7: of the meshes' move the sums are rounded to that.
    if within and move:
        assert got.color.mean() == pytest.approx(expected.color.mean(), rel=5e-3)
    else:
        assert (difference <= error).mean() > 0.99
        assert got.color.mean() == pytest.approx(expected.color.mean(), rel=1e-3)


@pytest.mark.parametrize("ratio", [1, 10, 100, 1000])
@pytest.mark.parametrize(("scale", "move"), [(1e-4, 0), (1, 0), (1e6, 0), (1, 3), (1, 1e5)])
def test_a_white_convex_body_does_not_shade_itself(ratio: float, scale: float, move: float) -> None:
    """Squashed by `ratio`, under an even sky it is 1 wherever no ray meets it again."""
    for seed in range(3):
        rng = np.random.default_rng(seed)
        turns = [np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in range(2)]
        placed = np.zeros((3, 4))
        placed[:, :3] = turns[0] @ np.diag([1, 1, 1 / ratio]) @ turns[1] * scale
        placed[:, 3] = move
        view = sf.Camera((move, -4 * scale + move, move), (move, move, move), up=(0, 0, 1))
        body = sf.Instances(sf.Mesh(SINGLES, TRIANGLES, WHITE), placed)
        scene = sf.Scene([body], view, WHITE, max_bounces=2, robust=True)  # no ray passes an edge
        assert (sf.render(scene, 32, 32, spp=16).color == 1).all()


def test_albedos_are_of_each_placement() -> None:
    placed = np.zeros((2, 3, 4))
    placed[:, :, :3] = np.eye(3)
    placed[:, 0, 3] = -1.2, 1.2
    colors = np.array([[0.1, 0.2, 0.3], [0.9, 0.8, 0.7]])
    ball = sf.Mesh(SINGLES, TRIANGLES)
    scene = sf.Scene([sf.Instances(ball, placed, albedos=colors)], VIEW)
    albedo = sf.render(scene, 65, 65, spp=16, aovs="albedo").aovs["albedo"]
    for column, color in zip((32 - 12, 32 + 12), colors, strict=True):  # 9.2 units away, 65 pixels are 6.7
        assert albedo[32, column] == pytest.approx(color, abs=1e-6)


def test_threads_change_no_bit() -> None:
    scene, _ = pair(GROUPS["lamp"], transforms(12, 3), background=(0.3, 0.4, 0.5))
    films = [sf.render(scene, 32, 32, spp=32, threads=threads).color for threads in (1, 4)]
    assert (films[0] == films[1]).all()


def test_triangles_are_held_once_and_arrays_read_in_place() -> None:
    placed = transforms(50, 1)
    body = sf.Mesh(SINGLES, TRIANGLES)
    once, again = sf.Instances(body, placed), sf.Instances([body], placed[:7])
    assert once.transforms is placed
    assert once.meshes[0].vertices is SINGLES
    assert len(once) == 50
    scene = sf.Scene([once, again, body], VIEW)
    info = scene.info
    assert info.instance_count == 57
    assert info.triangle_count == 58 * len(TRIANGLES)
    assert info.unique_triangle_count == 2 * len(TRIANGLES)  # the instances share one prototype
    assert info.mesh_count == 2
    assert scene.meshes == (body,)
    assert "57 instances" in repr(scene)
    full = np.zeros((7, 4, 4))
    full[:, :3], full[:, 3, 3] = placed[:7], 1
    assert (sf.Instances(body, full).transforms == placed[:7]).all()


def test_plans_and_hashes_know_of_instances() -> None:
    placed = transforms(3, 1)
    few, many = pair(GROUPS["diffuse"], placed)
    assert "instances" in few.plan().stages
    assert "instances" not in many.plan().stages
    assert few.info.hash == pair(GROUPS["diffuse"], placed.copy())[0].info.hash
    other = placed.copy()
    other[1, 2, 3] += np.float32(0.1)
    assert few.info.hash != pair(GROUPS["diffuse"], other)[0].info.hash


def change(row: int, column: int, value: float) -> NDArray[np.float32]:
    placed = transforms(3, 1)
    placed[1, row, column] = value
    return placed


def flat_transforms() -> NDArray[np.float32]:
    placed = transforms(3, 1)
    placed[2, :, 1] = placed[2, :, 0]
    return placed


BODY = GROUPS["diffuse"][0]


@pytest.mark.parametrize(
    ("make", "error", "part"),
    [
        (lambda: sf.Instances(sf.Instances(BODY, transforms(1, 1)), change(0, 0, 1)), TypeError, "Mesh"),  # type: ignore[arg-type]
        (lambda: sf.Instances([sf.Instances(BODY, transforms(1, 1))], change(0, 0, 1)), TypeError, "products"),  # type: ignore[list-item]
        (lambda: sf.Instances([sf.Sphere((0, 0, 0), 1)], transforms(1, 1)), TypeError, "Sphere"),  # type: ignore[list-item]
        (lambda: sf.Instances([], transforms(1, 1)), ValueError, "meshes is empty"),
        (lambda: sf.Instances(BODY, np.eye(3)), ValueError, r"shape \(3, 3\)"),
        (lambda: sf.Instances(BODY, ["a"]), TypeError, "transforms has dtype"),
        (lambda: sf.Instances(BODY, np.zeros((0, 3, 4))), ValueError, "0 transforms"),
        (lambda: sf.Instances(BODY, flat_transforms()), ValueError, "transform 2 is singular"),
        (lambda: sf.Instances(BODY, np.zeros((3, 4))), ValueError, "transform 0 is singular"),
        (lambda: sf.Instances(BODY, change(1, 2, math.nan)), ValueError, "transform 1: row 1, column 2 is nan"),
        (lambda: sf.Instances(BODY, change(2, 3, 1e13)), ValueError, "transform 1: row 2, column 3 is 1e"),
        (lambda: sf.Instances(BODY, np.eye(3, 4) * 1e-13), ValueError, "determinant"),
        (lambda: sf.Instances(BODY, np.ones((4, 4))), ValueError, "transform 0 has the last row"),
        (lambda: sf.Instances(BODY, transforms(2, 1), albedos=[[1, 1, 1]]), ValueError, r"give \(2, 3\)"),
        (lambda: sf.Instances(BODY, transforms(1, 1), albedos=[[1, 2, 1]]), ValueError, "albedo 0: its value 1 is 2"),
        (
            lambda: sf.Scene([sf.Instances(BODY, np.column_stack([np.eye(3) * 8e11, [5e11] * 3]))], VIEW),
            ValueError,
            "takes its prototype",
        ),
    ],
)
def test_bad_values_are_refused(make: Callable[[], object], error: type[Exception], part: str) -> None:
    with pytest.raises(error, match=part):
        make()
