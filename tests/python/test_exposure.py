# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""exposure: what a PNG shows of radiance, and what is said of pictures that show nothing."""

from __future__ import annotations

import logging
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
import pytest

import sunfleck as sf
from gltf_files import CAMERA, SQUARE, box, write_gltf
from sunfleck.exposure import auto_exposure, encode_srgb

FLOOR = sf.Mesh([[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]], [[0, 1, 2], [0, 2, 3]], (0.5, 0.5, 0.5))
ABOVE = sf.Camera((0, 0, 3), (0, 0, 0))


def shown(path: Path) -> np.ndarray:
    return np.asarray(oiio.ImageBuf(str(path)).get_pixels(oiio.UINT8))


def radiance(path: Path) -> np.ndarray:
    return np.asarray(oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT))


def floor_under(irradiance: float, **options: Any) -> sf.Image:
    """Radiance irradiance / 2 pi everywhere."""
    scene = sf.Scene([FLOOR], ABOVE, suns=[sf.Sun((0, 0, 1), 0, (irradiance,) * 3)], **options)
    return sf.render(scene, 16, 16, spp=4)


@pytest.fixture
def sun_in_lux(tmp_path: Path) -> Path:
    """A sun of 3 W/m2 as exporters write it, over a floor with a box."""
    nodes: list[dict[str, Any]] = [
        {"mesh": 0},
        {"mesh": 1},
        {"camera": 0, "translation": [0, 0.7, 4]},
        {"rotation": [-0.5, 0.2, 0.1, 0.83], "extensions": {"KHR_lights_punctual": {"light": 0}}},
    ]
    lights = [{"type": "directional", "intensity": 2049}]
    return write_gltf(
        tmp_path,
        [(*SQUARE, 0), (*box((-0.3, 0, -0.3), (0.3, 0.6, 0.3)), 0)],
        nodes,
        cameras=[CAMERA],
        extensions={"KHR_lights_punctual": {"lights": lights}},
    )


def test_stops_are_powers_of_two(tmp_path: Path) -> None:
    image = floor_under(1.0)
    for stops in (-1.5, 0, 2):
        image.save(tmp_path / "t.png", exposure=stops)
        assert np.array_equal(shown(tmp_path / "t.png"), encode_srgb(image.color * np.float32(2.0**stops)))


def test_auto_brings_what_is_lit_to_four_fifths_of_white(tmp_path: Path) -> None:
    assert auto_exposure(np.full((4, 4, 3), 100, np.float32)) == pytest.approx(np.log2(0.008))
    assert auto_exposure(np.zeros((4, 4, 3), np.float32)) == 0
    mixed = np.zeros((100, 3), np.float32)
    mixed[:20] = 3  # a fifth is lit, the rest is night
    mixed[0] = 1e9  # and one lamp
    assert auto_exposure(mixed) == pytest.approx(np.log2(0.8 / 3))
    floor_under(1e5).save(tmp_path / "t.png", exposure="auto")
    assert (np.abs(shown(tmp_path / "t.png").astype(int) - int(encode_srgb(0.8))) <= 1).all()


def test_a_sun_in_lux_is_exposed_by_itself_and_that_is_said(
    sun_in_lux: Path, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    scene = sf.load(sun_in_lux)
    assert scene.exposure == "auto"
    assert len(scene.shapes) == 2
    image = sf.render(scene, 32, 32, spp=16)
    with caplog.at_level(logging.INFO, "sunfleck"):
        image.save(tmp_path / "t.png")
    assert "exposure -9." in caplog.text
    assert not [record for record in caplog.records if record.levelno > logging.INFO]
    pixels = shown(tmp_path / "t.png")
    covered = image.alpha > 0.5
    assert (pixels[covered] == 255).mean() < 0.3
    assert pixels[covered].mean() > 100
    assert image._repr_png_() == (tmp_path / "t.png").read_bytes()
    image.save(tmp_path / "t.exr")
    assert np.array_equal(radiance(tmp_path / "t.exr")[..., :3], image.color)


def test_the_exposure_of_other_scenes_is_zero(picture: sf.Image, tmp_path: Path) -> None:
    assert (sf.scenes.penumbra().exposure, picture.exposure) == (0, 0)
    picture.save(tmp_path / "t.png")
    assert np.array_equal(shown(tmp_path / "t.png"), encode_srgb(picture.color))


def test_merged_images_keep_the_exposure(sun_in_lux: Path) -> None:
    scene = sf.load(sun_in_lux)
    parts = [sf.render(scene, 8, 8, spp=16, seed=seed) for seed in (1, 2)]
    assert sf.merge(parts).exposure == "auto"


@pytest.mark.parametrize(
    ("exposure", "error"), [("bright", ValueError), (1e9, ValueError), (float("nan"), ValueError), ([1], TypeError)]
)
def test_other_exposures_are_refused(picture: sf.Image, tmp_path: Path, exposure: Any, error: type[Exception]) -> None:
    with pytest.raises(error, match="exposure is"):
        picture.save(tmp_path / "t.png", exposure=exposure)
    with pytest.raises(error, match="exposure is"):
        sf.Scene([FLOOR], ABOVE, exposure=exposure)
    assert not (tmp_path / "t.png").exists()


def test_radiance_is_not_exposed(picture: sf.Image, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"only a \.png is exposed"):
        picture.save(tmp_path / "t.exr", exposure=1)


# ---- pictures that show nothing ----


def said(caplog: pytest.LogCaptureFixture) -> list[str]:
    return [record.getMessage() for record in caplog.records if record.levelno >= logging.WARNING]


SUN = sf.Sun((0, 0, 1), 0, (1, 1, 1))
AWAY = sf.Camera((0, 0, 3), (0, 0, 9), (0, 1, 0))
BELOW = sf.Sun((0, 0, -1), 0, (1, 1, 1))


@pytest.mark.parametrize(
    ("scene", "why"),
    [
        (lambda: sf.Scene([FLOOR], ABOVE), "nothing in the scene shines"),
        (lambda: sf.Scene([FLOOR], AWAY, suns=[SUN]), "sees none"),
        (lambda: sf.Scene([FLOOR], ABOVE, suns=[SUN], max_bounces=0), "max_bounces is 0"),
        (lambda: sf.Scene([FLOOR], ABOVE, suns=[BELOW]), "does not reach what the camera sees"),
    ],
)
def test_a_black_picture_says_why(scene: Any, why: str, caplog: pytest.LogCaptureFixture) -> None:
    sf.render(scene(), 8, 8, spp=4)
    [message] = said(caplog)
    assert message.startswith("the picture is wholly black: ")
    assert why in message


def test_a_white_or_black_png_says_why(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    floor_under(1e4).save(tmp_path / "t.png")
    floor_under(1e-4).save(tmp_path / "t.png")
    white, black = said(caplog)
    assert "wholly white with an exposure of 0 stops" in white
    assert "radiance of about 1.59e+03; exposure='auto' would be -10.9" in white
    assert "wholly black" in black
    assert "exposure='auto' would be 15.6" in black


def test_pictures_that_show_something_are_passed_over(
    picture: sf.Image, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    picture.save(tmp_path / "t.png")
    floor_under(1.0).save(tmp_path / "t.png")
    assert said(caplog) == []


# ---- the command ----


def run(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "sunfleck", "render", *arguments, "--width", "16", "--height", "16", "--spp", "16"]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False, cwd=cwd)


def test_the_command_exposes_pngs_alone(sun_in_lux: Path) -> None:
    folder = sun_in_lux.parent
    auto = run("t.gltf", "-o", "auto.png", "-o", "t.exr", cwd=folder)
    assert auto.returncode == 0, auto.stderr
    assert "auto.png: exposure -9." in auto.stderr
    given = run("t.gltf", "-o", "given.png", "-o", "u.exr", "--exposure=-12", cwd=folder)
    assert given.returncode == 0, given.stderr
    assert shown(folder / "given.png").max() < shown(folder / "auto.png").max()
    exr = [radiance(folder / name) for name in ("t.exr", "u.exr")]
    assert np.array_equal(exr[0][..., :3], exr[1][..., :3])
    for wrong in (["-o", "t.exr", "--exposure", "auto"], ["-o", "t.png", "--exposure", "bright"]):
        refused = run("t.gltf", *wrong, cwd=folder)
        assert refused.returncode == 2
        assert "--exposure is" in refused.stderr


def test_the_command_s_options_of_files(tmp_path: Path) -> None:
    (tmp_path / "model").mkdir()
    cube = box((-0.5, 0, -0.5), (0.5, 1, 0.5))
    nodes: list[dict[str, Any]] = [
        {"mesh": 0},
        {"camera": 0, "translation": [0, 0.5, 3], "name": "near"},
        {"camera": 0, "translation": [0, 0.5, 30], "name": "far"},
    ]
    path = write_gltf(tmp_path / "model", [(*cube, 0)], nodes, cameras=[CAMERA])
    near = run("t.gltf", "-o", "near.exr", cwd=path.parent)
    assert "2 cameras: 0 'near', 1 'far'" in near.stderr
    for name, wanted in (("far.exr", "far"), ("one.exr", "1")):
        assert run("t.gltf", "-o", name, "--camera", wanted, cwd=path.parent).returncode == 0
    alpha = {name: radiance(path.parent / f"{name}.exr")[..., 3].sum() for name in ("near", "far", "one")}
    assert alpha["near"] > 20 * alpha["far"]
    assert alpha["far"] == alpha["one"]
    text = path.read_text()
    (tmp_path / "outside.bin").write_bytes(b"\0" * 400)
    path.write_text(text.replace(text[text.index("data:") : text.index('"', text.index("data:"))], "../outside.bin"))
    assert "outside of its folder" in run("t.gltf", "-o", "t.exr", cwd=path.parent).stderr
    assert "one point" in run("t.gltf", "-o", "t.exr", "--allow-outside", cwd=path.parent).stderr
    path.write_text(text)
    assert "12 triangles" in run("t.gltf", "-o", "t.exr", "--limits", "triangles=11,bytes=1e9", cwd=path.parent).stderr
    assert "--limits has 'wheels=4'" in run("t.gltf", "-o", "t.exr", "--limits", "wheels=4", cwd=path.parent).stderr
    assert "'cornell' is a built-in scene" in run("cornell", "-o", "t.exr", "--camera", "0", cwd=path.parent).stderr
