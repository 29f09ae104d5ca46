# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""heatmap: samples, half-widths and stop reasons of an image in colours, with scale and unit."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sunfleck import _core
from sunfleck._arguments import choice, spoken
from sunfleck.plot.figure import COLORS, Figure, bare_figure

__all__ = ["HEATMAPS", "heatmap"]

HEATMAPS = ("samples", "half_width", "stop_reason")

_UNKNOWN = "#BBBBBB"
_REASON_COLORS = {
    "fixed": COLORS[5],  # sky blue
    "met": COLORS[2],  # green
    "max_samples": COLORS[4],  # orange
    "out_of_time": COLORS[3],  # purple
    "suspicious": COLORS[1],  # vermilion
    "interrupted": COLORS[0],  # blue
    "masked": COLORS[6],  # black
}


@dataclass(frozen=True)
class _Scale:
    """Colours, what they stand for, a value to mark, and where ticks may fall: steps x base^e."""

    colors: str
    label: str
    mark: float
    steps: Sequence[float]
    base: float


# In pixels of the figure.
_DPI = 100
_LONG_SIDE = 384
_LEFT, _RIGHT, _TOP, _BOTTOM = 48, 172, 34, 30
_NARROWEST = 200


def _axes(height: int, width: int, title: str, scale: int) -> tuple[Any, Any, Any]:
    """A figure, axes that give each pixel of the image scale x scale of its own, and a bar's axes."""
    inner = max(width * scale, _NARROWEST)
    across, down = _LEFT + inner + _RIGHT, _TOP + height * scale + _BOTTOM
    drawn = bare_figure(across / _DPI, down / _DPI, _DPI)

    def place(left: float, wide: float, high: float) -> Any:
        return drawn.add_axes((left / across, 1 - (_TOP + high) / down, wide / across, high / down))

    ax = place(_LEFT, width * scale, height * scale)
    ax.tick_params(labelsize=7)
    ax.locator_params(integer=True)
    drawn.text(_LEFT / across, 1 - 10 / down, title, fontsize=9, va="top")
    return drawn, ax, place(_LEFT + width * scale + 12, 14, height * scale)


def _show(ax: Any, values: Any, x0: int, y0: int, **how: Any) -> Any:
    height, width = values.shape[:2]
    extent = (x0, x0 + width, y0 + height, y0)
    return ax.imshow(values, interpolation="none", aspect="auto", extent=extent, **how)


def _number(value: float) -> str:
    return f"{value:,.0f}" if value >= 1000 else f"{value:.3g}"


def _scale_of(values: NDArray[np.float64]) -> tuple[Any, NDArray[np.bool_]]:
    """A logarithmic scale over what is known, and what is not."""
    from matplotlib.colors import LogNorm

    unknown = ~np.isfinite(values)
    known = values[~unknown & (values > 0)]
    low, high = (float(known.min()), float(known.max())) if known.size else (1.0, 1.0)
    return LogNorm(low, high if high > low else 1.001 * low, clip=True), unknown


def _ticks(low: float, high: float, steps: Sequence[float], base: float) -> list[float]:
    """At most seven of steps x base^e between low and high, evenly; the ends where there are fewer than two."""
    first, last = (int(np.floor(np.log(value) / np.log(base))) for value in (low, high))
    round_ones = [step * base**e for e in range(first, last + 1) for step in steps]
    inside = [value for value in round_ones if low <= value <= high]
    return inside[:: -(-len(inside) // 7)] if len(inside) >= 2 else sorted({low, high})


def _draw_scale(parts: tuple[Any, Any, Any], values: NDArray[np.float64], how: _Scale, x0: int, y0: int) -> None:
    from matplotlib import colormaps
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

    drawn, ax, bar = parts
    norm, unknown = _scale_of(values)
    # A zero is known, and below any scale of logarithms: it takes the lowest colour.
    filled = np.ma.masked_array(np.where(unknown, norm.vmin, np.maximum(values, norm.vmin)), mask=unknown)
    colors = colormaps[how.colors].with_extremes(bad=_UNKNOWN)
    shown = _show(ax, filled, x0, y0, norm=norm, cmap=colors)
    scale = drawn.colorbar(shown, cax=bar)
    scale.ax.yaxis.set_major_locator(FixedLocator(_ticks(norm.vmin, norm.vmax, how.steps, how.base)))
    scale.ax.yaxis.set_minor_locator(NullLocator())
    scale.ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: _number(value)))
    scale.ax.tick_params(labelsize=7)
    scale.set_label(how.label, fontsize=8)
    if norm.vmin < how.mark < norm.vmax:
        scale.ax.axhline(how.mark, color="white", linewidth=3)
        scale.ax.axhline(how.mark, color="black", linewidth=1)
    if unknown.any():
        ax.plot([], [], "s", color=_UNKNOWN, label="unknown")
        ax.legend(fontsize=7, loc="lower right", bbox_to_anchor=(1, 1), frameon=False)
    if unknown.all():
        bar.set_visible(False)


def _percent(share: float) -> str:
    """Rounded down to a hundredth, so that only a whole is called 100 %."""
    hundredths = math.floor(10_000 * share)
    return f"{hundredths / 100:g} %" if hundredths else "< 0.01 %"


def _draw_reasons(parts: tuple[Any, Any, Any], reasons: NDArray[np.uint8], x0: int, y0: int) -> None:
    from matplotlib.colors import to_rgb

    drawn, ax, bar = parts
    drawn.delaxes(bar)
    names = _core.stop_reasons()
    palette = np.array([to_rgb(_REASON_COLORS[name]) for name in names])
    _show(ax, palette[reasons], x0, y0)
    for number, name in enumerate(names):
        share = float(np.mean(reasons == number))
        if share > 0:
            ax.plot([], [], "s", color=palette[number], label=f"{spoken(name)}: {_percent(share)}")
    ax.legend(fontsize=7, loc="upper left", bbox_to_anchor=(1, 1), frameon=False, handletextpad=0.2)


def heatmap(channels: Mapping[str, NDArray[Any]], channel: str, metadata: Mapping[str, str]) -> Figure:
    """What `sunfleck.Image.heatmap` returns.

    Parameters
    ----------
    channels : mapping of str to ndarray, shape (h, w)
    channel : str
        One of `HEATMAPS`.
    metadata : mapping of str to str
        The image's.

    Raises
    ------
    ValueError
        Another channel.
    sunfleck.Error
        matplotlib is not installed.
    """
    channel = choice("channel", channel, HEATMAPS, "heat maps are drawn of")
    values = channels[channel]
    height, width = values.shape
    x0, y0 = (int(word) for word in metadata["crop"].split()[:2])
    counted = channels["samples"].astype(np.float64)
    title = {
        "samples": f"Samples: {_number(counted.mean())} a pixel",
        "half_width": "Half-width",
        "stop_reason": "Stop reason",
    }[channel]
    parts = _axes(height, width, title, max(1, round(_LONG_SIDE / max(height, width))))
    if channel == "stop_reason":
        _draw_reasons(parts, values, x0, y0)
    elif channel == "samples":
        counted[counted == 0] = np.inf  # left out by a mask
        _draw_scale(parts, counted, _Scale("viridis", "samples a pixel", 0.0, (1,), 2), x0, y0)
    else:
        tolerance = float(metadata["tolerance"])
        label = f"half-width at {100 * float(metadata['confidence']):g} %, linear radiance"
        label += f"\n(line: tolerance {tolerance:.3g})" if tolerance > 0 else ""
        how = _Scale("cividis", label, tolerance, (1, 2, 3, 5, 7), 10)
        _draw_scale(parts, values.astype(np.float64), how, x0, y0)
    return Figure(parts[0])
