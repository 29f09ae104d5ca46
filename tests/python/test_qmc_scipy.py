# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""qmc: SciPy's own tests of engines, from the SciPy that is installed, on every pattern.

Left out, and why (docs/qmc.md has the same list):

- test_sample with scrambles: the reference points are those of SciPy's; and but for sobol and halton,
  which SciPy has too: sobol's plain points in the order of the index, SciPy's in Gray code's.
- uniform with scrambles: nothing randomizes a grid.
- test_continuing, test_fast_forward of patterns that need their total: each call draws a set of its
  own, as LatinHypercube's do, whose tests leave them out too.
- orthogonal where the test asks for a count that is no square of a prime or a power of two, or for more
  dimensions than it has: test_1sample, test_reset, test_bounds, test_distribution.
- test_bounds of sz in 100 dimensions and its test_distribution in 50: it has 4.
- test_distribution of random and jittered, which do not stratify each coordinate to 1e-2 at 1,024
  points in 50 dimensions.
- test_optimizers: of uniform, which no exchange of coordinates changes; Lloyd's of hammersley and
  lattice, whose plain points are better spread by that measure than what it makes of them.
"""

from __future__ import annotations

import functools
import importlib
import warnings
from typing import Any

import numpy as np
import pytest

import sunfleck as sf
from sunfleck.qmc import Engine

try:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pytest.PytestUnknownMarkWarning)  # SciPy's own marks
        _module = importlib.import_module("scipy.stats.tests.test_qmc")
    _Suite: Any = _module.QMCEngineTests
except (ImportError, AttributeError) as error:
    pytest.skip(f"the SciPy that is installed ships no tests of its engines: {error}", allow_module_level=True)

NAMES = sorted(sf.PATTERNS)
SETS = {name for name in NAMES if Engine(name, 1)._needs_total}


def _takes(name: str, n: int, d: int) -> bool:
    try:
        return n in sf.valid_counts(name, n, d)
    except ValueError:  # so many dimensions
        return False


SIZES = {
    "test_1sample": (1, 2),
    "test_bounds": (512, 100),
    "test_reset": (8, 2),
    "test_distribution": (1024, 50),
    "test_optimizers": (64, 2),
    "test_consume_prng_state": (4, 2),
}


def _why_not(name: str, test: str, options: dict[str, Any]) -> str | None:
    """Why a test does not apply to a pattern; None: it does."""
    n, d = SIZES.get(test, (0, 1))
    if n and not _takes(name, n, d):
        return f"{name} has no set of {n} points in {d} dimensions"
    if name in SETS and test in ("test_continuing", "test_fast_forward"):
        return "each call draws a set of its own"
    if test == "test_sample" and (name not in ("sobol", "halton") or options["scramble"]):
        return "the reference points are those of SciPy's scrambles"
    if test == "test_distribution" and name in ("random", "jittered"):
        return f"{name} does not stratify a coordinate to 1e-2 at 1,024 points in 50 dimensions"
    if test == "test_optimizers" and (name == "uniform" or (name, options["optimization"]) in SPREAD):
        return "the plain points are too well spread to be bettered"
    return None


SPREAD = {("hammersley", "lloyd"), ("lattice", "lloyd")}


def _guarded(name: str, test: str) -> Any:
    """SciPy's test, with its parameters, that is skipped where it does not apply."""
    original = getattr(_Suite, test)

    @functools.wraps(original)
    def guarded(self: Any, **options: Any) -> None:
        if reason := _why_not(name, test, options):
            pytest.skip(reason)
        original(self, **options)

    return guarded


def _suite_of(name: str) -> Any:
    """SciPy's class for one pattern."""
    members: dict[str, Any] = {
        "qmce": staticmethod(functools.partial(Engine, name)),
        "can_scramble": name != "uniform",
        "__doc__": f"SciPy's tests of {name}.",
    }
    if name == "halton":
        members["unscramble_nd"] = _module.TestHalton.unscramble_nd
    if name == "sobol":
        gray = np.arange(8) ^ np.arange(8) >> 1  # SciPy's i-th point is ours of index gray(i)
        members["unscramble_nd"] = _module.TestSobol.unscramble_nd[np.argsort(gray)]
    tests = [test for test in dir(_Suite) if test.startswith("test_")]
    return type(f"Test{name.capitalize()}", (_Suite,), members | {test: _guarded(name, test) for test in tests})


def test_the_suite_is_scipys() -> None:
    assert set(SIZES) | {"test_0dim", "test_0sample", "test_sample"} <= set(dir(_Suite))


for _name in NAMES:
    globals()[f"Test{_name.capitalize()}"] = _suite_of(_name)
