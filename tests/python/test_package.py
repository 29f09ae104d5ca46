# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""package: doctests, stubs, and what importing brings along."""

import doctest
import importlib
import importlib.metadata
import pkgutil
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

import sunfleck as sf

MODULES = sorted(m.name for m in pkgutil.walk_packages(sf.__path__, "sunfleck.") if not m.name.endswith("__main__"))


@pytest.mark.parametrize("name", ["sunfleck", *MODULES])
def test_the_examples_in_docstrings_run(name: str) -> None:
    results = doctest.testmod(importlib.import_module(name), optionflags=doctest.IGNORE_EXCEPTION_DETAIL)
    assert results.failed == 0


def test_there_are_examples() -> None:
    modules = [importlib.import_module(name) for name in MODULES if not name.endswith("_core")]
    found = [test for module in modules for test in doctest.DocTestFinder().find(module) if test.examples]
    assert len(found) >= 20


def test_every_public_name_exists_and_is_documented() -> None:
    for name in sf.__all__:
        assert hasattr(sf, name), name
        if name not in (
            "AOVS",
            "MAPPINGS",
            "PATTERNS",
            "PIXEL_FILTERS",
            "RENDER_PATTERNS",
            "RNGS",
            "SCRAMBLES",
            "STOP_REASONS",
            "Progress",
        ):
            assert getattr(sf, name).__doc__, name
    assert sf.__version__.count(".") == 2
    assert issubclass(sf.Error, RuntimeError)


def test_the_committed_stub_is_the_extension_s() -> None:
    command = [sys.executable, "-m", "nanobind.stubgen", "-q", "-m", "sunfleck._core", "-O", "{folder}"]
    committed = Path(sf.__file__).with_name("_core.pyi")
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([part.format(folder=folder) for part in command], check=True)
        [made] = Path(folder).rglob("_core.pyi")
        assert made.read_text() == committed.read_text()


def test_importing_brings_nothing_heavy() -> None:
    heavy = ("OpenImageIO", "tqdm", "scipy", "matplotlib", "plotly")
    script = f"import sys, sunfleck; print([m for m in {heavy} if m in sys.modules])"
    assert subprocess.check_output([sys.executable, "-c", script], text=True) == "[]\n"


def test_the_licences_of_what_the_wheel_contains_come_with_it() -> None:
    texts = {
        Path(str(file)).name: file.read_text()
        for file in importlib.metadata.files("sunfleck") or ()
        if "licenses" in file.parts
    }
    assert {"LICENSE", "NOTICE", "nanobind.txt", "robin-map.txt"} <= set(texts)
    assert "Wenzel Jakob" in texts["nanobind.txt"]
    assert "Redistributions in binary form" in texts["nanobind.txt"]
    assert "Thibaut Goetghebuer-Planchon" in texts["robin-map.txt"]
    assert "copies or substantial" in texts["robin-map.txt"]
    assert "nanobind" in texts["NOTICE"]
    assert "robin_map" in texts["NOTICE"]
