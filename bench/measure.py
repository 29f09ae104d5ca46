# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""What every figure is stated with: the machine, the build, the median and the spread."""

from __future__ import annotations

import os
import re
import statistics
from collections.abc import Sequence
from pathlib import Path

from sunfleck.provenance import compiler, processor

ROOT = Path(__file__).resolve().parent.parent


def describe_machine() -> str:
    """The processor, how many cores this process may use, and the load already on it."""
    return f"{processor()}, load {os.getloadavg()[0]:.1f} before"


def describe_build() -> str:
    """The compiler, as it signed the extension, and the flags that csrc/CMakeLists.txt sets."""
    flags = re.search(r"set\(sunfleck_flags\s+([^)]*)\)", (ROOT / "csrc/CMakeLists.txt").read_text())
    return f"{compiler()}, {' '.join(flags[1].split()) if flags else 'unknown flags'}"


def state(values: Sequence[float], digits: int = 3) -> str:
    """Median, and the least and the greatest: "36.2 (35.0 … 37.1, 7 runs)"."""
    middle, low, high = (f"{v:.{digits}g}" for v in (statistics.median(values), min(values), max(values)))
    return f"{middle} ({low} … {high}, {len(values)} runs)"
