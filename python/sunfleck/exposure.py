# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""exposure: from radiance to what a picture of 8 bits shows of it, and why one shows nothing."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sunfleck._arguments import number

__all__ = ["auto_exposure", "clipped", "exposure_of", "stops"]

# "auto" brings the radiance that this share of the lit pixels stay below to this value, so that the brightest
# tenth, lamps and glints, may clip.
_SHARE = 0.9
_VALUE = 0.8

_LEAST, _MOST = -100.0, 100.0  # stops: 2^100 is 1.3e30, which single precision holds


def exposure_of(value: Any) -> float | str:
    """A number of stops, or "auto".

    Raises
    ------
    TypeError, ValueError
        Anything else.
    """
    if isinstance(value, str):
        if value == "auto":
            return value
        raise ValueError(f"exposure is {value!r}; give a number of stops, or 'auto'")
    given = number("exposure", value)
    if not _LEAST <= given <= _MOST:
        raise ValueError(f"exposure is {given:g}; give stops from {_LEAST:g} to {_MOST:g}, or 'auto'")
    return given


def auto_exposure(color: NDArray[np.float32]) -> float:
    """Stops that show most of what is lit; 0 of a picture that is black.

    Parameters
    ----------
    color : ndarray of float32, shape (..., 3)
        Linear radiance.
    """
    level = color.astype(np.float64).mean(axis=-1)
    lit = level[np.isfinite(level) & (level > 0)]
    if not lit.size:
        return 0.0
    return float(np.clip(math.log2(_VALUE / np.quantile(lit, _SHARE)), _LEAST, _MOST))


def stops(exposure: float | str, color: NDArray[np.float32]) -> float:
    """The number that an exposure stands for."""
    return auto_exposure(color) if isinstance(exposure, str) else exposure


def clipped(encoded: NDArray[np.uint8], seen: NDArray[np.bool_]) -> bool:
    """Whether an 8-bit picture is white wherever there is anything to see, but for one pixel in 50."""
    white = (encoded == 255).all(axis=-1)[seen]
    return bool(white.size) and float(white.mean()) >= 0.98
