# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""gallery: the command `sunfleck gallery`."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from sunfleck.plot.gallery import gallery

__all__ = ["add_gallery"]

_EXAMPLES = """\
examples:
  sunfleck gallery -o gallery
      gallery/index.html, which needs no network, and the pictures beside it as PNG files
  sunfleck gallery -o large --size 512
      with larger renders
"""


def add_gallery(commands: argparse._SubParsersAction[Any]) -> None:
    """Adds the command to those of `sunfleck`."""
    parser = commands.add_parser(
        "gallery",
        help="make a lecture's figures on random numbers and mappings anew",
        description="Make the figures of a lecture on random numbers and mappings anew, and a page that shows them.",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=_run)
    add = parser.add_argument
    add("-o", "--output", required=True, metavar="DIR", help="the folder, made if need be")
    add("--size", type=int, default=208, metavar="N", help="width and height of the renders, in pixels; default 208")
    add("--seed", type=int, default=0, metavar="N", help="default 0")
    add("--threads", type=int, metavar="N", help="default: one for each processor")


def _run(given: argparse.Namespace) -> int:
    page = gallery(given.output, size=given.size, seed=given.seed, threads=given.threads, progress=sys.stderr.isatty())
    print(page)
    return 0
