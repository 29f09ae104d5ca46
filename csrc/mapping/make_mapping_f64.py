# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0
"""Writes mapping_f64.h: the inline mappings of include/sunfleck in double, formula for formula.

Run without arguments after a change to one of the headers; --check compares instead.
"""

import re
import sys
from pathlib import Path

HERE = Path(__file__).parent
INCLUDE = HERE.parent / "include/sunfleck"
SOURCES = ["mapping_pixel.h", "mapping_plane.h", "mapping_sphere.h", "mapping_lobe.h", "mapping_light.h"]
HEAD = """// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Made by make_mapping_f64.py from {names}: do not edit.
 * The same formulas in double, for the bulk calls; the comments are there. */
#ifndef SUNFLECK_MAPPING_F64_H
#define SUNFLECK_MAPPING_F64_H

#include "mapping/elementary_f64.h"
#include "mapping/lanczos_table_f64.h"
"""
RULES = [
    (r"/\*.*?\*/|//[^\n]*", ""),
    (r"#[^\n]*\n", ""),
    (r'extern "C" \{\n|^\}\n(?=\s*\Z)', ""),
    (r"\bfloat\b", "double"),
    (r"\b(sqrt|fabs|copysign)f\b", r"\1"),
    (r"\b(0x[0-9a-f.]+p[-+]?\d+|\d+\.?\d*(?:e[-+]?\d+)?)f\b", r"\1"),
    (r"\b(SF_PI|SF_UNIT_MAX|SF_LANCZOS_TERMS)_F\b", r"\1"),
    (r"\b(sf_lanczos_(?:table|lobes))\b", r"\1_f64"),
    (r"\b(sf_spherical_(?:triangle|rectangle))\b(?!\()", r"\1_f64"),
    (r"\b(sf_\w+)\(", r"\1_f64("),
    (r"[ \t]+\n", "\n"),
    (r"\n{2,}(?=    )", "\n"),
    (r"\n{2,}", "\n\n"),
]


def doubled(text: str) -> str:
    for pattern, replacement in RULES:
        text = re.sub(pattern, replacement, text, flags=re.DOTALL if pattern.startswith("/") else 0)
    return text.replace("\n}\n\n}\n", "\n}\n").strip() + "\n"


def main() -> int:
    made = HEAD.format(names=", ".join(SOURCES[:-1]) + "\n * and " + SOURCES[-1])
    for name in SOURCES:
        made += f"\n/* ---- {name} ---- */\n\n" + doubled((INCLUDE / name).read_text())
    made += "\n#endif\n"
    target = HERE / "mapping_f64.h"
    if "--check" in sys.argv:
        return int(target.read_text() != made)
    target.write_text(made)
    return 0


if __name__ == "__main__":
    sys.exit(main())
