# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""cells: what is measured, one cell at a time, and kept so that a run can be continued."""

from __future__ import annotations

import datetime
import json
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sunfleck import _core
from sunfleck.error import Error
from sunfleck.io.files import FilePath, ending, given_path, replacing, writable_target
from sunfleck.provenance import compiler, processor

__all__ = ["TIMINGS", "Cell", "Key", "Store", "disturbance", "least_time", "measure_cells"]

Key = tuple[str, str, float]
"""Case, method, and how many samples, or another number that says how much."""

_FORMAT = "sunfleck chart 1"
_WRITE_SECONDS = 1.0
_WRITE_SHARE = 0.05  # of the time, at the most, where there is so much to write that it takes longer


class Cell(NamedTuple):
    """A key, and how its numbers come from a seed, and of how much work that is."""

    key: Key
    measure: Callable[[int], dict[str, float]]
    weight: float
    """Expected cost of a seed beside others', for the bar and the order; 1 is some 5 ns."""
    most: int = 1 << 62
    """Seeds, at the most: so many will do."""


class Store:
    """The numbers of cells, in a JSON file or in memory only.

    Parameters
    ----------
    path : path-like, optional
        Ending in .json. Where the file exists, its cells are taken over.
    fresh : bool
        Begin anew, whatever the file holds.

    Raises
    ------
    ValueError, TypeError
        The file is not a chart's, or its numbers were measured on another machine, by another
        compiler's build or by another version: they can't stand in one chart.
    OSError
        It can't be read, or no file can be written there.
    """

    def __init__(self, path: FilePath | None = None, fresh: bool = False) -> None:
        version = f"{_core.version()} ({_core.isa()})"
        self._head = {"format": _FORMAT, "processor": processor(), "compiler": compiler(), "version": version}
        self._path = path
        self._write_at = time.monotonic() + _WRITE_SECONDS
        self.dates: list[str] = []
        self._cells: dict[str, dict[str, list[float]]] = {}
        if path is not None:
            target = writable_target(path, "numbers", (".json",))
            if target.exists():
                self._take_over(target, fresh)

    def _take_over(self, target: Path, fresh: bool) -> None:
        try:
            kept = json.loads(target.read_text(encoding="utf-8"))
            head = {name: kept[name] for name in self._head}
            cells, dates = dict(kept["cells"]), list(kept["dates"])
        except (ValueError, KeyError, TypeError):
            head, cells, dates = {}, {}, []
        if head.get("format") != _FORMAT:  # somebody else's file is not overwritten, fresh or not
            raise ValueError(f"{str(self._path)!r} exists and does not hold the numbers of a chart; give another file")
        if fresh:
            return
        for name, now in self._head.items():
            if head[name] != now:
                raise ValueError(
                    f"{str(self._path)!r} was measured with {name} {head[name]}, which here is {now}; "
                    "give another file, or begin anew (--fresh, fresh=True)"
                )
        self._cells, self.dates = cells, dates

    def get(self, key: Key, seeds: int) -> dict[str, list[float]] | None:
        """The numbers of the first so many seeds, by name; None where none are known."""
        cell = self._cells.get(json.dumps(key))
        return {name: values[:seeds] for name, values in cell.items()} if cell else None

    def seeds(self, key: Key) -> int:
        """How many seeds are known."""
        cell = self._cells.get(json.dumps(key))
        return len(next(iter(cell.values()))) if cell else 0

    def add(self, key: Key, numbers: dict[str, float]) -> None:
        """The numbers of the next seed; on disk within seconds."""
        cell = self._cells.setdefault(json.dumps(key), {name: [] for name in numbers})
        for name, value in numbers.items():
            cell[name].append(float(value))
        today = datetime.date.today().isoformat()
        if today not in self.dates:
            self.dates.append(today)
        if time.monotonic() > self._write_at:
            self.write()

    def write(self) -> None:
        """Writes the file, beside and renamed; nothing where there is none."""
        start = time.monotonic()
        if self._path is not None:
            with replacing(self._path, "numbers", (".json",)) as target:
                target.write_text(json.dumps({**self._head, "dates": self.dates, "cells": self._cells}))
        now = time.monotonic()
        self._write_at = now + max(_WRITE_SECONDS, (now - start) / _WRITE_SHARE)


TIMINGS = ("seconds", "float64", "uint64", "float32", "sample", "pdf", "invert")
"""The numbers of cells that are times: what else a machine does adds to them, and never takes away."""

_QUIET_SPREAD = 1.5  # of a point's median timing over its least: half as much again is said


def least_time(values: Sequence[float]) -> float:
    """Of several timings of one thing the least, which was disturbed least; NaN where there is none."""
    known = [value for value in values if np.isfinite(value)]
    return min(known) if known else float("nan")


def disturbance(cells: Sequence[Cell], seeds: int, store: Store) -> str:
    """What a chart says where the machine was not quiet: "" where it was.

    By the numbers themselves: half of the points have a median timing that is so much above their least.
    """
    spreads = []
    for cell in cells:
        for name, values in (store.get(cell.key, seeds) or {}).items():
            if name in TIMINGS and len(values) > 2 and least_time(values) > 0:
                spreads.append(float(np.nanmedian(values)) / least_time(values))
    if not spreads or (typical := float(np.median(spreads))) < _QUIET_SPREAD:
        return ""
    return f"the machine was not quiet: a point's median timing is {typical:.1f} times its least, which is drawn"


def numbers_beside(path: FilePath) -> str:
    """Where the numbers of a chart go: its path with .json for its ending."""
    given = given_path(path)
    return given[: len(given) - len(ending(given))] + ".json"


def _bar(total: float, done: float) -> Any:
    try:
        from tqdm import tqdm
    except ImportError:
        raise Error("a progress bar needs tqdm; pip install tqdm brings it") from None
    layout = "{l_bar}{bar}| {elapsed}, {remaining} left{postfix}"
    return tqdm(total=total, initial=done, bar_format=layout, dynamic_ncols=True, leave=False)


def measure_cells(cells: Sequence[Cell], seeds: int, store: Store, progress: bool = False) -> bool:
    """Measures what the store lacks: seeds 1 .. `seeds` of every cell, light cells first.

    Parameters
    ----------
    cells : sequence of Cell
    seeds : int
    store : Store
    progress : bool
        A bar on stderr, with the time that is left.

    Returns
    -------
    bool
        Whether all is there; False after Ctrl-C. What was measured is in the store either way.
    """
    asked = [(cell, min(seeds, cell.most)) for cell in sorted(cells, key=lambda c: c.weight)]
    missing = [(cell, max(0, wish - store.seeds(cell.key))) for cell, wish in asked]
    total, left = sum(wish * c.weight for c, wish in asked), sum(count * c.weight for c, count in missing)
    bar = _bar(total, total - left) if progress else None
    try:
        for cell, count in missing:
            if bar is not None and count:
                bar.set_postfix_str(" ".join(map(str, cell.key)), refresh=False)
            known = store.seeds(cell.key)
            for seed in range(known + 1, known + count + 1):
                store.add(cell.key, cell.measure(seed))
                if bar is not None:
                    bar.update(cell.weight)
    except KeyboardInterrupt:
        return False
    finally:
        if bar is not None:
            bar.close()
        store.write()
    return True
