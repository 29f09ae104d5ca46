# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""show: point sets as pictures: of the plane as they lie, of space as seen from a little above.

Point sets are plain NumPy arrays, which show themselves as numbers; a class of their own would have to
follow every slice and sum of them about. So a function draws them, whatever array they are in.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sunfleck.plot.figure import COLORS, Figure, new_figure

__all__ = ["draw_points", "seen", "show"]

_ELEVATION = np.radians(24.0)
_AZIMUTH = np.radians(-60.0)
_FAR = "#93B8D1"  # COLORS[0], paler
_SIDE, _WIDEST = 2.8, 10.4  # inches: of a set, and of them all


def seen(points: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points of space in the plane of the picture, +z up, and how near they are.

    Parameters
    ----------
    points : array_like, shape (n, 3)

    Returns
    -------
    tuple of ndarray of float64, shapes (n, 2) and (n,)
        Right and up; the distance towards the viewer.
    """
    x, y, z = np.asarray(points, dtype=np.float64).T
    right = x * np.cos(_AZIMUTH + np.pi / 2) + y * np.sin(_AZIMUTH + np.pi / 2)
    near = x * np.cos(_AZIMUTH) + y * np.sin(_AZIMUTH)
    up = z * np.cos(_ELEVATION) - near * np.sin(_ELEVATION)
    return np.stack([right, up], axis=1), near * np.cos(_ELEVATION) + z * np.sin(_ELEVATION)


def _checked(name: str, points: ArrayLike) -> NDArray[np.float64]:
    array = np.asarray(points)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} has dtype {array.dtype}; give real numbers")
    if array.ndim != 2 or array.shape[1] not in (2, 3):
        raise ValueError(f"{name} has shape {array.shape}; give (n, 2) or (n, 3): of more columns, those to be seen")
    return array.astype(np.float64)


def draw_points(ax: Any, points: ArrayLike, outline: Sequence[ArrayLike] = ()) -> None:
    """Draws points on axes, in equal units.

    Parameters
    ----------
    ax : matplotlib.axes.Axes
    points : array_like, shape (n, 2) or (n, 3)
        Those of space as `seen`: the nearer half dark and above, the farther half pale.
    outline : sequence of array_like, shape (m, 2) or (m, 3)
        Lines of the same space.
    """
    array = _checked("points", points)
    size = float(np.clip(54 / np.sqrt(max(len(array), 1)), 0.8, 4.0))
    style = {
        "linestyle": "none",
        "marker": "o",
        "markersize": size,
        "markeredgewidth": 0,
        "rasterized": len(array) > 5000,
    }
    if array.shape[1] == 3:
        flat, near = seen(array)
        middle = (near.min(initial=np.inf) + near.max(initial=-np.inf)) / 2 if len(near) else 0.0
        ax.plot(*flat[near < middle].T, color=_FAR, **style)
        ax.plot(*flat[near >= middle].T, color=COLORS[0], **style)
    else:
        ax.plot(*array.T, color=COLORS[0], **style)
    for line in outline:
        corners = np.asarray(line, dtype=np.float64)
        ax.plot(*(seen(corners)[0] if corners.shape[1] == 3 else corners).T, color="#888888", linewidth=0.7, zorder=1)
    ax.set_aspect("equal")
    ax.set(xticks=[], yticks=[])
    if array.shape[1] == 3 or outline:
        ax.set_axis_off()
    elif array.min(initial=0) >= 0 and array.max(initial=0) < 1:
        ax.set(xlim=(0, 1), ylim=(0, 1))
    if outline:
        ax.margins(0.03)


def _fit(drawn: Any, axes: NDArray[Any], side: float, named: bool) -> None:
    """Gives the figure the height that its axes need in equal units."""
    rows, columns = axes.shape
    limits = [(ax.get_xlim(), ax.get_ylim()) for ax in axes.flat if ax.axison or ax.lines]
    slopes = [(top - bottom) / (right - left) for (left, right), (bottom, top) in limits if right > left]
    slope = float(np.clip(max(slopes, default=1.0), 0.2, 2.0))
    drawn.set_size_inches(columns * side, rows * (side * slope + (0.3 if named else 0.0)))


def show(points: ArrayLike | Mapping[str, ArrayLike], *, outline: Sequence[ArrayLike] = (), columns: int = 5) -> Figure:
    """Point sets as a figure that shows itself in a notebook.

    Parameters
    ----------
    points : array_like, shape (n, 2) or (n, 3), or a mapping of names to such arrays
        Several are drawn side by side, each under its name. Points of [0,1)^2 in the unit square; points of
        space from a little above with +z up, the nearer half dark, the farther half pale.
    outline : sequence of array_like, shape (m, 2) or (m, 3)
        Lines to draw as well, around each.
    columns : int
        At the most.

    Returns
    -------
    sunfleck.plot.figure.Figure
        With ``save`` to .png or .svg.

    Raises
    ------
    ValueError, TypeError
        Another shape, or not real numbers.
    sunfleck.Error
        matplotlib is not installed.

    Examples
    --------
    >>> import sunfleck as sf
    >>> figure = sf.show({name: sf.points(name, 256) for name in ("random", "jittered", "sobol")})
    >>> directions = sf.show(sf.mapping.cosine_hemisphere.sample(sf.points("sobol", 512)))
    """
    sets = dict(points) if isinstance(points, Mapping) else {"": points}
    if not sets:
        raise ValueError("points has no sets in it; give at least one")
    arrays = {name: _checked(f"points {name!r}" if name else "points", values) for name, values in sets.items()}
    columns = min(columns, len(arrays))
    side = min(_SIDE, _WIDEST / columns)
    drawn, axes = new_figure(-(-len(arrays) // columns), columns, side, side)
    for ax, (name, array) in zip(axes.flat, arrays.items(), strict=False):
        draw_points(ax, array, outline)
        ax.set_title(name, fontsize=10)
    for ax in axes.flat[len(arrays) :]:
        ax.set_axis_off()
    _fit(drawn, axes, side, named=any(arrays))
    return Figure(drawn)
