# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""moments: running means and variances of numbers, of colours, and of numbers with weights."""

from __future__ import annotations

import math
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from sunfleck import _core
from sunfleck._arguments import number
from sunfleck.estimate.accumulator import Accumulator, confidence_of, float64_of, samples_of

__all__ = ["ChannelMoments", "Moments", "VectorMoments", "WeightedMoments", "moments_from"]

_Core = TypeVar("_Core", _core.Moments, _core.VectorMoments)


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
    def sample_variance(self) -> float:
        """Unbiased for the variance that independent samples come from: sum of squared deviations / (N - 1).

        Infinite below two samples. ``standard_error`` is the square root of this over N.
        """
        return self._core.sample_variance

    @property
    def sample_deviation(self) -> float:
        """The square root of ``sample_variance``; infinite below two samples."""
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

    The mean of finite samples is finite. A sum of squared deviations above 1.8e308 is infinity, and
    so are variance, error and half-width: give samples 1e154 apart in another unit.

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
        self._core.add(samples_of(x))

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
        return self._core.half_width(confidence_of(confidence))

    def bernstein_half_width(self, low: float, high: float, confidence: float = 0.95) -> float:
        """Of the mean's interval by the empirical Bernstein bound: it holds at any count.

        Parameters
        ----------
        low, high : float
            Where the samples are known to lie; they must be independent.
        confidence : float
            In (0, 1), for one count that was fixed ahead.

        Returns
        -------
        float
            Infinite below two samples.

        References
        ----------
        Maurer & Pontil 2009, "Empirical Bernstein bounds and sample variance penalization", theorem 4.

        Examples
        --------
        >>> import sunfleck as sf
        >>> m = sf.Moments()
        >>> m.add([0.25, 0.75] * 500)
        >>> round(m.bernstein_half_width(0, 1), 4)
        0.0337
        """
        low, high = number("low", low), number("high", high)
        if not -math.inf < low < high < math.inf:
            raise ValueError(f"the samples' interval is [{low}, {high}]; give finite low < high")
        return self._core.bernstein_half_width(high - low, confidence_of(confidence))

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
        samples = samples_of(x)
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


class ChannelMoments(Accumulator):
    """Running mean and variance of colours, each channel for itself.

    Examples
    --------
    >>> import sunfleck as sf
    >>> m = sf.ChannelMoments()
    >>> m.add([[0.0, 0.0, 1.0], [2.0, 0.0, 3.0]])
    >>> m.mean, m.variance
    ((1.0, 0.0, 2.0), (1.0, 0.0, 1.0))
    """

    __slots__ = ()

    def __init__(self) -> None:
        self._core = _core.ChannelMoments()

    def add(self, x: ArrayLike) -> None:
        """Adds a colour, shape (3,), or every colour of an array of shape (..., 3).

        A colour with one channel that is not finite is left out whole.

        Raises
        ------
        ValueError
            Another shape.
        TypeError
            Samples that are not real numbers.
        """
        samples = samples_of(x)
        if samples.ndim < 1 or samples.shape[-1] != 3:
            raise ValueError(f"the samples have shape {samples.shape}; give (..., 3)")
        self._core.add(samples.reshape(-1, 3))

    def merge(self, other: ChannelMoments) -> None:
        """Adds what another has seen."""
        if not isinstance(other, ChannelMoments):
            raise TypeError(f"other is {other!r}; give sunfleck.ChannelMoments")
        self._core.merge(other._core)

    @property
    def channels(self) -> tuple[Moments, Moments, Moments]:
        """The moments of each channel, as copies."""
        r, g, b = (moments_from(self._core.at(k)) for k in range(3))
        return r, g, b

    @property
    def count(self) -> int:
        """Finite colours so far."""
        return self.channels[0].count

    @property
    def nonfinite(self) -> int:
        """Colours that were not finite: counted, and left out of all else."""
        return self.channels[0].nonfinite

    @property
    def mean(self) -> tuple[float, float, float]:
        """By channel; NaN without a sample."""
        r, g, b = (m.mean for m in self.channels)
        return r, g, b

    @property
    def variance(self) -> tuple[float, float, float]:
        """By channel, sum of squared deviations / N; NaN without a sample."""
        r, g, b = (m.variance for m in self.channels)
        return r, g, b

    @property
    def sample_variance(self) -> tuple[float, float, float]:
        """By channel, sum of squared deviations / (N - 1); infinite below two samples."""
        r, g, b = (m.sample_variance for m in self.channels)
        return r, g, b

    @property
    def standard_error(self) -> tuple[float, float, float]:
        """Of the mean, by channel, for independent samples; infinite below two."""
        r, g, b = (m.standard_error for m in self.channels)
        return r, g, b

    def __setstate__(self, state: bytes) -> None:
        self._core = _core.ChannelMoments()
        self._core.set_state(state)


def moments_from(state: tuple[int, float, float, int]) -> Moments:
    m = Moments()
    m._core.set_state(*state)
    return m


class WeightedMoments(Accumulator):
    """Running mean and variance of numbers that count by their weights.

    Notes
    -----
    Near the largest double as in `Moments`; where the sum of the weights exceeds it, mean and
    variance are NaN.

    References
    ----------
    West 1979, "Updating mean and variance estimates: an improved method".

    Examples
    --------
    >>> import sunfleck as sf
    >>> m = sf.WeightedMoments()
    >>> m.add([1.0, 5.0], weights=[3.0, 1.0])
    >>> m.mean, m.variance
    (2.0, 3.0)
    """

    __slots__ = ()

    def __init__(self) -> None:
        self._core = _core.WeightedMoments()

    def add(self, x: ArrayLike, weights: ArrayLike) -> None:
        """Adds samples with weights of the same shape, or one weight for all.

        A sample or weight that is not finite, or a negative weight, is counted and left out.

        Raises
        ------
        ValueError
            Weights of another shape.
        TypeError
            Samples or weights that are not real numbers.
        """
        samples, given = float64_of(x), float64_of(weights)
        try:
            given = np.require(np.broadcast_to(given, samples.shape), None, ["C", "A"])
        except ValueError:
            raise ValueError(f"the weights have shape {given.shape}, the samples {samples.shape}") from None
        self._core.add(samples, given)

    def merge(self, other: WeightedMoments) -> None:
        """Adds what another has seen."""
        if not isinstance(other, WeightedMoments):
            raise TypeError(f"other is {other!r}; give sunfleck.WeightedMoments")
        self._core.merge(other._core)

    @property
    def count(self) -> int:
        """Finite samples so far, those of weight 0 among them."""
        return int(self._core.count)

    @property
    def nonfinite(self) -> int:
        """Samples left out."""
        return int(self._core.nonfinite)

    @property
    def weight(self) -> float:
        """The sum of the weights."""
        return float(self._core.weight)

    @property
    def mean(self) -> float:
        """sum(w x) / sum(w); NaN without weight."""
        return float(self._core.mean)

    @property
    def variance(self) -> float:
        """sum(w (x - mean)^2) / sum(w); NaN without weight."""
        return float(self._core.variance)

    @property
    def standard_error(self) -> float:
        """Of the mean, for independent samples whose weights do not depend on them."""
        return float(self._core.standard_error)

    def __setstate__(self, state: bytes) -> None:
        self._core = _core.WeightedMoments()
        self._core.set_state(state)
