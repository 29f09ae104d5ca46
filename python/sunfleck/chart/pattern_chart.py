# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""pattern_chart: patterns' errors against samples and seconds, on integrands and on a scene's pixels."""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sunfleck._arguments import choice
from sunfleck.chart.cells import Cell, Key, Store, least_time
from sunfleck.chart.fit import FLOOR, Fit, fit_slope, log_allowance, pareto_front, theory_of, winners
from sunfleck.chart.pixels import RENDER_PATTERNS, Pixels
from sunfleck.integrands import INTEGRANDS, Integrand, standard_deviation
from sunfleck.plot.figure import Panel, Series
from sunfleck.points import PATTERNS, SCRAMBLES, points, valid_counts

__all__ = ["DEFAULT_PATTERNS", "VARIANTS", "Method", "method_named", "pattern_cells", "pattern_panels"]

DEFAULT_PATTERNS = ("random", "sobol", "jittered", "halton", "latin", "lattice:shift", "uniform")
_DEFAULT_SCRAMBLE = {"sobol": "owen", "sz": "owen", "halton": "permuted"}
_THREADS = 16

Points = Callable[[int, int, int], NDArray[Any]]


class Method(NamedTuple):
    """A pattern as it is charted: its name there, what it claims to be, and how its points are made."""

    name: str
    pattern: str
    scramble: str
    make: Points
    """n, d, seed: points of shape (n, d), float64."""
    about: str = ""


def _without_first(n: int, d: int, seed: int) -> NDArray[Any]:
    """Points 1 .. n of Sobol's sequence rather than 0 .. n - 1."""
    first = points("sobol", n, d, seed=seed, dtype="float64", threads=1)
    return np.concatenate([first[1:], points("sobol", 1, d, seed=seed, start=n, dtype="float64", threads=1)])


def _same_seed_threads(n: int, d: int, seed: int) -> NDArray[Any]:
    """What so many threads draw that all start alike: each of n / 16 points, 16 times."""
    each = points("random", max(1, n // _THREADS), d, seed=seed, dtype="float64", threads=1)
    return np.tile(each, (-(-n // len(each)), 1))[:n]


def _same_seed_dimensions(n: int, d: int, seed: int) -> NDArray[Any]:
    """A generator for each dimension, all with one seed: the points lie on the diagonal."""
    return np.repeat(points("random", n, 1, seed=seed, dtype="float64", threads=1), d, axis=1)


VARIANTS: dict[str, Method] = {
    variant.name: variant
    for variant in (
        Method("sobol-dropped-first", "sobol", "owen", _without_first, "Sobol's sequence from its second point on"),
        Method("random-shared-seeds", "random", "none", _same_seed_threads, f"{_THREADS} threads with one seed"),
        Method("random-shared-dimensions", "random", "none", _same_seed_dimensions, "dimensions with one seed"),
    )
}
"""Patterns broken on purpose, to see what that looks like on a chart."""


def method_named(name: str) -> Method:
    """A pattern by its name in the chart: NAME, NAME:SCRAMBLE, or one of `VARIANTS`.

    Raises
    ------
    ValueError
        There is none of that name, or it does not take that scramble.
    """
    if name in VARIANTS:
        return VARIANTS[name]
    pattern, _, scramble = name.partition(":")
    if pattern not in PATTERNS:
        allowed = ", ".join([*PATTERNS, *VARIANTS])
        raise ValueError(f"there is no pattern {name!r}; give some of {allowed}, or NAME:SCRAMBLE")
    given = choice(f"the scramble of {name!r}", scramble or "default", SCRAMBLES)
    make = functools.partial(_points, pattern, None if given == "none" else given)
    make(valid_counts(pattern, 4, 2)[1] or 4, 2, 0)  # refuses a scramble that the pattern does not take
    return Method(name, pattern, scramble or _DEFAULT_SCRAMBLE.get(pattern, "none"), make)


def _points(pattern: str, scramble: str | None, n: int, d: int, seed: int) -> NDArray[Any]:
    return points(pattern, n, d, seed=seed, scramble=scramble, dtype="float64", threads=1)


def _measure(method: Method, integrand: Integrand, n: int, seed: int) -> dict[str, float]:
    """The error of the mean of n values, and the thread's own seconds for points and values."""
    start = time.thread_time()
    # Seeds differ from one n to the next: errors at two n are independent.
    values = integrand.f(method.make(n, integrand.d, (n << 24) + seed))
    mean = float(values.mean())
    return {"error": mean - integrand.exact, "seconds": time.thread_time() - start}


def _counts(method: Method, d: int, max_samples: int) -> list[int]:
    """Powers of two from 16 on, or what the pattern takes below them."""
    known = [valid_counts(method.pattern, 1 << k, d)[0] for k in range(4, max_samples.bit_length())]
    return sorted({n for n in known if n is not None and n >= 4})


def _weight(name: str, n: int) -> float:
    """By values, beside some 50 microseconds of calls."""
    return 1e4 + n * INTEGRANDS[name].d


def pattern_cells(
    methods: Sequence[Method], integrands: Sequence[str], pixels: Pixels | None, max_samples: int, max_spp: int
) -> list[Cell]:
    """What a chart of patterns measures."""
    cells = [
        Cell((name, method.name, n), functools.partial(_measure, method, INTEGRANDS[name], n), _weight(name, n))
        for name in integrands
        for method in methods
        for n in _counts(method, INTEGRANDS[name].d, max_samples)
    ]
    if pixels is None:
        return cells
    shown = [m for m in methods if m.name in RENDER_PATTERNS]
    spps = [1 << k for k in range(2, max_spp.bit_length())]
    return [*cells, pixels.reference_cell(), *(pixels.fixed_cell(m.name, spp) for m in shown for spp in spps)]


class _Curve(NamedTuple):
    """What one method came to on one integrand."""

    method: Method
    counts: list[int]
    errors: list[NDArray[np.float64]]
    seconds: list[float]

    def quantile(self, q: float) -> list[float]:
        """Of the errors' sizes; those of rounding alone are not drawn."""
        values = [float(np.quantile(e, q)) for e in self.errors]
        return [value if value > FLOOR else float("nan") for value in values]


def _curves(case: str, methods: Sequence[Method], keys: Sequence[Key], seeds: int, store: Store) -> list[_Curve]:
    found = []
    for method in methods:
        known = [(key[2], store.get(key, seeds)) for key in keys if key[:2] == (case, method.name)]
        cells = [(n, numbers) for n, numbers in sorted(known, key=lambda pair: pair[0]) if numbers]
        if cells:
            counts, numbers = zip(*cells, strict=True)
            errors = [np.abs(cell["error"]) for cell in numbers]
            seconds = [least_time(cell["seconds"]) for cell in numbers]
            found.append(_Curve(method, list(counts), errors, seconds))
    return found


def verdict(method: Method, integrand: Integrand, curve: tuple[Sequence[int], Sequence[Any]], sigma: float) -> str:
    """Slope, theory's, and a mark where it is worse than theory by more than four standard errors.

    The mark allows for theory's logarithm and 0.05 for counts that are no squares. It is set
    where theory's regime is known to be reached: in at most two dimensions (the Gaussian peak in
    three takes 2^15 points of sobol to fall as n^-3/2), off the poles. Of random points theory has
    the constant too, sigma / sqrt(n): twenty per cent more is marked.
    """
    counts, errors = curve
    if (
        integrand.kind == "singular"
    ):  # the fourth moment is infinite: the root mean square would need a great many seeds
        errors = [[np.median(np.abs(e))] for e in errors]
    fit = fit_slope(counts, errors)
    theory = theory_of(method.pattern, method.scramble, integrand)
    if fit is None:
        exact = all(np.max(np.abs(e)) < FLOOR for e in errors)
        return f"{method.name}: {'exact' if exact else 'no slope'}"
    text = f"{method.name}: {fit.slope:.2f}"
    if theory is None:
        return text
    text += f" (theory {theory:.3g})"
    if integrand.d > 2 or integrand.kind in ("singular", "rare"):
        return text
    if method.pattern == "random":
        excess = float(np.sqrt(np.mean([n * np.mean(np.square(e)) for n, e in zip(*curve, strict=True)])) / sigma)
        if excess > 1.2:
            return f"{text} ✗ {excess:.1f} × σ/√n"
    return f"{text} ✗" if fit.error and fit.slope > theory + _allowed(fit, integrand.d) else text


def _allowed(fit: Fit, d: int) -> float:
    return 4 * fit.error + log_allowance(d, fit.counts) + (0.05 if d > 1 else 0.0)


def _time_panel(title: str, curves: Sequence[_Curve]) -> tuple[Panel, str]:
    x, y = np.concatenate([c.seconds for c in curves]), np.concatenate([c.quantile(0.5) for c in curves])
    seen = np.isfinite(y)
    names = np.array([c.method.name for c in curves for _ in c.counts])[seen].tolist()
    x, y = x[seen], y[seen]
    front = pareto_front(x, y)
    series = [Series(c.method.name, c.seconds, c.quantile(0.5)) for c in curves]
    series.append(Series("Pareto front", x[front], y[front], line=False, style="front"))
    best = [f"in {budget:.0e} s: {name} {error:.1e}" for budget, name, error in winners(names, x, y)]
    return Panel(
        title, "seconds", "error, median", series, note="\n".join(["rings: Pareto front", *best]), legend=False
    ), "; ".join(best)


def _case_panels(title: str, x: str, curves: Sequence[_Curve], labels: Sequence[str]) -> tuple[list[Panel], str]:
    series = [
        Series(c.method.name, c.counts, c.quantile(0.5), c.quantile(0.1), c.quantile(0.9), label=label)
        for c, label in zip(curves, labels, strict=True)
    ]
    timed, best = _time_panel(title, curves)
    return [
        Panel(title, x, "error, median", series),
        timed,
    ], f"{title}\n  slopes  {', '.join(labels)}\n  best    {best}"


def pattern_panels(
    methods: Sequence[Method], cells: Sequence[Cell], pixels: Pixels | None, seeds: int, store: Store
) -> tuple[list[Panel], str]:
    """Two panels a case, and the findings in words."""
    keys = [cell.key for cell in cells]
    panels: list[Panel] = []
    text = [
        "error: median over seeds, shaded from 10 to 90 %; slopes of the root mean square (singular: of the median)"
    ]
    for case in dict.fromkeys(key[0] for key in keys):
        curves = _curves(case, methods, keys, seeds, store)
        if not curves:
            continue
        if case in INTEGRANDS:
            it, sigma = INTEGRANDS[case], standard_deviation(case)
            labels = [verdict(c.method, it, (c.counts, c.errors), sigma) for c in curves]
            made, words = _case_panels(f"{it.title}: {it.kind}, d = {it.d}", "samples", curves, labels)
        else:
            assert pixels is not None
            fits = [(c, fit_slope(c.counts, c.errors)) for c in curves]
            labels = [c.method.name + (f": {fit.slope:.2f}" if fit else "") for c, fit in fits]
            made, words = _case_panels(case, "samples a pixel", curves, labels)
            words += f"\n  {pixels.about(store)}"
        panels += made
        text.append(words)
    return panels, "\n".join(text)
