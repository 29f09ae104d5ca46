# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""renders: claims about pixels that real renders do not keep."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

import sunfleck as sf
from sunfleck.lab.experiment import Array, Experiment, Measured, bars, image, scatter

__all__ = ["EXPERIMENTS"]

SIZE = 32
ONE_SIGMA = 0.6826894921370859  # erf(2^-1/2)


def _grey(made: sf.Image) -> Array:
    return np.asarray(np.mean(made.color, axis=2, dtype=np.float64))


@functools.cache
def _reference() -> Array:
    """Penumbra's pixels, from 2,048 points of a Sobol sequence."""
    return _grey(sf.render(sf.scenes.penumbra(), SIZE, SIZE, spp=2048, seed=2**40, threads=1))


def _penumbra(seed: int, **options: Any) -> sf.Image:
    return sf.render(sf.scenes.penumbra(), SIZE, SIZE, seed=seed, threads=1, **options)


def _one_sigma(seed: int) -> Measured:
    def within(spp: int) -> tuple[float, Array]:
        made = _penumbra(seed, spp=spp, pattern="random", stop="standard_error", confidence=ONE_SIGMA)
        inside = np.abs(_grey(made) - _reference()) <= made.half_width
        return float(inside.mean()), inside

    before, few = within(2)
    after, many = within(64)
    show = [image(inside, "column", "row (1: truth within one sigma)") for inside in (few, many)]
    return Measured(before, after, show[0], show[1])


def _coverage(seed: int) -> Measured:
    def missed(stop: str, least: int) -> tuple[float, Array]:
        made = _penumbra(seed, tolerance=0.1, pattern="random", stop=stop, min_spp=least, max_spp=1024)
        outside = np.abs(_grey(made) - _reference()) > made.half_width
        return float(outside.mean()), outside

    before, early = missed("standard_error", 4)
    after, late = missed("dyadic", 32)
    show = [image(outside, "column", "row (1: truth outside its interval)") for outside in (early, late)]
    return Measured(before, after, show[0], show[1])


def _black(seed: int) -> Measured:
    def dark(stop: str) -> tuple[float, Array]:
        made = sf.render(
            sf.scenes.keyhole(), SIZE, SIZE, tolerance=0.05, min_spp=16, max_spp=64, stop=stop, seed=seed, threads=1
        )
        met = np.asarray(made.stop_reason) == sf.STOP_REASONS.index("met")
        return float(np.mean(met & (_grey(made) == 0))), np.sqrt(_grey(made))

    before, failing = dark("standard_error")
    after, remedied = dark("dyadic")
    show = [image(np.minimum(shown, 1), "column", "row (square root of radiance)") for shown in (failing, remedied)]
    return Measured(before, after, show[0], show[1])


def _plain() -> sf.Scene:
    """A spot of floor under a wide lamp: every pixel sees the same, and its noise is that of the lamp's sampling."""
    square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=np.float32)
    faces = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.uint32)
    floor = sf.Mesh(square * 4, faces)
    lamp = sf.Mesh(
        square + np.array([0, 0, 1], dtype=np.float32), faces[:, ::-1].copy(), albedo=(0, 0, 0), emission=(1, 1, 1)
    )
    return sf.Scene([floor, lamp], sf.Camera((0, 0, 0.9), (0, 0, 0), up=(0, 1, 0), vertical_fov=2.0), max_bounces=1)


def _shared(seed: int) -> Measured:
    def noise(seeds: str) -> tuple[float, Array]:
        # A tile for each thread: rendered one after the other, so that it is known who draws what.
        tiles = [(0, 0, 16, 16), (16, 0, 32, 16)]
        made = [
            _grey(sf.render(_plain(), 32, 16, spp=2, pattern="random", seeds=seeds, seed=seed, threads=1, crop=tile))
            for tile in tiles
        ]
        pairs = np.stack([(m - m.mean()).ravel() for m in made], axis=1)
        return float(np.corrcoef(pairs.T)[0, 1]), pairs

    before, failing = noise("shared")
    after, remedied = noise("pixel")
    show = [scatter(p, "noise of thread 0's tile", "noise of thread 1's tile") for p in (failing, remedied)]
    return Measured(before, after, show[0], show[1])


def _degenerate(_seed: int) -> Measured:
    good = np.array([[0, 0, 2], [1, 0, 2], [0, 1, 2]], dtype=np.float32)
    bad = {"no area": good * np.array([1, 0, 1], dtype=np.float32), "NaN": good.copy(), "infinite": good.copy()}
    bad["NaN"][1, 1], bad["infinite"][2, 0] = np.nan, np.inf
    naive, ours = {}, {}
    for name, vertices in bad.items():
        with np.errstate(all="ignore"):
            normal = np.cross(vertices[1] - vertices[0], vertices[2] - vertices[0])
            radiance = 1 / np.linalg.norm(normal) * normal  # the normal of a light, or 1 over its area
        naive[name] = float(not np.isfinite(radiance).all())
        try:
            lamp = sf.Mesh(vertices, np.array([[0, 1, 2]], dtype=np.uint32), emission=(1, 1, 1))
            made = sf.render(sf.Scene([lamp], sf.Camera((0, -3, 1), (0, 0, 1), up=(0, 0, 1))), 8, 8, spp=4, threads=1)
            ours[name] = float(not np.isfinite(made.color).all())
        except (ValueError, sf.Error):
            ours[name] = 0.0  # refused
    show = [bars(counts, "pictures that are not finite") for counts in (naive, ours)]
    return Measured(sum(naive.values()), sum(ours.values()), show[0], show[1])


EXPERIMENTS = (
    Experiment(
        "one-sigma",
        "68.2 % within one sigma does not hold for a few samples of a pixel",
        "The truth is within s / sqrt(n) of the mean in 68.2 % of the pixels.",
        "s of two samples is a guess: even of normal samples it holds for half of them.",
        "share of penumbra's pixels within one standard error, 2 samples (after: 64)",
        "More samples before s is believed, or Student's t.",
        (0.38, 0.595),  # at most P(|t| < 1) = 1/2 of one degree of freedom; sigma of 1024 pixels 0.0156, six of them
        (0.595, 0.77),  # 0.683; sigma 0.0145, six of them
        _one_sigma,
    ),
    Experiment(
        "lecture-rule-coverage",
        "the rule of the standard error stops where its interval is too small",
        "A pixel whose 95 % interval is below the tolerance is known to the tolerance.",
        "After 4 samples s is often too small, and those pixels are the ones that stop.",
        "share of penumbra's pixels whose 95 % interval misses the truth",
        "The default rule, dyadic, from 32 samples on.",
        (0.11, 0.3),  # 0.18 measured; sigma of 1024 pixels 0.012, six of them below
        (0, 0.091),  # 0.05; sigma 0.0068, six of them
        _coverage,
    ),
    Experiment(
        "black-pixels",
        "black looks converged",
        "A pixel whose samples agree is done.",
        "Sixteen samples that missed a small gap all say zero, with variance zero.",
        "share of keyhole's pixels that are black and called met; none is black in truth",
        "An interval that stays finite at zero variance: dyadic.",
        (0.2, 0.5),  # 0.34 measured; sigma of 1024 pixels 0.015
        (0, 0),
        _black,
    ),
    Experiment(
        "shared-seed-tiles",
        "threads with one seed put the same noise into their tiles",
        "Each thread starts its own generator, so the noise is its own.",
        'From the same seed: seeds="shared".',
        "correlation of the noise in two threads' tiles, 256 pixels",
        'A stream for each pixel: seeds="pixel", the default.',
        (0.8, 1),
        (-0.38, 0.38),  # sigma 1/16, six of them
        _shared,
    ),
    Experiment(
        "degenerate-lights",
        "a light without area divides by zero",
        "A mesh is what its arrays say.",
        "1 over the area, and the normal, of a triangle without one, or with a vertex that is no number.",
        "of three bad triangles, those whose result is not finite",
        "Refused, or skipped with a count.",
        (3, 3),
        (0, 0),
        _degenerate,
    ),
)
