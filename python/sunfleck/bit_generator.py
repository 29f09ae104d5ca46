# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""bit_generator: our generators beneath `numpy.random.Generator`, and NumPy's states in and out."""

from __future__ import annotations

import copy
import ctypes
import operator
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.random._common import interface
from numpy.random.bit_generator import ISeedSequence, ISpawnableSeedSequence
from numpy.typing import NDArray

from sunfleck._arguments import integer, shape_of

if TYPE_CHECKING:
    from sunfleck.rng import Rng, Shape

__all__ = ["BitGenerator"]

INTERFACE: Any = interface
MASK = (1 << 64) - 1
JUMP = 0x9E3779B97F4A7C15  # 2^64 over the golden ratio; not a power of two, by which draws of an LCG share low bits
SHORT = {"minstd", "lcg32", "lcg64", "randu"}  # too short to jump in
PERIODS = {"pcg32": 1 << 64, "splitmix64": 1 << 64, "xorshift64": MASK, "xorshift64-lrl": MASK}
PERIODS |= {"minstd": (1 << 31) - 2, "randu": 1 << 29}
PCG64_MULTIPLIER = 0xDA942042E4DD58B5


class BitGenerator(np.random.BitGenerator):
    """A generator as `numpy.random.Generator` takes it; made by ``Rng.bit_generator``, or by a name.

    Draws through it and through the `Rng` are one sequence, and threads take turns.

    Parameters
    ----------
    rng : Rng or str
        The generator, or the name of a new one.
    seed : None, int, sequence of ints or SeedSequence, optional
        For a new one, as NumPy's bit generators take it: it goes through `numpy.random.SeedSequence`. ``mt19937``,
        ``pcg64dxsm``, ``sfc64`` and ``philox4x64`` are then seeded as NumPy's of the method are, draw for draw;
        others take seed and stream from the first two words of 64 bits of the sequence.

    Attributes
    ----------
    capsule : PyCapsule
        NumPy's ``bitgen_t``. ``next_double`` gives what ``Rng.random()`` gives, and words of 32
        bits are those of ``Rng.bits()`` with two exceptions, as NumPy's distributions need every
        bit random: methods of 31 bits give the top 16 of two draws, and LCGs with a modulus that
        is no power of two their state as a fraction. Words of 64 bits from methods of 31 and 32
        have the first in the high half, as NumPy's MT19937 has.
    ctypes, cffi
        The functions of the capsule for ctypes and cffi, in NumPy's ``interface``: what Numba takes.
        They are good for as long as the bit generator lives, and take no turns.
    lock
        Taken by NumPy around its draws.
    seed_seq : SeedSequence
        What a generator made by name was seeded by. That of an `Rng` is made from its seed and stream,
        to spawn from: the `Rng` itself was not seeded by it.
    state : dict
        As NumPy's generator of the method has it, for ``mt19937``, ``pcg64dxsm``, ``sfc64`` and
        ``philox4x64`` (NumPy's Philox): the two go on alike from one state. For others
        ``{"bit_generator": name, "words": list of ints}``. Setting it takes either form.

    Raises
    ------
    TypeError, ValueError
        A seed that `numpy.random.SeedSequence` refuses, or one beside an `Rng`.

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
    >>> from sunfleck.bit_generator import BitGenerator
    >>> BitGenerator("sfc64", [1, 2, 3]).random_raw() == np.random.SFC64([1, 2, 3]).random_raw()
    True
    """

    def __init__(self, rng: Rng | str, seed: Any = None) -> None:
        if isinstance(rng, str):
            sequence: Any = seed if isinstance(seed, ISeedSequence) else np.random.SeedSequence(seed)
            self._begin(seeded(rng, sequence), sequence, False)
        elif seed is not None:
            raise TypeError(f"seed is {seed!r} beside a generator that has one; give a name and a seed")
        else:
            self._begin(rng, rng._seed_sequence(), True)

    def _begin(self, rng: Rng, sequence: Any, of_rng: bool) -> None:
        super().__init__(0)  # NumPy's own seeding, which nothing reads
        self._rng = rng
        self._core = rng._generator
        self._sequence = sequence
        self._of_rng = of_rng
        self._turn = self._core.turn
        self._capsule = self._core.capsule()
        self._for_ctypes: Any = None
        self._for_cffi: Any = None

    @property
    def capsule(self) -> Any:
        return self._capsule

    @property
    def lock(self) -> Any:  # type: ignore[override]
        return self._turn

    @property
    def seed_seq(self) -> Any:
        return self._sequence

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
        draws = np.empty(shape_of("size", size), np.uint64 if self._core.native_bits == 64 else np.uint32)
        self._core.fill(draws)
        return draws.astype(np.uint64, copy=False) if output else None

    def advance(self, delta: int) -> BitGenerator:
        """Passes over ``delta`` native draws, or back, and drops a waiting half word.

        Parameters
        ----------
        delta : int
            Any, modulo the period, for pcg32, pcg64dxsm, philox4x32, philox4x64, splitmix64, xorshift64 in
            both orders, minstd and randu; in [0, 2^64) for others. NumPy's Philox counts blocks of four here.

        Returns
        -------
        BitGenerator
            This one.

        Raises
        ------
        NotImplementedError
            The method cannot skip (ran1, ran2, sfc64).

        Examples
        --------
        >>> import sunfleck as sf
        >>> generator = sf.Rng("philox4x32", seed=1).bit_generator
        >>> first = generator.random_raw(7)
        >>> bool((generator.advance(-7).random_raw(7) == first).all())
        True
        """
        try:
            count = operator.index(delta)
        except TypeError:
            raise TypeError(f"delta is {delta!r}; give an integer") from None
        name, words = self._core.name, self._core.state()
        if name == "pcg64dxsm":
            self._core.set_state(pcg64dxsm_advanced(words, count))
        elif name.startswith("philox"):
            position = philox_position(words, 64 if name == "philox4x64" else 32) + count
            self._core.set_state(philox_at(words, 64 if name == "philox4x64" else 32, position))
            for _ in range(position % 4):
                self._core.next_raw()
        else:
            self._core.skip(integer("delta", count % PERIODS[name] if name in PERIODS else count))
        return self

    def jumped(self, jumps: int = 1) -> BitGenerator:
        """A copy far ahead, for another thread: by ``jumps`` times 2^64 over the golden ratio draws.

        Parameters
        ----------
        jumps : int
            At least 0. The cost is that of so many ``Rng.skip``.

        Raises
        ------
        NotImplementedError
            The method cannot skip (ran1, ran2, sfc64), or its period is too short for it (minstd, lcg32,
            lcg64, randu): spawn, or take streams.
        """
        count = integer("jumps", jumps)
        name = self._core.name
        if name in SHORT:
            raise NotImplementedError(f"{name} is too short to jump in; take streams, or spawn")
        rng = copy.deepcopy(self._rng)
        for _ in range(max(count, 1)):
            rng.skip(JUMP if count else 0)
        return restored(rng, self._sequence, self._of_rng)

    def spawn(self, n_children: int) -> list[BitGenerator]:
        """As many children: of an `Rng` those that ``Rng.spawn`` makes, else by spawning the seed sequence.

        Raises
        ------
        TypeError
            A seed sequence that cannot spawn.
        """
        if self._of_rng:
            return [child.bit_generator for child in self._rng.spawn(n_children)]
        if not isinstance(self._sequence, ISpawnableSeedSequence):
            raise TypeError("The underlying SeedSequence does not implement spawning.")
        return [BitGenerator(self._core.name, child) for child in self._sequence.spawn(n_children)]

    def __getstate__(self) -> tuple[dict[str, Any], Any]:
        return self.state, self._sequence

    def __setstate__(self, value: Any) -> None:
        state, sequence = value
        self.state = state
        self._sequence = sequence

    def __reduce__(self) -> tuple[Any, ...]:
        return restored, (self._rng, self._sequence, self._of_rng)

    @property
    def ctypes(self) -> Any:
        if self._for_ctypes is None:
            bitgen, state, *functions = self._core.addresses()
            results: tuple[Any, ...] = (ctypes.c_uint64, ctypes.c_uint32, ctypes.c_double)
            made = [ctypes.CFUNCTYPE(r, ctypes.c_void_p)(f) for r, f in zip(results, functions, strict=True)]
            self._for_ctypes = INTERFACE(state, ctypes.c_void_p(state), *made, ctypes.c_void_p(bitgen))
        return self._for_ctypes

    @property
    def cffi(self) -> Any:
        if self._for_cffi is None:
            from cffi import FFI  # optional, as it is for NumPy

            cast = FFI().cast
            bitgen, state, *functions = self._core.addresses()
            results = ("uint64_t", "uint32_t", "double")
            made = [cast(f"{r} (*)(void *)", f) for r, f in zip(results, functions, strict=True)]
            self._for_cffi = INTERFACE(state, cast("void *", state), *made, cast("void *", bitgen))
        return self._for_cffi

    def _benchmark(self, cnt: int, method: str = "uint64") -> None:
        if method not in ("uint64", "double"):
            raise ValueError(f"method is {method!r}; give 'uint64' or 'double'")
        self._core.fill(np.empty(integer("cnt", cnt), np.uint64 if method == "uint64" else np.float64))


def restored(rng: Rng, sequence: Any, of_rng: bool) -> BitGenerator:
    """A bit generator of this Rng, with the sequence that it was seeded by."""
    made = BitGenerator.__new__(BitGenerator)
    made._begin(rng, sequence, of_rng)
    return made


def seeded(name: str, sequence: Any) -> Rng:
    """A generator seeded by a sequence, as NumPy's of the method is where there is one."""
    from sunfleck.rng import Rng

    if name in NAMES:
        rng = Rng(name, seed=1)
        words = rng._generator.state()
        rng._generator.set_state(words_of(name, getattr(np.random, NAMES[name])(sequence).state, words))
        return rng
    first, second = sequence.generate_state(2, np.uint64).tolist()
    return Rng(name, seed=first, stream=second >> 1 | 1)  # a stream above 0, which takes every seed


# ---- positions in a sequence, beyond what a skip counts ----


def pcg64dxsm_advanced(words: list[int], count: int) -> list[int]:
    """x -> a x + c, so often (Brown 1994), modulo 2^128."""
    modulus, a = 1 << 128, PCG64_MULTIPLIER
    power = pow(a, count % modulus, modulus * (a - 1))
    x = words[0] << 64 | words[1]
    x = (power * x + (power - 1) // (a - 1) * (words[2] << 64 | words[3])) % modulus
    return [x >> 64, x & MASK, *words[2:4], 0, *words[-3:]]


def philox_position(words: list[int], bits: int) -> int:
    """Draws so far: the counter is that of the next block of four, of which `used` of the last are gone."""
    counter = sum(word << bits * i for i, word in enumerate(words[:4]))
    return 4 * (counter - 1) + words[10]


def philox_at(words: list[int], bits: int, position: int) -> list[int]:
    """The state before the block that holds a position, nothing of it drawn."""
    block = position // 4 % (1 << 4 * bits)
    counter = [block >> bits * i & ((1 << bits) - 1) for i in range(4)]
    return [*counter, *words[4:10], 4, 0, *words[-3:]]


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


def words_of(name: str, value: Any, now: list[int]) -> list[int]:
    """The words of a state in either form; seed, stream and children stay as they are in NumPy's."""
    if name == "mt19937" and isinstance(value, tuple) and len(value) >= 3:  # as RandomState.get_state gives it
        value = {"bit_generator": value[0], "state": {"key": value[1], "pos": value[2]}}
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
