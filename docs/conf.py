# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""The site: `make docs` builds it into build/site/.

Sphinx, as it reads the pages of docs/ as they are (MyST), the docstrings (autodoc and napoleon) and has
a C domain; Furo, as its pages load nothing from elsewhere. The headers are read by c_headers.py and
not by Doxygen, whose own markup they do without.

Which pages there are is found out here: a page of docs/ needs no entry anywhere, but takes the place
that docs/README.md gives it. Pages of the reference are made in docs/reference/, which git ignores.
"""

from __future__ import annotations

import contextlib
import importlib
import io
import os
import pkgutil
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

DOCS = Path(__file__).resolve().parent
ROOT = DOCS.parent
HEADERS = ROOT / "csrc/include/sunfleck"
sys.path.insert(0, str(DOCS))

from c_headers import header_page  # noqa: E402
from docutils import nodes  # noqa: E402
from docutils.statemachine import StringList  # noqa: E402
from sphinx.pycode import ModuleAnalyzer  # noqa: E402
from sphinx.util.docutils import SphinxDirective  # noqa: E402

import sunfleck as sf  # noqa: E402
from sunfleck import cli  # noqa: E402

project, author, copyright = "Sunfleck", "The Sunfleck developers", "2026 The Sunfleck developers"
version = release = sf.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
exclude_patterns = ["README.md"]  # the table of pages, for those who read them in the repository
myst_heading_anchors = 3
default_role = "py:obj"
napoleon_google_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False
autodoc_typehints = "none"
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True}
maximum_signature_line_length = 88
add_module_names = False

html_theme = "furo"
html_title = f"Sunfleck {version}"
html_static_path = ["site"]
html_css_files = ["sunfleck.css"]
html_copy_source = False
html_show_sphinx = False

START = ("tutorial", "which-pattern", "building")
SEEN = ("chart", "gallery", "lab")

# ---- the reference: a page for each module, made anew where it has changed ----


def write(name: str, lines: list[str], suffix: str = ".rst") -> str:
    """Writes a page of docs/reference/, and returns its name."""
    path = DOCS / "reference" / f"{name}{suffix}"
    path.parent.mkdir(parents=True, exist_ok=True)
    text = "\n".join(lines) + "\n"
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")
    return f"reference/{name}"


def titled(title: str, underline: str = "=") -> list[str]:
    return [title, underline * len(title), ""]


def modules() -> Iterator[ModuleType]:
    """The package's modules; of a folder that says what it offers the whole, of another each module in it."""
    for info in pkgutil.iter_modules(sf.__path__, "sunfleck."):
        if info.name.startswith("sunfleck._"):
            continue
        module = importlib.import_module(info.name)
        if not info.ispkg or hasattr(module, "__all__"):
            yield module
        else:
            yield from (importlib.import_module(m.name) for m in pkgutil.iter_modules(module.__path__, f"{info.name}."))


def public_names() -> dict[ModuleType, list[tuple[str, Any]]]:
    """Of each module the names by which its things are had, "points" or "mapping.triangle", and those."""
    found: dict[ModuleType, list[tuple[str, Any]]] = {}
    for module in modules():
        own = module.__name__.removeprefix("sunfleck.")
        is_public = own == "qmc" or (own in sf.__all__ and getattr(sf, own) is module)
        for name in getattr(module, "__all__", []):
            thing = getattr(module, name)
            if name in sf.__all__ and getattr(sf, name) is thing:
                found.setdefault(module, []).append((name, thing))
            elif is_public:
                found.setdefault(module, []).append((f"{own}.{name}", thing))
    return found


def first_line(thing: Any) -> str:
    """A line about it: itself, or the first of its docstring."""
    return thing if isinstance(thing, str) else (thing.__doc__ or "").partition("\n")[0]


def said_of(module: ModuleType, name: str) -> list[str]:
    """What the source says beneath a constant: the module's, or that of a module in its folder."""
    places = [module.__name__]
    places += [info.name for info in pkgutil.iter_modules(getattr(module, "__path__", []), f"{module.__name__}.")]
    comments = (ModuleAnalyzer.for_module(place).find_attr_docs().get(("", name), []) for place in places)
    return next(filter(None, comments), [])


def constant(module: ModuleType, name: str, thing: Any) -> list[str]:
    """What the source says beneath it; a dictionary as a table of names and lines about them."""
    said = said_of(module, name)
    made = [f".. py:data:: {name}", "", *(f"   {line}" for line in said), ""]
    if not isinstance(thing, dict):
        return [*made, "   .. code-block:: python", "", f"      {thing!r}", ""]
    made += ["   .. list-table::", "      :widths: 25 75", ""]
    for key, line in thing.items():
        made += [f"      * - ``{key}``", "        - " + re.sub(r"([\\*`_|])", r"\\\1", first_line(line))]
    return [*made, ""]


def python_page(module: ModuleType, names: list[tuple[str, Any]]) -> str:
    title = module.__name__.rpartition(".")[2]
    lines = titled(f"{title} in Python")
    lines += [f".. automodule:: {module.__name__}", "   :no-members:", "   :no-index:", ""]
    for full, thing in names:
        place, _, name = f"sunfleck.{full}".rpartition(".")
        lines += [f".. currentmodule:: {place}", ""]
        if isinstance(thing, type):
            lines += [f".. autoclass:: {name}", ""]
        elif isinstance(thing, sf.mapping.Mapping):
            continue  # all are in the table of MAPPINGS
        elif callable(thing):
            lines += [f".. autofunction:: {name}", ""]
        else:
            lines += constant(module, name, thing)
    return write(f"python/{title}", lines)


def c_page(header: Path) -> str:
    parts = [header, *sorted(HEADERS.glob(f"{header.stem}_*.h"))]
    lines = titled(f"{header.stem} in C")
    for part in parts:
        lines += [*titled(f"sunfleck/{part.name}", "-"), f".. c-header:: {part.relative_to(ROOT)}", ""]
    return write(f"c/{header.stem}", lines)


def command_line_page() -> str:
    lines = titled("Command line")
    for name, text in cli_help().items():
        lines += [*titled(name, "-"), ".. code-block:: text", "", *(f"   {line}" for line in text.splitlines()), ""]
    return write("command-line", lines)


def said(*arguments: str) -> str:
    """What the command prints."""
    with contextlib.redirect_stdout(io.StringIO()) as printed, contextlib.suppress(SystemExit):
        cli.main(arguments)
    return printed.getvalue()


def cli_help() -> dict[str, str]:
    """What `sunfleck --help` and each command's say."""
    os.environ["COLUMNS"], os.environ["NO_COLOR"] = "100", "1"
    top = said("--help")
    names = re.findall(r"^    (\w+) ", top.partition("  COMMAND\n")[2], re.MULTILINE)
    assert names, "sunfleck --help lists no commands"
    return {"sunfleck": top} | {f"sunfleck {name}": said(name, "--help") for name in names}


def reference_pages() -> dict[str, list[str]]:
    """Pages by caption; mapping_plane.h and its like are on the page of mapping.h."""
    names = {header.stem for header in HEADERS.glob("*.h") if not header.stem.startswith("exact_")}
    names -= {"sunfleck", "lanczos_table"}  # the umbrella, and a table that is generated
    own = sorted(name for name in names if not any(name.startswith(f"{other}_") for other in names))
    return {
        "Python reference": [python_page(module, things) for module, things in public_names().items()],
        "C reference": [c_page(HEADERS / f"{name}.h") for name in own],
    }


REFERENCE = reference_pages()
ELSEWHERE = [command_line_page()] + [
    write(page, [f"# {page}"], ".md")  # in whose place read_page puts the file
    for page in ("CONTRIBUTING", "CHANGELOG")
]

# ---- the front page, and what is in the margin ----


def prose_pages() -> dict[str, list[str]]:
    """The pages of docs/ by caption: modules as docs/README.md has them, then whatever it lacks."""
    there = sorted(page.stem for page in DOCS.glob("*.md") if page.stem not in ("index", "README"))
    listed = re.findall(r"\]\(([\w-]+)\.md\)", (DOCS / "README.md").read_text(encoding="utf-8"))
    ordered = [*START, *SEEN, *dict.fromkeys(listed), *there]
    kept = [page for page in dict.fromkeys(ordered) if page in there]
    return {
        "Start": [page for page in kept if page in START],
        "See": [page for page in kept if page in SEEN],
        "Modules": [page for page in kept if page not in START + SEEN],
    }


def toctree(caption: str, pages: list[str]) -> str:
    """Pages of the reference are listed by their module alone."""
    listed = "\n".join(f"{page.rpartition('/')[2]} <{page}>" if page.count("/") == 2 else page for page in pages)
    return f"```{{toctree}}\n:hidden:\n:caption: {caption}\n:maxdepth: 1\n\n{listed}\n```\n" if pages else ""


def top_page(name: str) -> str:
    """A page of the repository's top, its links as docs/ and docs/reference/ have them."""
    text = (ROOT / f"{name}.md").read_text(encoding="utf-8")
    text = re.sub(r"\]\((?![a-z]+:|#|docs/|(?:CONTRIBUTING|CHANGELOG)\.md)", "](/../", text)
    text = re.sub(r"\]\((?=CONTRIBUTING|CHANGELOG)", "](/reference/", text)
    return text.replace("](docs/README.md)", "](/index.md)").replace("](docs/", "](/")


def front_page() -> str:
    """The project's README and the tables of contents."""
    text = top_page("README").replace("](/index.md)", "](#modules)")
    prose = prose_pages()
    modules = "\n".join(f"- [{page}]({page}.md)" for page in prose["Modules"])
    contents = [toctree(caption, pages) for caption, pages in {**prose, **REFERENCE}.items()]
    contents.append(toctree("More", ELSEWHERE))
    return f"{text}\n## Modules\n\n{modules}\n\n" + "\n".join(contents)


def reference_of(page: str) -> str:
    """A module's page ends with where its reference is."""
    links = [
        f"[{caption.split()[0]}]({made}.rst)"
        for caption, pages in REFERENCE.items()
        for made in pages
        if made.rpartition("/")[2] == page
    ]
    return f"\n\n---\n\nReference: {', '.join(links)}\n" if links else ""


def read_page(app: Any, name: str, source: list[str]) -> None:
    if name == "index":
        source[0] = front_page()
    elif name in ELSEWHERE[1:]:
        source[0] = top_page(name.rpartition("/")[2])
    elif "/" not in name:
        source[0] += reference_of(name)


def plain_docstring(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Bars are absolute values, and references are numbered by docstring: neither is so in Sphinx."""
    example = False
    for k, line in enumerate(lines):
        example = line.lstrip().startswith(">>>") or (example and bool(line.strip()))
        if not example:
            line = re.sub(r"(?<!\\)\|", r"\|", line)
            lines[k] = re.sub(r"^\.\. (?=\[\d+\] )|(?<=\d\])_", "", line)  # as text, without a link


def always_read(app: Any, env: Any, added: set[str], changed: set[str], removed: set[str]) -> list[str]:
    """Pages whose source is elsewhere."""
    return ["index", *ELSEWHERE[1:]]


class CHeader(SphinxDirective):
    """`c-header`: what a header says; takes its path in the repository."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        path = ROOT / self.arguments[0]
        self.env.note_dependency(str(path))
        lines = StringList(header_page(path.read_text(encoding="utf-8")), source=str(path))
        return self.parse_text_to_nodes(lines, allow_section_headings=True)


def setup(app: Any) -> None:
    app.add_directive("c-header", CHeader)
    app.connect("env-get-outdated", always_read)
    app.connect("source-read", read_page)
    app.connect("autodoc-process-docstring", plain_docstring, priority=400)  # before napoleon
