# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""qmc: the patterns as engines for SciPy.

Needs SciPy, which nothing else here does; ``sunfleck.qmc`` is imported when it is first used.
"""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sunfleck import _core
from sunfleck._arguments import integer, text
from sunfleck._seed import seed_of
from sunfleck.points import points

try:
    from scipy.stats import qmc as _qmc
except ImportError as error:
    raise ImportError(f"sunfleck.qmc needs SciPy 1.10 or later ({error}); pip install 'scipy>=1.10'") from error

__all__ = ["Engine"]

# SciPy 1.15 renamed the argument; the old name still works, and is to warn one day.
_RNG = "rng" if "rng" in inspect.signature(_qmc.QMCEngine.__init__).parameters else "seed"


def _aligned_blocks(start: int, n: int) -> list[tuple[int, int]]:
    """start .. start + n - 1 as the fewest blocks of 2^k indices from a multiple of 2^k on."""
    blocks = []
    while n:
        size = 1 << (n.bit_length() - 1)
        if start:
            size = min(size, start & -start)
        blocks.append((start, size))
        start, n = start + size, n - size
    return blocks


class Engine(_qmc.QMCEngine):  # type: ignore[misc]
    """A pattern as a `scipy.stats.qmc.QMCEngine`.

    Parameters
    ----------
    pattern : str
        One of `sunfleck.PATTERNS`.
    d : int
        Dimensions of a point; 0 is allowed, as SciPy has it.
    scramble : str, bool or None
        As `sunfleck.points` takes it; False is None. True randomizes whatever the pattern: the default
        scramble, "shift" for lattice and r2, "permuted" for hammersley, which have none by default;
        uniform, which can't be, is refused.
    pad : int
        As `sunfleck.points` takes it.
    total : int, optional
        For the patterns that need their total ahead (uniform, jittered, latin, …): how many points
        there will be, drawn in any number of calls. None: each call of `random` draws a set of its
        own, complete, and independent of the one before, as `scipy.stats.qmc.LatinHypercube` does.
        Sequences need none and are not limited by it.
    optimization : {None, "random-cd", "lloyd"}
        As `scipy.stats.qmc.QMCEngine` has it. Both move points, and break nets and strata.
    rng, seed : optional
        The source of randomness, under either name: an int is the pattern's seed itself below 2^64
        and is hashed above; a `sunfleck.Rng` or NumPy generator gives 64 bits and is advanced by
        them, a seed sequence spawns a child that does; None takes them from the system.

    Attributes
    ----------
    d : int
    seed : int
        The pattern's: ``Engine(p, d, seed=s).random(n)`` is ``points(p, n, d, seed=s,
        dtype="float64")``, bit for bit.
    num_generated : int
        Points drawn or skipped so far.

    Raises
    ------
    ValueError
        An unknown name, dimensions or a total that the pattern can't have, more points than
        ``total``.
    TypeError
        A value of the wrong kind; both ``rng`` and ``seed``.

    Warns
    -----
    UserWarning
        sobol and the like where the first draw is not a power of two, once, as
        `scipy.stats.qmc.Sobol` does.

    Notes
    -----
    `random`, `integers`, `reset` and `fast_forward` are SciPy's; ``workers`` is the number of
    threads (-1: one for each processor) and changes no bit. Skipping a sequence costs nothing.
    With ``total`` the set is made at once and kept: total · d · 8 bytes. `qmc_quad` randomizes the
    further engines that it makes of a plain one; but uniform repeats itself in every set, so that an
    error estimated from such sets is 0. Not safe to share between threads, as SciPy's.

    Examples
    --------
    >>> import sunfleck as sf
    >>> engine = sf.qmc.Engine("sobol", 2, seed=7)
    >>> engine.random(4).shape
    (4, 2)
    >>> engine.fast_forward(4).random(8).tolist() == sf.points(
    ...     "sobol", 8, 2, seed=7, start=8, dtype="float64"
    ... ).tolist()
    True
    >>> from scipy.stats.qmc import MultivariateNormalQMC
    >>> MultivariateNormalQMC([0.0, 1.0], engine=engine.reset()).random(256).shape
    (256, 2)
    """

    def __init__(
        self,
        pattern: str,
        d: int,
        *,
        scramble: str | bool | None = "default",
        pad: int = 0,
        total: int | None = None,
        optimization: str | None = None,
        rng: Any = None,
        seed: Any = None,
    ) -> None:
        if rng is not None and seed is not None:
            raise TypeError("rng and seed are both given; they are two names of one argument")
        self.pattern = text("pattern", pattern)
        self.scramble = self._scramble_of(scramble)
        self.pad = integer("pad", pad, bits=32)
        self.total = None if total is None else integer("total", total)
        self.seed = seed_of("the seed", seed if rng is None else rng)
        self.optimization = optimization
        self._begin(d)
        # What scipy.integrate.qmc_quad makes its further, independent engines with.
        fresh = self.scramble
        if fresh is None or fresh.lower() in ("none", "default"):
            fresh = _core.pattern_random_scramble(pattern)
        self._init_quad: dict[str, Any] = {
            "pattern": pattern,
            "d": d,
            "scramble": fresh,
            "pad": pad,
            "total": total,
            "optimization": optimization,
        }
        self._needs_total = _core.pattern_needs_total(pattern)
        self._whole = self._make_whole()

    def _scramble_of(self, scramble: str | bool | None) -> str | None:
        """As `sunfleck.points` takes it."""
        if scramble is None or scramble is False:
            return None
        if scramble is not True:
            return text("scramble", scramble)
        random = _core.pattern_random_scramble(self.pattern)
        if random == "none" and not _core.pattern_is_random(self.pattern):
            raise ValueError(f"scramble is True, but nothing randomizes {self.pattern}; give False or another pattern")
        return random

    def _begin(self, d: int) -> None:
        """SciPy's part of the state, as new: its own generator is for `optimization`."""
        super().__init__(d=d, optimization=self.optimization, **{_RNG: self.seed})
        self._sets = 0  # drawn so far, where each call draws one

    def _make_whole(self) -> NDArray[Any] | None:
        """The set of `total` points where it is needed; what the pattern can't have is refused."""
        if self._needs_total and self.total is not None and self.d > 0:
            return self._points(0, self.total, self.seed, 1)
        if self.d > 0:
            points(self.pattern, 0, self.d, scramble=self.scramble, **self._options())
        return None

    def _options(self) -> dict[str, Any]:
        return {"pad": self.pad} if self.pad else {}

    def _points(self, start: int, n: int, seed: int, workers: int) -> NDArray[Any]:
        """Without the warning of a block that is not aligned, unless it is the first."""
        out = np.empty((n, self.d))
        blocks = [(start, n)] if start == 0 or self._needs_total else _aligned_blocks(start, n)
        for first, count in blocks:
            points(
                self.pattern,
                count,
                self.d,
                seed=seed,
                scramble=self.scramble,
                start=first,
                dtype="float64",
                threads=None if workers == -1 else workers,
                out=out[first - start : first - start + count],
                **self._options(),
            )
        return out

    def _left(self, n: int) -> None:
        if self.total is not None and self._needs_total and self.num_generated + n > self.total:
            raise ValueError(
                f"{n} points after {self.num_generated} are more than the total of {self.total}; "
                "reset the engine, or give a larger total"
            )

    def random(self, n: int = 1, *, workers: int = 1) -> NDArray[Any]:
        """The next n points.

        Parameters
        ----------
        n : int
            How many.
        workers : int
            Threads, at least 1; -1: one for each processor. Changes no bit.

        Returns
        -------
        ndarray of float64, shape (n, d), in [0, 1)

        Raises
        ------
        ValueError
            More than are left of ``total``, or a count that the pattern can't have.
        TypeError
            n is no integer; NumPy's are.
        """
        # SciPy counts with what it is given, and a NumPy integer would stay one from then on.
        sample: NDArray[Any] = super().random(integer("n", n), workers=workers)
        return sample

    def random_base2(self, m: int) -> NDArray[Any]:
        """The next 2^m points, as `scipy.stats.qmc.Sobol` has it.

        Parameters
        ----------
        m : int
            Logarithm of the number of points to base 2.

        Returns
        -------
        ndarray of float64, shape (2**m, d), in [0, 1)

        Raises
        ------
        ValueError
            sobol, sz and lattice, where the points drawn so far and these are not a power of two
            together: they would lose their balance.
        """
        n = 1 << integer("m", m, bits=6)
        total = self.num_generated + n
        if self.pattern.lower() in ("sobol", "sz", "lattice") and total & (total - 1):
            raise ValueError(
                f"{n} points after {self.num_generated} are {total}, no power of two: {self.pattern} would lose its "
                "balance; reset the engine, or draw with random(n)"
            )
        return self.random(n)

    def _random(self, n: int = 1, *, workers: int = 1) -> NDArray[Any]:
        n = integer("n", n)
        if workers != -1 and integer("workers", workers, bits=32) == 0:
            raise ValueError("workers is 0; give at least 1, or -1 for one for each processor")
        self._left(n)
        if self.d == 0 or n == 0:
            return np.empty((n, self.d))
        begin: int = self.num_generated
        if self._whole is not None:
            part: NDArray[Any] = self._whole[begin : begin + n].copy()
            return part
        if not self._needs_total:
            return self._points(begin, n, self.seed, workers)
        drawn = self._points(0, n, self._seed_of_set(), workers)
        self._sets += 1
        return drawn

    def _seed_of_set(self) -> int:
        """The engine's own for the first set."""
        if self._sets == 0:
            return self.seed
        return int(np.random.SeedSequence([self.seed, self._sets]).generate_state(1, np.uint64)[0])

    def reset(self) -> Engine:
        """Back to the first point.

        Returns
        -------
        Engine
            Itself.
        """
        self._begin(self.d)
        return self

    def fast_forward(self, n: int) -> Engine:
        """Skips n points, at no cost; or one set of n, where each call draws a set of its own.

        Parameters
        ----------
        n : int
            How many.

        Returns
        -------
        Engine
            Itself.

        Raises
        ------
        ValueError
            More than are left of ``total``.
        """
        skipped = integer("n", n)
        self._left(skipped)
        self.num_generated += skipped
        self._sets += 1
        return self
