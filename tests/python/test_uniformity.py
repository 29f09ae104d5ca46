# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""uniformity: SciPy's discrepancies, nets, spectra in closed form, every pattern, bad input."""

from typing import Any

import numpy as np
import pytest
from scipy.spatial.distance import pdist
from scipy.stats import qmc

import sunfleck as sf
from sunfleck import uniformity

SCIPYS = {"centered": "CD", "wraparound": "WD", "mixture": "MD", "l2-star": "L2-star"}


@pytest.mark.parametrize("kind", SCIPYS)
@pytest.mark.parametrize("d", [1, 2, 7, 40])
@pytest.mark.parametrize("n", [1, 31, 300, 1100])
def test_discrepancies_are_scipys(kind: str, d: int, n: int) -> None:
    u = sf.points("random", n, d, seed=n, dtype="float64")
    expected = qmc.discrepancy(u, method=SCIPYS[kind])
    # Both are differences of terms of up to (19/12)^40 = 1e8, each summed with rounding.
    assert uniformity.discrepancy(u, kind) == pytest.approx(expected, rel=1e-10, abs=1e-10 if d < 40 else 0)


def test_kinds_are_listed() -> None:
    assert set(uniformity.DISCREPANCIES) == set(SCIPYS)
    assert all(text and "\n" not in text for text in uniformity.DISCREPANCIES.values())


@pytest.mark.parametrize("kind", SCIPYS)
def test_threads_change_no_bit(kind: str) -> None:
    u = sf.points("sobol", 1024, 5)
    assert len({uniformity.discrepancy(u, kind, threads=threads) for threads in (1, 2, 3, None)}) == 1


@pytest.mark.parametrize("name", sorted(sf.PATTERNS))
def test_every_pattern_is_at_least_as_even_as_random_points(name: str) -> None:
    # 256 = 16^2 points for those who take some counts only. Of random points the squared l2-star
    # discrepancy has mean (1/4 - 1/9) / n; ten times less is what the worst of the others (uniform)
    # has at most.
    n = next(count for count in sf.valid_counts(name, 256, 2) if count)
    u = sf.points(name, n, 2, seed=5, dtype="float64")
    square = uniformity.discrepancy(u, "l2-star") ** 2 * n / (1 / 4 - 1 / 9)
    assert square < (4 if name == "random" else 0.7), square


def test_star_discrepancy_bounds_and_values() -> None:
    line = np.sort(sf.points("random", 1000, 1, dtype="float64"), axis=0)
    rank = np.arange(1000)[:, None] / 1000
    exact = max((rank + 1 / 1000 - line).max(), (line - rank).max())
    assert uniformity.star_discrepancy(line) == pytest.approx((exact, exact), abs=1e-15)
    lower, upper = uniformity.star_discrepancy(sf.points("sobol", 1024, 6))
    assert 0 < lower < upper < 0.5
    closer = uniformity.star_discrepancy(sf.points("sobol", 1024, 6), boxes=1 << 16)
    assert closer.upper - closer.lower < upper - lower
    assert closer.lower <= upper
    assert lower <= closer.upper


def test_star_discrepancy_of_sobol_falls_as_it_should() -> None:
    # A (0,m,2)-net in base 2: n D* <= m/2 + 3/2 (Niederreiter 1992, theorem 4.7, b = 2, s = 2).
    for m in (6, 8, 10, 12):
        u = sf.points("sobol", 1 << m, 2, scramble=None, dtype="float64")
        assert uniformity.star_discrepancy(u).upper * (1 << m) <= m / 2 + 1.5


def test_t_values_by_pair() -> None:
    u = sf.points("sobol", 1024, 12, scramble=None, dtype="float64")
    t = uniformity.pair_t_values(u)
    assert t.shape == (12, 12)
    assert np.array_equal(t, t.T)
    assert not np.diagonal(t).any()  # each dimension alone is a (0,m,1)-net
    assert t[0, 1] == 0
    for i, j in ((2, 5), (3, 11)):
        assert t[i, j] == uniformity.t_value(u[:, [i, j]])
    assert (t < 10).all()
    # Scrambling changes no t.
    assert np.array_equal(uniformity.pair_t_values(sf.points("sobol", 1024, 12, dtype="float64")), t)


def test_t_value_of_other_bases() -> None:
    # Halton's first 3^6 points with i / n before them: of two dimensions, a (0,6,2)-net in base 3.
    n = 3**6
    third = sf.points("halton", n, 2, scramble=None, dtype="float64")[:, 1]
    u = np.stack([np.arange(n) / n, third], axis=1)
    assert uniformity.t_value(u, base=3) == 0
    assert uniformity.t_value(u[:, [0, 0]], base=3) == 5  # the diagonal


@pytest.mark.parametrize("toroidal", [False, True])
@pytest.mark.parametrize("d", [1, 2, 3, 12])
def test_minimum_distance_is_that_of_all_pairs(d: int, toroidal: bool) -> None:
    u = sf.points("random", 500, d, seed=d, dtype="float64")
    if toroidal:
        gaps = np.stack([pdist(u[:, [k]]) for k in range(d)])
        expected = np.sqrt((np.minimum(gaps, 1 - gaps) ** 2).sum(axis=0)).min()
    else:
        expected = pdist(u).min()
    assert uniformity.minimum_distance(u, toroidal=toroidal) == pytest.approx(expected, rel=1e-13)


def test_power_spectrum_is_the_sum_it_says() -> None:
    u = sf.points("random", 5000, 2, dtype="float64")  # more than are taken at a time
    power = uniformity.power_spectrum(u, max_frequency=5)
    for a, b in ((0, 0), (3, -5), (-4, 1), (0, 2)):
        wave = np.exp(-2j * np.pi * (u @ [a, b])).sum()
        assert power[a + 5, b + 5] == pytest.approx(abs(wave) ** 2 / 5000, rel=1e-9)


def test_power_spectrum_of_points_on_a_grid_is_numpys_fft() -> None:
    cells = np.unravel_index(np.flatnonzero(sf.Rng("pcg32", seed=1).random(1024) < 0.3), (32, 32))
    image = np.zeros((32, 32))
    image[cells] = 1
    power = uniformity.power_spectrum(np.stack(cells, axis=1) / 32, max_frequency=16)
    expected = np.abs(np.fft.fftshift(np.fft.fft2(image))) ** 2 / image.sum()
    assert np.allclose(power[:32, :32], expected, atol=1e-10)


def test_radial_spectrum_of_random_points_is_flat() -> None:
    sets = np.stack([sf.points("random", 256, seed=seed) for seed in range(40)])
    spectrum = uniformity.radial_power_spectrum(sets, max_frequency=30)
    # Power is exponential with mean 1. Ring r holds some 2 pi r frequencies, half of them distinct,
    # in each of 40 sets: relative deviation 1/sqrt(pi r 40); four and a half of it, for 30 rings.
    assert (np.abs(spectrum.power - 1) < 4.5 / np.sqrt(np.pi * spectrum.frequency * 40)).all()


def test_radial_spectrum_of_jittered_points_is_its_closed_form() -> None:
    # Of a point in each cell of a k x k grid: 1 - sinc(a/k)^2 sinc(b/k)^2 at frequency (a, b).
    k, seeds = 16, 60
    sets = np.stack([sf.points("jittered", k * k, seed=seed, dtype="float64") for seed in range(seeds)])
    spectrum = uniformity.radial_power_spectrum(sets)
    a = np.arange(-2 * k, 2 * k + 1)
    theory = 1 - (np.sinc(a[:, None] / k) * np.sinc(a / k)) ** 2
    ring = np.rint(np.hypot(a[:, None], a))
    expected = np.array([theory[ring == r].mean() for r in spectrum.frequency])
    # As above: no power spreads more about its mean than exponentially.
    assert (np.abs(spectrum.power / expected - 1) < 4.5 / np.sqrt(np.pi * spectrum.frequency * seeds)).all()


@pytest.mark.parametrize(
    ("call", "error", "match"),
    [
        (lambda u: uniformity.discrepancy(u, "centred"), ValueError, "centred.*centered"),
        (lambda u: uniformity.discrepancy(u, u.ndim), TypeError, "kind is 2"),
        (lambda u: uniformity.discrepancy(u + 1), ValueError, "coordinate 0 of point 0"),
        (lambda u: uniformity.discrepancy(u * np.nan), ValueError, "nan"),
        (lambda u: uniformity.discrepancy(u[:0]), ValueError, "0 points"),
        (lambda u: uniformity.discrepancy(u[0]), ValueError, "shape"),
        (lambda u: uniformity.discrepancy([[0.5], [0.5, 0.5]]), ValueError, "regular"),
        (lambda u: uniformity.discrepancy((u * 2**32).astype("uint32")), TypeError, "uint32"),
        (lambda u: uniformity.discrepancy(u, threads=0), ValueError, "threads"),
        (lambda u: uniformity.star_discrepancy(u, boxes=0), ValueError, "boxes is 0"),
        (lambda u: uniformity.star_discrepancy(np.ones((2, 2))), ValueError, "point 0"),
        (lambda u: uniformity.t_value(u[:13]), ValueError, "8 or 16"),
        (lambda u: uniformity.t_value(u, base=1), ValueError, "base is 1"),
        (lambda u: uniformity.t_value(u, effort=0), ValueError, "effort"),
        (lambda u: uniformity.t_value(np.zeros((256, 5000)), effort=1), NotImplementedError, "at most 8"),
        (lambda u: uniformity.minimum_distance(u[:1]), ValueError, "needs 2"),
        (lambda u: uniformity.power_spectrum(u[:, :1]), ValueError, "shape"),
        (lambda u: uniformity.power_spectrum(u - 1), ValueError, "outside"),
        (lambda u: uniformity.power_spectrum(u, max_frequency=0), ValueError, "max_frequency"),
        (lambda u: uniformity.radial_power_spectrum(np.zeros((0, 4, 2))), ValueError, "no sets"),
    ],
)
def test_bad_input_is_named(call: Any, error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=match):
        call(sf.points("random", 16, dtype="float64"))
