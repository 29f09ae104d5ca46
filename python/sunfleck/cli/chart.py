# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""chart: the command `sunfleck chart`."""

from __future__ import annotations

import argparse
import inspect
import sys
from typing import Any

import sunfleck as sf
from sunfleck._arguments import choice
from sunfleck.cli.exit_codes import INTERRUPTED
from sunfleck.io.files import ending, writable_target
from sunfleck.scenes import SCENES

__all__ = ["add_chart"]

_KINDS = ("patterns", "scenes", "generators", "mappings")  # sf.chart.KINDS, without its imports

_EXAMPLES = """\
examples:
  sunfleck chart --quick
      patterns: error against samples and against seconds; patterns.png, and .csv and .json beside it
  sunfleck chart patterns cornell -o p.png -o p.svg --html p.html
      in full, with the pixels of the Cornell box; two figures and an interactive page
  sunfleck chart --pattern sobol,sobol:lms,sobol-dropped-first --integrand product,circle
      chosen patterns, scrambles and integrands; sobol-dropped-first is broken on purpose
  sunfleck chart scenes room.glb --quick -o room.png
      fixed counts and adaptive renders of a scene: seconds against relMSE, tolerance against error
  sunfleck chart generators
  sunfleck chart mappings

Ctrl-C draws what there is and exits with 130. FILE.json keeps every number as it comes: the same command
goes on where it was, more seeds or samples add to it, and --fresh begins anew.
"""


def add_chart(commands: argparse._SubParsersAction[Any]) -> None:
    """Adds the command to the others."""
    parser = commands.add_parser(
        "chart",
        help="chart speed against accuracy",
        description="Measure and chart speed against accuracy: of patterns, scenes, generators or mappings.",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=_run)
    add = parser.add_argument
    add("kind", nargs="?", default="patterns", metavar="KIND", help=f"{', '.join(_KINDS)}; default patterns")
    add("scene", nargs="?", metavar="SCENE", help=f"of patterns and scenes: {', '.join(SCENES)} or a file")
    add(
        "-o", "--output", action="append", metavar="FILE", help=".png, .svg or .html; default KIND.png; may be repeated"
    )
    add("--html", metavar="FILE", help="also a page with interactive charts, in one file that needs no network")
    add("--quick", action="store_true", help="seconds instead of minutes: fewer seeds, samples and cases")
    add("--fresh", action="store_true", help="forget the numbers that FILE.json keeps")

    chosen = parser.add_argument_group("what is charted (names with commas between)")
    add = chosen.add_argument
    add("--pattern", dest="patterns", metavar="NAMES", help="also NAME:SCRAMBLE")
    add("--integrand", dest="integrands", metavar="NAMES", help="of sunfleck.integrands; patterns only")
    add("--stop", dest="stops", metavar="RULES", help="stopping rules; scenes only")
    add("--pixel-filter", dest="pixel_filters", metavar="NAMES", help="scenes only")
    add("--tolerance", dest="tolerances", metavar="LIST", help="such as 0.1,0.05,0.02; scenes only")
    add("--generator", dest="generators", metavar="NAMES", help="generators only")
    add("--mapping", dest="mappings", metavar="NAMES", help="mappings only")
    add("--seeds", type=int, metavar="N", help="of every number, so that its spread is known")
    add("--max-samples", type=int, metavar="N", help="of patterns, at the most")


def _run(given: argparse.Namespace) -> int:
    given.kind = choice("KIND", given.kind, _KINDS)
    outputs = [*(given.output or [f"{given.kind}.png"]), *([given.html] if given.html else [])]
    chart = sf.chart.KINDS[given.kind]
    numbers = outputs[0][: len(outputs[0]) - len(ending(outputs[0]))]
    _refuse_early(outputs, given.html, f"{numbers}.csv")
    options = {name: value for name, value in vars(given).items() if value is not None}
    for name in ("run", "kind", "output", "html"):
        options.pop(name, None)
    for name in options:
        if name not in inspect.signature(chart).parameters:
            raise ValueError(f"a chart of {given.kind} takes no {name.replace('_', '-')}")
    made = chart(**options, keep=f"{numbers}.json", progress=sys.stderr.isatty())
    for output in dict.fromkeys([*outputs, f"{numbers}.csv"]):
        made.save(output)
    print(made)
    if made.complete:
        return 0
    print("sunfleck: interrupted; what was measured is drawn and kept, the same command goes on", file=sys.stderr)
    return INTERRUPTED


def _refuse_early(outputs: list[str], html: str | None, numbers: str) -> None:
    """What can't be written, or needs a package that is not there, before any work."""
    from sunfleck.plot.figure import require_matplotlib
    from sunfleck.plot.page import PAGE_TYPES, plotly

    if html:
        writable_target(html, "pages", PAGE_TYPES)
    for output in (*outputs, numbers):
        writable_target(output, "charts", sf.chart.CHART_TYPES)
        if ending(output) in PAGE_TYPES:
            plotly()
    require_matplotlib()
