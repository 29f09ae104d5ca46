# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""mappings: from the unit square to somewhere else, badly."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import sunfleck as sf
from sunfleck.lab.experiment import Array, Experiment, Measured, scatter
from sunfleck.plot.figure import Panel

__all__ = ["EXPERIMENTS"]

CORNERS = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))


def _square(seed: int, n: int = 4096) -> Array:
    return np.asarray(sf.points("sobol", n, seed=seed, dtype="float64", threads=1))


def _log_zero(seed: int) -> Measured:
    u = np.asarray(sf.points("sobol", 1024, scramble=None, dtype="float64"))
    with np.errstate(divide="ignore", invalid="ignore"):
        radius = 0.4 * np.sqrt(-2 * np.log(u[:, 0]))
        failing = 0.5 + radius[:, None] * np.stack([np.cos(2 * np.pi * u[:, 1]), np.sin(2 * np.pi * u[:, 1])], 1)
    right = np.asarray(sf.mapping.pixel_gaussian.sample(u, mu=0.4))
    right = np.concatenate([right, np.asarray(sf.mapping.pixel_gaussian.sample(_square(seed), mu=0.4))])

    def infinite(p: Array) -> float:
        return float(np.sum(~np.isfinite(p).all(axis=1)))

    show = [scatter(p[np.isfinite(p).all(axis=1)][:2000], "x", "y") for p in (failing, right)]
    return Measured(infinite(failing), infinite(right), show[0], show[1])


def _leaves(failing: str, remedied: str, **options: float) -> Callable[[int], Measured]:
    def outside(name: str, seed: int, **options: float) -> tuple[float, Panel]:
        p = np.asarray(getattr(sf.mapping, name).sample(_square(seed), **options))
        return float(np.mean(((p < 0) | (p > 1)).any(axis=1))), scatter(p[:2000], "x", "y")

    def measure(seed: int) -> Measured:
        before, left = outside(failing, seed)
        after, right = outside(remedied, seed, **options)
        return Measured(before, after, left, right)

    return measure


def _disk(seed: int) -> Measured:
    def inner(name: str) -> tuple[float, Panel]:
        p = np.asarray(getattr(sf.mapping, name).sample(_square(seed)))
        return float(np.mean((p**2).sum(axis=1) < 0.25)), scatter(p[:1024], "x", "y")

    before, failing = inner("disk_naive")
    after, remedied = inner("disk_concentric")
    return Measured(before, after, failing, remedied)


def _strata(name: str, cells: int = 16) -> tuple[float, Panel]:
    """The longest diagonal of a mapped cell, in diagonals of the square's cells."""
    step = np.arange(cells + 1) / cells * (1 - 2.0**-20)
    grid = np.stack(np.meshgrid(step, step, indexing="ij"), axis=2).reshape(-1, 2)
    p = np.asarray(getattr(sf.mapping, name).sample(grid, *CORNERS))[:, :2].reshape(cells + 1, cells + 1, 2)
    one = np.linalg.norm(p[1:, 1:] - p[:-1, :-1], axis=2)
    other = np.linalg.norm(p[1:, :-1] - p[:-1, 1:], axis=2)
    return float(max(one.max(), other.max()) * cells / 2**0.5), scatter(p.reshape(-1, 2), "x", "y")


def _stretch(_seed: int) -> Measured:
    before, failing = _strata("triangle")
    after, remedied = _strata("triangle_low_distortion")
    return Measured(before, after, failing, remedied)


def _cosine(seed: int) -> Measured:
    def spread(name: str) -> tuple[float, Panel]:
        w = np.asarray(getattr(sf.mapping, name).sample(_square(seed, 1 << 14)))
        estimate = w[:, 2] / np.asarray(getattr(sf.mapping, name).pdf(w))
        return float(np.var(estimate) / np.mean(estimate) ** 2), scatter(w[:1024, :2], "x", "y")

    before, failing = spread("hemisphere")
    after, remedied = spread("cosine_hemisphere")
    return Measured(before, after, failing, remedied)


def _poles(seed: int) -> Measured:
    u = _square(seed)
    polar = np.pi * u[:, 0]
    azimuth = 2 * np.pi * u[:, 1]
    naive = np.stack([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], 1)
    right = np.asarray(sf.mapping.sphere.sample(u))

    def caps(w: Array) -> tuple[float, Panel]:
        return float(np.mean(np.abs(w[:, 2]) > 0.9)), scatter(w[:2000, [0, 2]], "x", "z")

    before, failing = caps(naive)
    after, remedied = caps(right)
    return Measured(before, after, failing, remedied)


EXPERIMENTS = (
    Experiment(
        "gaussian-log-zero",
        "the Gaussian pixel map takes the logarithm of zero",
        "sqrt(-2 log s) is a normal radius.",
        "s = 0 is a number of [0,1), and the first point of a plain sequence.",
        "infinite positions among 1024 Sobol points",
        "log(1 - s).",
        (1, 1),
        (0, 0),
        _log_zero,
    ),
    Experiment(
        "gaussian-leaves",
        "the Gaussian pixel map leaves the pixel",
        "Samples stay in their pixel.",
        "A normal position is unbounded.",
        "share of positions outside the pixel, mu 0.4",
        "Truncate and renormalize: pixel_gaussian_truncated within half a pixel.",
        (0.3, 0.5),
        (0, 0),
        _leaves("pixel_gaussian", "pixel_gaussian_truncated", radius=0.5),
    ),
    Experiment(
        "tent-leaves",
        "the tent pixel map reaches half a pixel beyond",
        "Shirley's map stays in the pixel.",
        "Its range is [-1/2, 3/2): a filter two pixels wide is what it is.",
        "share of positions outside the pixel, 1 - (3/4)^2",
        "Where samples must stay in: the box.",
        (0.42, 0.455),  # 7/16
        (0, 0),
        _leaves("pixel_tent", "pixel_box"),
    ),
    Experiment(
        "disk-radius",
        "radius = t piles samples up at a disk's centre",
        "A uniform radius and a uniform angle fill a disk evenly.",
        "Their density is proportional to 1/r.",
        "share of samples within half the radius",
        "The square root, or the concentric map.",
        (0.48, 0.52),  # 1/2; random points would have sigma 0.008, these less
        (0.23, 0.27),  # 1/4
        _disk,
    ),
    Experiment(
        "triangle-stretch",
        "the square-root map stretches strata at a vertex",
        "A map that keeps areas keeps a pattern's quality.",
        "Cells at one vertex become slivers.",
        "longest diagonal of 16 x 16 mapped cells, over that of the cells",
        "The low-distortion map (Heitz 2019).",
        (3.5, 1000),
        (1, 3.2),
        _stretch,
    ),
    Experiment(
        "sphere-poles",
        "uniform angles crowd a sphere's poles",
        "Uniform polar and azimuth angles are uniform directions.",
        "Circles near a pole are short.",
        "share of directions with |z| > 0.9",
        "Uniform z: the library's sphere.",
        (0.27, 0.31),  # 2 acos(0.9) / pi = 0.287
        (0.08, 0.12),  # 1/10
        _poles,
    ),
    Experiment(
        "uniform-hemisphere",
        "uniform directions on a diffuse surface have variance where there need be none",
        "Every direction of the hemisphere is as good.",
        "The cosine is left in the estimate.",
        "variance over squared mean, of the integral of the cosine",
        "Cosine weighting.",
        (0.32, 0.345),  # 1/3
        (0, 1e-9),  # cos / pdf is pi up to float rounding of the pdf: 2^-23 squared
        _cosine,
    ),
)
