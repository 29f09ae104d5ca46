# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""integrands: functions on the unit cube whose integrals are known, to measure patterns and rules with."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sunfleck.points import points

__all__ = ["INTEGRANDS", "Integrand", "standard_deviation"]

Block = NDArray[Any]


class Integrand(NamedTuple):
    """A function of points in [0,1)^d, and what it comes to."""

    title: str
    d: int
    kind: str
    """"smooth", "kinked", "discontinuous", "rare" or "singular"."""
    f: Callable[[Block], Block]
    """Gets points of shape (n, d), float64, returns (n,)."""
    exact: float
    """The integral."""
    value_range: tuple[float, float] | None = None
    """Where its values lie, where that is of use."""
    pole: float = 0.0
    """A of a singular one, which grows as x^-A; its variance is infinite from 1/2 on."""


def _mean_excess(d: int, c: int) -> float:
    """E max(S - c, 0) of the sum S of d uniforms (Irwin & Hall's density, integrated exactly)."""
    total = sum(Fraction((-1) ** k * math.comb(d, k) * (d - c - k) ** (d + 1)) for k in range(d - c + 1))
    return float(total / math.factorial(d + 1))


def _sum_below(d: int, c: int) -> float:
    """P(S < c) of the sum S of d uniforms (Irwin & Hall)."""
    total = sum(Fraction((-1) ** k * math.comb(d, k) * (c - k) ** d) for k in range(c + 1))
    return float(total / math.factorial(d))


def _circle(u: Block) -> Block:
    value: Block = 4.0 * (u[:, 0] ** 2 + u[:, 1] ** 2 < 1.0)
    return value


def _corner(u: Block) -> Block:
    value: Block = (u < 0.01).all(axis=1).astype(float)
    return value


def _product(u: Block) -> Block:
    """Integrated over y it is e^x - 1."""
    value: Block = u[:, 0] * np.exp(u[:, 0] * u[:, 1])
    return value


def _peak(u: Block) -> Block:
    value: Block = np.exp(-25 * ((u - 0.5) ** 2).sum(axis=1))
    return value


def _oscillation(u: Block) -> Block:
    value: Block = np.cos(0.6 * math.pi + u @ np.arange(1.0, 6.0))
    return value


def _oscillation_exact() -> float:
    product = np.prod([(np.exp(1j * a) - 1) / (1j * a) for a in range(1, 6)])
    return float((np.exp(0.6j * math.pi) * product).real)


def _g_function(u: Block) -> Block:
    a = np.arange(1.0, 7.0)
    value: Block = np.prod((np.abs(4 * u - 2) + a) / (1 + a), axis=1)
    return value


def _product_exponential(u: Block) -> Block:
    value: Block = np.exp(u @ (1 / np.arange(1.0, 11.0)))
    return value


def _mean_exponential(u: Block) -> Block:
    value: Block = np.exp(u.sum(axis=1) / 20)
    return value


def _call(u: Block) -> Block:
    value: Block = np.maximum(u.sum(axis=1) - 11, 0)
    return value


INTEGRANDS: dict[str, Integrand] = {
    "exp": Integrand("exp x", 1, "smooth", lambda u: np.exp(u[:, 0]), math.e - 1, (1, math.e)),
    "product": Integrand("x exp(x y)", 2, "smooth", _product, math.e - 2, (0, math.e)),
    "peak": Integrand("Gaussian peak", 3, "smooth", _peak,
                      (math.sqrt(math.pi) / 5 * math.erf(2.5)) ** 3, (0, 1)),
    "oscillation": Integrand("oscillation", 5, "smooth", _oscillation, _oscillation_exact(), (-1, 1)),
    "exp-sum": Integrand("exp of a sum", 10, "smooth", _product_exponential,
                         math.prod(k * (math.exp(1 / k) - 1) for k in range(1, 11))),
    "exp-mean": Integrand("exp of a mean", 20, "smooth", _mean_exponential,
                          (20 * (math.exp(1 / 20) - 1)) ** 20, (1, math.e)),
    "kink": Integrand("|x + y - 1|", 2, "kinked", lambda u: np.abs(u[:, 0] + u[:, 1] - 1), 1 / 3, (0, 1)),
    "g": Integrand("g function", 6, "kinked", _g_function, 1.0),
    "call": Integrand("call on a sum", 20, "kinked", _call,
                      _mean_excess(20, 11), (0, 9)),
    "circle": Integrand("circle (π)", 2, "discontinuous", _circle, math.pi, (0, 4)),
    "simplex": Integrand("simplex", 8, "discontinuous", lambda u: (u.sum(axis=1) < 3.0).astype(float),
                         _sum_below(8, 3), (0, 1)),
    "corner": Integrand("rare corner, p = 1e-4", 2, "rare", _corner, 1e-4, (0, 1)),
    "pole": Integrand("x^-0.45", 1, "singular", lambda u: (u[:, 0] + 1e-300) ** -0.45, 1 / 0.55, pole=0.45),
    "heavy-pole": Integrand("x^-0.6", 1, "singular", lambda u: (u[:, 0] + 1e-300) ** -0.6, 1 / 0.4, pole=0.6),
}  # fmt: skip
"""The integrands: name → what it is. "g" is Sobol's g function, "call" the payoff of an option."""


@functools.cache
def standard_deviation(name: str, n: int = 2**18) -> float:
    """Of an integrand's value at a random point; infinite where its variance is.

    Parameters
    ----------
    name : str
        One of `INTEGRANDS`.
    n : int
        Points that it is told from.

    Returns
    -------
    float

    Examples
    --------
    >>> from sunfleck.integrands import standard_deviation
    >>> round(standard_deviation("kink"), 4)  # the root of 1/6 - 1/9
    0.2357
    """
    integrand = INTEGRANDS[name]
    if integrand.pole:  # E x^-2A - (E x^-A)^2; points near the pole are too few to tell
        return math.sqrt(1 / (1 - 2 * integrand.pole) - integrand.exact**2) if integrand.pole < 0.5 else math.inf
    values = integrand.f(points("sobol", n, integrand.d, seed=1, dtype="float64"))
    return float(np.sqrt(np.mean((values - integrand.exact) ** 2)))
