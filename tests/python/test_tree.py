# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""The package's tree: modules import only what stands below them, few lie flat, and former names go on working."""

import ast
import importlib
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import sunfleck as sf

PACKAGE = Path(sf.__file__).parent

# From the bottom up: a module imports what stands before it, or in the same row. CONTRIBUTING.md tells of it.
ORDER = """
_core
_arguments error tolerance provenance exposure
rng
_seed bit_generator
points mapping discrete uniformity estimate
integrate integrands qmc
scene
scenes
io.files io.source io.text io.notices io.polygon
io.image
plot.figure
plot.heatmap plot.show plot.page
render
io.contents
io.gltf_data io.gltf_material io.gltf_mesh io.gltf io.mtl io.obj io.ply_rows io.ply io.stl
io.lamp
io.load
plot.plates
plot.gallery
_former
chart lab
"""
RANKS = {name: rank for rank, row in enumerate(ORDER.strip().splitlines()) for name in row.split()}
TOPS = ("", "__main__", "cli")  # the package itself and the command stand above all

# Within folders that are one row above, likewise.
WITHIN = {
    "scene": "material fog sky | mesh shapes | instances | bounds | scene",
    "render": "options summary | progress image | merge render",
    "estimate": "accumulator | moments running_sums | intervals",
    "cli": "exit_codes | chart gallery lab scene | command",
}


def module_of(path: Path) -> str:
    """ "io.load" of io/load.py, "render" of render/__init__.py."""
    return ".".join(path.relative_to(PACKAGE).with_suffix("").parts).removesuffix("__init__").removesuffix(".")


def imported(path: Path) -> Iterator[str]:
    """What a module imports of the package when it is imported: not for types alone, nor within functions."""
    waiting: list[ast.AST] = [ast.parse(path.read_text(encoding="utf-8"))]
    while waiting:
        for node in ast.iter_child_nodes(waiting.pop()):
            if isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] == "sunfleck":
                assert node.level == 0, path
                own = (node.module or "").removeprefix("sunfleck").removeprefix(".")
                names = [f"{own}.{alias.name}".removeprefix(".") for alias in node.names]
                yield from (name if is_module(name) else own for name in names)
            elif isinstance(node, ast.Import):
                yield from ("" for alias in node.names if alias.name == "sunfleck")
            elif not isinstance(node, ast.FunctionDef) and not is_for_types(node):
                waiting.append(node)


def is_for_types(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"


def is_module(name: str) -> bool:
    place = PACKAGE / name.replace(".", "/")
    return name == "_core" or place.is_dir() or place.with_suffix(".py").exists()


def rank(name: str) -> float:
    if name.partition(".")[0] in TOPS:
        return len(RANKS)
    return RANKS.get(name, RANKS.get(name.partition(".")[0], -1))


FILES = sorted(PACKAGE.rglob("*.py"))


@pytest.mark.parametrize("path", FILES, ids=module_of)
def test_a_module_imports_only_what_stands_below_it(path: Path) -> None:
    name = module_of(path)
    if name in ("io", "plot"):
        assert not list(imported(path))  # else whoever needs one of their modules would import all
        return
    assert rank(name) >= 0, f"{name} has no place in the order"
    # The laboratory uses the package as its users do, when the whole of it has been imported.
    allowed = len(RANKS) if name.partition(".")[0] == "lab" else rank(name)
    assert [other for other in imported(path) if rank(other) > allowed] == []


@pytest.mark.parametrize("folder", WITHIN)
def test_modules_of_a_folder_have_an_order(folder: str) -> None:
    ranks = {f"{folder}.{name}": k for k, row in enumerate(WITHIN[folder].split(" | ")) for name in row.split()}
    there = {module_of(path) for path in (PACKAGE / folder).glob("[!_]*.py")}
    assert there == set(ranks)
    for name in there:
        others = imported(PACKAGE / (name.replace(".", "/") + ".py"))
        assert [other for other in others if ranks.get(other, -1) >= ranks[name] or other == folder] == [], name


def test_few_modules_lie_flat() -> None:
    assert len(list(PACKAGE.glob("*.py"))) < 25


@pytest.mark.parametrize(
    ("former", "now"),
    [
        ("material", "scene.material"),
        ("mesh", "scene.mesh"),
        ("image", "io.image"),
        ("load", "io.load"),
        ("source", "io.source"),
        ("polygon", "io.polygon"),
        ("figure", "plot.figure"),
        ("heatmap", "plot.heatmap"),
        ("plates", "plot.plates"),
        ("gallery", "plot.gallery"),
    ],
)
def test_a_module_that_moved_is_imported_by_its_former_name_too(former: str, now: str) -> None:
    module = importlib.import_module(f"sunfleck.{former}")
    assert module is sys.modules[f"sunfleck.{now}"]
    assert hasattr(sf, former)


def test_functions_keep_the_names_that_modules_have_too() -> None:
    for name in ("gallery", "integrate", "load", "merge", "points", "render", "show"):
        assert callable(getattr(sf, name)), name
