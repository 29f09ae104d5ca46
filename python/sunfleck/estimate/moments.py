# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""estimate: running means and variances, standard errors, and intervals for the mean."""

from __future__ import annotations

import math
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from sunfleck import _core
from sunfleck._arguments import array_of, integer, number, one_of

__all__ = [
    "BatchMeans",
    "ChannelMoments",
    "ConfidenceSequence",
    "Moments",
    "RunningSums",
    "VectorMoments",
    "WeightedMoments",
    "betting_interval",
    "normal_quantile",
    "student_t_quantile",
]

_Core = TypeVar("_Core", _core.Moments, _core.VectorMoments)


def _samples(x: ArrayLike) -> NDArray[Any]:
    """float32 as it is, other real numbers as float64."""
    array = array_of("x", x)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"the samples have dtype {array.dtype}; give real numbers")
    return np.require(array, np.float32 if array.dtype == np.float32 else np.float64, ["C", "A"])


def _float64(x: ArrayLike) -> NDArray[np.float64]:
    """Real numbers as float64."""
    return np.require(_samples(x), np.float64, ["C", "A"])


def _confidence(value: float) -> float:
    confidence = number("confidence", value)
    if not 0 < confidence < 1:
        raise ValueError(f"confidence is {confidence}; give one above 0 and below 1")
    return confidence


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
        return self._core.half_width(_confidence(confidence))

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
        return self._core.bernstein_half_width(high - low, _confidence(confidence))

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


class _Bytes:
    """What the further kinds have in common: a state of bytes, for copies and pickles."""

    __slots__ = ("_core",)

    _core: Any

    def __getstate__(self) -> bytes:
        state: bytes = self._core.state()
        return state


class ChannelMoments(_Bytes):
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
        samples = _samples(x)
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
        r, g, b = (_moments(self._core.at(k)) for k in range(3))
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
    def standard_error(self) -> tuple[float, float, float]:
        """Of the mean, by channel, for independent samples; infinite below two."""
        r, g, b = (m.standard_error for m in self.channels)
        return r, g, b

    def __setstate__(self, state: bytes) -> None:
        self._core = _core.ChannelMoments()
        self._core.set_state(state)


def _moments(state: tuple[int, float, float, int]) -> Moments:
    m = Moments()
    m._core.set_state(*state)
    return m


class WeightedMoments(_Bytes):
    """Running mean and variance of numbers that count by their weights.

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
        samples, given = _float64(x), _float64(weights)
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


class RunningSums(_Bytes):
    """The lecture's running sums, m of f and s of f squared: kept as the one that fails.

    The variance s/N - mean^2 subtracts numbers that are nearly equal where the mean is large
    beside the deviation: float32 sums are lost from mean / deviation of some 10^3 on, float64 at
    10^8. Use `Moments`.

    Parameters
    ----------
    dtype : "float64" or "float32"
        Of the sums and of what is added to them.

    Notes
    -----
    As on the slide: a sample that is not finite spoils the sums for good, and a negative
    variance gives a standard error of NaN.

    Examples
    --------
    >>> import sunfleck as sf
    >>> x = [1e6 + 1, 1e6 - 1] * 500
    >>> sums, moments = sf.RunningSums("float32"), sf.Moments()
    >>> sums.add(x)
    >>> moments.add(x)
    >>> moments.variance, abs(sums.variance - 1.0) > 1000
    (1.0, True)
    """

    __slots__ = ("dtype",)

    def __init__(self, dtype: DTypeLike = "float64") -> None:
        self.dtype = one_of("dtype", dtype, ("float64", "float32"))
        self._core = _core.RunningSums() if self.dtype == np.float64 else _core.RunningSumsF32()

    def add(self, x: ArrayLike) -> None:
        """Adds a number, or every number of an array in order, rounded to the dtype.

        Raises
        ------
        TypeError
            Samples that are not real numbers.
        """
        self._core.add(np.require(_samples(x), self.dtype, ["C", "A"]))

    @property
    def count(self) -> int:
        """N, all samples."""
        return int(self._core.count)

    @property
    def m(self) -> float:
        """The sum of f."""
        return float(self._core.m)

    @property
    def s(self) -> float:
        """The sum of f squared."""
        return float(self._core.s)

    @property
    def mean(self) -> float:
        """m / N."""
        return float(self._core.mean)

    @property
    def variance(self) -> float:
        """s / N - mean^2."""
        return float(self._core.variance)

    @property
    def standard_error(self) -> float:
        """sqrt(variance / (N - 1))."""
        return float(self._core.standard_error)

    def __getstate__(self) -> Any:
        return self.dtype.name, self._core.state()

    def __setstate__(self, state: Any) -> None:
        self.__init__(state[0])  # type: ignore[misc]
        self._core.set_state(state[1])


class BatchMeans(_Bytes):
    """The means of successive batches of samples, and the interval that they give by Student's t.

    For samples of one stream that depend on their neighbours (batches longer than the
    dependence), and for replicates: n points of each of several randomized copies of a pattern
    are batches of n.

    Parameters
    ----------
    size : int
        Samples of a batch, at least 1.

    Examples
    --------
    >>> import sunfleck as sf
    >>> batches = sf.BatchMeans(256)
    >>> for seed in range(16):
    ...     u = sf.points("sobol", 256, d=2, seed=seed, dtype="float64")
    ...     batches.add(4.0 * ((u**2).sum(axis=1) < 1.0))
    >>> abs(batches.means.mean - 3.14159265) < batches.means.half_width(0.99)
    True
    """

    __slots__ = ()

    def __init__(self, size: int) -> None:
        size = integer("size", size)
        if size == 0:
            raise ValueError("size is 0; give at least 1")
        self._core = _core.BatchMeans(size)

    def add(self, x: ArrayLike) -> None:
        """Adds a number, or every number of an array, in order.

        One that is not finite is counted and takes no place in its batch.

        Raises
        ------
        TypeError
            Samples that are not real numbers.
        """
        self._core.add(_float64(x))

    @property
    def size(self) -> int:
        """Samples of a batch."""
        return int(self._core.size)

    @property
    def nonfinite(self) -> int:
        """Samples left out."""
        return int(self._core.nonfinite)

    @property
    def means(self) -> Moments:
        """Of the means of the full batches, as a copy."""
        return _moments(self._core.means())

    def half_width(self, confidence: float = 0.95) -> float:
        """Of the mean's interval by Student's t; infinite below two full batches."""
        return self.means.half_width(confidence)

    def __setstate__(self, state: bytes) -> None:
        self._core = _core.BatchMeans(1)
        self._core.set_state(state)


class ConfidenceSequence(_Bytes):
    """Intervals for the mean of bounded samples, all of which hold at once.

    One may look after every sample and stop when one likes: with the confidence, no interval of
    the sequence ever misses the mean. That holds for any distribution on [low, high].

    Parameters
    ----------
    low, high : float
        Where the samples are known to lie.
    confidence : float
        In (0, 1).
    target : float, optional
        A half-width to reach: some 2 log(2 / (1 - confidence)) variance / target^2 samples do.
        Without one the sequence serves all counts alike, at a width that is larger by some
        sqrt(log N) and keeps falling.

    Raises
    ------
    ValueError, TypeError
        A value out of its range, or not a number.

    Notes
    -----
    The order of the samples counts, so that two sequences can't be merged. A sample outside
    [low, high] shows that the interval was wrong: it is counted in ``outside``, and the sequence
    is infinite from then on. Memory is constant, a sample takes some 30 ns.

    References
    ----------
    Waudby-Smith & Ramdas 2023, "Estimating means of bounded random variables by betting", theorem
    2 (predictable plug-in empirical Bernstein), with running intersection.

    Examples
    --------
    >>> import sunfleck as sf
    >>> c = sf.ConfidenceSequence(0, 1)
    >>> c.add(sf.Rng("pcg32", seed=1).random(10_000))
    >>> c.lower < 0.5 < c.upper
    True
    """

    __slots__ = ()

    def __init__(self, low: float, high: float, confidence: float = 0.95, *, target: float | None = None) -> None:
        reach = 0.0 if target is None else number("target", target)
        if target is not None and reach == 0:  # C's word for none
            raise ValueError("target is 0; give a half-width above 0, or None")
        self._core = _core.ConfidenceSequence(
            number("low", low), number("high", high), number("confidence", confidence), reach
        )

    def add(self, x: ArrayLike) -> None:
        """Adds a number, or every number of an array, in order.

        One that is not finite is counted and left out.

        Raises
        ------
        TypeError
            Samples that are not real numbers.
        """
        self._core.add(_float64(x))

    @property
    def count(self) -> int:
        """Samples so far, within [low, high]."""
        return int(self._core.count)

    @property
    def nonfinite(self) -> int:
        """Samples that were NaN or infinite."""
        return int(self._core.nonfinite)

    @property
    def outside(self) -> int:
        """Samples outside [low, high]."""
        return int(self._core.outside)

    @property
    def lower(self) -> float:
        """The interval's lower end; low before the first sample."""
        return float(self._core.lower)

    @property
    def upper(self) -> float:
        """The interval's upper end; high before the first sample."""
        return float(self._core.upper)

    def __setstate__(self, state: bytes) -> None:
        self._core = _core.ConfidenceSequence(0.0, 1.0, 0.5, 0.0)
        self._core.set_state(state)


def betting_interval(x: ArrayLike, low: float, high: float, confidence: float = 0.95) -> tuple[float, float]:
    """The interval for the mean of bounded samples by the hedged capital process.

    Holds at one count that was fixed ahead. Narrower than the empirical Bernstein bound, above
    all where samples are few or skewed; needs all samples at hand.

    Parameters
    ----------
    x : array_like
        Samples in [low, high], in their order, any shape.
    low, high : float
        Where the samples are known to lie.
    confidence : float
        In (0, 1).

    Returns
    -------
    tuple of two floats
        Lower and upper end. In the rare case (of a probability below 1 - confidence) that the
        samples contradict every mean, lower is above upper.

    Raises
    ------
    ValueError, TypeError
        A sample outside [low, high] or not finite, a bad interval or confidence.

    Notes
    -----
    Costs some 100 passes over the samples. Releases the GIL.

    References
    ----------
    Waudby-Smith & Ramdas 2023, "Estimating means of bounded random variables by betting", theorem 3.

    Examples
    --------
    No event in 100 samples, so that its probability is below 4.8 %:

    >>> import sunfleck as sf
    >>> lower, upper = sf.estimate.betting_interval([0.0] * 100, 0, 1)
    >>> lower, round(upper, 3)
    (0.0, 0.048)
    """
    return _core.betting_interval(
        _float64(x), number("low", low), number("high", high), number("confidence", confidence)
    )


def normal_quantile(p: float) -> float:
    """The z below which a standard normal falls with probability p, to 1e-13.

    Infinite at 0 and 1, NaN outside [0, 1].

    Examples
    --------
    >>> import sunfleck as sf
    >>> round(sf.estimate.normal_quantile(0.975), 6)
    1.959964
    """
    return _core.normal_quantile(number("p", p))


def student_t_quantile(p: float, dof: float) -> float:
    """The same of Student's t with ``dof`` degrees of freedom, to 1e-10.

    NaN for dof <= 0, or p outside [0, 1]. dof need not be whole.

    Examples
    --------
    >>> import sunfleck as sf
    >>> round(sf.estimate.student_t_quantile(0.975, 15), 6)
    2.13145
    """
    return _core.student_t_quantile(number("p", p), number("dof", dof))
