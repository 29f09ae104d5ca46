# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""What the renderer's choice of mapping saves: the lens's disk, and a spherical light by its cone.

Prints the root of the mean squared error, over 256 seeds, of two integrals whose values are known:

lens   the share of the lens that an edge leaves open, over 256 edges at random; the concentric
       against the polar disk
cone   the irradiance from a sphere of radiance 1 that stands whole over the horizon, pi (r / d)^2 cos
       (a view factor, exact); directions of its cone against points of its whole surface, of
       which those that face away count 0
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import sunfleck as sf

SEEDS = 256
TILT = 0.6  # of the sphere's direction from the normal, radians


def rms(estimate: Callable[[np.ndarray], np.ndarray], exact: np.ndarray | float, pattern: str, n: int) -> float:
    """The error of an estimate over `exact`, root of the mean square."""
    errors = [estimate(sf.points(pattern, n, seed=s, dtype="float64")) / exact - 1 for s in range(SEEDS)]
    return float(np.sqrt(np.mean(np.square(errors))))


def lens(mapping: sf.mapping.Mapping, pattern: str, n: int) -> float:
    rng = np.random.default_rng(0)
    turn, d = 2 * np.pi * rng.random(256), 1.6 * rng.random(256) - 0.8
    normals = np.stack([np.cos(turn), np.sin(turn)])
    share = (np.arccos(d) - d * np.sqrt(1 - d * d)) / np.pi
    return rms(lambda u: (mapping.sample(u) @ normals > d).mean(axis=0), share, pattern, n)


def by_cone(distance: float) -> Callable[[np.ndarray], np.ndarray]:
    angle = np.arcsin(1 / distance)

    def estimate(u: np.ndarray) -> np.ndarray:
        w = sf.mapping.cone.sample(u, angle)
        cosine = w[:, 2] * np.cos(TILT) + w[:, 0] * np.sin(TILT)
        return np.asarray((cosine / sf.mapping.cone.pdf(w, angle)).mean())

    return estimate


def by_area(distance: float) -> Callable[[np.ndarray], np.ndarray]:
    def estimate(u: np.ndarray) -> np.ndarray:
        normal = sf.mapping.sphere.sample(u)
        to = normal + np.array([0, 0, distance])
        square = (to**2).sum(axis=1)
        facing = np.maximum(-(to * normal).sum(axis=1), 0)
        cosine = to[:, 2] * np.cos(TILT) + to[:, 0] * np.sin(TILT)
        return np.asarray((4 * np.pi * facing * cosine / square**2).mean())

    return estimate


def main() -> None:
    print("| lens | points | polar | concentric | polar / concentric |\n|---|---|---|---|---|")
    for pattern in ("sobol", "jittered", "random"):
        for n in (16, 64, 256):
            polar, concentric = (lens(m, pattern, n) for m in (sf.mapping.disk_polar, sf.mapping.disk_concentric))
            print(f"| {pattern} | {n} | {polar:.4f} | {concentric:.4f} | {polar / concentric:.2f} |")
    print("\n| sphere | distance over radius | by area | by its cone | area / cone |\n|---|---|---|---|---|")
    for pattern in ("sobol", "random"):
        for distance in (1.3, 2.0, 5.0, 20.0):
            exact = np.pi / distance**2 * np.cos(TILT)
            area, cone = (rms(by(distance), exact, pattern, 64) for by in (by_area, by_cone))
            print(f"| {pattern} | {distance:g} | {area:.2e} | {cone:.2e} | {area / cone:.0f} |")


if __name__ == "__main__":
    main()
