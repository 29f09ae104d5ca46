# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Whether penumbra pays for what it does not use: its time with all modules, over that of a build without them.

    render_modules.py [--rounds N]

The second build, in build/modules/, is a copy of the source in which every kernel file of what penumbra
has no use for (fog, sky, round shapes, materials, lights by solid angle, the light tree, AOVs) holds
a table of null functions: a stage that called one would crash. Both are built alike, and render in
turn, each time in a process of its own.
"""

from __future__ import annotations

import argparse
import re
import statistics
from pathlib import Path

from measure import ROOT, describe_build, describe_machine, state
from variants import build, run

WORK = ROOT / "build/modules"
MODULES = ("fog", "sky", "round", "material", "light_shape", "light_tree", "aov")
TABLE = re.compile(r"^const (\w+) SF_AT_ISA\(\1\) = ", re.MULTILINE)
TIMED = """
import time
scene, seconds = sf.scenes.penumbra(), []
for seed in range(9):
    start = time.perf_counter()
    sf.render(scene, 256, 256, spp=64, seed=seed)
    seconds.append(time.perf_counter() - start)
print(sorted(seconds)[4])
"""


def empty(folder: Path) -> None:
    for module in MODULES:
        path = folder / f"csrc/trace/{module}_kernels.c"
        table = TABLE.search(path.read_text())
        assert table, path
        path.write_text(f'#include "{module}_kernels.h"\n\n{table[0]}{{0}};\n')


def seconds(installed: Path) -> float:
    return float(str(run(installed, TIMED)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=9)
    given = parser.parse_args()
    full, reduced = build(WORK / "with"), build(WORK / "without", empty)
    print(describe_machine())
    print(describe_build())
    ratios, times = [], []
    for k in range(given.rounds):
        first, second = (full, reduced) if k % 2 else (reduced, full)
        taken = {first: seconds(first), second: seconds(second)}
        ratios.append(taken[full] / taken[reduced])
        times.append(1e3 * taken[full])
    print(f"penumbra, 256 x 256, 64 samples a pixel: {statistics.median(times):.0f} ms with all modules")
    print(f"that over the time without them: {state(ratios)}")


if __name__ == "__main__":
    main()
