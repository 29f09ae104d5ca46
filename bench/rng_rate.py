# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Nanoseconds a number of every generator, beside NumPy's same one where it has it.

One thread fills one array of 4 M values that was written before; the contenders take turns, so that all see the same
machine, and a ratio is the median over turns of NumPy's time over ours in the same turn. Times are the thread's own.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable

import numpy as np
from measure import describe_build, describe_machine

import sunfleck as sf
from sunfleck import _core

COUNT = 1 << 22
NUMPY = {"mt19937": "MT19937", "pcg64dxsm": "PCG64DXSM", "sfc64": "SFC64", "philox4x64": "Philox"}


def seconds(call: Callable[[], object]) -> float:
    """Of processor time, which does not run while another process has the processor."""
    start = time.thread_time()
    call()
    return time.thread_time() - start


def filler(rng: sf.Rng, out: np.ndarray) -> Callable[[], object]:
    if out.dtype.kind == "f":
        return lambda: rng.random(out=out, dtype=out.dtype)
    return lambda: rng.bits(out=out, dtype=out.dtype)


def nanoseconds(rng: sf.Rng, dtype: str, runs: int = 9, count: int = COUNT) -> list[float]:
    """Of one value, for each of `runs` fills."""
    out = np.ones(count, dtype=dtype)
    fill = filler(rng, out)
    return [1e9 * seconds(fill) / count for _ in range(runs)]


def compare(name: str, dtype: str, runs: int) -> tuple[list[float], list[float]]:
    """Our nanoseconds and NumPy's, in turns; NumPy's are empty where it has none."""
    out = np.ones(COUNT, dtype=dtype)
    ours = filler(sf.Rng(name, seed=12345), out)
    theirs = None
    if name in NUMPY and dtype == "float64":
        generator = np.random.Generator(getattr(np.random, NUMPY[name])(12345))
        theirs = lambda: generator.random(out=out)  # noqa: E731
    pairs = [(seconds(ours), seconds(theirs) if theirs else 0.0) for _ in range(runs)]
    scale = 1e9 / COUNT
    return [a * scale for a, _ in pairs], [b * scale for _, b in pairs] if theirs else []


def cell(values: list[float]) -> str:
    if not values:
        return ""
    return f"{statistics.median(values):.2f} ({min(values):.2f} … {max(values):.2f})"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=7)
    parser.add_argument("names", nargs="*", default=list(sf.RNGS))
    args = parser.parse_args()

    print(f"{describe_machine()}; {describe_build()}; {_core.isa()}; NumPy {np.__version__}")
    out = np.ones(COUNT)
    constant = [1e9 * seconds(lambda: out.fill(0.5)) / COUNT for _ in range(args.runs)]
    print(f"median (least … greatest) of {args.runs} fills of {COUNT} values; a constant fill of float64 takes")
    print(f"{cell(constant)} ns\n")
    print("| generator | float64, ns | NumPy float64, ns | NumPy / ours | uint64, ns | float32, ns |")
    print("|---|---|---|---|---|---|")
    for name in args.names:
        ours, theirs = compare(name, "float64", args.runs)
        ratio = f"{statistics.median(b / a for a, b in zip(ours, theirs, strict=True)):.1f}" if theirs else ""
        wide, _ = compare(name, "uint64", args.runs)
        floats, _ = compare(name, "float32", args.runs)
        print(f"| `{name}` | {cell(ours)} | {cell(theirs)} | {ratio} | {cell(wide)} | {cell(floats)} |", flush=True)


if __name__ == "__main__":
    main()
