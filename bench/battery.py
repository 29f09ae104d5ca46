# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Runs tests of dieharder (Debian's package) over every generator, and writes the table of docs/generators.md.

Every test starts a generator anew from the seed, so that a result depends on nothing that ran before. Results are
kept in build/battery/, a file for each generator and seed; a second run makes only those that are missing.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import threading
from collections.abc import Iterator

import numpy as np
from generators import nanoseconds
from measure import ROOT, describe_machine

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


def run_test(name: str, seed: int, test: tuple[int, int, int]) -> list[tuple[str, int, float, str]]:
    """The test's name, tuple length, p-value and dieharder's assessment, for each result it gives."""
    number, length, samples = test
    command = ["dieharder", "-g", "200", "-d", str(number), "-n", str(length), "-p", str(samples), "-D", "504"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=False) as process:

        def feed() -> None:
            try:
                for chunk in words(name, seed):
                    process.stdin.write(chunk.tobytes())
            except BrokenPipeError:
                pass

        feeder = threading.Thread(target=feed)
        feeder.start()
        printed = process.stdout.read().decode()
        process.wait()
        feeder.join()
    rows = [[field.strip() for field in line.split("|")] for line in printed.splitlines() if line.count("|") >= 5]
    return [(row[0], int(row[1]), float(row[4]), row[5]) for row in rows]


def results_of(name: str, seed: int) -> list[tuple[str, int, float, str]]:
    kept = KEPT / f"{name}-{seed}.json"
    if not kept.exists():
        results = [result for test in TESTS for result in run_test(name, seed, test)]
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_text(json.dumps(results))
        print(f"{name}, seed {seed}: {summary(results)}", flush=True)
    return [tuple(result) for result in json.loads(kept.read_text())]


def summary(results: list[tuple[str, int, float, str]]) -> str:
    failed = [result for result in results if result[3] == "FAILED"]
    names = sorted({test for test, *_ in failed})
    return f"{len(failed)} of {len(results)} failed" + (f": {', '.join(names)}" if names else "")


def table(seeds: list[int]) -> str:
    rates = {name: nanoseconds(sf.Rng(name, seed=seeds[0]), "float64") for name in sf.RNGS}
    lines = [
        "| generator | ns a float64 | failed | weak | of | which failed |",
        "|---|---|---|---|---|---|",
    ]
    for name in sf.RNGS:
        results = [result for seed in seeds for result in results_of(name, seed)]
        failed = sorted({test.replace("_", " ") for test, _, _, verdict in results if verdict == "FAILED"})
        count = {verdict: sum(result[3] == verdict for result in results) for verdict in ("FAILED", "WEAK")}
        cells = [f"`{name}`", f"{np.median(rates[name]):.2f}", count["FAILED"], count["WEAK"], len(results)]
        lines.append(f"| {' | '.join(map(str, cells))} | {', '.join(failed)} |")
    return "\n".join(lines)


def version() -> str:
    banner = subprocess.run(["dieharder", "-l"], capture_output=True, text=True, check=False).stdout
    return re.search(r"version ([0-9.]+)", banner)[1]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, nargs="+", default=[12345])
    args = parser.parse_args()

    machine = describe_machine()
    for name in sf.RNGS:
        for seed in args.seeds:
            results_of(name, seed)
    begin, end = "<!-- begin: bench/battery.py -->", "<!-- end -->"
    caption = f"dieharder {version()}, seeds {', '.join(map(str, args.seeds))}; rates on {machine}."
    page = PAGE.read_text()
    head, rest = page.split(begin)
    PAGE.write_text(f"{head}{begin}\n{table(args.seeds)}\n\n{caption}\n{end}{rest.split(end, 1)[1]}")


if __name__ == "__main__":
    main()
