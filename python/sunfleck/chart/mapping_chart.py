# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""mapping_chart: nanoseconds a point against the evenness that a mapping keeps, and its rounding."""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sunfleck import mapping
from sunfleck.chart.cells import TIMINGS, Cell, Store, least_time
from sunfleck.plot.figure import Panel, Series
from sunfleck.points import points

__all__ = ["PARAMETERS", "accuracy", "mapping_cells", "mapping_panels"]

_TRIANGLE: dict[str, Any] = {"a": (0.0, 0.0, 1.0), "b": (1.0, 0.0, 1.0), "c": (0.0, 1.0, 1.0)}

PARAMETERS: dict[str, dict[str, Any]] = {
    "triangle": _TRIANGLE,
    "triangle_low_distortion": _TRIANGLE,
    "parallelogram": _TRIANGLE,
    "annulus": {"inner": 0.5},
    "regular_polygon": {"sides": 6},
    "cone": {"angle": 0.5},
    "power_cosine": {"exponent": 20},
    "henyey_greenstein": {"g": 0.7},
    "ggx_visible_normals": {"w": (0.6, 0.0, 0.8), "alpha_x": 0.3, "alpha_y": 0.3},
    "spherical_triangle": _TRIANGLE,
    "spherical_rectangle": _TRIANGLE,
}
"""What the mappings that need parameters are measured with."""

PATTERNS = ("sobol", "jittered", "random")

_POINTS = 1024  # a square, for jittered
_FILL = 1 << 16
_ACCURACY = 1 << 18
_CUTS = 512
_DRAWN_AS_ZERO = 0.1

Array = NDArray[Any]


def accuracy(name: str, n: int = _ACCURACY) -> tuple[Array, Array]:
    """How far float32 samples of `n` Sobol points are from float64 ones, and round trips from u, in units of 2^-24."""
    of, named = getattr(mapping, name), PARAMETERS.get(name, {})
    u = points("sobol", n, seed=1)
    x = of.sample(u, **named)
    error = np.abs(x - of.sample(u.astype(np.float64), **named)).max(axis=1) * 2.0**24
    moved = np.abs(of.invert(x, **named) - u)
    return error, np.minimum(moved, 1 - moved).max(axis=1) * 2.0**24


def _accuracy_cell(name: str, _seed: int) -> dict[str, float]:
    error, moved = accuracy(name)
    return {"ulps": float(np.quantile(error, 0.999)), "ulps_most": float(error.max()),
            "round_trip": float(np.quantile(moved, 0.999))}  # fmt: skip


class _Cuts(NamedTuple):
    """Half spaces through a shape, and the share of it that lies in each."""

    normal: Array
    height: Array
    share: Array


@functools.cache
def _cuts(name: str) -> _Cuts:
    """Of directions that are uniform, through random points of the shape; shares from 2^16 Sobol points."""
    x = getattr(mapping, name).sample(points("sobol", 1 << 16, seed=7, dtype="float64"), **PARAMETERS.get(name, {}))
    rng = np.random.default_rng(1)
    normal = rng.normal(size=(_CUTS, x.shape[1]))
    height = (x[rng.integers(len(x), size=_CUTS)] * normal).sum(axis=1)
    share = np.array([np.mean(x @ n > h) for n, h in zip(normal, height, strict=True)])
    return _Cuts(normal, height, share)


def _discrepancy(name: str, pattern: str, seed: int) -> dict[str, float]:
    """The largest difference between the share of the points and that of the shape, over the cuts."""
    u = points(pattern, _POINTS, seed=seed, dtype="float64")
    x = getattr(mapping, name).sample(u, **PARAMETERS.get(name, {}))
    cuts = _cuts(name)
    return {"discrepancy": float(np.abs((x @ cuts.normal.T > cuts.height).mean(axis=0) - cuts.share).max())}


def _speed(name: str, seed: int) -> dict[str, float]:
    """Nanoseconds a point of the thread's own time, outputs allocated beforehand, the second of two calls."""
    of, named = getattr(mapping, name), PARAMETERS.get(name, {})
    u = points("sobol", _FILL, seed=seed)
    x = of.sample(u, **named)
    pdf, back = np.empty(_FILL, np.float32), np.empty_like(u)
    calls: dict[str, Callable[[], Any]] = {
        "sample": lambda: of.sample(u, out=x, **named),
        "pdf": lambda: of.pdf(x, out=pdf, **named),
        "invert": lambda: of.invert(x, out=back, **named),
    }
    found = {}
    for what, call in calls.items():
        call()
        start = time.thread_time()
        call()
        found[what] = 1e9 * (time.thread_time() - start) / _FILL
    return found


def mapping_cells(names: Sequence[str]) -> list[Cell]:
    """What a chart of mappings measures."""
    cells = [Cell((name, "nanoseconds", _FILL), functools.partial(_speed, name), 1.0) for name in names]
    cells += [
        Cell((name, p, _POINTS), functools.partial(_discrepancy, name, p), 5.0) for name in names for p in PATTERNS
    ]
    cells += [Cell((name, "float32", _ACCURACY), functools.partial(_accuracy_cell, name), 20.0, 1) for name in names]
    return cells


def _middle(store: Store, key: tuple[str, str, float], seeds: int, what: str) -> float:
    numbers = store.get(key, seeds)
    if not numbers:
        return float("nan")
    return least_time(numbers[what]) if what in TIMINGS else float(np.median(numbers[what]))


def mapping_panels(names: Sequence[str], seeds: int, store: Store) -> tuple[list[Panel], str]:
    """Three panels, and the findings in words."""
    columns = {
        "sample": [_middle(store, (n, "nanoseconds", _FILL), seeds, "sample") for n in names],
        **{p: [_middle(store, (n, p, _POINTS), seeds, "discrepancy") for n in names] for p in PATTERNS},
        **{what: [_middle(store, (n, "float32", _ACCURACY), 1, what) for n in names] for what in ("ulps", "ulps_most")},
    }
    x = columns["sample"]
    panels = []
    for pattern in PATTERNS[:2]:
        share = np.divide(columns[pattern], columns["random"])
        series = [Series("mappings", x, share, line=False, labels=names)]
        if "pixel_box" in names:
            square = share[list(names).index("pixel_box")]
            series.append(Series("the square itself", [min(x), max(x)], [square] * 2, style="guide"))
        title = f"what {pattern} keeps"
        panels.append(Panel(title, "ns a point, float32", "discrepancy, of random points'", series, y_log=False))
    drawn = {what: np.maximum(columns[what], _DRAWN_AS_ZERO) for what in ("ulps", "ulps_most")}
    rounding = [
        Series("mappings", x, drawn["ulps"], line=False, labels=names, label="of 99.9 % of the points"),
        Series("the largest", x, drawn["ulps_most"], line=False),
    ]
    unit = f"units of 2^-24 ({_DRAWN_AS_ZERO}: none)"
    panels.append(Panel("rounding of float32", "ns a point, float32", unit, rounding))
    text = [
        "ns: median, one thread; discrepancy: largest difference of shares, median over seeds; units of 2^-24",
        f"{'':30} sample  {'  '.join(f'{p:8}' for p in PATTERNS)}  99.9 %  largest",
    ]
    for i, name in enumerate(names):
        shares = "  ".join(f"{columns[p][i]:<8.4f}" for p in PATTERNS)
        text.append(f"{name:30} {x[i]:6.2f}  {shares}  {columns['ulps'][i]:6.1f}  {columns['ulps_most'][i]:.1f}")
    return panels, "\n".join(text)
