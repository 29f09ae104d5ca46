# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Compares the renderer with the plain path tracer on many random scenes, and prints a report.

run.py [--scenes N] [--first SEED] [--rate ALPHA] [--workers N] [--effort X]
run.py --scene SEED        one scene, with all its tests
"""

from __future__ import annotations

import argparse
import queue
import signal
import sys
import threading
import time
from collections.abc import Iterator

import sunfleck as sf
from compare import TESTS_OF_SCENE, Case, Verdict, holm
from worker import Worker


def judge_all(seeds: range, workers: int, effort: float = 1.0) -> Iterator[Verdict]:
    """Verdicts in the order that they come, of scenes judged in so many processes."""
    waiting, done, threads = iter(seeds), queue.Queue[Verdict](), []
    crew = [Worker(effort) for _ in range(workers)]
    lock = threading.Lock()

    def work(worker: Worker) -> None:
        while True:
            with lock:
                seed = next(waiting, None)
            if seed is None:
                return
            done.put(worker.judge(seed))

    try:
        for worker in crew:
            threads.append(threading.Thread(target=work, args=(worker,), daemon=True))
            threads[-1].start()
        for _ in seeds:
            yield done.get()
    finally:
        with lock:
            waiting = iter(range(0))
        for worker in crew:
            worker.stop()
        for thread, worker in zip(threads, crew, strict=False):
            thread.join()
            worker.close()


def report(verdicts: list[Verdict], rate: float) -> str:
    """What the scenes came to; every finding with its scene."""
    found = holm(verdicts, rate)
    seeds = sorted({verdict.seed for verdict, _ in found})
    precision = sorted(v.precision for v in verdicts if v.precision > 0)
    lines = [
        f"{len(verdicts)} scenes, {TESTS_OF_SCENE} tests each, family-wise rate {rate:g}, sunfleck {sf.__version__}",
        f"{sum(v.drawn_again for v in verdicts)} scenes were drawn again; the first step's standard error of the"
        f" frame's mean is {100 * precision[len(precision) // 2]:.2g} % in the median" if precision else "",
        f"{len(seeds)} scenes differ: {seeds}",
    ]  # fmt: skip
    for verdict in verdicts:
        if verdict.broken:
            lines += ["", Case(verdict.seed).describe(), f"  {verdict.broken}"]
    for seed in seeds:
        lines += ["", Case(seed).describe()]
        mine = sorted((f for v, f in found if v.seed == seed), key=lambda f: f.p)
        lines += [f"  {finding}" for finding in mine[:6]]
        lines.append(f"  again:  python tests/differential/run.py --scene {seed}")
    return "\n".join(lines)


def _one(seed: int, effort: float) -> int:
    print(Case(seed).describe(), flush=True)
    (verdict,) = judge_all(range(seed, seed + 1), 1, effort)
    print(f"first step: least p = {verdict.screen:.1e}; {verdict.broken or 'all samples finite'}")
    for finding in verdict.findings:
        print(f"  {finding}")
    return bool(holm([verdict], 1e-3) or verdict.broken)


def _many(seeds: range, workers: int, effort: float) -> list[Verdict]:
    """The verdicts, told as they come; those so far, where Ctrl-C ends it."""
    verdicts: list[Verdict] = []
    start = time.monotonic()
    print(f"scenes {seeds.start} to {seeds.stop - 1}; Ctrl-C ends with a report", flush=True)
    try:
        for verdict in judge_all(seeds, workers, effort):
            verdicts.append(verdict)
            least = min((f.p for f in verdict.findings), default=1.0)
            if least < 1e-5 or verdict.broken:
                print(f"scene {verdict.seed}: {verdict.broken or f'p = {least:.1e}'}", flush=True)
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
    parser.add_argument("--effort", type=float, default=1.0, help="multiplies the samples of all sides")
    arguments = parser.parse_args()
    signal.signal(signal.SIGINT, signal.default_int_handler)  # shells have what runs in the background ignore it
    if arguments.scene is not None:
        return _one(arguments.scene, arguments.effort)
    seeds = range(arguments.first, arguments.first + arguments.scenes)
    verdicts = _many(seeds, arguments.workers, arguments.effort)
    if not verdicts:
        return 130
    print(report(verdicts, arguments.rate))
    return bool(holm(verdicts, arguments.rate) or any(v.broken for v in verdicts))


if __name__ == "__main__":
    sys.exit(main())
