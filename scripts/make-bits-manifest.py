#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Prints a hash for each kind of number that the installed package makes, a line each.

Two runs that print the same lines drew the same bits: run it before and after a change that must
leave samples and films alone, and compare. Takes some twenty seconds.

    .venv/bin/python scripts/make-bits-manifest.py > before.txt
"""

import hashlib
import itertools
from collections.abc import Callable, Iterator

import numpy as np

import sunfleck as sf

STOPS = ("standard_error", "replicates", "dyadic")
SCRAMBLES = ("default", None, "permuted", "shift", "lms", "owen", "nested")
CORNERS = ((0.0, 0.0, 1.0), (1.0, 0.0, 1.0), (0.0, 1.0, 1.5))
PARAMETERS: dict[str, tuple[object, ...]] = {  # of the mappings that take some
    "triangle": CORNERS,
    "triangle_low_distortion": CORNERS,
    "parallelogram": CORNERS,
    "spherical_triangle": CORNERS,
    "spherical_rectangle": CORNERS,
    "annulus": (0.5,),
    "cone": (0.9,),
    "power_cosine": (5.0,),
    "regular_polygon": (5,),
    "henyey_greenstein": (0.5,),
    "ggx_visible_normals": ((0.6, 0.0, 0.8), 0.3, 0.4),
}


def digest(*arrays: object) -> str:
    """The first 16 digits of a SHA-256 over shapes, types and bytes."""
    h = hashlib.sha256()
    for array in map(np.ascontiguousarray, arrays):
        h.update(f"{array.shape}{array.dtype}".encode())
        h.update(array.tobytes())
    return h.hexdigest()[:16]


def generators() -> Iterator[tuple[str, Callable[[], str]]]:
    for name, stream in itertools.product(sf.RNGS, (0, 3)):
        rng = sf.Rng(name, seed=12345, stream=stream)
        yield (
            f"rng {name} {stream}",
            lambda rng=rng: digest(
                rng.bits(999), rng.bits(99, dtype="uint64"), rng.random(999), rng.random(99, dtype="float32")
            ),
        )


def patterns() -> Iterator[tuple[str, Callable[[], str]]]:
    for name, d, dtype in itertools.product(sf.PATTERNS, (1, 2, 7), ("float32", "float64", "uint32")):
        for scramble in SCRAMBLES:
            more = {} if scramble == "default" else {"scramble": scramble}
            yield (
                f"points {name} {d} {dtype} {scramble}",
                lambda a=name, k=dict(d=d, seed=5, dtype=dtype, **more): digest(
                    sf.points(a, sf.valid_counts(a, 256, k["d"])[1], **k)
                ),
            )


def mappings() -> Iterator[tuple[str, Callable[[], str]]]:
    for dtype in ("float32", "float64"):
        u = sf.points("sobol", 1024, d=2, seed=3, dtype=dtype)
        for name in sf.MAPPINGS:
            given = PARAMETERS.get(name, ())
            yield f"mapping {name} {dtype}", lambda n=name, u=u, p=given: digest(getattr(sf.mapping, n).sample(u, *p))


def mixture(**sky_or_fog: object) -> sf.Scene:
    """Materials, shapes, instances, a lens and many lights in one scene, with a sky or in fog."""
    rng = np.random.default_rng(1)
    floor = sf.Mesh([[-5, -5, 0], [5, -5, 0], [5, 5, 0], [-5, 5, 0]], [[0, 1, 2], [0, 2, 3]], albedo=(0.6, 0.5, 0.4))
    lamps = (rng.uniform(-2, 2, (12, 1, 3)) + rng.uniform(-0.2, 0.2, (12, 3, 3)) + [0, 0, 2.5]).astype(np.float32)
    pebble = sf.Mesh(CORNERS, [[0, 1, 2]], albedo=(0.3, 0.7, 0.3))
    places = np.tile(np.eye(3, 4), (5, 1, 1))
    places[:, :, 3] = rng.uniform(-1, 1, (5, 3))
    return sf.Scene(
        [
            floor,
            sf.Mesh(lamps.reshape(-1, 3), np.arange(36).reshape(-1, 3), (0, 0, 0), (8, 9, 10)),
            sf.Sphere((0, 0, 0.6), 0.5, material=sf.Dielectric(1.5, roughness=0.3)),
            sf.Sphere((1, 0.5, 0.4), 0.4, material=sf.Conductor(roughness=0.2)),
            sf.Disk((-1, 0, 1.5), (0, 0, -1), 0.3, (0, 0, 0), (5, 5, 5)),
            sf.Instances([pebble], places),
        ],
        sf.Camera((0, -4, 2), (0, 0, 0.5), up=(0, 0, 1), aperture_radius=0.02),
        max_bounces=4,
        **sky_or_fog,
    )


def films() -> Iterator[tuple[str, Callable[[], str]]]:
    def film(scene: sf.Scene, **options: object) -> str:
        image = sf.render(scene, 48, 40, seed=7, **options)
        return digest(image.color, image.samples, image.half_width, image.stop_reason)

    scenes = {name: getattr(sf.scenes, name)() for name in ("penumbra", "defocus", "cornell", "keyhole")}
    pixels = np.linspace(0, 1, 96, dtype=np.float32).reshape(4, 8, 3)
    scenes["sky"] = mixture(environment=sf.Environment(pixels), suns=[sf.Sun((1, 1, 1), 5, irradiance=(1, 1, 1))])
    scenes["fog"] = mixture(fog=sf.Fog(0.05, 0.01, 0.3))
    for (name, scene), pattern in itertools.product(scenes.items(), sf.RENDER_PATTERNS):
        for spp in (1, 3, 16, 64):
            yield f"film {name} {pattern} {spp}", lambda s=scene, p=pattern, n=spp: film(s, pattern=p, spp=n)
        for stop in STOPS:
            yield (
                f"film {name} {pattern} {stop}",
                lambda s=scene, p=pattern, r=stop: film(s, pattern=p, stop=r, tolerance=0.05, max_spp=256),
            )
    for name, pixel_filter in itertools.product(scenes, sf.PIXEL_FILTERS):
        yield (
            f"film {name} {pixel_filter}",
            lambda s=scenes[name], f=pixel_filter: film(s, pixel_filter=f, spp=16),
        )


def main() -> None:
    for name, make in itertools.chain(generators(), patterns(), mappings(), films()):
        try:
            print(f"{make()}  {name}", flush=True)
        except (ValueError, TypeError) as refused:  # a combination that is not offered is part of the manifest
            print(f"{type(refused).__name__:16}  {name}", flush=True)


if __name__ == "__main__":
    main()
