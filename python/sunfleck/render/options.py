# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""options: the names that a render's options may have, and what a caller gave as the numbers that C takes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sunfleck import _core
from sunfleck._arguments import array_of, integer, number, text
from sunfleck.tolerance import Tolerance

__all__ = [
    "AOVS",
    "PIXEL_FILTERS",
    "RENDER_PATTERNS",
    "STOP_REASONS",
    "above_zero",
    "aovs_of",
    "count",
    "crop_of",
    "mask_of",
    "tolerance_of",
]

STOP_REASONS: tuple[str, ...] = tuple(_core.stop_reasons())
"""The names of the numbers in `Image.stop_reason`."""

AOVS: tuple[str, ...] = tuple(_core.aov_names())
"""What an image can hold beside the colours; see `render`."""

RENDER_PATTERNS: tuple[str, ...] = tuple(_core.render_patterns())
"""The patterns that a picture can be rendered with."""

PIXEL_FILTERS: tuple[str, ...] = tuple(_core.pixel_filters())
"""What a pixel can average over: the mappings pixel_NAME; see `render`."""


def tolerance_of(value: float | Tolerance | None) -> tuple[float, float]:
    """Relative and absolute; both 0 where none is asked for."""
    if value is None:
        return 0.0, 0.0
    if not isinstance(value, Tolerance):
        value = Tolerance(relative=number("tolerance", value))
    return value.relative, value.absolute


def count(name: str, value: int | None, bits: int = 32) -> int:
    """A count that may be None, which is C's 0; so that 0 itself must be refused here."""
    if value is None:
        return 0
    given = integer(name, value, bits=bits)
    if given == 0:
        raise ValueError(f"{name} is 0; give at least 1, or None")
    return given


def above_zero(name: str, value: float | None, refusal: str) -> float:
    """A number that may be None, which is C's 0; so that 0 itself must be refused here, in these words."""
    if value is None:
        return 0.0
    given = number(name, value)
    if given == 0:
        raise ValueError(f"{name} is 0{refusal}")
    return given


def crop_of(value: Sequence[int] | None) -> tuple[int, int, int, int]:
    if value is None:
        return 0, 0, 0, 0
    try:
        x0, y0, x1, y1 = value
    except (TypeError, ValueError):
        raise ValueError(f"crop is {value!r}; give (x0, y0, x1, y1), half open, in pixels of the full frame") from None
    names = ("x0", "y0", "x1", "y1")
    crop = [integer(f"crop {name}", v, bits=32) for name, v in zip(names, (x0, y0, x1, y1), strict=True)]
    if not any(crop):
        raise ValueError("crop is (0, 0, 0, 0), which is empty; give x0 < x1 and y0 < y1")
    return crop[0], crop[1], crop[2], crop[3]


def aovs_of(value: Sequence[str]) -> list[str]:
    if isinstance(value, str):
        value = [name.strip() for name in value.split(",") if name.strip()]
    try:
        names = list(value)
    except TypeError:
        raise TypeError(f"aovs is {value!r}; give names of {', '.join(AOVS)}") from None
    return [text("aovs", name) for name in names]


def mask_of(value: ArrayLike | None) -> NDArray[np.uint8] | None:
    """As bytes, without a copy where it can be."""
    if value is None:
        return None
    mask = array_of("mask", value)
    if mask.dtype not in (np.bool_, np.uint8):
        raise TypeError(f"mask has dtype {mask.dtype}; give bool or uint8")
    if mask.ndim != 2:
        raise ValueError(f"mask has shape {mask.shape}; give (height, width)")
    return np.ascontiguousarray(mask).view(np.uint8)
