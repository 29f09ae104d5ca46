# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""bit_generator: word for word with NumPy's generators, and beneath its distributions."""

import copy
import pickle
import subprocess
import sys
import textwrap
import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import sunfleck as sf
from sunfleck.bit_generator import BitGenerator

SEED = 12345
NUMPY = {"mt19937": "MT19937", "pcg64dxsm": "PCG64DXSM", "sfc64": "SFC64", "philox4x64": "Philox"}


def theirs(name: str, seed: int = 7) -> Any:
    return getattr(np.random, NUMPY[name])(seed)


@pytest.mark.parametrize("name", sorted(NUMPY))
@pytest.mark.parametrize("draws", [0, 1, 2, 3, 5, 624, 1001])
def test_numpys_generator_goes_on_alike_from_one_state(name: str, draws: int) -> None:
    numpy = theirs(name)
    numpy.random_raw(draws)
    if name != "mt19937":
        np.random.Generator(numpy).random(dtype="float32")  # leaves half a draw waiting
    rng = sf.Rng(name, seed=SEED)
    rng.bit_generator.state = numpy.state
    raw = "uint32" if name == "mt19937" else "uint64"
    assert np.array_equal(copy.deepcopy(rng).bits(3000, raw), copy.deepcopy(numpy).random_raw(3000))
    generator = np.random.Generator(numpy)
    assert np.array_equal(rng.random(1001, "float32"), generator.random(1001, dtype="float32"))
    assert np.array_equal(rng.random(1001), generator.random(1001))
    assert np.array_equal(rng.bits(7), generator.integers(2**32, size=7, dtype=np.uint32))


@pytest.mark.parametrize("name", sorted(NUMPY))
@pytest.mark.parametrize("draws", [0, 3, 1001])
def test_our_state_goes_into_numpys_generator(name: str, draws: int) -> None:
    rng = sf.Rng(name, seed=SEED, stream=3)
    rng.random(draws)
    rng.bits()
    numpy = theirs(name)
    numpy.state = rng.bit_generator.state
    ours = np.random.Generator(rng.bit_generator)
    other = np.random.Generator(numpy)
    distributions: list[Callable[[np.random.Generator], object]] = [
        lambda g: g.random(100),
        lambda g: g.normal(size=100),
        lambda g: g.integers(0, 1000, size=100),
        lambda g: g.integers(0, 2**63, size=100),
        lambda g: g.gamma(0.7, size=100),
        lambda g: g.random(101, dtype="float32"),
        lambda g: g.permutation(50),
        lambda g: g.exponential(size=100),
    ]
    for draw in distributions:
        assert np.array_equal(np.asarray(draw(ours)), np.asarray(draw(other)))


def test_mt19937_is_seeded_as_numpys_legacy_one() -> None:
    # RandomState seeds by init_genrand, and random_sample is genrand_res53.
    legacy: Any = np.random.RandomState(5489)
    assert np.array_equal(sf.Rng("mt19937", seed=5489).random(1000), legacy.random_sample(1000))


@pytest.mark.parametrize("name", sorted(sf.RNGS))
def test_every_generator_drives_numpys_distributions(name: str) -> None:
    generator = np.random.Generator(sf.Rng(name, seed=SEED).bit_generator)
    normal = generator.normal(size=20_000)
    # Five standard errors of mean and variance, 1 / sqrt(n) and sqrt(2 / n); RANDU and LCGs pass them too.
    assert abs(normal.mean()) < 5 / 20_000**0.5
    assert abs(normal.var() - 1) < 5 * (2 / 20_000) ** 0.5
    # Of 2^16 faces each bit is fair: n / 2 with a deviation of sqrt(n) / 2.
    faces = generator.integers(0, 1 << 16, size=20_000)
    ones = np.array([(faces >> bit & 1).sum() for bit in range(16)])
    assert np.abs(ones - 10_000).max() < 5 * 20_000**0.5 / 2


@pytest.mark.parametrize("name", sorted(sf.RNGS))
def test_draws_through_both_faces_are_one_sequence(name: str) -> None:
    rng, twin = sf.Rng(name, seed=SEED), sf.Rng(name, seed=SEED)
    generator = np.random.Generator(rng.bit_generator)
    mixed = [generator.random(), rng.random(), *generator.random(3), *rng.random(2)]
    assert mixed == twin.random(7).tolist()


@pytest.mark.parametrize("name", sorted(sf.RNGS))
def test_generators_are_pickled_copied_and_spawned(name: str) -> None:
    generator = np.random.Generator(sf.Rng(name, seed=SEED).bit_generator)
    generator.random(3)
    twins = [pickle.loads(pickle.dumps(generator)), copy.deepcopy(generator)]
    expected = generator.random(5).tolist()
    assert all(twin.random(5).tolist() == expected for twin in twins)
    children = generator.spawn(2)
    assert children[0].random() != children[1].random()
    assert np.random.default_rng(sf.Rng(name, seed=SEED).bit_generator).random() == sf.Rng(name, seed=SEED).random()


@pytest.mark.parametrize("name", sorted(sf.RNGS))
def test_state_is_got_and_set(name: str) -> None:
    rng, other = sf.Rng(name, seed=SEED), sf.Rng(name, seed=54321)
    rng.bits(3)
    other.bit_generator.state = rng.bit_generator.state
    assert other.random(5).tolist() == rng.random(5).tolist()


def test_raw_draws() -> None:
    raw = sf.Rng("minstd", seed=1).bit_generator.random_raw(10_000)
    assert raw[-1] == 1043618065
    assert isinstance(sf.Rng("minstd", seed=1).bit_generator.random_raw(), int)


def test_shuffling_a_list_may_draw_under_the_lock() -> None:
    rng = sf.Rng("pcg32", seed=SEED)

    class Drawing(list[int]):
        def __setitem__(self, key: Any, value: Any) -> None:
            rng.bits()
            super().__setitem__(key, value)

    items = Drawing(range(10))
    np.random.Generator(rng.bit_generator).shuffle(items)
    assert sorted(items) == list(range(10))


def test_threads_take_turns_through_both_faces() -> None:
    rng = sf.Rng("splitmix64", seed=SEED)
    generator = np.random.Generator(rng.bit_generator)
    drawn: list[np.ndarray] = []

    def draw(one: Any) -> None:
        for _ in range(200):
            drawn.append(one(500))

    threads = [threading.Thread(target=draw, args=(one,)) for one in (rng.random, generator.random) * 2]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    expected = sf.Rng("splitmix64", seed=SEED).random(4 * 200 * 500)
    assert np.array_equal(np.sort(np.concatenate(drawn)), np.sort(expected))


@pytest.mark.parametrize(
    ("value", "match"),
    [
        ({}, "pcg64dxsm"),
        ({"bit_generator": "PCG64"}, "PCG64"),
        ({"bit_generator": "PCG64DXSM"}, "state"),
        ({"bit_generator": "PCG64DXSM", "state": {"state": 1, "inc": 2}}, "odd"),
        ({"bit_generator": "PCG64DXSM", "state": {"state": 1 << 128, "inc": 1}}, "state word"),
        (np.random.SFC64(1).state, "SFC64"),
        (3, "pcg64dxsm"),
    ],
)
def test_bad_states_are_refused(value: Any, match: str) -> None:
    rng = sf.Rng("pcg64dxsm", seed=SEED)
    with pytest.raises(ValueError, match=match):
        rng.bit_generator.state = value
    assert rng.random() == sf.Rng("pcg64dxsm", seed=SEED).random()


@pytest.mark.parametrize("name", sorted(sf.RNGS))
def test_ctypes_and_cffi_draw_the_same_words(name: str) -> None:
    for kind in ("ctypes", "cffi"):
        if kind == "cffi":
            pytest.importorskip("cffi")
        bits, twin = sf.Rng(name, seed=SEED).bit_generator, np.random.Generator(sf.Rng(name, seed=SEED).bit_generator)
        face = getattr(bits, kind)
        assert face is getattr(bits, kind)
        assert face.next_double(face.state) == twin.random()
        assert face.next_uint32(face.state) == twin.integers(1 << 32, dtype=np.uint32)
        assert face.next_uint64(face.state) == twin.integers(1 << 64, dtype=np.uint64)


def test_numba_draws_through_numpys_generator() -> None:
    pytest.importorskip("numba")
    # In a process of its own: a wrong pointer ends it.
    code = """
        import numba, numpy as np, sunfleck as sf

        @numba.njit
        def total(generator, n):
            s = 0.0
            for _ in range(n):
                s += generator.random()
            return s

        for name in sf.RNGS:
            rng, twin = sf.Rng(name, seed=12345), sf.Rng(name, seed=12345)
            s = 0.0
            for x in twin.random(100).tolist():
                s += x
            assert total(np.random.Generator(rng.bit_generator), 100) == s, name
            assert rng.random() == twin.random(), name
        print("alike")
    """
    command = [sys.executable, "-W", "ignore", "-c", textwrap.dedent(code)]
    assert subprocess.run(command, capture_output=True, text=True, check=True).stdout == "alike\n"


@pytest.mark.parametrize("name", sorted(set(sf.RNGS) - {"ran1", "ran2", "sfc64"}))
@pytest.mark.parametrize("drawn", [0, 1, 5])
def test_advance_passes_over_native_draws(name: str, drawn: int) -> None:
    bits = sf.Rng(name, seed=SEED).bit_generator
    bits.random_raw(drawn)
    expected = copy.deepcopy(bits).random_raw(1010)[1001:]
    assert np.array_equal(bits.advance(1001).random_raw(9), expected)


@pytest.mark.parametrize(
    "name", ["pcg32", "pcg64dxsm", "philox4x32", "philox4x64", "splitmix64", "xorshift64", "minstd", "randu"]
)
def test_advance_goes_back_and_round_the_period(name: str) -> None:
    bits = sf.Rng(name, seed=SEED, stream=2).bit_generator
    bits.random_raw(3)
    first = bits.random_raw(50)
    assert np.array_equal(bits.advance(-50).random_raw(50), first)
    assert np.array_equal(bits.advance(2**70 + 11).advance(-(2**70) - 61).random_raw(50), first)


def test_advance_is_numpys_for_pcg64dxsm() -> None:
    ours, theirs = BitGenerator("pcg64dxsm", 7), np.random.PCG64DXSM(7)
    for delta in (1, 2**64 + 3, 2**127 + 99, -5):
        assert ours.advance(delta).state == theirs.advance(delta).state


def test_what_cannot_advance_or_jump_says_so() -> None:
    for name in ("ran1", "ran2", "sfc64"):
        with pytest.raises(NotImplementedError, match=name):
            sf.Rng(name, seed=1).bit_generator.advance(5)
    for name in ("ran1", "sfc64", "minstd", "lcg64"):
        with pytest.raises(NotImplementedError, match=name):
            sf.Rng(name, seed=1).bit_generator.jumped()
    for wrong in (-1, 2**64):
        with pytest.raises(ValueError, match="delta"):
            sf.Rng("mt19937", seed=1).bit_generator.advance(wrong)
    with pytest.raises(TypeError, match="delta"):
        sf.Rng("pcg32", seed=1).bit_generator.advance(1.5)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["pcg32", "pcg64dxsm", "xoshiro256++", "philox4x32", "mt19937", "combined"])
def test_jumped_is_a_copy_ahead(name: str) -> None:
    rng = sf.Rng(name, seed=SEED)
    before = rng.state
    once, twice = rng.bit_generator.jumped(), rng.bit_generator.jumped(2)
    assert rng.state == before
    assert once.jumped().random_raw() == twice.random_raw()
    rng.skip(0x9E3779B97F4A7C15)
    assert once.random_raw() == rng.bit_generator.random_raw()


@pytest.mark.parametrize("name", sorted(NUMPY))
@pytest.mark.parametrize("seed", [0, 5, [1, 2, 3], 2**200 + 1])
def test_a_name_and_a_seed_are_numpys(name: str, seed: Any) -> None:
    ours, numpy = BitGenerator(name, seed), getattr(np.random, NUMPY[name])(seed)
    assert np.array_equal(ours.random_raw(700), numpy.random_raw(700))
    children = zip(ours.spawn(3), numpy.spawn(3), strict=True)
    assert all(a.random_raw() == b.random_raw() for a, b in children)
    assert ours.seed_seq.entropy == seed


@pytest.mark.parametrize("name", sorted(sf.RNGS))
def test_array_seeds_are_taken_by_all(name: str) -> None:
    words = {BitGenerator(name, seed).random_raw(2).tobytes() for seed in ([1], [1, 2], [2, 1], 1 << 100)}
    assert len(words) == 4
    again = BitGenerator(name, np.random.SeedSequence([1, 2])).random_raw(2).tobytes()
    assert again == BitGenerator(name, [1, 2]).random_raw(2).tobytes()
    assert BitGenerator(name).random_raw() != BitGenerator(name).random_raw()


def test_the_sequence_of_an_rng_spawns_something_new_each_time() -> None:
    rng = sf.Rng("pcg32", seed=5, stream=2)
    first, second = (rng.bit_generator.seed_seq.spawn(1)[0] for _ in range(2))
    assert first.entropy == (5, 2)
    assert first.spawn_key != second.spawn_key


@pytest.mark.parametrize(
    ("rng", "seed", "error"),
    [("pcg33", 1, ValueError), ("pcg32", -1, ValueError), ("pcg32", 1.5, TypeError), ("pcg32", "x", TypeError)],
)
def test_bad_seeds_are_refused(rng: str, seed: Any, error: type[Exception]) -> None:
    with pytest.raises(error):
        BitGenerator(rng, seed)


def test_a_seed_beside_an_rng_is_refused() -> None:
    with pytest.raises(TypeError, match="beside"):
        BitGenerator(sf.Rng("pcg32", seed=1), 2)
