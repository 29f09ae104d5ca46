# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""experiment: the shape that all experiments of the laboratory share."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sunfleck.plot.figure import Panel, Series

__all__ = ["Experiment", "Measured", "bars", "image", "lines", "scatter"]

Array = NDArray[Any]


@dataclass(frozen=True)
class Measured:
    """One run: the number where the method fails, the number after the remedy, and a panel of each."""

    before: float
    after: float
    failing: Panel
    remedied: Panel


@dataclass(frozen=True)
class Experiment:
    """A claim, where it breaks, and the remedy.

    ``fails`` and ``holds`` are closed intervals, derived where the experiment is defined: the
    number before lies in the first, the number after in the second, at any seed.
    """

    name: str
    line: str
    claim: str
    breaks: str
    quantity: str
    remedy: str
    fails: tuple[float, float]
    holds: tuple[float, float]
    measure: Callable[[int], Measured]

    def holds_for(self, measured: Measured) -> bool:
        """Whether both numbers lie within their intervals."""
        sides = ((self.fails, measured.before), (self.holds, measured.after))
        return all(low <= number <= high for (low, high), number in sides)

    def report(self, measured: Measured) -> str:
        """The lines that ``sunfleck lab NAME`` prints."""
        rows: Mapping[str, str] = {
            "experiment": f"{self.name}: {self.line}",
            "claim": self.claim,
            "break": self.breaks,
            "number": f"{measured.before:.6g} ({self.quantity}; fails within {_interval(self.fails)})",
            "remedy": self.remedy,
            "number after": f"{measured.after:.6g} (holds within {_interval(self.holds)})",
        }
        return "\n".join(f"{key + ':':<14}{text}" for key, text in rows.items())


def _interval(bounds: tuple[float, float]) -> str:
    return f"[{bounds[0]:g}, {bounds[1]:g}]"


def scatter(points: Array, x: str = "u0", y: str = "u1") -> Panel:
    """Points, shape (n, 2): smaller dots where there are many, 4,000 of them at the most."""
    shown = points[:4000]
    size = float(np.clip(60 / max(len(shown), 1) ** 0.5, 1.2, 4))
    return Panel("", x, y, [Series("points", shown[:, 0], shown[:, 1], line=False, marker_size=size)], False, False)


def bars(values: Mapping[str, float], y: str) -> Panel:
    """A bar for each name."""
    made = Series("value", np.arange(len(values)), list(values.values()), labels=list(values), bars=True)
    return Panel("", "", y, [made], False, False)


def lines(curves: Mapping[str, tuple[Array, Array]], x: str, y: str, log: bool = False) -> Panel:
    """A curve for each name, with markers where its points are few."""
    made = [Series(name, *curve, marker_size=4 if len(curve[0]) < 100 else 0) for name, curve in curves.items()]
    return Panel("", x, y, made, log, log)


def image(values: Array, x: str, y: str) -> Panel:
    """Values as colours, shape (rows, columns)."""
    return Panel("", x, y, [], False, False, image=values)
