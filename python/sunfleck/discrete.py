# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""discrete: sampling in proportion to weights that are given by data.

`AliasTable` draws one of n things in constant time; `PiecewiseConstant1D` and `PiecewiseConstant2D`
draw places on the unit interval or square, in proportion to the cell that they lie in, as an
environment map is sampled. Like mappings they have `sample`, `pdf` and `invert`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sunfleck import _core
from sunfleck._arguments import array_of, output_array, real_array

__all__ = ["AliasTable", "PiecewiseConstant1D", "PiecewiseConstant2D"]


def _weights(value: ArrayLike, axes: int) -> NDArray[Any]:
    array = real_array("weights", value, np.dtype(np.float64))
    if array.ndim != axes or array.size == 0:
        shape = "(n,)" if axes == 1 else "(rows, columns)"
        raise ValueError(f"weights has shape {array.shape}; give {shape}, none of them 0")
    return array


class AliasTable:
    """One of n entries, in proportion to its weight, in constant time.

    Parameters
    ----------
    weights : array_like, shape (n,)
        Finite, at least 0, one of them positive. An entry of weight 0 is never drawn.

    Raises
    ------
    ValueError, TypeError
        Weights of another shape, kind or range.

    Notes
    -----
    Takes 24 bytes an entry. Immutable: may be read by any number of threads. Probabilities are within
    2**-25 / n of the weights' shares.

    References
    ----------
    .. [1] Vose, "A linear algorithm for generating random numbers with a given distribution", 1991.

    Examples
    --------
    >>> import numpy as np, sunfleck as sf
    >>> table = sf.AliasTable([1, 0, 3])
    >>> np.bincount(table.sample(sf.points("uniform", 1000, d=1)[:, 0]))
    array([250,   0, 750])
    >>> table.pdf(2)
    array(0.75)
    """

    def __init__(self, weights: ArrayLike) -> None:
        self._weights = _weights(weights, 1).copy()  # a copy or pickle builds the table anew
        self._table = _core.AliasTable(self._weights)

    def __reduce__(self) -> tuple[type[AliasTable], tuple[NDArray[Any]]]:
        return AliasTable, (self._weights,)

    def __len__(self) -> int:
        return len(self._table)

    def sample(self, u: ArrayLike, *, out: NDArray[Any] | None = None) -> NDArray[np.uint32]:
        """The entries for values of the unit interval.

        Parameters
        ----------
        u : array_like, shape (...)
            In [0, 1); float32 stays (up to 2**24 entries), the rest becomes float64.
        out : ndarray of uint32, optional
            Filled in place: C-contiguous, of ``u``'s shape.

        Returns
        -------
        ndarray of uint32, shape (...)

        Raises
        ------
        ValueError, TypeError
            A value outside [0, 1), or an ``out`` that would need a copy.
        """
        array = real_array("u", u, None)
        target = output_array(out, array.shape, np.dtype(np.uint32))
        self._table.sample(array, target)
        return target

    def pdf(self, index: ArrayLike, *, out: NDArray[Any] | None = None) -> NDArray[np.float64]:
        """The probability of entries: weight over the sum of all.

        Parameters
        ----------
        index : array_like of int, shape (...)
            0 .. n - 1.
        out : ndarray of float64, optional

        Returns
        -------
        ndarray of float64, shape (...)

        Raises
        ------
        ValueError, TypeError
            An index out of range, or an ``out`` that would need a copy.
        """
        array = _indices(index)
        target = output_array(out, array.shape, np.dtype(np.float64))
        self._table.pdf(array, target)
        return target

    def invert(self, index: ArrayLike, *, out: NDArray[Any] | None = None) -> NDArray[np.float64]:
        """A value that `sample` takes to each entry: the middle of those in the entry's own column.

        Parameters
        ----------
        index : array_like of int, shape (...)
            0 .. n - 1, of positive weight.
        out : ndarray of float64, optional

        Returns
        -------
        ndarray of float64, shape (...)

        Raises
        ------
        ValueError, TypeError
            An index out of range or of weight 0, or an ``out`` that would need a copy.
        """
        array = _indices(index)
        target = output_array(out, array.shape, np.dtype(np.float64))
        self._table.invert(array, target)
        return target


def _indices(index: ArrayLike) -> NDArray[np.uint32]:
    array = array_of("index", index)
    if array.dtype.kind not in "iu":
        raise TypeError(f"index has dtype {array.dtype}; give integers")
    if array.size and not (array.min() >= 0 and array.max() < 1 << 32):
        raise ValueError(f"index runs from {array.min()} to {array.max()}; it must be 0 .. n - 1")
    return np.require(array, np.uint32, ["C", "A"])


class _Piecewise:
    """What the line and the square have in common."""

    _core: _core.Piecewise
    _weights: NDArray[Any]  # a copy or pickle builds the tables anew
    _point: tuple[int, ...]

    def __reduce__(self) -> tuple[type[_Piecewise], tuple[NDArray[Any]]]:
        return type(self), (self._weights,)

    def _fill(self, operation: str, points: ArrayLike, out: NDArray[Any] | None) -> NDArray[Any]:
        array = real_array("the points", points, None)
        leading = array.shape[: array.ndim - len(self._point)]
        if array.shape[len(leading) :] != self._point:
            raise ValueError(f"the points have shape {array.shape}; {operation} takes (..., {self._point[0]})")
        target = output_array(out, leading if operation == "pdf" else array.shape, array.dtype)
        if np.may_share_memory(target, array):
            raise ValueError("out overlaps the points; give an array of its own")
        self._core.fill(operation, array, target)
        return target

    def sample(self, u: ArrayLike, *, out: NDArray[Any] | None = None) -> NDArray[Any]:
        """The places that values in [0, 1) go to, in [0, 1) as well; of `u`'s shape and dtype.

        Raises
        ------
        ValueError, TypeError
            A value outside [0, 1), a wrong shape, or an ``out`` that would need a copy.
        """
        return self._fill("sample", u, out)

    def pdf(self, x: ArrayLike, *, out: NDArray[Any] | None = None) -> NDArray[Any]:
        """The density at places in [0, 1): the cell's weight over the mean of all.

        Raises
        ------
        ValueError, TypeError
            As `sample`.
        """
        return self._fill("pdf", x, out)

    def invert(self, x: ArrayLike, *, out: NDArray[Any] | None = None) -> NDArray[Any]:
        """The values that `sample` takes to these places.

        Raises
        ------
        ValueError, TypeError
            As `sample`.
        """
        return self._fill("invert", x, out)


class PiecewiseConstant1D(_Piecewise):
    """A density on [0, 1) that is constant on each of n cells of equal width.

    Parameters
    ----------
    weights : array_like, shape (n,)
        Finite, at least 0, one of them positive; n up to 2**24.

    Notes
    -----
    `sample`, `pdf` and `invert` take arrays of any shape, float32 or float64 (the rest becomes
    float64). `sample` is monotone, so that strata stay whole. A guide table finds the cell in a step
    or two [1]_. Takes 20 bytes a cell. Immutable: may be read by any number of threads.

    References
    ----------
    .. [1] Chen & Asau, "On generating random variates from an empirical distribution", 1974.

    Examples
    --------
    >>> import sunfleck as sf
    >>> density = sf.PiecewiseConstant1D([1, 3])
    >>> density.sample([0.125, 0.25, 0.625])
    array([0.25, 0.5 , 0.75])
    >>> density.pdf([0.25, 0.75])
    array([0.5, 1.5])
    """

    def __init__(self, weights: ArrayLike) -> None:
        array = self._weights = _weights(weights, 1).copy()
        self._core = _core.Piecewise(array, array.size, 0)
        self._point = ()


class PiecewiseConstant2D(_Piecewise):
    """A density on [0, 1)² that is constant on each cell of a grid: an image, an environment map.

    Parameters
    ----------
    weights : array_like, shape (rows, columns)
        Finite, at least 0, one of them positive; row 0 lies at y = 0, column 0 at x = 0. Each axis up to
        2**24. For an environment map in latitude and longitude the weight is radiance times the
        sine of the angle from the pole.

    Notes
    -----
    `sample`, `pdf` and `invert` take points (x, y), arrays of shape (..., 2), float32 or float64 (the
    rest becomes float64). The second coordinate chooses the row, the first the place in it.
    Takes 20 bytes a cell. Immutable: may be read by any number of threads.

    Examples
    --------
    >>> import sunfleck as sf
    >>> density = sf.PiecewiseConstant2D([[1, 0], [0, 3]])
    >>> x = density.sample(sf.points("sobol", 1024))
    >>> float((x[:, 0] < 0.5).mean())
    0.25
    >>> density.pdf([0.25, 0.75])
    array(0.)
    """

    def __init__(self, weights: ArrayLike) -> None:
        array = self._weights = _weights(weights, 2).copy()
        self._core = _core.Piecewise(array, array.shape[1], array.shape[0])
        self._point = (2,)
