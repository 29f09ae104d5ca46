# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""integrate: the integral of a function over a box, to a tolerance at a confidence."""

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
    value: Any
    half_width: Any


@dataclass(frozen=True, eq=False)
class Integral:
    """An integral and how far it may be off. Made by `integrate`.

    Attributes
    ----------
    value : float or ndarray of float64
        Of the shape of one value of f. NaN where no sample was finite.
    half_width : float or ndarray of float64
        Of the same shape. Bounds ``abs(value - integral)`` with the confidence. Never 0; infinite where nothing is
        known.
    samples : int
        Evaluations of the function, all of them.
    stop_reason : str
        "met": the half-width is within the tolerance. "max_samples": the next look would have
        needed more. "interrupted": by Ctrl-C. "suspicious": met or not, the half-width can't be
        trusted, in at least one component: samples were not finite; or the means of the replicates
        follow the most extreme sample of each, or the most extreme of all are spread as those of a
        law without a variance (a heavy tail, or an event seen less than about once in each); or
        all samples are 0 and no ``value_range`` says what may hide between them.
    nonfinite : int
        Samples that were NaN or infinite, over all components: counted, never averaged in.
    confidence : float
        That was asked for.
    replicates : int
        Copies of the pattern, each randomized on its own.
    shifted : bool
        Whether the copies were shifted at random, the seed leaving the pattern where it is.
    folded : bool
        Whether the copies were shifted and folded, so that a step shows in their spread.
    trusted : bool or ndarray of bool
        Which components are not suspicious.
    history : tuple of IntegralLook
        (samples, value, half_width) at each look, for a chart.
    """

    value: Any
    half_width: Any
    samples: int
    stop_reason: str
    nonfinite: int
    confidence: float
    replicates: int
    shifted: bool
    folded: bool
    trusted: Any
    history: tuple[IntegralLook, ...]

    def __str__(self) -> str:
        value = f"{self.value:.6g}" if np.ndim(self.value) == 0 else np.array2string(self.value, precision=6)
        width = self.half_width if np.ndim(self.value) == 0 else np.max(self.half_width)
        text = f"{value} ± {width:.2g} ({100 * self.confidence:g} %), {self.samples} samples: "
        return text + self.stop_reason + (f", {self.nonfinite} not finite" if self.nonfinite else "")

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Integral):
            return NotImplemented
        alike = all(
            np.array_equal(getattr(self, name), getattr(other, name))
            for name in self.__dataclass_fields__
            if name != "history"
        )
        looks = zip(self.history, other.history, strict=False)
        return (
            alike
            and len(self.history) == len(other.history)
            and all(np.array_equal(a, b) for mine, theirs in looks for a, b in zip(mine, theirs, strict=True))
        )

    def __hash__(self) -> int:
        return hash((self.samples, self.stop_reason, self.replicates, self.confidence))


class _OtherShape(Exception):
    """The function's values are not the numbers that were expected: begin again, with what they are."""


class _Function:
    """The user's function, as C calls it: values in one row, of the shape found at the first call."""

    def __init__(self, f: Callable[..., ArrayLike], args: tuple[Any, ...]) -> None:
        self.f = f
        self.args = args
        self.shape: tuple[int, ...] | None = None
        self.first: NDArray[np.float64] | None = None

    def __call__(self, u: NDArray[np.float64]) -> NDArray[np.float64]:
        if self.first is not None:  # the same points as at the call that found the shape
            kept, self.first = self.first, None
            return kept
        count = len(u)
        array = array_of("what f returned", self.f(u, *self.args))
        if array.dtype.kind not in "fiub":
            raise TypeError(f"f returned values of dtype {array.dtype}; it must return real numbers")
        wanted = "(n,) or (n, …)" if self.shape is None else str((count, *self.shape))
        if array.ndim == 0 or array.shape[0] != count or (self.shape is not None and array.shape[1:] != self.shape):
            raise ValueError(f"f returned shape {array.shape} for {count} points; it must return {wanted}")
        if array.size == 0:
            raise ValueError(f"f returned shape {array.shape}: no values")
        values = np.ascontiguousarray(array, np.float64).reshape(-1)
        if self.shape is None:
            self.shape = array.shape[1:]
            if self.shape:
                self.first = values
                raise _OtherShape
        return values


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


def _tolerance(tolerance: float | Tolerance | None, atol: float | None, rtol: float | None) -> Tolerance:
    """One of the two ways to say it; a plain number is relative, as in `render`."""
    if atol is None and rtol is None:
        if isinstance(tolerance, Tolerance):
            return tolerance
        return Tolerance(relative=number("tolerance", 1e-3 if tolerance is None else tolerance))
    if tolerance is not None:
        raise ValueError(f"tolerance={tolerance} and atol={atol}, rtol={rtol} are given; choose one way")
    return Tolerance(
        0.0 if atol is None else number("atol", atol),
        0.0 if rtol is None else number("rtol", rtol),
    )


def _box(d: int | None, bounds: Sequence[ArrayLike] | None) -> tuple[int, NDArray[np.float64], NDArray[np.float64]]:
    """Dimensions, and the lower and upper ends; no ends for the unit cube."""
    if bounds is None:
        if d is None:
            raise TypeError("d is not given; say how many dimensions f takes, or give bounds")
        return integer("d", d, bits=32), np.empty(0), np.empty(0)
    try:
        a, b = bounds
    except (TypeError, ValueError):
        raise ValueError(f"bounds is {bounds!r}; give (a, b), the lower ends and the upper ends") from None
    ends = [array_of("bounds", end) for end in (a, b)]
    try:
        lower, upper = np.broadcast_arrays(*(end.astype(np.float64) for end in ends))
    except (TypeError, ValueError):
        raise ValueError(f"bounds is {bounds!r}; give numbers, one or d for each end") from None
    if lower.ndim > 1 or lower.size == 0:
        raise ValueError(f"bounds have shape {lower.shape}; give numbers, or one for each dimension")
    if d is None:
        d = lower.size
    elif lower.ndim == 1 and integer("d", d, bits=32) != lower.size:
        raise ValueError(f"d is {d}, but bounds has {lower.size} dimensions")
    shape = (integer("d", d, bits=32),)
    lower, upper = (np.ascontiguousarray(np.broadcast_to(e, shape)) for e in (lower, upper))
    if not (lower < upper).all():
        k = int(np.argmin(lower < upper))
        raise ValueError(
            f"bounds of dimension {k} are {lower[k]} and {upper[k]}; give (a, b), all lower ends, then all upper ends, "
            "each lower end below its upper end"
        )
    return d, lower, upper


def integrate(
    f: Callable[..., ArrayLike],
    d: int | None = None,
    pattern: str = "sobol",
    tolerance: float | Tolerance | None = None,
    confidence: float = 0.95,
    max_samples: int = 2**24,
    *,
    atol: float | None = None,
    rtol: float | None = None,
    bounds: Sequence[ArrayLike] | None = None,
    args: Any = (),
    min_samples: int = 1024,
    replicates: int = 16,
    value_range: Sequence[float] | None = None,
    scramble: str | None = "default",
    seed: Any = 0,
    threads: int | None = 1,
    rng: Any | Unset = UNSET,
) -> Integral:
    """Integrates a function over [0,1)^d, or over a box, to a tolerance at a confidence.

    Parameters
    ----------
    f : callable
        ``f(x, *args)`` gets a block of points, ndarray of float64, shape (n, d), in [0, 1) or
        within ``bounds``, its own to keep or overwrite; returns n real numbers, shape (n,), or n
        arrays of them, shape (n, …). n varies, up to about 8,192.
    d : int, optional
        Dimensions, at least 1. May be left out where ``bounds`` says it.
    pattern : str
        One of `sunfleck.PATTERNS`.
    tolerance : float or Tolerance, optional
        A plain number is relative to the magnitude of the integral, as in `render`; 1e-3 where
        nothing is given. An integral that may be 0 needs ``atol``: no half-width is within a share
        of 0. `Tolerance` says either or both.
    confidence : float
        That the half-width bounds the error, in (0, 1); of several components, for each by itself.
    max_samples : int
        Evaluations of f in all, at most.
    atol, rtol : float, optional
        The tolerance as SciPy names it, absolute in f's unit and relative: met, in each component,
        where the half-width is within the larger of ``atol`` and ``rtol * abs(value)``. Not with
        ``tolerance``.
    bounds : (a, b), optional
        Lower and upper ends, each one number or d of them; ``-numpy.inf`` and ``numpy.inf`` may be
        among them. Without d, numbers mean one dimension. The unit cube where not given.
    args : tuple
        Further arguments of f; what is no tuple is one argument.
    min_samples : int
        Before the first look, at least 2; rounded up to what the replicates can take.
    replicates : int
        Independent copies of the pattern, 2 to 1,024. More make the half-width steadier, fewer
        leave more points to each: by 16 most of the former is won. Below 6 an interval covers less
        than it says where the function is discontinuous: of 300 intervals at 0.95 of a step in two
        dimensions 0.80 with 2 copies, 0.90 with 3, 0.92 with 4, 0.93 with 5, 0.97 with 8.
    value_range : (low, high), optional
        Where the values of f, all components, are known to lie; others are refused. Not with
        infinite bounds. With pattern "random" the interval then is a confidence sequence, which
        holds for any such f at every count.
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

    The copies of patterns that are random within their strata (sobol and sz but under "shift",
    latin, jittered, multijittered, orthogonal; halton and hammersley under "owen") are shifted and
    folded, ``x -> 1 - abs(2x - 1)``, each by itself, three of four in each dimension: else all may
    see the same count beside a step, which is an error without a spread. Where all points of a copy
    have one offset within their strata (halton and hammersley otherwise, lattice, shifted nets,
    uniform) the half-width falls no faster than 1/n until further looks bear it out. Bounds are reached by
    rational maps, t / (1 - t) for an infinite end, so that functions that fall faster than x^-2
    stay bounded.

    Smooth functions of up to 3 dimensions are `scipy.integrate.cubature`'s, which takes thousands
    of times fewer evaluations.

    Where all samples, or the means of all replicates, are equal to the last bit, the half-width
    is -log(1 - confidence) / samples of the values' range (the rule of three): of
    ``value_range``, else as seen, else the value itself, else 1.

    Ctrl-C returns what is known so far. The same seed gives the same result.

    References
    ----------
    L'Ecuyer, Nakayama, Owen & Tuffin 2023, "Confidence intervals for randomized quasi-Monte
    Carlo estimators".
    Cranley & Patterson 1976, "Randomization of number theoretic methods for multiple integration".
    Hickernell 2002, "Obtaining O(N^-2+ε) convergence for lattice quadrature rules" (the fold).
    Hill 1975, "A simple general approach to inference about the tail of a distribution".
    Waudby-Smith & Ramdas 2023, "Estimating means of bounded random variables by betting".

    Examples
    --------
    π by the circle: points in the square, and the share of them that is inside.

    >>> import sunfleck as sf
    >>> pi = sf.integrate(lambda u: 4.0 * (u[:, 0] ** 2 + u[:, 1] ** 2 < 1.0), d=2)
    >>> abs(pi.value - 3.14159265) <= pi.half_width <= 1e-3 * pi.value
    True
    >>> pi.stop_reason
    'met'

    Mean and second moment of a normal law at once, over the whole line:

    >>> import numpy as np
    >>> def moments(x, s):
    ...     density = np.exp(-0.5 * (x[:, 0] / s) ** 2) / (s * np.sqrt(2 * np.pi))
    ...     return density[:, None] * x ** [1, 2]
    >>> r = sf.integrate(moments, bounds=(-np.inf, np.inf), args=(2.0,), atol=1e-3)
    >>> bool((abs(r.value - [0, 4]) <= r.half_width).all())
    True
    """
    if not callable(f):
        raise TypeError(f"f is {f!r}; give a function of a block of points")
    goal = _tolerance(tolerance, atol, rtol)
    if threads is not None and integer("threads", threads, bits=32) == 0:  # C's word for all processors
        raise ValueError("threads is 0; give at least 1, or None for one for each processor")
    d, lower, upper = _box(d, bounds)
    low, high = _range(value_range)
    confidence = number("confidence", confidence)
    function = _Function(f, args if isinstance(args, tuple) else (args,))
    options: dict[str, Any] = {
        "pattern": text("pattern", pattern),
        "scramble": "none" if scramble is None else text("scramble", scramble),
        "dims": d,
        "seed": seed_from(seed, rng),
        "absolute": goal.absolute,
        "relative": goal.relative,
        "confidence": confidence,
        "min_samples": integer("min_samples", min_samples),
        "max_samples": integer("max_samples", max_samples),
        "replicates": integer("replicates", replicates, bits=32),
        "low": low,
        "high": high,
        "threads": threads or 0,
        "lower": lower,
        "upper": upper,
    }
    try:
        found = _core.integrate(function, components=1, **options)
    except _OtherShape:
        found = _core.integrate(function, components=math.prod(function.shape or ()), **options)
    return _integral(found, function.shape or (), confidence)


def _integral(found: list[dict[str, Any]], shape: tuple[int, ...], confidence: float) -> Integral:
    """One record of the components' records."""

    def gather(ones: Sequence[Any]) -> Any:
        return np.array(ones).reshape(shape) if shape else ones[0]

    history = tuple(
        IntegralLook(looks[0][0], gather([look[1] for look in looks]), gather([look[2] for look in looks]))
        for looks in zip(*(one["history"] for one in found), strict=True)
    )
    reasons = [one["stop_reason"] for one in found]
    return Integral(
        value=gather([one["value"] for one in found]),
        half_width=gather([one["half_width"] for one in found]),
        samples=found[0]["samples"],
        stop_reason="suspicious" if "suspicious" in reasons else reasons[0],
        nonfinite=sum(one["nonfinite"] for one in found),
        confidence=confidence,
        replicates=found[0]["replicates"],
        shifted=found[0]["shifted"],
        folded=found[0]["folded"],
        trusted=gather([reason != "suspicious" for reason in reasons]),
        history=history,
    )
