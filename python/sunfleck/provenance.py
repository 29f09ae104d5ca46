# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""provenance: where and with what a figure was measured."""

from __future__ import annotations

import datetime
import os
import platform
import re
from collections.abc import Sequence
from pathlib import Path

from sunfleck import _core

__all__ = ["compiler", "processor", "provenance"]


def processor() -> str:
    """The processor, and how many of its threads this process may use.

    Returns
    -------
    str
        "NAME, N cores"
    """
    cpuinfo = Path("/proc/cpuinfo")
    match = re.search(r"model name\s*: (.*)", cpuinfo.read_text()) if cpuinfo.exists() else None
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return f"{match[1] if match else platform.machine()}, {cores} cores"


def compiler() -> str:
    """The compiler, as it signed the extension.

    Returns
    -------
    str
        "GCC: (…) 12.2.0", or "unknown compiler"
    """
    signed = re.search(rb"(GCC: \([^)]*\) [0-9.]+|clang version [0-9.]+)", Path(_core.__file__).read_bytes())
    return signed[1].decode() if signed else "unknown compiler"


def provenance(seeds: Sequence[int], dates: Sequence[str] = ()) -> str:
    """One line with processor, cores, compiler, instruction set, version, seeds and date.

    Parameters
    ----------
    seeds : sequence of int
        Those that the figure was measured with.
    dates : sequence of str
        Of the measurements; none means today.

    Returns
    -------
    str

    Examples
    --------
    >>> from sunfleck.provenance import provenance
    >>> "seeds 1 .. 8" in provenance(range(1, 9))
    True
    """
    named = f"seeds {seeds[0]} .. {seeds[-1]}" if len(seeds) > 1 else f"seed {seeds[0]}"
    date = " and ".join(dict.fromkeys([dates[0], dates[-1]])) if dates else datetime.date.today().isoformat()
    version = f"sunfleck {_core.version()} ({_core.isa()})"
    return f"{processor()}; {compiler()}; {version}; {named}; {date}"
