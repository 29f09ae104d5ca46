# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""points: latin, multijittered, orthogonal, halton, hammersley, lattice, r2: strata, laws, known answers."""

import os
import subprocess
import sys
import zlib
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import qmc

import sunfleck as sf

FLOATS = ("float32", "float64")


def strata(u: NDArray[Any], n: int) -> NDArray[np.int64]:
    """floor(u n), exactly: u is a multiple of 2^-53 and n below 2^24, so that longdouble holds the product."""
    return np.floor(u.astype(np.longdouble) * n).astype(np.int64)


def fill_once(cells: NDArray[np.int64], n: int) -> bool:
    return bool(np.array_equal(np.sort(cells), np.arange(n)))


# ---- latin ----


@pytest.mark.parametrize("dtype", FLOATS)
@pytest.mark.parametrize("n", [1, 2, 3, 5, 7, 16, 17, 100, 997, 1024, 4095, 4096, 4099, 65537])
def test_latin_has_one_point_in_each_stratum(n: int, dtype: str) -> None:
    for d, seed in ((1, 0), (5, 3), (300 if n < 5000 else 6, 9)):
        cells = strata(sf.points("latin", n, d, seed=seed, dtype=dtype), n)
        assert all(fill_once(column, n) for column in cells.T)


def test_latin_holds_as_many_strata_as_floats_do() -> None:
    # A tenth of the points: no stratum twice, and where a float's and a double's strata differ
    # the word was rounded wrongly. Products with n in longdouble are exact.
    n, some = 2**24 - 3, 2**20
    whole = sf.points("latin", n, 1, seed=1)
    doubles = sf.points("latin", n, 1, seed=1, dtype="float64")
    for start in (0, n - some):
        floats = strata(whole[start : start + some, 0], n)
        assert len(np.unique(floats)) == some
        assert np.array_equal(floats, strata(doubles[start : start + some, 0], n))


def test_latin_beyond_floats_holds_its_strata_in_doubles() -> None:
    n, some = 2**24 + 11, 2**20
    u = sf.points("latin", n, 1, seed=4, dtype="float64")[:some, 0]
    assert len(np.unique(strata(u, n))) == some


def test_latin_removes_the_variance_of_an_additive_integrand() -> None:
    # f = sum over d of x_d: in each of n strata a place with variance 1 / (12 n^2), so that the
    # mean has variance d / (12 n^3) (McKay, Beckman & Conover 1979; Stein 1987). The estimate of
    # a variance from r normal seeds has a relative error of sqrt(2 / r): within 4.5 of them.
    n, d, r = 64, 4, 2000
    means = np.array([sf.points("latin", n, d, seed=s, dtype="float64").sum(axis=1).mean() for s in range(r)])
    assert abs(means.mean() - d / 2) < 4.5 * np.sqrt(d / (12 * n**3) / r)
    assert abs(means.var() / (d / (12 * n**3)) - 1) < 4.5 * np.sqrt(2 / r)


def test_latin_pairs_strata_as_independent_permutations_do() -> None:
    # f = (x - 1/2)(y - 1/2) has no additive part: with strata paired at random its mean has
    # variance about (1/12)^2 / (n - 1) (Stein 1987, the pairs of distinct strata being equally likely;
    # the strata's own spread changes that by O(1 / n^2)). Relative error of a variance from r
    # seeds: sqrt(2 / r); 4.5 of them, and 2 / n for the terms left out.
    n, r = 64, 3000
    x = np.array([sf.points("latin", n, 2, seed=s, dtype="float64") - 0.5 for s in range(r)])
    means = (x[:, :, 0] * x[:, :, 1]).mean(axis=1)
    assert abs(means.var() / (1 / 144 / (n - 1)) - 1) < 4.5 * np.sqrt(2 / r) + 2 / n


# ---- multijittered ----


@pytest.mark.parametrize("dtype", FLOATS)
@pytest.mark.parametrize(("m", "k"), [(1, 1), (2, 1), (2, 2), (3, 2), (4, 4), (7, 5), (32, 31), (61, 53)])
def test_multijittered_keeps_both_stratifications(m: int, k: int, dtype: str) -> None:
    n = m * k
    u = sf.points("multijittered", n, 5, seed=6, dtype=dtype)
    for d in range(5):
        assert fill_once(strata(u[:, d], n), n)  # n x 1 and 1 x n
    for d in (0, 2):
        assert fill_once(strata(u[:, d], m) * k + strata(u[:, d + 1], k), n)  # m x k


def test_multijittered_columns_share_one_permutation() -> None:
    # Kensler's correlation: the stratum inside a column depends on the row alone.
    m = k = 8
    u = sf.points("multijittered", m * k, 2, seed=2)
    inside = strata(u[:, 0], m * k) % k
    rows = strata(u[:, 1], k)
    assert all(len(np.unique(inside[rows == row])) == 1 for row in range(k))


# ---- orthogonal ----


@pytest.mark.parametrize("q", [2, 3, 4, 5, 7, 8, 11, 16, 17, 32])
def test_orthogonal_has_one_point_in_each_cell_of_every_pair(q: int) -> None:
    n, d = q * q, q + 1
    for dtype in FLOATS:
        u = sf.points("orthogonal", n, d, seed=5, dtype=dtype)
        levels = strata(u, q)
        for a in range(d):
            assert fill_once(strata(u[:, a], n), n)
            for b in range(a):
                assert fill_once(levels[:, a] * q + levels[:, b], n)


@pytest.mark.parametrize("q", [64, 128, 256, 512, 1024, 2048])
def test_every_field_has_its_pairs(q: int) -> None:
    # A polynomial that factors would leave cells of some pair empty.
    d = 20 if q < 1024 else 5
    levels = strata(sf.points("orthogonal", q * q, d, seed=1)[:, -3:], q)
    for a, b in ((0, 1), (0, 2), (1, 2)):
        assert (np.bincount(levels[:, a] * q + levels[:, b], minlength=q * q) == 1).all()


@pytest.mark.parametrize(
    ("n", "d", "counts"),
    [(997, 2, (961, 1024)), (25, 7, (None, 49)), (36, 3, (25, 49)), (2**24 + 1, 2, (2**24, None)), (1, 1, (None, 4))],
)
def test_orthogonal_names_its_nearest_counts(n: int, d: int, counts: tuple[int | None, int | None]) -> None:
    assert sf.valid_counts("orthogonal", n, d) == counts
    if n < 2**20:
        with pytest.raises(ValueError, match=f"{n}.*{counts[0] or counts[1]}"):
            sf.points("orthogonal", n, d)


# ---- halton and hammersley ----


def test_plain_halton_is_scipys_over_many_dimensions() -> None:
    # SciPy sums up to 10 rounded terms, each below 1: within 10 x 2^-53 of ours, which is exact.
    ours = sf.points("halton", 2000, 200, scramble=None, dtype="float64")
    assert np.abs(ours - qmc.Halton(200, scramble=False).random(2000)).max() < 1.2e-15


def test_halton_of_17_in_base_3() -> None:
    # 17 is 122 in base 3, mirrored 0.221: 25 / 27.
    assert sf.points("halton", 1, 2, scramble=None, start=17, dtype="float64")[0, 1] == pytest.approx(
        25 / 27, abs=2e-16
    )


@pytest.mark.parametrize("dtype", FLOATS)
@pytest.mark.parametrize("scramble", [None, "permuted", "owen"])
def test_halton_fills_every_box_of_every_aligned_block(scramble: str | None, dtype: str) -> None:
    for start in (0, 2**8 * 3**5 * 11):
        u = sf.points("halton", 2**8 * 3**5, 2, seed=8, scramble=scramble, start=start, dtype=dtype)
        for i in range(9):
            for j in range(6):
                a, b = 2**i, 3**j
                boxes = (strata(u[:, 0], a) * b + strata(u[:, 1], b)).reshape(-1, a * b)
                assert (np.sort(boxes, axis=1) == np.arange(a * b)).all(), (i, j)


@pytest.mark.parametrize("dimension", [0, 1, 2, 4, 10, 30, 400])
def test_owen_scrambled_halton_is_stratified_in_each_base(dimension: int) -> None:
    primes = [p for p in range(2, 66000) if p < 4 or all(p % f for f in range(2, int(p**0.5) + 1))][:6542]
    base = primes[dimension]
    power = base
    while power * base <= 2**15:
        power *= base
    for start in (0, 5 * power, 2**40 // power * power):
        u = sf.points("halton", power, dimension + 1, seed=3, scramble="owen", start=start, dtype="float32")[:, -1]
        assert fill_once(strata(u, power), power)


def owen_digits(seed: int, base_dimension: int, base: int, indices: list[int], places: int) -> NDArray[np.int64]:
    columns = [
        sf.points("halton", 1, base_dimension + 1, seed=seed, scramble="owen", start=i, dtype="float64")[0, -1]
        for i in indices
    ]
    return strata(np.array(columns), base**places)


@pytest.mark.parametrize(("dimension", "base"), [(0, 2), (1, 3), (2, 5)])
def test_owen_scrambled_pairs_have_owens_law(dimension: int, base: int) -> None:
    # Two indices that differ first in digit 0, 1, 2 share just so many scrambled digits; the digits
    # from the second after that on are independent and uniform (Owen 1997, section 2). A chi-square of
    # (first differing digit of either) over base (base - 1) cells, and of the next digits over
    # base^2, at 1500 seeds: bounds are the mean plus 5 standard deviations, k + 5 sqrt(2 k).
    seeds, rng = 1500, np.random.default_rng(1)
    for shared in range(3):
        i = int(rng.integers(base**shared))
        j = i + base**shared * int(rng.integers(1, base))
        cells = np.array([owen_digits(s, dimension, base, [i, j], shared + 2) for s in range(seeds)])
        first, second = cells // base % base, cells % base
        assert (cells // base**2 == (cells // base**2)[:, :1]).all()
        assert (first[:, 0] != first[:, 1]).all()
        for digits, k in ((first, base * (base - 1)), (second, base * base)):
            counts = np.bincount(digits[:, 0] * base + digits[:, 1], minlength=base * base)
            expected = seeds / k
            chi = ((counts - expected) ** 2 / expected).sum() - (expected * base if k < base * base else 0)
            assert chi < k - 1 + 5 * np.sqrt(2 * k), (shared, k)


def test_owen_scrambled_halton_gains_a_power_of_n() -> None:
    # On x in base 2, n = 2^m points: the m scrambled digits are a permutation and what follows
    # is uniform in each interval, so that the mean has variance 1 / (12 n^3) exactly. Relative
    # error of a variance from r seeds sqrt(2 / r); 4.5 of them.
    r = 800
    for n in (4, 32, 256):
        u = [sf.points("halton", n, 1, seed=s, scramble="owen", dtype="float64").mean() for s in range(r)]
        assert abs(np.var(u) * 12 * n**3 - 1) < 4.5 * np.sqrt(2 / r)


@pytest.mark.parametrize("scramble", [None, "permuted", "owen"])
def test_hammersley_is_i_over_n_beside_halton(scramble: str | None) -> None:
    for n in (1, 7, 1000, 4096):
        u = sf.points("hammersley", n, 5, seed=2, scramble=scramble, dtype="float64")
        assert np.array_equal(u[:, 1:], sf.points("halton", n, 4, seed=2, scramble=scramble, dtype="float64"))
        assert np.array_equal(strata(u[:, 0], n), np.arange(n))
        assert np.array_equal(strata(sf.points("hammersley", n, 5, seed=2, scramble=scramble)[:, 0], n), np.arange(n))
        if scramble is None:
            assert np.abs(u[:, 0] - np.arange(n) / n).max() <= 2**-53


# ---- lattice and r2 ----


def test_lattice_steps_along_one_vector() -> None:
    # Component 0 is 1, and Kuo's next ones 182667, 213731, 255351 (lattice-33002-1024-1048576.9125).
    n, vector = 1024, np.array([1, 182667, 213731, 255351])
    u = sf.points("lattice", n, 4, dtype="float64")
    k = (u[:, 0] * n).astype(int)
    assert np.array_equal(u, k[:, None] * vector % n / n)
    assert fill_once(k, n)


@pytest.mark.parametrize("dtype", FLOATS)
@pytest.mark.parametrize("scramble", [None, "shift"])
def test_lattice_coordinates_are_permutations_at_every_aligned_block(scramble: str | None, dtype: str) -> None:
    u = sf.points("lattice", 4096, 300, scramble=scramble, seed=7, dtype=dtype, start=8192)
    for m in (1, 4, 10, 12):
        # Each aligned block of 2^m has one point in each stratum, up to a shift: sorted, the
        # strata's numbers are all of them, a shifted lattice having one point in any half-open 2^-m.
        cells = strata(u, 2**m).reshape(-1, 2**m, 300)
        assert (np.sort(cells, axis=1) == np.arange(2**m)[:, None]).all()


def test_the_lattices_dimensions_all_differ() -> None:
    u = sf.points("lattice", 1, 4391, start=1 << 19, dtype="float64")  # z / 2^20
    z = (u[0] * 2**20).astype(int)
    assert len(np.unique(np.minimum(z, 2**20 - z))) == 4391
    with pytest.raises(ValueError, match=r"4392.*4391"):
        sf.points("lattice", 1, 4392)


def test_lattice_is_exact_on_waves_outside_its_dual() -> None:
    # The mean of cos 2 pi h.x over the lattice is 0 unless h.z = 0 modulo n; 4096 terms of rounded doubles.
    n, z = 4096, [1, 182667]
    u = sf.points("lattice", n, 2, dtype="float64")
    for h in ((1, 0), (3, -2), (17, 5), (100, 31)):
        assert (h[0] * z[0] + h[1] * z[1]) % n
        assert abs(np.cos(2 * np.pi * (u @ np.array(h))).mean()) < 1e-12


@pytest.mark.parametrize("pattern", ["lattice", "r2"])
def test_a_shift_moves_all_points_of_a_dimension_alike(pattern: str) -> None:
    plain = sf.points(pattern, 500, 6, dtype="float64")
    shifts = []
    for seed in (1, 2, 3):
        moved = (sf.points(pattern, 500, 6, seed=seed, scramble="shift", dtype="float64") - plain) % 1
        apart = np.abs(moved - moved[0])
        assert np.minimum(apart, 1 - apart).max() < 2**-51  # each cut off at 2^-53
        shifts += moved[0].tolist()
    assert len(set(shifts)) == 18


def test_r2_steps_by_the_generalized_golden_ratio() -> None:
    # Roberts 2018: phi_1 = 1.61803398874989484820, phi_2 = 1.32471795724474602596,
    # phi_3 = 1.22074408460575947536; z_n = 1/2 + n alpha from n = 1, alpha_k = phi^-k. Rounding: n
    # alpha in doubles is off by up to 1000 x 2^-53, the constants by 1000 x 3 x 5e-21.
    i = np.arange(1, 1001)[:, None]
    for d, phi in ((1, 1.6180339887498948482), (2, 1.32471795724474602596), (3, 1.22074408460575947536)):
        expected = (0.5 + i * phi ** -np.arange(1.0, d + 1)) % 1
        apart = np.abs(sf.points("r2", 1000, d, dtype="float64") - expected)
        assert np.minimum(apart, 1 - apart).max() < 1000 * 2**-52


# ---- all ----

CASES = [
    ("latin", None),
    ("multijittered", None),
    ("orthogonal", None),
    ("halton", None),
    ("halton", "permuted"),
    ("halton", "owen"),
    ("hammersley", None),
    ("hammersley", "permuted"),
    ("hammersley", "owen"),
    ("lattice", None),
    ("lattice", "shift"),
    ("r2", None),
    ("r2", "shift"),
]

# CRC-32 of 64 points in 5 dimensions, seed 1234, as uint32, float32, float64 (little-endian).
GOLDEN: dict[tuple[str, str | None], tuple[int, int, int]] = {
    ("latin", None): (1114538991, 2305160335, 1061159693),
    ("multijittered", None): (349674202, 1575521675, 3633995408),
    ("orthogonal", None): (3743254114, 1314577384, 3187729919),
    ("halton", None): (2783399650, 1166988296, 34022650),
    ("halton", "permuted"): (3827799616, 971056427, 321139975),
    ("halton", "owen"): (1349989337, 3940567017, 2341358753),
    ("hammersley", None): (1120167181, 1162839225, 704739656),
    ("hammersley", "permuted"): (352804150, 2610916956, 2384181963),
    ("hammersley", "owen"): (2248685427, 2917843435, 2448737718),
    ("lattice", None): (221168711, 2369647864, 1918190989),
    ("lattice", "shift"): (234396763, 1568951875, 978431865),
    ("r2", None): (2431933185, 331096307, 3958215758),
    ("r2", "shift"): (3905772796, 70390437, 3936787580),
}


def fingerprint(pattern: str, scramble: str | None, dtype: str) -> int:
    return zlib.crc32(sf.points(pattern, 64, 5, seed=1234, scramble=scramble, dtype=dtype).tobytes())


@pytest.mark.parametrize(("pattern", "scramble"), CASES)
def test_golden_vectors(pattern: str, scramble: str | None) -> None:
    found = tuple(fingerprint(pattern, scramble, dtype) for dtype in ("uint32", "float32", "float64"))
    assert found == GOLDEN[pattern, scramble]


@pytest.mark.parametrize(("pattern", "scramble"), CASES)
def test_any_number_of_threads_gives_the_same_bits(pattern: str, scramble: str | None) -> None:
    n, d = (257**2, 5) if pattern == "orthogonal" else (2**16, 5)
    for dtype in FLOATS:
        one = sf.points(pattern, n, d, seed=3, scramble=scramble, dtype=dtype, threads=1)
        for threads in (2, 3):
            again = sf.points(pattern, n, d, seed=3, scramble=scramble, dtype=dtype, threads=threads)
            assert np.array_equal(one, again)


def test_every_instruction_set_level_gives_the_same_bits() -> None:
    script = (
        "import sunfleck as sf, zlib\n"
        f"for p, s in {CASES!r}:\n"
        "    for d in (1, 3, 16, 40):\n"
        "        for n in ((1681,) if p == 'orthogonal' else (2970, 4096) if p == 'multijittered' else (3001, 4096)):\n"
        "            for t in ('uint32', 'float32', 'float64'):\n"
        "                print(zlib.crc32(sf.points(p, n, d, seed=5, scramble=s, dtype=t).tobytes()))\n"
    )
    found = {
        level: subprocess.check_output([sys.executable, "-c", script], env={**os.environ, "SUNFLECK_ISA": level})
        for level in ("baseline", "avx2", "avx512")
    }
    assert found["baseline"] == found["avx2"] == found["avx512"]


@pytest.mark.parametrize(("pattern", "scramble"), [c for c in CASES if c[0] in ("halton", "lattice", "r2")])
def test_sequences_go_on_from_any_start(pattern: str, scramble: str | None) -> None:
    # Blocks of every base end inside; the last lies beyond 2^32, where deeper digits count.
    for start in (0, 1000, 2**33 - 700, 2**62):
        whole = sf.points(pattern, 1400, 70, seed=4, scramble=scramble, start=start, dtype="float64")
        for skipped in (1, 53, 699, 701):
            part = sf.points(
                pattern, 1400 - skipped, 70, seed=4, scramble=scramble, start=start + skipped, dtype="float64"
            )
            assert np.array_equal(part, whole[skipped:])


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"pattern": "latin", "scramble": "owen"}, "owen.*none"),
        ({"pattern": "lattice", "scramble": "owen"}, "shift"),
        ({"pattern": "halton", "scramble": "shift"}, "permuted"),
        ({"pattern": "multijittered", "n": 17}, "17"),
        ({"pattern": "orthogonal", "n": 16, "d": 6}, "16.*6.*25"),
        ({"pattern": "orthogonal", "d": 4098}, "4097"),
        ({"pattern": "hammersley", "d": 6544}, "6543"),
        ({"pattern": "r2", "d": 65537}, "65536"),
    ],
)
def test_bad_input_is_named(options: dict[str, Any], match: str) -> None:
    with pytest.raises(ValueError, match=match):
        sf.points(**{"n": 16, "d": 2, **options})


def test_nothing_is_filled_with_nothing() -> None:
    for pattern, scramble in CASES:
        assert sf.points(pattern, 0, 3, scramble=scramble).shape == (0, 3)
