# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Whether penumbra pays for what it does not use: its time with all modules, over that of a build without them.

    modules.py [--rounds N]

The second build, in build/modules/, is a copy of the source in which every kernel file of what penumbra
has no use for (fog, sky, round shapes, materials, lights by solid angle, the light tree, AOVs) holds
a table of null functions: a stage that called one would crash. Both are built alike, and render in
turn, each time in a process of its own.
"""

from __future__ import annotations

import argparse
import re
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

from measure import ROOT, describe_build, describe_machine, state

WORK = ROOT / "build/modules"
MODULES = ("fog", "sky", "round", "material", "light_shape", "light_tree", "aov")
SOURCES = ("CMakeLists.txt", "LICENSE", "NOTICE", "README.md", "cmake", "csrc", "pyproject.toml", "python")
TABLE = re.compile(r"^const (\w+) SF_AT_LEVEL\(\1\) = ", re.MULTILINE)
TIMED = """
import sys, time
sys.path.insert(0, sys.argv[1])
import sunfleck as sf
assert sf.__file__.startswith(sys.argv[1]), sf.__file__
scene, seconds = sf.scenes.penumbra(), []
for seed in range(9):
    start = time.perf_counter()
    sf.render(scene, 256, 256, spp=64, seed=seed)
    seconds.append(time.perf_counter() - start)
print(sorted(seconds)[4])
"""


def copy_source(empty: bool) -> Path:
    tree = WORK / ("without" if empty else "with")
    shutil.rmtree(tree, ignore_errors=True)
    tree.mkdir(parents=True)
    for name in SOURCES:
        (shutil.copytree if (ROOT / name).is_dir() else shutil.copy)(ROOT / name, tree / name)
    for module in MODULES if empty else ():
        path = tree / f"csrc/{module}_kernels.c"
        table = TABLE.search(path.read_text())
        assert table, path
        path.write_text(f'#include "{module}_kernels.h"\n\n{table[0]}{{0}};\n')
    return tree


def build(empty: bool) -> Path:
    tree = copy_source(empty)
    target = tree / "installed"
    pip = [sys.executable, "-m", "pip", "install", "-q", "--no-deps", "-C", f"build-dir={tree / 'build'}"]
    subprocess.run([*pip, "-t", str(target), str(tree)], check=True)
    return target


def seconds(installed: Path) -> float:
    line = [sys.executable, "-c", TIMED, str(installed)]
    return float(subprocess.run(line, cwd=WORK, check=True, capture_output=True, text=True).stdout)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=9)
    given = parser.parse_args()
    full, reduced = build(False), build(True)
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
