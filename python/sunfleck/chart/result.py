# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""result: a chart and the numbers it was drawn from, as a figure, a page or a table."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sunfleck.chart.cells import Cell, Store, disturbance, measure_cells
from sunfleck.io.files import FilePath, ending, replacing
from sunfleck.plot.figure import FIGURE_TYPES, Panel, draw_panels, png, save
from sunfleck.plot.page import PAGE_TYPES, Page
from sunfleck.provenance import provenance

__all__ = ["CHART_TYPES", "Chart", "measured"]

CHART_TYPES = (*FIGURE_TYPES, *PAGE_TYPES, ".csv")


@dataclass
class Chart:
    """Made by `patterns`, `scenes`, `generators` and `mappings`. Shows itself in a notebook.

    Attributes
    ----------
    title : str
    panels : list of sunfleck.plot.figure.Panel
        What is drawn: every number of the figure.
    text : str
        The findings in words: winners, slopes, what departs from theory.
    about : str
        Processor, cores, compiler, version, seeds and date.
    rows : list of dict
        The numbers: a row a cell, with the median, the 10 and 90 % quantiles and the root mean
        square over its seeds.
    columns, size
        How the panels are laid out: how many side by side at the most, and each one's inches.
    pictures : dict of str to bytes
        PNGs by their captions, for the page.
    complete : bool
        Whether everything was measured; False after Ctrl-C.
    """

    title: str
    panels: list[Panel]
    text: str
    about: str
    rows: list[dict[str, Any]]
    columns: int = 4
    size: tuple[float, float] = (4.6, 3.6)
    pictures: dict[str, bytes] = field(default_factory=dict)
    complete: bool = True

    def figure(self) -> Any:
        """The panels as a matplotlib figure.

        Raises
        ------
        sunfleck.Error
            matplotlib is not installed.
        """
        return draw_panels(self.panels, self.about, self.columns, self.size)

    def _repr_png_(self) -> bytes:
        return png(self.figure())

    def page(self) -> Page:
        """The panels as interactive charts in one page, with the findings and the pictures."""
        page = Page(self.title, self.about)
        page.lines(self.text)
        if self.pictures:
            page.pictures(self.pictures)
        for panel in self.panels:
            page.chart(panel)
            if panel.note:
                page.lines(panel.note)
        return page

    def save(self, path: FilePath) -> None:
        """Writes the chart by the path's ending: .png or .svg, .html, or .csv (the rows).

        The file is written beside and renamed.

        Raises
        ------
        ValueError
            Another ending.
        OSError
            The file can't be written.
        sunfleck.Error
            matplotlib, or plotly for .html, is not installed.
        """
        kind = ending(path)
        if kind in FIGURE_TYPES:
            save(self.figure(), path)
        elif kind in PAGE_TYPES:
            self.page().save(path)
        else:
            names = list(dict.fromkeys(name for row in self.rows for name in row))
            with replacing(path, "charts", CHART_TYPES) as target, open(target, "w", newline="", encoding="utf-8") as f:
                table = csv.DictWriter(f, names, restval="")
                table.writeheader()
                table.writerows(self.rows)

    def __str__(self) -> str:
        return f"{self.text}\n{self.about}"


def _rows(cells: Sequence[Cell], seeds: int, store: Store) -> list[dict[str, Any]]:
    rows = []
    for cell in cells:
        numbers = store.get(cell.key, seeds)
        if not numbers:
            continue
        row: dict[str, Any] = dict(zip(("case", "method", "n"), cell.key, strict=True))
        row["seeds"] = len(next(iter(numbers.values())))
        for name, values in numbers.items():
            size = np.abs(values)
            low, middle, high = np.quantile(size, [0.1, 0.5, 0.9]).tolist()
            row |= {f"{name}_median": middle, f"{name}_10%": low, f"{name}_90%": high}
            row[f"{name}_rms"] = float(np.sqrt(np.mean(size**2)))
        rows.append(row)
    return rows


def measured(
    title: str,
    cells: Sequence[Cell],
    seeds: int,
    store: Store,
    progress: bool,
    draw: Callable[[], tuple[list[Panel], str]],
    columns: int = 4,
    size: tuple[float, float] = (4.6, 3.6),
) -> Chart:
    """Measures what the store lacks, then draws what it holds."""
    complete = measure_cells(cells, seeds, store, progress)
    panels, text = draw()
    about = provenance(range(1, seeds + 1), store.dates)
    if noise := disturbance(cells, seeds, store):
        about = f"{noise}; {about}"
    if not complete:
        known = sum(store.seeds(cell.key) > 0 for cell in cells)
        about = f"interrupted: {known} of {len(cells)} cells begun; {about}"
    return Chart(title, panels, text, about, _rows(cells, seeds, store), columns, size, complete=complete)
