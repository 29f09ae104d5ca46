# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""cli: the command as a process: files, help, one-line errors, Ctrl-C."""

import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

import sunfleck as sf


def run(*arguments: str | Path, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "sunfleck", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False, cwd=cwd)


def pixels_of(path: Path) -> np.ndarray:
    pixels = oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)
    assert pixels is not None
    return pixels


def assert_refused(result: subprocess.CompletedProcess[str], *words: str) -> None:
    assert result.returncode == 2
    assert result.stdout == ""
    assert result.stderr.startswith("sunfleck: error: ")
    assert result.stderr.count("\n") == 1
    for word in words:
        assert word in result.stderr


def test_render_is_the_library_s(tmp_path: Path) -> None:
    exr, png = tmp_path / "out.exr", tmp_path / "out.png"
    options = ["--width", "48", "--height", "32", "--spp", "8", "--seed", "3", "--pixel-filter", "tent"]
    result = run("render", "cornell", *options, "--crop", "8", "0", "40", "24", "-o", exr, "-o", png)
    assert (result.returncode, result.stderr) == (0, "")
    assert "samples" in result.stdout
    expected = sf.render(sf.scenes.cornell(), 48, 32, spp=8, seed=3, pixel_filter="tent", crop=(8, 0, 40, 24))
    pixels = pixels_of(exr)
    assert np.array_equal(pixels[..., :3], expected.color)
    assert png.stat().st_size > 100
    commas = run("render", "cornell", *options, "--crop", "8,0,40,24", "-o", tmp_path / "two.exr")
    assert commas.returncode == 0
    assert np.array_equal(pixels_of(tmp_path / "two.exr"), pixels)


def test_render_with_aovs(tmp_path: Path) -> None:
    result = run("render", "--width", "16", "--height", "16", "--spp", "32", "--aov", "albedo,half_b", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    source = oiio.ImageInput.open(str(tmp_path / "penumbra.exr"))
    assert source
    names = source.spec().channelnames
    assert {"albedo.R", "albedo.G", "albedo.B", "half_b.R", "half_b.G", "half_b.B"} <= set(names)
    assert "Z" not in names


def test_render_s_defaults(tmp_path: Path) -> None:
    result = run("render", "--width", "16", "--height", "16", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["penumbra.exr"]
    assert "% of pixels met 0.01 at 95 %; worst " in result.stdout.splitlines()[0]


def test_render_of_a_file_says_what_it_was_given(tmp_path: Path) -> None:
    (tmp_path / "t.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    result = run("render", "t.obj", "--width", "16", "--height", "16", "--spp", "4", cwd=tmp_path)
    assert result.returncode == 0
    assert "sunfleck: t.obj: no camera in it" in result.stderr
    assert (tmp_path / "t.exr").is_file()


def test_render_under_an_environment(tmp_path: Path) -> None:
    import OpenImageIO as oiio

    sky = np.zeros((4, 8, 3), np.float32)
    sky[0] = 3  # from above alone
    output = oiio.ImageOutput.create(str(tmp_path / "sky.hdr"))
    assert output
    assert output.open(str(tmp_path / "sky.hdr"), oiio.ImageSpec(8, 4, 3, oiio.FLOAT))
    assert output.write_image(sky)
    output.close()
    (tmp_path / "t.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    options = ("--width", "16", "--height", "16", "--spp", "32", "--environment", "sky.hdr", "--rotation", "45")
    for scene in ("penumbra", "t.obj"):
        result = run("render", scene, *options, "-o", "out.exr", cwd=tmp_path)
        assert result.returncode == 0, result.stderr
        assert "no light" not in result.stderr
        assert pixels_of(tmp_path / "out.exr")[..., :3].max() > 0
    assert_refused(run("render", "--environment", "sky.png", cwd=tmp_path), "sky.png", ".exr, .hdr, .pfm")
    assert_refused(run("render", "--environment", "none.exr", cwd=tmp_path), "none.exr")


def test_errors_are_one_line_and_exit_2(tmp_path: Path) -> None:
    assert_refused(run("render", "nowhere"), "nowhere", "penumbra, defocus, cornell")
    assert_refused(run("render", tmp_path / "nowhere.obj"), "nowhere.obj")
    assert_refused(run("render", "x.fbx"), ".fbx", ".glb")
    assert_refused(run("render", "-o", "out.jpg"), ".jpg", ".exr, .png")
    assert_refused(run("render", "-o", tmp_path / "missing" / "out.exr"), "no folder")
    assert_refused(run("render", "--spp", "4", "--tolerance", "0.1"), "both")
    assert_refused(run("render", "--spp", "many"), "--spp", "many")
    assert_refused(run("render", "--spp", "-1"), "spp is -1")
    assert_refused(run("render", "--width", "0"), "width is 0")
    assert_refused(run("render", "--crop", "1", "2", "3"), "--crop")
    assert_refused(run("render", "--pattern", "sobel"), "sobel", "sobol")
    assert_refused(run("render", "--aov", "albedo,motion"), "motion", "albedo, normal")
    assert_refused(run("paint"), "paint", "render")
    assert_refused(run(), "COMMAND")
    assert_refused(run("points", "sobel"), "sobel", "sobol")
    assert_refused(run("points", "jittered", "-n", "17"), "17")
    assert_refused(run("points", "sobol", "-o", "p.svg"), ".svg", ".npy, .csv, .txt")
    assert_refused(run("plan", "nowhere"), "nowhere")


def test_an_old_file_survives_a_render_that_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "out.exr"
    path.write_bytes(b"old")
    assert_refused(run("render", "--confidence", "2", "-o", path), "confidence")
    assert path.read_bytes() == b"old"


def test_points(tmp_path: Path) -> None:
    expected = sf.points("halton", 10, 3, seed=4)
    for name, read in (
        ("p.npy", np.load),
        ("p.csv", lambda path: np.loadtxt(path, delimiter=",", dtype=np.float32)),
        ("p.txt", lambda path: np.loadtxt(path, dtype=np.float32)),
    ):
        result = run("points", "halton", "-n", "10", "-d", "3", "--seed", "4", "-o", name, cwd=tmp_path)
        assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
        assert np.array_equal(read(tmp_path / name), expected)
    printed = run("points", "halton", "-n", "10", "-d", "3", "--seed", "4").stdout
    assert np.array_equal(np.loadtxt(printed.splitlines(), delimiter=",", dtype=np.float32), expected)
    assert run("points", "sobol", "-n", "2", "--scramble", "none").stdout == "0,0\n0.5,0.5\n"


def test_points_take_every_option_of_sf_points() -> None:
    given = ["--scramble", "nested", "--pad", "2", "--start", "16", "--seed", "5"]
    printed = run("points", "sz", "-n", "16", "-d", "5", *given).stdout
    expected = sf.points("sz", 16, 5, scramble="nested", pad=2, start=16, seed=5)
    assert np.array_equal(np.loadtxt(printed.splitlines(), np.float32, delimiter=","), expected)
    printed = run("points", "jittered", "-n", "6", "--start", "10", "--total", "16").stdout
    expected = sf.points("jittered", 16)[10:]
    assert np.array_equal(np.loadtxt(printed.splitlines(), np.float32, delimiter=","), expected)
    assert_refused(run("points", "sobol", "-n", "4", "--pad", "3"), "pad is 3", "0, 2 or 4")
    assert_refused(run("points", "sobol", "-n", "4", "--start", "-1"), "start is -1")
    assert_refused(run("points", "latin", "-n", "4", "--total", "3"), "a total of 3")


def test_points_warn_once_in_one_line() -> None:
    result = run("points", "sobol", "-n", "3")
    assert result.returncode == 0
    assert result.stderr.startswith("sunfleck: 3 points")
    assert result.stderr.count("\n") == 1


FULL_DISK = """
    import resource, signal, sys
    from sunfleck.cli import main
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (8192, 8192))
    sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.parametrize(
    "words",
    [
        ["points", "random", "-n", "20000", "-o", "p.npy"],
        ["points", "random", "-n", "20000", "-o", "p.csv"],
        ["points", "random", "-n", "20000", "-o", "p.txt"],
        ["lab", "randu-planes", "-o", "randu.png"],
    ],
)
def test_a_disk_without_room_is_told_with_the_file_s_name(tmp_path: Path, words: list[str]) -> None:
    target = tmp_path / words[-1]
    target.write_bytes(b"old")
    command = [sys.executable, "-c", textwrap.dedent(FULL_DISK), *words]
    result = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False, cwd=tmp_path)
    assert result.returncode == 2
    assert f"error: can't write '{words[-1]}': File too large" in result.stderr
    assert result.stderr.count("\n") == 1
    assert target.read_bytes() == b"old"
    assert not list(tmp_path.glob(".sunfleck-*"))


def test_standard_output_without_room_is_told() -> None:
    command = f"{sys.executable} -m sunfleck points random -n 20000 > /dev/full"
    result = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert result.returncode == 2
    assert result.stderr == "sunfleck: error: can't write standard output: No space left on device\n"


def test_a_reader_that_goes_away_is_no_error() -> None:
    command = f"{sys.executable} -m sunfleck points random -n 200000 | head -n 1"
    result = subprocess.run(["bash", "-c", f"set -o pipefail; {command}"], capture_output=True, text=True, check=False)
    assert (result.returncode, result.stderr) == (0, "")


def test_plan() -> None:
    result = run("plan", "defocus")
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout.rstrip("\n") == str(sf.scenes.defocus().plan())
    assert run("plan").stdout.rstrip("\n") == str(sf.scenes.penumbra().plan())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--help"], ["render", "points", "plan", "examples:"]),
        (
            ["render", "--help"],
            [
                ", ".join(sf.RENDER_PATTERNS),
                "examples:",
                "--tolerance",
                "--crop",
                "Ctrl-C",
                "penumbra, defocus, cornell",
                ".glb",
            ],
        ),
        (["points", "--help"], ["examples:", "--pad", "--start", "--total", *sf.SCRAMBLES, *sf.PATTERNS]),
        (["plan", "--help"], ["examples:"]),
        (["--version"], [f"sunfleck {sf.__version__}"]),
    ],
)
def test_help_teaches(arguments: list[str], words: list[str]) -> None:
    result = run(*arguments)
    assert (result.returncode, result.stderr) == (0, "")
    for word in words:
        assert " ".join(word.split()) in " ".join(result.stdout.split())


INTERRUPTED = """
    import os, signal, sys, threading, time
    import sunfleck as sf
    from sunfleck.cli import main

    render, sent = sf.render, []

    def interrupt():
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    def interrupted_render(*arguments, **options):
        threading.Timer(0.3, interrupt).start()
        image = render(*arguments, **options)
        assert time.monotonic() - sent[0] < 0.5
        return image

    sf.render = interrupted_render
    sys.exit(main(["render", "--width", "64", "--height", "64", "--spp", str(2**31), "-o", "out.exr"]))
"""


def test_ctrl_c_saves_the_partial_picture_and_exits_130(tmp_path: Path) -> None:
    command = [sys.executable, "-c", textwrap.dedent(INTERRUPTED)]
    result = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False, cwd=tmp_path)
    assert result.returncode == 130, result.stderr
    assert result.stderr == "sunfleck: interrupted; the partial picture was saved\n"
    pixels = pixels_of(tmp_path / "out.exr")
    assert pixels.shape == (64, 64, 7)
    assert pixels[..., :3].max() > 0
