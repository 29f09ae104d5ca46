# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Compares the renderer with the plain path tracer on many random scenes, and prints a report.

run.py [--scenes N] [--first SEED] [--rate ALPHA] [--workers N]
run.py --scene SEED        one scene, with all its tests
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from typing import Any

import sunfleck as sf
from compare import TESTS_OF_SCENE, Case, Verdict, holm, judge
from reference import load


def judge_all(seeds: range, library: Any, workers: int) -> Iterator[Verdict]:
    """Verdicts in the order that they come; Ctrl-C and an early end leave the scenes not yet begun."""
    pool = ThreadPoolExecutor(workers)
    try:
        for done in as_completed([pool.submit(judge, seed, library) for seed in seeds]):
            yield done.result()
    finally:
        pool.shutdown(cancel_futures=True)


def report(verdicts: list[Verdict], rate: float) -> str:
    """What the scenes came to; every finding with its scene."""
    found = holm(verdicts, rate)
    seeds = sorted({verdict.seed for verdict, _ in found})
    broken = sorted(v.seed for v in verdicts if v.nonfinite)
    precision = sorted(v.precision for v in verdicts if v.precision > 0)
    lines = [
        f"{len(verdicts)} scenes, {TESTS_OF_SCENE} tests each, family-wise rate {rate:g}, sunfleck {sf.__version__}",
        f"{sum(v.drawn_again for v in verdicts)} scenes were drawn again; the first step's standard error of the"
        f" frame's mean is {100 * precision[len(precision) // 2]:.2g} % in the median" if precision else "",
        f"{len(seeds)} scenes differ: {seeds}",
    ]  # fmt: skip
    if broken:
        lines.append(f"samples that are not finite in scenes {broken}")
    for seed in seeds:
        lines += ["", Case(seed).describe()]
        mine = sorted((f for v, f in found if v.seed == seed), key=lambda f: f.p)
        lines += [f"  {finding}" for finding in mine[:6]]
        lines.append(f"  again:  python tests/differential/run.py --scene {seed}")
    return "\n".join(lines)


def _one(seed: int, library: Any) -> int:
    print(Case(seed).describe(), flush=True)
    verdict = judge(seed, library)
    print(f"first step: least p = {verdict.screen:.1e}; {verdict.nonfinite} samples that are not finite")
    for finding in verdict.findings:
        print(f"  {finding}")
    return bool(holm([verdict], 1e-3))


def _many(seeds: range, library: Any, workers: int) -> list[Verdict]:
    """The verdicts, told as they come; those so far, where Ctrl-C ends it."""
    verdicts: list[Verdict] = []
    start = time.monotonic()
    print(f"scenes {seeds.start} to {seeds.stop - 1}; Ctrl-C ends with a report", flush=True)
    try:
        for verdict in judge_all(seeds, library, workers):
            verdicts.append(verdict)
            least = min((f.p for f in verdict.findings), default=1.0)
            if least < 1e-5:
                print(f"scene {verdict.seed}: p = {least:.1e}", flush=True)
            if len(verdicts) % 50 == 0:
                print(f"{len(verdicts)} scenes, {time.monotonic() - start:.0f} s", flush=True)
    except KeyboardInterrupt:
        print("\ninterrupted: a report of the scenes so far", file=sys.stderr)
    return verdicts


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=2000)
    parser.add_argument("--first", type=int, default=1_000_000, help="seed of the first scene")
    parser.add_argument("--scene", type=int, help="the seed of the only one")
    parser.add_argument("--rate", type=float, default=1e-3, help="of false alarms in the whole run")
    parser.add_argument("--workers", type=int, default=2, help="scenes at a time")
    arguments = parser.parse_args()
    library = load()
    if arguments.scene is not None:
        return _one(arguments.scene, library)
    seeds = range(arguments.first, arguments.first + arguments.scenes)
    verdicts = _many(seeds, library, arguments.workers)
    if not verdicts:
        return 130
    print(report(verdicts, arguments.rate))
    return bool(holm(verdicts, arguments.rate) or any(v.nonfinite for v in verdicts))


if __name__ == "__main__":
    sys.exit(main())
