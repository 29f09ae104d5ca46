# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""render: Russian roulette leaves the mean as it is, and where it is off nothing changes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sunfleck as sf


def mean(scene: sf.Scene, roulette: int, pattern: str) -> tuple[float, float]:
    """Of independent pictures, and its standard error."""
    runs = [
        sf.render(scene, 16, 16, spp=32, seed=seed, roulette=roulette, pattern=pattern).color.mean()
        for seed in range(16)
    ]
    return float(np.mean(runs)), float(np.std(runs, ddof=1) / 4)


@pytest.mark.parametrize("pattern", ["sobol", "halton"])
def test_the_mean_is_the_same(cornell: sf.Scene, pattern: str) -> None:
    all_paths, error = mean(cornell, 0, pattern)
    for first in (2, 4):
        some, other = mean(cornell, first, pattern)
        assert abs(some - all_paths) < 4.5 * np.hypot(error, other)  # t of 30 degrees: 1 in 10^4
        assert error < 0.02 * all_paths  # a bounce left out, or not divided by 0.5, would show


def test_glass_and_metal_too() -> None:
    floor = sf.Mesh([[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]], [[0, 1, 2], [0, 2, 3]])
    balls = [
        sf.Sphere((-0.6, 0, 0.5), 0.5, (0.9, 0.9, 0.9), material=sf.Dielectric(1.5, 0.2)),
        sf.Sphere((0.6, 0, 0.5), 0.5, (0.9, 0.6, 0.3), material=sf.Conductor(0.3)),
    ]
    camera = sf.Camera((0, -4, 2), (0, 0, 0.4), up=(0, 0, 1), vertical_fov=25)
    scene = sf.Scene([floor, *balls], camera, (1, 1, 1), max_bounces=8)
    all_paths, error = mean(scene, 0, "random")
    some, other = mean(scene, 2, "random")
    assert abs(some - all_paths) < 4.5 * np.hypot(error, other)
    assert other > error  # it did end paths


def test_bounces_that_a_scene_does_not_have_change_nothing(cornell: sf.Scene) -> None:
    plain = sf.render(cornell, 16, 16, spp=16)
    assert (sf.render(cornell, 16, 16, spp=16, roulette=6).color == plain.color).all()
    assert (sf.render(cornell, 16, 16, spp=16, roulette=5).color != plain.color).any()


def test_threads_change_no_bit(cornell: sf.Scene) -> None:
    films = [sf.render(cornell, 24, 24, spp=16, roulette=2, threads=threads).color for threads in (1, 3)]
    assert (films[0] == films[1]).all()


def test_the_film_says_so_and_checkpoints_keep_to_it(cornell: sf.Scene, tmp_path: Path) -> None:
    path = tmp_path / "a"
    image = sf.render(cornell, 16, 16, spp=16, roulette=3, checkpoint=path)
    assert image.metadata["roulette"] == "3"
    with pytest.raises(ValueError, match="roulette"):
        sf.render(cornell, 16, 16, spp=32, roulette=0, checkpoint=path)
    more = sf.render(cornell, 16, 16, spp=32, roulette=3, checkpoint=path)
    assert (more.color == sf.render(cornell, 16, 16, spp=32, roulette=3).color).all()


@pytest.mark.parametrize("value", [1, 65])
def test_bounces_beyond_what_is_allowed_are_refused(cornell: sf.Scene, value: int) -> None:
    with pytest.raises(ValueError, match=f"roulette is {value}; it must be 2 to 64, or 0 for none"):
        sf.render(cornell, 8, 8, spp=1, roulette=value)
