# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""fit: what a chart says beside its points: slopes and what theory has for them, fronts, winners."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sunfleck.integrands import Integrand

__all__ = ["FLOOR", "Fit", "fit_slope", "log_allowance", "pareto_front", "theory_of", "winners"]

FLOOR = 1e-14
"""Below, errors are those of double precision's sums."""


class Fit(NamedTuple):
    """A line through log error over log n."""

    slope: float
    error: float
    """The slope's standard error; 0 where all seeds gave the same."""
    counts: NDArray[np.float64]
    """The n that it was fitted to."""


def fit_slope(counts: Sequence[int], errors: Sequence[ArrayLike]) -> Fit | None:
    """The slope of the root mean square error, weights equal, over n >= 64 where enough is left.

    Parameters
    ----------
    counts : sequence of int
        n, rising.
    errors : sequence of array_like
        For each n, the errors of several seeds.

    Returns
    -------
    Fit or None
        None where fewer than three counts have an error above rounding.

    Notes
    -----
    The standard error follows from the seeds: log of the mean square of S errors e has the
    standard error sd(e²) / (mean(e²) √S) by the delta method, and its half is that of log RMS.
    Errors at different n must be independent.
    """
    squares = [np.asarray(e, float) ** 2 for e in errors]
    kept = [(n, s) for n, s in zip(counts, squares, strict=True) if math.sqrt(s.mean()) > FLOOR]
    if len([n for n, _ in kept if n >= 64]) >= 4:
        kept = [(n, s) for n, s in kept if n >= 64]
    if len(kept) < 3:
        return None
    n = np.array([float(n) for n, _ in kept])
    x = np.log(n) - np.log(n).mean()
    y = np.array([0.5 * math.log(s.mean()) for _, s in kept])
    deviation = np.array([s.std(ddof=1) / (2 * s.mean() * math.sqrt(len(s))) if len(s) > 1 else 0.0 for _, s in kept])
    weight = x / (x @ x)
    return Fit(float(weight @ y), float(np.sqrt(weight**2 @ deviation**2)), n)


def log_allowance(d: int, counts: NDArray[np.float64]) -> float:
    """How much flatter (log n)^((d - 1)/2) makes a slope that is fitted over these n."""
    x = np.log(counts) - np.log(counts).mean()
    return float((d - 1) / 2 * (x @ np.log(np.log(counts))) / (x @ x))


def theory_of(pattern: str, scramble: str, integrand: Integrand) -> float | None:
    """The exponent of n that theory has for the root mean square error, logarithms aside.

    Parameters
    ----------
    pattern, scramble : str
        As `sunfleck.points` takes them, "default" resolved.
    integrand : Integrand

    Returns
    -------
    float or None
        None where no theorem is known to us.

    Notes
    -----
    With A the pole's exponent, d the dimensions:

    - one dimension, x^-A: n^(A-1) where the stratum at 0 decides, which it does for random
      points from A = 1/2 on (then the error's median), and for stratified ones always.
    - random: -1/2.
    - jittered: n strata of diameter n^(-1/d): -1/2 - 1/d; an indicator varies only in the
      n^(1-1/d) strata on its border: -1/2 - 1/(2d). Multi-jittered pairs likewise.
    - latin: what is not a sum of functions of one variable stays at -1/2 (Stein 1987), else -3/2.
    - scrambled nets: -3/2 (Owen 1997), for lms too (Owen 2003); indicators -1/2 - 1/(2d)
      (He & Wang 2015).
    - the others, of bounded variation: -1 (Koksma & Hlawka).
    - uniform, smooth: the midpoint rule's -2/d.
    """
    d, kind = integrand.d, integrand.kind
    net = pattern in ("sobol", "sz") and scramble in ("owen", "nested", "lms")
    if kind == "singular":
        stratified = net or pattern in ("jittered", "latin")
        return max(integrand.pole - 1, -0.5) if pattern == "random" else integrand.pole - 1 if stratified else None
    if pattern == "random":
        return -0.5
    if kind == "rare":
        return None
    if pattern == "latin":
        return -1.5 if d == 1 and kind == "smooth" else -0.5
    if pattern == "jittered" or (pattern == "multijittered" and d == 2):
        return -0.5 - (0.5 if kind == "discontinuous" else 1.0) / d
    if net:
        return {"smooth": -1.5, "discontinuous": -0.5 - 0.5 / d}.get(kind)
    if pattern == "uniform":
        return -2 / d if kind == "smooth" else None
    bounded = kind != "discontinuous"
    return -1.0 if bounded and pattern in ("halton", "hammersley", "sobol", "sz", "lattice", "r2") else None


def pareto_front(x: ArrayLike, y: ArrayLike) -> NDArray[np.intp]:
    """Indices of the points that no other beats in both, by rising x.

    Examples
    --------
    >>> from sunfleck.chart.fit import pareto_front
    >>> pareto_front([1, 2, 3, 4], [9, 4, 5, 1]).tolist()
    [0, 1, 3]
    """
    x, y = np.asarray(x, float), np.asarray(y, float)
    order = np.lexsort((y, x))
    best = np.minimum.accumulate(np.concatenate([[np.inf], y[order]]))[:-1]
    return order[y[order] < best]


def winners(names: Sequence[str], x: ArrayLike, y: ArrayLike) -> list[tuple[float, str, float]]:
    """For every budget, a power of ten of x: who has the least y within it, and that y.

    Examples
    --------
    >>> from sunfleck.chart.fit import winners
    >>> winners(["a", "b", "a"], [0.02, 0.5, 3.0], [0.1, 0.05, 0.01])
    [(0.1, 'a', 0.1), (1.0, 'b', 0.05), (10.0, 'a', 0.01)]
    """
    x, y = np.asarray(x, float), np.asarray(y, float)
    found: list[tuple[float, str, float]] = []
    for decade in range(math.floor(math.log10(x.min())) + 1, math.ceil(math.log10(x.max())) + 1):
        inside = np.flatnonzero(x <= 10.0**decade)
        best = inside[np.argmin(y[inside])]
        if found and found[-1][2] <= y[best]:  # more time brings no more
            continue
        found.append((10.0**decade, names[best], float(y[best])))
    return found
