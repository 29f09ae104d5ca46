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

from sunfleck.error import Error
from sunfleck.io.files import FilePath, replacing

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
    """Points with one name, by which they have their colour; `low` and `high` are the ends of their spread.

    The legend has `label`, or else the name. A `style` "guide" is a thin grey line beside the data,
    "front" a ring around points that other series show. Bars have `labels` below them.
    """

    name: str
    x: ArrayLike
    y: ArrayLike
    low: ArrayLike | None = None
    high: ArrayLike | None = None
    line: bool = True
    labels: Sequence[str] | None = None
    bars: bool = False
    marker_size: float = 4.0
    label: str | None = None
    style: str = "data"


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
    legend: bool = True


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


def _color(series: Series, names: dict[str, int]) -> str:
    """The same for a name wherever it stands; what is beside the data takes none of the colours."""
    if series.style != "data":
        return {"guide": "#888888", "front": "#000000"}[series.style]
    return COLORS[names.setdefault(series.name, len(names)) % len(COLORS)]


def _style(series: Series, names: dict[str, int]) -> dict[str, Any]:
    color = _color(series, names)
    if series.style == "guide":
        return {"color": color, "linestyle": "--", "linewidth": 1.0}
    if series.style == "front":
        return {"color": color, "linestyle": "none", "marker": "o", "markersize": 8, "markerfacecolor": "none"}
    number = names[series.name]
    return {
        "color": color,
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


Box = tuple[float, float, float, float]


def _covered(box: Box, taken: Sequence[Box], frame: Box) -> float:
    """What a label in this box would cover, in square pixels, and what of it would stick out of the axes."""
    left, low, right, top = box
    shared = [max(0, min(right, c) - max(left, a)) * max(0, min(top, d) - max(low, b)) for a, b, c, d in taken]
    outside = max(0, frame[0] - left) + max(0, right - frame[2]) + max(0, frame[1] - low) + max(0, top - frame[3])
    return float(sum(shared) + 10 * outside)


def _labelled(panel: Panel) -> bool:
    """Whether points have names beside them."""
    return any(series.labels and not series.bars for series in panel.series)


def _place_labels(ax: Any, panel: Panel) -> None:
    """Names beside points, each on the side where it covers least of other names and points."""
    size, pixels = 6, ax.figure.dpi / 72
    points = [ax.transData.transform(np.column_stack([s.x, s.y])) for s in panel.series if s.style == "data"]
    taken = [(x - 3, y - 3, x + 3, y + 3) for x, y in np.concatenate(points)]
    for series in panel.series:
        for place, label in zip(np.column_stack([series.x, series.y]), series.labels or (), strict=False):
            x, y = ax.transData.transform(place)
            width, height = 0.58 * size * pixels * len(label), 1.15 * size * pixels
            sides = [(dx, dy) for g in (4, 11) for dx in (g, -g - width) for dy in (-height / 2, g, -g - height)]
            sides += [(-width / 2, dy) for gap in (5, 13, 21) for dy in (gap, -gap - height)]
            boxes = [(x + dx, y + dy, x + dx + width, y + dy + height) for dx, dy in sides]
            best = min(boxes, key=lambda box: _covered(box, taken, ax.bbox.extents))
            taken.append(best)
            offset = ((best[0] - x) / pixels, (best[1] - y) / pixels)
            ax.annotate(label, place, fontsize=size, xytext=offset, textcoords="offset points")


def _make_room_below(ax: Any, share: float) -> None:
    """Moves the lower end of y down, so that no data lie in that share of the height."""
    transform = ax.yaxis.get_transform()
    low, high = transform.transform(np.array(ax.get_ylim()))
    low = high - (high - low) / (1 - share)
    ax.set_ylim(bottom=transform.inverted().transform(np.array([low]))[0])


def _draw(ax: Any, panel: Panel, names: dict[str, int]) -> None:
    if panel.image is not None:
        _draw_image(ax, panel.image)
    for series in panel.series:
        if series.bars:
            _draw_bars(ax, series, _color(series, names))
            continue
        style = _style(series, names)
        ax.plot(series.x, series.y, label=series.label or series.name, **style)
        if series.low is not None and series.high is not None:
            ax.fill_between(series.x, series.low, series.high, color=style["color"], alpha=0.15, linewidth=0)
    ax.set(title=panel.title, xlabel=panel.x, ylabel=panel.y)
    ax.set_xscale("log" if panel.x_log else "linear")
    ax.set_yscale("log" if panel.y_log else "linear")
    for series in panel.series:
        if series.bars and series.labels:
            ax.set_xticks(np.asarray(series.x, dtype=float), series.labels)  # after the scale, which resets them
    ax.title.set_fontsize(9)
    if panel.image is None:
        ax.grid(alpha=0.25, linewidth=0.5)
    if _labelled(panel):
        ax.margins(0.08)
        if not panel.y_log and all(np.array_equal(s.y, np.rint(s.y)) for s in panel.series):
            ax.yaxis.get_major_locator().set_params(integer=True)
    ax.tick_params(labelsize=7)
    ax.tick_params(which="minor", labelsize=6)
    if panel.note:
        if panel.image is None and not any(series.bars for series in panel.series):
            _make_room_below(ax, 0.04 * (1 + panel.note.count("\n")) + 0.02)
        ax.text(0.02, 0.02, panel.note, transform=ax.transAxes, fontsize=6, va="bottom", family="monospace")
    if len(panel.series) > 1 and panel.legend:
        ax.legend(fontsize=6, framealpha=0.6, loc="upper right" if panel.series[-1].style == "front" else "best")


def draw_panels(panels: Sequence[Panel], about: str, columns: int = 3, size: tuple[float, float] = (4.6, 3.6)) -> Any:
    """The panels as one figure of matplotlib's, with `about` below it.

    Parameters
    ----------
    panels : sequence of Panel
    about : str
        Where the numbers come from, see `sunfleck.provenance.provenance`.
    columns : int
        At the most.
    size : (float, float)
        Of a panel, in inches.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    sunfleck.Error
        matplotlib is not installed.
    """
    columns = min(columns, len(panels))
    made, axes = new_figure(-(-len(panels) // columns), columns, *size)
    names: dict[str, int] = {}
    for ax, panel in zip(axes.flat, panels, strict=False):
        _draw(ax, panel, names)
    for ax in axes.flat[len(panels) :]:
        ax.set_axis_off()
    made.supxlabel(about, fontsize=6, color="#555555")
    if any(_labelled(panel) for panel in panels):
        made.draw_without_rendering()  # places the axes, so that it is known where points are
        for ax, panel in zip(axes.flat, panels, strict=False):
            if _labelled(panel):
                _place_labels(ax, panel)
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
        color = _color(series, names)
        x, y = (np.atleast_1d(np.asarray(v, dtype=float)).tolist() for v in (series.x, series.y))
        y = [v if np.isfinite(v) else None for v in y]  # JSON knows no NaN
        trace: dict[str, Any] = {"type": "scatter", "x": x, "y": y, "name": series.label or series.name}
        trace["line"] = {"color": color, "dash": "dash" if series.style == "guide" else "solid"}
        trace["mode"] = "lines" if series.style == "guide" else "lines+markers" if series.line else "markers"
        if series.style == "front":
            trace["marker"] = {"symbol": "circle-open", "size": 14, "color": color}
        if series.labels:
            trace["text"] = list(series.labels)
        if series.low is not None and series.high is not None:
            low, middle, high = (np.nan_to_num(np.asarray(v, float)) for v in (series.low, series.y, series.high))
            spread = {"array": (high - middle).tolist(), "arrayminus": (middle - low).tolist()}
            trace["error_y"] = {"type": "data", "thickness": 0.8, **spread}
        traces.append(trace)
    axis = {"x": panel.x_log, "y": panel.y_log}
    layout = {
        "title": {"text": panel.title},
        "xaxis": {"title": {"text": panel.x}, "type": "log" if axis["x"] else "linear"},
        "yaxis": {"title": {"text": panel.y}, "type": "log" if axis["y"] else "linear"},
        "height": 480,
    }
    return {"data": traces, "layout": layout}
