# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""render(relmse=): a goal for the whole picture, against its true error, and what is said of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import sunfleck as sf
from sunfleck.cli import main

SIZE = 64
MET = sf.STOP_REASONS.index("met")


def relmse(x: NDArray[np.float32], r: NDArray[np.float32]) -> float:
    return float(np.mean((x.astype(float) - r) ** 2 / (r.astype(float) ** 2 + 0.01)))


@pytest.mark.parametrize(
    ("name", "goal", "share"), [("penumbra", 2e-5, 0.7), ("defocus", 1e-4, 0.95), ("cornell", 4e-3, 1.05)]
)
def test_the_true_error_is_within_and_samples_are_saved(name: str, goal: float, share: float) -> None:
    scene = getattr(sf.scenes, name)()
    truth = sf.render(scene, SIZE, SIZE, spp=8192, seed=99).color
    images = [sf.render(scene, SIZE, SIZE, relmse=goal, seed=seed) for seed in range(4)]
    errors = [relmse(image.color, truth) for image in images]
    assert 0.3 * goal < np.mean(errors) < 1.15 * goal
    assert all(image.summary().relmse <= goal for image in images)
    assert all((image.stop_reason == MET).all() for image in images)
    # Of the samples that as small an error takes where all pixels have as many, by powers of two around it.
    fixed = [(n, relmse(sf.render(scene, SIZE, SIZE, spp=n, seed=7).color, truth)) for n in (16, 32, 64, 128, 256, 512)]
    counts, even = np.log([n for n, _ in fixed]), np.log([e for _, e in fixed])
    alike = np.exp(np.interp(-np.log(np.mean(errors)), -even, counts))
    assert np.mean([image.samples.mean() for image in images]) < share * alike


def test_the_estimate_of_a_fixed_count_is_near_the_truth(cornell: sf.Scene) -> None:
    truth = sf.render(cornell, SIZE, SIZE, spp=8192, seed=99).color
    image = sf.render(cornell, SIZE, SIZE, spp=64)
    error = relmse(image.color, truth)
    assert error < image.summary().relmse < 2 * error  # the rule's safety is 1.38


def test_what_is_asked_and_told(penumbra: sf.Scene) -> None:
    seen: list[float] = []

    def look(progress: sf.Progress) -> None:
        seen.append(progress.relmse)
        assert 0 <= progress.pixels_done <= progress.pixels

    image = sf.render(penumbra, SIZE, SIZE, relmse=1e-4, progress=look)
    assert seen[0] > seen[-1] > 0
    assert image.summary().goal == 1e-4
    assert image.summary().line.startswith(f"relMSE {image.summary().relmse:.3g}, reached: 0.0001 was asked for; ")
    assert image.metadata["relmse"] == "0.0001"
    short = sf.render(penumbra, SIZE, SIZE, relmse=1e-9, max_spp=64)
    assert "not reached: 1e-09 was asked for" in short.summary().line
    assert (short.samples == 64).all()
    assert not (short.stop_reason == MET).any()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"relmse": 0}, "relmse is 0, which no number of samples reaches"),
        ({"relmse": -1}, "relmse is -1"),
        ({"relmse": float("nan")}, "relmse is nan"),
        ({"relmse": 1e-3, "spp": 4}, "relmse is 0.001 beside spp"),
        ({"relmse": 1e-3, "tolerance": 0.1}, "relmse is 0.001 beside spp, samples or a tolerance"),
        ({"relmse": 1e-3, "samples": 10**6}, "relmse is 0.001 beside spp"),
    ],
)
def test_bad_goals_are_refused(penumbra: sf.Scene, options: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        sf.render(penumbra, 8, 8, **options)  # type: ignore[arg-type]


def test_two_stages_take_the_pilot_s_counts(penumbra: sf.Scene) -> None:
    one, two = (sf.render(penumbra, SIZE, SIZE, relmse=1e-4, unbiased=unbiased) for unbiased in (False, True))
    assert np.array_equal(one.samples, two.samples)
    assert not np.array_equal(one.color, two.color)


def test_a_checkpoint_goes_on_to_a_smaller_goal(penumbra: sf.Scene, tmp_path: Path) -> None:
    path = tmp_path / "a.ckpt"
    first = sf.render(penumbra, SIZE, SIZE, relmse=1e-4, checkpoint=path)
    with pytest.raises(ValueError, match=r"relmse 0\.0001; this render has relmse 0.001"):
        sf.render(penumbra, SIZE, SIZE, relmse=1e-3, checkpoint=path)
    with pytest.raises(ValueError, match="relmse"):
        sf.render(penumbra, SIZE, SIZE, tolerance=0.1, checkpoint=path)
    second = sf.render(penumbra, SIZE, SIZE, relmse=2e-5, checkpoint=path)
    assert second.summary().relmse <= 2e-5
    assert (second.samples >= first.samples).all()
    assert second.samples.sum() > first.samples.sum()


def test_the_command_line_takes_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "a.exr"
    size = ["--width", "32", "--height", "32", "-o", str(file)]
    assert main(["render", "penumbra", "--relmse", "1e-4", *size]) == 0
    assert "relMSE" in capsys.readouterr().out
    assert file.stat().st_size > 1000


def test_replicates_halve_the_estimate(cornell: sf.Scene) -> None:
    one, two = (sf.render(cornell, SIZE, SIZE, spp=64, seed=seed) for seed in (1, 2))
    merged = sf.merge([one, two]).summary().relmse
    assert 0.4 * one.summary().relmse < merged < 0.8 * one.summary().relmse
