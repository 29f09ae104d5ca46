# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""lights: irradiances that have a closed form, by light sampling, surface sampling and both."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import sunfleck as sf

Shapes = list[sf.Mesh | sf.Sphere | sf.Disk]
Vector = tuple[float, float, float]

FLOOR = sf.Mesh(
    [[-50, -50, 0], [50, -50, 0], [50, 50, 0], [-50, 50, 0]], [[0, 1, 2], [0, 2, 3]], albedo=(0.7, 0.7, 0.7)
)
# All of its rays meet the floor at the origin.
SPOT = sf.Camera((0, -1, 0.5), (0, 0, 0), up=(0, 0, 1), vertical_fov=1e-7)
BLACK = (0.0, 0.0, 0.0)


def square(half: float, height: float, radiance: float = 10) -> sf.Mesh:
    corners = [[-half, -half, height], [-half, half, height], [half, half, height], [half, -half, height]]
    return sf.Mesh(corners, [[0, 1, 2], [0, 2, 3]], albedo=BLACK, emission=(radiance,) * 3)


def half_square(half: float, height: float) -> sf.Mesh:
    corners = [[-half, -half, height], [-half, half, height], [half, half, height]]
    return sf.Mesh(corners, [[0, 1, 2]], albedo=BLACK, emission=(10, 10, 10))


def under_square(half: float, height: float) -> float:
    """Below its middle: four corners (Siegel & Howell, configuration C-11 of the view factors)."""
    slope = half / math.hypot(half, height)
    return 10 * 4 * slope * math.atan(slope)


def sun_at(degrees: float, radius: float, **light: tuple[float, float, float]) -> sf.Sun:
    return sf.Sun((math.sin(math.radians(degrees)), 0, math.cos(math.radians(degrees))), radius, **light)


def one_texel() -> tuple[sf.Environment, float]:
    """Radiance 1000 in one pixel, and its irradiance: the integral of the cosine over the patch."""
    image = np.zeros((64, 128, 3), np.float32)
    image[16, 40] = 1000
    low, high = 16 / 64 * math.pi, 17 / 64 * math.pi
    irradiance = 1000 * 2 * math.pi / 128 * (math.sin(high) ** 2 - math.sin(low) ** 2) / 2
    return sf.Environment(image, up=(0, 0, 1)), irradiance


TEXEL, TEXEL_IRRADIANCE = one_texel()
SKY = sf.Environment(np.full((3, 5, 3), 2, np.float32), up=(0, 0, 1))

# Shapes, what else the scene has, and the irradiance at the origin.
CASES: dict[str, tuple[Shapes, dict[str, Any], float]] = {
    "small square": ([square(0.5, 3)], {}, under_square(0.5, 3)),
    "large square": ([square(4, 1)], {}, under_square(4, 1)),
    "huge square": ([square(40, 1)], {}, under_square(40, 1)),
    "large square by area": ([square(4, 1)], {"solid_angle_ratio": 0}, under_square(4, 1)),
    "large triangle": ([half_square(4, 1)], {}, under_square(4, 1) / 2),  # by symmetry
    # E = pi L (r / D)^2 of a sphere right above.
    "sphere": ([sf.Sphere((0, 0, 3), 0.8, BLACK, (10, 10, 10))], {}, math.pi * 10 * (0.8 / 3) ** 2),
    # E = pi L r^2 / (r^2 + h^2) of a disk right above.
    "disk": ([sf.Disk((0, 0, 2), (0, 0, -1), 1.5, BLACK, (10, 10, 10))], {}, math.pi * 10 * 1.5**2 / (1.5**2 + 4)),
    # E = pi L sin^2(radius) cos(direction): exact while the whole sun is above the horizon.
    "sun": (
        [],
        {"suns": [sun_at(30, 5, radiance=(10, 10, 10))]},
        math.pi * 10 * math.sin(math.radians(5)) ** 2 * math.cos(math.radians(30)),
    ),
    "direction": ([], {"suns": [sun_at(60, 0, irradiance=(10, 10, 10))]}, 5),
    "even sky": ([], {"environment": SKY}, 2 * math.pi),
    "one pixel": ([], {"environment": TEXEL}, TEXEL_IRRADIANCE),
}


def measure(shapes: Shapes, settings: dict[str, Any], sampling: str, bounces: int) -> tuple[float, float]:
    """Radiance of the floor at the origin and its standard error, from independent samples."""
    scene = sf.Scene([FLOOR, *shapes], SPOT, max_bounces=bounces, light_sampling=sampling, **settings)
    image = sf.render(scene, 16, 16, spp=512, pattern="random", seed=1)
    error = np.sqrt((image.half_width.astype(float) ** 2).sum()) / 1.959964 / 256
    return float(image.color.mean()), float(error)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("sampling", ["both", "light", "surface"])
def test_irradiance_is_the_closed_form_however_it_is_sampled(case: str, sampling: str) -> None:
    shapes, settings, irradiance = CASES[case]
    if sampling == "surface" and case in ("direction", "one pixel"):
        pytest.skip("surface rays find it never or hardly ever")
    for bounces in (1, 2):  # with 2 there are surface rays, which find the light too
        radiance, error = measure(shapes, settings, sampling, bounces)
        expected = 0.7 / math.pi * irradiance
        # 5 standard errors: 1 of 10^6 trials; and 2^-18, by which vertices and light points are moved.
        assert abs(radiance - expected) < 5 * error + 2e-5 * expected


def test_all_kinds_of_light_together_are_the_same_by_light_sampling_alone_and_weighted() -> None:
    shapes: Shapes = [
        square(4, 1),
        sf.Sphere((3, 0, 0.5), 0.3, BLACK, (20, 20, 20)),
        sf.Disk((1, 1, 0.2), (-1, -1, 1), 0.1, BLACK, (9, 9, 9)),
    ]
    settings = {
        "suns": [sun_at(60, 0, irradiance=(10, 10, 10)), sun_at(80, 5, irradiance=(8, 8, 8))],
        "environment": SKY,
    }
    both, error = measure(shapes, settings, "both", 3)
    light, other = measure(shapes, settings, "light", 3)
    assert abs(both - light) < 5 * math.hypot(error, other)


def test_solid_angle_lowers_the_error_under_a_large_light() -> None:
    """Uniform over the solid angle, only the cosine varies: it is measured 6.7 times at ratio 4."""
    _, near = measure([square(4, 1)], {}, "light", 1)
    _, area = measure([square(4, 1)], {"solid_angle_ratio": 0}, "light", 1)
    assert near < area / 5


def test_an_even_environment_is_the_background() -> None:
    ball = sf.Sphere((0, 0, 0.5), 0.5, (0.6, 0.5, 0.4))
    camera = sf.Camera((0, -3, 1), (0, 0, 0.5), up=(0, 0, 1))
    images = [
        sf.render(sf.Scene([FLOOR, ball], camera, max_bounces=3, **light), 32, 32, spp=256)
        for light in ({"background": (2, 2, 2)}, {"environment": SKY})
    ]
    error = np.hypot(*(image.half_width.astype(float) for image in images))
    difference = np.abs(images[0].color - images[1].color).mean(axis=2)
    assert (difference <= 1.5 * error + 1e-5).mean() > 0.95  # half-widths are of 95 %; wide, of a stratified pattern
    assert images[0].color.mean() == pytest.approx(images[1].color.mean(), rel=2e-3)
    assert (images[0].alpha == images[1].alpha).all()


# What the camera sees along each axis of an environment of six colours, as OpenEXR has it: row 0 is +y,
# the middle column +z, the column a quarter to the left +x.
@pytest.mark.parametrize(
    ("up", "rotation", "seen"),
    [
        ((0, 1, 0), 0, {(0, 1, 0): "top", (0, -1, 0): "bottom", (0, 0, 1): 0, (1, 0, 0): 90, (0, 0, -1): 180}),
        ((0, 1, 0), 90, {(0, 1, 0): "top", (1, 0, 0): 0, (0, 0, -1): 90, (-1, 0, 0): 180, (0, 0, 1): -90}),
        ((0, 0, 1), 0, {(0, 0, 1): "top", (0, 0, -1): "bottom", (1, 0, 0): 0, (0, 1, 0): 90, (0, -1, 0): -90}),
        ((2, 0, 0), 0, {(1, 0, 0): "top", (0, 0, 1): 0, (0, -1, 0): 90, (0, 1, 0): -90}),
    ],
)
def test_directions_of_the_environment(up: Vector, rotation: float, seen: dict[Vector, str | int]) -> None:
    image = np.zeros((8, 16, 3), np.float32)
    image[:2], image[6:] = 10, 20
    # Column k spans the longitudes from 180 - 22.5 k down.
    centers = 180 - 22.5 * (np.arange(16) + 0.5)
    colors = {0: 1, 90: 2, 180: 3, -90: 4}
    for longitude, color in colors.items():
        image[2:6, np.abs((centers - longitude + 180) % 360 - 180) < 45] = color
    environment = sf.Environment(image, up, rotation)
    speck = sf.Sphere((0, 0, 1e6), 1e-6)
    for direction, what in seen.items():
        level = (0, 0, 1) if direction[2] == 0 else (0, 1, 0)
        camera = sf.Camera((0, 0, 0), direction, up=level, vertical_fov=1)
        seen_color = sf.render(sf.Scene([speck], camera, environment=environment), 4, 4, spp=16).color
        expected = {"top": 10, "bottom": 20}[what] if isinstance(what, str) else colors[what]
        assert (seen_color == expected).all()


def test_the_camera_sees_the_sun_s_disk() -> None:
    """Its share of the picture is its solid angle over that of the pixels, near the axis."""
    sun = sf.Sun((0, 0, 1), 2, radiance=(5, 4, 3))
    camera = sf.Camera((0, 0, 0), (0, 0, 1), vertical_fov=10)
    speck = sf.Sphere((0, 0, -100), 1)
    image = sf.render(sf.Scene([speck], camera, suns=[sun]), 64, 64, spp=64)
    assert image.color[32, 32] == pytest.approx((5, 4, 3), rel=1e-5)
    assert (image.color[0, 0] == 0).all()
    # On the picture's plane at distance 1: a disk of radius tan 2 degrees in a square of half tan 5.
    share = math.pi * (math.tan(math.radians(2)) / math.tan(math.radians(5)) / 2) ** 2
    assert image.color[..., 0].mean() / 5 == pytest.approx(share, rel=0.003)


def test_depth_normal_and_albedo_of_a_sphere_and_a_disk() -> None:
    ball = sf.Sphere((0, 0, 0), 1, (0.1, 0.2, 0.3))
    plate = sf.Disk((0, 3, 0), (0, -2, 0), 3, (0.4, 0.5, 0.6))
    camera = sf.Camera((0, -4, 0), (0, 0, 0), up=(0, 0, 1), vertical_fov=60)
    scene = sf.Scene([ball, plate], camera, (1, 1, 1), max_bounces=1)
    image = sf.render(scene, 65, 65, spp=16, aovs=("depth", "normal", "albedo"))
    middle, side = (32, 32), (32, 50)  # 18 pixels are 17.7 degrees; the ball fills 14.5, the disk 23.2
    assert image.aovs["depth"][middle] == pytest.approx(3, abs=1e-3)
    assert image.aovs["normal"][middle] == pytest.approx((0, -1, 0), abs=2e-3)
    assert image.aovs["albedo"][middle] == pytest.approx((0.1, 0.2, 0.3))
    assert image.aovs["depth"][side] == pytest.approx(7, abs=1e-5)
    assert image.aovs["normal"][side] == pytest.approx((0, -1, 0), abs=1e-6)
    assert image.aovs["albedo"][side] == pytest.approx((0.4, 0.5, 0.6))
    assert scene.info.mesh_count == 0
    assert (scene.info.sphere_count, scene.info.disk_count) == (1, 1)


def test_a_thousand_lights_are_as_bright_as_one() -> None:
    """A square of 32 x 32 tiles, each of two triangles that are one light."""
    n = 32
    x, y = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(n)))
    low = np.stack([x / n - 0.5, y / n - 0.5, np.full(n * n, 3.0)], axis=1)
    steps = np.array([(0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)]) / n
    vertices = (low[:, None] + steps).reshape(-1, 3)
    order = np.array([(0, 1, 2), (0, 2, 3)])
    triangles = (4 * np.arange(n * n)[:, None, None] + order).reshape(-1, 3)
    tiles = sf.Mesh(vertices, triangles, albedo=BLACK, emission=(10, 10, 10))
    scene = sf.Scene([FLOOR, tiles], SPOT, max_bounces=1)
    assert scene.info.light_count == n * n
    radiance, error = measure([tiles], {}, "both", 1)
    assert abs(radiance - 0.7 / math.pi * under_square(0.5, 3)) < 5 * error + 1e-5


def test_plans_show_what_a_scene_needs() -> None:
    ball = sf.Sphere((0, 0, 0), 1)
    camera = sf.Camera((0, -4, 0), (0, 0, 0), up=(0, 0, 1))
    plain = sf.Scene([FLOOR, square(0.5, 3)], camera).plan().stages
    assert not {"round shapes", "sky", "light shapes"} & set(plain)
    assert "round shapes" in sf.Scene([ball], camera, (1, 1, 1)).plan().stages
    assert {"sky", "light shapes"} <= set(
        sf.Scene([FLOOR], camera, suns=[sf.Sun((0, 0, 1), irradiance=(1, 1, 1))]).plan().stages
    )
    delta = sf.Scene([FLOOR], camera, max_bounces=1, suns=[sf.Sun((0, 0, 1), 0, (1, 1, 1))]).plan()
    assert "sky" not in delta.stages
    assert delta.surface_rays == 0
    # Of one bright pixel among 64 x 128 light sampling finds all, and the last surface ray nothing.
    wide, narrow = (sf.Scene([FLOOR], camera, max_bounces=2, environment=e).plan() for e in (SKY, TEXEL))
    assert "last surface" in wide.stages
    assert "last surface" not in narrow.stages
    assert {"surface", "weight"} <= set(narrow.stages)
    assert (wide.surface_rays, narrow.surface_rays) == (2, 1)
    alone = sf.Scene([FLOOR, square(0.5, 3)], camera, max_bounces=2, light_sampling="surface").plan()
    assert (alone.shadow_rays, alone.surface_rays) == (0, 2)
    assert "weight" not in alone.stages


@pytest.mark.parametrize(
    ("make", "error", "part"),
    [
        (lambda: sf.Sphere((0, 0, 0), -1), ValueError, "radius is -1"),
        (lambda: sf.Disk((0, 0, 0), (0, 0, 0), 1), ValueError, "no direction"),
        (lambda: sf.Sun((0, 0, 1)), ValueError, "one of them"),
        (lambda: sf.Sun((0, 0, 1), 0, radiance=(1, 1, 1)), ValueError, "give irradiance"),
        (lambda: sf.Sun((0, 0, 1), 95, (1, 1, 1)), ValueError, r"\[0.01, 89\]"),
        (lambda: sf.Environment(np.zeros((4, 4))), ValueError, r"\(height, width, 3\)"),
        (lambda: sf.Environment(np.full((4, 4, 3), np.nan)), ValueError, "nan"),
        (lambda: sf.Environment(np.zeros((4, 4, 3))), ValueError, "black"),
        (lambda: sf.Scene([FLOOR], SPOT, light_sampling="bsdf"), ValueError, "both, light, surface"),
        (lambda: sf.Scene([FLOOR], SPOT, suns=[1]), TypeError, "sunfleck.Sun"),  # type: ignore[list-item]
        (lambda: sf.Scene([FLOOR], SPOT, solid_angle_ratio=-1), ValueError, "0 or more"),
        (lambda: sf.Scene([FLOOR], SPOT, environment=3), TypeError, "sunfleck.Environment"),  # type: ignore[arg-type]
    ],
)
def test_bad_values_are_refused(make: Callable[[], object], error: type[Exception], part: str) -> None:
    with pytest.raises(error, match=part):
        make()
