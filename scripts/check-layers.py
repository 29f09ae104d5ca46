#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Fails on an #include or a symbol of the C library that points up its order of modules.

    check-layers.py [BUILD]     BUILD: a folder with compiled objects, whose symbols are read by nm

A module is a folder of csrc/. It may use itself and the modules before it, and the public headers
of these; a public header includes only those of its own module and of the modules before it.
"""

import re
import subprocess
import sys
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


def upward_symbols(build: Path) -> list[str]:
    """By object: what it defines is its module's, what it lacks must be of a module that is not above."""
    home: dict[str, str] = {}
    needed: list[tuple[str, str]] = []
    for path in sorted(build.rglob("*.o")):
        module = next((m for m in path.parts if m in ORDER and path.parent.name == m), None)
        if module is None:
            continue
        listing = subprocess.run(["nm", "-P", path], capture_output=True, text=True, check=True).stdout
        for name, kind, *_ in (line.split() for line in listing.splitlines()):
            if kind == "U":
                needed.append((module, name))
            elif kind.isupper():
                home[name] = module
    if not home:
        sys.exit(f"check-layers: no objects of csrc/ in {build}")
    upward = {(m, name) for m, name in needed if rank(home.get(name, m)) > rank(m)}
    return [f"{module} calls {name} of {home[name]}" for module, name in sorted(upward)]


def main() -> None:
    found = upward_includes()
    for build in sys.argv[1:]:
        found += upward_symbols(Path(build) / "csrc")
    if found:
        sys.exit("\n".join([*found, f"{len(found)} point up the order {' < '.join(ORDER)}"]))


if __name__ == "__main__":
    main()
