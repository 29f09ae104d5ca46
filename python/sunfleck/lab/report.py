# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""report: experiments as figures, as a page, and as a table."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable
from pathlib import Path

from sunfleck.io.files import FilePath, replacing
from sunfleck.lab.experiment import Experiment, Measured
from sunfleck.plot.figure import FIGURE_TYPES, Figure, draw_panels
from sunfleck.plot.page import Page
from sunfleck.provenance import provenance

__all__ = ["Result", "draw", "table", "write_all"]


@dataclasses.dataclass(frozen=True)
class Result:
    """An experiment that was run.

    Attributes
    ----------
    experiment : Experiment
    measured : Measured
    seed : int
    """

    experiment: Experiment
    measured: Measured
    seed: int

    @property
    def before(self) -> float:
        """The number where the method fails."""
        return self.measured.before

    @property
    def after(self) -> float:
        """The number after the remedy."""
        return self.measured.after

    @property
    def holds(self) -> bool:
        """Whether the failure fails and the remedy holds, each within its stated interval."""
        return self.experiment.holds_for(self.measured)

    def figure(self) -> Figure:
        """Both sides; shows itself in a notebook."""
        return draw(self)

    def save(self, path: FilePath) -> None:
        """Writes the figure: .png or .svg."""
        draw(self).save(path)

    def __str__(self) -> str:
        return self.experiment.report(self.measured)


def draw(result: Result) -> Figure:
    """The failing side and the remedied one.

    Raises
    ------
    sunfleck.Error
        matplotlib is not installed.
    """
    sides = (("fails", result.measured.failing, result.before), ("remedied", result.measured.remedied, result.after))
    panels = [dataclasses.replace(panel, title=f"{name}: {number:.5g}") for name, panel, number in sides]
    return Figure(draw_panels(panels, provenance([result.seed])))


def write_all(folder: FilePath, results: Iterable[Result], done: Callable[[Result], object] | None = None) -> Path:
    """A PNG of each result and index.html, one page that needs no network.

    Parameters
    ----------
    folder : path
        Made if need be.
    results : iterable of Result
        May run the experiments as it goes.
    done : callable, optional
        Called with each result after its figure is written.

    Returns
    -------
    pathlib.Path
        The page.
    """
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    kept = []
    for result in results:
        kept.append((result, draw(result).png()))
        with replacing(target / f"{result.experiment.name}.png", "figures", FIGURE_TYPES) as path:
            path.write_bytes(kept[-1][1])
        if done:
            done(result)
    page = Page("Where methods fail", provenance([kept[0][0].seed]))
    page.text(
        "Each experiment states a claim, where it breaks, a number measured there, a remedy and the number after it."
    )
    for result, data in kept:
        page.heading(result.experiment.name)
        page.pictures({result.experiment.line: data})
        page.lines(str(result))
    page.save(target / "index.html")
    return target / "index.html"


def table(results: Iterable[Result]) -> str:
    """Markdown: a row for each result."""
    rows = ["| experiment | what fails | the number | measured | remedy | after |", "|---|---|---|---|---|---|"]
    for result in results:
        made = result.experiment
        cells = (f"`{made.name}`", made.line, made.quantity, f"{result.before:.4g}", made.remedy, f"{result.after:.4g}")
        rows.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(rows) + "\n"
