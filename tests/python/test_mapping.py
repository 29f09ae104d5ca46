# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""mapping: round trips, densities, parameters, shapes and dtypes, out=, bad input."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sunfleck as sf

NAMES = sorted(sf.MAPPINGS)
TRIANGLE: dict[str, Any] = {"a": (1.0, 0.0, 0.0), "b": (0.0, 2.0, 0.0), "c": (0.0, 0.0, 3.0)}
PARAMETERS: dict[str, dict[str, Any]] = {
    "triangle": TRIANGLE,
    "triangle_low_distortion": TRIANGLE,
    "parallelogram": TRIANGLE,
    "annulus": {"inner": 0.5},
    "regular_polygon": {"sides": 6},
    "cone": {"angle": 0.7},
    "power_cosine": {"exponent": 8},
    "henyey_greenstein": {"g": 0.5},
    "ggx_visible_normals": {"w": (0.6, 0.0, 0.8), "alpha_x": 0.4, "alpha_y": 0.7},
    "spherical_triangle": TRIANGLE,  # an octant, from the origin
    "spherical_rectangle": {"a": (-1.0, -1.0, 1.0), "b": (1.0, -1.0, 1.0), "c": (-1.0, 1.0, 1.0)},  # a cube's face
}
DTYPES = ["float32", "float64"]


def mapping(name: str) -> sf.mapping.Mapping:
    found = getattr(sf.mapping, name)
    assert isinstance(found, sf.mapping.Mapping)
    return found


def parameters(name: str) -> dict[str, Any]:
    return PARAMETERS.get(name, {})


def inner_points(dtype: str, n: int = 4096) -> np.ndarray:
    """Away from the edges, where s or t may be lost, and from the tent's fold."""
    return 0.01 + 0.98 * sf.points("sobol", n, dtype=dtype).astype(dtype)


def test_every_mapping_of_the_library_is_an_attribute() -> None:
    terms = {"ggx_normals", "ggx_masking", "ggx_masking_shadowing"}
    assert set(sf.mapping.__all__) - {"MAPPINGS", "Mapping"} - terms == set(sf.MAPPINGS)
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
        ("triangle_low_distortion", 3.5),
        ("parallelogram", 7),
        ("annulus", 0.75 * np.pi),
        ("regular_polygon", 1.5 * 3**0.5),
        ("cone", 2 * np.pi * (1 - np.cos(0.7))),
        ("henyey_greenstein", 4 * np.pi),
        ("spherical_triangle", np.pi / 2),
        ("spherical_rectangle", 4 * np.pi / 6),
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
    # 1 / pdf is constant, linear, smooth (Henyey-Greenstein: midpoints, (1/256)^2), or for the
    # cosine 1 / sqrt(t), whose midpoint sum of 256 rows falls short by 0.3 / sqrt(256) of 1: 1.9 %.
    loose = {"cosine_hemisphere": 0.02, "henyey_greenstein": 1e-4}
    assert mean == pytest.approx(measure, rel=loose.get(name, 1e-6))


@pytest.mark.parametrize(
    ("name", "named"),
    [
        ("pixel_tent", {}),
        ("pixel_gaussian", {"mu": 0.4}),
        ("pixel_gaussian", {"mu": 0.2}),
        ("pixel_blackman_harris", {"radius": 2}),
        ("pixel_mitchell", {}),
        ("pixel_lanczos", {}),
    ],
)
def test_pixel_densities_integrate_to_one(name: str, named: dict[str, Any]) -> None:
    axis = np.linspace(-3, 4, 1401)
    grid = np.stack(np.meshgrid(axis, axis), axis=-1)
    assert mapping(name).pdf(grid, **named).sum() * (axis[1] - axis[0]) ** 2 == pytest.approx(1, abs=1e-4)


def test_directions_have_length_one_and_the_pole_is_z() -> None:
    u = sf.points("sobol", 1024)
    for name in ("sphere", "hemisphere", "cosine_hemisphere", "cosine_hemisphere_concentric"):
        w = mapping(name).sample(u)
        assert np.abs(np.linalg.norm(w, axis=1) - 1).max() < 1e-6
        assert (w[:, 2].min() < -0.9) == (name == "sphere")
    # E[z] = 2/3 under the cosine; 1024 stratified points are within 1e-3 of it.
    assert sf.mapping.cosine_hemisphere.sample(u)[:, 2].mean() == pytest.approx(2 / 3, abs=1e-3)


def test_pixels_have_their_centre_at_a_half() -> None:
    u = sf.points("sobol", 4096, dtype="float64")
    for name in (n for n in NAMES if n.startswith("pixel_")):
        assert mapping(name).sample(u).mean(axis=0) == pytest.approx([0.5, 0.5], abs=2e-3)
    assert sf.mapping.pixel_tent.sample(u).min() < 0


@pytest.mark.parametrize("name", NAMES)
def test_weights_keep_a_constant(name: str) -> None:
    u = sf.points("sobol", 2**16, dtype="float64")
    weight = mapping(name).weight(mapping(name).sample(u, **parameters(name)), **parameters(name))
    if name in ("pixel_mitchell", "pixel_lanczos"):
        size = np.abs(weight[0])
        assert np.all(np.abs(weight) == size)
        assert 0.01 < np.mean(weight < 0) < 0.5
        # The share of negative samples is that of a few rectangles: 65536 Sobol points are within
        # 32 / 65536 of it, and the mean moves by twice the weight of those.
        assert weight.mean() == pytest.approx(1, abs=2 * size * 32 / 65536)
    else:
        assert np.all(weight == 1)


def test_the_weighted_moments_are_the_filter_s() -> None:
    # Of Mitchell's cubics with B = C = 1/3 the first moment is 0, the second 1/9, by integration.
    u = sf.points("sobol", 2**16, dtype="float64")
    x = sf.mapping.pixel_mitchell.sample(u)
    weight = sf.mapping.pixel_mitchell.weight(x)
    assert np.average(x[:, 0], weights=weight) == pytest.approx(0.5, abs=1e-3)
    assert np.average((x[:, 0] - 0.5) ** 2, weights=weight) == pytest.approx(1 / 9, abs=2e-3)


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
        (lambda: sf.mapping.cone.sample(U, 4), ValueError, r"angle is 4.*\[0, pi\]"),
        (lambda: sf.mapping.cone.sample(U), TypeError, "angle"),
        (lambda: sf.mapping.regular_polygon.sample(U, 5.5), ValueError, "sides is 5.5.*whole"),
        (lambda: sf.mapping.regular_polygon.sample(U, 2), ValueError, "sides is 2"),
        (lambda: sf.mapping.henyey_greenstein.sample(U, g=1), ValueError, "g is 1"),
        (lambda: sf.mapping.annulus.sample(U, [[0.1], [1.5]] * 2), ValueError, "inner has shape"),
        (lambda: sf.mapping.annulus.sample(U, [0.1, 0.2, 0.3, 1.5]), ValueError, r"inner\[3\]\[0\] is 1.5"),
        (lambda: sf.mapping.ggx_visible_normals.sample(U, (1, 1, 1), 0.1, 0.1), ValueError, "w.*length 1"),
        (lambda: sf.mapping.ggx_visible_normals.sample(U, (0, 0.6, -0.8), 0.1, 0.1), ValueError, "horizon"),
        (lambda: sf.mapping.ggx_visible_normals.sample(U, (0, 0, 1), 0, 0.1), ValueError, "alpha_x is 0"),
        (
            lambda: sf.mapping.spherical_rectangle.sample(U, (0, 0, 1), (1, 0, 1), (1, 1, 1)),
            ValueError,
            "angle at a.*0.707",
        ),
        (lambda: sf.mapping.ggx_masking((0, 0, 1), 0, 0.1), ValueError, r"ggx_masking: alpha_x\[0\] is 0.*1e-4"),
        (lambda: sf.mapping.ggx_masking((0, 0, 1), 1, np.nan), ValueError, r"alpha_y\[0\] is nan"),
        (lambda: sf.mapping.ggx_masking([(0, 0, 1), (0, 1, 1)], 1, 1), ValueError, r"w\[1\] is \(0, 1, 1\).*length 1"),
        (lambda: sf.mapping.ggx_masking((0, 1), 1, 1), ValueError, r"w has shape \(2,\)"),
        (lambda: sf.mapping.ggx_normals((0, 0, np.nan), 1, 1), ValueError, r"h\[0\] is \(0, 0, nan\)"),
        (lambda: sf.mapping.ggx_masking_shadowing((0, 0, 1), (0, 0, 2), 1, 1), ValueError, r"v\[0\] is \(0, 0, 2\)"),
        (lambda: sf.mapping.ggx_masking((0, 0, 1), [1, 1], 1), ValueError, "alpha_x has shape"),
        (lambda: sf.mapping.triangle.sample(U, (0, 0, 0), (1, 0, 0)), TypeError, "needs its parameter 'c'"),
        (lambda: sf.mapping.triangle.sample(U, (0, 0), (1, 0, 0), (0, 1, 0)), ValueError, "a has shape"),
        (lambda: sf.mapping.triangle.sample(U, (0, 0, np.nan), (1, 0, 0), (0, 1, 0)), ValueError, "a"),
    ],
)
def test_bad_input_is_named(call: Any, error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=match):
        call()


@pytest.mark.parametrize("dtype", DTYPES)
def test_the_visible_normals_have_the_density_of_their_terms(dtype: str) -> None:
    u = inner_points(dtype)
    w = sf.mapping.hemisphere.sample(u[::-1])
    alpha_x, alpha_y = 0.1 + u[:, 0], 0.1 + u[:, 1]
    h = sf.mapping.ggx_visible_normals.sample(u, w, alpha_x, alpha_y)
    facing = np.maximum((w * h).sum(axis=1), 0)
    terms = sf.mapping.ggx_masking(w, alpha_x, alpha_y) * sf.mapping.ggx_normals(h, alpha_x, alpha_y)
    pdf = sf.mapping.ggx_visible_normals.pdf(h, w, alpha_x, alpha_y)
    assert terms.dtype == pdf.dtype == dtype
    # w.h, at least 0.003 here, is a sum of three roundings of values up to 1; 20 more of the rest.
    assert facing.min() > 0.003
    assert np.abs(facing * terms / w[:, 2] / pdf - 1).max() < (3 / 0.003 + 20) * np.finfo(dtype).eps


def test_masking_keeps_the_projected_area() -> None:
    # Heitz 2014, eq. 20: what is seen of the microsurface has the area of the surface, w_z.
    s, t = np.meshgrid(*2 * [(np.arange(1024) + 0.5) / 1024], indexing="ij")
    h = sf.mapping.hemisphere.sample(np.stack([s, t], axis=-1))
    for w in ((0.6, 0.0, 0.8), (0.48, -0.64, 0.6), (0.0, 0.99, 0.0199**0.5)):
        seen = np.maximum(h @ np.array(w), 0) * sf.mapping.ggx_normals(h, 0.5, 0.7)
        # The midpoint rule, its kink on a curve of 1024 cells of 2^20: below 1e-4 of the whole.
        area = sf.mapping.ggx_masking(w, 0.5, 0.7) * 2 * np.pi * seen.mean()
        assert abs(area / w[2] - 1) < 1e-4


def test_masking_and_shadowing_are_of_both() -> None:
    u = sf.points("sobol", 1024, d=4, dtype="float64")
    w, v = sf.mapping.hemisphere.sample(u[:, :2].copy()), sf.mapping.hemisphere.sample(u[:, 2:].copy())
    both = sf.mapping.ggx_masking_shadowing(w, v, 0.5, 0.5)
    of_w, of_v = (sf.mapping.ggx_masking(x, 0.5, 0.5) for x in (w, v))
    # Heitz 2014, eq. 99 by its eq. 72: 1 / G2 = 1 + lambda + lambda', 1 / G1 = 1 + lambda.
    inside = np.minimum(w[:, 2], v[:, 2]) > 0
    np.testing.assert_allclose(1 / both[inside], 1 / of_w[inside] + 1 / of_v[inside] - 1, rtol=1e-13)
    assert np.array_equal(both, sf.mapping.ggx_masking_shadowing(v, w, 0.5, 0.5))
    assert sf.mapping.ggx_masking_shadowing(w, (0.0, 0.0, 1.0), 0.5, 0.5).shape == (1024,)
    below = -w[inside]
    assert not sf.mapping.ggx_masking(below, 0.5, 0.5).any()
    assert not sf.mapping.ggx_normals(below, 0.5, 0.5).any()
    assert not sf.mapping.ggx_masking_shadowing(below, (0.0, 0.0, 1.0), 0.5, 0.5).any()
    out = np.empty(1024)
    assert sf.mapping.ggx_masking(w, 0.5, 0.5, out=out) is out


def test_nothing_is_written_when_a_point_is_refused() -> None:
    out = np.zeros((4, 3))
    u = U.copy()
    u[3, 1] = 2
    with pytest.raises(ValueError, match="2"):
        sf.mapping.sphere.sample(u, out=out)
    assert not out.any()


def test_the_double_formulas_are_made_from_the_headers() -> None:
    script = Path(__file__).resolve().parents[2] / "csrc/mapping/make_mapping_f64.py"
    assert subprocess.run([sys.executable, str(script), "--check"]).returncode == 0
