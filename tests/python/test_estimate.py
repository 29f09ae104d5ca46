# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""estimate: NumPy's and SciPy's figures, merging, samples that are not finite, bad input."""

import copy
import pickle
from typing import Any

import numpy as np
import pytest
from scipy import stats

import sunfleck as sf


def moments_of(x: Any) -> sf.Moments:
    m = sf.Moments()
    m.add(x)
    return m


@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_moments_are_numpys(dtype: str) -> None:
    x = sf.Rng("pcg32", seed=1).random(100_001, dtype=dtype)
    m, exact = moments_of(x), x.astype("float64")
    assert m.count == len(x)
    assert m.mean == pytest.approx(exact.mean(), rel=1e-14)
    assert m.variance == pytest.approx(exact.var(), rel=1e-13)
    assert m.sample_deviation == pytest.approx(exact.std(ddof=1), rel=1e-13)
    assert m.standard_error == pytest.approx(stats.sem(exact), rel=1e-13)


def test_the_mean_does_not_cancel_the_variance() -> None:
    # The lecture's sums lose this altogether: mean / sigma is 10^9.
    x = 1e9 + np.tile([-1.0, 1.0], 50_000)
    assert moments_of(x).variance == pytest.approx(1, rel=1e-6)


def test_one_by_one_is_the_same_as_at_once() -> None:
    x = sf.Rng("pcg32", seed=2).random(1000)
    m = sf.Moments()
    for value in x:
        m.add(value)
    assert m.variance == pytest.approx(moments_of(x).variance, rel=1e-13)


def test_merge_is_as_if_added() -> None:
    x = sf.Rng("pcg32", seed=3).random(3000)
    m = moments_of(x[:1000])
    m.merge(moments_of(x[1000:]))
    m.merge(sf.Moments())
    assert m.count == 3000
    assert m.mean == pytest.approx(x.mean(), rel=1e-14)
    assert m.variance == pytest.approx(x.var(), rel=1e-13)
    m.merge(m)
    assert m.count == 6000
    assert m.variance == pytest.approx(x.var(), rel=1e-13)


def test_what_is_not_finite_is_counted_and_left_out() -> None:
    m = moments_of([1.0, np.nan, 3.0, np.inf, -np.inf])
    assert (m.count, m.nonfinite, m.mean) == (2, 3, 2.0)


def test_little_is_known_of_few_samples() -> None:
    m = sf.Moments()
    assert np.isnan(m.mean)
    assert np.isnan(m.variance)
    m.add(3)
    assert (m.mean, m.variance, m.standard_error, m.half_width()) == (3.0, 0.0, np.inf, np.inf)


@pytest.mark.parametrize("n", [2, 3, 10, 1000])
@pytest.mark.parametrize("confidence", [0.5, 0.95, 0.999])
def test_half_width_is_students(n: int, confidence: float) -> None:
    x = sf.Rng("pcg32", seed=4).random(n)
    expected = stats.t.ppf((1 + confidence) / 2, n - 1) * stats.sem(x)
    assert moments_of(x).half_width(confidence) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("kind", [sf.Moments, sf.VectorMoments])
def test_pickle_and_copy_go_on_where_they_were(kind: Any) -> None:
    m = kind()
    m.add(sf.Rng("pcg32", seed=5).random((10, 3)))
    for twin in (pickle.loads(pickle.dumps(m)), copy.deepcopy(m)):
        assert (twin.count, twin.mean, twin.variance) == (m.count, m.mean, m.variance)
        twin.add([7.0, 7.0, 7.0])
        assert twin.count > m.count


def test_vector_moments_keep_one_variance_of_the_distance() -> None:
    x = sf.Rng("pcg32", seed=6).random((500, 3))
    m = sf.VectorMoments()
    m.add(x[:200].astype("float32").astype("float64"))
    other = sf.VectorMoments()
    other.add(x[200:].reshape(3, 100, 3))
    m.merge(other)
    assert m.count == 500
    assert m.mean == pytest.approx(x.mean(axis=0), abs=1e-7)
    assert m.variance == pytest.approx(((x - x.mean(axis=0)) ** 2).sum(axis=1).mean(), rel=1e-6)
    m.add([1.0, np.nan, 1.0])
    assert (m.count, m.nonfinite) == (500, 1)


@pytest.mark.parametrize(
    ("call", "error", "match"),
    [
        (lambda: sf.Moments().add("x"), TypeError, "real numbers"),
        (lambda: sf.Moments().add([1j]), TypeError, "complex"),
        (lambda: sf.Moments().add([[1], [2, 3]]), ValueError, "regular"),
        (lambda: sf.Moments().merge(3), TypeError, "other"),  # type: ignore[arg-type]
        (lambda: sf.Moments().merge(sf.VectorMoments()), TypeError, "other"),  # type: ignore[arg-type]
        (lambda: sf.Moments().half_width(0), ValueError, "confidence"),
        (lambda: sf.Moments().half_width(1), ValueError, "confidence"),
        (lambda: sf.Moments().half_width("high"), TypeError, "confidence"),  # type: ignore[arg-type]
        (lambda: sf.VectorMoments().add([1.0, 2.0]), ValueError, r"\(2,\)"),
    ],
)
def test_bad_input_is_named(call: Any, error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=match):
        call()
