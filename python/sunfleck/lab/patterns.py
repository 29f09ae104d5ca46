# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""patterns: point sets that fail."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

import sunfleck as sf
from sunfleck.lab.experiment import Array, Experiment, Measured, image, lines, scatter
from sunfleck.plot.figure import Panel

__all__ = ["EXPERIMENTS"]

COUNTS = np.array([64, 256, 1024, 4096])


def _points(pattern: str, n: int, d: int = 2, **options: Any) -> Array:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what the library warns of is what is shown here
        return np.asarray(sf.points(pattern, n, d, dtype="float64", threads=1, **options))


def _smooth(u: Array) -> Array:
    """Of mean 1 in each factor, smooth."""
    return np.asarray(np.prod(1 + (u - 0.5) + (u - 0.5) ** 2 - 1 / 12, axis=1))


def _rms(f: Callable[[Array], Array], exact: float, sets: list[Array]) -> float:
    return float(np.sqrt(np.mean([(np.mean(f(u)) - exact) ** 2 for u in sets])))


def _slope(pattern: str, seed: int, runs: int = 100, **options: Any) -> tuple[float, Panel]:
    errors = [
        _rms(_smooth, 1.0, [_points(pattern, int(n), seed=seed * runs + k, **options) for k in range(runs)])
        for n in COUNTS
    ]
    slope = float(np.polyfit(np.log(COUNTS), np.log(errors), 1)[0])
    return slope, lines({pattern: (COUNTS, np.array(errors))}, "samples", "RMS error", log=True)


def _aliasing(seed: int) -> Measured:
    n, frequency = 256, 16

    def error(pattern: str) -> tuple[float, Panel]:
        u = _points(pattern, n, seed=seed)
        return abs(float(np.mean(np.cos(2 * np.pi * frequency * (u[:, 0] - u[0, 0]))))), scatter(u)

    before, failing = error("uniform")
    u = _points("jittered", n, seed=seed)
    after = abs(float(np.mean(np.cos(2 * np.pi * frequency * u[:, 0]))))
    return Measured(before, after, failing, scatter(u))


def _clumps(seed: int) -> Measured:
    before, failing = _slope("random", seed)
    after, remedied = _slope("jittered", seed)
    return Measured(before, after, failing, remedied)


def _in_step(seed: int) -> Measured:
    n = 1024
    pixel = _points("jittered", n, seed=2 * seed)
    lens = _points("jittered", n, seed=2 * seed + 1)
    order = np.argsort(np.asarray(sf.Rng("pcg64dxsm", seed=seed).random(n)))

    def share(partner: Array) -> tuple[float, Panel]:
        both = np.stack([pixel[:, 0], partner[:, 0]], 1)
        near = np.abs(both[:, 0] - both[:, 1]) < 0.25
        return float(np.mean(near)) - 7 / 16, scatter(both, "pixel x", "lens x")

    before, failing = share(lens)
    after, remedied = share(lens[order])
    return Measured(before, after, failing, remedied)


def _correlation(first: int, n: int) -> Callable[[int], Measured]:
    def measure(seed: int) -> Measured:
        def correlation(scramble: str | None) -> tuple[float, Panel]:
            u = _points("halton", n, first + 2, seed=seed, scramble=scramble)[:, first:]
            return abs(float(np.corrcoef(u.T)[0, 1])), scatter(u, f"dimension {first}", f"dimension {first + 1}")

        before, failing = correlation(None)
        _, remedied = correlation("owen")
        trials = [
            float(np.corrcoef(_points("halton", n, first + 2, seed=seed * 64 + k, scramble="owen")[:, first:].T)[0, 1])
            for k in range(64)
        ]
        return Measured(before, abs(float(np.mean(trials))), failing, remedied)

    return measure


def _diagonals(seed: int) -> Measured:
    def uneven(k: int, scramble: str | None) -> tuple[float, Panel]:
        u = _points("halton", 100, 8, seed=64 * seed + k, scramble=scramble)[:, 6:]
        return sf.uniformity.discrepancy(u), scatter(u, "dimension 6", "dimension 7")

    before, failing = uneven(0, None)
    trials = [uneven(k, "permuted") for k in range(64)]
    return Measured(before, float(np.mean([value for value, _ in trials])), failing, trials[0][1])


def _product(u: Array) -> Array:
    return np.asarray((u[:, 0] - 0.5) * (u[:, 1] - 0.5))


def _projection(seed: int) -> Measured:
    runs = 1000
    sets = [_points("sobol", 16, 4, seed=seed * runs + k) for k in range(runs)]

    def rms(pair: tuple[int, int]) -> tuple[float, Panel]:
        chosen = [u[:, pair] for u in sets]
        return _rms(_product, 0.0, chosen), scatter(chosen[0], *(f"dimension {k}" for k in pair))

    before, failing = rms((0, 3))
    after, remedied = rms((0, 1))
    return Measured(before, after, failing, remedied)


def _many_dimensions(seed: int) -> Measured:
    n, runs = 16, 1000

    def again(k: int) -> Array:
        """The first dimension of a four, and of another four in the same order, scrambled apart."""
        return np.stack([_points("sz", n, 4, seed=2 * (seed * runs + k) + four)[:, 0] for four in (0, 1)], axis=1)

    def rms(sets: list[Array]) -> tuple[float, Panel]:
        return _rms(_product, 0.0, sets) * 12 * np.sqrt(n), scatter(sets[0], "dimension 0", "dimension 4")

    before, failing = rms([again(k) for k in range(runs)])
    after, remedied = rms([_points("sz", n, 5, seed=seed * runs + k, pad=4)[:, (0, 4)] for k in range(runs)])
    return Measured(before, after, failing, remedied)


def _first_point(seed: int) -> Measured:
    before, failing = _slope("sobol", seed, start=1)
    after, remedied = _slope("sobol", seed)
    return Measured(before, after, failing, remedied)


def _hash_flips(original: bool, seed: int) -> Array:
    """Flips (as -1, 1) of the bit below each of the 4 prefixes of 2 bits, for 2^14 random seeds.

    On reversed bits, as the hashes work: prefix k is the low two bits, its flip bit 2.
    """
    seeds = np.asarray(sf.Rng("splitmix64", seed=seed).bits(1 << 14, dtype="uint32"))[:, None]
    prefix = np.arange(4, dtype=np.uint32)[None]
    with np.errstate(over="ignore"):
        if original:  # Laine & Karras 2011, section 3.1 of "Stratified sampling for stochastic transparency"
            x = prefix + seeds
            for constant in (0x6C50B47C, 0xB82F1E52, 0xC7AFE638, 0x8D22F6E6):
                x = x ^ (x * np.uint32(constant))
        else:  # Vegdahl 2021, "Building a better LK hash"
            x = prefix ^ (prefix * np.uint32(0x3D20ADEA))
            x = x + seeds
            x = x * ((seeds >> np.uint32(16)) | np.uint32(1))
            for constant in (0x05526C56, 0x53A22864):
                x = x ^ (x * np.uint32(constant))
    return np.asarray(1.0 - 2.0 * ((x >> np.uint32(2)) & np.uint32(1)))


def _weak_hash(seed: int) -> Measured:
    def worst(original: bool) -> tuple[float, Panel]:
        law = np.corrcoef(_hash_flips(original, seed).T)
        return float(np.max(np.abs(law - np.eye(4)))), image(law, "prefix", "prefix")

    before, failing = worst(True)
    after, remedied = worst(False)
    return Measured(before, after, failing, remedied)


def _duplicates(seed: int) -> Measured:
    digits, n = 6, 3**6
    shift = 1 + np.asarray(sf.Rng("pcg64dxsm", seed=seed).bits(digits)) % 2
    index, value = np.arange(n), np.zeros(n)
    for k in range(digits):  # of the index's own digits, the leading zeros left alone
        value += np.where(index >= 3**k, (index // 3**k + shift[k]) % 3, 0) / 3.0 ** (k + 1)
    right = _points("halton", n, 2, seed=seed, scramble="permuted")[:, 1]

    def repeated(x: Array) -> float:
        return float(n - len(np.unique(np.round(x * n, 3))))

    show = [scatter(np.stack([index, x], axis=1)[:243], "index", "value") for x in (value, right)]
    return Measured(repeated(value), repeated(right), show[0], show[1])


def _not_a_power(seed: int, runs: int = 200) -> Measured:
    counts = np.array([1024, 1280, 1536, 1792, 2048])
    errors = np.array(
        [_rms(_smooth, 1.0, [_points("sobol", int(n), seed=seed * runs + k) for k in range(runs)]) for n in counts]
    )
    shown = lines({"sobol": (counts, errors)}, "samples", "RMS error", log=True)
    kept = lines({"sobol": (counts[::4], errors[::4])}, "samples", "RMS error", log=True)
    return Measured(float(errors[2] / errors[0]), float(errors[4] / errors[0]), shown, kept)


EXPERIMENTS = (
    Experiment(
        "grid-aliasing",
        "a uniform grid aliases where the integrand has its frequency",
        "More points, a smaller error.",
        "cos(32 pi x) on a 16 x 16 grid: every point sees the same phase.",
        "absolute error, of an integrand within [-1, 1]",
        "Jitter.",
        (0.999, 1),
        (0, 0.25),  # a whole period a cell: sigma 2^-1/2 / 16 = 0.044, 5.6 of them
        _aliasing,
    ),
    Experiment(
        "random-clumps",
        "random points have clumps and gaps",
        "Random sampling is good enough.",
        "The RMS error falls as n^-1/2 only.",
        "slope of log RMS error over log n, smooth integrand, 100 seeds",
        "Any stratified pattern: jittered in the plane has n^-1.",
        (-0.65, -0.35),  # an RMS of 100 has sigma 7 %: of the slope 0.022, six of them
        (-1.15, -0.85),
        _clumps,
    ),
    Experiment(
        "pixel-and-lens-in-step",
        "two jittered pads that share their cells are correlated",
        "Each pad is well stratified, so are the pairs.",
        "Sample k takes the same cell of pixel and lens: a defocused edge is biased.",
        "error of the share |pixel x - lens x| < 1/4, which is 7/16",
        "Shuffle one pad's order.",
        (0.5, 0.57),  # |x - l| < 1/32: always true, 9/16
        (-0.1, 0.1),  # sigma below 0.5 / 32 = 0.016, six of them
        _in_step,
    ),
    Experiment(
        "halton-17-19",
        "plain Halton in bases 17 and 19 is a set of lines",
        "A low-discrepancy sequence fills every plane.",
        "The first hundred points run along a few diagonals.",
        "centered discrepancy of dimensions 6 and 7, n = 100 (after: mean of 64 seeds)",
        "Permute the digits: the library's default.",
        (0.0039, 0.004),  # no seed: 0.00395
        # Random points have (5/4)^2 - (13/12)^2 = 0.389 over n on average: stratified ones stay below.
        (0, 0.0039 / 2),
        _diagonals,
    ),
    Experiment(
        "halton-29-31",
        "Halton in bases 29 and 31 runs along one diagonal",
        "A low-discrepancy sequence fills every plane.",
        "Both radical inverses are near i/30 while i < 29.",
        "correlation of dimensions 9 and 10 at n = 29 (after: mean of 64 scrambles)",
        "Scramble the digits: owen.",
        (0.9, 1),
        (0, 0.14),  # sigma 29^-1/2 / 8 = 0.023, six of them
        _correlation(9, 29),
    ),
    Experiment(
        "sobol-projection",
        "some pairs of Sobol's dimensions are bad at small n",
        "Every pair of dimensions is stratified alike.",
        "Dimensions 0 and 3 at n = 16 are no better than random on (x - 1/2)(y - 1/2), which has 0.0208.",
        "RMS error, 1000 scrambles",
        "Give important pairs the first dimensions, or pad sets of two.",
        (0.019, 0.025),  # 0.022; an RMS of 1000 has sigma 2.2 % (normal errors), six of them
        (0.0053, 0.0069),  # 0.0061
        _projection,
    ),
    Experiment(
        "sz-few-points",
        "few points can't tell a second four of sz from the first",
        "sz's four dimensions are a perfect net: so take them twice.",
        "In the same order dimension 4 is dimension 0, scrambled apart; a (0, 16)-sequence's is up to 2^4 points.",
        "RMS error of the mean product of dimensions 0 and 4, n = 16, 1000 scrambles, over independent points'",
        "Fours in orders of their own: pad=4; or sobol.",
        (2.5, 3.6),  # 3.05 by the dual net, within six sigma of 3 %
        (0.9, 1.5),  # 1.2, as of any nested shuffles; sigma 3 %
        _many_dimensions,
    ),
    Experiment(
        "sobol-first-point",
        "Sobol without its first point loses the rate",
        "The point at the origin is special: drop it.",
        "The rest is no net: n^-3/2 becomes n^-1 (Owen 2020).",
        "slope of log RMS error over log n, smooth integrand, 100 seeds",
        "Keep point 0.",
        (-1.15, -0.85),
        (-1.75, -1.25),  # -3/2 up to a logarithm at these n, and six sigma of 0.022
        _first_point,
    ),
    Experiment(
        "owen-weak-hash",
        "scrambling by the original Laine-Karras constants is not Owen's",
        "A hash of the bits above decides each flip independently.",
        "Flips of the same level are correlated.",
        "largest correlation of two flips at depth 3, over 2^14 seeds",
        "The revised constants (Vegdahl 2021), the library's scramble; or nested, exact at any depth.",
        (0.4, 1),
        (0, 0.06),  # sigma 2^-7 = 0.0078, seven of them for the largest of 6
        _weak_hash,
    ),
    Experiment(
        "halton-duplicates",
        "permuting only an index's own digits makes duplicates",
        "A permutation of digits keeps points apart.",
        "A leading digit that becomes 0 can't be told from no digit.",
        "points of 729 that repeat another, base 3",
        "Permute all digits, the leading zeros too, to infinity: permuted, the default.",
        (1, 728),
        (0, 0),
        _duplicates,
    ),
    Experiment(
        "sobol-1536",
        "half as many Sobol points again buy nothing",
        "More samples, a smaller error.",
        "The other half of the second net is missing, and with it what would cancel.",
        "RMS error at n = 1536 (after: 2048) over that at 1024, smooth integrand",
        "Powers of two.",
        # (2 e(1024) + e(512)) / 3, with e(512) = 2^(3/2) e(1024): 1.15 where these are independent, and 6 sigma of
        # 7 %; below where they are not. n^-3/2 would have 0.54.
        (0.7, 1.64),
        (0.22, 0.56),  # 2^-3/2 = 0.354; RMS of 200: sigma 5 % each, six of 7 %
        _not_a_power,
    ),
)
