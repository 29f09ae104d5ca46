# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""render: the same bits however the work is divided, budgets, progress, Ctrl-C, bad input."""

import gc
import subprocess
import sys
import textwrap
import threading
import time
from typing import Any

import numpy as np
import pytest

import sunfleck as sf

MET, MAX_SAMPLES = sf.STOP_REASONS.index("met"), sf.STOP_REASONS.index("max_samples")
OUT_OF_TIME, INTERRUPTED = sf.STOP_REASONS.index("out_of_time"), sf.STOP_REASONS.index("interrupted")


def assert_same_film(a: sf.Image, b: sf.Image) -> None:
    for (name, ours), (_, theirs) in zip(a.channels, b.channels, strict=True):
        assert np.array_equal(ours, theirs), name


# ---- what an image holds ----


@pytest.mark.parametrize("pattern", ["random", "halton", "sobol"])
def test_samples_can_be_had_in_parts(penumbra: sf.Scene, pattern: str) -> None:
    whole = sf.render(penumbra, 40, 24, spp=48, pattern=pattern)
    parts = [sf.render(penumbra, 40, 24, spp=n, start=k, pattern=pattern) for k, n in ((0, 20), (20, 28))]
    mean = (20 * parts[0].color.astype(float) + 28 * parts[1].color.astype(float)) / 48
    # Float results near 1: each is within half an ulp, 2^-25 relative, of its double.
    assert np.abs(mean - whole.color).max() < 4 * 2.0**-25 * whole.color.max()
    assert not np.array_equal(parts[0].color, whole.color)


def test_a_render_ends_at_the_last_index_that_there_is(penumbra: sf.Scene) -> None:
    image = sf.render(penumbra, 8, 8, start=2**31 - 3, spp=3)
    assert (image.samples == 3).all()
    assert np.isfinite(image.color).all()


def test_a_start_goes_with_a_fixed_count(penumbra: sf.Scene) -> None:
    with pytest.raises(ValueError, match="start is 16"):
        sf.render(penumbra, 8, 8, start=16, tolerance=0.1)
    with pytest.raises(ValueError, match="start is 4294967295"):
        sf.render(penumbra, 8, 8, start=2**32 - 1, spp=1)


def test_arrays_have_the_stated_shapes_and_dtypes(picture: sf.Image) -> None:
    assert (picture.width, picture.height) == (40, 24)
    assert picture.color.shape == (24, 40, 3)
    assert picture.color.dtype == np.float32
    for array, dtype in (
        (picture.alpha, np.float32),
        (picture.samples, np.uint32),
        (picture.half_width, np.float32),
        (picture.stop_reason, np.uint8),
    ):
        assert array.shape == (24, 40)
        assert array.dtype == dtype
    assert [name for name, _ in picture.channels] == ["R", "G", "B", "A", "samples", "half_width", "stop_reason"]


def test_arrays_are_views_of_the_film(picture: sf.Image) -> None:
    channels = dict(picture.channels)
    for index, name in enumerate("RGB"):
        assert np.shares_memory(channels[name], picture.color)
        assert np.array_equal(channels[name], picture.color[..., index])
    assert np.shares_memory(channels["samples"], picture.samples)
    assert not picture.color.flags.owndata
    assert not picture.color.flags.writeable


def test_arrays_outlive_their_image(penumbra: sf.Scene) -> None:
    image = sf.render(penumbra, 64, 64, spp=4)
    kept, copy = image.color, image.color.copy()
    del image
    gc.collect()
    others = [sf.render(penumbra, 64, 64, spp=4, seed=seed) for seed in range(1, 5)]
    assert np.array_equal(kept, copy)
    assert not any(np.shares_memory(kept, other.color) for other in others)


def test_metadata_holds_every_option(picture: sf.Image) -> None:
    options = {
        "width": "40",
        "height": "24",
        "seed": "7",
        "pattern": "sobol",
        "pixel_filter": "box",
        "stop": "dyadic",
        "seeds": "pixel",
        "tile_size": "16",
    }
    assert options.items() <= picture.metadata.items()
    assert float(picture.metadata["relative_tolerance"]) == 0.05
    assert float(picture.metadata["confidence"]) == 0.95
    assert all(isinstance(text, str) for text in picture.metadata.values())


def test_summary_adds_up(picture: sf.Image) -> None:
    summary = picture.summary()
    assert summary.pixels == 40 * 24
    assert summary.samples == picture.samples.sum()
    assert sum(summary.reasons.values()) == summary.pixels
    assert summary.reasons["met"] == (picture.stop_reason == MET).sum()
    assert summary.share_met == summary.reasons["met"] / summary.pixels
    assert summary.worst_half_width == picture.half_width.max()
    x, y = summary.worst_pixel
    assert picture.half_width[y, x] == picture.half_width.max()
    assert summary.mean_half_width == pytest.approx(picture.half_width.mean(), rel=1e-5)
    assert summary.tolerance == pytest.approx(0.05 * summary.level)
    assert summary.nonfinite_samples == 0
    assert str(summary).startswith(f"{summary.line}\n")
    assert f"{summary.samples}" in str(summary)


COUNTS: dict[str, Any] = {
    "pixels": 1000,
    "samples": 64000,
    "traced_samples": 64000,
    "nonfinite_samples": 0,
    "level": 0.5,
    "tolerance": 0.005,
    "confidence": 0.95,
    "worst_half_width": 0.015,
    "worst_pixel": (12, 200),
    "mean_half_width": 0.002,
    "seconds": 1.0,
    "threads": 2,
    "rounds": 3,
}


@pytest.mark.parametrize(
    ("reasons", "options", "line"),
    [
        (
            {"met": 987, "max_samples": 13},
            {"relative": True},
            "98.7 % of pixels met 0.01 at 95 %; worst 0.03 at (12, 200)",
        ),
        ({"met": 1000}, {}, "100 % of pixels met 0.005 at 95 %; worst 0.015 at (12, 200)"),
        (
            {"met": 999_999, "max_samples": 1},
            {"pixels": 1_000_000, "confidence": 0.999},
            "99.9 % of pixels met 0.005 at 99.9 %; worst 0.015 at (12, 200)",
        ),
        (
            {"met": 500, "out_of_time": 499, "suspicious": 1},
            {"relative": True},
            "50.0 % of pixels met 0.01 at 95 %, 49.9 % out of time; worst 0.03 at (12, 200)",
        ),
        (
            {"interrupted": 1000},
            {"relative": True},
            "0.0 % of pixels met 0.01 at 95 %, 100 % interrupted; worst 0.03 at (12, 200)",
        ),
        (
            {"fixed": 1000},
            {"tolerance": 0.0},
            "64 samples a pixel; half-width at 95 %: mean 0.002, worst 0.015 at (12, 200)",
        ),
        (
            {"out_of_time": 1000},
            {"tolerance": 0.0, "samples": 64_512},
            "64.51 samples a pixel, out of time; half-width at 95 %: mean 0.002, worst 0.015 at (12, 200)",
        ),
    ],
)
def test_a_summary_s_line_says_what_was_met(reasons: dict[str, int], options: dict[str, Any], line: str) -> None:
    every = dict.fromkeys(sf.STOP_REASONS, 0) | reasons
    summary = sf.Summary(**(COUNTS | {"reasons": every} | options))
    assert summary.line == line
    assert str(summary).splitlines()[0] == line


def test_a_line_has_the_tolerance_as_it_was_given(penumbra: sf.Scene) -> None:
    assert " met 0.07 at 90 %; " in sf.render(penumbra, 24, 24, tolerance=0.07, confidence=0.9).summary().line
    both = sf.Tolerance(absolute=0.025, relative=0.01)
    assert " met 0.025 at 95 %; " in sf.render(penumbra, 24, 24, tolerance=both).summary().line


# ---- AOVs and masks ----


def test_aovs_are_views_by_name(cornell: sf.Scene) -> None:
    image = sf.render(cornell, 40, 32, spp=32, aovs=sf.AOVS)
    assert sf.AOVS == ("albedo", "normal", "depth", "variance", "half_a", "half_b")
    assert tuple(image.aovs) == sf.AOVS
    channels = dict(image.channels)
    assert list(channels)[7:] == [
        *("albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z", "Z", "variance"),
        *("half_a.R", "half_a.G", "half_a.B", "half_b.R", "half_b.G", "half_b.B"),
    ]
    for name, array in image.aovs.items():
        assert array.dtype == np.float32
        assert array.shape == ((32, 40) if name in ("depth", "variance") else (32, 40, 3))
        assert not array.flags.writeable
    assert np.array_equal(channels["normal.Z"], image.aovs["normal"][..., 2])
    assert np.shares_memory(channels["Z"], image.aovs["depth"])
    # Equal halves: their mean is the picture, to the rounding of three floats.
    mean = (image.aovs["half_a"] + image.aovs["half_b"]) / 2
    assert np.allclose(mean, image.color, rtol=3 * 2**-24, atol=0)


def test_cornell_s_aovs_are_what_its_meshes_say(cornell: sf.Scene) -> None:
    image = sf.render(cornell, 64, 64, spp=16, aovs="albedo, normal,depth")
    albedo, normal, depth = (image.aovs[name] for name in ("albedo", "normal", "depth"))
    colors = np.unique([mesh.albedo for mesh in cornell.meshes], axis=0)
    distance = np.abs(albedo[:, :, None, :] - colors).max(axis=-1).min(axis=-1)
    assert (distance < 1e-6).mean() > 0.8  # all but the borders between surfaces
    assert np.linalg.norm(normal, axis=-1).max() <= 1 + 1e-6
    camera = cornell.camera
    forward = np.subtract(camera.target, camera.position) / np.linalg.norm(np.subtract(camera.target, camera.position))
    hit = np.isfinite(depth)
    assert hit.any()
    # Visible faces look towards the viewer: against the rays, which are within 30 degrees of the axis.
    assert (normal[hit] @ forward < 0.5).all()
    reach = [(mesh.vertices - camera.position) @ forward for mesh in cornell.meshes]
    near, far = min(r.min() for r in reach), max(r.max() for r in reach)
    assert near - 1e-4 <= depth[hit].min() <= depth[hit].max() <= far + 1e-4


def test_a_mask_renders_its_pixels_only_and_alike(cornell: sf.Scene) -> None:
    y, x = np.mgrid[:48, :64]
    mask = (x - 40) ** 2 + (y - 20) ** 2 < 100
    full = sf.render(cornell, 64, 48, spp=8, aovs=("albedo", "depth"))
    for given in (mask, mask.astype(np.uint8) * 7, np.asfortranarray(mask), np.repeat(mask, 2, axis=1)[:, ::2]):
        image = sf.render(cornell, 64, 48, spp=8, aovs=("albedo", "depth"), mask=given)
        for (name, ours), (_, theirs) in zip(image.channels, full.channels, strict=True):
            assert np.array_equal(ours[mask], theirs[mask]), name
        assert (image.samples == np.where(mask, 8, 0)).all()
        assert np.isinf(image.half_width[~mask]).all()
        assert (image.stop_reason[~mask] == sf.STOP_REASONS.index("masked")).all()
        assert not image.color[~mask].any()
    summary = image.summary()
    assert summary.pixels == mask.sum() == summary.reasons["fixed"]
    assert image.metadata["mask"].startswith(f"{mask.sum()} pixels")
    assert (image.metadata["aovs"], full.metadata["mask"]) == ("albedo,depth", "none")


def test_a_mask_and_a_crop_are_both_in_pixels_of_the_frame(cornell: sf.Scene) -> None:
    mask = np.zeros((48, 64), bool)
    mask[10:20, 30:33] = True
    image = sf.render(cornell, 64, 48, spp=8, mask=mask, crop=(25, 5, 35, 15))
    assert np.array_equal(image.samples > 0, mask[5:15, 25:35])


# ---- accuracy and budgets ----


def test_an_adaptive_picture_meets_its_tolerance(penumbra: sf.Scene) -> None:
    image = sf.render(penumbra, 64, 64, tolerance=sf.Tolerance(absolute=0.005), min_spp=64)
    met = image.stop_reason == MET
    assert met.mean() > 0.95
    assert image.half_width[met].max() <= 0.005
    assert image.samples.min() == 64
    assert image.samples.max() > 128


@pytest.mark.parametrize("stop", ["dyadic", "replicates"])
def test_rules_of_powers_of_two_look_there(penumbra: sf.Scene, stop: str) -> None:
    image = sf.render(penumbra, 48, 48, tolerance=0.03, min_spp=50, stop=stop)
    first = {"dyadic": 64, "replicates": 128}[stop]
    assert image.samples.min() == first
    assert set(np.unique(image.samples)) <= {first << k for k in range(7)}


def test_a_pixel_that_saw_no_difference_has_a_finite_error(penumbra: sf.Scene) -> None:
    # A white furnace: every sample of every pixel is the background.
    scene = sf.Scene(penumbra.meshes[:1], penumbra.camera, background=(0.5, 0.5, 0.5), max_bounces=0)
    image = sf.render(scene, 16, 16, spp=64)
    sky = image.alpha == 0
    if sky.any():
        assert (image.half_width[sky] > 0).all()
    assert (image.half_width > 0).all()


def test_a_budget_of_samples_is_spent_where_the_error_is_largest(penumbra: sf.Scene) -> None:
    budget = 64 * 64 * 100
    image = sf.render(penumbra, 64, 64, samples=budget)
    even = sf.render(penumbra, 64, 64, spp=64)
    total = int(image.samples.sum(dtype=np.uint64))
    assert 0.8 * budget < total <= budget
    assert image.half_width.max() < 0.6 * even.half_width.max()
    with pytest.raises(ValueError, match="samples is 10"):
        sf.render(penumbra, 64, 64, samples=10)
    with pytest.raises(ValueError, match="beside spp"):
        sf.render(penumbra, 64, 64, samples=10**6, spp=4)


def test_nothing_given_means_a_hundredth_of_the_level(penumbra: sf.Scene) -> None:
    summary = sf.render(penumbra, 16, 16).summary()
    assert summary.tolerance == pytest.approx(0.01 * summary.level)


def test_a_plain_number_is_relative(penumbra: sf.Scene) -> None:
    assert_same_film(
        sf.render(penumbra, 24, 24, tolerance=0.03),
        sf.render(penumbra, 24, 24, tolerance=sf.Tolerance(relative=0.03)),
    )


def test_a_fixed_count_is_taken_in_every_pixel(penumbra: sf.Scene) -> None:
    image = sf.render(penumbra, 20, 20, spp=37)
    assert (image.samples == 37).all()
    assert (image.stop_reason == sf.STOP_REASONS.index("fixed")).all()


def test_max_spp_ends_what_cannot_be_met(penumbra: sf.Scene) -> None:
    image = sf.render(penumbra, 20, 20, tolerance=1e-9, min_spp=8, max_spp=64)
    assert image.samples.max() == 64
    assert (image.stop_reason == MAX_SAMPLES).any()


def test_seconds_alone_are_spent(penumbra: sf.Scene) -> None:
    start = time.monotonic()
    image = sf.render(penumbra, 64, 64, seconds=0.5)
    took = time.monotonic() - start
    assert 0.4 < took < 1.0
    assert (image.stop_reason == OUT_OF_TIME).all()
    assert image.samples.min() > 0


@pytest.mark.parametrize("scene", ["penumbra", "cornell"])
def test_threads_and_tiles_change_no_bit(scene: str, request: pytest.FixtureRequest) -> None:
    built = request.getfixturevalue(scene)
    first = sf.render(built, 70, 50, tolerance=0.05, max_spp=256, threads=1, tile_size=8)
    for threads, tile_size in ((2, 8), (1, 16), (2, 16), (2, 64), (3, 64)):
        assert_same_film(
            first, sf.render(built, 70, 50, tolerance=0.05, max_spp=256, threads=threads, tile_size=tile_size)
        )


@pytest.mark.parametrize("pattern", ["random", "halton", "sobol", "uniform", "jittered"])
def test_every_pattern_gives_the_same_picture_twice(penumbra: sf.Scene, pattern: str) -> None:
    image = sf.render(penumbra, 32, 32, spp=16, pattern=pattern)
    assert_same_film(image, sf.render(penumbra, 32, 32, spp=16, pattern=pattern, threads=1))
    # All of them estimate the same means; 16 samples of 1,024 pixels are within 2 %.
    reference = sf.render(penumbra, 32, 32, spp=1024).color.mean()
    assert image.color.mean() == pytest.approx(reference, rel=0.02)


@pytest.mark.parametrize("pixel_filter", ["tent", "gaussian"])
def test_filters_keep_the_mean_and_soften_edges(penumbra: sf.Scene, pixel_filter: str) -> None:
    box = sf.render(penumbra, 64, 64, spp=256)
    soft = sf.render(penumbra, 64, 64, spp=256, pixel_filter=pixel_filter)
    assert soft.color.mean() == pytest.approx(box.color.mean(), rel=5e-3)
    assert np.abs(np.diff(soft.color, axis=1)).max() < np.abs(np.diff(box.color, axis=1)).max()


def test_seeds_differ(penumbra: sf.Scene) -> None:
    a, b = (sf.render(penumbra, 32, 32, spp=16, seed=seed) for seed in (0, 2**64 - 1))
    assert not np.array_equal(a.color, b.color)


@pytest.mark.parametrize("seeds", ["thread", "shared"])
def test_the_other_seed_policies_render(penumbra: sf.Scene, seeds: str) -> None:
    image = sf.render(penumbra, 32, 32, spp=64, seeds=seeds, pattern="random")
    assert image.color.mean() == pytest.approx(sf.render(penumbra, 32, 32, spp=64).color.mean(), rel=0.03)


@pytest.mark.parametrize("crop", [(0, 0, 13, 7), (17, 5, 41, 30), (63, 47, 64, 48)])
def test_a_crop_is_cut_out_of_the_full_frame(cornell: sf.Scene, crop: tuple[int, int, int, int]) -> None:
    x0, y0, x1, y1 = crop
    full = sf.render(cornell, 64, 48, spp=8)
    image = sf.render(cornell, 64, 48, spp=8, crop=crop)
    assert (image.width, image.height) == (x1 - x0, y1 - y0)
    for (_, part), (_, whole) in zip(image.channels, full.channels, strict=True):
        assert np.array_equal(part, whole[y0:y1, x0:x1])


def test_renders_of_several_threads_do_not_disturb_one_another(penumbra: sf.Scene) -> None:
    images: dict[int, sf.Image] = {}

    def work(seed: int) -> None:
        images[seed] = sf.render(penumbra, 48, 48, spp=32, seed=seed, threads=1)

    threads = [threading.Thread(target=work, args=(seed,)) for seed in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for seed, image in images.items():
        assert_same_film(image, sf.render(penumbra, 48, 48, spp=32, seed=seed))


def test_the_gil_is_released(penumbra: sf.Scene) -> None:
    ticks = 0
    done = threading.Event()

    def tick() -> None:
        nonlocal ticks
        while not done.wait(0.005):
            ticks += 1

    ticker = threading.Thread(target=tick)
    ticker.start()
    sf.render(penumbra, 64, 64, seconds=0.5, threads=1)
    done.set()
    ticker.join()
    assert ticks > 20


# ---- progress ----


def test_progress_is_told_after_every_round(penumbra: sf.Scene) -> None:
    records: list[tuple[int, int, int, int]] = []

    def tell(p: sf.Progress) -> None:
        records.append((p.round, p.samples, p.pixels, p.pixels_done))

    image = sf.render(penumbra, 32, 32, tolerance=0.02, progress=tell)
    rounds, samples, pixels, done = zip(*records, strict=True)
    assert list(rounds) == list(range(1, len(rounds) + 1))
    assert len(rounds) == image.summary().rounds
    assert list(samples) == sorted(samples)
    assert list(done) == sorted(done)
    assert set(pixels) == {32 * 32}
    assert samples[-1] == image.samples.sum()
    assert done[-1] == 32 * 32


def test_progress_may_stop_the_render(penumbra: sf.Scene) -> None:
    image = sf.render(penumbra, 64, 64, tolerance=1e-6, max_spp=2**20, progress=lambda p: p.round < 2)
    assert image.interrupted
    assert (image.stop_reason == INTERRUPTED).any()
    assert image.summary().rounds == 2
    assert image.samples.min() > 0


def test_only_false_stops(penumbra: sf.Scene) -> None:
    answers: list[object] = [None, 0, True]
    for answer in answers:
        assert not sf.render(penumbra, 16, 16, spp=64, progress=lambda _, answer=answer: answer).interrupted  # type: ignore[misc]


def test_what_progress_raises_comes_through(penumbra: sf.Scene) -> None:
    def fail(_: sf.Progress) -> None:
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        sf.render(penumbra, 64, 64, tolerance=1e-6, progress=fail)


def test_a_bar_is_drawn_on_stderr(penumbra: sf.Scene, capfd: pytest.CaptureFixture[str]) -> None:
    sf.render(penumbra, 64, 64, tolerance=1e-9, seconds=0.5, max_spp=2**31, progress=True)
    sf.render(penumbra, 64, 64, spp=2**31, seconds=0.5, progress=True)
    out, err = capfd.readouterr()
    assert out == ""
    assert "samples a pixel" in err
    assert "% met, " in err
    assert "sample/s" in err


# ---- Ctrl-C ----

INTERRUPT = """
    import os, signal, threading, time
    import sunfleck as sf
    scene = sf.scenes.cornell()
    sent = []

    def interrupt():
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    threading.Timer(0.5, interrupt).start()
    image = sf.render(scene, {size}, {size}, {options})
    late = time.monotonic() - sent[0]
    interrupted = sf.STOP_REASONS.index("interrupted")
    assert image.interrupted
    assert (image.stop_reason == interrupted).any()
    assert image.color.shape == ({size}, {size}, 3)
    assert late < 0.5, late
    time.sleep(0.01)  # the KeyboardInterrupt was spent
    print("partial")
"""


@pytest.mark.parametrize(
    ("size", "options"),
    [(64, "spp=2**31"), (2048, "spp=2**20, tile_size=1024"), (256, "tolerance=1e-9, max_spp=2**31")],
)
def test_ctrl_c_returns_the_partial_picture_within_half_a_second(size: int, options: str) -> None:
    script = textwrap.dedent(INTERRUPT.format(size=size, options=options))
    result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=False)
    assert (result.returncode, result.stdout) == (0, "partial\n"), result.stderr


# ---- bad input ----


@pytest.mark.parametrize(
    ("options", "error", "match"),
    [
        ({"width": 0}, ValueError, "width is 0"),
        ({"width": -1}, ValueError, "width is -1"),
        ({"height": 65537}, ValueError, "height is 65537.*65536"),
        ({"height": 2**40}, ValueError, "height"),
        ({"width": 16.0}, TypeError, "width is 16.0"),
        ({"spp": 0}, ValueError, "spp is 0"),
        ({"spp": -4}, ValueError, "spp is -4"),
        ({"spp": 2**31 + 1}, ValueError, "spp is 2147483649"),
        ({"spp": 4, "tolerance": 0.1}, ValueError, "both"),
        ({"tolerance": 0}, ValueError, "tolerance is 0"),
        ({"tolerance": -0.1}, ValueError, "-0.1"),
        ({"tolerance": np.nan}, ValueError, "tolerance"),
        ({"tolerance": np.inf}, ValueError, "tolerance"),
        ({"tolerance": "fine"}, TypeError, "tolerance"),
        ({"confidence": 0}, ValueError, "confidence is 0"),
        ({"confidence": 1}, ValueError, "confidence is 1"),
        ({"confidence": np.nan}, ValueError, "confidence"),
        ({"min_spp": 1}, ValueError, "min_spp is 1"),
        ({"min_spp": 64, "max_spp": 32}, ValueError, "min_spp is 64"),
        ({"max_spp": 2**31 + 1}, ValueError, "max_spp"),
        ({"seconds": 0}, ValueError, "seconds is 0"),
        ({"seconds": -1}, ValueError, "seconds is -1"),
        ({"seconds": np.nan}, ValueError, "seconds"),
        ({"pattern": "sobel"}, ValueError, "sobel.*sobol"),
        ({"pattern": "lattice"}, ValueError, f"lattice.*{', '.join(sf.RENDER_PATTERNS)}$"),
        ({"pattern": None}, TypeError, "pattern"),
        ({"pixel_filter": "sinc"}, ValueError, "sinc.*box, tent, gaussian.*lanczos"),
        ({"stop": "never"}, ValueError, "never.*standard_error"),
        ({"seeds": "time"}, ValueError, "time.*pixel, thread, shared"),
        ({"seed": -1}, ValueError, "seed is -1"),
        ({"seed": 2**64}, ValueError, "seed"),
        ({"threads": 0}, ValueError, "threads is 0"),
        ({"threads": 1025}, ValueError, "threads is 1025"),
        ({"tile_size": 12}, ValueError, "tile_size is 12"),
        ({"tile_size": 0}, ValueError, "tile_size is 0"),
        ({"tile_size": 2048}, ValueError, "tile_size is 2048"),
        ({"crop": (0, 0, 0, 0)}, ValueError, "crop"),
        ({"crop": (4, 4, 4, 8)}, ValueError, "crop"),
        ({"crop": (8, 0, 4, 8)}, ValueError, "crop"),
        ({"crop": (0, 0, 17, 8)}, ValueError, "crop"),
        ({"crop": (0, 0, 8)}, ValueError, "crop"),
        ({"crop": (-1, 0, 8, 8)}, ValueError, "crop x0 is -1"),
        ({"crop": 5}, ValueError, "crop"),
        ({"aovs": ("albedo", "motion")}, ValueError, "motion.*albedo, normal, depth, variance, half_a, half_b"),
        ({"aovs": 3}, TypeError, "aovs is 3"),
        ({"aovs": (3,)}, TypeError, "aovs is 3"),
        ({"aovs": "half_a", "spp": 16}, ValueError, "half_a.*spp is 16"),
        ({"mask": np.ones((16, 17), bool)}, ValueError, r"mask has shape \(16, 17\).*\(16, 16\)"),
        ({"mask": np.ones(256, bool)}, ValueError, "mask has shape"),
        ({"mask": np.ones((16, 16))}, TypeError, "mask has dtype float64"),
        ({"mask": np.zeros((16, 16), bool)}, ValueError, "mask leaves no pixel"),
        ({"progress": 3}, TypeError, "progress"),
        ({"scene": None}, TypeError, "scene"),
    ],
)
def test_a_bad_option_is_named(penumbra: sf.Scene, options: dict[str, Any], error: Any, match: str) -> None:
    with pytest.raises(error, match=match):
        sf.render(**{"scene": penumbra, "width": 16, "height": 16, **options})


@pytest.mark.parametrize("values", [{}, {"absolute": 0}, {"relative": "x"}])
def test_a_bad_tolerance_is_named(values: dict[str, Any]) -> None:
    with pytest.raises((ValueError, TypeError), match="tolerance"):
        sf.Tolerance(**values)


def test_a_profile_accounts_for_the_threads_time_and_changes_no_pixel() -> None:
    scene = sf.scenes.cornell()
    plain, told = (sf.render(scene, 64, 64, spp=32, threads=2, profile=profile) for profile in (False, True))
    assert np.array_equal(plain.color, told.color)
    assert plain.summary().work == {}
    assert "work" not in str(plain.summary())
    summary = told.summary()
    names = "coordinates, camera, camera rays, shadow rays, surface rays, vertices, light, surface, sums, film"
    assert ", ".join(summary.work) == names
    whole = summary.threads * summary.seconds
    # Each thread's clock runs from tile to tile: it can't have more than the call, and has most of it.
    assert 0.3 * whole < sum(summary.work.values()) <= 1.001 * whole
    assert "shadow rays" in str(summary)
    assert "surface rays" not in sf.render(sf.scenes.penumbra(), 16, 16, spp=4, profile=True).summary().work
