# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""lab: the command `sunfleck lab`."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING, Any

from sunfleck.io.files import writable_target
from sunfleck.plot.figure import FIGURE_TYPES, require_matplotlib

if TYPE_CHECKING:
    from sunfleck.lab import Result

__all__ = ["add_lab"]

_EXAMPLES = """\
examples:
  sunfleck lab --list
      a name and a line for each experiment
  sunfleck lab randu-planes
      what is claimed, where it breaks, the number measured, the remedy, the number after
  sunfleck lab randu-planes -o planes.png --seed 7
      and its figure
  sunfleck lab --all -o lab
      lab/index.html, which needs no network, and a PNG for each experiment beside it

The exit code is 1 where a number lies outside its stated interval.
"""


def add_lab(commands: argparse._SubParsersAction[Any]) -> None:
    """Adds the command to those of `sunfleck`."""
    parser = commands.add_parser(
        "lab",
        help="show where methods fail, and what helps",
        description="Show where methods fail: a claim, where it breaks, a number, the remedy and its number.",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=_run)
    add = parser.add_argument
    add("name", nargs="?", metavar="NAME", help="of an experiment, see --list")
    add("--list", action="store_true", help="a name and a line for each experiment")
    add("--all", action="store_true", help="run them all; needs -o")
    add("-o", "--output", metavar="FILE", help="the figure, .png or .svg; with --all, the folder, made if need be")
    add("--seed", type=int, default=1, metavar="N", help="1 or more; default 1")


def _run(given: argparse.Namespace) -> int:
    from sunfleck import lab

    if (given.name is not None) + given.list + given.all != 1:
        raise ValueError("give one of NAME, --list and --all (see sunfleck lab --help)")
    if given.list:
        for name, experiment in lab.EXPERIMENTS.items():
            print(f"{name:<24}{experiment.line}")
        return 0
    if given.output is not None:
        require_matplotlib()
    return _all(given) if given.all else _one(given)


def _one(given: argparse.Namespace) -> int:
    from sunfleck import lab

    if given.output is not None:
        writable_target(given.output, "figures", FIGURE_TYPES)
    result = lab.run(given.name, seed=given.seed)
    print(result)
    if given.output is not None:
        result.save(given.output)
    return 0 if result.holds else 1


def _all(given: argparse.Namespace) -> int:
    from sunfleck import lab

    if given.output is None:
        raise ValueError("--all needs -o DIR, the folder for the page and the figures")
    broken: list[str] = []
    count = 0

    def done(result: Result) -> None:
        nonlocal count
        count += 1
        if not result.holds:
            broken.append(result.experiment.name)
        if sys.stderr.isatty():
            print(f"\r{count}/{len(lab.EXPERIMENTS)} {result.experiment.name:<24}", end="", file=sys.stderr, flush=True)

    try:
        print(lab.write_all(given.output, (lab.run(name, seed=given.seed) for name in lab.EXPERIMENTS), done))
    finally:
        if sys.stderr.isatty():
            print(file=sys.stderr)
    for name in broken:
        print(f"sunfleck: {name} lies outside its stated interval", file=sys.stderr)
    return 1 if broken else 0
