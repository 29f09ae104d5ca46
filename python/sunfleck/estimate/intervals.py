# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""intervals: for the mean, from batches or from bounded samples, and the quantiles that they are made of."""

from __future__ import annotations

from numpy.typing import ArrayLike

from sunfleck import _core
from sunfleck._arguments import integer, number
from sunfleck.estimate.accumulator import Accumulator, float64_of
from sunfleck.estimate.moments import Moments, moments_from

__all__ = ["BatchMeans", "ConfidenceSequence", "betting_interval", "normal_quantile", "student_t_quantile"]


class BatchMeans(Accumulator):
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
        self._core.add(float64_of(x))

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
        return moments_from(self._core.means())

    def half_width(self, confidence: float = 0.95) -> float:
        """Of the mean's interval by Student's t; infinite below two full batches."""
        return self.means.half_width(confidence)

    def __setstate__(self, state: bytes) -> None:
        self._core = _core.BatchMeans(1)
        self._core.set_state(state)


class ConfidenceSequence(Accumulator):
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
        self._core.add(float64_of(x))

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
        float64_of(x), number("low", low), number("high", high), number("confidence", confidence)
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
