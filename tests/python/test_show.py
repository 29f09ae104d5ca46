# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""show: images, point sets and heat maps as pictures: what is drawn, and that every eye can tell it apart."""

import base64
import itertools
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import OpenImageIO as oiio
import pytest
from matplotlib.colors import LogNorm, to_rgb

import sunfleck as sf
from sunfleck.plot import heatmap as heatmaps
from sunfleck.plot.figure import Figure

GREY = to_rgb("#BBBBBB")


def pixels_of(data: bytes, folder: Path) -> Any:
    path = folder / "read.png"
    path.write_bytes(data)
    return oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)


def colors_of(figure: Figure, height: int, width: int, folder: Path) -> Any:
    """The colour of every pixel of the image, where the figure's axes say that it is."""
    drawn = pixels_of(figure.png(), folder)[..., :3]
    box = figure.drawn.axes[0].get_window_extent()
    x = box.x0 + (np.arange(width) + 0.5) * box.width / width
    y = len(drawn) - box.y1 + (np.arange(height) + 0.5) * box.height / height
    return drawn[np.ix_(y.astype(int), x.astype(int))]


def expected(values: Any, colors: str) -> Any:
    return matplotlib.colormaps[colors](LogNorm(values.min(), values.max())(values))[..., :3]


def test_an_image_shows_what_it_saves(picture: sf.Image, tmp_path: Path) -> None:
    picture.save(tmp_path / "saved.png")
    assert picture._repr_png_() == (tmp_path / "saved.png").read_bytes()


def test_a_heat_map_has_every_pixel_in_its_place(picture: sf.Image, tmp_path: Path) -> None:
    figure = picture.heatmap("samples")
    height, width = picture.samples.shape
    assert len(np.unique(picture.samples)) > 2
    found = colors_of(figure, height, width, tmp_path)
    # Half a step of 8 bits, and one of the 256 colours of the map.
    assert np.abs(found - expected(picture.samples.astype(float), "viridis")).max() < 0.5 / 255 + 2 / 255
    found = colors_of(picture.heatmap("half_width"), height, width, tmp_path)
    known = picture.half_width > 0
    wanted = expected(picture.half_width[known].astype(float), "cividis")
    assert np.abs(found[known] - wanted).max() < 0.5 / 255 + 2 / 255


def test_a_heat_map_in_svg_holds_every_pixel(penumbra: sf.Scene, tmp_path: Path) -> None:
    image = sf.render(penumbra, 256, 200, spp=2)  # drawn at 1.4 units a pixel: resampled, some would be lost
    with matplotlib.rc_context({"savefig.dpi": 37, "figure.dpi": 50}):
        image.heatmap("samples").save(tmp_path / "map.svg")
        assert image.heatmap("samples").drawn.axes[0].get_window_extent().width == pytest.approx(512)
        assert pixels_of(image.heatmap("samples").png(), tmp_path).shape[1] > 512
    embedded = re.findall(r"base64,([^\"]*)", (tmp_path / "map.svg").read_text())
    assert pixels_of(base64.b64decode(embedded[0]), tmp_path).shape[:2] == (200, 256)


def test_a_heat_map_says_what_it_shows(picture: sf.Image) -> None:
    def words(figure: Figure) -> str:
        return " ".join(text.get_text() for text in figure.drawn.findobj(matplotlib.text.Text))

    assert "samples a pixel" in words(picture.heatmap("samples"))
    tolerance = float(picture.metadata["tolerance"])
    assert f"half-width at 95 %, linear radiance\n(line: tolerance {tolerance:.3g})" in words(
        picture.heatmap("half_width")
    )
    assert picture.summary().share_met == 1
    assert "met: 100 %" in words(picture.heatmap("stop_reason"))


def test_a_heat_map_has_the_full_frame_s_coordinates(penumbra: sf.Scene) -> None:
    image = sf.render(penumbra, 64, 48, spp=2, crop=(8, 16, 40, 32))
    ax = image.heatmap("samples").drawn.axes[0]
    assert (ax.get_xlim(), ax.get_ylim()) == ((8, 40), (32, 16))


def test_what_is_unknown_is_grey(penumbra: sf.Scene, tmp_path: Path) -> None:
    mask = np.zeros((24, 40), bool)
    mask[:, :20] = True
    image = sf.render(penumbra, 40, 24, spp=16, mask=mask)
    for channel in ("samples", "half_width"):
        found = colors_of(image.heatmap(channel), 24, 40, tmp_path)
        grey = np.abs(found - GREY).max(axis=2) < 1 / 255
        assert np.array_equal(grey, ~mask)
    one = sf.render(penumbra, 40, 24, spp=1)
    assert np.abs(colors_of(one.heatmap("half_width"), 24, 40, tmp_path) - GREY).max() < 1 / 255


def test_each_stop_reason_has_its_colour(tmp_path: Path) -> None:
    count = len(sf.STOP_REASONS)
    channels: dict[str, Any] = {
        "stop_reason": np.arange(count, dtype=np.uint8)[None],
        "samples": np.ones((1, count), np.uint32),
    }
    figure = heatmaps.heatmap(channels, "stop_reason", {"crop": "0 0 7 1"})
    found = colors_of(figure, 1, count, tmp_path)[0]
    wanted = [to_rgb(heatmaps._REASON_COLORS[name]) for name in sf.STOP_REASONS]
    assert np.abs(found - np.array(wanted)).max() < 1 / 255
    shares = {text.get_text() for text in figure.drawn.axes[0].get_legend().get_texts()}
    assert shares == {f"{name.replace('_', ' ')}: 14.28 %" for name in sf.STOP_REASONS}
    # Nothing of the legend is cut off.
    legend = figure.drawn.axes[0].get_legend().get_window_extent()
    assert legend.x1 <= figure.drawn.bbox.x1


def test_only_a_whole_is_called_100_percent() -> None:
    reasons = np.full((300, 400), sf.STOP_REASONS.index("met"), np.uint8)
    reasons[7, 9] = sf.STOP_REASONS.index("suspicious")
    channels: dict[str, Any] = {"stop_reason": reasons, "samples": np.ones_like(reasons)}
    figure = heatmaps.heatmap(channels, "stop_reason", {"crop": "0 0 400 300"})
    texts = [text.get_text() for text in figure.drawn.axes[0].get_legend().get_texts()]
    assert texts == ["met: 99.99 %", "suspicious: < 0.01 %"]


# Machado, Oliveira & Fernandes 2009, "A physiologically-based model for simulation of color vision
# deficiency", table 1, severity 1: linear RGB as those see it who lack one kind of cone.
SIGHT = {
    "all cones": np.eye(3),
    "protanopia": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranopia": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritanopia": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}


def lab(srgb: Any, sight: Any) -> Any:
    """CIE L*a*b* (D65) of sRGB colours under a kind of sight."""
    srgb = np.asarray(srgb)
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    seen = np.clip(linear @ np.asarray(sight).T, 0, 1)
    xyz = (
        seen
        @ np.array(
            [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
        ).T
    )
    t = xyz / [0.95047, 1.0, 1.08883]
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.stack([116 * f[..., 1] - 16, 500 * (f[..., 0] - f[..., 1]), 200 * (f[..., 1] - f[..., 2])], axis=-1)


@pytest.mark.parametrize("sight", SIGHT)
def test_stop_reasons_are_told_apart_with_any_sight(sight: str) -> None:
    colors = lab([to_rgb(color) for color in heatmaps._REASON_COLORS.values()], SIGHT[sight])
    nearest = min(float(np.linalg.norm(a - b)) for a, b in itertools.combinations(colors, 2))
    assert nearest > 10  # 2.3 is a just noticeable difference (Mahy et al. 1994)


@pytest.mark.parametrize("sight", SIGHT)
@pytest.mark.parametrize("colors", ["viridis", "cividis"])
def test_scales_grow_lighter_with_any_sight(sight: str, colors: str) -> None:
    lightness = lab(matplotlib.colormaps[colors](np.linspace(0, 1, 33))[:, :3], SIGHT[sight])[:, 0]
    assert (np.diff(lightness) > 0).all()
    assert lightness[-1] - lightness[0] > 60


def test_points_are_drawn_where_they_are() -> None:
    points = sf.points("sobol", 64)
    figure = sf.show(points)
    [ax] = figure.drawn.axes
    assert np.array_equal(np.stack(ax.lines[0].get_data(), axis=1), points.astype(float))
    assert (ax.get_xlim(), ax.get_ylim()) == ((0, 1), (0, 1))
    beyond = sf.show(sf.mapping.pixel_gaussian.sample(points)).drawn.axes[0]
    assert beyond.get_xlim()[1] > 1


def test_points_of_space_are_seen_from_above_with_the_near_half_dark() -> None:
    from sunfleck.plot.show import seen

    flat, near = seen(np.eye(3))
    # A turned view: lengths and angles of space are those of (right, up, near).
    turned = np.column_stack([flat, near])
    assert turned @ turned.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(turned) == pytest.approx(1)
    assert flat[2, 0] == pytest.approx(0)  # z is up,
    assert flat[2, 1] > 0.8
    assert near[2] > 0.3  # and seen from above
    [ax] = sf.show(sf.mapping.sphere.sample(sf.points("jittered", 400))).drawn.axes
    far, dark = (len(line.get_xdata()) for line in ax.lines)
    assert far + dark == 400
    assert abs(dark - 200) < 40  # half; jittered points deviate less than random ones, of which 40 is four sigma


def test_several_sets_side_by_side(tmp_path: Path) -> None:
    figure = sf.show({name: sf.points(name, 64) for name in sf.PATTERNS if name != "orthogonal"}, columns=4)
    assert [ax.get_title() for ax in figure.drawn.axes][:2] == list(sf.PATTERNS)[:2]
    figure.save(tmp_path / "sets.svg")
    assert (tmp_path / "sets.svg").read_text().startswith("<?xml")
    assert figure._repr_png_().startswith(b"\x89PNG")


def test_what_can_t_be_shown_is_refused(picture: sf.Image, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"shape \(8, 5\)"):
        sf.show(sf.points("random", 8, 5))
    with pytest.raises(ValueError, match="no sets"):
        sf.show({})
    with pytest.raises(TypeError, match="'words' has dtype"):
        sf.show({"words": [["a", "b"]]})
    with pytest.raises(ValueError, match="channel is 'R'; heat maps are drawn of samples"):
        picture.heatmap("R")
    with pytest.raises(ValueError, match=r"\.jpg"):
        picture.heatmap("samples").save(tmp_path / "x.jpg")


def run(folder: Path, *arguments: str, before: str = "") -> subprocess.CompletedProcess[str]:
    script = f"import sys; {before}\nfrom sunfleck.cli import main\nsys.exit(main(sys.argv[1:]))"
    command = [sys.executable, "-c", script, "render", "--width", "16", "--height", "16", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False, cwd=folder)


def test_the_command_line_s_heat_maps(tmp_path: Path) -> None:
    result = run(tmp_path, "--spp", "4", "-o", "a.exr", "-o", "b.png", "--heatmap", "samples, half_width,stop_reason")
    assert (result.returncode, result.stderr) == (0, "")
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {"a.exr", "b.png", "a.samples.png", "a.half_width.png", "a.stop_reason.png"}
    expected = sf.render(sf.scenes.penumbra(), 16, 16, spp=4).heatmap("half_width").png()
    found = (tmp_path / "a.half_width.png").read_bytes()
    assert np.array_equal(pixels_of(found, tmp_path), pixels_of(expected, tmp_path))


def test_the_command_line_refuses_heat_maps_before_any_work(tmp_path: Path) -> None:
    for words, before in (
        (("--heatmap", "samples,depth"), ""),
        (("--heatmap", "samples"), "sys.modules['matplotlib'] = None"),
    ):
        result = run(tmp_path, "-o", "a.exr", *words, before=before)
        assert result.returncode == 2
        assert result.stderr.startswith("sunfleck: error: ")
        assert "depth" in result.stderr or "pip install 'sunfleck[chart]'" in result.stderr
        assert not list(tmp_path.iterdir())
