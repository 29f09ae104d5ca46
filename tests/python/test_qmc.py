# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""qmc: what SciPy's own tests ask of an engine, of every pattern; SciPy's users of engines."""

import copy
import inspect
import subprocess
import sys
import warnings
from typing import Any

import numpy as np
import pytest
from scipy import integrate, optimize, stats
from scipy.stats import qmc, sampling

import sunfleck as sf
from sunfleck.qmc import Engine

NAMES = sorted(sf.PATTERNS)
SEED = 170382760648021597650530316304495310428  # SciPy's tests'; beyond 64 bits


def count_near(name: str, n: int, d: int) -> int:
    return next(count for count in sf.valid_counts(name, n, d) if count)


def draws_on_seed(name: str) -> bool:
    n = count_near(name, 4, 2)
    return not np.array_equal(sf.points(name, n, 2, seed=1), sf.points(name, n, 2, seed=2))


SEQUENCES = [name for name in NAMES if not Engine(name, 1)._needs_total]
SETS = [name for name in NAMES if name not in SEQUENCES]
SEEDED = [name for name in NAMES if draws_on_seed(name)]


def test_it_is_an_engine_and_both_kinds_are_tried() -> None:
    assert issubclass(Engine, qmc.QMCEngine)
    assert {"random", "halton", "sobol"} <= set(SEQUENCES)
    assert {"uniform", "jittered"} <= set(SETS)
    assert {"random", "jittered", "halton", "sobol"} <= set(SEEDED)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("d", [1, 3, 8])
def test_points_are_the_patterns(name: str, d: int) -> None:
    d = min(d, 4) if name == "sz" else d  # which has four dimensions
    n = count_near(name, 256, d)
    expected = sf.points(name, n, d, seed=11, dtype="float64")
    for engine in (Engine(name, d, seed=11), Engine(name, d, rng=11), Engine(name, d, seed=np.int64(11), total=n)):
        sample = engine.random(n)
        assert sample.dtype == np.float64
        assert np.array_equal(sample, expected)
        assert engine.num_generated == n


@pytest.mark.parametrize("name", NAMES)
def test_no_dimensions_and_no_points(name: str) -> None:
    assert Engine(name, 0).random(4).shape == (4, 0)
    engine = Engine(name, 2)
    assert engine.random(0).shape == (0, 2)
    assert engine.num_generated == 0
    n = count_near(name, 1, 2)
    assert engine.random(n).shape == (n, 2)


@pytest.mark.parametrize("name", SEQUENCES)
def test_a_sequence_goes_on(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        d = 4 if name == "sz" else 5
        whole = Engine(name, d, seed=SEED).random(64)
        engine = Engine(name, d, seed=SEED)
        parts = [engine.random(n) for n in (1, 3, 12, 0, 17, 31)]
    assert np.array_equal(np.concatenate(parts), whole)
    assert engine.num_generated == 64


@pytest.mark.parametrize("name", SEQUENCES)
def test_fast_forward_skips(name: str) -> None:
    whole = Engine(name, 2, seed=3).random(64)
    engine = Engine(name, 2, seed=3)
    assert engine.fast_forward(13) is engine
    assert np.array_equal(engine.random(51), whole[13:])
    engine.reset()
    draws = [engine.random() if i % 2 == 0 else engine.fast_forward(1).random(0) for i in range(8)]
    assert np.array_equal(np.concatenate(draws), whole[:8:2])
    assert engine.num_generated == 8


@pytest.mark.parametrize("name", SETS)
def test_a_set_of_known_total_goes_on_to_its_end(name: str) -> None:
    n = count_near(name, 64, 2)
    whole = sf.points(name, n, 2, seed=5, dtype="float64")
    engine = Engine(name, 2, total=n, seed=5)
    assert np.array_equal(
        np.concatenate([engine.random(9), engine.fast_forward(1).random(n - 10)]), whole[np.arange(n) != 9]
    )
    with pytest.raises(ValueError, match=f"1 points after {n}.*total of {n}"):
        engine.random()
    with pytest.raises(ValueError, match="total"):
        engine.fast_forward(1)
    assert np.array_equal(engine.reset().random(n), whole)
    engine.reset().random(4)[:] = 0  # the caller's own
    assert np.array_equal(engine.reset().random(4), whole[:4])


@pytest.mark.parametrize("name", SETS)
def test_without_a_total_each_call_draws_a_set_of_its_own(name: str) -> None:
    n = count_near(name, 64, 2)
    engine = Engine(name, 2, seed=5)
    first, second = engine.random(n), engine.random(n)
    assert engine.num_generated == 2 * n
    assert np.array_equal(first, sf.points(name, n, 2, seed=5, dtype="float64"))
    assert np.array_equal(first, second) == (name not in SEEDED)
    assert np.array_equal(engine.reset().random(n), first)
    assert np.array_equal(engine.reset().fast_forward(n).random(n), second)


@pytest.mark.parametrize("name", SEEDED)
@pytest.mark.parametrize("source", [SEED, None, "generator", "sequence"])
def test_reset_repeats(name: str, source: Any) -> None:
    rng = {"generator": np.random.default_rng(SEED), "sequence": np.random.SeedSequence(SEED)}.get(source, source)
    engine = Engine(name, 2, rng=rng)
    sample = engine.random(16)
    assert engine.reset() is engine
    assert engine.num_generated == 0
    assert np.array_equal(engine.random(16), sample)


@pytest.mark.parametrize("name", SEEDED)
def test_engines_of_one_generator_are_independent_and_repeatable(name: str) -> None:
    def three() -> list[Any]:
        rng = np.random.default_rng(7)
        return [Engine(name, 2, rng=rng).random(16) for _ in range(3)]

    a, b, c = three()
    assert not np.array_equal(a, b)
    assert not np.array_equal(a, c)
    assert not np.array_equal(b, c)
    assert np.array_equal(three(), [a, b, c])


def test_every_source_of_randomness_is_taken() -> None:
    sources = [SEED, 3, np.uint64(2**64 - 1), np.random.default_rng(1), np.random.RandomState(1)]
    sources += [np.random.SeedSequence(1), np.random.PCG64(2), sf.Rng("pcg32", seed=1), [1, 2, 3]]
    seeds = [Engine("sobol", 2, rng=source).seed for source in sources]
    assert seeds[1:3] == [3, 2**64 - 1]
    assert len(set(seeds)) == len(seeds)
    assert all(0 <= seed < 1 << 64 for seed in seeds)
    assert Engine("sobol", 2).seed != Engine("sobol", 2).seed


@pytest.mark.parametrize("name", [name for name in NAMES if name not in ("uniform", "random")])
def test_points_are_spread_better_than_random_ones(name: str) -> None:
    n = count_near(name, 1024, 2)
    sample = Engine(name, 2, seed=2).random(n)
    random = np.mean([qmc.discrepancy(Engine("random", 2, seed=seed).random(n)) for seed in range(5)])
    assert qmc.discrepancy(sample) < 0.7 * random


def test_distribution_is_uniform_in_every_dimension() -> None:
    # SciPy's test_distribution: 1,024 points in 50 dimensions, to 1e-2.
    for name in ("sobol", "halton"):
        sample = Engine(name, 50, seed=SEED).random(1024)
        for share in (0.25, 0.5, 0.75):
            assert np.abs(np.quantile(sample, share, axis=0) - share).max() < 1e-2
        assert np.abs(sample.mean(axis=0) - 0.5).max() < 1e-2


def test_plain_sequences_are_scipys() -> None:
    gray = np.arange(256) ^ np.arange(256) >> 1
    for off in (None, False):
        ours = Engine("sobol", 10, scramble=off).random(256)
        assert np.array_equal(ours[gray], qmc.Sobol(10, scramble=False, bits=53).random(256))
    assert np.array_equal(Engine("sobol", 2, scramble=True, seed=1).random(8), Engine("sobol", 2, seed=1).random(8))


@pytest.mark.parametrize("optimization", ["random-cd", "lloyd"])
def test_optimizers_are_scipys(optimization: str) -> None:
    plain = Engine("halton", 2, scramble=None).random(64)
    engine = Engine("halton", 2, scramble=None, optimization=optimization, seed=1)
    sample = engine.random(64)
    if optimization == "random-cd":
        assert qmc.discrepancy(sample) < qmc.discrepancy(plain)
    else:
        assert sf.uniformity.minimum_distance(sample) > sf.uniformity.minimum_distance(plain)
    assert np.array_equal(engine.reset().random(64), sample)  # its generator is reset too


@pytest.mark.skipif("pad" not in inspect.signature(sf.points).parameters, reason="points has no padding")
def test_padding_is_the_patterns() -> None:
    options: dict[str, Any] = {"pad": 2}
    expected = sf.points("sobol", 64, 8, seed=3, dtype="float64", **options)
    engine = Engine("sobol", 8, seed=3, **options)
    assert np.array_equal(np.concatenate([engine.random(16), engine.random(48)]), expected)
    assert engine._init_quad["pad"] == 2


def test_integers_and_scale() -> None:
    drawn = Engine("sobol", 2, seed=1).integers([0, -5], u_bounds=[10, 5], n=1024, endpoint=True)
    assert drawn.dtype == np.int64
    assert np.array_equal(np.unique(drawn[:, 0]), np.arange(11))
    assert np.array_equal(np.unique(drawn[:, 1]), np.arange(-5, 6))
    counts = np.bincount(Engine("sobol", 1, seed=1).integers(8, n=1024).ravel())
    assert np.array_equal(counts, np.full(8, 128))
    scaled = qmc.scale(Engine("halton", 2, seed=1).random(100), [-1, 2], [1, 4])
    assert (scaled >= [-1, 2]).all()
    assert (scaled < [1, 4]).all()


def test_workers_change_no_bit() -> None:
    one = Engine("sobol", 4, seed=1).random(1 << 15)
    for workers in (2, -1):
        assert np.array_equal(Engine("sobol", 4, seed=1).random(1 << 15, workers=workers), one)


def test_copies_go_on_alike() -> None:
    engine = Engine("sobol", 3, seed=1)
    engine.random(4)
    assert np.array_equal(copy.deepcopy(engine).random(4), engine.random(4))


def test_sobol_warns_once() -> None:
    engine = Engine("sobol", 2)
    with pytest.warns(UserWarning, match="power of two"):
        engine.random(3)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        engine.random(5)


@pytest.mark.parametrize("name", NAMES)
def test_scramble_true_randomizes_or_is_refused(name: str) -> None:
    n = count_near(name, 16, 2)
    if name == "uniform":
        with pytest.raises(ValueError, match="nothing randomizes uniform"):
            Engine(name, 2, scramble=True, seed=1)
        return
    a, b = (Engine(name, 2, scramble=True, seed=seed).random(n) for seed in (1, 2))
    assert not np.array_equal(a, b)
    if name in SEQUENCES:  # point 0 is uniform over the seeds: six standard deviations of the mean of 200
        first = np.array([Engine(name, 2, scramble=True, seed=seed).random()[0] for seed in range(200)])
        assert np.abs(first.mean(axis=0) - 0.5).max() < 6 / np.sqrt(12 * 200)


@pytest.mark.parametrize("name", NAMES)
def test_numpys_integers_leave_the_next_draw_as_it_was(name: str) -> None:
    n = count_near(name, 16, 1)
    plain, engine = Engine(name, 1, seed=1), Engine(name, 1, seed=1)
    kinds: list[Any] = [np.int64, np.uint64, np.uint8, np.prod]
    for kind in kinds:
        assert np.array_equal(engine.random(kind(n)), plain.random(n))
        assert type(engine.num_generated) is int
    assert engine.fast_forward(np.int64(3)).num_generated == plain.fast_forward(3).num_generated
    assert type(engine.num_generated) is int
    assert np.array_equal(engine.random(n), plain.random(n))


def test_qrvs_draws_twice() -> None:
    normal = sampling.NumericalInversePolynomial(stats.norm())
    engine = Engine("halton", 1, seed=1)
    for _ in range(2):
        assert normal.qrvs(size=(3, 2), qmc_engine=engine).shape == (3, 2)


def test_a_seed_sequence_is_advanced() -> None:
    sequence, again = np.random.SeedSequence(1), np.random.SeedSequence(1)
    a, b = (Engine("sobol", 2, seed=sequence).seed for _ in range(2))
    assert a != b
    assert Engine("sobol", 2, rng=again).seed == a
    assert np.random.SeedSequence(1).generate_state(1, np.uint64)[0] != a


def test_random_base2() -> None:
    engine, whole = Engine("sobol", 2, seed=1), Engine("sobol", 2, seed=1).random(8)
    assert np.array_equal(engine.random_base2(2), whole[:4])
    assert np.array_equal(engine.random_base2(np.int64(2)), whole[4:])
    with pytest.raises(ValueError, match="4 points after 8 are 12, no power of two"):
        engine.random_base2(2)
    assert Engine("halton", 2, seed=1).random_base2(3).shape == (8, 2)


# ---- SciPy's users of engines ----

with_quad = pytest.mark.skipif(not hasattr(integrate, "qmc_quad"), reason="SciPy 1.11 has qmc_quad")


@with_quad
@pytest.mark.parametrize("name", NAMES)
def test_qmc_quad_takes_every_pattern(name: str) -> None:
    n = count_near(name, 1024, 2)
    result = integrate.qmc_quad(
        lambda x: np.exp(x[0]) * x[1], [0, 0], [1, 2], n_points=n, n_estimates=8, qrng=Engine(name, 2, seed=4)
    )
    exact = 2 * (np.e - 1)
    # Random points: deviation 2.3 / sqrt(8 * 1024), by the integrand's variance; five of them.
    assert abs(result.integral - exact) < 5 * 2.3 / np.sqrt(8 * n)
    if name in SEEDED:
        # Student's t of 7 degrees of freedom is beyond 8 once in 10,000.
        assert result.standard_error > 0
        assert abs(result.integral - exact) < 8 * result.standard_error


@with_quad
def test_qmc_quad_estimates_are_independent_though_the_first_is_plain() -> None:
    engine = Engine("sobol", 2, scramble=None, seed=1)
    result = integrate.qmc_quad(lambda x: x[0] * x[1], [0, 0], [1, 1], n_points=256, n_estimates=4, qrng=engine)
    assert result.standard_error > 0


@with_quad
@pytest.mark.parametrize("name", ["lattice", "r2", "hammersley"])
@pytest.mark.parametrize("scramble", [True, "default", None])
def test_qmc_quads_error_of_plain_patterns_is_not_nothing(name: str, scramble: Any) -> None:
    engine = Engine(name, 2, scramble=scramble, seed=1)
    result = integrate.qmc_quad(lambda x: np.exp(x[0] * x[1]), [0, 0], [1, 1], n_points=64, n_estimates=8, qrng=engine)
    assert result.standard_error > 0
    assert abs(result.integral - 1.3179021514544) < 8 * result.standard_error + (0.05 if scramble is not True else 0)


@with_quad
def test_qmc_quad_keeps_the_options() -> None:
    engine = Engine("jittered", 2, total=64, seed=1)
    again = type(engine)(seed=np.random.default_rng(1), **engine._init_quad)
    assert again.total == 64
    assert again.pattern == "jittered"
    with pytest.raises(ValueError, match="total of 64"):
        integrate.qmc_quad(lambda x: x[0], [0, 0], [1, 1], n_points=100, qrng=engine)


def test_multivariate_normal_and_multinomial() -> None:
    cov = [[2.0, 0.5], [0.5, 1.0]]
    sample = qmc.MultivariateNormalQMC([1.0, -1.0], cov, engine=Engine("sobol", 2, seed=1)).random(4096)
    # Errors of a smooth map of a net: far below the 0.02 of independent samples.
    assert np.abs(sample.mean(axis=0) - [1, -1]).max() < 2e-3
    assert np.abs(np.cov(sample.T) - cov).max() < 2e-2
    boxed = qmc.MultivariateNormalQMC([0, 0], inv_transform=False, engine=Engine("halton", 2, seed=1)).random(1000)
    assert np.isfinite(boxed).all()
    counts = qmc.MultinomialQMC([0.2, 0.3, 0.5], 1024, engine=Engine("sobol", 1, seed=1)).random(1)
    assert np.abs(counts - [205, 307, 512]).max() <= 2


def test_distributions_are_inverted_from_an_engine() -> None:
    normal = sampling.NumericalInversePolynomial(stats.norm())
    drawn = normal.qrvs(1024, qmc_engine=Engine("sobol", 1, seed=1))
    assert stats.kstest(drawn, "norm").statistic < 2 / 1024  # a (0,m,1)-net: within 1/n of the ranks


def test_differential_evolution_starts_from_a_sample() -> None:
    start = qmc.scale(Engine("sobol", 2, seed=1).random(32), [-5, -5], [5, 5])
    result = optimize.differential_evolution(optimize.rosen, [(-5, 5), (-5, 5)], init=start, maxiter=200)
    assert np.allclose(result.x, 1, atol=1e-3)


@pytest.mark.skipif(not hasattr(stats, "sobol_indices"), reason="SciPy 1.11 has sobol_indices")
def test_sobol_indices_take_an_engines_sample() -> None:
    # Ishigami's function, a = 7, b = 0.1: first-order indices 0.3139, 0.4424, 0 (Saltelli et al.
    # 2008). Matrices A and B are two halves of one sample's columns, as SciPy draws them.
    def f(x: Any) -> Any:
        return np.sin(x[0]) + 7 * np.sin(x[1]) ** 2 + 0.1 * x[2] ** 4 * np.sin(x[0])

    sample = qmc.scale(Engine("sobol", 6, seed=1).random(8192), [-np.pi] * 6, [np.pi] * 6).T
    a, b = sample[:3], sample[3:]
    ab = np.stack([np.where(np.arange(3)[:, None] == i, b, a) for i in range(3)])
    values = {"f_A": f(a)[None], "f_B": f(b)[None], "f_AB": np.stack([f(x)[None] for x in ab])}
    indices = stats.sobol_indices(func=values, n=8192).first_order
    assert np.abs(indices - [0.3139, 0.4424, 0]).max() < 0.01


# ---- without SciPy; bad input ----


def test_scipy_is_imported_with_it_alone_and_missed_by_name() -> None:
    script = (
        "import sys\nimport sunfleck as sf\nassert 'scipy' not in sys.modules\n"
        "sys.modules['scipy'] = None\n"
        "try:\n    sf.qmc\nexcept ImportError as error:\n    print(error)\n"
    )
    said = subprocess.check_output([sys.executable, "-c", script], text=True)
    assert "sunfleck.qmc needs SciPy 1.10 or later" in said


def test_it_is_found_as_an_attribute() -> None:
    assert sf.qmc.Engine is Engine
    with pytest.raises(AttributeError, match="qmd"):
        sf.__getattr__("qmd")


@pytest.mark.parametrize(
    ("options", "error", "match"),
    [
        ({"pattern": "sobel"}, ValueError, "sobel.*sobol"),
        ({"pattern": 3}, TypeError, "pattern is 3"),
        ({"d": -1}, ValueError, "non-negative"),
        ({"d": 1.5}, ValueError, "non-negative"),
        ({"d": 21202}, ValueError, "21202"),
        ({"scramble": "permuted"}, ValueError, "permuted"),
        ({"scramble": 3}, TypeError, "scramble"),
        ({"total": -1}, ValueError, "total is -1"),
        ({"pattern": "jittered", "total": 17}, ValueError, "17"),
        ({"optimization": "toto"}, ValueError, "toto"),
        ({"seed": -1}, ValueError, "seed is -1"),
        ({"seed": 1, "rng": 1}, TypeError, "rng and seed"),
    ],
)
def test_bad_options_are_named(options: dict[str, Any], error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=match):
        Engine(**{"pattern": "sobol", "d": 2, **options})


@pytest.mark.parametrize(
    ("name", "options", "error", "match"),
    [
        ("sobol", {"n": -1}, ValueError, "n is -1"),
        ("sobol", {"n": 2.0}, TypeError, "n is 2.0"),
        ("sobol", {"n": 4, "workers": 0}, ValueError, "workers"),
        ("jittered", {"n": 17}, ValueError, "17"),
    ],
)
def test_bad_draws_are_named_and_change_nothing(
    name: str, options: dict[str, Any], error: type[Exception], match: str
) -> None:
    engine = Engine(name, 2, seed=1)
    with pytest.raises(error, match=match):
        engine.random(**options)
    assert engine.num_generated == 0
    assert np.array_equal(engine.random(16), sf.points(name, 16, 2, seed=1, dtype="float64"))
