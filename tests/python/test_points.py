# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""points: SciPy's sequences, strata, splitting, threads, out=, bad input."""

import warnings
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest
from scipy.stats import qmc

import sunfleck as sf

# A count and a dimension that every pattern takes: 4 x 4 x 4 cells.
N, D = 64, 3
NAMES = sorted(sf.PATTERNS)


def test_descriptions_are_one_line_each() -> None:
    assert {"uniform", "random", "jittered", "halton", "sobol"} <= set(sf.PATTERNS)
    assert all(text and "\n" not in text for text in sf.PATTERNS.values())


def test_plain_sobol_is_scipys_in_natural_order() -> None:
    n, d = 1024, 64
    gray = np.arange(n) ^ np.arange(n) >> 1  # SciPy's i-th point is ours of index gray(i)
    expected = qmc.Sobol(d, scramble=False, bits=53).random(n)
    for dtype in ("float32", "float64"):
        assert np.array_equal(sf.points("sobol", n, d, scramble=None, dtype=dtype)[gray], expected)


def test_plain_sobol_is_scipys_in_the_last_dimensions() -> None:
    n, d = 8, 21201
    gray = np.arange(n) ^ np.arange(n) >> 1
    expected = qmc.Sobol(d, scramble=False).random(n)
    assert np.array_equal(sf.points("sobol", n, d, scramble=None, dtype="float64")[gray], expected)


def test_plain_halton_is_scipys() -> None:
    n, d = 1000, 20
    expected = qmc.Halton(d, scramble=False).random(n)
    ours = sf.points("halton", n, d, scramble=None, dtype="float64")
    # Ours is the exact fraction to 53 bits, on or above its interval's border; SciPy sums floats.
    assert np.abs(ours - expected).max() < 2e-15


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("dtype", ["float32", "float64", "uint32"])
def test_shape_dtype_and_interval(name: str, dtype: str) -> None:
    u = sf.points(name, N, D, dtype=dtype)
    assert u.shape == (N, D)
    assert u.dtype == dtype
    if dtype != "uint32":
        assert u.min() >= 0
        assert u.max() < 1


@pytest.mark.parametrize("name", NAMES)
def test_floats_are_the_words_top_bits(name: str) -> None:
    words = sf.points(name, N, D, dtype="uint32")
    assert np.array_equal(sf.points(name, N, D), (words >> 8) * np.float32(2**-24))
    doubles = sf.points(name, N, D, dtype="float64") * 2**32
    if name in ("halton", "hammersley"):  # each is rounded by itself, so that both lie in their elementary interval
        assert np.abs(doubles - words).max() <= 2**8
    else:
        assert np.array_equal(np.floor(doubles), words)


@pytest.mark.parametrize("name", NAMES)
def test_threads_change_no_bit(name: str) -> None:
    n = 1 << 16  # 256 x 256
    one = sf.points(name, n, 2, threads=1)
    assert np.array_equal(sf.points(name, n, 2, threads=2), one)
    assert np.array_equal(sf.points(name, n, 2), one)


@pytest.mark.parametrize("name", ["random", "halton", "sobol"])
def test_start_goes_on_with_the_sequence(name: str) -> None:
    whole = sf.points(name, 1024, 5, seed=9)
    assert np.array_equal(sf.points(name, 512, 5, seed=9, start=512), whole[512:])


@pytest.mark.parametrize("name", ["random", "jittered", "halton", "sobol"])
def test_seeds_differ_and_repeat(name: str) -> None:
    a, b = sf.points(name, N, D, seed=1), sf.points(name, N, D, seed=2)
    assert not np.array_equal(a, b)
    assert np.array_equal(a, sf.points(name, N, D, seed=1))


def test_scrambled_sobol_keeps_every_elementary_interval() -> None:
    u = sf.points("sobol", 256, 2, seed=5)
    for k in range(9):  # 2^k x 2^(8-k) boxes
        boxes = np.floor(u * [1 << k, 1 << (8 - k)]).astype(int) @ [1 << (8 - k), 1]
        assert len(np.unique(boxes)) == 256, k


def test_jittered_has_one_point_in_each_cell() -> None:
    u = sf.points("jittered", 992, 2, seed=3)
    cells = [np.unique(np.floor(u * sides).astype(int), axis=0) for sides in ((32, 31), (31, 32))]
    assert 992 in [len(c) for c in cells]


@pytest.mark.parametrize(
    ("pattern", "n", "d", "expected"),
    [
        ("jittered", 997, 2, (992, 999)),
        ("jittered", 992, 2, (992, 992)),
        ("uniform", 64, 3, (64, 64)),
        ("sobol", 997, 2, (997, 997)),
        ("jittered", 0, 2, (None, 1)),
    ],
)
def test_valid_counts(pattern: str, n: int, d: int, expected: tuple[int, int]) -> None:
    assert sf.valid_counts(pattern, n=n, d=d) == expected


def test_every_valid_count_is_taken_and_no_other() -> None:
    for n in range(1, 200):
        below, above = sf.valid_counts("jittered", n=n, d=2)
        if below == above == n:
            assert sf.points("jittered", n, 2).shape == (n, 2)
        else:
            with pytest.raises(ValueError, match=f"{n}.*{below}.*{above}"):
                sf.points("jittered", n, 2)


@pytest.mark.parametrize(("n", "start"), [(1000, 0), (256, 128), (3, 0)])
def test_sobol_warns_where_it_loses_its_balance(n: int, start: int) -> None:
    with pytest.warns(UserWarning, match="power of two") as caught:
        sf.points("sobol", n, start=start)
    assert caught[0].filename == __file__


def test_nothing_else_warns() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for n, start in ((0, 0), (1, 5), (1024, 0), (256, 512)):
            sf.points("sobol", n, start=start)
        sf.points("halton", 1000)
        sf.points("random", 1000)


def test_out_is_filled_in_place() -> None:
    out = np.zeros((N, D), dtype=np.float64)
    assert sf.points("sobol", N, D, dtype="float64", out=out) is out
    assert np.array_equal(out, sf.points("sobol", N, D, dtype="float64"))


@pytest.mark.parametrize(
    ("out", "error"),
    [
        (np.zeros((N, D), dtype=np.float16), TypeError),
        (np.zeros((D, N), dtype=np.float32), ValueError),
        (np.zeros((D, N), dtype=np.float32).T, ValueError),
        (np.zeros((N, 2 * D), dtype=np.float32)[:, ::2], ValueError),
        ("out", TypeError),
    ],
)
def test_out_that_would_need_a_copy_is_refused(out: Any, error: type[Exception]) -> None:
    with pytest.raises(error, match="out"):
        sf.points("sobol", N, D, out=out)
    if isinstance(out, np.ndarray):
        assert not out.any()


@pytest.mark.parametrize(
    ("options", "error", "match"),
    [
        ({"pattern": "sobel"}, ValueError, "sobel.*sobol"),
        ({"pattern": None}, TypeError, "pattern"),
        ({"n": -1}, ValueError, "n is -1"),
        ({"n": 2.0}, TypeError, "n is 2.0"),
        ({"n": 2**33}, (ValueError, MemoryError), "."),
        ({"d": 0}, ValueError, "0"),
        ({"d": 21202}, ValueError, "21202.*21201"),
        ({"pattern": "halton", "d": 6543}, ValueError, "6543.*6542"),
        ({"seed": -1}, ValueError, "seed"),
        ({"start": -1}, ValueError, "start"),
        ({"start": 2**32 - 8}, ValueError, "."),
        ({"scramble": "permuted"}, ValueError, "permuted"),
        ({"scramble": "owens"}, ValueError, "owens"),
        ({"scramble": 3}, TypeError, "scramble"),
        ({"dtype": "float16"}, TypeError, "float16"),
        ({"threads": 0}, ValueError, "threads"),
        ({"threads": -1}, ValueError, "threads"),
        ({"pattern": "jittered", "n": 17}, ValueError, "17"),
    ],
)
def test_bad_input_is_named(options: dict[str, Any], error: Any, match: str) -> None:
    with pytest.raises(error, match=match):
        sf.points(**{"pattern": "sobol", "n": 16, "d": 2, **options})


@pytest.mark.parametrize("name", NAMES)
def test_parts_of_a_total_are_the_whole(name: str) -> None:
    whole = sf.points(name, N, D, seed=3)
    parts = [sf.points(name, 16, D, seed=3, start=start, total=N) for start in range(0, N, 16)]
    assert np.array_equal(np.concatenate(parts), whole)
    first = sf.points(name, N // 4, D, seed=3, start=0, total=N)
    assert np.array_equal(first, whole[: N // 4])


@pytest.mark.parametrize(
    ("total", "named"),
    [(0, "total is 0"), (-1, "total is -1"), (2**64, "total is 18446744073709551616"), (9, "total of 9")],
)
def test_bad_totals(total: int, named: str) -> None:
    with pytest.raises(ValueError, match=named):
        sf.points("latin", 10, total=total)


def test_totals_that_a_pattern_cannot_have() -> None:
    with pytest.raises(ValueError, match=r"992.*999"):
        sf.points("jittered", 4, total=997)
    with pytest.raises(ValueError, match="latin has up to 4294967296"):
        sf.points("latin", 4, total=2**32 + 1)


def test_a_kept_set_serves_only_its_like() -> None:
    """The tables of the last call are kept; whatever was asked for before, the points are the same."""
    asked: list[dict[str, Any]] = [
        {"pattern": pattern, "n": 64, "d": d, "seed": seed, "scramble": scramble, "dtype": dtype, "threads": threads}
        for pattern, scramble in (("sobol", "owen"), ("sobol", "lms"), ("sz", "owen"), ("halton", "default"))
        for d, seed in ((3, 1), (3, 2), (4, 1))
        for dtype, threads in (("float32", 1), ("float64", 2))
    ]
    alone = [sf.points(**options) for options in asked]
    order = np.random.default_rng(7).integers(len(asked), size=400)
    assert all(np.array_equal(sf.points(**asked[i]), alone[i]) for i in order)
    assert len({array.tobytes() for array in alone}) == len(asked)  # no two of them are alike
    with ThreadPoolExecutor(4) as pool:
        assert all(pool.map(lambda i: np.array_equal(sf.points(**asked[i]), alone[i]), order))


def test_a_kept_set_refuses_as_a_new_one_does() -> None:
    sf.points("sobol", 16, 2, total=16)
    with pytest.raises(ValueError, match="total of 16"):
        sf.points("sobol", 16, 2, start=16, total=16)
    assert len(sf.points("sobol", 16, 2, total=16)) == 16


# ---- sources of randomness, names, dtypes ----


def test_seeds_come_from_whatever_numpy_has() -> None:
    for name in ("seed", "rng"):
        for make in (np.random.default_rng, np.random.SeedSequence, lambda s: sf.Rng("pcg32", seed=s)):
            source, twin = make(5), make(5)
            a, b = (sf.points("sobol", 8, **{name: source}) for _ in range(2))  # type: ignore[arg-type]
            assert not np.array_equal(a, b)  # advanced
            assert np.array_equal(a, sf.points("sobol", 8, **{name: twin}))  # type: ignore[arg-type]
        assert not np.array_equal(*(sf.points("sobol", 8, **{name: None}) for _ in range(2)))  # type: ignore[arg-type]
        assert np.array_equal(sf.points("sobol", 8, **{name: np.uint64(3)}), sf.points("sobol", 8, seed=3))
    values = [
        sf.integrate(lambda u: u[:, 0] ** 2, 1, max_samples=2048, **{name: np.random.default_rng(5)}).value  # type: ignore[arg-type]
        for name in ("seed", "rng")
    ]
    assert values[0] == values[1]
    with pytest.raises(TypeError, match="rng and seed are both given"):
        sf.points("sobol", 8, seed=1, rng=2)
    with pytest.raises(TypeError, match="rng is 'x'; give None, an integer"):
        sf.points("sobol", 8, rng="x")
    with pytest.raises(TypeError, match=r"seed is 1\.5"):
        sf.points("sobol", 8, seed=1.5)


def test_names_are_the_same_in_upper_and_lower_case() -> None:
    assert np.array_equal(sf.points("SOBOL", 8, scramble="Owen"), sf.points("sobol", 8, scramble="owen"))
    assert sf.valid_counts("Jittered", 997) == (992, 999)
    assert sf.Rng("PCG32", seed=1).bits() == sf.Rng("pcg32", seed=1).bits()
    assert sf.Rng("MT19937", seed=1).name == "mt19937"
    points = sf.points("sobol", 8)
    assert sf.uniformity.discrepancy(points, kind="Centered") == sf.uniformity.discrepancy(points, kind="centered")
    with pytest.warns(UserWarning, match="power of two"):
        sf.points("Sobol", 7)
    image = sf.render(sf.scenes.penumbra(), 8, 8, spp=1, pattern="Sobol", pixel_filter="Tent", seeds="PIXEL", threads=1)
    assert image.color.shape == (8, 8, 3)


@pytest.mark.parametrize("name", ["sobol\0x", "sobol\ud800"])
def test_a_name_that_c_cannot_read_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match="null character"):
        sf.points(name, 2)
    with pytest.raises(ValueError, match="null character"):
        sf.render(sf.scenes.penumbra(), 8, 8, spp=1, pattern=name)


@pytest.mark.parametrize("separator", ["_", "-", " "])
def test_one_separator_of_words_stands_for_all(separator: str) -> None:
    names = {"stop": f"Standard{separator}error", "pixel_filter": f"gaussian{separator}Truncated"}
    image = sf.render(sf.scenes.penumbra(), 8, 8, spp=1, **names)  # type: ignore[arg-type]
    assert image.metadata["stop"] == "standard_error"
    assert image.metadata["pixel_filter"] == "gaussian_truncated"
    assert not any(c in value for value in (*sf.STOP_REASONS, *sf.PIXEL_FILTERS, *sf.AOVS) for c in "- ")


@pytest.mark.parametrize("dtype", ["float32", "float64", "uint32"])
def test_out_sets_the_dtype(dtype: str) -> None:
    out = np.empty((8, 2), dtype)
    assert sf.points("sobol", 8, out=out) is out
    assert np.array_equal(out, sf.points("sobol", 8, dtype=dtype))
    with pytest.raises(TypeError, match="out has dtype"):
        sf.points("sobol", 8, out=out, dtype="float32" if dtype != "float32" else "float64")
    with pytest.raises(TypeError, match="int16"):
        sf.points("sobol", 8, out=np.empty((8, 2), "int16"))


@pytest.mark.filterwarnings("ignore:.*aligned block")
@pytest.mark.parametrize("pattern", sorted(sf.PATTERNS))
@pytest.mark.parametrize("d", [1, 2, 3, 4])
def test_the_counts_nearest_to_any_are_those_that_are_taken(pattern: str, d: int) -> None:
    taken = []
    for n in range(1, 41):
        try:
            sf.points(pattern, n, d)
        except ValueError:
            continue
        taken.append(n)
    least = 1 if pattern in ("uniform", "jittered", "latin", "multijittered", "orthogonal", "hammersley") else 0
    taken = [0, *taken] if least == 0 else taken
    for n in range(max(taken) + 1):
        below = max((t for t in taken if t <= n), default=None)
        above = min(t for t in taken if t >= n)
        # 0 of a pattern whose sequence may have no points is "none" and 0 at once.
        assert sf.valid_counts(pattern, n, d) == (below or None, above or None), n


@pytest.mark.filterwarnings("ignore:.*aligned block")
@pytest.mark.parametrize("pattern", sorted(sf.PATTERNS))
def test_the_word_is_the_floats_and_but_for_halton_the_doubles(pattern: str) -> None:
    [n] = {count for count in sf.valid_counts(pattern, 961, 3) if count and count <= 961}
    for scramble in sf.SCRAMBLES:
        try:
            words = sf.points(pattern, n, 3, scramble=scramble, seed=7, dtype="uint32")
        except ValueError:
            continue
        floats, doubles = (sf.points(pattern, n, 3, scramble=scramble, seed=7, dtype=t) for t in ("float32", "float64"))
        assert np.array_equal(floats * np.float32(2**24), words >> 8)
        above = words.astype(np.float64) - np.floor(doubles * 2.0**32)
        if pattern in ("halton", "hammersley"):
            assert above.min() >= 0
            assert above.max() <= 256
        else:
            assert not above.any()
