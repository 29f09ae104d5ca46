# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Builds of the package from changed copies of its source, to time one against another."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from measure import ROOT

SOURCES = ("CMakeLists.txt", "LICENSE", "NOTICE", "README.md", "cmake", "csrc", "pyproject.toml", "python")
IMPORT = """
import sys
sys.path.insert(0, sys.argv[1])
import sunfleck as sf
assert sf.__file__.startswith(sys.argv[1]), sf.__file__
"""


def build(folder: Path, change: Callable[[Path], None] | None = None) -> Path:
    """Copies the source into the folder, changes the copy, and installs the package from it; where to, is returned."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name in SOURCES:
        (shutil.copytree if (ROOT / name).is_dir() else shutil.copy)(ROOT / name, folder / name)
    if change:
        change(folder)
    target = folder / "installed"
    pip = [sys.executable, "-m", "pip", "install", "-q", "--no-deps", "-C", f"build-dir={folder / 'build'}"]
    subprocess.run([*pip, "-t", str(target), str(folder)], check=True)
    return target


def run(installed: Path, program: str) -> object:
    """What the program prints, as JSON, in a process of its own where `sf` is that build."""
    line = [sys.executable, "-c", IMPORT + program, str(installed)]
    done = subprocess.run(line, cwd=installed, check=True, capture_output=True, text=True)
    return json.loads(done.stdout)
