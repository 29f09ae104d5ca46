# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Tests of a generator's structure that dieharder lacks, and writes their table into docs/generators.md.

They are the ones by which TestU01 and PractRand find linear and short generators, at sizes that take a second each:

linear complexity   of one bit of every draw (Berlekamp 1968, Massey 1969; TestU01's scomp_LinearComp). A sequence of
                    n random bits has complexity n / 2 within a few; a bit that is linear over GF(2) has that of its
                    state's size.
birthday spacings   of points of two draws (Marsaglia 1985; Knuth 3.3.2 J; L'Ecuyer & Simard 2001): equal spacings are
                    Poisson with mean n^3 / (4 k). A lattice has too many from n = 16 times the period's cube root on.
collisions          of whole words of 31 or 32 bits (Knuth 3.3.2 I): a generator that gives each word once a period has
                    none.
"""

from __future__ import annotations

import math

import numpy as np
from measure import ROOT
from scipy.stats import poisson

import sunfleck as sf

PAGE = ROOT / "docs/generators.md"
BITS = 50_000  # beyond twice the 19,937 bits of the Mersenne Twister
BIRTHDAYS, REPEATS = 1 << 20, 16
WORDS = 1 << 22
NARROW = {"minstd": 31, "randu": 31, "ran1": 31, "ran2": 31, "lcg32": 32, "mt19937": 32, "pcg32": 32, "philox4x32": 32}


def raw(rng: sf.Rng, count: int) -> np.ndarray:
    """Native draws, their top bit at bit 63."""
    if rng.name in NARROW:
        return rng.bits(count, "uint32").astype(np.uint64) << np.uint64(64 - NARROW[rng.name])
    return rng.bits(count, "uint64")


def linear_complexity(bits: np.ndarray) -> int:
    """Berlekamp & Massey's algorithm; polynomials and the reversed sequence are integers of as many bits."""
    connection, before, length, since, seen = 1, 1, 0, 1, 0
    for n, bit in enumerate(bits.tolist()):
        seen = seen << 1 | bit  # bit i of `seen` is that of i draws ago
        if (connection & seen).bit_count() & 1:
            was = connection
            connection ^= before << since
            if 2 * length <= n:
                length, before, since = n + 1 - length, was, 0
        since += 1
    return length


def complexity_p(length: int, n: int) -> float:
    """How often random bits are as far from n / 2: both tails fall by 4 a step (Rueppel 1986)."""
    return min(1.0, 2.0 ** (1 - min(1000.0, 2 * abs(length - n / 2))))


def linear_complexities(name: str, seed: int) -> list[tuple[str, float]]:
    """Of the top bit, the middle one and the lowest of a draw."""
    draws = raw(sf.Rng(name, seed=seed), BITS)
    width = NARROW.get(name, 64)
    results = []
    for label, place in (("top", 63), ("middle", 64 - width // 2), ("low", 64 - width)):
        bits = (draws >> np.uint64(place) & np.uint64(1)).astype(np.uint8)
        results.append((f"linear complexity, {label} bit", complexity_p(linear_complexity(bits), BITS)))
    return results


def birthday_spacings(name: str, seed: int) -> tuple[str, float]:
    """Repeats of 2^20 points among 2^58 cells, 29 top bits of each of two draws."""
    rng, equal = sf.Rng(name, seed=seed), 0
    for _ in range(REPEATS):
        halves = (raw(rng, 2 * BIRTHDAYS) >> np.uint64(35)).reshape(-1, 2)
        days = np.sort(halves[:, 0] << np.uint64(29) | halves[:, 1])
        spacings = np.sort(np.diff(days))
        equal += int(np.count_nonzero(spacings[1:] == spacings[:-1]))
    return "birthday spacings", two_sided(equal, REPEATS * BIRTHDAYS**3 / (4 * 2.0**58))


def collisions(name: str, seed: int) -> tuple[str, float]:
    """Among the top 31 or 32 bits of 2^22 draws."""
    width = min(NARROW.get(name, 64), 32)
    words = np.sort(raw(sf.Rng(name, seed=seed), WORDS) >> np.uint64(64 - width))
    equal = int(np.count_nonzero(words[1:] == words[:-1]))
    cells = 2.0**width
    expected = WORDS - cells * -math.expm1(WORDS * math.log1p(-1 / cells))
    return "collisions", two_sided(equal, expected)


def two_sided(count: int, expected: float) -> float:
    return float(min(1.0, 2 * min(poisson.cdf(count, expected), poisson.sf(count - 1, expected))))


def results_of(name: str, seed: int) -> list[tuple[str, float]]:
    return [*linear_complexities(name, seed), birthday_spacings(name, seed), collisions(name, seed)]


def row(name: str, seeds: list[int], failed_below: float) -> str:
    results = [result for seed in seeds for result in results_of(name, seed)]
    failed = [test for test, p in results if p < failed_below]
    return f"| `{name}` | {len(failed)} | {len(results)} | {'; '.join(dict.fromkeys(failed))} |"


def table(seeds: list[int], failed_below: float) -> str:
    head = "| generator | failed | of | which failed |\n|---|---|---|---|\n"
    return head + "\n".join(row(name, seeds, failed_below) for name in sf.RNGS)


def main() -> None:
    begin, end = "<!-- begin: bench/rng_structure.py -->", "<!-- end -->"
    head, rest = PAGE.read_text().split(begin)
    PAGE.write_text(f"{head}{begin}\n{table([12345], 1e-6)}\n\nSeed 12345.\n{end}{rest.split(end, 1)[1]}")


if __name__ == "__main__":
    main()
