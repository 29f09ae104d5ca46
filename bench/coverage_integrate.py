# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""How often `sf.integrate` tells the truth, and what it costs: integrands with known answers.

For each integrand, pattern and tolerance, over many seeds:

covered    share of seeds whose error is within the half-width claimed
within     share of seeds whose error is within the tolerance
trusted    share that was not marked suspicious, and the coverage of those
cost       mean samples over those of an oracle that knows the estimate's true error at every
           look, has the same replicates, looks and minimum, and stops where z(confidence) times
           that error is within the tolerance. For random, that is (z sigma / tolerance)^2 samples.
single     the same over an oracle that needs no replicates: one scrambled copy of the pattern
"""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from measure import describe_machine
from numpy.typing import NDArray

import sunfleck as sf

Block = NDArray[np.float64]


def mean_excess(d: int, c: int) -> float:
    """E max(S - c, 0) of the sum S of d uniforms (Irwin & Hall's density, integrated exactly)."""
    total = sum(Fraction((-1) ** k * math.comb(d, k) * (d - c - k) ** (d + 1)) for k in range(d - c + 1))
    return float(total / math.factorial(d + 1))


def sum_below(d: int, c: int) -> float:
    """P(S < c) of the sum S of d uniforms (Irwin & Hall)."""
    total = sum(Fraction((-1) ** k * math.comb(d, k) * (c - k) ** d) for k in range(c + 1))
    return float(total / math.factorial(d))


class Case(NamedTuple):
    name: str
    d: int
    kind: str
    f: Callable[[Block], Block]
    exact: float
    tolerances: dict[str, float]  # by pattern, chosen to be met after several looks
    value_range: tuple[float, float] | None


def circle(u: Block) -> Block:
    return 4.0 * (u[:, 0] ** 2 + u[:, 1] ** 2 < 1.0)


def oscillation(u: Block) -> Block:
    return np.cos(0.6 * math.pi + u @ np.arange(1.0, 6.0))


def oscillation_exact() -> float:
    product = np.prod([(np.exp(1j * a) - 1) / (1j * a) for a in range(1, 6)])
    return float((np.exp(0.6j * math.pi) * product).real)


def g_function(u: Block) -> Block:
    a = np.arange(1.0, 7.0)
    return np.prod((np.abs(4 * u - 2) + a) / (1 + a), axis=1)


def product_exponential(u: Block) -> Block:
    return np.exp(u @ (1 / np.arange(1.0, 11.0)))


CASES = [
    Case("exp x", 1, "smooth", lambda u: np.exp(u[:, 0]), math.e - 1, {"low": 1e-6, "random": 1e-2}, (1, math.e)),
    Case("Gaussian peak", 3, "smooth", lambda u: np.exp(-25 * ((u - 0.5) ** 2).sum(axis=1)),
         (math.sqrt(math.pi) / 5 * math.erf(2.5)) ** 3, {"low": 1e-5, "random": 1e-3}, (0, 1)),
    Case("oscillation", 5, "smooth", oscillation, oscillation_exact(), {"low": 1e-4, "random": 1e-2}, (-1, 1)),
    Case("exp of a sum", 10, "smooth", product_exponential, math.prod(k * (math.exp(1 / k) - 1) for k in range(1, 11)),
         {"low": 3e-3, "random": 5e-2}, None),
    Case("exp of a mean", 20, "smooth", lambda u: np.exp(u.mean(axis=1)), (20 * (math.exp(1 / 20) - 1)) ** 20,
         {"low": 1e-5, "random": 1e-3}, (1, math.e)),
    Case("|x + y - 1|", 2, "kinked", lambda u: np.abs(u[:, 0] + u[:, 1] - 1), 1 / 3,
         {"low": 3e-6, "random": 3e-3}, (0, 1)),
    Case("g function", 6, "kinked", g_function, 1.0, {"low": 5e-4, "random": 5e-3}, None),
    Case("call on a sum", 20, "kinked", lambda u: np.maximum(u.sum(axis=1) - 11, 0), mean_excess(20, 11),
         {"low": 1e-3, "random": 5e-3}, (0, 9)),
    Case("circle (π)", 2, "discontinuous", circle, math.pi, {"low": 2e-3, "random": 2e-2}, (0, 4)),
    Case("simplex", 8, "discontinuous", lambda u: (u.sum(axis=1) < 3.0).astype(float), sum_below(8, 3),
         {"low": 1e-3, "random": 3e-3}, (0, 1)),
    Case("rare corner, p = 1e-4", 2, "rare", lambda u: 1.0 * ((u < 0.01).all(axis=1)), 1e-4,
         {"low": 1e-4, "random": 1e-4}, (0, 1)),
    Case("x^-0.45", 1, "heavy tail, variance finite", lambda u: (u[:, 0] + 1e-300) ** -0.45, 1 / 0.55,
         {"low": 1e-3, "random": 2e-2}, None),
    Case("x^-0.6", 1, "heavy tail, variance infinite", lambda u: (u[:, 0] + 1e-300) ** -0.6, 1 / 0.4,
         {"low": 2e-2, "random": 1e-1}, None),
]  # fmt: skip


class Job(NamedTuple):
    case: int
    pattern: str
    tolerance: float
    replicates: int
    bounded: bool
    seeds: range
    max_samples: int


def run(job: Job) -> list[tuple[float, float, int, str]]:
    """(error, half-width, samples, stop reason) of each seed."""
    case = CASES[job.case]
    options = {"replicates": job.replicates, "value_range": case.value_range if job.bounded else None}
    found = []
    for seed in job.seeds:
        r = sf.integrate(case.f, case.d, job.pattern, job.tolerance, seed=seed, max_samples=job.max_samples, **options)
        found.append((r.value - case.exact, r.half_width, r.samples, r.stop_reason))
    return found


def errors_by_look(job: Job) -> list[list[float]]:
    """Squared errors by number of looks, each seed up to max_samples."""
    case = CASES[job.case]
    squares: list[list[float]] = []
    for seed in job.seeds:
        r = sf.integrate(case.f, case.d, job.pattern, 1e-300, seed=10**6 + seed, replicates=job.replicates,
                         max_samples=job.max_samples)  # fmt: skip
        squares.append([(look.value - case.exact) ** 2 for look in r.history])
    return squares


def single_errors(job: Job) -> list[list[float]]:
    """Squared errors of one copy of 2^6 … points."""
    case = CASES[job.case]
    squares = []
    for seed in job.seeds:
        values = case.f(sf.points(job.pattern, job.max_samples, case.d, seed=10**6 + seed, dtype="float64", threads=1))
        sums = np.cumsum(values)
        squares.append([(sums[2**k - 1] / 2**k - case.exact) ** 2 for k in range(6, job.max_samples.bit_length())])
    return squares


Z = sf.estimate.normal_quantile(0.975)
COLUMNS = ["integrand", "d", "kind", "tolerance", "covered", "within", "trusted/covered", "samples", "cost", "single"]


def split(job: Job, parts: int) -> list[Job]:
    n = len(job.seeds)
    return [job._replace(seeds=range(n * k // parts, n * (k + 1) // parts)) for k in range(parts)]


def oracle(pool: ProcessPoolExecutor, job: Job, first: int, measure: Callable[[Job], list[list[float]]]) -> float:
    """Samples at the first look whose true error meets the tolerance; looks at first * 2^k."""
    limit = 16 * first
    while True:
        parts = pool.map(measure, split(job._replace(max_samples=limit, seeds=range(200)), 8))
        squares = [row for part in parts for row in part]
        rms = np.sqrt(np.mean(squares, axis=0))
        met = np.flatnonzero(Z * rms <= job.tolerance)
        if len(met):
            return first * 2.0 ** met[0]
        if limit >= 2**22:
            return math.nan
        limit *= 8


def sigma(case: Case) -> float:
    u = sf.Rng("pcg64dxsm" if "pcg64dxsm" in sf.RNGS else "xoshiro256++", seed=1).random((2**21, case.d))
    return float(case.f(u).std())


def report(pool: ProcessPoolExecutor, job: Job, oracles: bool) -> str:
    case = CASES[job.case]
    found = [row for part in pool.map(run, split(job, 16)) for row in part]
    errors = np.abs([row[0] for row in found])
    covered = errors <= np.array([row[1] for row in found])
    trusted = np.array([row[3] != "suspicious" for row in found])
    samples = float(np.mean([row[2] for row in found]))
    cost = single = math.nan
    if oracles and job.pattern == "random":
        cost = samples / max(1024, (Z * sigma(case) / job.tolerance) ** 2) if "infinite" not in case.kind else math.nan
    elif oracles:
        cost = samples / oracle(pool, job, 1024, errors_by_look)
        single = samples / oracle(pool, job, 64, single_errors)
    n = len(found)
    low = covered.mean() < 0.95 - 2 * math.sqrt(0.95 * 0.05 / n)
    trust = f"{trusted.mean():.3f} / {covered[trusted].mean():.3f}" if trusted.any() else "0 / –"
    cells = [case.name.replace("|", "\\|"), str(case.d), case.kind, f"{job.tolerance:g}"]
    cells += [f"{covered.mean():.3f}{' ✗' if low else ''}", f"{(errors <= job.tolerance).mean():.3f}", trust]
    cells += [f"{samples:,.0f}", *("–" if math.isnan(x) else f"{x:.2f}" for x in (cost, single))]
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--patterns", nargs="+", default=["sobol", "halton", "random"])
    parser.add_argument("--seeds", type=int, default=1000)
    parser.add_argument("--replicates", type=int, default=16)
    parser.add_argument("--bounded", action="store_true", help="give value_range, where there is one")
    parser.add_argument("--no-oracle", action="store_true")
    parser.add_argument("--cases", nargs="+", default=[case.name for case in CASES])
    args = parser.parse_args()

    print(describe_machine())
    print(f"{args.seeds} seeds, {args.replicates} replicates, confidence 0.95, numpy {np.__version__}")
    print(f"✗: below 0.95 by more than two binomial deviations, {2 * math.sqrt(0.95 * 0.05 / args.seeds):.4f}")
    with ProcessPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        for pattern in args.patterns:
            print(f"\n**{pattern}{', value_range given' if args.bounded else ''}**\n")
            print(
                "| integrand | d | kind | tolerance | covered | within | trusted / covered | samples | cost | single |"
            )
            print("|---|---|---|---|---|---|---|---|---|---|")
            for i, case in enumerate(CASES):
                if case.name not in args.cases or (args.bounded and not case.value_range):
                    continue
                tolerance = case.tolerances["random" if pattern == "random" else "low"]
                job = Job(i, pattern, tolerance, args.replicates, args.bounded, range(args.seeds), 2**24)
                options: dict[str, Any] = {"oracles": not args.no_oracle}
                print(report(pool, job, **options), flush=True)


if __name__ == "__main__":
    main()
