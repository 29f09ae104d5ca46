# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""scenes: the built-in scenes, each made anew from a few numbers."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sunfleck.scene import Camera, Scene
from sunfleck.scene.mesh import Mesh

__all__ = ["SCENES", "cornell", "defocus", "keyhole", "penumbra"]

Arrays = tuple[NDArray[np.float64], NDArray[np.uint32]]

_QUAD = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.uint32)
_GREY = (0.7, 0.7, 0.7)
_BLACK = (0.0, 0.0, 0.0)
_SPHERE_CENTRE = (-0.45, -0.1, 0.5)


def _icosphere(subdivisions: int, radius: float, centre: ArrayLike) -> Arrays:
    """A regular icosahedron, each triangle split in four `subdivisions` times, pushed to the sphere."""
    golden = (1 + 5**0.5) / 2
    vertices = np.array(
        [(0, a, b * golden) for a in (-1, 1) for b in (-1, 1)]
        + [(a, b * golden, 0) for a in (-1, 1) for b in (-1, 1)]
        + [(b * golden, 0, a) for a in (-1, 1) for b in (-1, 1)]
    )
    # The faces are the triples at distance 2 of one another, wound to face outward.
    near = np.isclose(np.linalg.norm(vertices[:, None] - vertices[None], axis=2), 2)
    triangles = np.array(
        [
            (i, j, k) if np.linalg.det(vertices[[i, j, k]]) > 0 else (i, k, j)
            for i in range(12)
            for j in range(i + 1, 12)
            for k in range(j + 1, 12)
            if near[i, j] and near[j, k] and near[i, k]
        ]
    )
    for _ in range(subdivisions):
        # One new vertex in the middle of each edge, shared by the two triangles that meet there.
        edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        edges, inverse = np.unique(edges, axis=0, return_inverse=True)
        middle = len(vertices) + inverse.reshape(-1, 3)
        vertices = np.concatenate([vertices, vertices[edges].mean(axis=1)])
        (a, b, c), (ab, bc, ca) = triangles.T, middle.T
        corners = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        triangles = np.stack([np.stack(corner, axis=1) for corner in corners], axis=1).reshape(-1, 3)
    vertices *= radius / np.linalg.norm(vertices, axis=1, keepdims=True)
    return vertices + np.asarray(centre), triangles.astype(np.uint32)


def _box(lower: ArrayLike, upper: ArrayLike) -> Arrays:
    """An axis-aligned box, its six sides facing outward, four vertices each."""
    lower, upper = np.asarray(lower, dtype=np.float64), np.asarray(upper, dtype=np.float64)
    sides = []
    for axis in range(3):
        for end in (0, 1):
            square = np.full((4, 3), float(end))
            # Counter-clockwise as seen from outside: the other two axes in cyclic order, or swapped.
            first, second = [(axis + 1) % 3, (axis + 2) % 3][:: 1 if end else -1]
            square[:, first] = (0, 1, 1, 0)
            square[:, second] = (0, 0, 1, 1)
            sides.append(square)
    triangles = np.concatenate([_QUAD + 4 * np.uint32(side) for side in range(6)])
    return lower + np.concatenate(sides) * (upper - lower), triangles


def _penumbra_meshes() -> list[Mesh]:
    floor = [(-5, -5, 0), (5, -5, 0), (5, 5, 0), (-5, 5, 0)]
    light = [(-0.5, -0.5, 3), (-0.5, 0.5, 3), (0.5, 0.5, 3), (0.5, -0.5, 3)]  # wound to face down
    return [
        Mesh(floor, _QUAD, _GREY),
        Mesh(*_icosphere(5, 0.5, _SPHERE_CENTRE), _GREY),
        Mesh(*_box((0.35, -0.2, 0), (1.05, 0.5, 0.9)), _GREY),
        Mesh(light, _QUAD, _BLACK, (10, 10, 10)),
    ]


def _penumbra_camera() -> Camera:
    return Camera((0, -4, 3.2), (0, 0, 0.3), up=(0, 0, 1), vertical_fov=35)


def penumbra() -> Scene:
    """A sphere and a box on a floor under one square light: soft shadows, direct light only.

    z is up. A floor of side 10, an icosphere of 20,480 triangles and a box, all of albedo 0.7;
    a 1 x 1 light of radiance 10, three units above the floor; 1 bounce.

    Examples
    --------
    >>> import sunfleck as sf
    >>> sf.scenes.penumbra()
    Scene(4 meshes, 20496 triangles, 1 lights, max_bounces=1)
    """
    return Scene(_penumbra_meshes(), _penumbra_camera(), max_bounces=1)


def defocus() -> Scene:
    """Penumbra through a wide lens, with a hundred small spheres on the floor.

    Icospheres of radius 0.09 (1,280 triangles each) stand on a 10 x 10 grid over +-2.25; the
    aperture's radius is 0.1, the focus lies on the large sphere's centre.

    Examples
    --------
    >>> import sunfleck as sf
    >>> [group.name for group in sf.scenes.defocus().plan().dimensions]
    ['pixel', 'lens', 'light 1']
    """
    vertices, triangles = _icosphere(3, 0.09, (0, 0, 0.09))
    grid = np.linspace(-2.25, 2.25, 10)
    places = np.array([(x, y, 0) for y in grid for x in grid])
    spheres = Mesh(
        (places[:, None] + vertices).reshape(-1, 3),
        (np.arange(len(places))[:, None, None] * len(vertices) + triangles).reshape(-1, 3),
        _GREY,
    )
    camera = _penumbra_camera()
    position, target = np.array(camera.position), np.array(camera.target)
    axis = (target - position) / np.linalg.norm(target - position)
    focus = float((np.array(_SPHERE_CENTRE) - position) @ axis)
    camera = dataclasses.replace(camera, aperture_radius=0.1, focus_distance=focus)
    return Scene([*_penumbra_meshes(), spheres], camera, max_bounces=1)


def _rectangle(x: ArrayLike, y: ArrayLike, centre: ArrayLike) -> Arrays:
    """The square [-1, 1]^2 with its axes along x and y; it faces x cross y."""
    x, y, centre = (np.asarray(v, dtype=np.float64) for v in (x, y, centre))
    return np.array([centre - x - y, centre + x - y, centre + x + y, centre - x + y]), _QUAD


def _turned_box(half_size: ArrayLike, degrees: float, centre: ArrayLike) -> Arrays:
    """A box turned about the y axis."""
    vertices, triangles = _box((-1, -1, -1), (1, 1, 1))
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    turn = np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])
    return vertices * np.asarray(half_size) @ turn.T + np.asarray(centre), triangles


def cornell() -> Scene:
    """The Cornell box of Mitsuba 3's ``mi.cornell_box()``: colour bleeding, 5 bounces.

    The same geometry, colours and camera; the light's own albedo is 0 here.

    References
    ----------
    Goral, Torrance, Greenberg & Battaile 1984, "Modeling the interaction of light between
    diffuse surfaces". Jakob et al. 2022, "Mitsuba 3 renderer".

    Examples
    --------
    >>> import sunfleck as sf
    >>> sf.scenes.cornell()
    Scene(8 meshes, 36 triangles, 1 lights, max_bounces=5)
    """
    white, red, green = (
        (0.885809, 0.698859, 0.666422),
        (0.570068, 0.0430135, 0.0443706),
        (0.105421, 0.37798, 0.076425),
    )
    x, y, z = np.eye(3)
    meshes = [
        Mesh(*_rectangle(x, -z, -y), white),  # floor
        Mesh(*_rectangle(x, z, y), white),  # ceiling
        Mesh(*_rectangle(x, y, -z), white),  # back
        Mesh(*_rectangle(-z, y, -x), red),
        Mesh(*_rectangle(z, y, x), green),
        Mesh(*_turned_box((0.3, 0.3, 0.3), -17, (0.335, -0.7, 0.38)), white),
        Mesh(*_turned_box((0.3, 0.61, 0.3), 18.25, (-0.33, -0.4, -0.28)), white),
        Mesh(*_rectangle(0.23 * x, 0.19 * z, (0, 0.99, 0.01)), _BLACK, (18.387, 13.9873, 6.75357)),
    ]
    camera = Camera((0, 0, 3.9), (0, 0, 2.9), vertical_fov=39.3077)
    return Scene(meshes, camera, max_bounces=5)


def keyhole() -> Scene:
    """A room that gets its light through a small gap in a wall: most pixels see light rarely.

    z is up. The room spans 4 x 4 x 2.5; behind a gap of 0.3 x 0.6 in the wall at x = 2 lies a
    chamber with a lamp of 0.8 x 0.8 and radiance 60 under its ceiling. All albedo 0.7; 5 bounces.

    Examples
    --------
    >>> import sunfleck as sf
    >>> sf.scenes.keyhole().info.light_count
    1
    """
    x, y, z = np.eye(3)

    def wall(y0: float, y1: float, z0: float, z1: float) -> Mesh:
        """A part of the wall with the gap, which faces the room."""
        return Mesh(*_rectangle(-(y1 - y0) / 2 * y, (z1 - z0) / 2 * z, (2, (y0 + y1) / 2, (z0 + z1) / 2)), _GREY)

    meshes = [
        Mesh(*_rectangle(3 * x, 2 * y, (1, 0, 0)), _GREY),  # floor, of the room and the chamber
        Mesh(*_rectangle(3 * x, -2 * y, (1, 0, 2.5)), _GREY),  # ceiling
        Mesh(*_rectangle(3 * x, 1.25 * z, (1, 2, 1.25)), _GREY),
        Mesh(*_rectangle(-3 * x, 1.25 * z, (1, -2, 1.25)), _GREY),
        Mesh(*_rectangle(2 * y, 1.25 * z, (-2, 0, 1.25)), _GREY),
        Mesh(*_rectangle(-2 * y, 1.25 * z, (4, 0, 1.25)), _GREY),
        wall(-2, -0.15, 0, 2.5),
        wall(0.15, 2, 0, 2.5),
        wall(-0.15, 0.15, 0, 1.0),
        wall(-0.15, 0.15, 1.6, 2.5),
        Mesh(*_box((-0.6, -1.2, 0), (0.2, -0.5, 0.8)), _GREY),
        Mesh(*_rectangle(0.4 * x, -0.4 * y, (3, 0, 2.45)), _BLACK, (60, 60, 60)),
    ]
    return Scene(meshes, Camera((-1.9, 1.7, 1.5), (0.6, -0.5, 0.7), up=(0, 0, 1), vertical_fov=70), max_bounces=5)


SCENES: dict[str, Callable[[], Scene]] = {
    "penumbra": penumbra,
    "defocus": defocus,
    "cornell": cornell,
    "keyhole": keyhole,
}
