# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""What `import sunfleck` adds to `import numpy`, and how large the wheel is.

The two imports take turns in processes of their own, so that both see the same machine.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time

from measure import ROOT, describe_machine, state


def seconds_to_run(code: str) -> float:
    start = time.perf_counter()
    subprocess.run([sys.executable, "-c", code], check=True, cwd="/")
    return time.perf_counter() - start


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=21)
    args = parser.parse_args()

    print(describe_machine())
    seconds_to_run("import numpy, sunfleck")  # fills the disk cache
    numpy, added = [], []
    for _ in range(args.runs):
        numpy.append(seconds_to_run("import numpy"))
        added.append(seconds_to_run("import numpy, sunfleck") - numpy[-1])
    print(f"import numpy, with the interpreter's start: {state([1e3 * s for s in numpy])} ms")
    print(f"import sunfleck adds: {state([1e3 * s for s in added])} ms")
    print(f"as a ratio to the former: {state([a / n for a, n in zip(added, numpy, strict=True)])}")
    for wheel in sorted((ROOT / "build/wheel").glob("*.whl")):
        print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
