# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""discrete: alias tables and piecewise constant densities from Python."""

from typing import Any

import numpy as np
import pytest

import sunfleck as sf

WEIGHTS = np.array([0.5, 0, 2, 1, 0.25, 0])
GRID = np.arange(12.0).reshape(3, 4) % 5


@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_a_table_draws_in_proportion(dtype: str) -> None:
    table = sf.AliasTable(WEIGHTS)
    assert len(table) == 6
    u = sf.points("uniform", 2**16, d=1, dtype=dtype)[:, 0]
    index = table.sample(u)
    assert index.dtype == np.uint32
    # Equidistant values: each of an entry's at most 6 runs is off by one at either end.
    assert np.abs(np.bincount(index, minlength=6) - 2**16 * WEIGHTS / WEIGHTS.sum()).max() <= 12
    assert table.pdf(np.arange(6)) == pytest.approx(WEIGHTS / WEIGHTS.sum())
    positive = np.flatnonzero(WEIGHTS)
    assert np.array_equal(table.sample(table.invert(positive)), positive)


@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_a_line_maps_strata_to_strata(dtype: str) -> None:
    density = sf.PiecewiseConstant1D(WEIGHTS)
    u = sf.points("jittered", 4096, d=1, dtype=dtype)[:, 0]
    x = density.sample(u.reshape(64, 64))
    assert x.dtype == dtype
    assert x.shape == (64, 64)
    assert np.all(np.diff(x.ravel()[np.argsort(u)]) >= 0)
    assert np.all(density.pdf(x) > 0)
    # x is rounded by eps / 2, and u changes by the density, at most 3.2, times that.
    assert np.abs(density.invert(x).ravel() - u).max() <= 4 * np.finfo(dtype).eps


@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_a_grid_is_sampled_by_its_cells(dtype: str) -> None:
    density = sf.PiecewiseConstant2D(GRID)
    u = sf.points("sobol", 2**16, dtype=dtype)
    x = density.sample(u)
    hits, _, _ = np.histogram2d(x[:, 1], x[:, 0], bins=(3, 4), range=((0, 1), (0, 1)))
    # The cells' pre-images are rectangles; 2^16 points of a (0,2)-sequence are within 2^8 of each.
    assert np.abs(hits - 2**16 * GRID / GRID.sum()).max() <= 2**8
    cell = (x * [4, 3]).astype(int)
    assert density.pdf(x) == pytest.approx(GRID[cell[:, 1], cell[:, 0]] / GRID.mean(), rel=1e-6)
    assert np.abs(density.invert(x) - u).max() <= 16 * np.finfo(dtype).eps


def test_out_is_filled_in_place() -> None:
    u = sf.points("sobol", 64)
    out = np.zeros((64, 2), dtype=np.float32)
    density = sf.PiecewiseConstant2D(GRID)
    assert density.sample(u, out=out) is out
    pdf = np.zeros(64, dtype=np.float32)
    assert density.pdf(out, out=pdf) is pdf
    index = np.zeros(64, dtype=np.uint32)
    assert sf.AliasTable(WEIGHTS).sample(u[:, 0], out=index) is index
    assert index.any()


@pytest.mark.parametrize(
    ("call", "error", "match"),
    [
        (lambda: sf.AliasTable([1, -1]), ValueError, r"weights\[1\] is -1"),
        (lambda: sf.AliasTable([1, np.inf]), ValueError, r"weights\[1\] is inf"),
        (lambda: sf.AliasTable([0, 0]), ValueError, "one must be positive"),
        (lambda: sf.AliasTable([]), ValueError, "shape"),
        (lambda: sf.AliasTable([[1, 2]]), ValueError, "shape"),
        (lambda: sf.AliasTable(["a"]), TypeError, "real numbers"),
        (lambda: sf.AliasTable([1, 2]).sample(1.0), ValueError, r"\[0,1\)"),
        (lambda: sf.AliasTable([1, 2]).sample([0.5, np.nan]), ValueError, "nan"),
        (lambda: sf.AliasTable([1, 2]).pdf(2), ValueError, "is 2; it must be 0 .. 1"),
        (lambda: sf.AliasTable([1, 2]).pdf(-1), ValueError, "-1"),
        (lambda: sf.AliasTable([1, 2]).pdf(0.5), TypeError, "integers"),
        (lambda: sf.AliasTable([1, 0]).invert(1), ValueError, "weight is 0"),
        (lambda: sf.PiecewiseConstant1D([[1, 2]]), ValueError, "shape"),
        (lambda: sf.PiecewiseConstant1D([1, 2]).sample(2), ValueError, r"\[0,1\)"),
        (lambda: sf.PiecewiseConstant2D([1, 2]), ValueError, "rows, columns"),
        (lambda: sf.PiecewiseConstant2D(GRID).sample(np.zeros((4, 3))), ValueError, r"\(4, 3\)"),
        (lambda: sf.PiecewiseConstant2D(GRID).sample(u := np.zeros((4, 2)), out=u), ValueError, "overlaps"),
        (lambda: sf.PiecewiseConstant2D(GRID).pdf([0.5, 1]), ValueError, "value 1 of x is 1"),
    ],
)
def test_bad_input_is_named(call: Any, error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=match):
        call()


def test_piecewise_doubles_stay_below_one() -> None:
    last = 1 - 2.0**-53
    assert sf.PiecewiseConstant1D([1, 3]).sample([last])[0] < 1
    assert (sf.PiecewiseConstant2D([[1, 3], [1, 3]]).sample([[last, last]]) < 1).all()
