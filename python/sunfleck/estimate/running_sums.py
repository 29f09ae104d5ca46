# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""running_sums: the lecture's sums of f and of f squared, kept as the way that fails."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from sunfleck import _core
from sunfleck._arguments import one_of
from sunfleck.estimate.accumulator import Accumulator, samples_of

__all__ = ["RunningSums"]


class RunningSums(Accumulator):
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
        self._core.add(np.require(samples_of(x), self.dtype, ["C", "A"]))

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
