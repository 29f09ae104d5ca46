# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""_seed: 64 bits from whatever a caller gives as a source of randomness."""

from __future__ import annotations

import enum
import operator
from typing import Any, Final

import numpy as np

from sunfleck._arguments import integer
from sunfleck.rng import Rng, system_bits

__all__ = ["UNSET", "Unset", "seed_from", "seed_of"]


class Unset(enum.Enum):
    """The type of `UNSET`, for an argument that was not given where None says something."""

    UNSET = "not given"

    def __repr__(self) -> str:
        return "<not given>"


UNSET: Final = Unset.UNSET


def seed_of(name: str, source: Any) -> int:
    """64 bits from a source of randomness.

    None: from the system. A whole number below 2^64 is the seed itself, a larger one is hashed. A
    `sunfleck.Rng` or a NumPy generator draws them, a seed sequence spawns a child that gives them:
    the next call with the same object gets others. All else is what `numpy.random.default_rng` takes.
    """
    if source is None:
        return system_bits()
    if isinstance(source, Rng):
        return int(source.bits(1, dtype="uint64")[0])
    if isinstance(source, np.random.SeedSequence):
        return int(source.spawn(1)[0].generate_state(1, np.uint64)[0])
    if not isinstance(source, (np.random.Generator, np.random.RandomState)):
        try:
            number = operator.index(source)
        except TypeError:
            source = _generator(name, source)
        else:
            if number < 0:
                raise ValueError(f"{name} is {number}; give 0 or more")
            return number if number < 1 << 64 else seed_of(name, np.random.SeedSequence(number))
    return int.from_bytes(source.bytes(8), "little")


def _generator(name: str, source: Any) -> np.random.Generator:
    try:
        return np.random.default_rng(source)
    except (TypeError, ValueError) as error:
        raise type(error)(
            f"{name} is {source!r}; give None, an integer, a generator or a seed sequence of NumPy's, or a sunfleck.Rng"
        ) from None


def seed_from(seed: Any, rng: Any) -> int:
    """The seed of a pattern from the two names that a caller may give it under.

    A seed that is an integer is in [0, 2^64); all other sources are `seed_of`'s, under either name.
    """
    if rng is not UNSET:
        if not (isinstance(seed, int) and seed == 0):
            raise TypeError("rng and seed are both given; they are two names of one argument")
        return seed_of("rng", rng)
    return integer("seed", seed) if hasattr(seed, "__index__") else seed_of("seed", seed)
