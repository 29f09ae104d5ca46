# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""bit_generator: word for word with NumPy's generators, and beneath its distributions."""

import copy
import pickle
import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import sunfleck as sf

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


@pytest.mark.parametrize("attribute", ["ctypes", "cffi", "seed_seq"])
def test_what_is_missing_says_so(attribute: str) -> None:
    with pytest.raises(NotImplementedError):
        getattr(sf.Rng("sfc64", seed=1).bit_generator, attribute)
