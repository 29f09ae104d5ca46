# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""estimate: NumPy's and SciPy's figures, merging, samples that are not finite, bad input."""

import copy
import math
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
    assert m.sample_variance == pytest.approx(exact.var(ddof=1), rel=1e-13)
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


@pytest.mark.parametrize("scale", [1e155, 1e200, 1e307, 1.7e308])
def test_huge_samples_have_their_mean_and_claim_no_error(scale: float) -> None:
    u = 2 * sf.Rng("pcg32", seed=8).random(3000) - 1
    pieces = [moments_of(part * scale) for part in np.split(u, 5)]
    for m in (moments_of(u * scale), pieces[0]):
        for other in pieces[1:] if m is pieces[0] else ():
            m.merge(other)
        assert m.count == 3000
        # The sum cancels: 3000 terms below 1, each rounded by 2^-53, and as many roundings of the mean.
        assert m.mean / scale == pytest.approx(u.mean(), abs=1e-14)
        assert (m.variance, m.sample_deviation, m.standard_error, m.half_width()) == (np.inf,) * 4
    rows = (u * scale).reshape(-1, 3)
    vectors, channels, batches = sf.VectorMoments(), sf.ChannelMoments(), sf.BatchMeans(10)
    vectors.add(rows)
    channels.add(rows)
    batches.add(u * scale)
    for mean in (vectors.mean, channels.mean):
        assert np.array(mean) / scale == pytest.approx(u.reshape(-1, 3).mean(axis=0), abs=1e-14)
    assert (vectors.variance, channels.variance) == (np.inf, (np.inf,) * 3)
    assert batches.means.mean / scale == pytest.approx(u.mean(), abs=1e-14)


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


def test_float32_running_sums_are_lost_at_a_mean_of_a_million() -> None:
    x = 1e6 + np.tile([-1.0, 1.0], 5000)
    single, double = sf.RunningSums("float32"), sf.RunningSums()
    single.add(x)
    double.add(x)
    # The squares are 1e12: an ulp of their mean is 65,536 in float32. In float64 the sum, 1e16, is
    # rounded by 1 in each of 10,000 steps: at most 1 in its mean, some 0.1 as it comes.
    assert abs(single.variance - 1) > 1000
    assert double.variance == pytest.approx(1, abs=0.5)
    assert moments_of(x).variance == pytest.approx(1, rel=1e-9)


def test_float64_running_sums_are_lost_at_a_mean_of_1e8() -> None:
    sums = sf.RunningSums()
    sums.add(1e8 + np.tile([-1.0, 1.0], 5000))  # an ulp of 1e16 is 2
    assert abs(sums.variance - 1) > 0.5


def test_running_sums_are_the_lecture_s() -> None:
    sums = sf.RunningSums()
    sums.add([1.0, 2.0, 6.0])
    assert (sums.count, sums.m, sums.s, sums.mean) == (3, 9.0, 41.0, 3.0)
    assert sums.variance == pytest.approx(41 / 3 - 9)
    assert sums.standard_error == pytest.approx(math.sqrt((41 / 3 - 9) / 2))
    sums.add(np.nan)
    assert np.isnan(sums.mean)


def test_weighted_moments_are_numpys() -> None:
    rng = sf.Rng("pcg32", seed=7)
    x, w = rng.random(1000), rng.random(1000)
    m, tail = sf.WeightedMoments(), sf.WeightedMoments()
    m.add(x[:400], w[:400])
    tail.add(x[400:], weights=w[400:])
    m.merge(tail)
    mean = np.average(x, weights=w)
    assert m.mean == pytest.approx(mean, rel=1e-13)
    assert m.variance == pytest.approx(np.average((x - mean) ** 2, weights=w), rel=1e-12)
    assert m.weight == pytest.approx(w.sum())
    equal = sf.WeightedMoments()
    equal.add(x, 0.25)
    assert equal.standard_error == pytest.approx(stats.sem(x), rel=1e-10)
    equal.add([1.0, 1.0, np.nan], [-1.0, np.inf, 1.0])
    assert (equal.count, equal.nonfinite) == (1000, 3)


@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_channel_moments_are_those_of_each_channel(dtype: str) -> None:
    x = sf.Rng("pcg32", seed=8).random((500, 3), dtype=dtype)
    m, tail = sf.ChannelMoments(), sf.ChannelMoments()
    m.add(x[:100])
    tail.add(x[100:])
    m.merge(tail)
    m.add([np.nan, 0, 0])
    exact = x.astype("float64")
    assert (m.count, m.nonfinite) == (500, 1)
    assert m.mean == pytest.approx(exact.mean(axis=0), rel=1e-13)
    assert m.variance == pytest.approx(exact.var(axis=0), rel=1e-12)
    assert m.standard_error == pytest.approx(stats.sem(exact), rel=1e-12)


def test_batch_means_are_the_moments_of_the_means() -> None:
    x = sf.Rng("pcg32", seed=9).random(1030)
    batches = sf.BatchMeans(50)
    batches.add(x[:333])
    batches.add(x[333:])
    assert batches.means.count == 20
    assert batches.means.standard_error == pytest.approx(stats.sem(x[:1000].reshape(20, 50).mean(axis=1)), rel=1e-12)
    assert batches.half_width(0.9) == batches.means.half_width(0.9)


def test_bernstein_is_the_paper_s() -> None:
    x = sf.Rng("pcg32", seed=10).random(400)
    log = math.log(4 / 0.05)
    expected = math.sqrt(2 * x.var(ddof=1) * log / 400) + 7 * 3 * log / (3 * 399)
    assert moments_of(x).bernstein_half_width(-1, 2) == pytest.approx(expected, rel=1e-12)


def test_a_confidence_sequence_holds_at_every_look() -> None:
    missed = 0
    for stream in range(200):
        c = sf.ConfidenceSequence(0, 1, confidence=0.9)
        for x in sf.Rng("pcg32", seed=11, stream=stream).random((40, 50)):
            c.add(x**3)
            missed += not c.lower <= 0.25 <= c.upper
            if not c.lower <= 0.25 <= c.upper:
                break
    assert missed <= 20 + 17  # a tenth, and four deviations of 4.2


def test_a_target_is_reached_sooner() -> None:
    x = sf.Rng("pcg32", seed=12).random(7000)
    aimed, plain = sf.ConfidenceSequence(0, 1, target=0.01), sf.ConfidenceSequence(0, 1)
    aimed.add(x)
    plain.add(x)
    assert aimed.upper - aimed.lower <= 0.02 < plain.upper - plain.lower
    aimed.add([np.nan, 2.0])
    assert (aimed.nonfinite, aimed.outside, aimed.lower, aimed.upper) == (1, 1, -np.inf, np.inf)


def test_quantiles_are_scipys() -> None:
    for p in (1e-9, 0.01, 0.3, 0.5, 0.9, 0.975, 1 - 1e-9):
        assert sf.estimate.normal_quantile(p) == pytest.approx(stats.norm.ppf(p), rel=1e-9, abs=1e-12)
        for dof in (1, 2.5, 7, 15, 31, 1000, 1e6):
            assert sf.estimate.student_t_quantile(p, dof) == pytest.approx(stats.t.ppf(p, dof), rel=1e-7, abs=1e-9)


@pytest.mark.parametrize(
    ("make", "more"),
    [
        (sf.RunningSums, ([1.0, 2.0],)),
        (lambda: sf.RunningSums("float32"), ([1.0, 2.0],)),
        (sf.WeightedMoments, ([1.0, 2.0], [1.0, 3.0])),
        (sf.ChannelMoments, ([[1.0, 2.0, 3.0]],)),
        (lambda: sf.BatchMeans(2), ([1.0, 2.0, 3.0],)),
        (lambda: sf.ConfidenceSequence(0, 5), ([1.0, 2.0],)),
    ],
)
def test_every_kind_can_be_pickled(make: Any, more: Any) -> None:
    one = make()
    one.add(*more)
    for twin in (pickle.loads(pickle.dumps(one)), copy.deepcopy(one)):
        assert type(twin) is type(one)
        twin.add(*more)
        one_more = pickle.loads(pickle.dumps(one))
        one_more.add(*more)
        assert twin.__getstate__() == one_more.__getstate__() != one.__getstate__()


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
        (lambda: sf.ChannelMoments().add([1.0, 2.0]), ValueError, r"\(2,\)"),
        (lambda: sf.WeightedMoments().add([1.0, 2.0], [1.0, 2.0, 3.0]), ValueError, "weights have shape"),
        (lambda: sf.BatchMeans(0), ValueError, "size is 0"),
        (lambda: sf.RunningSums("float16"), TypeError, "dtype"),
        (lambda: sf.ConfidenceSequence(1, 0), ValueError, r"\[1, 0\]"),
        (lambda: sf.ConfidenceSequence(0, 1, 1.0), ValueError, "confidence"),
        (lambda: sf.ConfidenceSequence(0, 1, target=0), ValueError, "target"),
        (lambda: sf.Moments().bernstein_half_width(1, 0), ValueError, r"\[1.0, 0.0\]"),
        (lambda: sf.estimate.betting_interval([0.5, 2.0], 0, 1), ValueError, "sample 1 is 2"),
    ],
)
def test_bad_input_is_named(call: Any, error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=match):
        call()


@pytest.mark.parametrize("p", [5e-324, 1e-310, 2.3e-308, 1e-291, 1e-289])
def test_the_normal_quantile_of_the_smallest_probabilities(p: float) -> None:
    special = pytest.importorskip("scipy.special")
    assert special.log_ndtr(sf.estimate.normal_quantile(p)) == pytest.approx(np.log(p), rel=1e-10)
