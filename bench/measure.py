# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""What every figure is stated with: the machine, the build, the median and the spread."""

from __future__ import annotations

import os
import re
import statistics
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def describe_machine() -> str:
    """The processor, how many of its threads this process may use, and the load already on it."""
    cpuinfo = Path("/proc/cpuinfo")
    match = re.search(r"model name\s*: (.*)", cpuinfo.read_text()) if cpuinfo.exists() else None
    processor = match[1] if match else os.uname().machine
    return f"{processor}, {len(os.sched_getaffinity(0))} threads, load {os.getloadavg()[0]:.1f} before"


def describe_build(extension: Path) -> str:
    """The compiler, as it signed the extension, and the flags that csrc/CMakeLists.txt sets."""
    signed = re.search(rb"(GCC: \([^)]*\) [0-9.]+|clang version [0-9.]+)", extension.read_bytes())
    compiler = signed[1].decode() if signed else "unknown compiler"
    flags = re.search(r"set\(sunfleck_flags\s+([^)]*)\)", (ROOT / "csrc/CMakeLists.txt").read_text())
    return f"{compiler}, {' '.join(flags[1].split()) if flags else 'unknown flags'}"


def state(values: Sequence[float], digits: int = 3) -> str:
    """Median, and the least and the greatest: "36.2 (35.0 … 37.1, 7 runs)"."""
    middle, low, high = (f"{v:.{digits}g}" for v in (statistics.median(values), min(values), max(values)))
    return f"{middle} ({low} … {high}, {len(values)} runs)"
