# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""scenes: the built-in ones are what the design says."""

import numpy as np
import pytest

import sunfleck as sf


def corners(mesh: sf.Mesh) -> np.ndarray:
    return mesh.vertices[mesh.triangles].astype("float64")


def normals(mesh: sf.Mesh) -> np.ndarray:
    a, b, c = corners(mesh).swapaxes(0, 1)
    return np.cross(b - a, c - a)


def bounds(mesh: sf.Mesh) -> list[list[float]]:
    return [mesh.vertices.min(axis=0).tolist(), mesh.vertices.max(axis=0).tolist()]


def assert_closed(mesh: sf.Mesh) -> None:
    """Every edge is run through once each way, by position."""
    _, same = np.unique(mesh.vertices.round(5), axis=0, return_inverse=True)
    triangles = same.reshape(-1)[mesh.triangles]
    edges = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    assert len(np.unique(edges, axis=0)) == len(edges)
    assert {tuple(e) for e in edges.tolist()} == {tuple(e) for e in edges[:, ::-1].tolist()}


def test_penumbra(penumbra: sf.Scene) -> None:
    floor, sphere, box, light = penumbra.meshes
    assert bounds(floor) == [[-5, -5, 0], [5, 5, 0]]
    assert (normals(floor)[:, 2] > 0).all()

    centre = np.array([-0.45, -0.1, 0.5])
    assert len(sphere.triangles) == 20480
    assert np.linalg.norm(sphere.vertices - centre, axis=1) == pytest.approx(0.5, abs=1e-6)
    assert_closed(sphere)
    assert (np.einsum("ij,ij->i", normals(sphere), corners(sphere).mean(axis=1) - centre) > 0).all()

    assert np.allclose(bounds(box), [[0.35, -0.2, 0], [1.05, 0.5, 0.9]])
    assert len(box.triangles) == 12
    assert_closed(box)
    middle = box.vertices.mean(axis=0)
    assert (np.einsum("ij,ij->i", normals(box), corners(box).mean(axis=1) - middle) > 0).all()

    assert bounds(light) == [[-0.5, -0.5, 3], [0.5, 0.5, 3]]
    assert (normals(light)[:, 2] < 0).all()
    assert (light.emission, light.albedo) == ((10, 10, 10), (0, 0, 0))
    assert [mesh.albedo for mesh in (floor, sphere, box)] == [(0.7, 0.7, 0.7)] * 3
    assert penumbra.camera == sf.Camera((0, -4, 3.2), (0, 0, 0.3), up=(0, 0, 1), vertical_fov=35)
    assert (penumbra.max_bounces, penumbra.background) == (1, (0, 0, 0))
    assert penumbra.info.rectangle_light_count == 1


def test_defocus(penumbra: sf.Scene) -> None:
    scene = sf.scenes.defocus()
    assert scene.info.triangle_count == 20496 + 100 * 1280
    spheres = scene.meshes[-1]
    assert_closed(spheres)
    balls = spheres.vertices.reshape(100, -1, 3)
    middles = balls.mean(axis=1)
    grid = np.linspace(-2.25, 2.25, 10)
    assert middles == pytest.approx(np.array([(x, y, 0.09) for y in grid for x in grid]), abs=1e-5)
    assert np.linalg.norm(balls - middles[:, None], axis=2) == pytest.approx(0.09, abs=1e-5)
    assert scene.camera.aperture_radius == 0.1
    axis = np.array([0, 4, -2.9]) / np.hypot(4, 2.9)
    assert scene.camera.focus_distance == pytest.approx(axis @ np.array([-0.45, 3.9, -2.7]))
    assert scene.max_bounces == 1


def test_cornell_is_mitsubas(cornell: sf.Scene) -> None:
    floor, ceiling, back, red, green, small, large, light = cornell.meshes
    # What mi.cornell_box() of Mitsuba 3.6 prints for its shapes' to_world, bounds and normals.
    assert np.allclose(bounds(floor), [[-1, -1, -1], [1, -1, 1]])
    assert np.allclose(bounds(ceiling), [[-1, 1, -1], [1, 1, 1]])
    assert np.allclose(bounds(back), [[-1, -1, -1], [1, 1, -1]])
    assert np.allclose(bounds(red), [[-1, -1, -1], [-1, 1, 1]])
    assert np.allclose(bounds(green), [[1, -1, -1], [1, 1, 1]])
    assert np.allclose(bounds(light), [[-0.23, 0.99, -0.18], [0.23, 0.99, 0.2]])
    for mesh, inward in ((floor, (0, 1, 0)), (ceiling, (0, -1, 0)), (back, (0, 0, 1)), (red, (1, 0, 0))):
        assert (normals(mesh) @ inward > 0).all()
    assert (normals(green) @ (-1, 0, 0) > 0).all()
    assert (normals(light) @ (0, -1, 0) > 0).all()

    # Their corner (1, 1, 1), by the matrices that it prints.
    for box, matrix in (
        (small, [(0.286891, 0, -0.0877115, 0.335), (0, 0.3, 0, -0.7), (0.0877115, 0, 0.286891, 0.38)]),
        (large, [(0.28491, 0, 0.0939491, -0.33), (0, 0.61, 0, -0.4), (-0.0939491, 0, 0.28491, -0.28)]),
    ):
        m = np.array(matrix)
        cube = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        expected = cube @ m[:, :3].T + m[:, 3]
        distance = np.linalg.norm(box.vertices[:, None] - expected, axis=2)
        assert distance.min(axis=0).max() < 1e-5
        assert distance.min(axis=1).max() < 1e-5
        assert_closed(box)

    white = (0.885809, 0.698859, 0.666422)
    assert all(mesh.albedo == white for mesh in (floor, ceiling, back, small, large))
    assert red.albedo == (0.570068, 0.0430135, 0.0443706)
    assert green.albedo == (0.105421, 0.37798, 0.076425)
    assert (light.albedo, light.emission) == ((0, 0, 0), (18.387, 13.9873, 6.75357))
    assert (cornell.camera.position, cornell.camera.vertical_fov) == ((0, 0, 3.9), 39.3077)
    assert cornell.max_bounces == 5


def test_cornell_shows_its_red_wall_on_the_left_and_its_light_on_top(cornell: sf.Scene) -> None:
    color = sf.render(cornell, 32, 32, spp=16).color
    left, right = color[12:20, 1], color[12:20, -2]
    assert (left[:, 0] > 2 * left[:, 1]).all()
    assert (right[:, 1] > 1.5 * right[:, 0]).all()
    row, column = np.unravel_index(np.argmax(color[..., 0]), (32, 32))
    assert row < 8
    assert 10 < column < 22


def test_penumbra_is_as_bright_as_its_light_makes_it(penumbra: sf.Scene) -> None:
    # A patch of open floor far from the shadows, in front: the light's square is summed over in
    # 200 x 200 parts for the point under the pixel's centre.
    image = sf.render(penumbra, 64, 64, spp=256)
    position, target = np.array(penumbra.camera.position), np.array(penumbra.camera.target)
    forward = (target - position) / np.linalg.norm(target - position)
    right = np.cross(forward, (0, 0, 1))
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    half = np.tan(np.radians(35 / 2))
    x, y = 32, 60
    ray = forward + half * (((x + 0.5) / 32 - 1) * right + (1 - (y + 0.5) / 32) * up)
    hit = position - ray * position[2] / ray[2]
    axis = (np.arange(200) + 0.5) / 200 - 0.5
    light = np.stack([*np.meshgrid(axis, axis), np.full((200, 200), 3.0)], axis=-1)
    to = light - hit
    square = (to**2).sum(axis=-1)
    irradiance = 10 * np.mean(to[..., 2] ** 2 / square**2)
    # The pixel spans 1.6 % of the distance; brightness varies by less than that across it, and
    # linear variation cancels. 256 stratified samples of a smooth integrand: well below 1 %.
    assert image.color[y, x] == pytest.approx(0.7 / np.pi * irradiance, rel=0.01)


def test_keyhole_is_a_closed_room_lit_through_the_gap_alone() -> None:
    scene = sf.scenes.keyhole()
    assert scene.info.light_count == 1
    image = sf.render(scene, 32, 32, spp=64)
    assert image.alpha.min() == 1  # no ray leaves
    # With direct light alone, few pixels see any: those on the streak, and what the gap shows.
    direct = sf.Scene(scene.meshes, scene.camera, max_bounces=1)
    lit = sf.render(direct, 32, 32, spp=64).color.mean(axis=2) > 0
    assert 0.01 < lit.mean() < 0.2
    assert (image.color.mean(axis=2) > 0).mean() > 0.9  # most are lit by what the streak reflects
