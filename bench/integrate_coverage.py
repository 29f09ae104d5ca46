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
from typing import Any, NamedTuple

import numpy as np
from measure import describe_machine

import sunfleck as sf
from sunfleck.integrands import INTEGRANDS, standard_deviation

# By name in sf.integrands, for the low-discrepancy patterns and for random: chosen to be met after several looks.
TOLERANCES = {
    "exp": (1e-6, 1e-2),
    "peak": (1e-5, 1e-3),
    "oscillation": (1e-4, 1e-2),
    "exp-sum": (3e-3, 5e-2),
    "exp-mean": (1e-5, 1e-3),
    "kink": (3e-6, 3e-3),
    "g": (5e-4, 5e-3),
    "call": (1e-3, 5e-3),
    "circle": (2e-3, 2e-2),
    "simplex": (1e-3, 3e-3),
    "corner": (1e-4, 1e-4),
    "pole": (1e-3, 2e-2),
    "heavy-pole": (2e-2, 1e-1),
}


class Job(NamedTuple):
    case: str
    pattern: str
    tolerance: float
    replicates: int
    bounded: bool
    seeds: range
    max_samples: int


def run(job: Job) -> list[tuple[float, float, int, str]]:
    """(error, half-width, samples, stop reason) of each seed."""
    case = INTEGRANDS[job.case]
    options = {"replicates": job.replicates, "value_range": case.value_range if job.bounded else None}
    found = []
    for seed in job.seeds:
        r = sf.integrate(
            case.f, case.d, job.pattern, atol=job.tolerance, seed=seed, max_samples=job.max_samples, **options
        )
        found.append((r.value - case.exact, r.half_width, r.samples, r.stop_reason))
    return found


def errors_by_look(job: Job) -> list[list[float]]:
    """Squared errors by number of looks, each seed up to max_samples."""
    case = INTEGRANDS[job.case]
    squares: list[list[float]] = []
    for seed in job.seeds:
        r = sf.integrate(case.f, case.d, job.pattern, atol=1e-300, seed=10**6 + seed, replicates=job.replicates,
                         max_samples=job.max_samples)  # fmt: skip
        squares.append([(look.value - case.exact) ** 2 for look in r.history])
    return squares


def single_errors(job: Job) -> list[list[float]]:
    """Squared errors of one copy of 2^6 … points."""
    case = INTEGRANDS[job.case]
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


def report(pool: ProcessPoolExecutor, job: Job, oracles: bool) -> str:
    case = INTEGRANDS[job.case]
    found = [row for part in pool.map(run, split(job, 16)) for row in part]
    errors = np.abs([row[0] for row in found])
    covered = errors <= np.array([row[1] for row in found])
    trusted = np.array([row[3] != "suspicious" for row in found])
    samples = float(np.mean([row[2] for row in found]))
    cost = single = math.nan
    if oracles and job.pattern == "random":
        needed = max(1024, (Z * standard_deviation(job.case) / job.tolerance) ** 2)
        cost = samples / needed if math.isfinite(needed) else math.nan
    elif oracles:
        cost = samples / oracle(pool, job, 1024, errors_by_look)
        single = samples / oracle(pool, job, 64, single_errors)
    n = len(found)
    low = covered.mean() < 0.95 - 2 * math.sqrt(0.95 * 0.05 / n)
    trust = f"{trusted.mean():.3f} / {covered[trusted].mean():.3f}" if trusted.any() else "0 / –"
    cells = [case.title.replace("|", "\\|"), str(case.d), case.kind, f"{job.tolerance:g}"]
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
    parser.add_argument("--cases", nargs="+", default=list(TOLERANCES), choices=TOLERANCES, metavar="NAME")
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
            for name in args.cases:
                if args.bounded and not INTEGRANDS[name].value_range:
                    continue
                tolerance = TOLERANCES[name][pattern == "random"]
                job = Job(name, pattern, tolerance, args.replicates, args.bounded, range(args.seeds), 2**24)
                options: dict[str, Any] = {"oracles": not args.no_oracle}
                print(report(pool, job, **options), flush=True)


if __name__ == "__main__":
    main()
