# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""The surface-sampled ray: where it has less error a second than light sampling alone.

Every case renders the same picture without the ray and with it, weighted by the power heuristic;
the figure is (MSE x seconds) without, over that with: above 1 the ray earns its cost. MSE against
4,096 samples a pixel; 64 x 64 pixels, 64 samples; the two ways take turns, median and range over
the seeds.

- Under lights that are surfaces, and narrow environments, the plan ends at light sampling. A
  background of 1e-30, which no float of the picture can hold beside the light, makes it trace the
  last surface ray as well.
- Wide environments, rough surfaces and the bounces before the last have the ray anyway: there
  light_sampling "light" is what goes without. Of rough surfaces and before the last bounce this
  saves no ray, only the weighing.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from measure import describe_build, describe_machine

import sunfleck as sf

SIZE, SPP, SEEDS, TRUTH_SPP = 64, 64, 9, 2048
SPECK = (1e-30,) * 3
BLACK, GREY = (0.0, 0.0, 0.0), (0.7, 0.7, 0.7)
QUAD = [[0, 1, 2], [0, 2, 3]]
FLOOR = sf.Mesh([[-5, -5, 0], [5, -5, 0], [5, 5, 0], [-5, 5, 0]], QUAD, GREY)

Pair = tuple[sf.Scene, sf.Scene]  # without the ray, and with it
Make = Callable[[], Pair]


def at_the_last(shapes: Sequence[Any], camera: sf.Camera) -> Pair:
    """Direct light of surfaces."""
    without, ray = (sf.Scene(shapes, camera, background, 1) for background in (BLACK, SPECK))
    assert "last surface" not in without.plan().stages
    assert {"last surface", "weight"} <= set(ray.plan().stages)
    return without, ray


def by_option(scene: sf.Scene, bounces: int) -> Pair:
    """The scene with its light sampled alone, and weighted."""
    without, ray = (
        sf.Scene(
            scene.shapes, scene.camera, background, bounces, environment=scene.environment, light_sampling=sampling
        )
        for sampling, background in (("light", BLACK), ("both", SPECK if scene.environment else BLACK))
    )
    return without, ray


def panel(height: float, triangles: int = 2) -> Make:
    """A floor seen from above its edge, under a square of side 2 or half of it."""

    def make() -> Pair:
        corners = [[-1, -1, height], [-1, 1, height], [1, 1, height], [1, -1, height]]
        light = sf.Mesh(corners, QUAD[:triangles], BLACK, (10, 10, 10))
        camera = sf.Camera((0, -4, 0.02 + 0.5 * min(height, 1)), (0, 0, 0), up=(0, 0, 1), vertical_fov=50)
        return at_the_last([FLOOR, light], camera)

    return make


def ceiling() -> Pair:
    """The Cornell box under a light of 97 % of its ceiling's width, direct light."""
    box = sf.scenes.cornell()
    corners = [[-0.97, 0.99, -0.97], [0.97, 0.99, -0.97], [0.97, 0.99, 0.97], [-0.97, 0.99, 0.97]]
    light = sf.Mesh(corners, QUAD, BLACK, (1, 0.8, 0.5))
    return at_the_last([*box.meshes[:7], light], box.camera)


def under(height: float) -> Make:
    """What lies right under the square alone: it fills nearly all of the sky at 0.01."""

    def make() -> Pair:
        corners = [[-1, -1, height], [-1, 1, height], [1, 1, height], [1, -1, height]]
        light = sf.Mesh(corners, QUAD, BLACK, (10, 10, 10))
        camera = sf.Camera((0, 0, 0.9 * height), (0, 0, 0), up=(0, 1, 0), vertical_fov=90)
        return at_the_last([FLOOR, light], camera)

    return make


def ball(height: float) -> Make:
    """A sphere of radius 1 whose lowest point is that high."""

    def make() -> Pair:
        light = sf.Sphere((0, 0, 1 + height), 1, BLACK, (10, 10, 10))
        return at_the_last([FLOOR, light], sf.Camera((0, -3, 2), (0, -1, 0), up=(0, 0, 1), vertical_fov=40))

    return make


def many() -> Pair:
    """1,024 small squares, a tenth of the ceiling."""
    n, half = 32, 0.158 / 2
    x, y = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(n)))
    middle = np.stack([x / n * 8 - 4, y / n * 8 - 4, np.full(n * n, 1.0)], axis=1)
    steps = np.array([(-1, -1, 0), (-1, 1, 0), (1, 1, 0), (1, -1, 0)]) * half / 2
    triangles = (4 * np.arange(n * n)[:, None, None] + np.array(QUAD)).reshape(-1, 3)
    lights = sf.Mesh((middle[:, None] + steps).reshape(-1, 3), triangles, BLACK, (10, 10, 10))
    return at_the_last([FLOOR, lights], sf.Camera((0, -4, 0.9), (0, 0, 0), up=(0, 0, 1), vertical_fov=50))


def metal(roughness: float, half: float) -> Make:
    """A conductor as the floor, beside a standing square light."""

    def make() -> Pair:
        corners = FLOOR.vertices
        floor = sf.Mesh(corners, QUAD, (0.9, 0.9, 0.9), material=sf.Conductor(roughness))
        upright = [[-half, 2, 0.1], [half, 2, 0.1], [half, 2, 0.1 + 2 * half], [-half, 2, 0.1 + 2 * half]]
        light = sf.Mesh(upright, QUAD, BLACK, (10, 10, 10))
        camera = sf.Camera((0, -3, 1.5), (0, 0.3, 0), up=(0, 0, 1), vertical_fov=30)
        return by_option(sf.Scene([floor, light], camera), 1)

    return make


def sky(sun: float, where: str = "objects") -> Make:
    """A sky that brightens towards the top, grey below, with one pixel that is `sun` brighter.

    Above a sphere and a box, above their floor alone, or before the open side of the Cornell box.
    """

    def make() -> Pair:
        rows = np.cos((np.arange(32) + 0.5) / 32 * np.pi)
        image = np.repeat(np.clip(rows, 0, None)[:, None, None] + 0.2, 64, axis=1).repeat(3, axis=2)
        image[6, 20] += sun
        box, open_air = sf.scenes.cornell(), sf.scenes.penumbra()
        meshes = {"objects": open_air.meshes[:3], "floor": open_air.meshes[:1], "room": box.meshes[:7]}[where]
        camera, up = (box.camera, (0, 1, 0)) if where == "room" else (open_air.camera, (0, 0, 1))
        environment = sf.Environment(image.astype(np.float32), up=up)
        return by_option(sf.Scene(meshes, camera, environment=environment), 1)

    return make


def inside(bounces: int, large: bool = False) -> Make:
    """The Cornell box with that many bounces: the surface rays before the last are traced anyway."""

    def make() -> Pair:
        box = sf.scenes.cornell()
        meshes = ceiling()[0].meshes if large else box.meshes
        return by_option(sf.Scene(meshes, box.camera), bounces)

    return make


def measure(make: Make, pattern: str) -> list[tuple[float, float, float]]:
    """By seed: error and seconds without the ray over those with it, and the product."""
    pair = make()
    truth = np.mean(
        [sf.render(s, SIZE, SIZE, spp=TRUTH_SPP, seed=1001 + k).color for k, s in enumerate(pair)],
        axis=0,
        dtype=np.float64,
    )
    ratios = []
    for seed in range(SEEDS):
        errors, seconds = [], []
        for scene in pair:
            start = time.perf_counter()
            image = sf.render(scene, SIZE, SIZE, spp=SPP, seed=seed, pattern=pattern)
            seconds.append(time.perf_counter() - start)
            errors.append(float(((image.color - truth) ** 2).mean()))
        error, cost = errors[0] / errors[1], seconds[0] / seconds[1]
        ratios.append((error, cost, error * cost))
    return ratios


CASES: dict[str, Make] = {
    "penumbra": lambda: at_the_last(sf.scenes.penumbra().meshes, sf.scenes.penumbra().camera),
    "cornell, direct": lambda: at_the_last(sf.scenes.cornell().meshes, sf.scenes.cornell().camera),
    "ceiling, direct": ceiling,
    **{f"square at {h:g}": panel(h) for h in (0.03, 0.1, 0.3, 1.0, 4.0)},
    **{f"triangle at {h:g}": panel(h, 1) for h in (0.03, 0.3, 1.0)},
    **{f"right under, {h:g}": under(h) for h in (0.01, 0.1, 0.5)},
    **{f"sphere at {h:g}": ball(h) for h in (0.02, 0.5, 3.0)},
    "1,024 squares": many,
    **{f"metal {r:g}, square {2 * h:g}": metal(r, h) for r in (0.05, 0.2, 0.5, 1.0) for h in (0.1, 1.0)},
    **{f"sky over {w}, sun {v:g}": sky(v, w) for w in ("floor", "objects", "room") for v in (0, 10, 30, 300, 3000)},
    **{f"cornell, {b} bounces": inside(b) for b in (2, 5)},
    **{f"ceiling, {b} bounces": inside(b, large=True) for b in (2, 5)},
}


def main() -> None:
    """Arguments: the pattern (sobol if none), then parts of the names of the cases; none: all."""
    pattern, wanted = (sys.argv[1:2] or ["sobol"])[0], sys.argv[2:]
    print(describe_machine())
    print(describe_build())
    print(f"{pattern:24}{'MSE x':>24}{'seconds x':>24}{'both':>24}")
    for name, make in CASES.items():
        if wanted and not any(part in name for part in wanted):
            continue
        columns = np.array(measure(make, pattern)).T
        text = (f"{np.median(c):.3g} ({c.min():.3g} … {c.max():.3g})" for c in columns)
        print(f"{name:24}" + "".join(f"{t:>24}" for t in text), flush=True)


if __name__ == "__main__":
    main()
