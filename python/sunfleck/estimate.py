# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""estimate: running means and variances that do not cancel, and standard errors."""

from __future__ import annotations

from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sunfleck import _core
from sunfleck._arguments import number

__all__ = ["Moments", "VectorMoments"]

_Core = TypeVar("_Core", _core.Moments, _core.VectorMoments)


def _samples(x: ArrayLike) -> NDArray[Any]:
    """float32 as it is, other real numbers as float64."""
    try:
        array = np.asarray(x)
    except ValueError as error:
        raise ValueError(f"the samples are not a regular array: {error}") from None
    if array.dtype.kind not in "fiu":
        raise TypeError(f"the samples have dtype {array.dtype}; give real numbers")
    return np.require(array, np.float32 if array.dtype == np.float32 else np.float64, ["C", "A"])


class _Running(Generic[_Core]):
    """What moments of numbers and of colours have in common."""

    __slots__ = ("_core",)

    _core: _Core

    @property
    def count(self) -> int:
        """Finite samples so far."""
        return self._core.count

    @property
    def nonfinite(self) -> int:
        """Samples that were NaN or infinite: counted, and left out of all else."""
        return self._core.nonfinite

    @property
    def variance(self) -> float:
        """The samples' own, sum of squared deviations / N; NaN without a sample."""
        return self._core.variance

    @property
    def sample_deviation(self) -> float:
        """sqrt(sum of squared deviations / (N - 1)); infinite below two samples."""
        return self._core.sample_deviation

    @property
    def standard_error(self) -> float:
        """Of the mean, for independent samples: ``sample_deviation`` / sqrt(N); infinite below two."""
        return self._core.standard_error

    def __getstate__(self) -> tuple[Any, ...]:
        state: tuple[Any, ...] = self._core.state()
        return state

    def __repr__(self) -> str:
        return f"{type(self).__name__}(count={self.count}, standard_error={self.standard_error:g})"


class Moments(_Running[_core.Moments]):
    """Running mean and variance of numbers, in double precision.

    Notes
    -----
    Memory is constant. An array is taken in blocks that are merged pairwise, so that the error
    grows as log(N); cost is one pass over it, without the GIL. Threads may share moments, taking
    turns; one for each, merged in a fixed order, is faster and repeatable.

    References
    ----------
    Welford 1962, "Note on a method for calculating corrected sums of squares and products".
    Chan, Golub & LeVeque 1979, "Updating formulae and a pairwise algorithm for computing sample
    variances".

    Examples
    --------
    >>> import sunfleck as sf
    >>> m = sf.Moments()
    >>> m.add([1.0, 2.0, 4.0])
    >>> m.add(5.0)
    >>> m.count, m.mean, m.variance
    (4, 3.0, 2.5)
    """

    __slots__ = ()

    def __init__(self) -> None:
        self._core = _core.Moments()

    @property
    def mean(self) -> float:
        """NaN without a sample."""
        return self._core.mean

    def add(self, x: ArrayLike) -> None:
        """Adds a number, or every number of an array of any shape.

        Raises
        ------
        TypeError
            Samples that are not real numbers.
        """
        self._core.add(_samples(x))

    def merge(self, other: Moments) -> None:
        """Adds what another has seen."""
        if not isinstance(other, Moments):
            raise TypeError(f"other is {other!r}; give sunfleck.Moments")
        self._core.merge(other._core)

    def half_width(self, confidence: float = 0.95) -> float:
        """Of the mean's interval by Student's t, for independent samples that are near normal.

        Parameters
        ----------
        confidence : float
            In (0, 1).

        Returns
        -------
        float
            Infinite below two samples.

        Examples
        --------
        >>> import sunfleck as sf
        >>> m = sf.Moments()
        >>> m.add([1.0, 2.0, 3.0])
        >>> round(m.half_width(), 4)
        2.4841
        """
        confidence = number("confidence", confidence)
        if not 0 < confidence < 1:
            raise ValueError(f"confidence is {confidence}; give one above 0 and below 1")
        return self._core.half_width(confidence)

    def __setstate__(self, state: tuple[int, float, float, int]) -> None:
        self._core = _core.Moments()
        self._core.set_state(*state)


class VectorMoments(_Running[_core.VectorMoments]):
    """Running mean of colours, with one variance: that of the distance from the mean.

    Examples
    --------
    >>> import sunfleck as sf
    >>> m = sf.VectorMoments()
    >>> m.add([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]])
    >>> m.mean, m.variance
    ((1.0, 0.0, 0.0), 1.0)
    """

    __slots__ = ()

    def __init__(self) -> None:
        self._core = _core.VectorMoments()

    @property
    def mean(self) -> tuple[float, float, float]:
        """By channel; NaN without a sample."""
        r, g, b = self._core.mean
        return r, g, b

    def add(self, x: ArrayLike) -> None:
        """Adds a colour, shape (3,), or every colour of an array of shape (..., 3).

        Raises
        ------
        ValueError
            Another shape.
        TypeError
            Samples that are not real numbers.
        """
        samples = _samples(x)
        if samples.ndim < 1 or samples.shape[-1] != 3:
            raise ValueError(f"the samples have shape {samples.shape}; give (..., 3)")
        self._core.add(samples.reshape(-1, 3))

    def merge(self, other: VectorMoments) -> None:
        """Adds what another has seen."""
        if not isinstance(other, VectorMoments):
            raise TypeError(f"other is {other!r}; give sunfleck.VectorMoments")
        self._core.merge(other._core)

    def __setstate__(self, state: tuple[int, tuple[float, float, float], float, int]) -> None:
        self._core = _core.VectorMoments()
        self._core.set_state(*state)
