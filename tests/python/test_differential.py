# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""The renderer against a plain path tracer on random scenes that mix all features; docs/differential.md.

The scenes change with the ISO week. SUNFLECK_DIFFERENTIAL=SEED[:COUNT] gives the first seed, and how many.
"""

from __future__ import annotations

import datetime
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "differential"))

import compare
import reference
import run
import scenes

SCENES = 60
RATE = 1e-3  # of false alarms, over all tests of all scenes


@pytest.fixture(scope="module")
def plain() -> Any:
    return reference.load()


def _seeds() -> range:
    given = os.environ.get("SUNFLECK_DIFFERENTIAL")
    if given:
        start, _, count = given.partition(":")
        return range(int(start), int(start) + int(count or SCENES))
    year, week, _ = datetime.date.today().isocalendar()
    first = (100 * year + week) * 100
    return range(first, first + SCENES)


def test_random_scenes_have_the_means_of_a_plain_path_tracer() -> None:
    seeds = _seeds()
    print(f"SUNFLECK_DIFFERENTIAL={seeds.start}:{len(seeds)}")
    verdicts = list(run.judge_all(seeds, 2))
    faulty = compare.holm(verdicts, RATE) or any(v.broken for v in verdicts)
    assert not faulty, f"SUNFLECK_DIFFERENTIAL={seeds.start}:{len(seeds)}\n{run.report(verdicts, RATE)}"


def test_a_frame_that_is_brighter_by_a_hundredth_is_found() -> None:
    rng = np.random.default_rng(1)
    one = 1 + 0.005 * rng.normal(size=(64, len(compare.TESTS)))
    other = 1 + 0.005 * rng.normal(size=(64, len(compare.TESTS)))
    assert compare.welch(one, other).min() > 1e-4
    assert compare.welch(1.01 * one, other).max() < 1e-6
    assert (compare.welch(np.ones((8, 10)), np.ones((8, 10))) == 1).all()
    assert (compare.welch(np.ones((8, 10)), np.full((8, 10), 1.01)) == 0).all()


def test_the_plain_path_tracer_knows_a_furnace(plain: Any) -> None:
    """Within a closed box of albedo 1/2 that shines 1 it is 1 + 1/2 + 1/4 + 1/8 after three bounces.

    Of 96,000 paths, each within [0, 2] but for the filter's weights: four standard errors are below 0.005.
    """
    room = scenes.box(np.zeros(3), np.ones(3), np.eye(3), inward=True)
    shining = scenes.Surface((0.5, 0.5, 0.5), (1.0, 1.0, 1.0))
    camera = {"position": (0.1, 0.2, 0.0), "target": (1.0, 0.0, 0.3), "up": (0, 0, 1), "vertical_fov": 60.0}
    world = scenes.World([scenes.Item("mesh", shining, *room)], camera, max_bounces=3)
    picture = reference.Reference(plain, world, 8, 6, "mitchell").render(5, 2000, np.ones((6, 8), dtype=bool))
    assert picture[..., :3].mean() == pytest.approx(1.875, abs=5e-3)


def test_the_scenes_straddle_what_switches_a_way() -> None:
    """Of 400 scenes, each with 8 lights and fewer, 64 primitives and more, and every feature in some of them."""
    cases = [compare.Case(seed) for seed in range(400)]
    worlds = [case.world for case in cases]
    sorted_rays = [w.primitives <= 64 and not w.fog and all(i.transforms is None for i in w.items) for w in worlds]
    lamps = [sum(any(i.surface.emission) for i in w.items) for w in worlds]
    assert sum(few and n >= 8 and w.max_bounces > 1 for few, n, w in zip(sorted_rays, lamps, worlds, strict=True)) > 20
    assert {63, 64, 65, 66} <= {w.primitives for w in worlds}
    assert {0, 1, 7, 8, 9, 15, 16, 17} <= set(lamps)
    for feature in ("fog", "environment", "suns"):
        assert sum(bool(getattr(w, feature)) for w in worlds) > 20, feature
    assert {case.frame.pixel_filter for case in cases} == set(reference.FILTERS)
    for option, count in (("pattern", 4), ("seeds", 3), ("threads", 3), ("tile_size", 4), ("roulette", 3)):
        assert len({way.render[option] for case in cases for way in case.ways}) == count, option
    materials = {type(item.surface.material).__name__ for w in worlds for item in w.items}
    assert materials == {"NoneType", "Mirror", "Dielectric", "Conductor"}
