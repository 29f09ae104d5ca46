# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""figure: panels of data as matplotlib's charts and as interactive ones, and how both look."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sunfleck._files import FilePath, replacing
from sunfleck.error import Error

__all__ = [
    "COLORS",
    "FIGURE_TYPES",
    "Figure",
    "Panel",
    "Series",
    "bare_figure",
    "draw_panels",
    "new_figure",
    "plotly_figure",
    "png",
    "require_matplotlib",
    "save",
]

FIGURE_TYPES = (".png", ".svg")

COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#8C6D31")
"""Colours that are told apart with every kind of colour vision (Okabe & Ito 2008; the last is ours)."""

_MARKERS = "os^Dv*PX"


@dataclass
class Series:
    """Points with one name; `low` and `high` are the ends of their spread. Bars have `labels` below them."""

    name: str
    x: ArrayLike
    y: ArrayLike
    low: ArrayLike | None = None
    high: ArrayLike | None = None
    line: bool = True
    labels: Sequence[str] | None = None
    bars: bool = False
    marker_size: float = 4.0


@dataclass
class Panel:
    """One pair of axes and what is drawn on it; `image`, shape (rows, columns), lies below."""

    title: str
    x: str
    y: str
    series: list[Series] = field(default_factory=list)
    x_log: bool = True
    y_log: bool = True
    note: str = ""
    image: ArrayLike | None = None


def _pyplot() -> Any:
    try:
        from matplotlib import figure
    except ImportError:
        raise Error("figures need matplotlib; pip install 'sunfleck[chart]' brings it") from None
    return figure


def require_matplotlib() -> None:
    """Raises where figures can't be drawn, before work whose end is a figure.

    Raises
    ------
    sunfleck.Error
        matplotlib is not installed.
    """
    _pyplot()


def new_figure(rows: int, columns: int, width: float = 4.6, height: float = 3.6) -> tuple[Any, NDArray[Any]]:
    """A figure with rows x columns of axes, each so many inches.

    Returns
    -------
    figure, array of axes, shape (rows, columns)

    Raises
    ------
    sunfleck.Error
        matplotlib is not installed.
    """
    made = _pyplot().Figure(figsize=(columns * width, rows * height + 0.4), dpi=110, layout="constrained")
    return made, made.subplots(rows, columns, squeeze=False)


def bare_figure(width: float, height: float, dpi: float) -> Any:
    """A figure of so many inches without axes, for what lays out its own.

    Raises
    ------
    sunfleck.Error
        matplotlib is not installed.
    """
    return _pyplot().Figure(figsize=(width, height), dpi=dpi)


def _style(series: Series, number: int) -> dict[str, Any]:
    return {
        "color": COLORS[number % len(COLORS)],
        "marker": _MARKERS[number % len(_MARKERS)],
        "markersize": series.marker_size,
        "markeredgewidth": min(1.0, series.marker_size / 4),
        "linestyle": "-" if series.line else "none",
        "linewidth": 1.3,
    }


def _draw_bars(ax: Any, series: Series, color: str) -> None:
    at = np.asarray(series.x, dtype=float)
    drawn = ax.bar(at, series.y, width=0.6, color=color, label=series.name)
    ax.bar_label(drawn, fmt="%.4g", fontsize=7, padding=1)
    if not np.any(series.y):
        ax.set_ylim(0, 1)


def _draw_image(ax: Any, image: ArrayLike) -> None:
    drawn = ax.imshow(image, cmap="cividis", interpolation="nearest", aspect="auto")
    ax.figure.colorbar(drawn, ax=ax, shrink=0.8).ax.tick_params(labelsize=6)


def _draw(ax: Any, panel: Panel, names: dict[str, int]) -> None:
    if panel.image is not None:
        _draw_image(ax, panel.image)
    for series in panel.series:
        if series.bars:
            _draw_bars(ax, series, COLORS[names.setdefault(series.name, len(names)) % len(COLORS)])
            continue
        style = _style(series, names.setdefault(series.name, len(names)))
        ax.plot(series.x, series.y, label=series.name, **style)
        if series.low is not None and series.high is not None:
            ax.fill_between(series.x, series.low, series.high, color=style["color"], alpha=0.15, linewidth=0)
        for x, y, label in zip(np.atleast_1d(series.x), np.atleast_1d(series.y), series.labels or (), strict=False):
            ax.annotate(label, (x, y), fontsize=6, xytext=(3, 3), textcoords="offset points")
    ax.set(title=panel.title, xlabel=panel.x, ylabel=panel.y)
    ax.set_xscale("log" if panel.x_log else "linear")
    ax.set_yscale("log" if panel.y_log else "linear")
    for series in panel.series:
        if series.bars and series.labels:
            ax.set_xticks(np.asarray(series.x, dtype=float), series.labels)  # after the scale, which resets them
    ax.title.set_fontsize(9)
    if panel.image is None:
        ax.grid(alpha=0.25, linewidth=0.5)
    ax.tick_params(labelsize=7)
    if panel.note:
        ax.text(0.02, 0.02, panel.note, transform=ax.transAxes, fontsize=6, va="bottom", family="monospace")
    if len(panel.series) > 1:
        ax.legend(fontsize=6, framealpha=0.6)


def draw_panels(panels: Sequence[Panel], about: str, columns: int = 3) -> Any:
    """The panels as one figure of matplotlib's, with `about` below it.

    Parameters
    ----------
    panels : sequence of Panel
    about : str
        Where the numbers come from, see `sunfleck.provenance.provenance`.
    columns : int
        At the most.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    sunfleck.Error
        matplotlib is not installed.
    """
    columns = min(columns, len(panels))
    made, axes = new_figure(-(-len(panels) // columns), columns)
    names: dict[str, int] = {}
    for ax, panel in zip(axes.flat, panels, strict=False):
        _draw(ax, panel, names)
    for ax in axes.flat[len(panels) :]:
        ax.set_axis_off()
    made.supxlabel(about, fontsize=6, color="#555555")
    return made


def png(made: Any) -> bytes:
    """The figure as a PNG file's bytes."""
    buffer = io.BytesIO()
    made.savefig(buffer, format="png", dpi=made.dpi)  # whatever matplotlib's settings say
    return buffer.getvalue()


def save(made: Any, path: FilePath) -> None:
    """Writes the figure beside `path`, then renames it.

    Raises
    ------
    ValueError
        An ending that is not among `FIGURE_TYPES`.
    OSError
        The file can't be written.
    """
    with replacing(path, "figures", FIGURE_TYPES) as target:
        made.savefig(target, format=target.suffix[1:], dpi=made.dpi)


class Figure:
    """A figure that shows itself in a notebook.

    Attributes
    ----------
    drawn : matplotlib.figure.Figure
        To add to, or to draw otherwise.

    Examples
    --------
    >>> import sunfleck as sf
    >>> sf.show(sf.points("sobol", 64)).png()[1:4]
    b'PNG'
    """

    def __init__(self, drawn: Any) -> None:
        self.drawn = drawn

    def png(self) -> bytes:
        """A PNG file's bytes."""
        return png(self.drawn)

    def save(self, path: FilePath) -> None:
        """Writes the figure beside `path`, then renames it; .png or .svg.

        Raises
        ------
        ValueError
            Another ending.
        OSError
            The file can't be written.
        """
        save(self.drawn, path)

    def _repr_png_(self) -> bytes:
        return self.png()


def plotly_figure(panel: Panel, names: dict[str, int]) -> dict[str, Any]:
    """The panel as plotly has figures: traces and a layout, of plain lists.

    Parameters
    ----------
    panel : Panel
    names : dict
        Colour numbers by series name, so that the panels of a page agree; filled.
    """
    traces: list[dict[str, Any]] = []
    for series in panel.series:
        color = COLORS[names.setdefault(series.name, len(names)) % len(COLORS)]
        x, y = (np.asarray(v, dtype=float).tolist() for v in (np.atleast_1d(series.x), np.atleast_1d(series.y)))
        trace: dict[str, Any] = {"type": "scatter", "x": x, "y": y, "name": series.name, "line": {"color": color}}
        trace["mode"] = "lines+markers" if series.line else "markers"
        if series.labels:
            trace["text"] = list(series.labels)
        if series.low is not None and series.high is not None:
            up, down = np.asarray(series.high, float) - y, np.asarray(y) - np.asarray(series.low, float)
            trace["error_y"] = {"type": "data", "array": up.tolist(), "arrayminus": down.tolist(), "thickness": 0.8}
        traces.append(trace)
    axis = {"x": panel.x_log, "y": panel.y_log}
    layout = {
        "title": {"text": panel.title},
        "xaxis": {"title": {"text": panel.x}, "type": "log" if axis["x"] else "linear"},
        "yaxis": {"title": {"text": panel.y}, "type": "log" if axis["y"] else "linear"},
        "height": 480,
    }
    return {"data": traces, "layout": layout}
