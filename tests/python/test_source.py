# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Tests of source: what a file may refer to, and how much it may ask for."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

import sunfleck as sf
from sunfleck.io.image import read_radiance
from sunfleck.io.source import Source


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """A file in a folder, with files beside, below and outside of it."""
    for name in ("model/room.gltf", "model/beside.bin", "model/below/deep.bin", "outside.bin", "model-2/near.bin"):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(name.encode())
    return tmp_path / "model" / "room.gltf"


@pytest.mark.parametrize("reference", ["beside.bin", "./beside.bin", "below/../beside.bin", "../model/beside.bin"])
def test_files_in_the_folder_are_read(model: Path, reference: str) -> None:
    assert Source(model).read_beside(reference) == b"model/beside.bin"


def test_files_below_the_folder_are_read(model: Path) -> None:
    assert Source(model).read_beside("below/deep.bin") == b"model/below/deep.bin"


def test_a_relative_path_has_a_folder_too(model: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(model.parent)
    assert Source("room.gltf").read_beside("beside.bin") == b"model/beside.bin"


@pytest.mark.parametrize(
    "reference", ["../outside.bin", "../model-2/near.bin", "below/../../outside.bin", "{}", "link"]
)
def test_files_outside_are_refused_unless_that_is_allowed(model: Path, reference: str) -> None:
    reference = reference.format(model.parent.parent / "outside.bin")
    (model.parent / "link").symlink_to(model.parent.parent / "outside.bin")
    with pytest.raises(ValueError, match="outside of its folder"):
        Source(model).read_beside(reference)
    assert Source(model, allow_outside=True).read_beside(reference) in (b"outside.bin", b"model-2/near.bin")


def test_a_link_to_a_folder_outside_is_refused(model: Path) -> None:
    (model.parent / "up").symlink_to("..")
    with pytest.raises(ValueError, match="outside of its folder"):
        Source(model).read_beside("up/outside.bin")


def test_a_link_within_the_folder_is_followed(model: Path) -> None:
    (model.parent / "link.bin").symlink_to("below/deep.bin")
    assert Source(model).read_beside("link.bin") == b"model/below/deep.bin"


def test_a_folder_that_is_a_link_is_the_one_it_leads_to(model: Path, tmp_path: Path) -> None:
    (tmp_path / "other").symlink_to("model")
    assert Source(tmp_path / "other" / "room.gltf").read_beside("beside.bin") == b"model/beside.bin"


def test_whether_a_file_outside_exists_is_not_told(model: Path) -> None:
    for reference in ("../outside.bin", "../nothing.bin"):
        with pytest.raises(ValueError, match="outside of its folder"):
            Source(model).locate(reference)


def test_a_missing_file_is_told_by_its_own_error(model: Path) -> None:
    with pytest.raises(FileNotFoundError):
        Source(model).read_beside("nothing.bin")


def test_what_is_no_file_is_refused_at_once(model: Path) -> None:
    os.mkfifo(model.parent / "pipe")
    for reference in ("pipe", "below", "."):
        with pytest.raises(OSError, match="is not a file"):
            Source(model).read_beside(reference)
    with pytest.raises(OSError, match="is not a file"):
        Source(model, allow_outside=True).read_beside("/dev/zero")
    with pytest.raises(OSError, match="is not a file"):
        Source(model.parent / "pipe").read()


def test_a_reference_with_a_null_character_is_refused(model: Path) -> None:
    with pytest.raises(ValueError, match="null character"):
        Source(model).read_beside("beside.bin\0")


def test_bytes_are_counted_over_all_files_and_arrays(model: Path) -> None:
    source = Source(model, limits=sf.Limits(bytes=40))
    assert source.read() == b"model/room.gltf"
    source.read_beside("beside.bin")
    with pytest.raises(ValueError, match=r"asks for 47 bytes in all; at most 40 are read.*Limits\(bytes=\.\.\.\)"):
        source.read_beside("beside.bin")
    with pytest.raises(ValueError, match="asks for 41 bytes"):
        Source(model, limits=sf.Limits(bytes=40)).take_bytes(41)


def test_a_sparse_file_beyond_the_limit_is_refused_before_it_is_read(model: Path) -> None:
    with open(model.parent / "huge.bin", "wb") as file:
        file.truncate(1 << 40)
    with pytest.raises(ValueError, match="asks for 1,099,511,627,776 bytes"):
        Source(model).read_beside("huge.bin")


def test_triangles_and_instances_add_up_and_pictures_stand_alone(model: Path) -> None:
    source = Source(model, limits=sf.Limits(triangles=3, instances=3, pixels=6))
    source.take_triangles(2)
    source.take_instances(2)
    with pytest.raises(ValueError, match="asks for 4 triangles"):
        source.take_triangles(2)
    with pytest.raises(ValueError, match="asks for 4 instances"):
        source.take_instances(2)
    source.take_picture(2, 3)
    source.take_picture(3, 2)
    with pytest.raises(ValueError, match="asks for 8 pixels in a picture of 2 x 4"):
        source.take_picture(2, 4)


def test_limits_of_the_wrong_kind_are_refused(model: Path) -> None:
    with pytest.raises(TypeError, match="triangles is 'many'"):
        sf.Limits(triangles="many")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="bytes is -1"):
        sf.Limits(bytes=-1)
    with pytest.raises(TypeError, match="limits is 5"):
        Source(model, limits=5)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="allow_outside is 1"):
        Source(model, allow_outside=1)  # type: ignore[arg-type]


def test_radiance_is_read_within_limits(tmp_path: Path) -> None:
    path = tmp_path / "sky.pfm"
    path.write_bytes(b"PF\n4 2\n-1.0\n" + np.ones((2, 4, 3), "<f4").tobytes())
    assert read_radiance(path).shape == (2, 4, 3)
    with pytest.raises(ValueError, match=r"sky\.pfm': it asks for 8 pixels in a picture of 4 x 2"):
        read_radiance(path, sf.Limits(pixels=7))
    with pytest.raises(ValueError, match="asks for 192 bytes"):
        read_radiance(path, sf.Limits(bytes=191))
    os.mkfifo(tmp_path / "pipe.exr")
    with pytest.raises(OSError, match="is not a file"):
        read_radiance(tmp_path / "pipe.exr")
