# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Masked arrays: every argument that takes an array refuses what is masked, and takes what is not."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sunfleck as sf


def masked(values: Any, dtype: str = "float64") -> Any:
    """The values, the first of them masked."""
    array = np.ma.masked_array(np.array(values, dtype=dtype), mask=False)
    array.mask.flat[0] = True
    return array


CORNERS = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
UNIT = [[0.25, 0.5], [0.75, 0.25]]
MATRIX = [[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]]


def table() -> sf.AliasTable:
    return sf.AliasTable([1.0, 2.0])


CALLS: dict[str, Callable[[], object]] = {
    "Moments": lambda: sf.Moments().add(masked([1, 2, 3])),
    "VectorMoments": lambda: sf.VectorMoments().add(masked(CORNERS)),
    "weights": lambda: sf.WeightedMoments().add([1.0, 2.0], masked([1, 2])),
    "betting_interval": lambda: sf.estimate.betting_interval(masked([0.1, 0.2]), 0, 1),
    "integrate": lambda: sf.integrate(lambda u: np.ma.masked_less(u[:, 0], 0.5), d=1, max_samples=4096),
    "AliasTable": lambda: sf.AliasTable(masked([1, 2])),
    "AliasTable.sample": lambda: table().sample(masked([0.1, 0.2])),
    "AliasTable.pdf": lambda: table().pdf(masked([0, 1], "int64")),
    "PiecewiseConstant1D": lambda: sf.PiecewiseConstant1D(masked([1, 2])),
    "vertices": lambda: sf.Mesh(masked(CORNERS), [[0, 1, 2]]),
    "triangles": lambda: sf.Mesh(CORNERS, masked([[0, 1, 2]], "int64")),
    "a list of rows": lambda: sf.Mesh([masked(row) for row in CORNERS], [[0, 1, 2]]),
    "albedo": lambda: sf.Mesh(CORNERS, [[0, 1, 2]], albedo=masked([0.5, 0.5, 0.5])),
    "transforms": lambda: sf.Instances([sf.Mesh(CORNERS, [[0, 1, 2]])], masked(MATRIX)),
    "mapping": lambda: sf.mapping.cosine_hemisphere.sample(masked(UNIT)),
    "mapping parameter": lambda: sf.mapping.pixel_gaussian.sample(UNIT, mu=masked([0.4, 0.4])),
    "uniformity": lambda: sf.uniformity.discrepancy(masked(UNIT)),
    "spectrum": lambda: sf.uniformity.radial_power_spectrum(masked([UNIT])),
    "out": lambda: sf.Rng("pcg32", 1).random(out=masked([0, 0])),
    "points' out": lambda: sf.points("sobol", 2, 2, dtype="float64", out=masked(UNIT)),
    "camera": lambda: sf.Camera(masked([0, 0, 1]), (0, 0, 0)),
}


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS)
def test_masked_values_are_refused(call: Callable[[], object]) -> None:
    with pytest.raises(ValueError, match=r"masked array, .* masked; .*compressed"):
        call()


def test_a_mask_of_nothing_is_taken() -> None:
    moments = sf.Moments()
    moments.add(np.ma.masked_array([1.0, 2.0, 3.0], mask=False))
    assert moments.mean == 2


def test_every_array_argument_goes_through_one_function() -> None:
    # np.asarray and its kin of a caller's value drop a mask: outside _arguments.py they may only be used on arrays that
    # the package made. These modules make arrays of their own, or have none.
    own = {"_arguments", "image", "show", "scenes", "load", "gltf", "gltf_material", "plates", "figure", "heatmap"}
    bare = re.compile(r"np\.(asarray|asanyarray|ascontiguousarray|array)\((value|values|points|x|index|mask|u|w)\b")
    allowed = {"return np.ascontiguousarray(mask).view(np.uint8)", "return np.ascontiguousarray(array, np.float64)"}
    package = Path(sf.__file__).parent
    for path in package.glob("*.py"):
        if path.stem in own:
            continue
        for line in path.read_text().splitlines():
            if ">>>" not in line and line.strip() not in allowed:
                assert not bare.search(line) or "_values" in line, f"{path.name}: {line.strip()}"
