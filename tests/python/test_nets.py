# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""nets: Sobol' and SZ, their scrambles and padding: SciPy's words, golden values, error rates."""

import hashlib
import itertools
import warnings
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import qmc

import sunfleck as sf

NETS = ("sobol", "sz")
SCRAMBLES = (None, "shift", "lms", "owen", "nested")
DTYPES = ("float32", "float64", "uint32")


def test_the_scrambles_are_listed() -> None:
    assert {"default", "none", "shift", "lms", "owen", "nested"} <= set(sf.SCRAMBLES)
    assert all(text and "\n" not in text for text in sf.SCRAMBLES.values())


@pytest.mark.parametrize("dtype", DTYPES)
def test_plain_sobol_is_scipys_word_for_word(dtype: str) -> None:
    n, d = 1024, 1500
    gray = np.arange(n) ^ np.arange(n) >> 1  # SciPy's i-th point is ours of index gray(i)
    expected = qmc.Sobol(d, scramble=False, bits=32).random(n)
    ours = sf.points("sobol", n, d, scramble=None, dtype=dtype)[gray]
    # 10 bits of the index leave the words' last 22 bits 0: every dtype holds them.
    assert np.array_equal(ours, expected * 2**32 if dtype == "uint32" else expected)


def test_plain_sobol_is_scipys_far_into_the_sequence() -> None:
    n, d, start = 64, 1111, 2**18
    engine = qmc.Sobol(d, scramble=False, bits=32)
    engine.fast_forward(start)
    gray = (index := np.arange(start, start + n)) ^ index >> 1
    points = sf.points("sobol", n, d, scramble=None, start=int(gray.min()), dtype="uint32")
    assert np.array_equal(points[gray - gray.min()], engine.random(n) * 2**32)


# sha256 of 37 points from index 5, d = 5 (4 of sz without pad), seed 20: frozen. Changing one is a breaking change.
GOLDEN = {
    ("sobol", None, 0): ("bf1060f577d1c6a0", "18212fd07233e79d", "b5eec9486f9cd176"),
    ("sobol", "shift", 0): ("df573e245614b732", "3fe8699728129e45", "633a40d31c6385d6"),
    ("sobol", "lms", 0): ("bd078791f7269232", "85ee2900f3e783bf", "5b38b355ca5ace15"),
    ("sobol", "owen", 0): ("30293a2706b4db28", "8cfd1dabfd491f69", "264e41c758c2edf3"),
    ("sobol", "nested", 0): ("a4aeee8d0d156879", "23e745d8546c6670", "edfbba3176fe73d0"),
    ("sz", None, 0): ("e5bdf09a9257977a", "0f14a84085c493e7", "9608d6c6f54f881c"),
    ("sz", "shift", 0): ("dbe32cf5c80bf9c0", "ee414d1f7d5ef1f9", "9d4fefd53e0671b9"),
    ("sz", "lms", 0): ("805a377a4064a69d", "0a83ede89547aaa1", "388dd41328313f6c"),
    ("sz", "owen", 0): ("4f2b223099e22d7d", "77ccf3ac2f5328a1", "487659c1cc38d6f8"),
    ("sz", "nested", 0): ("d27db13c6e8374ab", "1373b8b0f9200310", "04fb153c695693b0"),
    ("sobol", "owen", 2): ("200941ca92971d74", "91c57cf9cfd23e4d", "7febe0e2d6d0ea71"),
    ("sobol", "owen", 4): ("7e9d23fa7a7ac438", "0a8348dd39455848", "ec9d76a4d7fb9a21"),
    ("sobol", "nested", 2): ("d6f41ed23e5ed431", "a5880755f51d39b4", "56cd79d5f4f02f53"),
    ("sobol", "nested", 4): ("bf7c986b5f05b5f0", "456b5cadbbad6f95", "95b8cf8a5550aaa8"),
    ("sz", "owen", 2): ("200941ca92971d74", "91c57cf9cfd23e4d", "7febe0e2d6d0ea71"),
    ("sz", "owen", 4): ("8f51c89cffdc586f", "c5f46aac813aee84", "3b518a8710069c70"),
    ("sz", "nested", 2): ("d6f41ed23e5ed431", "a5880755f51d39b4", "56cd79d5f4f02f53"),
    ("sz", "nested", 4): ("f504fd3e0f40d79a", "2d44c9e0ce820ebd", "dc74c36679648b5b"),
}


def digest(pattern: str, scramble: str | None, pad: int, dtype: str) -> str:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        d = 4 if pattern == "sz" and not pad else 5
        u = sf.points(pattern, 37, d, seed=20, scramble=scramble, pad=pad, start=5, dtype=dtype)
    return hashlib.sha256(u.astype(u.dtype.newbyteorder("<")).tobytes()).hexdigest()[:16]


def test_values_are_frozen() -> None:
    kinds = [(p, s, 0) for p, s in itertools.product(NETS, SCRAMBLES)]
    kinds += [(p, s, k) for p, s, k in itertools.product(NETS, ("owen", "nested"), (2, 4))]
    found = {kind: tuple(digest(*kind, dtype) for dtype in DTYPES) for kind in kinds}
    assert found == GOLDEN


@pytest.mark.parametrize("pattern", NETS)
@pytest.mark.parametrize("scramble", SCRAMBLES[1:])
def test_every_bit_of_a_double_is_random(pattern: str, scramble: str) -> None:
    """Over 4000 seeds each of the 53 bits of a point is 1 in half: within 5 standard deviations,
    sqrt(4000) / 2, passed with chance 3e-5 by one of 53."""
    seeds = 4000
    u = np.array([sf.points(pattern, 1, 3, seed=s, scramble=scramble, start=6, dtype="float64") for s in range(seeds)])
    bits = (u[:, 0, 2] * 2**53).astype(np.uint64)
    ones = np.array([(bits >> np.uint64(k) & np.uint64(1)).sum() for k in range(53)])
    assert np.abs(ones - seeds / 2).max() < 5 * np.sqrt(seeds) / 2


@pytest.mark.parametrize("pattern", NETS)
@pytest.mark.parametrize("scramble", ["owen", "nested", "lms"])
def test_low_bits_of_doubles_are_not_those_of_one_word(pattern: str, scramble: str) -> None:
    """The 21 bits below the word take about as many values as 1024 uniform draws of 2^21 do: 1023.75
    of them are expected to differ (1024 (1 - 1024 / 2^22)), 10 fewer never."""
    u = sf.points(pattern, 1024, 2, seed=9, scramble=scramble, dtype="float64")
    low = (u * 2**53).astype(np.uint64) & np.uint64(2**21 - 1)
    assert len(np.unique(low[:, 0])) > 1013
    assert len(np.unique(low[:, 1])) > 1013


# ---- error rates ----


def smooth(u: NDArray[Any]) -> NDArray[Any]:
    """Mean 1 over the unit square: every mixed derivative is there."""
    x, y = u[..., 0], u[..., 1]
    result: NDArray[Any] = np.exp(x - y) / ((np.e - 1) * (1 - np.exp(-1)))
    return result


def root_mean_square(pattern: str, scramble: str, n: int, seeds: int, start: int = 0) -> float:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        errors = [
            smooth(sf.points(pattern, n, seed=s, scramble=scramble, start=start, dtype="float64", threads=1)).mean() - 1
            for s in range(seeds)
        ]
    return float(np.sqrt(np.mean(np.square(errors))))


@pytest.mark.parametrize("pattern", NETS)
@pytest.mark.parametrize(("scramble", "slack"), [("owen", 0.05), ("nested", 0.05), ("lms", 0.2)])
def test_error_falls_as_n_to_the_minus_three_halves(pattern: str, scramble: str, slack: float) -> None:
    """Variance of a scrambled (0, m, 2)-net on a smooth integrand is n^-3 times at most log2 n (Owen
    1997), that is, between these sizes a slope from -1.5 to -1.5 + log2(16 / 4) / 2 / 12 = -1.417.
    With 64 seeds log2 of a root mean square has standard deviation 1.44 / sqrt(2 * 64) = 0.13 (more
    where errors have heavier tails than the normal's), the slope over 4, 6, .. 16 one of 0.13 /
    sqrt(112) = 0.012: 4 of them at either end. A linear scramble has Owen's variance too, but few
    and large errors make it: its tails allow four times that."""
    exponents = np.arange(4, 17, 2)
    errors = [root_mean_square(pattern, scramble, 1 << int(m), 64) for m in exponents]
    slope = np.polyfit(exponents, np.log2(errors), 1)[0]
    assert -1.5 - slack < slope < -1.417 + slack


def test_dropping_the_first_point_loses_the_rate() -> None:
    """Without point 0 and with one more at the end the mean moves by (f(x_n) - f(x_0)) / n, whose
    spread is sqrt(2 * 0.17) / n for this integrand (variance of f: 0.17): 1.4e-4 at n = 4096, 50 and
    more times the error of the block. (Owen 2020, "On dropping the first Sobol' point".)"""
    n = 4096
    whole, dropped = root_mean_square("sobol", "owen", n, 64), root_mean_square("sobol", "owen", n, 64, start=1)
    assert dropped > 20 * whole
    assert dropped == pytest.approx(np.sqrt(2 * 0.17) / n, rel=0.5)


# ---- pairs of many dimensions ----


def pair_ratios(pattern: str, d: int, m: int) -> NDArray[np.float64]:
    """By pairs, the variance of the mean of (x - 1/2)(y - 1/2) over 2^m Owen-scrambled points over that
    of independent ones: Owen's gains (1997), exactly but for digits beyond the sixth, which weigh 4^-6.

    Sums of rows of the two matrices that are equal on m columns count, with weight 3 4^-a 2^-(a - 1)
    each for the last row a that is in them."""
    depth = 6
    columns = np.array([sf.points(pattern, 1, d, scramble=None, start=1 << k, dtype="uint32")[0] for k in range(m)])
    rows = [sum((columns[k] >> (31 - r) & 1).astype(np.int64) << k for k in range(m)) for r in range(depth)]
    sums = np.zeros((1, d), np.int64)
    for row in rows:
        sums = np.concatenate([sums, sums ^ row])
    last = np.array([u.bit_length() for u in range(1, 1 << depth)])
    words, at = np.unique(sums[1:], return_inverse=True)
    table = np.zeros((d, len(words)))
    np.add.at(table, (np.arange(d)[None], at.reshape(len(last), d)), (3.0 * 4.0**-last * 2.0 ** (1 - last))[:, None])
    return np.asarray(2.0**m * table @ table.T)


def test_the_worst_pair_of_sz_is_better_than_sobols_at_powers_of_four_and_than_independent_points() -> None:
    i, j = np.triu_indices(4, 1)
    for m in range(4, 13):  # beyond, digits that are left out count
        worst = {pattern: np.sqrt(pair_ratios(pattern, 4, m)[i, j]).max() for pattern in NETS}
        assert worst["sz"] < 0.55, m  # 1: as independent points
        assert m not in (4, 6, 8) or worst["sobol"] > 1.4 * worst["sz"], m  # powers of 4, the base
        assert worst["sz"] < 1.4 * worst["sobol"] + 0.001, m


def test_sz_ends_where_its_pairs_begin_to_repeat() -> None:
    """A fifth dimension would be its first at up to 2^4 points."""
    with pytest.raises(ValueError, match=r"d is 5; sz has 1 \.\. 4 dimensions.*pad=4.*sobol"):
        sf.points("sz", 16, 5)
    u = sf.points("sz", 4096, 32, pad=4, seed=3, dtype="float64")
    # Independent columns have correlations of n^-1/2, padded sets 1.2 times that: six of them.
    assert np.abs(np.corrcoef(u.T)[np.triu_indices(32, 1)]).max() < 6 * 1.2 / 64


# ---- padding ----


def pair_covariance(words: NDArray[np.uint32]) -> NDArray[np.float64]:
    """Of each pair of scrambled coordinates, in units of the variance 1/12, from the bits that their
    plain words share: 1 - 4^-k for the k shared bits, less 3 * 4^-(k + 1) for the next, opposite."""
    differ = words[:, None] ^ words[None, :]
    shared = 32 - np.frexp(differ.astype(np.float64))[1]
    return np.where(differ == 0, 1, 1 - 4.0**-shared - 3 * 4.0 ** -(shared + 1))


def shuffled_covariance(pattern: str, dimension: int, n: int) -> NDArray[np.float64]:
    """The same averaged over the pairs that a shuffle makes of one: those of the same first index
    bit that differs. Entry k is for bit k, the last for a point with itself."""
    words = sf.points(pattern, n, dimension + 1, scramble=None, dtype="uint32")[:, dimension]
    index = np.arange(n)
    top = np.frexp((index[:, None] ^ index[None, :]).astype(np.float64))[1] - 1
    return np.array([pair_covariance(words)[top == k].mean() for k in (*range(n.bit_length() - 1), -1)])


@pytest.mark.parametrize("pattern", NETS)
@pytest.mark.parametrize("scramble", ["owen", "nested"])
@pytest.mark.parametrize("pad", [2, 4])
def test_padded_sets_are_as_uncorrelated_as_shuffles_make_them(pattern: str, scramble: str, pad: int) -> None:
    """Independent columns have a correlation of standard deviation n^-1/2. Nested shuffles leave
    more, by the pair law: an index and its neighbour, in opposite halves of one set, are
    neighbours still in every other, so that the products of both agree (factor 1.2 at pad 2)."""
    n, d = 256, 100
    u = sf.points(pattern, n, d, scramble=scramble, pad=pad, seed=11, dtype="float64") - 0.5
    correlation = 12 / n * (u.T @ u)
    others = correlation[~np.kron(np.eye(d // pad), np.ones((pad, pad))).astype(bool)]
    pairs = np.array([*(n * 2.0 ** np.arange(n.bit_length() - 1)), n])
    laws = [shuffled_covariance(pattern, k, n) for k in range(pad)]
    expected = np.mean([(pairs * a * b).sum() / n**2 for a in laws for b in laws])
    # Over thousands of pairs, of 100 columns each: 100 independent groups at least, of relative
    # standard deviation sqrt(2): 0.14 of the square, 0.07 of its root; three of them.
    assert np.sqrt(np.mean(others**2) / expected) == pytest.approx(1, abs=0.21)
    # A normal's 6.5 standard deviations, 4950 times: chance 4e-7.
    assert np.abs(others).max() < 6.5 * np.sqrt(expected)


@pytest.mark.parametrize("pattern", NETS)
def test_padding_goes_beyond_the_table_and_keeps_every_pair(pattern: str) -> None:
    d = 65536
    u = sf.points(pattern, 16, d, pad=2)
    assert u.shape == (16, d)
    for k in range(0, d, 4096):
        boxes = np.floor(u[:, k : k + 2] * 4) @ [4, 1]
        assert len(np.unique(boxes)) == 16, k


def test_the_first_set_is_not_shuffled() -> None:
    assert np.array_equal(sf.points("sobol", 64, 9, pad=4)[:, :4], sf.points("sobol", 64, 4))


# ---- refusals ----


@pytest.mark.parametrize(
    ("options", "error", "match"),
    [
        ({"pad": 3}, ValueError, "pad is 3.*0, 2 or 4"),
        ({"pad": -2}, ValueError, "pad is -2"),
        ({"pad": 2.0}, TypeError, "pad is 2.0"),
        ({"pad": 2, "scramble": None}, ValueError, "owen or nested, not none"),
        ({"pad": 2, "scramble": "lms"}, ValueError, "owen or nested, not lms"),
        ({"pad": 2, "pattern": "halton"}, ValueError, "halton"),
        ({"pad": 4, "d": 65537}, ValueError, "65537.*65536"),
        ({"pattern": "sz", "d": 5}, ValueError, r"d is 5; sz has 1 \.\. 4"),
        ({"pattern": "sz", "scramble": "permuted"}, ValueError, "none, shift, lms, owen, nested"),
        ({"seed": 2**64}, ValueError, "seed"),
        ({"start": 2**32}, ValueError, "4294967296"),
        ({"start": 2**64}, ValueError, "start"),
        ({"scramble": "owens"}, ValueError, "owens.*owen, nested"),
    ],
)
def test_bad_input_is_named(options: dict[str, Any], error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=match):
        sf.points(**{"pattern": "sobol", "n": 16, "d": 2, **options})


def test_a_read_only_array_is_refused_and_left() -> None:
    out = np.zeros((16, 2), np.float32)
    out.flags.writeable = False
    with pytest.raises(ValueError, match="writeable"):
        sf.points("sobol", 16, 2, out=out)
    assert not out.any()


@pytest.mark.parametrize("pattern", NETS)
def test_no_points_are_allowed(pattern: str) -> None:
    for pad in (0, 2):
        assert sf.points(pattern, 0, 4, pad=pad).shape == (0, 4)
    assert sf.points(pattern, 0, 4, start=2**32).shape == (0, 4)


def test_sz_warns_where_it_loses_its_balance() -> None:
    with pytest.warns(UserWarning, match="sz's") as caught:
        sf.points("sz", 100)
    assert len(caught) == 1
