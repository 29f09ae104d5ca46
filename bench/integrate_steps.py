# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""How often `sf.integrate` covers a step across one axis beside something smooth: 1[x < u] + g(y), u random.

Copies of a stratified pattern may all see the same of the step, an error that is in no spread. The table
has, for each pattern and g, the share of runs whose error is within the half-width, and the mean samples.
"""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from typing import Any

import numpy as np
from measure import describe_machine
from numpy.typing import NDArray
from scipy.special import i0

import sunfleck as sf

Array = NDArray[np.float64]

SMOOTH: dict[str, tuple[Callable[[Array], Array], float]] = {  # and the integral
    "y²": (lambda y: y**2, 1 / 3),
    "0.1 y²": (lambda y: 0.1 * y**2, 1 / 30),
    "exp cos 2πy": (lambda y: np.exp(np.cos(2 * np.pi * y)), float(i0(1))),
}
KINDS = [
    "sobol:owen",
    "sobol:lms",
    "sobol:nested",
    "sobol:shift",
    "sz:owen",
    "sz:shift",
    "latin",
    "jittered",
    "multijittered",
    "orthogonal",
    "halton",
    "halton:owen",
    "hammersley",
    "hammersley:permuted",
    "hammersley:owen",
    "lattice",
    "r2",
    "random",
]


def run(kind: str, name: str, axis: int, tolerance: float, seeds: range) -> tuple[int, int]:
    """Runs that cover, and samples of all."""
    pattern, _, scramble = kind.partition(":")
    g, mean = SMOOTH[name]
    covered = samples = 0
    for seed in seeds:
        u = np.random.default_rng([7, seed]).random()

        def f(x: Array, u: float = u) -> Any:
            return (x[:, axis] < u) + g(x[:, 1 - axis])

        r = sf.integrate(f, 2, pattern, scramble=scramble or "default", seed=seed, atol=tolerance, max_samples=2**20)
        covered += abs(r.value - u - mean) <= r.half_width
        samples += r.samples
    return covered, samples


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kinds", nargs="+", default=KINDS, metavar="PATTERN[:SCRAMBLE]")
    parser.add_argument("--seeds", type=int, default=300)
    parser.add_argument("--tolerance", type=float, default=3e-4)
    parser.add_argument("--axis", type=int, default=0, choices=(0, 1))
    args = parser.parse_args()
    print(describe_machine())
    print(f"{args.seeds} runs, tolerance {args.tolerance:g}, axis {args.axis}, numpy {np.__version__}")
    print(f"two binomial deviations at 0.95: {2 * math.sqrt(0.95 * 0.05 / args.seeds):.3f}")
    print(f"\n| pattern | scramble | {' | '.join(SMOOTH)} |")
    print("|---|---|" + "---|" * len(SMOOTH))
    parts = [range(k * args.seeds // 8, (k + 1) * args.seeds // 8) for k in range(8)]
    with ProcessPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        for kind in args.kinds:
            cells = []
            for name in SMOOTH:
                jobs = [pool.submit(run, kind, name, args.axis, args.tolerance, part) for part in parts]
                covered, samples = np.sum([job.result() for job in jobs], axis=0)
                cells.append(f"{covered / args.seeds:.3f}, {samples / args.seeds:,.0f}")
            pattern, _, scramble = kind.partition(":")
            print(f"| {pattern} | {scramble} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
