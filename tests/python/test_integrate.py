# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""integrate: known answers over every pattern, honesty, interruption, exceptions, bad input."""

import dataclasses
import math
import os
import re
import signal
import threading
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import sunfleck as sf

Block = NDArray[np.float64]


def circle(u: Block) -> Block:
    return np.where(u[:, 0] ** 2 + u[:, 1] ** 2 < 1.0, 4.0, 0.0)


@pytest.mark.parametrize("pattern", sorted(sf.PATTERNS))
@pytest.mark.parametrize("scramble", ["default", None])
def test_pi_over_every_pattern(pattern: str, scramble: str | None) -> None:
    pi = sf.integrate(circle, d=2, pattern=pattern, scramble=scramble, atol=0.01, seed=1)
    assert pi.stop_reason == "met"
    assert 0 < pi.half_width <= 0.01
    # One interval for each: at 0.95, twice the half-width is missed in some 1e-4 of the cases.
    assert abs(pi.value - math.pi) <= 2 * pi.half_width
    assert pi.history[-1] == (pi.samples, pi.value, pi.half_width)
    assert [look.samples for look in pi.history] == sorted({look.samples for look in pi.history})


@pytest.mark.parametrize(("pattern", "tolerance"), [("sobol", 1e-3), ("random", 3e-2), ("halton", 1e-2)])
def test_coverage_is_what_was_asked_for(pattern: str, tolerance: float) -> None:
    # 200 seeds: four binomial deviations at 0.9 are 0.085; above is as good as at.
    exact = math.prod(k * (math.exp(1 / k) - 1) for k in (1, 2, 3))
    runs = [
        sf.integrate(lambda u: np.exp(u @ [1, 1 / 2, 1 / 3]), 3, pattern, atol=tolerance, confidence=0.9, seed=seed)
        for seed in range(200)
    ]
    assert np.mean([abs(r.value - exact) <= r.half_width for r in runs]) > 0.9 - 0.085
    assert [r.stop_reason for r in runs].count("met") >= 194


def test_a_plain_tolerance_is_relative_as_in_render_and_atol_is_absolute() -> None:
    def large(u: Block) -> Block:
        return 1e6 * (1 + u[:, 0])

    plain = sf.integrate(large, 1, tolerance=1e-4)
    assert plain.stop_reason == "met"
    assert plain.half_width <= 1e-4 * plain.value
    assert plain == sf.integrate(large, 1, tolerance=sf.Tolerance(relative=1e-4)) == sf.integrate(large, 1, rtol=1e-4)
    absolute = sf.integrate(large, 1, atol=1e-4, max_samples=2**16)
    assert absolute.samples > plain.samples
    assert absolute == sf.integrate(large, 1, tolerance=sf.Tolerance(absolute=1e-4), max_samples=2**16)
    either = sf.integrate(large, 1, atol=1e3, rtol=1e-9)
    assert either.half_width <= 1e3


@pytest.mark.parametrize("pattern", ["sobol", "random", "jittered"])
def test_values_may_be_arrays(pattern: str) -> None:
    calls = 0

    def powers(x: Block) -> Block:
        nonlocal calls
        calls += len(x)
        return x[:, :1, None] ** np.arange(6.0).reshape(2, 3)

    r = sf.integrate(powers, 1, pattern, rtol=1e-2)
    assert calls == r.samples
    assert r.value.shape == r.half_width.shape == r.trusted.shape == (2, 3)
    assert (abs(r.value - 1 / np.arange(1, 7).reshape(2, 3)) <= 3 * r.half_width).all()
    assert (r.half_width <= 1e-2 * r.value).all()
    assert r.stop_reason == "met"
    assert np.array_equal(r.history[-1].value, r.value)
    # A component alone takes the same points.
    alone = sf.integrate(lambda x: x[:, 0] ** 5, 1, pattern, rtol=1e-2)
    shared = {look.samples: look.value[1, 2] for look in r.history}
    assert shared[alone.samples] == alone.value or pattern == "random"
    assert r == sf.integrate(powers, 1, pattern, rtol=1e-2)
    assert r != sf.integrate(powers, 1, pattern, rtol=1e-2, seed=1)
    assert "[" in str(r)


def test_a_tail_without_a_variance_is_suspicious_over_every_pattern() -> None:
    exact, wrong = 2.5, 0
    for pattern in ("random", "sobol", "halton", "latin"):
        for seed in range(20):
            r = sf.integrate(lambda x: x[:, 0] ** -0.6, 1, pattern, atol=0.1, seed=seed, max_samples=2**20)
            wrong += r.stop_reason == "met" and abs(r.value - exact) > r.half_width
    assert wrong <= 1


def test_the_same_seed_gives_the_same_result_for_any_threads() -> None:
    runs = [
        sf.integrate(circle, 2, threads=threads, seed=seed) for threads, seed in ((1, 5), (3, 5), (None, 5), (1, 6))
    ]
    assert runs[0] == runs[1] == runs[2]
    assert runs[0].value != runs[3].value


def test_blocks_are_the_function_s_own() -> None:
    kept: list[Block] = []

    def greedy(u: Block) -> Block:
        assert u.flags.c_contiguous
        assert u.flags.writeable
        kept.append(u)
        before: Block = u.sum(axis=1)
        u[:] = -1
        return before

    r = sf.integrate(greedy, 3, tolerance=1e-3)
    assert abs(r.value - 1.5) <= 2 * r.half_width
    assert sum(len(u) for u in kept) == r.samples
    assert all((u == -1).all() for u in kept)
    assert all(u.shape[1] == 3 and u.dtype == np.float64 for u in kept)


@pytest.mark.parametrize("dtype", ["bool", "int64", "float32", "float64"])
def test_any_real_dtype_may_be_returned(dtype: str) -> None:
    r = sf.integrate(lambda u: (u[:, 0] < 0.5).astype(dtype), 1, atol=1e-2)
    assert abs(r.value - 0.5) <= r.half_width


def test_equal_samples_leave_an_error() -> None:
    r = sf.integrate(lambda u: np.ones(len(u)), 2, atol=1e-3)
    assert (r.value, r.stop_reason) == (1, "met")
    assert r.half_width == pytest.approx(-math.log(0.05) / r.samples)


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
def test_samples_that_are_all_zero_are_suspicious_unless_a_range_says_what_may_hide(scale: float) -> None:
    def hidden(u: Block) -> Block:  # of measure 1e-12
        return np.asarray(scale * (u < 1e-6).all(axis=1))

    r = sf.integrate(hidden, 2, atol=1e-3)
    assert (r.value, r.stop_reason) == (0, "suspicious")
    ranged = sf.integrate(hidden, 2, atol=1e-1 * scale, value_range=(0, 10 * scale))
    assert ranged.stop_reason == "met"
    assert ranged.half_width == pytest.approx(-10 * scale * math.log(0.05) / ranged.samples)


# A share of 120 seeds: three binomial deviations at 0.95 are 0.06. Without shift and fold it was 0.30 to 0.75.
@pytest.mark.parametrize(
    ("pattern", "scramble"),
    [
        ("sobol", "owen"),
        ("sobol", "lms"),
        ("sobol", "nested"),
        ("sz", "owen"),
        ("latin", None),
        ("multijittered", None),
    ],
)
def test_a_step_beside_something_smooth_is_covered(pattern: str, scramble: str | None) -> None:
    rng = np.random.default_rng(11)
    covered = 0
    for seed in range(120):
        step = rng.random()
        r = sf.integrate(
            lambda u, t: (u[:, 0] < t) + u[:, 1] ** 2,
            2,
            pattern,
            atol=1e-3,
            args=step,
            scramble="default" if scramble is None else scramble,
            seed=seed,
        )
        covered += abs(r.value - (step + 1 / 3)) <= r.half_width
    assert covered / 120 > 0.95 - 0.06


# Likewise; here all points of a copy have one offset within their strata, and it was 0.61 to 0.79.
@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize(
    ("pattern", "scramble"),
    [
        ("halton", "default"),
        ("hammersley", "default"),
        ("hammersley", "owen"),
        ("lattice", "default"),
        ("sobol", "shift"),
        ("sz", "shift"),
    ],
)
def test_a_step_at_a_common_offset_is_covered(pattern: str, scramble: str, axis: int) -> None:
    rng = np.random.default_rng(12)
    covered = 0
    for seed in range(120):
        r = sf.integrate(
            lambda u, t: (u[:, axis] < t) + 0.1 * u[:, 1 - axis] ** 2,
            2,
            pattern,
            atol=3e-4,
            args=(step := rng.random()),
            scramble=scramble,
            seed=seed,
        )
        covered += abs(r.value - (step + 1 / 30)) <= r.half_width
    assert covered / 120 > 0.95 - 0.06


def test_a_common_offset_costs_a_smooth_function_three_doublings_at_most() -> None:
    """Before the third look the half-width is at least 1 - (0.005 * 17)^(1/17) = 0.135 of a stratum times the
    range, 0.135 * 2.35 / n for n points of a copy: 3.1e-4 at 1024."""

    def periodic(u: Block) -> Block:
        return np.asarray(np.exp(np.cos(2 * np.pi * u[:, 0])))

    r = sf.integrate(periodic, 1, "lattice", atol=1e-9, seed=1)
    assert r.stop_reason == "met"
    first, second, third = r.history[:3]
    assert first.half_width == pytest.approx(0.135 * 2.35 / 64, rel=0.03)
    assert second.half_width == pytest.approx(first.half_width / 2, rel=0.03)
    assert third.half_width == pytest.approx(first.half_width / 4, rel=0.03)
    assert r.samples <= 2**4 * 1024  # the fourth look no longer has the range


@pytest.mark.parametrize(
    ("pattern", "scramble"),
    [
        ("r2", "default"),
        ("halton", "default"),
        ("lattice", "shift"),
        ("hammersley", "default"),
        ("sobol", "shift"),
        ("sobol", "owen"),
    ],
)
def test_smooth_functions_are_not_suspected(pattern: str, scramble: str) -> None:
    for seed in range(10):
        for f in (lambda u: u[:, 0], lambda u: np.exp(np.cos(2 * np.pi * u[:, 0]))):
            r = sf.integrate(f, 1, pattern, atol=1e-4, scramble=scramble, seed=seed)
            assert r.stop_reason == "met", (seed, f)


def test_a_lognormal_of_a_heavy_tail_is_suspicious_and_a_light_one_is_covered() -> None:
    from scipy.special import ndtri

    def lognormal(u: Block, sigma: float) -> Block:
        return np.asarray(np.exp(sigma * ndtri(np.maximum(u[:, 0], 2**-54))))

    heavy = [sf.integrate(lognormal, 1, "random", rtol=0.1, args=3.0, seed=s) for s in range(20)]
    assert [r.stop_reason for r in heavy].count("suspicious") >= 18
    light = [sf.integrate(lognormal, 1, "random", rtol=0.01, args=0.5, seed=s) for s in range(60)]
    assert [r.stop_reason for r in light].count("met") >= 55
    # Three binomial deviations below 0.95 of 60.
    assert sum(abs(r.value - math.exp(0.125)) <= r.half_width for r in light) >= 52


def test_values_near_the_largest_double_do_not_overflow() -> None:
    r = sf.integrate(lambda u: 1.7e308 * u[:, 0], 1, rtol=1e-3)
    assert r.stop_reason == "met"
    assert abs(r.value - 0.85e308) <= r.half_width <= 1e-3 * r.value


def test_bounds_args_and_components() -> None:
    r = sf.integrate(lambda x, a, b: a * x[:, 0] + b, bounds=(1, 3), args=(2.0, 1.0), rtol=1e-4)
    assert abs(r.value - 10) <= 2 * r.half_width
    gauss = sf.integrate(
        lambda x: np.exp(-0.5 * (x**2).sum(axis=1)) / (2 * np.pi), bounds=([-np.inf, -np.inf], np.inf), atol=1e-3
    )
    assert abs(gauss.value - 1) <= 2 * gauss.half_width
    half = sf.integrate(lambda x: np.exp(-x[:, 0]), bounds=(0, np.inf), atol=1e-3)
    assert abs(half.value - 1) <= 2 * half.half_width
    powers = sf.integrate(lambda x: x[:, :1, None] ** [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]], 1, atol=1e-4)
    assert powers.value.shape == powers.half_width.shape == (2, 3)
    assert (abs(powers.value - 1 / np.array([[1, 2, 3], [4, 5, 6]])) <= 2 * powers.half_width).all()
    assert powers.half_width.max() <= 1e-4
    inside: list[Block] = []

    def kept(x: Block) -> Block:
        inside.append(x.copy())
        return x[:, 0]

    sf.integrate(kept, bounds=([2, -5], [3, -4]), rtol=1e-2)
    assert all(((x >= [2, -5]) & (x < [3, -4])).all() for x in inside)


@pytest.mark.parametrize(
    ("options", "error", "match"),
    [
        ({}, TypeError, "d is not given"),
        ({"bounds": (0, 0)}, ValueError, "bounds of dimension 0 are 0.0 and 0.0"),
        ({"bounds": ([0, 1], [1, math.nan])}, ValueError, "dimension 1"),
        ({"bounds": 3}, ValueError, "bounds is 3"),
        ({"bounds": ([0, 0], [1, 1]), "d": 3}, ValueError, "d is 3, but bounds has 2"),
        ({"d": 2, "tolerance": 1e-3, "atol": 1e-3}, ValueError, "choose one way"),
        ({"d": 2, "atol": -1.0}, ValueError, "-1"),
    ],
)
def test_bad_boxes_and_tolerances_are_named(options: dict[str, Any], error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=match):
        sf.integrate(circle, **options)


def test_a_value_beyond_the_range_is_told_to_the_last_digit() -> None:
    beyond = float(np.nextafter(1, 2))
    with pytest.raises(ValueError, match=re.escape(f"{beyond:.17g}")):
        sf.integrate(lambda u: np.full(len(u), beyond), 1, value_range=(0, 1))


def test_values_that_are_not_finite_make_it_suspicious() -> None:
    r = sf.integrate(lambda u: np.where(u[:, 0] < 0.1, np.nan, 1 + u[:, 1]), 2, atol=1e-2)
    assert r.stop_reason == "suspicious"
    assert r.nonfinite == pytest.approx(0.1 * r.samples, rel=0.1)
    assert r.value == pytest.approx(1.5, abs=0.01)
    assert f"{r.nonfinite} not finite" in str(r)


def test_a_heavy_tail_makes_it_suspicious() -> None:
    reasons = [sf.integrate(lambda u: u[:, 0] ** -0.6, 1, atol=0.05, seed=s).stop_reason for s in range(20)]
    assert reasons.count("suspicious") >= 18


def test_a_known_range_holds_at_every_look() -> None:
    missed = 0
    for seed in range(100):
        r = sf.integrate(
            lambda u: u[:, 0] < 0.01, 1, "random", atol=3e-3, confidence=0.9, value_range=(0, 1), seed=seed
        )
        missed += any(abs(look.value - 0.01) > look.half_width * (1 + 1e-12) for look in r.history)
        assert r.stop_reason == "met"
    assert missed <= 10 + 12  # a tenth, and four deviations of 3


def test_max_samples_stops_it() -> None:
    r = sf.integrate(circle, 2, atol=1e-9, max_samples=5000)
    assert r.stop_reason == "max_samples"
    assert r.samples == 4096
    assert r.half_width > 1e-9


def test_an_exception_of_the_function_is_the_caller_s() -> None:
    class Own(Exception):
        pass

    calls = 0

    def fail(u: Block) -> Block:
        nonlocal calls
        calls += 1
        if calls == 2:
            raise Own("mine")
        return circle(u)

    with pytest.raises(Own, match="mine"):
        sf.integrate(fail, 2, atol=1e-9)
    assert calls == 2


def test_ctrl_c_returns_what_is_known() -> None:
    calls = 0

    def interrupted(u: Block) -> Block:
        nonlocal calls
        calls += 1
        if calls == 6:
            os.kill(os.getpid(), signal.SIGINT)
        return circle(u)

    r = sf.integrate(interrupted, 2, atol=1e-9)
    assert r.stop_reason == "interrupted"
    assert abs(r.value - math.pi) <= 3 * r.half_width
    assert r.samples < 2**24


def test_other_threads_run_meanwhile() -> None:
    results: dict[int, sf.Integral] = {}

    def work(seed: int) -> None:
        results[seed] = sf.integrate(circle, 2, seed=seed)

    threads = [threading.Thread(target=work, args=(seed,)) for seed in range(4)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert all(results[seed] == sf.integrate(circle, 2, seed=seed) for seed in range(4))


def test_the_result_is_a_record() -> None:
    r = sf.integrate(circle, 2, tolerance=0.05)
    assert dataclasses.asdict(r)["samples"] == r.samples
    assert (r.confidence, r.replicates, r.shifted) == (0.95, 16, False)
    assert "95 %" in str(r)
    assert str(r).endswith("met")


@pytest.mark.parametrize(
    ("options", "error", "match"),
    [
        ({"f": 3}, TypeError, "f is 3"),
        ({"f": lambda u: u[:5]}, ValueError, r"f returned shape \(5, 2\) for 1024 points"),
        ({"f": lambda u: u[:, 0] * 1j}, TypeError, "complex"),
        ({"f": lambda u: None}, TypeError, "object"),
        ({"f": lambda u: 5 * u[:, 0], "value_range": (0, 1)}, ValueError, "outside the range of values"),
        ({"d": 0}, ValueError, "d is 0"),
        ({"pattern": "sobble"}, ValueError, "sobble"),
        ({"scramble": "permuted"}, ValueError, "scramble"),
        ({"tolerance": 0}, ValueError, "tolerance is 0"),
        ({"tolerance": -1}, ValueError, "tolerance is -1"),
        ({"tolerance": math.nan}, ValueError, "tolerance is nan"),
        ({"tolerance": "small"}, TypeError, "tolerance"),
        ({"confidence": 1}, ValueError, "confidence is 1"),
        ({"max_samples": 10}, ValueError, "max_samples is 10"),
        ({"min_samples": 1}, ValueError, "min_samples is 1"),
        ({"replicates": 1}, ValueError, "replicates is 1"),
        ({"value_range": (1, 0)}, ValueError, r"\[1, 0\]"),
        ({"value_range": (0, math.inf)}, ValueError, "value_range"),
        ({"value_range": 4}, ValueError, "value_range"),
        ({"threads": 0}, ValueError, "threads is 0"),
        ({"seed": -1}, ValueError, "seed is -1"),
    ],
)
def test_bad_input_is_named(options: dict[str, Any], error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=match):
        sf.integrate(**{"f": circle, "d": 2, **options})


@pytest.mark.parametrize("values", [{"absolute": -1}, {"relative": math.inf}, {"absolute": math.nan}, {}])
def test_a_bad_tolerance_is_refused(values: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="tolerance"):
        sf.Tolerance(**values)
