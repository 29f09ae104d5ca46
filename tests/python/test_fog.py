# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""fog: Beer and Lambert's law, single scattering by quadrature, and that all ways to find light agree."""

from __future__ import annotations

import math
import subprocess
import sys
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import quad

import sunfleck as sf

BLACK = (0.0, 0.0, 0.0)
WHITE = (1.0, 1.0, 1.0)


def wall(distance: float, half: float = 50.0, **options: object) -> sf.Mesh:
    """At y = distance, facing the camera at the origin, which looks along +y."""
    square = [[-half, -half], [half, -half], [half, half], [-half, half]]
    corners = np.array([(x, distance, z) for x, z in square], dtype=np.float32)
    return sf.Mesh(corners, [[0, 1, 2], [0, 2, 3]], **options)  # type: ignore[arg-type]


# All of its rays are along +y.
AHEAD = sf.Camera((0, 0, 0), (0, 1, 0), up=(0, 0, 1), vertical_fov=1e-5)


def measure(scene: sf.Scene, spp: int = 256, seed: int = 0) -> tuple[float, float]:
    """The mean over 32 x 32 independent pixels, and its standard error."""
    color = sf.render(scene, 32, 32, spp=spp, pattern="random", seed=seed).color[..., 0].astype(float)
    return float(color.mean()), float(color.std() / 32)


@pytest.mark.parametrize(("scattering", "absorption"), [(0.0, 0.3), (0.3, 0.0), (0.1, 0.2)])
@pytest.mark.parametrize("distance", [1.0, 7.0])
def test_what_is_seen_through_fog_is_beer_and_lambert_s(scattering: float, absorption: float, distance: float) -> None:
    lamp = wall(distance, emission=WHITE, albedo=BLACK)
    fog = sf.Fog(scattering, absorption)
    got, error = measure(sf.Scene([lamp], AHEAD, max_bounces=0, fog=fog))
    assert abs(got - math.exp(-0.3 * distance)) < 5 * error
    assert error < 0.02 * got


def test_light_that_is_sampled_is_dimmed_too() -> None:
    """From a floor in fog that only absorbs, lit by a speck right above: both ways are dimmed."""
    floor = wall(2, albedo=WHITE)
    speck = sf.Sphere((0.5, 0, 0), 0.01, BLACK, WHITE)
    clear, _ = measure(sf.Scene([floor, speck], AHEAD, max_bounces=1), 16)
    foggy, error = measure(sf.Scene([floor, speck], AHEAD, max_bounces=1, fog=sf.Fog(0, 0.25)))
    assert abs(foggy - clear * math.exp(-0.25 * (2 + math.hypot(2, 0.5)))) < 5 * error + 1e-2 * foggy  # its width


def phase(cosine: float, g: float) -> float:
    """Henyey & Greenstein 1941."""
    return float((1 - g * g) / (4 * math.pi * (1 + g * g - 2 * g * cosine) ** 1.5))


def single_scattering(fog: sf.Fog, distance: float, side: float, ahead: float, radius: float) -> float:
    """Towards the camera, of a small sphere of radiance 1 at (side, ahead): the integral along the ray."""
    extinction = fog.scattering + fog.absorption

    def at(y: float) -> float:
        far = math.hypot(side, ahead - y)
        cosine = (ahead - y) / far
        angle = 2 * math.pi * (1 - math.sqrt(1 - (radius / far) ** 2))
        near = far - 2 / 3 * radius  # to its surface, the mean over the cone that it fills
        return fog.scattering * math.exp(-extinction * (y + near)) * phase(cosine, fog.g) * angle

    return float(quad(at, 0, distance, points=[ahead], epsabs=1e-14)[0])


@pytest.mark.parametrize("g", [0.0, 0.7, -0.5])
@pytest.mark.parametrize("sampling", ["both", "light"])
def test_single_scattering_is_the_integral_along_the_ray(g: float, sampling: str) -> None:
    fog = sf.Fog(0.2, 0.1, g)
    radius = 0.05  # so small that over it phase and distance vary by 1e-3 of themselves, whose odd part cancels
    scene = sf.Scene(
        [wall(6, albedo=BLACK), sf.Sphere((1, 2, 0), radius, BLACK, (100, 100, 100))],
        AHEAD,
        max_bounces=1,
        fog=fog,
        light_sampling=sampling,
    )
    got, error = measure(scene)
    expected = 100 * single_scattering(fog, 6, 1, 2, radius)
    assert abs(got - expected) < 5 * error + 2e-3 * expected
    assert error < 0.02 * expected


@pytest.mark.parametrize("bounces", [1, 4])
@pytest.mark.parametrize("g", [0.0, 0.6])
def test_light_and_surface_sampling_and_both_agree(g: float, bounces: int) -> None:
    shapes: list[sf.Mesh | sf.Sphere | sf.Disk] = [
        wall(4, albedo=(0.7, 0.7, 0.7)),
        sf.Disk((0, 1, 2), (0, 0, -1), 1.5, (0.5, 0.5, 0.5), (5, 5, 5)),
        sf.Sphere((1, 3, 0), 0.5, WHITE, material=sf.Conductor(0.5)),
    ]
    found = [
        measure(sf.Scene(shapes, AHEAD, max_bounces=bounces, fog=sf.Fog(0.2, 0.05, g), light_sampling=way), 512)
        for way in ("both", "light", "surface")
    ]
    for got, error in found[1:]:
        assert abs(got - found[0][0]) < 5 * math.hypot(error, found[0][1])
    assert found[0][1] < 0.01 * found[0][0]


def test_light_in_a_closed_room_of_scattering_fog_is_not_lost() -> None:
    """A furnace: within walls that send out as much as they take, radiance is 1 everywhere, fog or not."""
    walls = sf.Sphere((0, 0, 0), 3, BLACK)
    inner = [  # a sphere emits outwards: six quads that face the inside do it here
        np.float32(np.roll([[end, a, b] for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))], axis, axis=1))
        for axis in range(3)
        for end in (-1, 1)
    ]
    shapes: list[sf.Mesh | sf.Sphere | sf.Disk] = [walls]
    for k, corners in enumerate(inner):
        order = [[0, 2, 1], [0, 3, 2]] if k % 2 else [[0, 1, 2], [0, 2, 3]]
        shapes.append(sf.Mesh(corners, order, albedo=(0.5, 0.5, 0.5), emission=(0.5, 0.5, 0.5)))
    got, error = measure(sf.Scene(shapes, AHEAD, max_bounces=24, fog=sf.Fog(1, 0, 0.5)), 64)
    assert abs(got - 1) < 5 * error + 2e-4  # 0.5^24, and what 24 scatterings leave out
    assert error < 0.01


def test_threads_change_no_bit_and_roulette_no_mean() -> None:
    lamp = sf.Sphere((1, 2, 0), 0.3, BLACK, (9, 9, 9))
    scene = sf.Scene([wall(6), lamp], AHEAD, max_bounces=4, fog=sf.Fog(0.3))
    films = [sf.render(scene, 24, 24, spp=32, threads=threads).color for threads in (1, 3)]
    assert (films[0] == films[1]).all()
    plain, error = measure(scene)
    other = sf.render(scene, 32, 32, spp=256, pattern="random", roulette=2).color[..., 0]
    assert abs(plain - other.mean()) < 5 * math.hypot(error, other.std() / 32)


def test_plans_show_fog_where_there_is_some() -> None:
    lamp = wall(6, emission=WHITE)
    assert "fog" not in sf.Scene([lamp], AHEAD, fog=sf.Fog()).plan().stages
    plan = sf.Scene([lamp], AHEAD, max_bounces=1, fog=sf.Fog(0.1)).plan()
    assert "fog" in plan.stages
    assert [d.name for d in plan.dimensions if d.use == "fog"] == ["fog", "fog 1"]
    none, some = (sf.Scene([lamp], AHEAD, fog=fog) for fog in (None, sf.Fog()))
    assert none.info.hash == some.info.hash
    assert none.info.hash != sf.Scene([lamp], AHEAD, fog=sf.Fog(0.1)).info.hash


@pytest.mark.parametrize(
    ("make", "error", "part"),
    [
        (lambda: sf.Fog("a"), TypeError, "scattering"),  # type: ignore[arg-type]
        (lambda: sf.Scene([wall(1)], AHEAD, fog=0.1), TypeError, "sunfleck.Fog"),  # type: ignore[arg-type]
        (lambda: sf.Scene([wall(1)], AHEAD, fog=sf.Fog(-1)), ValueError, "scattering is -1"),
        (lambda: sf.Scene([wall(1)], AHEAD, fog=sf.Fog(0, math.nan)), ValueError, "absorption is nan"),
        (lambda: sf.Scene([wall(1)], AHEAD, fog=sf.Fog(1, 0, 1)), ValueError, "g is 1"),
        (lambda: sf.Scene([wall(1)], AHEAD, WHITE, fog=sf.Fog(1)), ValueError, "a background"),
        (
            lambda: sf.Scene([wall(1)], AHEAD, suns=[sf.Sun((0, 0, 1), irradiance=WHITE)], fog=sf.Fog(1)),
            ValueError,
            "a sun",
        ),
    ],
)
def test_bad_values_are_refused(make: Callable[[], object], error: type[Exception], part: str) -> None:
    with pytest.raises(error, match=part):
        make()


def test_diffuse_walls_under_a_square_light_agree_in_fog() -> None:
    """Nothing here but the fog needs the lights' densities by solid angle."""
    quad = [[0, 1, 2], [0, 2, 3]]
    floor = sf.Mesh([[-4, -4, -3], [4, -4, -3], [4, 4, -3], [-4, 4, -3]], quad, (0.5, 0.5, 0.5))
    light = sf.Mesh([[-1, -1, 3], [-1, 1, 3], [1, 1, 3], [1, -1, 3]], quad, (0, 0, 0), (10, 10, 10))
    camera = sf.Camera((0, -5, 2.6), (0, 0, 2.6), up=(0, 0, 1), vertical_fov=40)
    means = {}
    for way in ("both", "light", "surface"):
        scene = sf.Scene([floor, light], camera, max_bounces=2, fog=sf.Fog(0.3, 0.05, 0.2), light_sampling=way)
        image = sf.render(scene, 24, 24, spp=1024, pattern="random", seed=4)
        error = float(np.sqrt(np.mean(image.half_width.astype(float) ** 2) / 24**2) / 1.96)
        means[way] = (float(image.color.mean(dtype=float)), error)
    for way in ("light", "surface"):
        (a, e), (b, f) = means["both"], means[way]
        assert abs(a - b) < 5 * np.hypot(e, f), means


# Below 16 samples a batch has lanes behind its last block, whose coordinates are what an earlier pixel filter left.
# Embree is the witness: builds with assertions, such as Debian's, abort where a ray is no number.
UNTRACED = """
import sunfleck as sf
floor = sf.Mesh([[-3, -3, 0], [3, -3, 0], [3, 3, 0], [-3, 3, 0]], [[0, 1, 2], [0, 2, 3]])
lamp = sf.Sphere((0, 0, 2), 0.3, emission=(5, 5, 5))
camera = sf.Camera((0, -4, 2), (0, 0, 0.5), up=(0, 0, 1))
scene = sf.Scene([floor, lamp], camera, max_bounces=3, fog=sf.Fog(0.01, 0.0, 0.5))
for seed in range(20):
    for name in "gaussian", "lanczos":
        options = {"pixel_filter": name, "seed": seed, "threads": 1, "pattern": "random"}
        sf.render(scene, 16, 16, spp=20, **options)
        assert sf.render(scene, 11, 7, spp=1, **options).summary().nonfinite_samples == 0
"""


def test_fog_scatters_no_ray_that_was_not_traced() -> None:
    done = subprocess.run([sys.executable, "-c", UNTRACED], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
