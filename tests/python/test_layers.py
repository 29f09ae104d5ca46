# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""scripts/check-layers.py on objects made here: what it passes, and what it fails on."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

CHECK = Path(__file__).resolve().parents[2] / "scripts" / "check-layers.py"
COMPILER = next((c for c in ("cc", "gcc", "clang") if shutil.which(c)), None)

pytestmark = pytest.mark.skipif(COMPILER is None or not shutil.which("nm"), reason="no C compiler or no nm")


def check(build: Path, **sources: str) -> subprocess.CompletedProcess[str]:
    """Compiles sources, which are named module__file, where CMake would, and runs the check on them."""
    for name, text in sources.items():
        module, file = name.split("__")
        folder = build / "csrc" / "CMakeFiles" / module
        folder.mkdir(parents=True, exist_ok=True)
        command = [str(COMPILER), "-c", "-x", "c", "-", "-o", str(folder / f"{file}.c.o")]
        subprocess.run(command, input=text + "\n", text=True, check=True)
    return subprocess.run([sys.executable, CHECK, build], capture_output=True, text=True)


def test_calls_down_the_modules_and_within_one_pass(tmp_path: Path) -> None:
    done = check(
        tmp_path,
        points__top="int middle(void); int top(void) { return middle(); }",
        points__middle="int bottom(void); int middle(void) { return bottom(); }",
        rng__bottom="int bottom(void) { return 1; }",
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_a_call_up_the_modules_fails(tmp_path: Path) -> None:
    done = check(
        tmp_path,
        rng__low="int high(void); int low(void) { return high(); }",
        points__high="int high(void) { return 1; }",
    )
    assert done.returncode == 1
    assert "rng/low needs high of points/high, which stands above it" in done.stderr


def test_a_circle_of_files_fails_and_is_named_call_by_call(tmp_path: Path) -> None:
    done = check(
        tmp_path,
        film__a="int b(void); int a(void) { return b(); }",
        film__b="int c(void); int b(void) { return c(); }",
        film__c="extern int table[]; int a(void); int c(void) { return a() + table[0]; }",
        film__d="int table[1];",
    )
    assert done.returncode == 1
    assert [line for line in done.stderr.splitlines() if "circle" in line] == [
        "film/a needs b of film/b, in a circle",
        "film/b needs c of film/c, in a circle",
        "film/c needs a of film/a, in a circle",
    ]


def test_a_circle_by_data_fails(tmp_path: Path) -> None:
    done = check(
        tmp_path,
        scene__a="extern int limit; int a(void) { return limit; }",
        scene__b="int a(void); int limit = 3; int b(void) { return a(); }",
    )
    assert done.returncode == 1
    assert "scene/a needs limit of scene/b, in a circle" in done.stderr


def test_a_folder_without_objects_is_no_success(tmp_path: Path) -> None:
    done = check(tmp_path)
    assert done.returncode == 1
    assert "no objects" in done.stderr
