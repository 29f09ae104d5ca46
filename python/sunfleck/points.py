# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""points: patterns, rules that place n points in [0,1)^d."""

from __future__ import annotations

import warnings
from typing import Any

from numpy.typing import DTypeLike, NDArray

from sunfleck import _core
from sunfleck._arguments import check_size, integer, output_array, output_dtype, text
from sunfleck._seed import UNSET, Unset, seed_from

__all__ = ["PATTERNS", "SCRAMBLES", "points", "valid_counts"]

PATTERNS: dict[str, str] = _core.patterns()
"""The patterns: name → one line about it."""

SCRAMBLES: dict[str, str] = _core.scrambles()
"""How a deterministic pattern is randomized: name → one line about it; None means "none"."""


def points(
    pattern: str,
    n: int,
    d: int = 2,
    *,
    seed: Any = 0,
    scramble: str | None = "default",
    pad: int = 0,
    start: int = 0,
    total: int | None = None,
    dtype: DTypeLike | None = None,
    threads: int | None = None,
    out: NDArray[Any] | None = None,
    rng: Any | Unset = UNSET,
) -> NDArray[Any]:
    """Points ``start`` to ``start + n - 1`` of a pattern in [0,1)^d.

    Point i depends only on (pattern, d, scramble, pad, seed, i), and on `total` where the pattern
    needs it: calls may be split, reordered and run on any number of threads with the same bits.

    Parameters
    ----------
    pattern : str
        One of `sunfleck.PATTERNS`. Capital letters are as small ones, and "-" as "_".
    n : int
        How many points. uniform, jittered, multijittered and orthogonal take some counts only,
        see `valid_counts`: of `total`, where that is given.
    d : int
        Dimensions of a point, at least 1; at most 21,201 for sobol, 4 for sz, 65,536 where `pad`
        is given, 6,542 for halton, 4,391 for lattice, sqrt(n) + 1 for orthogonal.
    seed : int, None, numpy.random.Generator, numpy.random.SeedSequence or Rng
        An int in [0, 2^64). From another source 64 bits are taken, and it is advanced by that: the
        next call with it gets other points. None: from the system, so that no two calls agree.
    scramble : str or None
        One of `sunfleck.SCRAMBLES` that the pattern takes: "shift", "lms", "owen", "nested"
        (sobol, sz), "permuted", "owen" (halton, hammersley), "shift" (lattice, r2), "default"
        (the pattern's own: owen for sobol and sz, permuted for halton, none elsewhere); None is
        the plain sequence, in the natural order of the index.
    pad : 0, 2 or 4
        Of sobol and sz, with scramble "owen" or "nested": dimension k is dimension k % pad of
        a set of its own, the first in the pattern's order, the others shuffled. 0: no padding.
    start : int
        Index of the first point.
    total : int, optional
        How many points the whole set has, of which these are ``start`` to ``start + n - 1``:
        uniform, jittered, latin, multijittered, orthogonal and hammersley differ by it, so that
        parts of one set are made with the same `total`. The others do not, and only refuse
        points beyond it. None: ``start + n``.
    dtype : "float32", "float64" or "uint32", optional
        24 or 53 bits a value, or the 32-bit words that the float32 come from. None: that of ``out``,
        else float32.
    threads : int, optional
        How many to use, at least 1. None: one for each processor. Changes no bit.
    out : ndarray, optional
        Filled in place: shape (n, d), of the dtype, C-contiguous.
    rng : optional
        Another name of `seed`, as SciPy and NumPy have it; integers from 2^64 on are hashed. Give
        one of them.

    Returns
    -------
    ndarray, shape (n, d), of the dtype, in [0, 1), never 1

    Raises
    ------
    ValueError
        An unknown name, a count that the pattern can't take (the nearest are named), a value
        out of range, or an ``out`` that would need a copy.
    TypeError
        A value of the wrong kind, or another dtype.

    Warns
    -----
    UserWarning
        sobol and sz where the points are not an aligned block of a power of two: they lose their
        balance, and the error's n^-3/2 becomes n^-1 (Owen 2020).

    Notes
    -----
    Releases the GIL while it fills. One core of today makes some 2,500 million float32 of sobol a
    second with "owen" scrambling, 110 million with "nested", and as many as memory takes with the
    others; arrays from 12 MiB on are written past the caches. Threads stay between calls.

    References
    ----------
    Joe & Kuo 2008, "Constructing Sobol sequences with better two-dimensional projections".
    Ahmed et al. 2024, "SZ sequences: binary-based (0, 2^q)-sequences".
    Matousek 1998, "On the L2-discrepancy for anchored boxes" (lms).
    Owen 1995, "Randomly permuted (t,m,s)-nets and (t,s)-sequences" (nested).
    Burley 2020, "Practical hash-based Owen scrambling" (owen, and shuffled padding).
    Owen 2020, "On dropping the first Sobol' point".

    Examples
    --------
    >>> import sunfleck as sf
    >>> sf.points("sobol", 4, scramble=None).tolist()
    [[0.0, 0.0], [0.5, 0.5], [0.25, 0.75], [0.75, 0.25]]
    >>> sf.points("sobol", 256, 100, scramble="owen", pad=2).shape  # fifty pairs side by side
    (256, 100)
    """
    n, start = integer("n", n), integer("start", start)
    d = integer("d", d, bits=32)
    kind = output_dtype(dtype, out, ("float32", "float64", "uint32"))
    if total is not None and integer("total", total) == 0:  # C's word for start + n
        raise ValueError("total is 0; give at least 1, or None for start + n")
    if threads is not None and integer("threads", threads, bits=32) == 0:  # C's word for all processors
        raise ValueError("threads is 0; give at least 1, or None for one for each processor")
    pattern, pad, key = text("pattern", pattern), integer("pad", pad, bits=32), seed_from(seed, rng)
    scramble = "none" if scramble is None else text("scramble", scramble)
    shape = (n, d)
    check_size("(n, d)", shape)
    array = output_array(out, shape, kind)
    _core.fill_points(array, pattern, scramble, d, pad, key, start, total or 0, threads or 0)
    if pattern.lower() in ("sobol", "sz") and n and (n & (n - 1) or start % n):
        warnings.warn(
            f"{n} points from {start} on are not an aligned block of a power of two of {pattern}'s "
            "sequence: they lose its balance",
            stacklevel=2,
        )
    return array


def valid_counts(pattern: str, n: int, d: int = 2) -> tuple[int | None, int | None]:
    """The nearest counts that a pattern takes, at or below n and at or above it.

    Parameters
    ----------
    pattern : str
        One of `sunfleck.PATTERNS`.
    n : int
        The count wished for.
    d : int
        Dimensions of a point.

    Returns
    -------
    tuple of two ints
        Both n where n is valid; None where there is no such count.

    Raises
    ------
    ValueError, TypeError
        An unknown pattern, or a value out of range or of the wrong kind.

    Examples
    --------
    >>> import sunfleck as sf
    >>> sf.valid_counts("jittered", n=997, d=2)
    (992, 999)
    """
    below, above = _core.valid_counts(text("pattern", pattern), integer("d", d, bits=32), integer("n", n))
    return below or None, above or None
