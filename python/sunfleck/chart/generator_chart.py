# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""generator_chart: nanoseconds a number against what quick tests of randomness find.

Seven tests of some 10^5 words; the p-value of a good generator is uniform, below 10^-6 it fails.
They are a sieve for a chart, not a battery: docs/generators.md has dieharder's results.

References
----------
Knuth 1997, "The art of computer programming", volume 2, 3.3.2 (frequency and serial tests).
L'Ecuyer & Simard 2001, "On the performance of birthday spacings tests with certain families of
random number generators": linear generators modulo m fail from some 16 m^(1/3) numbers on.
Massey 1969, "Shift-register synthesis and BCH decoding" (linear complexity).
Rukhin et al. 2010, NIST SP 800-22, 3.10 (its distribution).
"""

from __future__ import annotations

import functools
import math
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sunfleck.chart.cells import Cell, Store, least_time
from sunfleck.plot.figure import Panel, Series
from sunfleck.rng import Rng

__all__ = ["FAILED", "TESTS", "generator_cells", "generator_panels", "linear_complexity"]

FAILED = 1e-6
_LEAST = 1e-16  # what a p-value is drawn as at the least
_FILL = 1 << 18
_COMPLEXITY_BITS = 41_000  # more than twice the 19,937 of the Mersenne Twister

Words = NDArray[np.uint32]


def _normal_p(z: float) -> float:
    """Of both tails."""
    return math.erfc(abs(z) / math.sqrt(2))


def _chi_square(cells: NDArray[Any], count: int) -> float:
    """p of equal shares, too even counting as too uneven; Wilson & Hilferty's normal for chi-square."""
    seen = np.bincount(cells.ravel(), minlength=count)
    expected = cells.size / count
    statistic = float(((seen - expected) ** 2).sum() / expected)
    free = count - 1
    spread = 2 / (9 * free)
    return _normal_p(((statistic / free) ** (1 / 3) - (1 - spread)) / math.sqrt(spread))


def _serial(words: Words, length: int, bits: int) -> float:
    """Tuples of the top bits of successive words."""
    top = (words[: len(words) // length * length] >> np.uint32(32 - bits)).reshape(-1, length).astype(np.int64)
    return _chi_square(top @ (1 << bits * np.arange(length)), 1 << bits * length)


def _birthday_spacings(words: Words) -> float:
    """Four times 2^14 points of a 2^16 x 2^16 grid: how many spacings occur twice.

    Poisson, of 4 n^3 / (4 k) = 1024 in the limit; for these n and k, philox4x32 has 1010.1 +- 2.3
    (the mean over 200 seeds), and variance 1020.
    """
    pairs = (words[: 1 << 17] >> np.uint32(16)).reshape(4, -1, 2).astype(np.int64)
    places = np.sort(pairs[..., 0] << 16 | pairs[..., 1], axis=1)
    spacings = np.sort(np.diff(places, axis=1), axis=1)
    return _normal_p((int((np.diff(spacings, axis=1) == 0).sum()) - 1010) / math.sqrt(1010))


def linear_complexity(bits: Sequence[int]) -> int:
    """The length of the shortest linear feedback shift register that makes these bits (Massey 1969).

    Parameters
    ----------
    bits : sequence of int
        0 or 1.

    Returns
    -------
    int

    Examples
    --------
    >>> from sunfleck.chart.generator_chart import linear_complexity
    >>> linear_complexity([1, 1, 0, 1, 0, 1, 1, 1, 1, 0, 0, 0, 1])  # the example of NIST SP 800-22, 2.10.4
    4
    """
    connection, before, length, since, window = 1, 1, 0, 1, 0
    for n, bit in enumerate(bits):
        window = window << 1 | bit
        if (connection & window).bit_count() & 1 == 0:
            since += 1
            continue
        longer = connection ^ before << since
        if 2 * length <= n:
            length, before, since = n + 1 - length, connection, 0
        connection = longer
        since += 1
    return length


def _complexity(words: Words, bit: int) -> float:
    """Of every second word's bit, which is one half of a 64-bit draw; P(|L - n/2| >= k) = 2^(1 - 2k)."""
    bits = (words[::2] >> np.uint32(bit) & np.uint32(1)).tolist()[:_COMPLEXITY_BITS]
    off = abs(linear_complexity(bits) - len(bits) / 2)
    return float(min(1.0, 2.0 ** max(-1000.0, 1 - 2 * off)))


TESTS: dict[str, Callable[[Words], float]] = {
    "frequency": lambda words: _serial(words, 1, 10),
    "pairs": lambda words: _serial(words, 2, 5),
    "triples": lambda words: _serial(words, 3, 4),
    "lowest bits": lambda words: _chi_square((words >> np.uint32(1) & np.uint32(0xFF)).astype(np.int64), 256),
    "birthday spacings": _birthday_spacings,
    "complexity, top bit": lambda words: _complexity(words, 31),
    "complexity, low bit": lambda words: _complexity(words, 1),
}
"""What is tested: name → p-value of 2^17 words, whose lowest bit is not looked at: some draws have 31."""

_BITS_31 = ("minstd", "randu", "ran1", "ran2")


def _words(name: str, seed: int) -> Words:
    """2^17 words; a draw of 31 bits stands in their upper ones."""
    words: Words = Rng(name, seed=seed).bits(1 << 17, dtype="uint32")
    return words << np.uint32(1) if name in _BITS_31 else words


def _test(name: str, test: str, seed: int) -> dict[str, float]:
    return {"p": TESTS[test](_words(name, 2 * seed + 1))}  # odd: every generator takes it


def _speed(name: str, seed: int) -> dict[str, float]:
    """Nanoseconds of the thread's own time, of the second of two fills."""
    rng, found = Rng(name, seed=2 * seed + 1), {}
    for dtype in ("float64", "uint64", "float32"):
        out = np.empty(_FILL, dtype)
        for _ in range(2):
            start = time.thread_time()
            rng.bits(out=out, dtype=dtype) if dtype == "uint64" else rng.random(out=out, dtype=dtype)
            found[dtype] = 1e9 * (time.thread_time() - start) / _FILL
    return found


def generator_cells(names: Sequence[str]) -> list[Cell]:
    """What a chart of generators measures."""
    cells = [Cell((name, "nanoseconds", _FILL), functools.partial(_speed, name), 1.0) for name in names]
    return cells + [
        Cell((name, test, 1 << 17), functools.partial(_test, name, test), 20.0 if test.startswith("complex") else 1.0)
        for test in TESTS
        for name in names
    ]


def _found(name: str, seeds: int, store: Store) -> tuple[float, float, float, list[str]] | None:
    """ns a float64, ns a uint64, the least p-value (of so many, corrected), and which tests failed."""
    speed = store.get((name, "nanoseconds", _FILL), seeds)
    tests = {test: store.get((name, test, 1 << 17), seeds) for test in TESTS}
    least = {test: min(numbers["p"]) for test, numbers in tests.items() if numbers}
    if not speed or not least:
        return None
    failed = [test for test, p in least.items() if p < FAILED]
    return least_time(speed["float64"]), least_time(speed["uint64"]), min(least.values()), failed


def generator_panels(names: Sequence[str], seeds: int, store: Store) -> tuple[list[Panel], str]:
    """Two panels, and the findings in words."""
    rows = {name: found for name in names if (found := _found(name, seeds, store))}
    if not rows:
        return [Panel("nothing was measured", "", "", x_log=False, y_log=False)], "nothing was measured"
    labels, (wide, whole, least, failed) = list(rows), zip(*rows.values(), strict=True)
    shown = [max(p, _LEAST) for p in least]
    ends = [0.8 * min(wide), 1.25 * max(wide)]
    panels = [
        Panel("the least p-value of seven tests and all seeds", "ns a float64", f"p, at least {_LEAST:.0e}", [
            Series("generators", wide, shown, line=False, labels=labels),
            Series(f"fails below {FAILED:.0e}", ends, [FAILED] * 2, style="guide"),
        ]),
        Panel("tests failed, of seven", "ns a uint64", "failed", [
            Series("generators", whole, [len(f) for f in failed], line=False, labels=labels),
        ], y_log=False),
    ]  # fmt: skip
    text = [
        f"failed: p below {FAILED:.0e} at one of the seeds; ns: medians, one thread",
        f"{'':16} float64  uint64  failed",
    ]
    text += [f"{n:16} {a:7.2f} {b:7.2f}  {len(f)}  {', '.join(f)}" for n, (a, b, _, f) in rows.items()]
    return panels, "\n".join(text)
