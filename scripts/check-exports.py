#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Fails where shared libraries export another set of symbols than the functions that the public headers declare.

check-exports.py LIBRARY …     the shared libraries of one build: core alone, or with render and image
"""

import re
import subprocess
import sys
from pathlib import Path

HEADERS = Path(__file__).resolve().parents[1] / "csrc/include/sunfleck"
RENDER = {"film", "material", "render", "scene"}  # headers of the component render; image's is image.h


def declared(components: set[str]) -> set[str]:
    """The functions of the headers of some components."""
    names: set[str] = set()
    for path in HEADERS.glob("*.h"):
        component = "render" if path.stem in RENDER else "image" if path.stem == "image" else "core"
        if component in components:
            names |= set(re.findall(r"^SF_API [^;{(]*?\b(sf_\w+)\(", path.read_text(), re.MULTILINE))
    return names


def exported(library: str) -> set[str]:
    listing = subprocess.run(["nm", "-D", "--defined-only", "-P", library], capture_output=True, text=True, check=True)
    return {line.split()[0] for line in listing.stdout.splitlines()}


def main() -> None:
    libraries = sys.argv[1:]
    components = {found[1] for name in libraries if (found := re.search(r"sunfleck_(core|render|image)\.", name))}
    if not components:
        sys.exit("check-exports: give the shared libraries libsunfleck_core.so, …")
    promised = declared(components)
    found: set[str] = set()
    for library in libraries:
        found |= exported(library)
    lines = [f"{name} is exported, and no public header declares it" for name in sorted(found - promised)]
    lines += [f"{name} is declared by a public header, and not exported" for name in sorted(promised - found)]
    if lines:
        sys.exit("\n".join([*lines, f"{len(lines)} symbols differ"]))


if __name__ == "__main__":
    main()
