# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""generators: streams of random bits that fail."""

from __future__ import annotations

import numpy as np

import sunfleck as sf
from sunfleck.lab.experiment import Array, Experiment, Measured, image, lines, scatter
from sunfleck.plot.figure import Panel

__all__ = ["EXPERIMENTS"]

M31 = 2**31 - 1


def _bits(name: str, seed: int, n: int) -> Array:
    return np.asarray(sf.Rng(name, seed=seed).bits(n, dtype="uint32")).astype(np.int64)


def _planes(seed: int) -> Measured:
    def planes(u: Array) -> tuple[float, Panel]:
        x, y, z = u.reshape(-1, 3).T
        k = 9 * x - 6 * y + z
        return float(len(np.unique(np.round(k, 6)))), scatter(np.stack([9 * x - 6 * y, z], 1), "9x - 6y", "z")

    n = 9000
    before, failing = planes(_bits("randu", 2 * seed + 1, n) / 2.0**31)
    after, remedied = planes(_bits("pcg32", seed, n) / 2.0**32)
    return Measured(before, after, failing, remedied)


def _low_bits(seed: int) -> Measured:
    words = _bits("lcg32", seed, 1 << 16)

    def repeats(bit: int) -> tuple[float, Panel]:
        b = (words >> bit) & 1
        return float(np.mean(b[2:] == b[:-2])), image(b[:4096].reshape(64, 64), "draw", "draw / 64")

    before, failing = repeats(0)
    after, remedied = repeats(31)
    return Measured(before, after, failing, remedied)


def _period(seed: int) -> Measured:
    def returns(name: str) -> tuple[float, Panel]:
        rng = sf.Rng(name, seed=seed)
        first = np.asarray(rng.bits(64))
        rng.reset()
        rng.skip(M31 - 1)
        later = np.asarray(rng.bits(64))
        return float(np.mean(first == later)), scatter(np.stack([first, later], 1), "draw i", "draw i + 2^31 - 2")

    before, failing = returns("minstd")
    after, remedied = returns("pcg64dxsm")
    return Measured(before, after, failing, remedied)


def _xorshift(state: int, n: int) -> Array:
    out = np.zeros(n, dtype=np.uint64)
    for i in range(n):
        state ^= state >> 21
        state ^= (state << 35) & (2**64 - 1)
        state ^= state >> 4
        out[i] = state
    return out


def _ones(words: Array) -> Array:
    """Share of one bits of each word."""
    octets = np.ascontiguousarray(words).view(np.uint8).reshape(len(words), -1)
    return np.asarray(np.unpackbits(octets, axis=1).mean(axis=1))


def _zero_state(seed: int) -> Measured:
    n = 1024
    index = np.arange(n)
    dead = _ones(_xorshift(0, n))
    alive = _ones(_xorshift(int(sf.Rng("splitmix64", seed=seed).bits(dtype="uint64")), n))
    show = [lines({"ones": (index, share)}, "draw", "share of one bits") for share in (dead, alive)]
    return Measured(float(dead.mean()), float(alive.mean()), show[0], show[1])


def _rank(matrix: Array) -> int:
    """Over GF(2), of rows given as Python integers."""
    rows, rank = [int("".join(map(str, row)), 2) for row in matrix.tolist()], 0
    while rows:
        pivot = rows.pop()
        if pivot:
            rank += 1
            low = pivot & -pivot
            rows = [row ^ pivot if row & low else row for row in rows]
    return rank


def _linear(seed: int) -> Measured:
    side = 128

    def rank(name: str) -> tuple[float, Panel]:
        words = np.asarray(sf.Rng(name, seed=seed).bits(side * side, dtype="uint64"))
        matrix = (words & np.uint64(1)).astype(np.int64).reshape(side, side)
        return float(_rank(matrix)), image(matrix, "column", "row")

    before, failing = rank("xorshift64")
    after, remedied = rank("pcg64dxsm")
    return Measured(before, after, failing, remedied)


def _twister(seed: int) -> Measured:
    n, window = 1 << 20, 624

    def recovery(key: Array) -> tuple[float, Panel]:
        state = np.random.MT19937()
        state.state = {"bit_generator": "MT19937", "state": {"key": key, "pos": 624}}
        words = state.random_raw(n - n % window).astype(np.uint32)
        share = _ones(words).reshape(-1, window).mean(axis=1)
        # A window of 624 words has 19,968 bits: sigma 0.0035, so 0.02 is 5.6 of them.
        off = np.nonzero(np.abs(share - 0.5) > 0.02)[0]
        draws = float((off[-1] + 1) * window) if len(off) else 0.0
        at = np.arange(len(share)) * window
        return draws, lines({"ones": (at, share)}, "draw", "share of one bits")

    one = np.zeros(624, dtype=np.uint32)
    one[1 + seed % 600] = 1
    before, failing = recovery(one)
    after, remedied = recovery(np.asarray(sf.Rng("splitmix64", seed=seed).bits(624, dtype="uint32")))
    return Measured(before, after, failing, remedied)


def _glibc_rand(seed: int, n: int) -> Array:
    """rand() of the GNU C library: an additive feedback generator, its lowest bit dropped."""
    r = [seed]
    for _ in range(30):
        r.append(16807 * r[-1] % M31)
    r += r[:3]
    for i in range(34, n + 344):
        r.append((r[i - 3] + r[i - 31]) & 0xFFFFFFFF)
    return np.array(r[344:], dtype=np.int64) >> 1


def _rand_sum(seed: int) -> Measured:
    n = 4096

    def told(words: Array) -> tuple[float, Panel]:
        guess = (words[28:-3] + words[:-31]) % 2**31
        rest = (words[31:] - guess) % 2**31
        return float(np.mean(rest <= 1)), scatter(np.stack([guess, words[31:]], 1), "o(i-3) + o(i-31)", "o(i)")

    before, failing = told(_glibc_rand(seed, n))
    after, remedied = told(_bits("pcg32", seed, n) >> 1)
    return Measured(before, after, failing, remedied)


def _rand_coarse(seed: int) -> Measured:
    n = 1 << 17
    words, x = np.empty(n, dtype=np.int64), seed
    for i in range(n):
        x = (1103515245 * x + 12345) & 0xFFFFFFFF
        words[i] = x // 65536 % 32768
    fine = _bits("pcg32", seed, n)
    unit = [words / 2.0**15, fine / 2.0**32]
    low = [np.nonzero(u < 2.0**-10)[0] for u in unit]  # 32 values of the coarse one
    show = [scatter(np.stack([at, u[at]], 1), "draw", "those below 1/1024") for at, u in zip(low, unit, strict=True)]
    return Measured(float(len(np.unique(words))), float(len(np.unique(fine))), show[0], show[1])


def _overflow(seed: int) -> Measured:
    n = 4096
    wrapped = np.empty(n, dtype=np.int64)
    x = seed
    for i in range(n):
        x = (16807 * x + 2**31) % 2**32 - 2**31  # what a 32-bit product leaves
        x = int(np.fmod(x, M31))  # C's %, which keeps the sign
        wrapped[i] = x
    right = _bits("minstd", seed, n)

    def outside(words: Array) -> float:
        return float(np.mean((words < 1) | (words >= M31)))

    show = [scatter((w / M31).reshape(-1, 2)) for w in (wrapped, right)]
    return Measured(outside(wrapped), outside(right), show[0], show[1])


EXPERIMENTS = (
    Experiment(
        "randu-planes",
        "RANDU puts all triples on 15 planes",
        "Three successive draws are a point in the unit cube.",
        "x(k+2) = 6 x(k+1) - 9 x(k) modulo 2^31: 9x - 6y + z is an integer.",
        "distinct values of 9x - 6y + z over 3000 triples",
        "Another generator: pcg32.",
        (1, 15),  # integers in (-6, 10)
        (2900, 3000),  # of 15 million values a rounding keeps, 3000 draws meet 0.3 times
        _planes,
    ),
    Experiment(
        "lcg-low-bits",
        "bit j of an LCG modulo 2^k has period 2^(j+1)",
        "Each bit of a draw is random.",
        "The lowest bit alternates.",
        "share of draws whose bit is that of two draws before",
        "The high bits only.",
        (1, 1),
        (0.48, 0.52),  # 65,534 comparisons: sigma 0.002, ten of them
        _low_bits,
    ),
    Experiment(
        "minstd-period",
        "minstd repeats after 2^31 - 2 draws, seconds of rendering",
        "A stream does not repeat within a picture.",
        "After 2^31 - 2 draws the same numbers come again.",
        "share of 64 draws that equal those 2^31 - 2 later",
        "A state of 64 bits or more: pcg64dxsm.",
        (1, 1),
        (0, 0.02),  # a single equal word has probability 64 / 2^32
        _period,
    ),
    Experiment(
        "xorshift-zero",
        "shift-XOR with state zero stays at zero",
        "Any seed will do.",
        "0 is a fixed point of every shift and XOR.",
        "share of one bits in 1024 draws",
        "Seed through SplitMix64.",
        (0, 0),
        (0.48, 0.52),  # 65,536 bits: sigma 0.002
        _zero_state,
    ),
    Experiment(
        "xorshift-rank",
        "the bits of shift-XOR are linear in its 64-bit state",
        "A 128 x 128 matrix of lowest bits is as good as random.",
        "Each bit is a linear form of 64 bits: the rank cannot exceed 64.",
        "rank over GF(2)",
        "A generator with a multiplication: pcg64dxsm.",
        (1, 64),
        (120, 128),  # P(rank <= 128 - 9) < 2^-81
        _linear,
    ),
    Experiment(
        "mt-one-bit",
        "the Mersenne Twister recovers slowly from a state of few bits",
        "After a few draws the state is forgotten.",
        "From a state with a single one bit, draws are mostly zeros for very long.",
        "draws until every later window of 624 is balanced within 0.02",
        "Proper seeding: the state from SplitMix64.",
        (5000, 2**20),
        (0, 0),
        _twister,
    ),
    Experiment(
        "c-rand-sum",
        "rand() of the GNU C library is the sum of two earlier draws",
        "The next draw can't be told from those before.",
        "o(i) = o(i-3) + o(i-31) modulo 2^31, or one more.",
        "share of draws told to within 1",
        "pcg32.",
        (1, 1),
        (0, 0.001),  # each with probability 2^-30
        _rand_sum,
    ),
    Experiment(
        "c-rand-coarse",
        "the C standard's own rand() has 32,768 values",
        "rand() / RAND_MAX fills [0,1].",
        "RAND_MAX is 32,767: a picture of 2^17 draws sees each value four times.",
        "distinct values in 2^17 draws",
        "32 bits or more a draw.",
        (1, 32768),
        (131000, 131072),  # 2^34 / 2 pairs / 2^32: 2 meet on average; 72 allowed
        _rand_coarse,
    ),
    Experiment(
        "overflow-16807",
        "16807 n in 32 bits is not minstd",
        "int x = 16807 * x % 2147483647 is the minimal standard.",
        "The product needs 46 bits; what is left of it in 32 has a sign.",
        "share of draws outside [1, 2^31 - 2]",
        "A 64-bit product, or Schrage's division: minstd.",
        (0.3, 0.7),  # a sign is a fair coin but for the method's own faults
        (0, 0),
        _overflow,
    ),
)
