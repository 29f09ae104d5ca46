# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Runs tests of dieharder (Debian's package) over every generator, and writes the table of docs/generators.md.

Every test starts a generator anew from the seed, so that a result depends on nothing that ran before. Results are
kept in build/battery/, a file for each generator and seed; a second run makes only those that are missing.
"""

from __future__ import annotations

import argparse
import contextlib
import itertools
import json
import os
import re
import subprocess
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import BinaryIO

import numpy as np
from measure import ROOT, describe_machine
from rng_rate import nanoseconds

import sunfleck as sf

# Test number, tuple length or lag (0: the test's own), and p-values that its own uniformity is judged by.
# Left out: those that dieharder itself calls suspect (5, 6, 7, 14), and bytes and trees of 2^26 words (205, 207).
TESTS = [
    *((number, 0, 20) for number in (0, 1, 2, 3, 4, 8, 9, 10, 11, 12, 13, 15, 16, 100, 101, 102)),
    (17, 0, 2),
    *((200, bits, 20) for bits in (4, 8, 12)),
    *((201, dimensions, 20) for dimensions in (2, 5)),
    (202, 5, 20),
    *((203, lag, 20) for lag in (0, 15, 31)),
    (204, 0, 20),
    *((number, 0, 1) for number in (206, 208, 209)),
]
KEPT = ROOT / "build/battery"
PAGE = ROOT / "docs/generators.md"
CHUNK = 1 << 16

# A p-value below the first is a failure, one below the second is weak. Large ones are not counted: dieharder's
# Kolmogorov-Smirnov test gives 1 for few samples, to a cipher as well (control: its own generator 205, AES).
FAILED, WEAK = 1e-6, 1e-3
CONTROL = "AES (control)"


def words(name: str, seed: int) -> Iterator[np.ndarray]:
    """Draws as words of 32 bits: 64-bit ones low half first, 31-bit ones laid bit to bit."""
    rng = sf.Rng(name, seed=seed)
    draws = np.empty(CHUNK, dtype=np.uint32)
    if name not in ("minstd", "randu", "ran1", "ran2"):
        while True:
            yield rng.bits(out=draws)
    while True:
        # 32 draws of 31 bits are 31 words of 32.
        groups = rng.bits(out=draws).reshape(-1, 32).T
        yield np.stack([groups[k] >> k | groups[k + 1] << (31 - k) for k in range(31)], axis=1)


def feed(pipe: BinaryIO, name: str, seed: int) -> None:
    """Words until the test has enough."""
    with contextlib.suppress(BrokenPipeError), pipe:
        for chunk in words(name, seed):
            pipe.write(chunk.tobytes())


def run_test(name: str, seed: int, test: tuple[int, int, int]) -> list[tuple[str, int, float]]:
    """The test's name, tuple length and p-value, for each result it gives."""
    number, length, samples = test
    command = ["dieharder", "-d", str(number), "-n", str(length), "-p", str(samples), "-D", "504"]
    if name == CONTROL:
        done = subprocess.run([*command, "-g", "205", "-S", str(seed)], capture_output=True, check=True)
        printed = done.stdout.decode()
    else:
        process = subprocess.Popen([*command, "-g", "200"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        feeder = threading.Thread(target=feed, args=(process.stdin, name, seed))
        feeder.start()
        printed = process.stdout.read().decode()
        process.wait()
        feeder.join()
        process.stdout.close()
    rows = [[field.strip() for field in line.split("|")] for line in printed.splitlines() if line.count("|") >= 5]
    return [(row[0], int(row[1]), float(row[4])) for row in rows]


def results_of(name: str, seed: int) -> list[tuple[str, int, float]]:
    kept = KEPT / f"{name.split()[0]}-{seed}.json"
    if not kept.exists():
        results = [result for test in TESTS for result in run_test(name, seed, test)]
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_text(json.dumps(results))
        print(f"{name}, seed {seed}: {len(failures(results))} of {len(results)} failed", flush=True)
    return [(test, length, p) for test, length, p, *_ in json.loads(kept.read_text())]


def failures(results: list[tuple[str, int, float]]) -> list[str]:
    return [test for test, _, p in results if p < FAILED]


def row(name: str, seeds: list[int]) -> str:
    results = [result for seed in seeds for result in results_of(name, seed)]
    failed = failures(results)
    weak = sum(FAILED <= p < WEAK for _, _, p in results)
    rate = "" if name == CONTROL else f"{np.median(nanoseconds(sf.Rng(name, seed=seeds[0]), 'float64')):.2f}"
    label = name if name == CONTROL else f"`{name}`"
    which = ", ".join(sorted({test.replace("_", " ") for test in failed}))
    return f"| {label} | {rate} | {len(failed)} | {weak} | {len(results)} | {which} |"


def table(seeds: list[int]) -> str:
    head = "| generator | ns a float64 | failed | weak | of | which failed |\n|---|---|---|---|---|---|\n"
    return head + "\n".join(row(name, seeds) for name in (*sf.RNGS, CONTROL))


def version() -> str:
    banner = subprocess.run(["dieharder", "-l"], capture_output=True, text=True, check=False).stdout
    return re.search(r"version ([0-9.]+)", banner)[1]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, nargs="+", default=[12345])
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    args = parser.parse_args()

    machine = describe_machine()
    with ThreadPoolExecutor(args.jobs) as pool:
        for _ in pool.map(lambda pair: results_of(*pair), itertools.product((*sf.RNGS, CONTROL), args.seeds)):
            pass
    begin, end = "<!-- begin: bench/rng_battery.py -->", "<!-- end -->"
    caption = f"dieharder {version()}, seeds {', '.join(map(str, args.seeds))}; rates on {machine}."
    page = PAGE.read_text()
    head, rest = page.split(begin)
    PAGE.write_text(f"{head}{begin}\n{table(args.seeds)}\n\n{caption}\n{end}{rest.split(end, 1)[1]}")


if __name__ == "__main__":
    main()
