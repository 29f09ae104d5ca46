# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""image: EXR and PNG read back, sRGB, false colours, and old files that survive a failure."""

import os
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

import sunfleck as sf
from sunfleck.io.image import encode_srgb, false_color


def read(path: Path) -> tuple[oiio.ImageSpec, np.ndarray]:
    source = oiio.ImageInput.open(str(path))
    assert source, oiio.geterror()
    spec = source.spec()
    pixels = source.read_image(spec.format)
    assert pixels is not None
    source.close()
    return spec, pixels


def test_an_exr_holds_every_channel_and_attribute(picture: sf.Image, tmp_path: Path) -> None:
    path = tmp_path / "out.exr"
    picture.save(path)
    spec, pixels = read(path)
    assert str(spec.format) == "float"
    assert (spec.width, spec.height) == (picture.width, picture.height)
    assert set(spec.channelnames) == {name for name, _ in picture.channels}
    assert spec.channelnames[:4] == ("R", "G", "B", "A")
    for name, expected in picture.channels:
        assert np.array_equal(pixels[..., spec.channelindex(name)], expected.astype(np.float32)), name
    attributes = {a.name: a.value for a in spec.extra_attribs if a.name.startswith("sunfleck:")}
    assert attributes == {f"sunfleck:{name}": text for name, text in picture.metadata.items()}
    assert len(attributes) >= 15
    assert len(list(tmp_path.iterdir())) == 1


def test_an_exr_holds_the_aovs_under_their_usual_names(penumbra: sf.Scene, tmp_path: Path) -> None:
    image = sf.render(penumbra, 33, 20, spp=32, aovs=sf.AOVS)
    image.save(tmp_path / "out.exr")
    spec, pixels = read(tmp_path / "out.exr")
    for name, layer, parts in (("albedo", "albedo", "RGB"), ("normal", "normal", "XYZ"), ("half_b", "half_b", "RGB")):
        for k, part in enumerate(parts):
            assert np.array_equal(pixels[..., spec.channelindex(f"{layer}.{part}")], image.aovs[name][..., k])
    assert np.array_equal(pixels[..., spec.channelindex("Z")], image.aovs["depth"])
    assert np.array_equal(pixels[..., spec.channelindex("variance")], image.aovs["variance"])
    image.save(tmp_path / "out.png")
    assert np.array_equal(read(tmp_path / "out.png")[1], encode_srgb(image.color))


def test_a_png_is_srgb(picture: sf.Image, tmp_path: Path) -> None:
    path = tmp_path / "out.PNG"
    picture.save(path)
    spec, pixels = read(path)
    assert (str(spec.format), spec.nchannels) == ("uint8", 3)
    assert np.array_equal(pixels, encode_srgb(picture.color))
    assert b"sRGB" in path.read_bytes()[:100]


def test_srgb_is_the_standards() -> None:
    # The standard's own: linear below 0.0031308; 0.5 encodes to 0.735357.
    assert encode_srgb([0.0, 0.002, 0.5, 1.0, 2.0, -1.0]).tolist() == [0, 7, 188, 255, 255, 0]
    # Decoded again, every one of the 256 codes is itself.
    codes = np.arange(256) / 255
    linear = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)
    assert encode_srgb(linear).tolist() == list(range(256))


def test_false_colours_run_from_dark_to_light_in_logarithmic_steps() -> None:
    colors = false_color(np.array([[1, 10, 100, 1000, 0, np.inf]]))[0].astype(int)
    assert colors[0].tolist() == [68, 1, 84]
    assert colors[3].tolist() == [253, 231, 37]
    luminance = colors @ (0.2126, 0.7152, 0.0722)
    assert luminance[0] < luminance[1] < luminance[2] < luminance[3]
    assert colors[4].tolist() == colors[0].tolist()
    assert colors[5].tolist() == [255, 255, 255]
    assert len(np.unique(false_color(np.full((2, 2), 7.0)))) == 3
    assert false_color(np.full((2, 2), np.inf)).min() == 255
    assert np.array_equal(false_color([[10.0]], low=1, high=100), false_color([[1, 10, 100]])[:, 1:2])


def test_maps_are_written(picture: sf.Image, tmp_path: Path) -> None:
    for name in ("samples", "half_width"):
        picture.save_map(name, tmp_path / f"{name}.png")
        assert np.array_equal(read(tmp_path / f"{name}.png")[1], false_color(dict(picture.channels)[name]))
    with pytest.raises(ValueError, match=r"depth.*half_width"):
        picture.save_map("depth", tmp_path / "depth.png")
    with pytest.raises(ValueError, match=r"\.exr.*\.png"):
        picture.save_map("samples", tmp_path / "samples.exr")


@pytest.mark.parametrize("name", ["out.jpg", "out", "out.exr.bak", ".exr"])
def test_other_endings_are_refused(picture: sf.Image, tmp_path: Path, name: str) -> None:
    with pytest.raises(ValueError, match=r"\.exr, \.png"):
        picture.save(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_unwritable_paths_are_os_errors(picture: sf.Image, tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="no folder"):
        picture.save(tmp_path / "missing" / "out.exr")
    (tmp_path / "folder.png").mkdir()
    with pytest.raises(OSError, match="not a file"):
        picture.save(tmp_path / "folder.png")
    with pytest.raises(TypeError, match="path"):
        picture.save(b"out.exr")  # type: ignore[arg-type]
    with pytest.raises(OSError):  # noqa: PT011
        picture.save(tmp_path / f"{'x' * 300}.exr")


def test_a_failure_leaves_the_old_file(picture: sf.Image, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise OSError("no space left")

    path = tmp_path / "out.exr"
    path.write_bytes(b"old")
    monkeypatch.setattr(os, "replace", fail)
    with pytest.raises(OSError, match="no space left"):
        picture.save(path)
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


FULL_DISK = """
    import resource, signal, sys
    import sunfleck as sf
    image = sf.render(sf.scenes.penumbra(), 128, 128, spp=2)
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
    try:
        image.save(sys.argv[1])
    except OSError as error:
        print(error)
"""


@pytest.mark.parametrize("name", ["out.exr", "out.png"])
def test_a_file_that_grows_too_large_leaves_the_old_one(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_bytes(b"old")
    script = textwrap.dedent(FULL_DISK)
    result = subprocess.run([sys.executable, "-c", script, str(path)], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    assert name in result.stdout or "large" in result.stdout
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_new_file_has_the_usual_permissions_and_links_are_followed(picture: sf.Image, tmp_path: Path) -> None:
    target, link = tmp_path / "target.exr", tmp_path / "link.exr"
    link.symlink_to(target)
    picture.save(link)
    assert link.is_symlink()
    assert target.is_file()
    umask = os.umask(0)
    os.umask(umask)
    assert target.stat().st_mode & 0o777 == 0o666 & ~umask
