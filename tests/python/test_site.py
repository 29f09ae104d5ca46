# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""The site's reading of the C headers: docs/c_headers.py. `make docs` checks all else, as it takes no warning."""

import importlib.util
import re
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]
HEADERS = [h for h in sorted((ROOT / "csrc/include/sunfleck").glob("*.h")) if not h.name.startswith("exact_")]


@pytest.fixture(scope="module")
def c_headers() -> ModuleType:
    spec = importlib.util.spec_from_file_location("c_headers", ROOT / "docs/c_headers.py")
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look there
    spec.loader.exec_module(module)
    return module


HEADER = """\
// SPDX-License-Identifier: Apache-2.0

/* thing: about it, and about `out`. */
#ifndef SUNFLECK_THING_H
#define SUNFLECK_THING_H

#define SF_THINGS 3u /* of them */

/* Kept as it is:
 *
 * one    1
 * other  2 */
typedef struct sf_thing {
    int one; /* which is
                1 */
} sf_thing;

/* Both of them, as sf_thing has it. */
void sf_thing_fill(sf_thing *thing, size_t count,
                   float *out);
size_t sf_thing_size(void); /* in words */

static inline int sf_thing_one(const sf_thing *thing) {
    /* Not of the reference. */
    return thing->one;
}
#endif
"""


def test_a_comment_goes_with_all_that_follows_it(c_headers: ModuleType) -> None:
    entries = list(c_headers.read_header(HEADER))
    assert [[(kind, signature) for kind, signature, _ in entry.declarations] for entry in entries] == [
        [],
        [("macro", "SF_THINGS")],
        [("struct", "sf_thing")],
        [
            ("function", "void sf_thing_fill(sf_thing *thing, size_t count, float *out)"),
            ("function", "size_t sf_thing_size(void)"),
        ],
        [("function", "static inline int sf_thing_one(const sf_thing *thing)")],
    ]
    assert [entry.comment for entry in entries] == [
        ["thing: about it, and about `out`."],
        [],
        ["Kept as it is:", "", "one    1", "other  2"],
        ["Both of them, as sf_thing has it."],
        [],
    ]


def test_columns_stay_and_names_are_linked(c_headers: ModuleType) -> None:
    page = "\n".join(c_headers.header_page(HEADER))
    assert "about ``out``" in page
    assert "   ::\n\n      one    1\n      other  2\n" in page
    assert ":c:data:`sf_thing`" in page
    assert "``sf_thing_size``: in words" in page
    assert "Not of the reference" not in page


@pytest.mark.parametrize("path", HEADERS, ids=lambda path: path.name)
def test_the_reference_has_every_name_of_a_header(c_headers: ModuleType, path: Path) -> None:
    """Against another way of finding them: what is left of the code outside of braces and parentheses."""
    text = path.read_text(encoding="utf-8")
    page = "\n".join(c_headers.header_page(text))
    code = re.sub(r"/\*.*?\*/|//[^\n]*|\"C\" \{", "", text, flags=re.DOTALL)
    macros = set(re.findall(r"^#define (SF_\w+)", code, re.MULTILINE))
    code = re.sub(r"^#(?:.*\\\n)*.*$", "", code, flags=re.MULTILINE)
    while (bare := re.sub(r"\{[^{}]*\}|\[[^\[\]]*\]", "", code)) != code:
        code = bare
    functions = set(re.findall(r"\b(sf_\w+)\s*\(", code))
    types = set(re.findall(r"typedef [^;(]*?\b(sf_\w+);", code)) | set(re.findall(r"\(\*(sf_\w+)\)", code))
    signatures = [signature for entry in c_headers.read_header(text) for _, signature, _ in entry.declarations]
    assert [signature for signature in signatures if signature not in page] == []
    named = (re.search(r"\(\*(\w+)\)|(\w+)(?:\(|\[|$)", signature) for signature in signatures)
    declared = {found[1] or found[2] for found in named if found}
    assert macros | functions | types <= declared
    if path.name not in ("sunfleck.h", "lanczos_table.h"):
        assert functions
