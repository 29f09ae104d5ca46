# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""checkpoint: renders that are stopped, killed or out of disk and go on; films that merge."""

import logging
import os
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sunfleck as sf

FRAME = ["--width", "96", "--height", "96"]


def assert_same_film(a: sf.Image, b: sf.Image) -> None:
    for (name, ours), (_, theirs) in zip(a.channels, b.channels, strict=True):
        assert np.array_equal(ours, theirs), name


def script(text: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", textwrap.dedent(text)]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False, cwd=cwd)


# ---- resuming ----


DISK = np.hypot(*np.mgrid[-20:20, -25:25]) < 17


@pytest.mark.parametrize(
    "options",
    [
        {"spp": 200},
        {"tolerance": 0.03, "max_spp": 512},
        {"spp": 200, "aovs": sf.AOVS, "mask": DISK},
        {"tolerance": 0.03, "max_spp": 512, "unbiased": True, "aovs": "depth,half_b", "mask": DISK},
    ],
)
def test_a_render_that_progress_stopped_goes_on(penumbra: sf.Scene, tmp_path: Path, options: dict[str, Any]) -> None:
    whole = sf.render(penumbra, 50, 40, **options)
    for stop in range(1, whole.summary().rounds):
        path = tmp_path / f"{stop}.ckpt"

        def go_on(progress: sf.Progress, last: int = stop) -> bool:
            return progress.round < last

        part = sf.render(penumbra, 50, 40, checkpoint=path, threads=1, progress=go_on, **options)
        assert part.interrupted
        assert_same_film(whole, sf.render(penumbra, 50, 40, checkpoint=path, threads=2, tile_size=8, **options))
        assert [file.name for file in tmp_path.glob(f"{stop}.*")] == [path.name]  # nothing beside it


def test_a_checkpoint_is_the_picture_so_far(penumbra: sf.Scene, tmp_path: Path) -> None:
    path = tmp_path / "part.ckpt"
    part = sf.render(penumbra, 50, 40, spp=256, checkpoint=str(path), progress=lambda p: p.round < 2)
    assert_same_film(part, sf.merge([path]))


def test_more_samples_are_added_to_those_there(cornell: sf.Scene, tmp_path: Path) -> None:
    path = tmp_path / "grow.ckpt"
    for spp in (16, 64, 160):
        grown = sf.render(cornell, 32, 32, spp=spp, checkpoint=path)
        assert_same_film(sf.render(cornell, 32, 32, spp=spp), grown)


def test_a_tighter_tolerance_keeps_what_was_sampled(penumbra: sf.Scene, tmp_path: Path) -> None:
    path = tmp_path / "tight.ckpt"
    easy = sf.render(penumbra, 48, 48, tolerance=0.1, checkpoint=path)
    seen: list[int] = []
    tight = sf.render(penumbra, 48, 48, tolerance=0.03, checkpoint=path, progress=lambda p: seen.append(p.samples))
    assert (tight.samples >= easy.samples).all()
    assert tight.summary().samples > easy.summary().samples
    assert seen[0] >= easy.summary().samples  # none was taken again
    fresh = sf.render(penumbra, 48, 48, tolerance=0.03)
    assert tight.summary().tolerance == fresh.summary().tolerance


# ---- refusals ----


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"seed": 2}, "was made with seed 1; this render has seed 2"),
        ({"spp": 8}, r"spp 16; this render has spp 8 \(counts may only grow"),
        ({"pattern": "halton"}, "pattern sobol; this render has pattern halton"),
        ({"height": 32}, "height 24.*height 32"),
        ({"spp": None, "tolerance": 0.1}, "spp 16.*relative_tolerance 0.1"),
        ({"seeds": "thread"}, "checkpoint needs seeds pixel"),
        ({"checkpoint_seconds": -1.0}, "checkpoint_seconds is -1"),
        ({"checkpoint_seconds": float("nan")}, "checkpoint_seconds"),
        ({"checkpoint": ""}, "empty path"),
        ({"checkpoint": "a\0b"}, "null character"),
    ],
)
def test_what_does_not_match_is_named(penumbra: sf.Scene, tmp_path: Path, options: dict[str, Any], match: str) -> None:
    path = tmp_path / "made.ckpt"
    made: dict[str, Any] = {"width": 24, "height": 24, "spp": 16, "seed": 1, "checkpoint": path}
    sf.render(penumbra, **made)
    before = path.read_bytes()
    with pytest.raises(ValueError, match=match):
        sf.render(penumbra, **{**made, **options})
    assert path.read_bytes() == before


def test_another_mask_is_refused(penumbra: sf.Scene, tmp_path: Path) -> None:
    path = tmp_path / "mask.ckpt"
    whole = sf.render(penumbra, 50, 40, spp=32, mask=DISK, aovs="albedo,variance", checkpoint=path)
    kept = sf.merge([path])
    assert_same_film(whole, kept)
    for name in ("albedo", "variance"):
        assert np.array_equal(whole.aovs[name], kept.aovs[name])
    for mask in (None, ~DISK):
        with pytest.raises(ValueError, match="was made with mask"):
            sf.render(penumbra, 50, 40, spp=32, mask=mask, aovs="albedo,variance", checkpoint=path)
    with pytest.raises(ValueError, match="aov"):
        sf.render(penumbra, 50, 40, spp=32, mask=DISK, aovs="depth", checkpoint=path)


def test_a_second_set_does_not_grow(penumbra: sf.Scene, tmp_path: Path) -> None:
    path = tmp_path / "two.ckpt"
    made = sf.render(penumbra, 24, 24, tolerance=0.1, unbiased=True, checkpoint=path)
    with pytest.raises(ValueError, match="unbiased set, and its second set does not grow"):
        sf.render(penumbra, 24, 24, tolerance=0.05, unbiased=True, checkpoint=path)
    with pytest.raises(ValueError, match="unbiased"):
        sf.render(penumbra, 24, 24, tolerance=0.1, checkpoint=path)
    assert_same_film(made, sf.render(penumbra, 24, 24, tolerance=0.1, unbiased=True, checkpoint=path))
    budget = tmp_path / "budget.ckpt"
    sf.render(penumbra, 24, 24, samples=24 * 24 * 64, unbiased=True, checkpoint=budget)
    with pytest.raises(ValueError, match="does not grow"):
        sf.render(penumbra, 24, 24, samples=24 * 24 * 128, unbiased=True, checkpoint=budget)


def test_another_scene_is_refused(penumbra: sf.Scene, cornell: sf.Scene, tmp_path: Path) -> None:
    sf.render(penumbra, 16, 16, spp=4, checkpoint=tmp_path / "scene.ckpt")
    with pytest.raises(ValueError, match="was made with scene"):
        sf.render(cornell, 16, 16, spp=4, checkpoint=tmp_path / "scene.ckpt")


def test_what_is_no_checkpoint_is_refused_and_kept(penumbra: sf.Scene, tmp_path: Path) -> None:
    path = tmp_path / "notes.txt"
    path.write_text("not to be lost, and longer than the header of a checkpoint")
    with pytest.raises(OSError, match="is not a checkpoint"):
        sf.render(penumbra, 16, 16, spp=4, checkpoint=path)
    assert path.read_text().startswith("not to be lost")
    for wrong in (tmp_path, tmp_path / "missing" / "x.ckpt"):
        with pytest.raises(OSError, match=str(wrong)):
            sf.render(penumbra, 16, 16, spp=4, checkpoint=wrong)
    with pytest.raises(TypeError):
        sf.render(penumbra, 16, 16, spp=4, checkpoint=3)  # type: ignore[arg-type]


def test_a_link_is_followed(penumbra: sf.Scene, tmp_path: Path) -> None:
    (tmp_path / "disk").mkdir()
    link = tmp_path / "link.ckpt"
    sf.render(penumbra, 16, 16, spp=4, checkpoint=tmp_path / "disk" / "real.ckpt")
    link.symlink_to(tmp_path / "disk" / "real.ckpt")
    image = sf.render(penumbra, 16, 16, spp=32, checkpoint=link)
    assert link.is_symlink()
    assert_same_film(image, sf.merge([tmp_path / "disk" / "real.ckpt"]))


# ---- a full disk ----

FULL = """
    import logging, resource, sys
    import numpy as np
    import sunfleck as sf
    scene = sf.scenes.penumbra()
    sf.render(scene, 64, 64, spp=16, checkpoint="full.ckpt")
    before = open("full.ckpt", "rb").read()
    warned = []
    handler = logging.Handler()
    handler.emit = lambda record: warned.append(record.getMessage())
    logging.getLogger("sunfleck").addHandler(handler)
    resource.setrlimit(resource.RLIMIT_FSIZE, (len(before) // 2, resource.RLIM_INFINITY))
    try:
        sf.render(scene, 64, 64, spp=512, checkpoint="full.ckpt", checkpoint_seconds=0)
    except OSError as error:
        assert isinstance(error, sf.CheckpointError)
        image = error.image
    assert (image.samples == 512).all()
    assert len(warned) > 1 and all("full.ckpt" in text for text in warned), warned  # while it ran, and at the end
    assert open("full.ckpt", "rb").read() == before
    resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    image = sf.render(scene, 64, 64, spp=64, checkpoint="full.ckpt")
    assert np.array_equal(image.color, sf.render(scene, 64, 64, spp=64).color)
    print("kept")
"""


def test_a_write_that_fails_warns_raises_and_loses_nothing(tmp_path: Path) -> None:
    result = script(FULL, tmp_path)
    assert (result.returncode, result.stdout) == (0, "kept\n"), result.stderr


@pytest.fixture
def small_disk(tmp_path: Path) -> Any:
    folder = tmp_path / "disk"
    folder.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", str(folder)]
    if subprocess.run(command, capture_output=True, check=False).returncode != 0:
        pytest.skip("no right to mount a file system")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


def test_a_full_file_system_keeps_the_old_file(penumbra: sf.Scene, small_disk: Path) -> None:
    path = small_disk / "full.ckpt"
    sf.render(penumbra, 48, 48, spp=16, checkpoint=path)  # some 280 KB: no room for a second and this
    (small_disk / "other").write_bytes(bytes(600_000))
    before = path.read_bytes()
    with pytest.raises(sf.CheckpointError, match="No space left on device") as caught:
        sf.render(penumbra, 48, 48, spp=64, checkpoint=path)
    assert_same_film(caught.value.image, sf.render(penumbra, 48, 48, spp=64))
    assert path.read_bytes() == before
    assert not list(small_disk.glob("*.part"))


# ---- the command, interrupted and killed ----


SPP = 512  # half a second's work: no stop below comes after it


def command(folder: Path, *more: str) -> subprocess.Popen[str]:
    words = ["render", "cornell", *FRAME, "--spp", str(SPP), "--checkpoint", "box.ckpt", "-o", "box.exr", *more]
    arguments = [sys.executable, "-m", "sunfleck", *words]
    return subprocess.Popen(arguments, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def wait_for_write(path: Path, process: subprocess.Popen[str], after: int = 0) -> None:
    deadline = time.monotonic() + 30
    while process.poll() is None and time.monotonic() < deadline:
        if path.exists() and path.stat().st_mtime_ns > after:
            return
        time.sleep(0.005)


def color_of(folder: Path) -> np.ndarray:
    import OpenImageIO as oiio

    pixels = oiio.ImageBuf(str(folder / "box.exr")).get_pixels(oiio.FLOAT)
    assert pixels is not None
    return pixels[..., :3]


def test_ctrl_c_then_the_same_command_goes_on(cornell: sf.Scene, tmp_path: Path) -> None:
    process = command(tmp_path, "--checkpoint-seconds", "0")
    wait_for_write(tmp_path / "box.ckpt", process)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=30)
    assert process.returncode == 130, err
    part = sf.merge([tmp_path / "box.ckpt"])
    assert np.array_equal(part.color, color_of(tmp_path))
    assert 0 < part.summary().samples < SPP * 96 * 96
    process = command(tmp_path)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 0, err
    assert f"{SPP}.0 a pixel" in out
    assert np.array_equal(color_of(tmp_path), sf.render(cornell, 96, 96, spp=SPP).color)


def test_kills_at_any_moment_leave_a_file_that_goes_on(cornell: sf.Scene, tmp_path: Path) -> None:
    path, samples, after = tmp_path / "box.ckpt", [0], 0
    for wait in (0.0, 0.013, 0.061):
        process = command(tmp_path, "--checkpoint-seconds", "0", "--threads", "2")
        wait_for_write(path, process, after)
        time.sleep(wait)
        process.kill()
        process.communicate(timeout=30)
        samples.append(sf.merge([path]).summary().samples)
        after = time.time_ns()
    assert samples == sorted(samples)  # what was written once is never lost
    process = command(tmp_path)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 0, err
    assert os.listdir(tmp_path) in (["box.ckpt", "box.exr"], ["box.exr", "box.ckpt"])
    assert np.array_equal(color_of(tmp_path), sf.render(cornell, 96, 96, spp=SPP).color)


def test_the_command_refuses_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "box.ckpt").write_text("something else, to be kept as it is")
    process = command(tmp_path)
    out, err = process.communicate(timeout=30)
    assert (process.returncode, out) == (2, "")
    assert err == "sunfleck: error: 'box.ckpt' is not a checkpoint\n"


# ---- merging ----


def test_replicates_merge(penumbra: sf.Scene, tmp_path: Path) -> None:
    counts = (16, 48)
    parts = [sf.render(penumbra, 40, 30, spp=spp, seed=spp) for spp in counts]
    sf.render(penumbra, 40, 30, spp=48, seed=48, checkpoint=tmp_path / "b.ckpt")
    merged = sf.merge(parts)
    assert_same_film(merged, sf.merge([parts[0], tmp_path / "b.ckpt"]))
    mean = sum(n * part.color.astype(float) for n, part in zip(counts, parts, strict=True)) / 64
    square = sum((n * part.half_width.astype(float)) ** 2 for n, part in zip(counts, parts, strict=True))
    assert np.allclose(merged.color, mean, rtol=3e-7, atol=0)
    assert np.allclose(merged.half_width, np.sqrt(square) / 64, rtol=3e-7, atol=0)
    assert (merged.samples == 64).all()
    assert merged.summary().samples == 64 * 40 * 30
    assert merged.metadata["merged_seeds"] == "16 48"


def test_tiles_merge_to_the_frame(cornell: sf.Scene, tmp_path: Path) -> None:
    full = sf.render(cornell, 40, 30, spp=8)
    crops = [(0, 0, 21, 30), (21, 0, 40, 11), (21, 11, 40, 30)]
    tiles = [sf.render(cornell, 40, 30, spp=8, crop=crop) for crop in crops]
    assert_same_film(full, sf.merge(tiles))
    with pytest.raises(ValueError, match="none of the films"):
        sf.merge(tiles[:2])


def test_what_can_not_merge_is_refused(penumbra: sf.Scene, cornell: sf.Scene) -> None:
    a = sf.render(penumbra, 16, 16, spp=4)
    with pytest.raises(ValueError, match="films 1 and 2 both have seed 0"):
        sf.merge([a, a])
    with pytest.raises(ValueError, match="film 1 is of scene"):
        sf.merge([a, sf.render(cornell, 16, 16, spp=4, seed=1)])
    with pytest.raises(ValueError, match="16 x 16 pixels and film 2 of 17 x 16"):
        sf.merge([a, sf.render(penumbra, 17, 16, spp=4, seed=1)])
    with pytest.raises(ValueError, match="at least one"):
        sf.merge([])
    for wrong in (a, "a.ckpt", None):
        with pytest.raises(TypeError, match="list of images"):
            sf.merge(wrong)  # type: ignore[arg-type]
    with pytest.raises(TypeError):
        sf.merge([3])  # type: ignore[list-item]


def test_a_failed_write_in_between_is_a_warning(
    penumbra: sf.Scene, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    folder = tmp_path / "gone"
    folder.mkdir()

    def remove(progress: sf.Progress) -> None:
        if progress.round == 1:
            for file in folder.iterdir():
                file.unlink()
            folder.rmdir()

    with caplog.at_level(logging.WARNING, "sunfleck"), pytest.raises(sf.CheckpointError) as caught:
        sf.render(penumbra, 16, 16, spp=256, checkpoint=folder / "x.ckpt", checkpoint_seconds=0, progress=remove)
    assert len(caplog.records) > 1
    assert (caught.value.image.samples == 256).all()


def test_a_link_to_a_file_that_is_not_there_yet_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "disk").mkdir()
    link = tmp_path / "c.ckpt"
    link.symlink_to("disk/real.ckpt")
    sf.render(sf.scenes.penumbra(), 16, 16, spp=4, checkpoint=link)
    assert link.is_symlink()
    assert (tmp_path / "disk" / "real.ckpt").is_file()


def test_a_replaced_file_keeps_its_mode(tmp_path: Path) -> None:
    image = sf.render(sf.scenes.penumbra(), 16, 16, spp=4, checkpoint=tmp_path / "c.ckpt")
    image.save(tmp_path / "a.png")
    for name in ("c.ckpt", "a.png"):
        (tmp_path / name).chmod(0o600)
    sf.render(sf.scenes.penumbra(), 16, 16, spp=8, checkpoint=tmp_path / "c.ckpt").save(tmp_path / "a.png")
    for name in ("c.ckpt", "a.png"):
        assert (tmp_path / name).stat().st_mode & 0o777 == 0o600
