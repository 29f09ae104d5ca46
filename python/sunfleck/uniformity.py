# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""uniformity: how evenly points fill the unit cube.

Points are arrays of shape (n, d) of real numbers. Every measure gives the same value, bit for bit,
for any number of threads, and releases the GIL while it works.

Examples
--------
>>> import sunfleck as sf
>>> u = sf.points("sobol", 256, seed=1)
>>> sf.uniformity.discrepancy(u) < 0.01 * sf.uniformity.discrepancy(sf.points("random", 256))
True
>>> sf.uniformity.t_value(u)
0
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sunfleck import _core
from sunfleck._arguments import array_of, integer, text

__all__ = [
    "DISCREPANCIES",
    "RadialSpectrum",
    "StarDiscrepancy",
    "discrepancy",
    "minimum_distance",
    "pair_t_values",
    "power_spectrum",
    "radial_power_spectrum",
    "star_discrepancy",
    "t_value",
]

DISCREPANCIES: dict[str, str] = _core.discrepancies()
"""The kinds of `discrepancy`: name → one line about it."""

_CHUNK = 4096  # points whose waves are held at a time


class StarDiscrepancy(NamedTuple):
    """Bounds of the star discrepancy; equal where it is known exactly."""

    lower: float
    upper: float


class RadialSpectrum(NamedTuple):
    """A power spectrum averaged over rings of frequency."""

    frequency: NDArray[np.float64]
    """The middle of each ring, in cycles along the side of the square."""
    power: NDArray[np.float64]
    """1 for white noise."""


def _rows(points: ArrayLike) -> NDArray[np.float64]:
    array = array_of("points", points)
    if array.dtype.kind != "f":
        raise TypeError(f"the points have dtype {array.dtype}; give floating-point numbers")
    if array.ndim != 2:
        raise ValueError(f"the points have shape {array.shape}; give (n, d)")
    return np.require(array, np.float64, ["C", "A"])


def _threads(threads: int | None) -> int:
    if threads is None:
        return 0
    if integer("threads", threads, bits=32) == 0:  # C's word for all processors
        raise ValueError("threads is 0; give at least 1, or None for one for each processor")
    return threads


def discrepancy(points: ArrayLike, kind: str = "centered", *, threads: int | None = None) -> float:
    """A discrepancy in closed form: how far the share of points in boxes is from their volume.

    Parameters
    ----------
    points : array_like, shape (n, d)
        In [0, 1].
    kind : str
        One of `DISCREPANCIES`: "centered", "wraparound" and "mixture" are squared, "l2-star" is
        not, each as `scipy.stats.qmc.discrepancy` has it (CD, WD, MD, L2-star).
    threads : int, optional
        How many to use, at least 1. None: one for each processor.

    Returns
    -------
    float

    Raises
    ------
    ValueError
        An unknown kind, a point outside [0, 1], or dimensions so many that the terms are beyond
        a double (some 640 for l2-star, 1,500 for mixture, 2,400 for wraparound, 8,800 for centered).
    TypeError
        Points that are not floating-point numbers.

    Notes
    -----
    Costs n² d / 2 terms.

    References
    ----------
    Hickernell 1998, "A generalized discrepancy and quadrature error bound" (centered) and
    "Lattice rules: how well do they measure up?" (wraparound).
    Zhou, Fang & Ning 2013, "Mixture discrepancy for quasi-random point sets".
    Warnock 1972, "Computational investigations of low-discrepancy point sets" (l2-star).

    Examples
    --------
    >>> import sunfleck as sf
    >>> round(sf.uniformity.discrepancy(sf.points("sobol", 8, scramble=None)), 6)
    0.013882
    """
    return _core.discrepancy(_rows(points), text("kind", kind), _threads(threads))


def star_discrepancy(points: ArrayLike, *, boxes: int = 1 << 14) -> StarDiscrepancy:
    """Bounds of the star discrepancy: the greatest difference between the share of points in a box
    [0, y) and its volume.

    Parameters
    ----------
    points : array_like, shape (n, d)
        In [0, 1).
    boxes : int
        1 to 2^20: in how many boxes, at most, the cube is covered where the exact value is too
        dear. More bring the bounds closer.

    Returns
    -------
    StarDiscrepancy
        (lower, upper). Equal, the exact value up to rounding, for d = 1 and where
        (n + 32)² (n + 1)^(d - 2) is at most 1.06 · 2^32: 65,536 points in 2 dimensions, 1,600 in
        3, 240 in 4. Beyond 32 dimensions upper is 1.

    Raises
    ------
    ValueError, TypeError
        A point outside [0, 1), or another kind of value.

    Notes
    -----
    Costs seconds at most where exact, else boxes · n · d steps at most; one thread.

    References
    ----------
    Thiemard 2001, "An algorithm to compute bounds for the star discrepancy".

    Examples
    --------
    >>> import sunfleck as sf
    >>> lower, upper = sf.uniformity.star_discrepancy([[0.25], [0.75]])
    >>> lower, upper
    (0.25, 0.25)
    """
    return StarDiscrepancy(*_core.star_discrepancy(_rows(points), integer("boxes", boxes)))


def t_value(points: ArrayLike, base: int = 2, *, effort: int | None = 64, threads: int | None = None) -> int:
    """The t of points as a (t, m, d)-net: the least for which every elementary interval of volume
    base^(t - m) holds base^t of the base^m points.

    Parameters
    ----------
    points : array_like, shape (n, d)
        In [0, 1), n a power of the base.
    base : int
        2 to 65,536.
    effort : int or None
        Caps the cost, in units of 2^30 steps (a second or so); None: no cap.
    threads : int, optional
        How many to use, at least 1. None: one for each processor.

    Returns
    -------
    int
        0 is the best; m says nothing: every set is an (m, m, d)-net.

    Raises
    ------
    ValueError, TypeError
        n no power of the base (the nearest are named), a point outside [0, 1), or another value
        out of range or of the wrong kind.
    NotImplementedError
        More than ``effort`` allows; the message has the bound on t that was reached.

    Notes
    -----
    Levels k = m - t are tested upwards until one fails: C(k + d - 1, k) shapes of interval at each,
    n d steps a shape. In a base that is no power of 2, a coordinate less than 2^-50 below an
    interval's border counts as on it, since no double holds the border.

    References
    ----------
    Niederreiter 1987, "Point sets and sequences with small discrepancy".

    Examples
    --------
    >>> import sunfleck as sf
    >>> sf.uniformity.t_value(sf.points("sobol", 1024, 5, seed=1))
    3
    """
    cap = 0 if effort is None else integer("effort", effort, bits=32)
    if effort is not None and cap == 0:  # C's word for no cap
        raise ValueError("effort is 0; give at least 1, or None for no cap")
    return _core.t_value(_rows(points), integer("base", base, bits=32), cap, _threads(threads))


def pair_t_values(points: ArrayLike, base: int = 2, *, threads: int | None = None) -> NDArray[np.int64]:
    """The t-value of every pair of dimensions.

    Parameters
    ----------
    points, base, threads
        As `t_value` takes them.

    Returns
    -------
    ndarray, shape (d, d), int64
        Symmetric; on the diagonal the t-value of the one dimension.

    Raises
    ------
    ValueError, TypeError
        As `t_value`.

    Notes
    -----
    Costs d² / 2 t-values of two dimensions, each m² / 2 passes over the n points.

    Examples
    --------
    >>> import sunfleck as sf
    >>> sf.uniformity.pair_t_values(sf.points("sobol", 16, 4, scramble=None)).tolist()
    [[0, 0, 0, 2], [0, 0, 1, 1], [0, 1, 0, 0], [2, 1, 0, 0]]
    """
    rows = _rows(points)
    d = rows.shape[1]
    values = np.empty((d, d), np.int64)
    for i in range(d):
        values[i, i] = t_value(rows[:, [i]], base, effort=None, threads=threads)
        for j in range(i):
            values[i, j] = values[j, i] = t_value(rows[:, [i, j]], base, effort=None, threads=threads)
    return values


def minimum_distance(points: ArrayLike, *, toroidal: bool = False, threads: int | None = None) -> float:
    """The least distance of two points.

    Parameters
    ----------
    points : array_like, shape (n, d)
        In [0, 1], at least two.
    toroidal : bool
        On the torus, where opposite sides are the same.
    threads : int, optional
        How many to use, at least 1. None: one for each processor.

    Returns
    -------
    float

    Raises
    ------
    ValueError, TypeError
        Fewer than two points, a point outside [0, 1], or another kind of value.

    Notes
    -----
    Costs n² d / 2 steps at most, in low dimensions far fewer: a sweep along the first coordinate.

    Examples
    --------
    >>> import sunfleck as sf
    >>> sf.uniformity.minimum_distance(sf.points("uniform", 64))
    0.125
    """
    return _core.minimum_distance(_rows(points), bool(toroidal), _threads(threads))


def _frequencies(n: int, max_frequency: int | None) -> int:
    """The greatest frequency: twice that of n points in a square grid, unless one is given."""
    if max_frequency is None:
        return max(1, math.ceil(2 * math.sqrt(n)))
    if integer("max_frequency", max_frequency, bits=16) == 0:
        raise ValueError("max_frequency is 0; give at least 1")
    return max_frequency


def _plane(points: ArrayLike) -> NDArray[np.float64]:
    rows = _rows(points)
    if rows.shape[1] != 2 or len(rows) == 0:
        raise ValueError(f"the points have shape {rows.shape}; give (n, 2) with n at least 1")
    if not (np.isfinite(rows).all() and rows.min() >= 0 and rows.max() <= 1):
        raise ValueError("a point is outside [0, 1]^2")
    return rows


def power_spectrum(points: ArrayLike, *, max_frequency: int | None = None) -> NDArray[np.float64]:
    """The power of points in the plane at every whole frequency: |Σ exp(-2πi f·x)|² / n.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        In [0, 1].
    max_frequency : int, optional
        K, at most 65,535. None: 2√n, rounded up.

    Returns
    -------
    ndarray, shape (2K + 1, 2K + 1), float64
        Entry [a, b] is that of frequency (a - K, b - K), in cycles along the side. The middle is
        n; independent points have 1 on average everywhere else.

    Raises
    ------
    ValueError, TypeError
        Points of another shape or outside [0, 1], or another value out of range or kind.

    Notes
    -----
    The sum itself, as a product of matrices: no binning to a grid and no aliases of it. Costs
    8 n (K + 1) (2K + 1) operations and 65,536 (3K + 2) bytes.

    Examples
    --------
    >>> import sunfleck as sf
    >>> power = sf.uniformity.power_spectrum(sf.points("jittered", 256, seed=1))
    >>> power.shape, float(power[32, 32]), bool(power[33, 32] < 0.1)
    ((65, 65), 256.0, True)
    """
    rows = _plane(points)
    k = _frequencies(len(rows), max_frequency)
    total: Any = np.zeros((k + 1, 2 * k + 1), np.complex128)
    for begin in range(0, len(rows), _CHUNK):
        turns = -2j * np.pi * rows[begin : begin + _CHUNK]
        x = np.exp(np.multiply.outer(np.arange(k + 1), turns[:, 0]))
        y = np.exp(np.multiply.outer(turns[:, 1], np.arange(-k, k + 1)))
        total += x @ y
    half = (total.real**2 + total.imag**2) / len(rows)
    # The sum at -f is the conjugate of that at f.
    full: NDArray[np.float64] = np.concatenate([half[:0:-1, ::-1], half])
    return full


def radial_power_spectrum(points: ArrayLike, *, max_frequency: int | None = None) -> RadialSpectrum:
    """The power spectrum of points in the plane, averaged over rings of frequency and over sets.

    Parameters
    ----------
    points : array_like, shape (n, 2) or (sets, n, 2)
        In [0, 1]. A pattern under several seeds is several sets.
    max_frequency : int, optional
        K, at most 65,535. None: 2√n, rounded up.

    Returns
    -------
    RadialSpectrum
        ``frequency`` and ``power``, each of shape (K,): ring r holds the frequencies whose length
        rounds to r, r = 1 … K. White noise has power 1; a pattern without clumps has less at low
        frequencies, one that is regular has peaks above.

    Raises
    ------
    ValueError, TypeError
        As `power_spectrum`.

    Notes
    -----
    Costs a `power_spectrum` a set. A ring of N frequencies (and as many opposite ones, which say
    the same) of s sets has a relative deviation of about 1/√(N s).

    References
    ----------
    Ulichney 1988, "Dithering with blue noise".

    Examples
    --------
    >>> import numpy as np
    >>> import sunfleck as sf
    >>> sets = np.stack([sf.points("jittered", 256, seed=seed) for seed in range(8)])
    >>> spectrum = sf.uniformity.radial_power_spectrum(sets)
    >>> bool(spectrum.power[0] < 0.1), bool(0.8 < spectrum.power[-8:].mean() < 1.2)
    (True, True)
    """
    array = array_of("points", points)
    sets = array if array.ndim == 3 else [points]
    if len(sets) == 0:
        raise ValueError("there are no sets of points; give at least one")
    spectra = [power_spectrum(one, max_frequency=max_frequency) for one in sets]
    power = np.mean(spectra, axis=0)
    k = len(power) // 2
    axis = np.arange(-k, k + 1)
    ring = np.rint(np.hypot(axis[:, None], axis)).astype(np.int64).ravel()
    inside = (ring > 0) & (ring <= k)
    totals = np.bincount(ring[inside], power.ravel()[inside], k + 1)
    counts = np.bincount(ring[inside], minlength=k + 1)
    return RadialSpectrum(np.arange(1.0, k + 1), totals[1:] / counts[1:])
