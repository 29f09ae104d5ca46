#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Fails on an #include or a symbol of the C library that points up its order, and on files that call in circles.

    check-layers.py [BUILD]     BUILD: a folder with compiled objects, whose symbols are read by nm

A module is a folder of csrc/. It may use itself and the modules before it, and the public headers
of these; a public header includes only those of its own module and of the modules before it. Within
a module the files have an order too, whichever it is: none may need a symbol of a file that needs one of
its own, directly or by way of others.
"""

import re
import subprocess
import sys
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CORE = ["base", "rng", "points", "mapping", "estimate", "integrate", "uniformity"]
ORDER = [*CORE, "scene", "film", "trace", "render", "image"]

# Public headers whose module is not their name's first word.
PUBLIC = {"elementary": "mapping", "discrete": "mapping", "lanczos": "mapping", "material": "scene", "exact": "base"}


def module_of(path: str) -> str:
    """The module of a file, by its path below csrc/ or, as it is included, below csrc/include/."""
    folder, _, name = path.removeprefix("include/").partition("/")
    if folder != "sunfleck":
        return folder
    word = re.split(r"[_.]", name)[0]
    return PUBLIC.get(word, word)


def rank(module: str) -> int:
    return ORDER.index(module)


def upward_includes() -> list[str]:
    found = []
    for path in sorted((ROOT / "csrc").rglob("*.[ch]*")):
        name = path.relative_to(ROOT / "csrc").as_posix()
        if name == "include/sunfleck/sunfleck.h" or path.suffix not in {".c", ".h", ".cpp"}:
            continue
        for line, text in enumerate(path.read_text().splitlines(), 1):
            include = re.match(r'\s*#\s*include "([\w/.]+/[\w.]+)"', text)
            if include and rank(module_of(include[1])) > rank(module_of(name)):
                found.append(f"csrc/{name}:{line}: {module_of(name)} includes {include[1]}")
    return found


def read_symbols(build: Path) -> tuple[dict[str, str], list[tuple[str, str]]]:
    """The file that defines a symbol, as module/name, and which file needs which; a kernel's objects are one file."""
    home: dict[str, str] = {}
    needed: list[tuple[str, str]] = []
    for path in sorted(build.rglob("*.o")):
        if path.parent.name not in ORDER:
            continue
        file = f"{path.parent.name}/{path.name.split('.')[0]}"
        listing = subprocess.run(["nm", "-P", path], capture_output=True, text=True, check=True).stdout
        for name, kind, *_ in (line.split() for line in listing.splitlines()):
            if kind == "U":
                needed.append((file, name))
            elif kind.isupper():
                home[name] = file
    if not home:
        sys.exit(f"check-layers: no objects of csrc/ in {build}")
    return home, [(file, name) for file, name in needed if home.get(name, file) != file]


def misplaced_symbols(build: Path) -> list[str]:
    """Symbols that point up the modules, and those that close a circle of files."""
    home, needed = read_symbols(build)
    found = {
        f"{file} needs {name} of {home[name]}, which stands above it"
        for file, name in needed
        if rank(module_of(home[name])) > rank(module_of(file))
    }
    calls: dict[str, set[str]] = {}
    for file, name in needed:
        calls.setdefault(file, set()).add(home[name])
    try:
        TopologicalSorter(calls).prepare()
    except CycleError as circle:  # of which each file is needed by the next
        for callee, caller in pairwise(circle.args[1]):
            names = sorted({name for file, name in needed if (file, home[name]) == (caller, callee)})
            found.add(f"{caller} needs {', '.join(names)} of {callee}, in a circle")
    return sorted(found)


def main() -> None:
    found = upward_includes()
    for build in sys.argv[1:]:
        found += misplaced_symbols(Path(build) / "csrc")
    if found:
        sys.exit("\n".join([*found, f"{len(found)} against the order {' < '.join(ORDER)}"]))


if __name__ == "__main__":
    main()
