# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""pixel filters of a render: constants exact, edges and ramps as the filter has them, half-widths that hold."""

import itertools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import erf

import sunfleck as sf

SIGNED = ("mitchell", "lanczos")
HALF = 12.0  # of the frame of `plane_scene`, in pixels

Array = NDArray[np.floating]


def assert_same_film(a: sf.Image, b: sf.Image) -> None:
    for (name, ours), (_, theirs) in zip(a.channels, b.channels, strict=True):
        assert np.array_equal(ours, theirs), name


def plane_scene(meshes: list[sf.Mesh]) -> sf.Scene:
    """Seen straight on, 24 x 24 pixels, of which each is a unit square of the plane z = 0."""
    camera = sf.Camera((0, 0, HALF), (0, 0, 0), up=(0, 1, 0), vertical_fov=90)
    return sf.Scene(meshes, camera, max_bounces=0)


def strip(left: float, right: float, radiance: float) -> sf.Mesh:
    vertices = np.array([(left, -99, 0), (right, -99, 0), (right, 99, 0), (left, 99, 0)], np.float32)
    triangles = np.array([(0, 1, 2), (0, 2, 3)], np.uint32)
    return sf.Mesh(vertices, triangles, albedo=(0, 0, 0), emission=(radiance,) * 3)


# ---- the filters' axes, written anew from their published forms ----


def mitchell(x: Array) -> Array:
    """Mitchell & Netravali 1988, eq. 8 with B = C = 1/3, times 18."""
    d = np.abs(x)
    inner = 21 * d**3 - 36 * d**2 + 16
    outer = -7 * d**3 + 36 * d**2 - 60 * d + 32
    return np.where(d < 1, inner, np.where(d < 2, outer, 0.0))


def blackman_harris(x: Array) -> Array:
    """Harris 1978, table 1: 4-term, -92 dB."""
    t = 2 * np.pi * (x / 3 + 0.5)
    window = 0.35875 - 0.48829 * np.cos(t) + 0.14128 * np.cos(2 * t) - 0.01168 * np.cos(3 * t)
    return np.asarray(np.where(np.abs(x) < 1.5, window, 0.0))


def truncated(x: Array) -> Array:
    """A Gaussian of sigma 0.4 within a circle of radius 1.5, summed along y."""
    chord = np.sqrt(np.maximum(1.5**2 - x**2, 0))
    return np.asarray(np.exp(-(x**2) / 0.32) * erf(chord / (0.4 * np.sqrt(2))))


AXES: dict[str, Callable[[Array], Array]] = {
    "box": lambda x: (np.abs(x) < 0.5) * 1.0,
    "tent": lambda x: np.maximum(1 - np.abs(x), 0),
    "gaussian": lambda x: np.exp(-(x**2) / 0.32),
    "gaussian_truncated": truncated,
    "blackman_harris": blackman_harris,
    "mitchell": mitchell,
    "lanczos": lambda x: np.where(np.abs(x) < 3, np.sinc(x) * np.sinc(x / 3), 0.0),
}


def step_response(name: str, distance: Array) -> Array:
    """The filtered value of what is 1 up to `distance` right of the pixel's centre, and 0 beyond."""
    cells = np.linspace(-4, 4, 80001)  # midpoint rule: within 1e-7 for these
    middle = (cells[1:] + cells[:-1]) / 2
    integral = np.concatenate([[0.0], np.cumsum(AXES[name](middle))])
    return np.asarray(np.interp(distance, cells, integral / integral[-1]))


def test_every_pixel_mapping_is_a_filter() -> None:
    assert {f"pixel_{name}" for name in sf.PIXEL_FILTERS} == {m for m in sf.MAPPINGS if m.startswith("pixel_")}
    assert set(AXES) == set(sf.PIXEL_FILTERS)


@pytest.mark.parametrize("pixel_filter", sf.PIXEL_FILTERS)
@pytest.mark.parametrize("pattern", ["sobol", "random"])
def test_a_constant_image_is_exact_at_any_count(pixel_filter: str, pattern: str) -> None:
    sky = np.array([0.1, 0.7, 3e5], np.float32)
    behind = sf.Mesh(np.array([(0, 0, 90), (1, 0, 90), (0, 1, 90)], np.float32), np.array([(0, 1, 2)], np.uint32))
    scene = sf.Scene([behind], sf.Camera((0, 0, 1), (0, 0, 0)), background=tuple(sky), max_bounces=0)
    for spp in (1, 2, 3, 16, 100):
        image = sf.render(scene, 32, 32, spp=spp, pixel_filter=pixel_filter, pattern=pattern)
        assert (image.color == sky).all(), spp


@pytest.mark.parametrize("pixel_filter", sf.PIXEL_FILTERS)
def test_an_edge_has_the_filters_step_response_within_its_half_width(pixel_filter: str) -> None:
    covered = []
    centre = np.arange(24) + 0.5 - HALF
    for seed, edge in enumerate((-0.3, 0.05, 0.4)):
        scene = plane_scene([strip(-99, edge, 1.0)])
        expected = step_response(pixel_filter, edge - centre)
        near = np.abs(edge - centre) < (0.45 if pixel_filter == "box" else 0.9)
        image = sf.render(
            scene, 24, 24, spp=1024, pixel_filter=pixel_filter, pattern="random", stop="standard_error", seed=seed
        )
        covered.append((np.abs(image.color[..., 0] - expected) <= image.half_width)[:, near])
        # A scrambled net's variance for a step is at most that of a 32 x 32 jittered grid, of whose 1,024 cells
        # the step cuts 32 and each adds at most 1/4 / 1024^2: 0.0028, times 1.845 for Lanczos' weights 0.0051,
        # in the pixels near the edge only, half of them; five of those for the worst of 1,728 pixels.
        smooth = sf.render(scene, 24, 24, spp=1024, pixel_filter=pixel_filter, seed=seed)
        assert np.sqrt(np.mean((smooth.color[..., 0] - expected) ** 2)) < 0.005
        assert np.abs(smooth.color[..., 0] - expected).max() < 0.03
    share = np.concatenate([c.ravel() for c in covered])
    # 95 % within four standard deviations of a binomial.
    assert abs(share.mean() - 0.95) < 4 * np.sqrt(0.95 * 0.05 / share.size)


@pytest.mark.parametrize("pixel_filter", sf.PIXEL_FILTERS)
def test_a_ramp_keeps_its_mean(pixel_filter: str) -> None:
    """Strips of 1/8 pixel are symmetric about every pixel's centre: the value there is the mean."""
    edges = np.arange(-24 * 8, 24 * 8 + 1) / 8
    scene = plane_scene([strip(a, b, 1 + (a + b) / 50) for a, b in itertools.pairwise(edges)])
    expected = 1 + (np.arange(24) + 0.5 - HALF) / 25
    image = sf.render(scene, 24, 24, spp=256, pixel_filter=pixel_filter, pattern="random", stop="standard_error")
    error = image.color[..., 0] - expected
    share = (np.abs(error) <= image.half_width).mean()
    assert abs(share - 0.95) < 4 * np.sqrt(0.95 * 0.05 / error.size)
    # The mean of 576 pixels' errors is within four of its standard errors: no bias.
    assert abs(error.mean()) < 4 * np.sqrt(np.mean((image.half_width / 1.96) ** 2) / error.size)


# ---- the two with negative lobes: everything that a film goes through ----


@pytest.mark.parametrize("pixel_filter", SIGNED)
def test_threads_tiles_crops_and_masks_change_no_bit(penumbra: sf.Scene, pixel_filter: str) -> None:
    options: dict[str, Any] = {"spp": 40, "pixel_filter": pixel_filter}
    whole = sf.render(penumbra, 48, 40, threads=1, **options)
    assert_same_film(whole, sf.render(penumbra, 48, 40, threads=3, tile_size=8, **options))
    crop = sf.render(penumbra, 48, 40, crop=(5, 3, 29, 22), **options)
    assert np.array_equal(crop.color, whole.color[3:22, 5:29])
    assert np.array_equal(crop.half_width, whole.half_width[3:22, 5:29])
    mask = np.zeros((40, 48), bool)
    mask[7:20, 9:30] = True
    masked = sf.render(penumbra, 48, 40, mask=mask, **options)
    assert np.array_equal(masked.color[mask], whole.color[mask])


@pytest.mark.parametrize("pixel_filter", SIGNED)
@pytest.mark.parametrize("stop", ["dyadic", "replicates", "standard_error"])
def test_a_stopped_render_goes_on_bit_for_bit(penumbra: sf.Scene, tmp_path: Path, pixel_filter: str, stop: str) -> None:
    options: dict[str, Any] = {"tolerance": 0.03, "max_spp": 512, "pixel_filter": pixel_filter, "stop": stop}
    whole = sf.render(penumbra, 32, 32, **options)
    file = tmp_path / "a.ckpt"
    part = sf.render(penumbra, 32, 32, checkpoint=file, progress=lambda p: p.round < 1, **options)
    assert part.interrupted
    assert np.array_equal(sf.merge([file]).color, part.color)
    assert_same_film(whole, sf.render(penumbra, 32, 32, checkpoint=file, **options))


@pytest.mark.parametrize("pixel_filter", SIGNED)
def test_a_longer_render_and_one_in_parts(penumbra: sf.Scene, tmp_path: Path, pixel_filter: str) -> None:
    file = tmp_path / "a.ckpt"
    sf.render(penumbra, 32, 32, spp=32, pixel_filter=pixel_filter, checkpoint=file)
    longer = sf.render(penumbra, 32, 32, spp=96, pixel_filter=pixel_filter, checkpoint=file)
    assert_same_film(longer, sf.render(penumbra, 32, 32, spp=96, pixel_filter=pixel_filter))
    other = tmp_path / "b.ckpt"
    sf.render(penumbra, 32, 32, spp=96, seed=5, pixel_filter=pixel_filter, checkpoint=other)
    merged = sf.merge([file, other])
    parts = [longer, sf.merge([other])]
    assert (merged.samples == 192).all()
    # Not the mean of the two means: the parts of either sign merge. They differ by how far the shares of
    # negative samples are off, which is little beside the half-width.
    middle = (parts[0].color.astype(float) + parts[1].color) / 2
    assert (np.abs(merged.color - middle).mean(axis=2) <= merged.half_width).mean() > 0.99
    assert np.allclose(merged.half_width, np.hypot(parts[0].half_width, parts[1].half_width) / 2, rtol=1e-6)


@pytest.mark.parametrize("pixel_filter", SIGNED)
def test_budgets_spend_what_they_have(penumbra: sf.Scene, pixel_filter: str) -> None:
    image = sf.render(penumbra, 32, 32, samples=200_000, pixel_filter=pixel_filter)
    assert 100_000 < image.samples.sum() <= 200_000
    assert image.samples.max() > image.samples.min()
    assert_same_film(image, sf.render(penumbra, 32, 32, samples=200_000, pixel_filter=pixel_filter, threads=1))


@pytest.mark.parametrize("pixel_filter", SIGNED)
def test_halves_meet_at_the_mean_nearly(penumbra: sf.Scene, pixel_filter: str) -> None:
    image = sf.render(penumbra, 32, 32, spp=128, pixel_filter=pixel_filter, aovs=("half_a", "half_b"))
    off = np.abs((image.aovs["half_a"] + image.aovs["half_b"]) / 2 - image.color).mean(axis=2)
    assert (off <= 0.5 * image.half_width + 1e-6).mean() > 0.95


@pytest.mark.parametrize("pixel_filter", sf.PIXEL_FILTERS)
def test_half_widths_cover_on_penumbra(penumbra: sf.Scene, pixel_filter: str) -> None:
    options: dict[str, Any] = {"pixel_filter": pixel_filter, "crop": (48, 48, 80, 80)}
    truth = sf.render(penumbra, 128, 128, spp=4096, seed=99, **options)
    image = sf.render(penumbra, 128, 128, tolerance=0.03, **options)
    error = np.abs(image.color.mean(axis=2) - truth.color.mean(axis=2))
    # docs/render.md has the figures of whole pictures, 0.98 and more.
    assert (error <= image.half_width).mean() > 0.95
