# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""mapping: round trips, densities, parameters, shapes and dtypes, out=, bad input."""

from typing import Any

import numpy as np
import pytest

import sunfleck as sf

NAMES = sorted(sf.MAPPINGS)
TRIANGLE = {"a": (1.0, 0.0, 0.0), "b": (0.0, 2.0, 0.0), "c": (0.0, 0.0, 3.0)}
DTYPES = ["float32", "float64"]


def mapping(name: str) -> sf.mapping.Mapping:
    found = getattr(sf.mapping, name)
    assert isinstance(found, sf.mapping.Mapping)
    return found


def parameters(name: str) -> dict[str, Any]:
    return dict(TRIANGLE) if name == "triangle" else {}


def inner_points(dtype: str, n: int = 4096) -> np.ndarray:
    """Away from the edges, where s or t may be lost, and from the tent's fold."""
    return 0.01 + 0.98 * sf.points("sobol", n, dtype=dtype).astype(dtype)


def test_every_mapping_of_the_library_is_an_attribute() -> None:
    assert {n for n in sf.mapping.__all__ if n not in ("MAPPINGS", "Mapping")} == set(sf.MAPPINGS)
    assert all(mapping(name).name == name for name in NAMES)
    assert all(text and "\n" not in text for text in sf.MAPPINGS.values())


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("dtype", DTYPES)
def test_invert_undoes_sample(name: str, dtype: str) -> None:
    u = inner_points(dtype)
    x = mapping(name).sample(u, **parameters(name))
    back = mapping(name).invert(x, **parameters(name))
    assert x.dtype == back.dtype == dtype
    # Slopes of the inverse stay below 100 on [0.01, 0.99]: a hundred roundings of the largest values.
    assert np.abs(back - u).max() < 400 * np.finfo(dtype).eps


@pytest.mark.parametrize("name", NAMES)
def test_both_precisions_agree(name: str) -> None:
    u = inner_points("float32")
    single = mapping(name).sample(u, **parameters(name))
    double = mapping(name).sample(u.astype("float64"), **parameters(name))
    assert np.abs(single - double).max() < 2e-6 * max(1, np.abs(double).max())


@pytest.mark.parametrize(
    ("name", "measure"),
    [
        ("pixel_box", 1),
        ("triangle", 3.5),  # half of |(-1, 2, 0) x (-1, 0, 3)| = 7
        ("disk_polar", np.pi),
        ("disk_concentric", np.pi),
        ("disk_naive", np.pi),
        ("sphere", 4 * np.pi),
        ("hemisphere", 2 * np.pi),
        ("cosine_hemisphere", 2 * np.pi),
    ],
)
def test_the_mean_of_one_over_pdf_is_the_measure(name: str, measure: float) -> None:
    # Centres of a grid, so that no sample lies where the density is 0.
    u = sf.points("uniform", 256 * 256, dtype="float64")
    x = mapping(name).sample(u, **parameters(name))
    mean = np.mean(1 / mapping(name).pdf(x, **parameters(name)))
    # 1 / pdf is constant, linear, or for the cosine 1 / sqrt(t), whose midpoint sum of 256 rows
    # falls short by 0.3 / sqrt(256) of 1: 1.9 %.
    assert mean == pytest.approx(measure, rel=0.02 if name == "cosine_hemisphere" else 1e-6)


@pytest.mark.parametrize(("name", "mu"), [("pixel_tent", None), ("pixel_gaussian", 0.4), ("pixel_gaussian", 0.2)])
def test_pixel_densities_integrate_to_one(name: str, mu: float | None) -> None:
    named: dict[str, Any] = {} if mu is None else {"mu": mu}
    axis = np.linspace(-3, 4, 1401)
    grid = np.stack(np.meshgrid(axis, axis), axis=-1)
    assert mapping(name).pdf(grid, **named).sum() * (axis[1] - axis[0]) ** 2 == pytest.approx(1, abs=1e-4)


def test_directions_have_length_one_and_the_pole_is_z() -> None:
    u = sf.points("sobol", 1024)
    for name in ("sphere", "hemisphere", "cosine_hemisphere"):
        w = mapping(name).sample(u)
        assert np.abs(np.linalg.norm(w, axis=1) - 1).max() < 1e-6
        assert (w[:, 2].min() < -0.9) == (name == "sphere")
    # E[z] = 2/3 under the cosine; 1024 stratified points are within 1e-3 of it.
    assert sf.mapping.cosine_hemisphere.sample(u)[:, 2].mean() == pytest.approx(2 / 3, abs=1e-3)


def test_pixels_have_their_centre_at_a_half() -> None:
    u = sf.points("sobol", 4096, dtype="float64")
    for name in ("pixel_box", "pixel_tent", "pixel_gaussian"):
        assert mapping(name).sample(u).mean(axis=0) == pytest.approx([0.5, 0.5], abs=2e-3)
    assert sf.mapping.pixel_tent.sample(u).min() < 0


def test_parameters_by_place_by_name_and_by_default() -> None:
    u = sf.points("sobol", 64)
    assert np.array_equal(sf.mapping.pixel_gaussian.sample(u), sf.mapping.pixel_gaussian.sample(u, mu=0.4))
    assert np.array_equal(sf.mapping.pixel_gaussian.sample(u, 0.2), sf.mapping.pixel_gaussian.sample(u, mu=0.2))
    assert not np.array_equal(sf.mapping.pixel_gaussian.sample(u, 0.2), sf.mapping.pixel_gaussian.sample(u))
    a, b, c = TRIANGLE.values()
    assert np.array_equal(sf.mapping.triangle.sample(u, a, b, c), sf.mapping.triangle.sample(u, a, c=c, b=b))


def test_a_parameter_may_differ_from_point_to_point() -> None:
    u = sf.points("sobol", 8).reshape(2, 4, 2)
    a = np.arange(24, dtype=np.float32).reshape(2, 4, 3)
    b, c = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    together = sf.mapping.triangle.sample(u, a, b, c)
    assert together.shape == (2, 4, 3)
    for i in np.ndindex(2, 4):
        assert np.array_equal(together[i], sf.mapping.triangle.sample(u[i], a[i], b, c))
    row = sf.mapping.pixel_gaussian.sample(
        u, np.array([[0.1], [0.3]], dtype=np.float32)
    )  # broadcast along the last axis
    assert np.array_equal(row[1], sf.mapping.pixel_gaussian.sample(u[1], 0.3))


def test_leading_shapes_and_dtypes() -> None:
    hemisphere = sf.mapping.hemisphere
    assert hemisphere.sample([0.5, 0.5]).shape == (3,)
    assert hemisphere.pdf(hemisphere.sample([0.5, 0.5])).shape == ()
    assert hemisphere.sample(np.zeros((0, 2))).shape == (0, 3)
    assert hemisphere.sample(np.zeros((2, 3, 4, 2))).shape == (2, 3, 4, 3)
    assert hemisphere.sample([[0, 0]]).dtype == "float64"
    assert hemisphere.sample(np.zeros((4, 2), dtype="float16")).dtype == "float64"
    strided = sf.points("sobol", 16)[::2]
    assert np.array_equal(hemisphere.sample(strided), hemisphere.sample(strided.copy()))


def test_out_is_filled_in_place() -> None:
    u = sf.points("sobol", 32)
    out = np.zeros((32, 3), dtype=np.float32)
    assert sf.mapping.sphere.sample(u, out=out) is out
    assert np.array_equal(out, sf.mapping.sphere.sample(u))
    density = np.zeros(32, dtype=np.float32)
    assert sf.mapping.sphere.pdf(out, out=density) is density
    back = np.zeros((32, 2), dtype=np.float32)
    assert sf.mapping.sphere.invert(out, out=back) is back


U = np.full((4, 2), 0.5)


@pytest.mark.parametrize(
    ("call", "error", "match"),
    [
        (lambda: sf.mapping.sphere.sample(U, out=np.zeros((4, 2))), ValueError, "out has shape"),
        (lambda: sf.mapping.sphere.sample(U, out=np.zeros((4, 3), dtype="float32")), TypeError, "out has dtype"),
        (lambda: sf.mapping.sphere.sample(U, out=np.zeros((4, 6))[:, ::2]), ValueError, "out is not"),
        (lambda: sf.mapping.pixel_box.sample(u := U.copy(), out=u), ValueError, "overlaps"),
        (lambda: sf.mapping.sphere.sample(np.zeros((4, 3))), ValueError, r"\(4, 3\).*\(\.\.\., 2\)"),
        (lambda: sf.mapping.sphere.pdf(U), ValueError, r"\(4, 2\).*\(\.\.\., 3\)"),
        (lambda: sf.mapping.sphere.sample(0.5), ValueError, r"\(\)"),
        (lambda: sf.mapping.sphere.sample([[0.5, 1.0]]), ValueError, "1"),
        (lambda: sf.mapping.sphere.sample([[0.5, -0.1]]), ValueError, "-0.1"),
        (lambda: sf.mapping.sphere.sample([[0.5, np.nan]]), ValueError, "nan"),
        (lambda: sf.mapping.sphere.pdf([[0.0, 0.0, np.inf]]), ValueError, "inf"),
        (lambda: sf.mapping.sphere.sample([["a", "b"]]), TypeError, "real numbers"),
        (lambda: sf.mapping.sphere.sample(U * 1j), TypeError, "complex"),
        (lambda: sf.mapping.sphere.sample([[0.5], [0.5, 0.5]]), ValueError, "regular"),
        (lambda: sf.mapping.sphere.sample(U, 0.4), TypeError, "takes 0"),
        (lambda: sf.mapping.sphere.sample(U, mu=0.4), TypeError, "mu"),
        (lambda: sf.mapping.pixel_gaussian.sample(U, 0.4, mu=0.4), TypeError, "twice"),
        (lambda: sf.mapping.pixel_gaussian.sample(U, mu=0), ValueError, "mu"),
        (lambda: sf.mapping.pixel_gaussian.sample(U, mu=-1), ValueError, "mu"),
        (lambda: sf.mapping.pixel_gaussian.sample(U, mu=np.nan), ValueError, "mu"),
        (lambda: sf.mapping.pixel_gaussian.sample(U, mu="wide"), TypeError, "mu"),
        (lambda: sf.mapping.pixel_gaussian.sample(U, mu=[0.1, 0.2, 0.3]), ValueError, "mu has shape"),
        (lambda: sf.mapping.triangle.sample(U, (0, 0, 0), (1, 0, 0)), TypeError, "needs its parameter 'c'"),
        (lambda: sf.mapping.triangle.sample(U, (0, 0), (1, 0, 0), (0, 1, 0)), ValueError, "a has shape"),
        (lambda: sf.mapping.triangle.sample(U, (0, 0, np.nan), (1, 0, 0), (0, 1, 0)), ValueError, "a"),
    ],
)
def test_bad_input_is_named(call: Any, error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=match):
        call()


def test_nothing_is_written_when_a_point_is_refused() -> None:
    out = np.zeros((4, 3))
    u = U.copy()
    u[3, 1] = 2
    with pytest.raises(ValueError, match="2"):
        sf.mapping.sphere.sample(u, out=out)
    assert not out.any()
