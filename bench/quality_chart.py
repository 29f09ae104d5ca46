# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Rate against quality, charted: patterns by discrepancy, generators by the battery's failures.

    python bench/quality_chart.py            # writes docs/images/quality.png and prints the numbers

Patterns: nanoseconds a value of a float32 fill of 2^18 x 2 (the nearest count that the pattern
takes), one thread, median of 9; against the centered discrepancy (Hickernell 1998; the root of
the mean square over 8 seeds) of 1,024 points in two dimensions, or the nearest count below.
Generators: nanoseconds a float64 and failed tests of dieharder, read from the table that
rng_battery.py keeps in docs/generators.md.
"""

from __future__ import annotations

import re
import time
from statistics import median

import matplotlib
import numpy as np
from measure import ROOT, describe_build, describe_machine

import sunfleck as sf

matplotlib.use("Agg")
import matplotlib.pyplot as plt

SEEDS = 8


def patterns() -> list[tuple[str, float, float]]:
    """Name with scramble, nanoseconds a value, discrepancy."""
    rows = []
    for name in sf.PATTERNS:
        for scramble in ("default", None):
            if scramble is None and name not in ("halton", "sobol", "sz"):
                continue
            fill_count = sf.valid_counts(name, 2**18, 2)[0]
            count = sf.valid_counts(name, 1024, 2)[0]
            assert fill_count is not None
            assert count is not None
            out = np.empty((fill_count, 2), np.float32)
            seconds = []
            for _ in range(10):
                start = time.perf_counter()
                sf.points(name, fill_count, 2, scramble=scramble, out=out, threads=1)
                seconds.append(time.perf_counter() - start)
            squares = [
                sf.uniformity.discrepancy(sf.points(name, count, 2, seed=s, scramble=scramble, dtype="float64"))
                for s in range(SEEDS)
            ]
            label = name if scramble == "default" else f"{name}, plain"
            rows.append((label, 1e9 * median(seconds[1:]) / out.size, float(np.mean(squares)) ** 0.5))
    return rows


def generators() -> list[tuple[str, float, int]]:
    """Name, nanoseconds a float64, failed tests."""
    table = re.findall(
        r"^\| `([^`]+)` \| ([\d.]+) \| (\d+) \|", (ROOT / "docs/generators.md").read_text(), re.MULTILINE
    )
    return [(name, float(rate), int(failed)) for name, rate, failed in table]


def main() -> None:
    print(describe_machine())
    print(describe_build())
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 5), layout="constrained")
    for name, rate, discrepancy in patterns():
        print(f"{name:16} {rate:6.2f} ns a value   centered discrepancy {discrepancy:.2e}")
        left.plot(rate, discrepancy, "o", color="#0072b2")
        below = name.startswith(("sz", "halton"))  # beside sobol and lattice
        offset = (5, -9) if below else (5, 3)
        left.annotate(name, (rate, discrepancy), xytext=offset, textcoords="offset points", fontsize=8)
    left.set(xscale="log", yscale="log", xlabel="ns a value, float32, d = 2", ylabel="centered discrepancy, n = 1,024")
    left.set_title("patterns: down and left is better")
    for name, rate, failed in generators():
        right.plot(rate, failed, "o", color="#d55e00")
        turn = 0 if failed else 65
        right.annotate(name, (rate, failed), xytext=(2, 5), textcoords="offset points", fontsize=8, rotation=turn)
    right.set(xscale="log", xlabel="ns a float64", ylabel="dieharder tests failed of 63")
    right.set_title("generators")
    for axes in (left, right):
        axes.grid(True, which="both", alpha=0.2)
    (ROOT / "docs/images").mkdir(exist_ok=True)
    figure.savefig(ROOT / "docs/images/quality.png", dpi=80)


if __name__ == "__main__":
    main()
