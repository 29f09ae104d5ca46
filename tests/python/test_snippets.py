# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""What the README and the pages under docs/ show runs: Python snippets each on its own, examples of a
session page by page with what they print, and commands of `sunfleck` as quick as they can be made."""

import doctest
import json
import re
import shlex
import struct
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]

# Commands whose work is bounded by what `quick` adds. The others have tests of their own.
QUICK = ("render", "points", "plan")


def blocks(page: Path, *languages: str) -> list[str]:
    """The fenced blocks in one of these languages, in order."""
    found = re.findall(r"^```(\w+)\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    return [block for language, block in found if language in languages]


def named(*languages: str) -> dict[str, str]:
    return {
        f"{page.relative_to(ROOT)}-{number}": block
        for page in PAGES
        for number, block in enumerate(blocks(page, *languages))
    }


def commands(block: str) -> list[list[str]]:
    """The arguments of each line that runs sunfleck, with or without a prompt."""
    lines = [shlex.split(line.removeprefix("$ "), comments=True) for line in block.splitlines()]
    return [words[1:] for words in lines if words and Path(words[0]).name == "sunfleck"]


def quick(arguments: list[str]) -> list[str]:
    """The same with fewer pixels and less time, which later options on the line override."""
    if arguments[0] != "render":
        return arguments
    smaller = ["--width", "16", "--height", "12"]
    return arguments + smaller + (["--seconds", "0.2"] if "--seconds" in arguments else [])


SNIPPETS = named("python")
SESSIONS = {str(page.relative_to(ROOT)): "\n".join(blocks(page, "pycon")) for page in PAGES if blocks(page, "pycon")}
CONSOLE = {name: block for name, block in named("sh", "console", "bash").items() if commands(block)}


def test_there_are_snippets() -> None:
    assert len(SNIPPETS) >= 8
    assert "docs/tutorial.md" in SESSIONS
    assert sum(len(commands(block)) for block in CONSOLE.values()) >= 9


@pytest.mark.parametrize("name", SNIPPETS)
def test_snippet_runs(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        exec(compile(SNIPPETS[name], name, "exec"), {"__name__": "__main__"})


@pytest.mark.parametrize("name", SESSIONS)
def test_session_prints_what_the_page_says(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    examples = doctest.DocTestParser().get_doctest(SESSIONS[name], {}, name, name, 0)
    told: list[str] = []
    results = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(examples, out=told.append)
    assert results.attempted == len(examples.examples) > 0
    assert not results.failed, "".join(told)


def tetrahedron() -> bytes:
    """A GLB of four triangles."""
    positions = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1)
    buffer = positions + bytes((0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3))
    tree = {
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]},
            {"bufferView": 1, "componentType": 5121, "count": 12, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
        "buffers": [{"byteLength": len(buffer)}],
    }
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(buffer))
    return head + struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(buffer), b"BIN\0") + buffer


@pytest.mark.parametrize("name", CONSOLE)
def test_commands_run(name: str, tmp_path: Path) -> None:
    for model in ("model.glb", "room.glb"):
        (tmp_path / model).write_bytes(tetrahedron())
    for arguments in commands(CONSOLE[name]):
        if arguments[0] in QUICK:
            command = [sys.executable, "-m", "sunfleck", *quick(arguments)]
            done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
            assert done.returncode == 0, f"sunfleck {shlex.join(arguments)}\n{done.stderr}"


def heading_anchors(text: str) -> set[str]:
    """The names by which headings are linked to, as GitHub and the site make them."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    headings = re.findall(r"^#+ +(.*)$", text, re.MULTILINE)
    plain = [re.sub(r"\[(.*?)\]\(.*?\)|[`*]", lambda m: m[1] or "", heading) for heading in headings]
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in plain}


def test_heading_anchors_are_github_s() -> None:
    text = "# Do the error bars hold?\n```sh\n# no heading\n```\n## `sz`\n### [a](b.md), b\n"
    assert heading_anchors(text) == {"do-the-error-bars-hold", "sz", "a-b"}


def test_what_the_pages_link_to_is_there() -> None:
    pages = [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")]
    links = [
        (page, *link)
        for page in pages
        for link in re.findall(r"\]\(([^)#\s]*)(?:#([^)\s]+))?\)", page.read_text(encoding="utf-8"))
        if "://" not in link[0]
    ]
    assert len(links) > 20
    missing = []
    for page, path, anchor in links:
        target = page.parent / path if path else page
        if not target.exists() or (anchor and anchor not in heading_anchors(target.read_text(encoding="utf-8"))):
            missing.append(f"{page.name}: {path}#{anchor}")
    assert not missing
