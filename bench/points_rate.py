# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""How fast patterns fill arrays: nanoseconds a value, beside a constant fill and SciPy's engines.

What is compared takes turns, so that both see the same machine; a ratio is the median of the
turns' ratios. One thread unless said.

    python bench/points_rate.py [memory] [cache] [patterns] [scipy] [threads] [table]     # all without a name
"""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Callable
from functools import partial
from statistics import median
from typing import Any

import numpy as np
from measure import describe_build, describe_machine, state
from scipy.stats import qmc

import sunfleck as sf

Work = Callable[[], Any]


def take_turns(works: list[Work], runs: int, warm: int = 0) -> list[list[float]]:
    """Seconds of each work in each run, after one run that counts for nothing; `warm` further calls
    before each that is timed, so that it finds the caches as it leaves them."""
    seconds: list[list[float]] = [[] for _ in works]
    for run in range(-1, runs):
        for work, list_ in zip(works, seconds, strict=True):
            for _ in range(warm):
                work()
            start = time.perf_counter()
            work()
            if run >= 0:
                list_.append(time.perf_counter() - start)
    return seconds


def ratio(numerator: list[float], denominator: list[float]) -> float:
    return median(a / b for a, b in zip(numerator, denominator, strict=True))


def per_value(seconds: list[float], values: int) -> str:
    return f"{state([1e9 * s / values for s in seconds])} ns"


def filler(pattern: str, n: int, d: int, out: np.ndarray, **options: Any) -> Work:
    options = {"threads": 1, **options}
    return lambda: sf.points(pattern, n, d, dtype=out.dtype, out=out, **options)


def run_engine(engine: Any, options: dict[str, Any], n: int, d: int) -> Any:
    return engine(d, **options).random(n)


def bench_memory() -> None:
    """An array beyond every cache, 256 MiB, against a constant fill of it."""
    n, d = 2**22, 16
    out = np.empty((n, d), np.float32)
    works: list[Work] = [lambda: out.fill(0.5)]
    works += [filler("sobol", n, d, out, scramble=None), filler("sobol", n, d, out)]
    constant, plain, owen = take_turns(works, 11)
    print(f"constant fill           {per_value(constant, n * d)}")
    print(f"sobol plain             {per_value(plain, n * d)}, {ratio(plain, constant):.2f} of the constant fill")
    print(f"sobol owen              {per_value(owen, n * d)}, {ratio(owen, constant):.2f} of the constant fill")


def bench_cache() -> None:
    """Arrays of 1 MiB, which a second cache holds."""
    kinds: list[tuple[str, int, dict[str, Any]]] = [
        ("sobol", d, {"scramble": s}) for d in (2, 16) for s in (None, "shift", "lms", "owen", "nested")
    ]
    kinds += [("sz", 2, {}), ("sz", 4, {}), ("sobol", 64, {"pad": 2}), ("sobol", 64, {"pad": 4})]
    for pattern, d, options in kinds:
        n = 2**18 // d
        float32, float64 = np.empty((n, d), np.float32), np.empty((n, d), np.float64)
        a, b = take_turns([filler(pattern, n, d, float32, **options), filler(pattern, n, d, float64, **options)], 41)
        name = f"{pattern} d={d} " + " ".join(f"{k}={v}" for k, v in options.items())
        print(f"{name:30} float32 {per_value(a, n * d)}, float64 {per_value(b, n * d)}")


def bench_patterns() -> None:
    """Every pattern with its own scramble and the others, 2^18 x 16 or the nearest count below."""
    d = 16
    for pattern in sf.PATTERNS:
        n, _ = sf.valid_counts(pattern, 2**18, d)
        float32, float64 = np.empty((n, d), np.float32), np.empty((n, d), np.float64)
        scrambles = [None, *(s for s in sf.SCRAMBLES if s not in ("default", "none"))]
        for scramble in scrambles:
            works = [filler(pattern, n, d, out, scramble=scramble) for out in (float32, float64)]
            try:
                works[0]()
            except ValueError:  # a scramble that the pattern does not take
                continue
            a, b = take_turns(works, 5)
            name = f"{pattern} {scramble or 'none'}"
            print(f"{name:20} n={n}: float32 {per_value(a, n * d)}, float64 {per_value(b, n * d)}")


def bench_scipy() -> None:
    """2^18 x 16 values, SciPy's in float64 (it has no other), ours in both."""
    n, d = 2**18, 16
    float32, float64 = np.empty((n, d), np.float32), np.empty((n, d), np.float64)
    peers: list[tuple[str, dict[str, Any], Any, dict[str, Any]]] = [
        ("sobol", {"scramble": None}, qmc.Sobol, {"scramble": False, "bits": 32}),
        ("sobol", {"scramble": "lms"}, qmc.Sobol, {"scramble": True, "bits": 32}),
        ("sobol", {"scramble": "owen"}, qmc.Sobol, {"scramble": True, "bits": 32}),  # lms: it lacks owen
        ("halton", {"scramble": None}, qmc.Halton, {"scramble": False}),
        ("halton", {}, qmc.Halton, {"scramble": True}),
        ("latin", {}, qmc.LatinHypercube, {}),
    ]
    for pattern, options, engine, theirs in peers:
        if pattern not in sf.PATTERNS:
            continue
        works: list[Work] = [
            partial(run_engine, engine, theirs, n, d),
            filler(pattern, n, d, float32, **options),
            filler(pattern, n, d, float64, **options),
        ]
        peer, a, b = take_turns(works, 5 if pattern == "halton" else 11)
        name = " ".join([pattern, *(str(v) for v in options.values())])
        print(f"{name:14} SciPy {per_value(peer, n * d)}")
        print(f"{'':14} float32 {per_value(a, n * d)}, {ratio(peer, a):.1f} x as fast")
        print(f"{'':14} float64 {per_value(b, n * d)}, {ratio(peer, b):.1f} x as fast")


def bench_threads() -> None:
    """One thread and two, from arrays that fit a first cache to those beyond every cache, each again
    and again: the parts stay in the cache of the core that wrote them, where they fit."""
    d = 16
    print(f"{'float32':>10}  {'plain: 1, 2 threads, gain':>30}  {'owen: 1, 2 threads, gain':>30}")
    for exponent in (10, 12, 13, 14, 15, 16, 17, 18, 20, 22):
        n = 2**exponent
        out = np.empty((n, d), np.float32)
        cells = []
        for scramble in (None, "owen"):
            works = [filler("sobol", n, d, out, scramble=scramble, threads=t) for t in (1, 2)]
            one, two = take_turns(works, 9 if exponent > 17 else 101, warm=1 if exponent > 17 else 3)
            micro = (1e6 * median(seconds) for seconds in (one, two))
            cells.append(f"{' '.join(f'{m:9.1f}' for m in micro)} us {ratio(one, two):5.2f} x")
        print(f"{n * d * 4 / 2**20:6.2f} MiB  " + "  ".join(cells))


def bench_table() -> None:
    """What the tables of many dimensions cost, the first point with them."""
    for pattern, d in (("sobol", 21201),):
        for scramble in (None, "owen", "lms"):
            out = np.empty((1, d), np.float32)
            (seconds,) = take_turns([filler(pattern, 1, d, out, scramble=scramble, start=2**31 - 1)], 7)
            print(f"{pattern} d={d} {scramble}: {state([1e3 * s for s in seconds])} ms")


BENCHES = {
    "memory": bench_memory,
    "cache": bench_cache,
    "patterns": bench_patterns,
    "scipy": bench_scipy,
    "threads": bench_threads,
    "table": bench_table,
}


def main() -> None:
    warnings.simplefilter("ignore")  # one point of Sobol' is asked for on purpose
    print(describe_machine())
    print(describe_build())
    for name in sys.argv[1:] or BENCHES:
        print(f"\n{name}: {BENCHES[name].__doc__}")
        BENCHES[name]()


if __name__ == "__main__":
    main()
