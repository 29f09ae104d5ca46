# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""tolerance: how far a result may be off, in plain units."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sunfleck._arguments import number

__all__ = ["Tolerance"]


@dataclass(frozen=True)
class Tolerance:
    """How far a result may be off: ``max(absolute, relative * level)``.

    Parameters
    ----------
    absolute : float
        In the result's own unit (of a render, linear radiance), at least 0.
    relative : float
        Of the level: in `render` the mean of (R+G+B)/3 over the frame after ``min_spp`` samples,
        in `integrate` the magnitude of the value; at least 0.

    Raises
    ------
    ValueError, TypeError
        A negative, infinite or NaN value, both 0, or not a number.

    Examples
    --------
    >>> import sunfleck as sf
    >>> sf.Tolerance(absolute=0.002)
    Tolerance(absolute=0.002, relative=0.0)
    """

    absolute: float = 0.0
    relative: float = 0.0

    def __post_init__(self) -> None:
        for name in ("absolute", "relative"):
            value = number(f"{name} tolerance", getattr(self, name))
            if not 0 <= value < math.inf:
                raise ValueError(f"{name} tolerance is {value}; give a finite number, at least 0")
            object.__setattr__(self, name, value)
        if self.absolute == 0 and self.relative == 0:  # C's word for "none asked for"
            raise ValueError("the tolerance is 0, which no number of samples meets; give one above 0")
