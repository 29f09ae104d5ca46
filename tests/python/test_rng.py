# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""rng: published vectors, the frozen meanings of seed and stream, out=, state, bad input."""

import copy
import pickle
import threading
from typing import Any

import numpy as np
import pytest

import sunfleck as sf

NAMES = sorted(sf.RNGS)
# A seed that every method takes.
SEED = 12345
NARROW = {"minstd", "lcg32", "randu", "ran1", "ran2", "mt19937", "pcg32", "philox4x32"}  # draws of 31 or 32 bits
WITHOUT_SKIP = {"ran1", "ran2", "sfc64"}


def test_there_are_these_and_descriptions_are_one_line_each() -> None:
    congruential = ["minstd", "lcg32", "lcg64", "randu", "ran1", "ran2"]
    linear = ["xorshift64", "xorshift64-lrl", "combined", "mt19937", "mt19937-64"]
    todays = ["pcg32", "pcg64dxsm", "xoshiro256++", "sfc64", "philox4x32", "philox4x64", "splitmix64"]
    assert list(sf.RNGS) == congruential + linear + todays
    assert all(text and "\n" not in text for text in sf.RNGS.values())


@pytest.mark.parametrize(
    ("name", "a", "c", "m"),
    [
        ("lcg32", 16807, 0, 2**31 - 1),
        ("lcg32", 69069, 1, 2**32),
        ("lcg32", 5, 3, 17),
        ("lcg64", 0x5DEECE66D, 11, 2**48),
        ("lcg64", 37, 0, 2**61 - 1),
        ("lcg64", 2862933555777941757, 3037000493, 2**64),
        ("lcg64", 2**64 - 61, 2**64 - 60, 2**64 - 59),
    ],
)
def test_lcgs_follow_their_rule(name: str, a: int, c: int, m: int) -> None:
    rng, x = sf.Rng(name, seed=9, a=a, c=c, m=m), 9
    dtype = "uint32" if name == "lcg32" else "uint64"
    for drawn in rng.bits(200, dtype).tolist():
        x = (a * x + c) % m
        assert drawn == x
    rng.reset()
    rng.skip(10**18)
    power, total = pow(a, 10**18, m * (a - 1)), 9
    total = (power * 9 + c * ((power - 1) // (a - 1))) % m
    assert rng.state["words"][0] == total
    assert pickle.loads(pickle.dumps(rng)).bits() == rng.bits()


def test_lcgs_choose_a_seed_of_their_own_below_any_modulus() -> None:
    assert len({sf.Rng("lcg32", a=5, c=3, m=257).seed for _ in range(20)}) > 1


def test_minstd_gives_the_standards_ten_thousandth_output() -> None:
    # C++ standard, rand.predef: minstd_rand0, default seed 1.
    assert sf.Rng("minstd", seed=1).bits(10_000)[-1] == 1043618065


def test_pcg32_gives_its_authors_demonstration() -> None:
    # O'Neill's pcg32-demo, seeded (42, 54): the state is (increment + seed) a + increment.
    expected = [0xA15C02B7, 0x7B47F409, 0xBA1D3330, 0x83D2F293, 0xBFA4784B, 0xCBED606E]
    increment = 2 * 54 + 1
    state = ((increment + 42) * 6364136223846793005 + increment) % 2**64
    rng = sf.Rng.from_state({"name": "pcg32", "words": [state, increment, 0, 42, 0, 0]})
    assert rng.bits(6).tolist() == expected


def test_splitmix64_gives_the_published_words() -> None:
    expected = [6457827717110365317, 3203168211198807973]
    assert sf.Rng("splitmix64", seed=1234567).bits(2, dtype="uint64").tolist() == expected


def test_a_64_bit_draw_gives_its_low_half_first() -> None:
    halves = sf.Rng("splitmix64", seed=SEED).bits(2)
    whole = sf.Rng("splitmix64", seed=SEED).bits(dtype="uint64")
    assert whole == int(halves[0]) | int(halves[1]) << 32


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_random_is_uniform_in_the_half_open_interval(name: str, dtype: str) -> None:
    x = sf.Rng(name, seed=SEED).random(100_000, dtype=dtype)
    assert x.dtype == dtype
    assert x.min() >= 0
    assert x.max() < 1
    # The mean's standard error is 1 / sqrt(12 * 100,000) = 9.1e-4; five of them.
    assert abs(float(x.mean(dtype=np.float64)) - 0.5) < 5 * 9.2e-4


def test_float32_is_the_top_24_bits() -> None:
    bits = sf.Rng("pcg32", seed=SEED).bits(1000)
    assert np.array_equal(sf.Rng("pcg32", seed=SEED).random(1000, "float32"), (bits >> 8) * np.float32(2**-24))


def test_shapes() -> None:
    rng = sf.Rng("pcg32", seed=SEED)
    assert isinstance(rng.random(), float)
    assert isinstance(rng.bits(), int)
    assert rng.random((2, 3)).shape == (2, 3)
    assert rng.random([4]).shape == (4,)
    assert rng.bits(0).shape == (0,)
    assert rng.random(()).shape == ()


def test_calls_may_be_split_anywhere() -> None:
    for name in NAMES:
        rng = sf.Rng(name, seed=SEED)
        parts = [rng.bits(k) for k in (1, 2, 3, 5, 1000)]
        assert np.array_equal(np.concatenate(parts), sf.Rng(name, seed=SEED).bits(1011)), name


def test_out_is_filled_in_place() -> None:
    out = np.zeros((3, 5), dtype=np.float64)
    result = sf.Rng("pcg32", seed=SEED).random(out=out)
    assert result is out
    assert np.array_equal(out, sf.Rng("pcg32", seed=SEED).random((3, 5)))
    view = np.zeros(10, dtype=np.uint64)[2:7]
    assert sf.Rng("pcg32", seed=SEED).bits(5, "uint64", out=view) is view
    assert view.all()


def read_only(array: np.ndarray) -> np.ndarray:
    array.flags.writeable = False
    return array


@pytest.mark.parametrize(
    ("out", "error"),
    [
        (np.zeros(5, dtype=np.int32), TypeError),
        (np.zeros(5, dtype=">f8"), TypeError),
        ([0.0] * 5, TypeError),
        (np.zeros(4), ValueError),
        (np.zeros((5, 1)), ValueError),
        (np.zeros(10)[::2], ValueError),
        (read_only(np.zeros(5)), ValueError),
    ],
)
def test_out_that_would_need_a_copy_is_refused_and_draws_nothing(out: Any, error: type[Exception]) -> None:
    rng = sf.Rng("pcg32", seed=SEED)
    with pytest.raises(error, match="out"):
        rng.random(5, out=out)
    assert rng.bits() == sf.Rng("pcg32", seed=SEED).bits()


@pytest.mark.parametrize("name", NAMES)
def test_streams_and_seeds_differ(name: str) -> None:
    words = {sf.Rng(name, seed=seed, stream=stream).bits(dtype="uint64") for seed in (1, 3) for stream in range(5)}
    assert len(words) == 10


@pytest.mark.parametrize("name", NAMES)
def test_a_seed_of_its_own_is_recorded(name: str) -> None:
    rng, other = sf.Rng(name), sf.Rng(name)
    assert rng.seed != other.seed
    assert np.array_equal(rng.bits(10), sf.Rng(name, seed=rng.seed).bits(10))


@pytest.mark.parametrize("name", NAMES)
def test_reset_starts_again(name: str) -> None:
    rng = sf.Rng(name, seed=SEED, stream=3)
    first = rng.bits(7)
    rng.reset()
    assert np.array_equal(rng.bits(7), first)
    assert (rng.name, rng.seed, rng.stream) == (name, SEED, 3)


@pytest.mark.parametrize("name", NAMES)
def test_skip_passes_over_draws_or_says_that_it_cannot(name: str) -> None:
    drawn, skipped = sf.Rng(name, seed=SEED), sf.Rng(name, seed=SEED)
    drawn.bits(1000, dtype="uint32" if name in NARROW else "uint64")
    try:
        skipped.skip(1000)
    except NotImplementedError:
        assert np.array_equal(skipped.bits(10), sf.Rng(name, seed=SEED).bits(10))
    else:
        assert np.array_equal(skipped.bits(10), drawn.bits(10))


@pytest.mark.parametrize("name", NAMES)
def test_methods_skip_far_or_say_that_they_cannot(name: str) -> None:
    once, twice = sf.Rng(name, seed=SEED), sf.Rng(name, seed=SEED)
    if name in WITHOUT_SKIP:
        with pytest.raises(NotImplementedError, match=name):
            once.skip(2**60)
        return
    once.skip(2**60 + 99)
    twice.skip(2**60)
    twice.skip(99)
    assert once.bits(5).tolist() == twice.bits(5).tolist()


def drawn_by_threads(rngs: list[sf.Rng]) -> np.ndarray:
    """4,096 float32 of each, drawn by a thread of its own."""
    drawn = np.empty((len(rngs), 4096), dtype=np.float32)
    threads = [
        threading.Thread(target=rng.random, kwargs={"out": drawn[i], "dtype": "float32"}) for i, rng in enumerate(rngs)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return drawn


def jumped(name: str, count: int) -> list[sf.Rng]:
    rngs = [sf.Rng(name, seed=SEED)]
    for _ in range(count - 1):
        rngs.append(copy.deepcopy(rngs[-1]))
        rngs[-1].skip(0x9E3779B97F4A7C15)
    return rngs


@pytest.mark.parametrize("name", NAMES)
def test_shared_seeds_repeat_and_the_policies_do_not(name: str) -> None:
    shared = drawn_by_threads([sf.Rng(name, seed=SEED) for _ in range(4)])
    assert (shared == shared[0]).all()
    policies = {
        "spawned": sf.Rng(name, seed=SEED).spawn(4),
        "streams": [sf.Rng(name, seed=SEED, stream=thread) for thread in range(4)],
    }
    if name not in WITHOUT_SKIP | {"minstd", "lcg32", "lcg64", "randu"}:
        policies["jumped"] = jumped(name, 4)
    for policy, rngs in policies.items():
        # Independent rows correlate by 1 / sqrt(4096) = 1/64; 5.5 of those leave one chance in 70,000 for all pairs.
        correlations = np.corrcoef(drawn_by_threads(rngs))
        assert np.abs(correlations - np.eye(4)).max() < 5.5 / 64, policy


@pytest.mark.parametrize("name", NAMES)
def test_children_differ_and_do_not_depend_on_use(name: str) -> None:
    fresh, used = sf.Rng(name, seed=SEED), sf.Rng(name, seed=SEED)
    used.bits(1001)
    children = fresh.spawn(4) + fresh.spawn(4)
    assert [c.bits(dtype="uint64") for c in children] == [c.bits(dtype="uint64") for c in used.spawn(8)]
    assert len({c.bits(dtype="uint64") for c in children}) == 8


@pytest.mark.parametrize("name", NAMES)
def test_state_pickle_and_copy_go_on_where_they_were(name: str) -> None:
    rng = sf.Rng(name, seed=SEED)
    rng.bits(3)  # an odd count: a 64-bit method has half a draw waiting
    twins = [sf.Rng.from_state(rng.state), pickle.loads(pickle.dumps(rng)), copy.deepcopy(rng)]
    expected = rng.bits(9).tolist()
    for twin in twins:
        assert (twin.name, twin.seed, twin.stream) == (name, SEED, 0)
        assert twin.bits(9).tolist() == expected


def test_threads_take_turns() -> None:
    rng = sf.Rng("splitmix64", seed=SEED)
    drawn: list[np.ndarray] = []

    def draw() -> None:
        for _ in range(200):
            drawn.append(rng.bits(500, dtype="uint64"))

    threads = [threading.Thread(target=draw) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    expected = sf.Rng("splitmix64", seed=SEED).bits(4 * 200 * 500, dtype="uint64")
    assert np.array_equal(np.sort(np.concatenate(drawn)), np.sort(expected))


@pytest.mark.parametrize(
    ("call", "error", "match"),
    [
        (lambda: sf.Rng("pcg33", seed=1), ValueError, "pcg33.*pcg32"),
        (lambda: sf.Rng("pcg33"), ValueError, "pcg33"),
        (lambda: sf.Rng(3, seed=1), TypeError, "name"),  # type: ignore[arg-type]
        (lambda: sf.Rng("pcg32", seed=-1), ValueError, "seed"),
        (lambda: sf.Rng("pcg32", seed=2**64), ValueError, "seed"),
        (lambda: sf.Rng("pcg32", seed=1.5), TypeError, "seed"),  # type: ignore[arg-type]
        (lambda: sf.Rng("pcg32", seed="1"), TypeError, "seed"),  # type: ignore[arg-type]
        (lambda: sf.Rng("minstd", seed=0), ValueError, "0"),
        (lambda: sf.Rng("minstd", seed=2**31 - 1), ValueError, "2147483647"),
        (lambda: sf.Rng("xorshift64", seed=0), ValueError, "0"),
        (lambda: sf.Rng("randu", seed=2), ValueError, "odd"),
        (lambda: sf.Rng("ran1", seed=0), ValueError, "2147483646"),
        (lambda: sf.Rng("ran2", seed=2147483399), ValueError, "2147483398"),
        (lambda: sf.Rng("mt19937", seed=2**32), ValueError, "4294967295"),
        (lambda: sf.Rng("pcg32", seed=1, a=5), ValueError, "lcg32"),
        (lambda: sf.Rng("lcg32", seed=1, a=4), ValueError, "factor 4"),
        (lambda: sf.Rng("lcg32", seed=1, a=-1), ValueError, "a is -1"),
        (lambda: sf.Rng("lcg32", seed=1, a=1.5), TypeError, "a is 1.5"),  # type: ignore[arg-type]
        (lambda: sf.Rng("lcg32", seed=1, m=2**33), ValueError, "2.*32"),
        (lambda: sf.Rng("lcg64", seed=1, m=0), ValueError, "m is 0"),
        (lambda: sf.Rng("lcg64", seed=1, m=2**64 + 1), ValueError, "m is"),
        (lambda: sf.Rng("lcg64", seed=2, c=0), ValueError, "seed is 2"),
        (lambda: sf.Rng("pcg32", seed=1, stream=2**63), ValueError, "stream"),
        (lambda: sf.Rng("pcg32", seed=1).random(-1), ValueError, "-1"),
        (lambda: sf.Rng("pcg32", seed=1).random(2.0), TypeError, "shape"),  # type: ignore[call-overload]
        (lambda: sf.Rng("pcg32", seed=1).random((1 << 40, 1 << 40)), MemoryError, "shape"),
        (lambda: sf.Rng("pcg32", seed=1).random(2, dtype="float16"), TypeError, "float16"),
        (lambda: sf.Rng("pcg32", seed=1).random(2, dtype="uint32"), TypeError, "uint32"),
        (lambda: sf.Rng("pcg32", seed=1).bits(2, dtype="int32"), TypeError, "int32"),
        (lambda: sf.Rng("pcg32", seed=1).bits(2, dtype="nonsense"), TypeError, "nonsense"),
        (lambda: sf.Rng("pcg32", seed=1).skip(-1), ValueError, "count"),
        (lambda: sf.Rng("pcg32", seed=1).spawn(-1), ValueError, "count"),
        (lambda: sf.Rng.from_state({}), ValueError, "state"),
        (lambda: sf.Rng.from_state({"name": "pcg32", "words": [1]}), ValueError, "1"),
        (lambda: sf.Rng.from_state({"name": "xoshiro256++", "words": [0] * 8}), ValueError, "."),
    ],
)
def test_bad_input_is_named(call: Any, error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=match):
        call()


def test_out_sets_the_dtype() -> None:
    for call, kinds in (("random", ("float64", "float32")), ("bits", ("uint32", "uint64"))):
        for kind in kinds:
            out = np.zeros(5, kind)
            made = getattr(sf.Rng("sfc64", seed=1), call)(out=out)
            assert made is out
            assert np.array_equal(out, getattr(sf.Rng("sfc64", seed=1), call)(5, dtype=kind))
        with pytest.raises(TypeError, match="int16"):
            getattr(sf.Rng("sfc64", seed=1), call)(out=np.zeros(5, "int16"))
