# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""light_choice: the tree of lights has the mean of a choice by power, whatever finds the light; when it is used."""

import math
from typing import Any

import numpy as np
import pytest

import sunfleck as sf

FLOOR = sf.Mesh(
    [[-50, -50, 0], [50, -50, 0], [50, 50, 0], [-50, 50, 0]], [[0, 1, 2], [0, 2, 3]], albedo=(0.7, 0.7, 0.7)
)
SPOT = sf.Camera((0, -1, 0.5), (0, 0, 0), up=(0, 0, 1), vertical_fov=1e-7)  # all rays meet the floor at the origin
ROOM = sf.Camera((0, -3, 1.2), (0, 0, 0.6), up=(0, 0, 1), vertical_fov=50)
BLACK = (0.0, 0.0, 0.0)


def panel(half: float, height: float, cells: int) -> sf.Mesh:
    """A square that faces down, of 2 cells^2 triangles. Rows are shifted so that some pair up and some do not."""
    x = np.linspace(-half, half, cells + 1)
    grid = np.stack([*np.meshgrid(x, x), np.full((cells + 1, cells + 1), height)], -1).reshape(-1, 3)
    i = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    j = i + cells + 1
    triangles = np.concatenate([np.stack([i, j, i + 1], 1), np.stack([i + 1, j, j + 1], 1)])
    return sf.Mesh(grid.astype(np.float32), triangles, albedo=BLACK, emission=(10, 10, 10))


def scattered(count: int, seed: int = 7) -> list[sf.Mesh]:
    """Triangles that face anywhere, in two meshes of different radiance."""
    rng = np.random.default_rng(seed)
    middles = rng.uniform((-2, -2, 0.2), (2, 2, 2), (count, 3))
    corners = (middles[:, None] + 0.08 * rng.uniform(-1, 1, (count, 3, 3))).astype(np.float32)
    return [
        sf.Mesh(part.reshape(-1, 3), np.arange(3 * len(part)).reshape(-1, 3), BLACK, (radiance,) * 3)
        for part, radiance in zip(np.array_split(corners, 2), (20, 60), strict=True)
    ]


def mean_of(scene: sf.Scene, size: int = 16, spp: int = 256, seed: int = 1) -> tuple[float, float]:
    """Mean radiance of the picture and its standard error, from independent samples."""
    image = sf.render(scene, size, size, spp=spp, pattern="random", seed=seed)
    error = np.sqrt((image.half_width.astype(float) ** 2).sum()) / 1.959964 / size**2
    return float(image.color.mean()), float(error)


@pytest.mark.parametrize("sampling", ["both", "light"])
@pytest.mark.parametrize("bounces", [1, 2])
def test_irradiance_of_a_rectangle_of_2000_triangles_is_the_closed_form(sampling: str, bounces: int) -> None:
    half, height = 2.0, 1.0
    lamp = panel(half, height, 32)
    scene = sf.Scene([FLOOR, lamp], SPOT, max_bounces=bounces, light_sampling=sampling, light_choice="tree")
    assert lamp.triangles.shape[0] == 2048
    assert "light tree" in scene.plan().stages
    radiance, error = mean_of(scene, spp=512)
    # Below its middle: four corners (Siegel & Howell, configuration C-11 of the view factors).
    slope = half / math.hypot(half, height)
    expected = 0.7 / math.pi * 10 * 4 * slope * math.atan(slope)
    # 5 standard errors: 1 of 10^6 trials; and 2^-18, by which vertices and light points are moved.
    assert abs(radiance - expected) < 5 * error + 2e-5 * expected


SETTINGS: dict[str, tuple[list[Any], dict[str, Any]]] = {
    "diffuse": ([], {}),
    "rough glass": ([sf.Sphere((0, 0, 0.6), 0.5, material=sf.Dielectric(1.5, roughness=0.4))], {}),
    "rough metal": ([sf.Sphere((0, 0, 0.6), 0.5, material=sf.Conductor(roughness=0.5))], {}),
    "fog": ([], {"fog": sf.Fog(0.2, 0.02, 0.5)}),
    "sky and shapes": (
        [sf.Sphere((0.5, 0, 1), 0.1, BLACK, (9, 9, 9)), sf.Disk((-1, 0, 1.5), (0, 0, -1), 0.3, BLACK, (5, 5, 5))],
        {
            "suns": [sf.Sun((1, 1, 1), 5, irradiance=(1, 1, 1))],
            "environment": sf.Environment(np.full((3, 5, 3), 0.1, np.float32)),
        },
    ),
}


@pytest.mark.parametrize("kind", SETTINGS)
def test_the_mean_is_that_of_power_and_of_surface_rays(kind: str) -> None:
    shapes, settings = SETTINGS[kind]
    ways = [("power", "both"), ("tree", "both"), ("tree", "light"), ("tree", "surface")]
    means = [
        mean_of(
            sf.Scene(
                [FLOOR, *scattered(200), *shapes], ROOM, max_bounces=2, light_choice=c, light_sampling=s, **settings
            ),
            spp=1024,
        )
        for c, s in ways
    ]
    reference, error = means[1]
    for (mean, other), way in zip(means, ways, strict=True):
        # 5 standard errors of the difference, of independent samples or better; the light points' 2^-18.
        assert abs(mean - reference) < 5 * math.hypot(error, other) + 2e-5 * reference, way


# "auto" takes the tree from 8 lights on; up to 64 primitives surface rays are sorted, and their vertices with them.
@pytest.mark.parametrize(("lamps", "primitives"), [(7, 64), (8, 20), (8, 63), (8, 64), (8, 65), (52, 64)])
@pytest.mark.parametrize("material", [None, sf.Conductor(roughness=0.4), sf.Dielectric(1.5, roughness=0.3)])
def test_a_closed_room_has_the_mean_of_power(
    lamps: int, primitives: int, material: sf.Conductor | sf.Dielectric | None
) -> None:
    corners = np.stack(np.meshgrid([-1, 1], [-1, 1], [-1, 1], indexing="ij"), -1).reshape(-1, 3).astype(np.float32)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    walls = sf.Mesh(corners, [t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])], albedo=(0.7, 0.6, 0.5))
    rng = np.random.default_rng(lamps)
    bulb = (rng.uniform(-0.3, 0.3, (lamps, 1, 3)) + rng.uniform(-0.3, 0.3, (lamps, 3, 3))).astype(np.float32)
    bulb[..., 2] += 0.3
    specks = rng.uniform(-1, 1, (3 * (primitives - 12 - lamps), 3)).astype(np.float32) * 1e-4 + [0, 0, 50]
    shapes = [
        walls,
        sf.Mesh(bulb.reshape(-1, 3), np.arange(3 * lamps).reshape(-1, 3), BLACK, (10, 10, 10), material=material),
        *([sf.Mesh(specks, np.arange(len(specks)).reshape(-1, 3))] if len(specks) else []),
    ]
    below = sf.Camera((-0.9, -0.9, -0.5), (0.9, 0.9, -0.9), up=(0, 0, 1), vertical_fov=30)
    means = [
        mean_of(sf.Scene(shapes, below, max_bounces=4, light_choice=choice), spp=512) for choice in ("auto", "power")
    ]
    # 5 standard errors of the difference. With vertices left where they were the mean was 5 to 29 % too high.
    assert abs(means[0][0] - means[1][0]) < 5 * math.hypot(means[0][1], means[1][1])


def test_a_choice_by_the_tree_has_the_lower_error_among_spread_lights() -> None:
    errors = [
        mean_of(sf.Scene([FLOOR, *scattered(2000)], SPOT, max_bounces=1, light_choice=choice))[1]
        for choice in ("power", "tree")
    ]
    # Half of the lights face away from any point, and the tree draws few of these: that alone halves the
    # variance. Near ones vary more. 0.8 is half way from the root of a half to 1, at errors known to some %.
    assert errors[1] < 0.8 * errors[0]


@pytest.mark.parametrize("choice", ["auto", "power", "tree"])
def test_the_plan_says_when_the_tree_is_used(choice: str) -> None:
    def stages(*shapes: sf.Mesh) -> tuple[str, ...]:
        return tuple(sf.Scene([FLOOR, *shapes], ROOM, light_choice=choice).plan().stages)

    assert ("light tree" in stages(*scattered(200))) == (choice != "power")
    assert ("light tree" in stages(*scattered(6))) == (choice == "tree")
    assert "light tree" not in stages(panel(1, 1, 1))  # one rectangle: nothing to choose


def test_power_and_auto_are_the_same_bits_where_there_are_few() -> None:
    films = [
        sf.render(sf.Scene([FLOOR, *scattered(6)], ROOM, light_choice=choice), 16, 16, spp=16, seed=3).color
        for choice in ("auto", "power")
    ]
    assert np.array_equal(films[0], films[1])


def test_the_tree_is_the_same_bits_on_any_number_of_threads() -> None:
    scene = sf.Scene([FLOOR, *scattered(500)], ROOM, max_bounces=3)
    films = [sf.render(scene, 40, 24, spp=16, seed=3, threads=threads).color for threads in (1, 2, 5)]
    assert np.array_equal(films[0], films[1])
    assert np.array_equal(films[0], films[2])


def test_lights_without_extent_beside_huge_ones() -> None:
    specks = np.tile(np.array([[0.5, 0.5, 1], [0.501, 0.5, 1], [0.5, 0.501, 1]], np.float32), (100, 1))
    flat = np.zeros((30, 3), np.float32)
    vertices = np.concatenate([specks, flat])
    tiny = sf.Mesh(vertices, np.arange(330).reshape(-1, 3), BLACK, (1000, 1000, 1000))
    shapes = [FLOOR, tiny, panel(20, 3, 1)]
    means = [mean_of(sf.Scene(shapes, SPOT, max_bounces=1, light_choice=c)) for c in ("power", "tree")]
    assert abs(means[0][0] - means[1][0]) < 5 * math.hypot(means[0][1], means[1][1])


def test_the_choice_is_part_of_the_scene() -> None:
    scenes = [sf.Scene([FLOOR, *scattered(40)], ROOM, light_choice=c) for c in ("auto", "power", "tree")]
    assert len({scene.info.hash for scene in scenes}) == 3
    assert [scene.light_choice for scene in scenes] == ["auto", "power", "tree"]
    with pytest.raises(ValueError, match="light_choice is 'best'; choose one of auto, power, tree"):
        sf.Scene([FLOOR], ROOM, light_choice="best")
