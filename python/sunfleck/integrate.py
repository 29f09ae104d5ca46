# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""integrate: the integral of a function over [0,1)^d, to a tolerance at a confidence."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sunfleck import _core
from sunfleck._arguments import array_of, integer, number, text
from sunfleck._seed import UNSET, Unset, seed_from
from sunfleck.tolerance import Tolerance

__all__ = ["Integral", "IntegralLook", "integrate"]


class IntegralLook(NamedTuple):
    """What was known after ``samples`` evaluations of the function."""

    samples: int
    value: float
    half_width: float


@dataclass(frozen=True)
class Integral:
    """An integral and how far it may be off. Made by `integrate`.

    Attributes
    ----------
    value : float
        NaN where no sample was finite.
    half_width : float
        Bounds ``abs(value - integral)`` with the confidence. Never 0; infinite where nothing is known.
    samples : int
        Evaluations of the function, all of them.
    stop_reason : str
        "met": the half-width is within the tolerance. "max samples": the next look would have
        needed more. "interrupted": by Ctrl-C. "suspicious": met or not, the half-width can't be
        trusted: samples were not finite, or the means of the replicates follow the most extreme
        sample of each (a heavy tail, or an event seen less than about once in each).
    nonfinite : int
        Samples that were NaN or infinite: counted, never averaged in.
    confidence : float
        That was asked for.
    replicates : int
        Copies of the pattern, each randomized on its own.
    shifted : bool
        Whether the copies were shifted at random, the seed leaving the pattern where it is.
    history : tuple of IntegralLook
        (samples, value, half_width) at each look, for a chart.
    """

    value: float
    half_width: float
    samples: int
    stop_reason: str
    nonfinite: int
    confidence: float
    replicates: int
    shifted: bool
    history: tuple[IntegralLook, ...]

    def __str__(self) -> str:
        text = f"{self.value:.6g} ± {self.half_width:.2g} ({100 * self.confidence:g} %), {self.samples} samples: "
        return text + self.stop_reason + (f", {self.nonfinite} not finite" if self.nonfinite else "")


def _values(values: Any, count: int) -> NDArray[np.float64]:
    """What the function returned, as the numbers that C takes."""
    array = array_of("what f returned", values)
    if array.dtype.kind not in "fiub":
        raise TypeError(f"f returned values of dtype {array.dtype}; it must return real numbers")
    if array.shape != (count,):
        raise ValueError(f"f returned shape {array.shape} for {count} points; it must return ({count},)")
    return np.ascontiguousarray(array, np.float64)


def _range(value: Sequence[float] | None) -> tuple[float, float]:
    if value is None:
        return -math.inf, math.inf
    try:
        low, high = value
    except (TypeError, ValueError):
        raise ValueError(f"value_range is {value!r}; give (low, high)") from None
    low, high = number("value_range's low", low), number("value_range's high", high)
    if not (math.isfinite(low) and math.isfinite(high)):  # C's word for "unknown"
        raise ValueError(f"value_range is {value!r}; give finite low < high, or None for unknown")
    return low, high


def integrate(
    f: Callable[[NDArray[np.float64]], ArrayLike],
    d: int = 2,
    pattern: str = "sobol",
    tolerance: float | Tolerance = 1e-3,
    confidence: float = 0.95,
    max_samples: int = 2**24,
    *,
    min_samples: int = 1024,
    replicates: int = 16,
    value_range: Sequence[float] | None = None,
    scramble: str | None = "default",
    seed: Any = 0,
    threads: int | None = 1,
    rng: Any | Unset = UNSET,
) -> Integral:
    """Integrates a function over [0,1)^d to a tolerance at a confidence.

    Parameters
    ----------
    f : callable
        Gets a block of points, ndarray of float64, shape (n, d), in [0, 1), its own to keep or
        overwrite; returns n real numbers, shape (n,). n varies, up to about 8,192.
    d : int
        Dimensions, at least 1.
    pattern : str
        One of `sunfleck.PATTERNS`.
    tolerance : float or Tolerance
        A plain number is absolute, in f's unit.
    confidence : float
        That the half-width bounds the error, in (0, 1).
    max_samples : int
        Evaluations of f in all, at most.
    min_samples : int
        Before the first look, at least 2; rounded up to what the replicates can take.
    replicates : int
        Independent copies of the pattern, 2 to 1,024. More make the half-width steadier, fewer
        leave more points to each: by 16 most of the former is won.
    value_range : (low, high), optional
        Where the values of f are known to lie; others are refused. With pattern "random" the
        interval then is a confidence sequence, which holds for any such f at every count.
    scramble : str or None
        As in `points`. Where it leaves the pattern, or a coordinate, where it is (None does),
        each replicate is shifted at random, modulo 1.
    seed : int, None, numpy.random.Generator, numpy.random.SeedSequence or Rng
        As in `points`: an int in [0, 2^64), or a source of 64 bits that is advanced by them. None:
        from the system.
    threads : int, optional
        That make the points; f is called on the caller's thread. None: one for each processor.
        Changes no bit.
    rng : optional
        Another name of `seed`, as SciPy and NumPy have it. Give one of them.

    Returns
    -------
    Integral

    Raises
    ------
    ValueError, TypeError
        An option out of its range or of the wrong kind, before f is called; values of f of the
        wrong shape or dtype, or outside ``value_range``.
    Exception
        Whatever f raises.

    Notes
    -----
    Each replicate is a copy of the pattern with a seed of its own; Student's t on the means of
    the replicates gives the half-width, since points of a pattern are not independent of one
    another. Points double between looks. Each look has half of the error probability, so that
    stopping at the first that meets the tolerance errs as often as asked, or less; ``history``
    holds look by look, not all at once. "random" is judged by its samples, which are independent:
    each look has 0.8 of the error probability, and falls where the tolerance should be met.

    Where all samples, or the means of all replicates, are equal to the last bit, the half-width
    is -log(1 - confidence) / samples of the values' range (the rule of three): of
    ``value_range``, else as seen, else the value itself, else 1.

    Ctrl-C returns what is known so far. The same seed gives the same result.

    References
    ----------
    L'Ecuyer, Nakayama, Owen & Tuffin 2023, "Confidence intervals for randomized quasi-Monte
    Carlo estimators".
    Cranley & Patterson 1976, "Randomization of number theoretic methods for multiple integration".
    Waudby-Smith & Ramdas 2023, "Estimating means of bounded random variables by betting".

    Examples
    --------
    π by the circle: points in the square, and the share of them that is inside.

    >>> import sunfleck as sf
    >>> pi = sf.integrate(lambda u: 4.0 * (u[:, 0] ** 2 + u[:, 1] ** 2 < 1.0), d=2)
    >>> abs(pi.value - 3.14159265) <= pi.half_width <= 1e-3
    True
    >>> pi.stop_reason
    'met'
    """
    if not callable(f):
        raise TypeError(f"f is {f!r}; give a function of a block of points")
    if not isinstance(tolerance, Tolerance):
        tolerance = Tolerance(absolute=number("tolerance", tolerance))
    if threads is not None and integer("threads", threads, bits=32) == 0:  # C's word for all processors
        raise ValueError("threads is 0; give at least 1, or None for one for each processor")
    low, high = _range(value_range)
    confidence = number("confidence", confidence)
    found = _core.integrate(
        lambda u: _values(f(u), len(u)),
        pattern=text("pattern", pattern),
        scramble="none" if scramble is None else text("scramble", scramble),
        dims=integer("d", d, bits=32),
        seed=seed_from(seed, rng),
        absolute=tolerance.absolute,
        relative=tolerance.relative,
        confidence=confidence,
        min_samples=integer("min_samples", min_samples),
        max_samples=integer("max_samples", max_samples),
        replicates=integer("replicates", replicates, bits=32),
        low=low,
        high=high,
        threads=threads or 0,
    )
    history = tuple(IntegralLook(*look) for look in found.pop("history"))
    return Integral(**found, confidence=confidence, history=history)
