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

SCENES = 60
RATE = 1e-3  # of false alarms, over all tests of all scenes


@pytest.fixture(scope="module")
def plain() -> Any:
    return reference.load()


def _seeds() -> range:
    given = os.environ.get("SUNFLECK_DIFFERENTIAL")
    if given:
        first, _, count = given.partition(":")
        return range(int(first), int(first) + int(count or SCENES))
    year, week, _ = datetime.date.today().isocalendar()
    first = (100 * year + week) * 100
    return range(first, first + SCENES)


def test_random_scenes_have_the_means_of_a_plain_path_tracer(plain: Any) -> None:
    seeds = _seeds()
    print(f"SUNFLECK_DIFFERENTIAL={seeds.start}:{len(seeds)}")
    verdicts = list(run.judge_all(seeds, plain, 2))
    found = compare.holm(verdicts, RATE)
    broken = [v.seed for v in verdicts if v.nonfinite]
    assert not found, f"SUNFLECK_DIFFERENTIAL={seeds.start}:{len(seeds)}\n{run.report(verdicts, RATE)}"
    assert not broken, f"samples that are not finite in scenes {broken}"


def test_a_frame_that_is_brighter_by_a_hundredth_is_found() -> None:
    rng = np.random.default_rng(1)
    one = 1 + 0.005 * rng.normal(size=(64, len(compare.TESTS)))
    other = 1 + 0.005 * rng.normal(size=(64, len(compare.TESTS)))
    assert compare.welch(one, other).min() > 1e-4
    assert compare.welch(1.01 * one, other).max() < 1e-6
    assert (compare.welch(np.ones((8, 10)), np.ones((8, 10))) == 1).all()
    assert (compare.welch(np.ones((8, 10)), np.full((8, 10), 1.01)) == 0).all()


def test_the_plain_path_tracer_knows_a_furnace(plain: Any) -> None:
    """Within a closed box of albedo a that shines 1, radiance after n bounces is 1 + a + ... + a^n."""
    maker = compare.random_world(0)
    maker.items = maker.items[:0]
    corners = np.array([[x, y, z] for z in (-1.0, 1.0) for y in (-1.0, 1.0) for x in (-1.0, 1.0)])
    faces = [(a, c, b) for a, b, c, d in reference_faces()] + [(a, d, c) for a, b, c, d in reference_faces()]
    surface = compare_surface((0.5, 0.5, 0.5), (1.0, 1.0, 1.0))
    maker.items.append(item(surface, corners, np.array(faces, dtype=np.uint32)))
    maker.camera = {"position": (0.1, 0.2, 0.0), "target": (1.0, 0.0, 0.3), "up": (0, 0, 1), "vertical_fov": 60.0}
    maker.background, maker.suns, maker.environment, maker.fog = (0.0, 0.0, 0.0), [], None, None
    maker.max_bounces = 3
    tracer = reference.Reference(plain, maker, 8, 6, "mitchell")
    picture = tracer.render(5, 2000, np.ones((6, 8), dtype=bool))
    assert picture[..., :3].mean() == pytest.approx(1.875, rel=5e-3)
