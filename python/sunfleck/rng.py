# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""rng: generators of random bits, by name."""

from __future__ import annotations

import os
import time
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import DTypeLike, NDArray

from sunfleck import _core
from sunfleck._arguments import integer, output_array, output_dtype, shape_of, text

if TYPE_CHECKING:
    from sunfleck.bit_generator import BitGenerator

__all__ = ["RNGS", "Rng", "system_bits"]

Shape = int | Sequence[int]

RNGS: dict[str, str] = _core.rngs()
"""The generators: name → one line about it."""


def modulus(m: Any) -> int:
    """A modulus as C takes it, which has 0 for 2^64."""
    number = integer("m", m, bits=65)
    if not 2 <= number <= 1 << 64:
        raise ValueError(f"m is {number}; a modulus is 2 to 2^64")
    return number & ((1 << 64) - 1)


def system_bits() -> int:
    """64 random bits of the system's: what `secrets` draws, whose import takes hashlib and hmac along."""
    return int.from_bytes(os.urandom(8), "little")


class Rng:
    """A generator of random bits.

    Parameters
    ----------
    name : str
        One of `sunfleck.RNGS`.
    seed : int, optional
        In [0, 2^64); with ``stream=0`` the generator is seeded as its reference is, and refuses
        a seed that its method can't take. None: from the clock and the system, kept in ``seed``.
    stream : int
        In [0, 2^64). Distinct streams of one seed are independent sequences.
    a, c, m : int, optional
        For ``lcg32`` and ``lcg64`` alone: x = a x + c mod m, with m up to 2^32 and 2^64. Those not
        given are Knuth's (see ``docs/rng.md``); constants under which the sequence collapses are
        refused.

    Attributes
    ----------
    name, seed, stream
        As given, or as chosen.

    Raises
    ------
    ValueError
        An unknown name, or a seed, stream or constant that the method can't take; what it takes is
        named.

    Notes
    -----
    Streams are frozen: name, seed and stream give the same words in every release and on every
    instruction set. Threads may share a generator, taking turns; a generator for each
    (``spawn``) is faster and repeatable.

    Examples
    --------
    >>> import sunfleck as sf
    >>> rng = sf.Rng("xoshiro256++", seed=1)
    >>> rng.random((2, 3)).shape
    (2, 3)
    >>> sf.Rng("minstd", seed=1).bits(3).tolist()
    [16807, 282475249, 1622650073]
    """

    __slots__ = ("_generator", "_sequence")

    _generator: _core.Rng
    _sequence: Any

    def __init__(
        self,
        name: str,
        seed: int | None = None,
        stream: int = 0,
        *,
        a: int | None = None,
        c: int | None = None,
        m: int | None = None,
    ) -> None:
        text("name", name)
        stream = integer("stream", stream)
        constants = {
            "a": None if a is None else integer("a", a),
            "c": None if c is None else integer("c", c),
            "m": None if m is None else modulus(m),
        }
        if seed is not None:
            self._generator = _core.Rng(name, integer("seed", seed), stream, **constants)
            return
        mixed = system_bits() ^ time.time_ns()
        candidates = [mixed | 1, mixed >> 33 | 1]  # the second for methods of 31 bits
        if m is not None:
            candidates += [(mixed >> k) % m for k in range(32)]
        for number in candidates:
            try:
                self._generator = _core.Rng(name, number, stream, **constants)
                return
            except ValueError:
                pass
        self._generator = _core.Rng(name, 1, stream, **constants)  # reports a bad name, stream or constant

    @property
    def name(self) -> str:
        return self._generator.name

    @property
    def seed(self) -> int:
        return self._generator.seed

    @property
    def stream(self) -> int:
        return self._generator.stream

    @overload
    def random(self, shape: None = None, dtype: DTypeLike | None = None, out: None = None) -> float: ...
    @overload
    def random(
        self, shape: Shape | None = None, dtype: DTypeLike | None = None, out: NDArray[Any] | None = None
    ) -> NDArray[Any]: ...
    def random(
        self, shape: Shape | None = None, dtype: DTypeLike | None = None, out: NDArray[Any] | None = None
    ) -> float | NDArray[Any]:
        """Uniform values in [0, 1), never 1.

        Parameters
        ----------
        shape : int or tuple of ints, optional
            None: one float, or the shape of ``out``.
        dtype : "float64" or "float32", optional
            53 or 24 random bits a value. None: that of ``out``, or float64.
        out : ndarray, optional
            Filled in place: of this shape and dtype, C-contiguous.

        Returns
        -------
        ndarray of the shape and dtype, in [0, 1)

        Raises
        ------
        TypeError, ValueError
            Another dtype, a negative size, or an ``out`` that would need a copy.

        Notes
        -----
        Releases the GIL while it fills. Ctrl-C ends a long fill within 0.2 s: the generator is then as it was,
        and ``out`` is filled in part.
        """
        kind = output_dtype(dtype, out, ("float64", "float32"))
        values = self._filled(shape, kind, out)
        return float(values[()]) if shape is None and out is None else values

    @overload
    def bits(self, shape: None = None, dtype: DTypeLike | None = None, out: None = None) -> int: ...
    @overload
    def bits(
        self, shape: Shape | None = None, dtype: DTypeLike | None = None, out: NDArray[Any] | None = None
    ) -> NDArray[Any]: ...
    def bits(
        self, shape: Shape | None = None, dtype: DTypeLike | None = None, out: NDArray[Any] | None = None
    ) -> int | NDArray[Any]:
        """Raw outputs, in order.

        Parameters
        ----------
        shape : int or tuple of ints, optional
            None: one integer, or the shape of ``out``.
        dtype : "uint32" or "uint64", optional
            As uint32 a 31-bit method gives one word a draw, a 64-bit method its low half first;
            as uint64 methods of 31 and 32 bits give two draws, the first in the low half. None: that of
            ``out``, or uint32.
        out : ndarray, optional
            Filled in place: of this shape and dtype, C-contiguous.

        Returns
        -------
        ndarray of the shape and dtype

        Raises
        ------
        TypeError, ValueError
            Another dtype, a negative size, or an ``out`` that would need a copy.
        """
        kind = output_dtype(dtype, out, ("uint32", "uint64"))
        values = self._filled(shape, kind, out)
        return int(values[()]) if shape is None and out is None else values

    def _filled(self, shape: Shape | None, dtype: np.dtype[Any], out: NDArray[Any] | None) -> NDArray[Any]:
        if shape is None:
            shape = out.shape if isinstance(out, np.ndarray) else ()
        array = output_array(out, shape_of("shape", shape), dtype)
        self._generator.fill(array)
        return array

    def reset(self) -> None:
        """Starts again, as the name, seed and stream first gave it."""
        self._generator.reset()

    def skip(self, count: int) -> None:
        """Passes over ``count`` native draws at once, in O(log count).

        Parameters
        ----------
        count : int
            In [0, 2^64), in draws of the method's own width (31, 32 or 64 bits).

        Raises
        ------
        NotImplementedError
            The method has no such skip (ran1, ran2, sfc64); the generator is as it was.

        Examples
        --------
        >>> import sunfleck as sf
        >>> a, b = sf.Rng("pcg32", seed=1), sf.Rng("pcg32", seed=1)
        >>> _ = a.bits(1000)
        >>> b.skip(1000)
        >>> a.bits() == b.bits()
        True
        """
        self._generator.skip(integer("count", count))

    def spawn(self, count: int) -> list[Rng]:
        """Independent generators of the same kind, for threads or tasks.

        They depend on this generator's seed and stream and on how many it spawned before, not
        on how much it was drawn from.

        Examples
        --------
        >>> import sunfleck as sf
        >>> a, b = sf.Rng("pcg32", seed=1).spawn(2)
        >>> a.bits() == b.bits()
        False
        """
        return [Rng._wrap(core) for core in self._generator.spawn(integer("count", count, bits=31))]

    @property
    def bit_generator(self) -> BitGenerator:
        """This generator, for `numpy.random.Generator` and what takes one.

        Draws through it and through the `Rng` are one sequence.

        Examples
        --------
        >>> import numpy as np
        >>> import sunfleck as sf
        >>> rng = sf.Rng("philox4x32", seed=1)
        >>> int(np.random.Generator(rng.bit_generator).integers(6)) in range(6)
        True
        """
        from sunfleck.bit_generator import BitGenerator  # brings numpy.random, which is not light

        return BitGenerator(self)

    def _seed_sequence(self) -> Any:
        """NumPy's sequence of this seed and stream, the same at each call, so that what it spawns differs."""
        try:
            return self._sequence
        except AttributeError:
            self._sequence = np.random.SeedSequence((self.seed, self.stream))
            return self._sequence

    @property
    def state(self) -> dict[str, Any]:
        """The whole state: ``{"name": str, "words": list of ints}``, for `from_state`."""
        return {"name": self._generator.name, "words": self._generator.state()}

    @classmethod
    def from_state(cls, state: Mapping[str, Any]) -> Rng:
        """A generator that goes on where ``state`` was taken.

        Raises
        ------
        ValueError
            A state that the method can't be in.

        Examples
        --------
        >>> import sunfleck as sf
        >>> rng = sf.Rng("splitmix64", seed=3)
        >>> twin = sf.Rng.from_state(rng.state)
        >>> rng.bits() == twin.bits()
        True
        """
        try:
            name, words = state["name"], state["words"]
        except (TypeError, KeyError):
            raise ValueError(f"state is {state!r}; give what Rng.state returned") from None
        core = _core.rng_from_state(text("state name", name), [integer("state word", word) for word in words])
        return cls._wrap(core)

    @classmethod
    def _wrap(cls, core: _core.Rng) -> Rng:
        rng = cls.__new__(cls)
        rng._generator = core
        return rng

    def __reduce__(self) -> tuple[Any, ...]:
        return Rng.from_state, (self.state,)

    def __repr__(self) -> str:
        return f"Rng({self.name!r}, seed={self.seed}, stream={self.stream})"
