# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""exposure: from radiance to what a picture of 8 bits shows of it, and why one shows nothing."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sunfleck._arguments import number

__all__ = ["auto_exposure", "blank", "encode_srgb", "exposure_of", "stops", "why_black"]

# "auto" brings the radiance that this share of the lit pixels stay below to this value, so that the brightest
# tenth, lamps and glints, may clip.
_SHARE = 0.9
_VALUE = 0.8

_WHITE = 0.98  # of the pixels that are lit

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


def encode_srgb(linear: ArrayLike) -> NDArray[np.uint8]:
    """Linear values as 8-bit sRGB (IEC 61966-2-1), clipped to [0, 1], rounded to nearest.

    Parameters
    ----------
    linear : array_like, any shape
        Linear light; 1 is white.

    Returns
    -------
    ndarray of uint8, the same shape

    Examples
    --------
    >>> from sunfleck.exposure import encode_srgb
    >>> encode_srgb([0, 0.2140, 1, 7]).tolist()
    [0, 127, 255, 255]
    """
    x = np.clip(np.asarray(linear, dtype=np.float32), 0, 1)
    encoded = np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.power(x, 1 / 2.4) - 0.055)
    return (255 * encoded + 0.5).astype(np.uint8)


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


def blank(color: NDArray[np.float32], exposure: float) -> str | None:
    """Why a PNG with so many stops is wholly white or black though there is something to see; None where it is not.

    White counts where anything is seen, but for one pixel in 50.
    """
    lit: NDArray[np.bool_] = np.any(color > 0, axis=-1)
    if not lit.any():
        return None  # which `render` has said
    with np.errstate(over="ignore"):
        encoded = encode_srgb(color * np.float32(2.0**exposure))
    white = float((encoded == 255).all(axis=-1)[lit].mean()) >= _WHITE
    if not white and encoded.any():
        return None
    better = auto_exposure(color)
    return (
        f"wholly {'white' if white else 'black'} with an exposure of {exposure:.4g} stops, since most of what is lit "
        f"has a radiance of about {_VALUE * 2.0**-better:.3g}; exposure='auto' would be {better:.4g}"
    )


def why_black(*, any_dropped: bool, any_light: bool, any_surface: bool, max_bounces: int) -> str:
    """Why a render is black: the first reason that there is."""
    if any_dropped:
        return "samples were not finite, and were dropped"
    if not any_light:
        return "nothing in the scene shines: no emission, no suns, no environment, no background"
    if not any_surface:
        return "the camera sees none of the shapes"
    if max_bounces == 0:
        return "max_bounces is 0, and the camera sees no light itself"
    return "the light does not reach what the camera sees: it faces away, or something stands between"
