# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""accumulator: what everything that takes samples one after the other shares."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sunfleck._arguments import array_of, number

__all__ = ["Accumulator", "confidence_of", "float64_of", "samples_of"]


def samples_of(x: ArrayLike) -> NDArray[Any]:
    """float32 as it is, other real numbers as float64."""
    array = array_of("x", x)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"the samples have dtype {array.dtype}; give real numbers")
    return np.require(array, np.float32 if array.dtype == np.float32 else np.float64, ["C", "A"])


def float64_of(x: ArrayLike) -> NDArray[np.float64]:
    """Real numbers as float64."""
    return np.require(samples_of(x), np.float64, ["C", "A"])


def confidence_of(value: float) -> float:
    confidence = number("confidence", value)
    if not 0 < confidence < 1:
        raise ValueError(f"confidence is {confidence}; give one above 0 and below 1")
    return confidence


class Accumulator:
    """What the further kinds have in common: a state of bytes, for copies and pickles."""

    __slots__ = ("_core",)

    _core: Any

    def __getstate__(self) -> bytes:
        state: bytes = self._core.state()
        return state
