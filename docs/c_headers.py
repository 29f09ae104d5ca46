# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""The public C headers as reStructuredText, for the site's reference.

The headers are written to be read as they stand: plain comments whose columns mean something, one
comment for several functions. Here each comment goes with what follows it, up to the next blank line,
into one entry of Sphinx's C domain, which makes the names linked, indexed and searchable.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field


@dataclass
class Entry:
    """A comment's lines, and the declarations beneath it: (kind in the C domain, signature, source)."""

    comment: list[str]
    declarations: list[tuple[str, str, str]] = field(default_factory=list)


# ---- reading ----


def _comment(lines: list[str], at: int) -> tuple[list[str], int]:
    """The text of the comment that begins on line `at`, and the line after it."""
    end = at
    while "*/" not in lines[end]:
        end += 1
    text = [re.sub(r"^(/\*| \*/?) ?", "", line) for line in lines[at : end + 1]]
    text[-1] = text[-1].partition("*/")[0]
    return [line.rstrip() for line in text], end + 1


def _declaration(lines: list[str], at: int) -> tuple[str, int]:
    """The source from line `at` on to the end of its statement or body, with a comment behind it."""
    depth, end, open_comment = 0, at, False
    while True:
        code = re.sub(r"/\*.*?\*/", "", lines[end]) if not open_comment else lines[end].partition("*/")[2]
        open_comment = "/*" in code or (open_comment and "*/" not in lines[end])
        code = code.partition("/*")[0].rstrip()
        depth += code.count("{") - code.count("}")
        end += 1
        if depth == 0 and not open_comment and code.endswith((";", "}")):
            return "\n".join(lines[at:end]), end


def _classify(source: str) -> tuple[str, str]:
    """The kind and the signature."""
    code = " ".join(re.sub(r"/\*.*?\*/", "", source, flags=re.DOTALL).split())
    if found := re.match(r"#define (\w+(?:\([^)]*\))?)", code):
        return "macro", found[1]
    if found := re.match(r"typedef (struct|enum|union) (\w+)", code):
        return found[1], found[2]
    if found := re.match(r"typedef (.*);$", code):
        return "type", found[1]
    if found := re.match(r"(static const [^=]*?) ?=", code):
        return "var", found[1]
    signature = re.sub(r"^SF_INLINE ", "static inline ", code.removeprefix("SF_API "))
    return "function", re.split(r" \{|;", signature)[0]


def read_header(text: str) -> Iterator[Entry]:
    """What a header of this house's layout says, from the top."""
    text = re.sub(r"^#else\n.*?^#endif", "#endif", text, flags=re.MULTILINE | re.DOTALL)
    lines, at, entry = text.splitlines(), 0, Entry([])
    while at < len(lines):
        line = lines[at]
        if line.startswith("/*"):
            if entry.comment or entry.declarations:
                yield entry
            comment, at = _comment(lines, at)
            entry = Entry(comment)
        elif re.match(r"#(if|el|endif|include|error|pragma)|#define SUNFLECK_\w+_H$|//|extern \"C\"|\}$|$", line):
            if not line and (entry.comment or entry.declarations):
                yield entry
                entry = Entry([])
            at += 1
        else:
            source, at = (line, at + 1) if line.startswith("#define") else _declaration(lines, at)
            if line.startswith("#define") and "/*" in line and "*/" not in line:
                raise ValueError(f"a comment goes on behind a macro: {line}")
            entry.declarations.append((*_classify(source), source))
    if entry.comment or entry.declarations:
        yield entry


# ---- writing ----


def _escaped(text: str) -> str:
    """Text for reStructuredText, with the library's names as links and code in backquotes as code."""
    parts = re.split(r"(`[^`]+`|\b(?:sf|SF)_\w+)", text)
    for k, part in enumerate(parts):
        if k % 2 == 0:
            parts[k] = re.sub(r"([\\*`_|])", r"\\\1", part)
        elif part.startswith("`"):
            parts[k] = f"``{part.strip('`')}``"
        else:
            parts[k] = f"\\ :c:data:`{part}`\\ "
    return "".join(parts)


def _paragraphs(comment: list[str]) -> Iterator[list[str]]:
    """A comment's paragraphs in reStructuredText; those with columns of their own stay as they are."""
    for block in re.split(r"\n\s*\n", "\n".join(comment).strip("\n")):
        lines = block.split("\n")
        if any(re.search(r"^\s{2}|\S {2,}\S", line) for line in lines):
            yield ["::", "", *(f"   {line}" for line in lines), ""]
        elif block.strip():
            yield [_escaped(line) for line in lines] + [""]


def _remark(signature: str, source: str) -> list[str]:
    """The comment behind a function's declaration."""
    found = re.search(r"\);\s*/\*(.*?)\*/\s*$", source, re.DOTALL)
    name = re.search(r"(\w+)\(", signature)
    return [f"``{name[1]}``: {_escaped(' '.join(found[1].split()))}", ""] if found and name else []


def _kept_source(kind: str, sources: list[str]) -> list[str]:
    """The source of what is its own best description: structs, enums and macros with a value."""
    lines = "\n".join(sources).split("\n")
    if kind == "function" or (kind == "var" and len(lines) > 3):
        return []
    return [".. code-block:: c", "", *(f"   {line}" for line in lines), ""]


def write_entry(entry: Entry) -> list[str]:
    """reStructuredText; a comment that begins with "---- title ----" is a section."""
    made: list[str] = []
    comment = entry.comment
    if comment and (section := re.match(r"-{4} (.*?) -{4}$", comment[0])):
        title = section[1][0].upper() + section[1][1:]
        made += [_escaped(title), "^" * (2 * len(title) + 80), ""]  # longer than the title with its escapes
        comment = comment[1:]
    body = [line for paragraph in _paragraphs(comment) for line in paragraph]
    if not entry.declarations:
        return made + body
    kinds = {kind for kind, _, _ in entry.declarations}
    for kind in sorted(kinds, key=[kind for kind, _, _ in entry.declarations].index):
        same = [d for d in entry.declarations if d[0] == kind]
        head = f".. c:{kind}:: "
        made += [(" " * len(head) if k else head) + signature for k, (_, signature, _) in enumerate(same)] + [""]
        remarks = [line for _, signature, source in same for line in _remark(signature, source) if kind == "function"]
        content = body + remarks + _kept_source(kind, [source for _, _, source in same])
        made += [f"   {line}" if line else "" for line in content] + [""]
        body = []
    return made


def header_page(text: str) -> list[str]:
    """A header as lines of reStructuredText."""
    return [line for entry in read_header(text) for line in write_entry(entry)]
