# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""command: the command `sunfleck`."""

from __future__ import annotations

import argparse
import contextlib
import errno
import logging
import os
import sys
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

import sunfleck as sf
from sunfleck import _core
from sunfleck._arguments import choice
from sunfleck.cli.chart import add_chart
from sunfleck.cli.exit_codes import INTERRUPTED
from sunfleck.cli.gallery import add_gallery
from sunfleck.cli.lab import add_lab
from sunfleck.cli.scene import add_environment, add_scene, scene_of
from sunfleck.exposure import exposure_of
from sunfleck.io.files import ending, replacing, writable_target
from sunfleck.io.image import IMAGE_TYPES
from sunfleck.plot.figure import FIGURE_TYPES, require_matplotlib
from sunfleck.plot.heatmap import HEATMAPS

__all__ = ["main"]

POINT_TYPES = (".npy", ".csv", ".txt")

_RENDER_EXAMPLES = """\
examples:
  sunfleck render -o out.exr
      penumbra, every pixel to 1 % of the mean level at 95 % confidence
  sunfleck render cornell --tolerance 0.03 --max-spp 16384 -o box.exr -o box.png
      coarser, with more samples allowed where it is hard; two files of one picture
  sunfleck render room.glb --spp 64 --width 1280 --height 720 -o room.png
      a fixed count of samples a pixel
  sunfleck render room.glb --camera kitchen --exposure auto -o kitchen.png
      by another of the file's cameras, as bright as it takes
  sunfleck render defocus --seconds 10 -o out.exr
      as good as ten seconds allow
  sunfleck render --heatmap samples,half_width,stop_reason -o out.png
      and out.samples.png, out.half_width.png, out.stop_reason.png: where the samples went, how far
      each pixel may be off, and why it stopped, in colours with a scale
  sunfleck render cornell --checkpoint box.ckpt -o box.exr
      may be stopped or killed: the same command goes on where it was, and a smaller --tolerance
      or larger --spp, --max-spp or --seconds adds to what is there

An .exr holds R G B A, samples, half_width and stop_reason of each pixel, what --aov asks for,
and every option as metadata; a .png holds the colours only, as sRGB. Ctrl-C saves what there is and exits with 130.
"""

_POINTS_EXAMPLES = """\
examples:
  sunfleck points sobol -n 16            prints 16 points as text, one a line
  sunfleck points jittered -n 1024 -d 2 -o points.npy
  sunfleck points halton -n 1000 -d 5 --scramble none -o points.csv
  sunfleck points sobol -n 1024 -d 100 --pad 2 --scramble nested --seed 7 -o pairs.npy
  sunfleck points latin -n 500 --start 500 --total 1000 -o second_half.npy

patterns:
"""

_PLAN_EXAMPLES = """\
examples:
  sunfleck plan defocus
  sunfleck plan room.glb
"""


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are one line, as all errors of the command are."""

    def error(self, message: str) -> NoReturn:
        raise argparse.ArgumentTypeError(f"{message} (see {self.prog} --help)")


def _add_render(commands: argparse._SubParsersAction[_Parser]) -> None:
    parser = commands.add_parser(
        "render",
        help="render a scene to a stated accuracy",
        description="Render a scene to a stated accuracy, a fixed count of samples, or a time.",
        epilog=_RENDER_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=_render)
    add_scene(parser)
    add = parser.add_argument
    add("-o", "--output", action="append", metavar="FILE", help=".exr or .png; default SCENE.exr; may be repeated")
    add(
        "--heatmap",
        default="",
        metavar="NAMES",
        help=f"also FILE.NAME.png of {', '.join(HEATMAPS)}: any of these, with commas between",
    )
    add("--width", type=int, default=512, metavar="N", help="of the full frame, in pixels; default 512")
    add("--height", type=int, default=512, metavar="N", help="default 512")
    add(
        "--exposure",
        metavar="STOPS|auto",
        help="of each .png: brighter by 2^STOPS; default 0, or auto where the file's light is in photometric units",
    )
    add_environment(parser)

    accuracy = parser.add_argument_group("accuracy, samples and time (default: --tolerance 0.01)")
    add = accuracy.add_argument
    add("--tolerance", type=float, metavar="X", help="a pixel is done when its half-width is X of the mean level")
    add("--relmse", type=float, metavar="X", help="instead, the relative mean square error of the whole picture")
    add("--spp", type=int, metavar="N", help="a fixed count of samples a pixel; not with --tolerance")
    add("--seconds", type=float, metavar="T", help="a time limit; alone, a budget that is spent on every pixel")

    sampling = parser.add_argument_group("sampling")
    for name, option in _plain_options().items():
        _add_plain(accuracy if name in ("confidence", "min_spp", "max_spp") else sampling, name, option)

    work = parser.add_argument_group("work")
    add = work.add_argument
    add("--threads", type=int, metavar="N", help="default: one for each processor")
    add("--profile", action="store_true", help="with the summary, what the threads' time went to")
    add("--aov", default="", metavar="NAMES", help=f"also {', '.join(sf.AOVS)}: any of these, with commas between")
    add("--crop", type=int, nargs=4, metavar=("X0", "Y0", "X1", "Y1"), help="half open, in pixels of the full frame")
    add("--checkpoint", metavar="FILE", help="keep the render's state there, and go on from it where it exists")
    add("--checkpoint-seconds", type=float, default=30.0, metavar="T", help="between two writes; default 30")


def _plain_options() -> dict[str, tuple[str, Any, list[str]]]:
    """Text, default and names, from the library's table, of the options that are here as in `sf.render`."""
    apart = {"crop", "start", "relative_tolerance", "absolute_tolerance", "samples", "threads", "aovs"}
    apart |= {"width", "height", "spp", "relmse", "seconds"}  # with words or defaults of their own above and below
    return {name: option for name, option in _core.render_options().items() if name not in apart}


def _add_plain(group: argparse._ArgumentGroup, name: str, option: tuple[str, Any, list[str]]) -> None:
    text, otherwise, names = option
    flag = f"--{name.replace('_', '-')}"
    if isinstance(otherwise, bool):
        group.add_argument(flag, action="store_true", help=text)
        return
    said = f"{text}: {', '.join(names)}" if names else text
    meta = "NAME" if names else "X" if isinstance(otherwise, float) else "N"
    group.add_argument(flag, type=type(otherwise), default=otherwise, metavar=meta, help=f"{said}; default {otherwise}")


def _add_points(commands: argparse._SubParsersAction[_Parser]) -> None:
    parser = commands.add_parser(
        "points",
        help="write the points of a pattern",
        description="Write the points of a pattern in [0,1)^d.",
        epilog=_POINTS_EXAMPLES + "".join(f"  {name:<14}{text}\n" for name, text in sf.PATTERNS.items()),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=_points)
    add = parser.add_argument
    add("pattern", metavar="PATTERN", help="its name, see below")
    add("-n", type=int, default=256, metavar="N", help="how many points; default 256")
    add("-d", type=int, default=2, metavar="D", help="dimensions; default 2")
    add("-o", "--output", default="-", metavar="FILE", help=".npy, .csv, .txt, or - for text on standard output")
    add("--seed", type=int, default=0, metavar="N", help="default 0")
    scrambles = ", ".join(name for name in sf.SCRAMBLES if name != "default")
    add("--scramble", default="default", metavar="NAME", help=f"{scrambles}; default: the pattern's own")
    add("--pad", type=int, default=0, metavar="N", help="2 or 4, of sobol and sz: sets of N dimensions side by side")
    add("--start", type=int, default=0, metavar="K", help="index of the first point; default 0")
    add("--total", type=int, metavar="M", help="points of the whole set, of which these are a part; default K + N")


def _add_plan(commands: argparse._SubParsersAction[_Parser]) -> None:
    parser = commands.add_parser(
        "plan",
        help="show what rendering a scene takes",
        description="Show the stages, sample dimensions and rays that rendering a scene takes.",
        epilog=_PLAN_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=_plan)
    add_scene(parser)


def _parser() -> _Parser:
    parser = _Parser(
        prog="sunfleck",
        description="Random numbers into pictures of stated accuracy.",
        epilog="examples:\n  sunfleck render -o out.exr\n  sunfleck points sobol -n 16\n  sunfleck plan cornell\n"
        "  sunfleck gallery -o gallery\n  sunfleck lab --list\n  sunfleck chart --quick\n\n"
        "Each command has its own --help.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    version = f"sunfleck {sf.__version__} ({_core.isa()})"
    parser.add_argument("--version", action="version", version=version)
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True, parser_class=_Parser)
    _add_render(commands)
    _add_points(commands)
    _add_plan(commands)
    add_gallery(commands)
    add_lab(commands)
    add_chart(commands)
    return parser


def _exposure(text: str | None, outputs: Sequence[str]) -> float | str | None:
    if text is None:
        return None
    if not any(ending(output) == ".png" for output in outputs):
        raise ValueError(f"--exposure is {text!r}; it is of a .png, and the output is {', '.join(outputs)}")
    try:
        return exposure_of(text if text == "auto" else float(text))
    except ValueError:
        raise ValueError(f"--exposure is {text!r}; give stops from -100 to 100, or auto") from None


def _heatmaps(names: str, output: str) -> dict[str, Path]:
    """Where each heat map goes: beside the first picture. Refused now rather than after the work."""
    given = [name.strip() for name in names.split(",") if name.strip()]
    wanted = [choice("--heatmap", name, HEATMAPS, "heat maps are drawn of") for name in given]
    paths = {name: Path(output).with_suffix(f".{name}.png") for name in wanted}
    for path in paths.values():
        writable_target(path, "figures", FIGURE_TYPES)
    if wanted:
        require_matplotlib()
    return paths


def _render(given: argparse.Namespace) -> int:
    outputs = given.output or [f"{Path(given.scene).stem}.exr"]
    for output in outputs:
        writable_target(output, "pictures", IMAGE_TYPES)  # refused now rather than after the work
    exposure = _exposure(given.exposure, outputs)
    heatmaps = _heatmaps(given.heatmap, outputs[0])
    failure = None
    try:
        image = _rendered(given)
    except sf.CheckpointError as error:  # the picture is there all the same, and is saved first
        image, failure = error.image, error
    for output in outputs:
        image.save(output, exposure if ending(output) == ".png" else None)
    for name, path in heatmaps.items():
        image.heatmap(name).save(path)
    print(image.summary())
    if failure:
        raise failure
    if image.interrupted:
        print("sunfleck: interrupted; the partial picture was saved", file=sys.stderr)
        return INTERRUPTED
    return 0


def _rendered(given: argparse.Namespace) -> sf.Image:
    return sf.render(
        scene_of(given),
        given.width,
        given.height,
        spp=given.spp,
        tolerance=given.tolerance,
        relmse=given.relmse,
        seconds=given.seconds,
        profile=given.profile,
        threads=given.threads,
        crop=given.crop,
        aovs=given.aov,
        checkpoint=given.checkpoint,
        checkpoint_seconds=given.checkpoint_seconds,
        progress=sys.stderr.isatty(),
        **{name: getattr(given, name) for name in _plain_options()},
    )


class _Writer:
    """A file by its function alone, so that NumPy writes through it, and not by itself."""

    def __init__(self, write: Callable[[bytes], int]) -> None:
        self.write = write


def _write_points(points: NDArray[np.float32], output: str) -> None:
    """As text where the ending is not .npy; nine digits tell every float apart."""
    if output == "-":
        np.savetxt(sys.stdout, points, fmt="%.9g", delimiter=",")
        return
    with replacing(output, "points", POINT_TYPES) as path:
        if path.suffix == ".npy":
            with open(path, "wb") as file:  # NumPy's own writing does not tell why it fails
                np.save(_Writer(file.write), points)
        else:
            np.savetxt(path, points, fmt="%.9g", delimiter="," if path.suffix == ".csv" else " ")


def _points(given: argparse.Namespace) -> int:
    scramble = None if given.scramble == "none" else given.scramble
    if given.output != "-":
        writable_target(given.output, "points", POINT_TYPES)
    points = sf.points(
        given.pattern,
        given.n,
        given.d,
        seed=given.seed,
        scramble=scramble,
        pad=given.pad,
        start=given.start,
        total=given.total,
    )
    _write_points(points, given.output)
    return 0


def _plan(given: argparse.Namespace) -> int:
    print(scene_of(given).plan())
    return 0


def _split_crop(arguments: Sequence[str]) -> list[str]:
    """ "--crop 0,0,64,64" as the four words that the parser takes."""
    words: list[str] = []
    for word in arguments:
        words += word.split(",") if words and words[-1] == "--crop" else [word]
    return words


def _told(error: OSError) -> str:
    """The error as text. One that names no file is of standard output, which is then given up."""
    if error.errno not in (errno.ENOSPC, errno.EFBIG, errno.EDQUOT, errno.EIO, errno.EBADF) or error.filename:
        return str(error)
    if "can't write" in str(error):
        return str(error)
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # else the interpreter tries once more
    return f"can't write standard output: {error.strerror}"


def _run(arguments: Sequence[str]) -> int:
    """The exit code; what goes wrong becomes one line on standard error."""
    try:
        given = _parser().parse_args(_split_crop(arguments))
        code: int = given.run(given)
        sys.stdout.flush()
        return code
    except BrokenPipeError:  # the reader of our output has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        print(f"sunfleck: error: {' '.join(_told(error).split())}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("sunfleck: interrupted", file=sys.stderr)
        return INTERRUPTED
    except MemoryError as error:
        print(f"sunfleck: error: out of memory {error}".rstrip(), file=sys.stderr)
        return 2
    except (argparse.ArgumentTypeError, ValueError, TypeError, NotImplementedError, sf.Error) as error:
        print(f"sunfleck: error: {' '.join(str(error).split())}", file=sys.stderr)
        return 2


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command.

    Parameters
    ----------
    arguments : sequence of str, optional
        Without the program's name. None: those of the process.

    Returns
    -------
    int
        The exit code: 0, 2 after an error, 130 after Ctrl-C.
    """
    notices = logging.StreamHandler()
    notices.setFormatter(logging.Formatter("sunfleck: %(message)s"))
    logger = logging.getLogger("sunfleck")
    logger.addHandler(notices)
    logger.setLevel(logging.INFO)
    try:
        with warnings.catch_warnings():
            warnings.showwarning = lambda message, *_: logger.warning("%s", message)
            return _run(sys.argv[1:] if arguments is None else arguments)
    finally:
        logger.removeHandler(notices)
