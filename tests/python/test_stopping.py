# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""stopping: two stages without bias, heavy tails that are told, crops of a render to a tolerance."""

from typing import Any

import numpy as np
import pytest

import sunfleck as sf

SUSPICIOUS = sf.STOP_REASONS.index("suspicious")
RULE: dict[str, Any] = {"tolerance": 0.3, "stop": "standard_error", "min_spp": 16, "max_spp": 512, "pattern": "random"}


def level(image: sf.Image) -> Any:
    return image.color.mean(axis=2, dtype=np.float64)


# ---- two stages ----


def test_a_pilot_decides_as_the_plain_render_does(penumbra: sf.Scene) -> None:
    plain, both = (sf.render(penumbra, 40, 40, tolerance=0.05, unbiased=unbiased) for unbiased in (False, True))
    assert np.array_equal(plain.samples, both.samples)
    assert np.array_equal(plain.half_width, both.half_width)
    assert np.array_equal(plain.stop_reason, both.stop_reason)
    assert both.summary().traced_samples == 2 * plain.summary().traced_samples
    assert both.metadata["unbiased"] == "true"


@pytest.mark.parametrize("stop", ["dyadic", "replicates", "standard_error"])
def test_the_second_set_is_independent_of_the_pilot(penumbra: sf.Scene, stop: str) -> None:
    options: dict[str, Any] = {"tolerance": 0.1, "stop": stop, "pattern": "random"}
    truth = level(sf.render(penumbra, 40, 40, spp=16384, seed=9))
    plain, both = (
        level(sf.render(penumbra, 40, 40, unbiased=unbiased, **options)) - truth for unbiased in (False, True)
    )
    assert (plain != both).mean() > 0.5
    # sobol's 16,384 samples leave some thousandth of the variance of at most 2,000 random ones.
    assert abs(np.corrcoef(plain.ravel(), both.ravel())[0, 1]) < 4 / np.sqrt(plain.size)


def test_bias_ends_with_the_second_set(cornell: sf.Scene) -> None:
    truth = sf.render(cornell, 24, 24, spp=8192, seed=99).color.mean(dtype=np.float64)
    error: dict[bool, float] = {}
    for unbiased in (False, True):
        means = [sf.render(cornell, 24, 24, seed=seed, unbiased=unbiased, **RULE).color.mean() for seed in range(32)]
        error[unbiased] = float((np.mean(means) - truth) / (np.std(means, ddof=1) / 32**0.5))
    assert error[False] < -5  # too low: the pixels that were estimated low are the ones that stopped
    assert abs(error[True]) < 3.7  # Student's t of 31 degrees of freedom: 1 in 1,000


def test_a_budget_is_halved_between_the_stages(penumbra: sf.Scene) -> None:
    image = sf.render(penumbra, 32, 32, samples=32 * 32 * 64, unbiased=True)
    assert 0.98 * 32 * 32 * 64 < image.summary().traced_samples <= 32 * 32 * 64
    assert image.samples.sum() * 2 == image.summary().traced_samples


def test_threads_and_tiles_change_no_bit_of_two_stages(cornell: sf.Scene) -> None:
    a, b = (
        sf.render(cornell, 24, 24, tolerance=0.3, unbiased=True, threads=threads, tile_size=tile)
        for threads, tile in ((1, 8), (2, 16))
    )
    assert np.array_equal(a.color, b.color)
    assert np.array_equal(a.samples, b.samples)


def test_a_fixed_count_has_no_second_set(penumbra: sf.Scene) -> None:
    with pytest.raises(ValueError, match="spp is 16 and unbiased is set too"):
        sf.render(penumbra, 8, 8, spp=16, unbiased=True)
    with pytest.raises(TypeError, match="unbiased is 'no'; give True or False"):
        sf.render(penumbra, 8, 8, unbiased="no")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="samples is 100; at least two, with unbiased, for each of 64 pixels"):
        sf.render(penumbra, 8, 8, samples=100, unbiased=True)


# ---- heavy tails ----


def test_rare_light_is_told(penumbra: sf.Scene) -> None:
    keyhole = sf.render(sf.scenes.keyhole(), 64, 64, tolerance=0.1, max_spp=512)
    doubted = keyhole.stop_reason == SUSPICIOUS
    assert 0.01 < doubted.mean() < 0.2
    assert (keyhole.half_width[doubted] > keyhole.summary().tolerance).all()
    # They are those that saw little: their level is below that of the others in the median.
    assert np.median(level(keyhole)[doubted]) < np.median(level(keyhole)[~doubted])
    assert not (sf.render(penumbra, 64, 64, tolerance=0.01, max_spp=512).stop_reason == SUSPICIOUS).any()


# ---- crops ----


def test_a_crop_to_a_tolerance_is_exact_where_no_neighbour_counts(penumbra: sf.Scene) -> None:
    options: dict[str, Any] = {"tolerance": sf.Tolerance(absolute=0.004), "stop": "standard_error"}
    whole = sf.render(penumbra, 64, 64, **options)
    part = sf.render(penumbra, 64, 64, crop=(20, 20, 44, 44), **options)
    assert np.array_equal(whole.color[20:44, 20:44], part.color)
    assert np.array_equal(whole.samples[20:44, 20:44], part.samples)


def test_a_crop_under_the_default_rule_takes_the_same_samples_nearly_everywhere(penumbra: sf.Scene) -> None:
    options: dict[str, Any] = {"tolerance": sf.Tolerance(absolute=0.004)}
    whole = sf.render(penumbra, 96, 96, **options)
    part = sf.render(penumbra, 96, 96, crop=(24, 24, 72, 72), **options)
    same = whole.samples[24:72, 24:72] == part.samples
    assert same.mean() > 0.97
    assert np.array_equal(whole.color[24:72, 24:72][same], part.color[same])  # the same count, the same bits
