# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""bit_generator: our generators beneath `numpy.random.Generator`, and NumPy's states in and out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from sunfleck import _core
from sunfleck._arguments import integer, shape_of

if TYPE_CHECKING:
    from sunfleck.rng import Rng, Shape

__all__ = ["BitGenerator"]

MASK = (1 << 64) - 1


class Turn:
    """The lock of a generator, as NumPy takes it; the thread that has it may take it again."""

    __slots__ = ("_generator",)

    def __init__(self, generator: _core.Rng) -> None:
        self._generator = generator

    def acquire(self) -> bool:
        self._generator.lock()
        return True

    def release(self) -> None:
        self._generator.unlock()

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, *exception: object) -> None:
        self.release()


class BitGenerator(np.random.BitGenerator):
    """A generator as `numpy.random.Generator` takes it; made by ``Rng.bit_generator``.

    Draws through it and through the `Rng` are one sequence, and threads take turns.

    Attributes
    ----------
    capsule : PyCapsule
        NumPy's ``bitgen_t``. ``next_double`` gives what ``Rng.random()`` gives, and words of 32
        bits are those of ``Rng.bits()`` with two exceptions, as NumPy's distributions need every
        bit random: methods of 31 bits give the top 16 of two draws, and LCGs with a modulus that
        is no power of two their state as a fraction. Words of 64 bits from methods of 31 and 32
        have the first in the high half, as NumPy's MT19937 has.
    lock
        Taken by NumPy around its draws.
    state : dict
        As NumPy's generator of the method has it, for ``mt19937``, ``pcg64dxsm``, ``sfc64`` and
        ``philox4x64`` (NumPy's Philox): the two go on alike from one state. For others
        ``{"bit_generator": name, "words": list of ints}``. Setting it takes either form.

    Examples
    --------
    >>> import numpy as np
    >>> import sunfleck as sf
    >>> generator = np.random.Generator(sf.Rng("xoshiro256++", seed=1).bit_generator)
    >>> generator.normal(size=3).shape
    (3,)
    >>> ours, theirs = sf.Rng("sfc64", seed=1), np.random.SFC64(7)
    >>> ours.bit_generator.state = theirs.state
    >>> ours.random() == np.random.Generator(theirs).random()
    True
    """

    def __init__(self, rng: Rng) -> None:
        super().__init__(0)  # NumPy's own seeding, which nothing reads
        self._rng = rng
        self._core = rng._generator
        self._turn = Turn(self._core)
        self._capsule = self._core.capsule()

    @property
    def capsule(self) -> Any:
        return self._capsule

    @property
    def lock(self) -> Any:  # type: ignore[override]
        return self._turn

    @property
    def state(self) -> dict[str, Any]:
        words = self._core.state()
        if self._core.name not in TO_NUMPY:
            return {"bit_generator": self._core.name, "words": words}
        return TO_NUMPY[self._core.name](words)

    @state.setter
    def state(self, value: Mapping[str, Any]) -> None:
        self._core.set_state(words_of(self._core.name, value, self._core.state()))

    def random_raw(self, size: Shape | None = None, output: bool = True) -> Any:  # type: ignore[override]
        """Native draws: an int, or an array of uint64 of shape ``size``; NumPy's method."""
        if size is None:
            draw = self._core.next_raw()
            return draw if output else None
        shape = shape_of("size", size)
        draws = np.array([self._core.next_raw() for _ in range(int(np.prod(shape)))], dtype=np.uint64)
        return draws.reshape(shape) if output else None

    def spawn(self, n_children: int) -> list[BitGenerator]:
        """Those of the generator's children, as ``Rng.spawn`` makes them."""
        return [child.bit_generator for child in self._rng.spawn(n_children)]

    def __reduce__(self) -> tuple[Any, ...]:
        return BitGenerator, (self._rng,)

    @property
    def ctypes(self) -> NoReturn:
        raise NotImplementedError("there is no ctypes interface; use the capsule")

    @property
    def cffi(self) -> NoReturn:
        raise NotImplementedError("there is no cffi interface; use the capsule")

    @property
    def seed_seq(self) -> NoReturn:
        raise NotImplementedError("there is no seed sequence; use the seed and stream of the Rng")

    def _benchmark(self, cnt: int, method: str = "uint64") -> NoReturn:
        raise NotImplementedError("bench/generators.py measures rates")


# The last four words of a state are the waiting half of a draw (2^32 + half, or 0), seed, stream, and the number of
# children (sf_rng_get_state).


def waiting(words: list[int]) -> dict[str, int]:
    return {"has_uint32": words[-4] >> 32, "uinteger": words[-4] & 0xFFFFFFFF}


def array(words: list[int], dtype: str = "uint64") -> NDArray[Any]:
    return np.array(words, dtype=dtype)


def mt19937_to_numpy(words: list[int]) -> dict[str, Any]:
    return {"bit_generator": "MT19937", "state": {"key": array(words[:624], "uint32"), "pos": words[624]}}


def pcg64dxsm_to_numpy(words: list[int]) -> dict[str, Any]:
    state = {"state": words[0] << 64 | words[1], "inc": words[2] << 64 | words[3]}
    return {"bit_generator": "PCG64DXSM", "state": state, **waiting(words)}


def sfc64_to_numpy(words: list[int]) -> dict[str, Any]:
    return {"bit_generator": "SFC64", "state": {"state": array(words[:4])}, **waiting(words)}


def number(words: list[int]) -> int:
    return sum(word << 64 * i for i, word in enumerate(words))


def split(value: int) -> list[int]:
    return [value >> 64 * i & MASK for i in range(4)]


def philox_to_numpy(words: list[int]) -> dict[str, Any]:
    # NumPy's counter is the one of the block in its buffer, ours of the block after.
    counter = split(number(words[:4]) - 1)
    state = {"counter": array(counter), "key": array(words[4:6])}
    buffer = {"buffer": array(words[6:10]), "buffer_pos": words[10]}
    return {"bit_generator": "Philox", "state": state, **buffer, **waiting(words)}


TO_NUMPY = {
    "mt19937": mt19937_to_numpy,
    "pcg64dxsm": pcg64dxsm_to_numpy,
    "sfc64": sfc64_to_numpy,
    "philox4x64": philox_to_numpy,
}
NAMES = {"mt19937": "MT19937", "pcg64dxsm": "PCG64DXSM", "sfc64": "SFC64", "philox4x64": "Philox"}


def method_words(name: str, value: Mapping[str, Any]) -> list[int]:
    """The method's own words of a state as NumPy has it."""
    state = value["state"]
    if name == "mt19937":
        return [*map(int, state["key"]), int(state["pos"])]
    if name == "pcg64dxsm":
        return [part for key in ("state", "inc") for part in (state[key] >> 64, state[key] & MASK)]
    if name == "sfc64":
        return list(map(int, state["state"]))
    counter = split(number(list(map(int, state["counter"]))) + 1)
    return [*counter, *map(int, state["key"]), *map(int, value["buffer"]), int(value["buffer_pos"])]


def words_of(name: str, value: Mapping[str, Any], now: list[int]) -> list[int]:
    """The words of a state in either form; seed, stream and children stay as they are in NumPy's."""
    given = value["bit_generator"] if isinstance(value, Mapping) and "bit_generator" in value else None
    if given not in (name, NAMES.get(name, name)):
        raise ValueError(f"state is one of {given!r}; give one of {name!r} or of NumPy's {NAMES.get(name, 'nothing')}")
    try:
        if "words" in value:
            return [integer("state word", word) for word in value["words"]]
        half = value.get("has_uint32", 0) and 1 << 32 | int(value["uinteger"])
        return [integer("state word", word) for word in (*method_words(name, value), half, *now[-3:])]
    except (KeyError, TypeError):
        raise ValueError(f"state is {value!r}; give what .state returned") from None
