# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""estimates: sums, intervals and rules that stop too early."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import sunfleck as sf
from sunfleck.lab.experiment import Array, Experiment, Measured, bars, lines

__all__ = ["EXPERIMENTS"]


def _normal(seed: int, n: int) -> Array:
    return np.asarray(np.random.Generator(sf.Rng("pcg64dxsm", seed=seed).bit_generator).standard_normal(n))


def _sums(mean: float, dtype: str) -> Callable[[int], Measured]:
    def measure(seed: int) -> Measured:
        x = mean + _normal(seed, 10000)
        running, welford = sf.RunningSums(dtype), sf.Moments()
        running.add(x.astype(dtype))
        welford.add(x)
        exact = float(np.var(x - mean))
        failed, right = abs(running.variance / exact - 1), abs(welford.variance / exact - 1)
        panels = [
            bars({"exact": exact, name: v}, "variance")
            for name, v in (("running sums", running.variance), ("Moments", welford.variance))
        ]
        return Measured(failed, right, panels[0], panels[1])

    return measure


def _growth(seed: int) -> Measured:
    rng = sf.Rng("pcg64dxsm", seed=seed)
    chunk, total, moments = 1 << 20, np.float32(0), sf.Moments()
    counts, single, double = [], [], []
    for k in range(40):
        x = np.asarray(rng.random(chunk, dtype="float32"))
        total = np.cumsum(np.concatenate([[total], x]), dtype=np.float32)[-1]
        moments.add(x)
        counts.append((k + 1) * chunk)
        single.append(float(total) / counts[-1])
        double.append(moments.mean)
    n = np.array(counts)
    panels = [lines({"mean": (n, np.array(m))}, "samples", "mean") for m in (single, double)]
    return Measured(abs(single[-1] - 0.5), abs(double[-1] - 0.5), panels[0], panels[1])


def _qmc_error(seed: int) -> Measured:
    n, runs, replicates = 1024, 200, 8
    means, widths = np.empty(runs), np.empty(runs)
    for run in range(runs):
        u = np.asarray(sf.points("sobol", n, seed=seed * runs + run, dtype="float64", threads=1))
        f = u[:, 0] * u[:, 1] + u[:, 0]
        means[run], widths[run] = f.mean(), f.std(ddof=1) / n**0.5
    groups = means.reshape(-1, replicates)
    truth = float(np.sqrt(np.mean((means - 0.75) ** 2)))
    told = float(np.sqrt(np.mean(groups.var(axis=1, ddof=1))))
    naive = float(np.mean(widths))
    panels = [
        bars({"true RMS error": truth, name: v}, "error") for name, v in (("s / sqrt(n)", naive), ("replicates", told))
    ]
    return Measured(naive / truth, told / truth, panels[0], panels[1])


def _pilot(seed: int) -> Measured:
    p, pilot, runs = 0.02, 16, 4000
    hits = np.asarray(sf.Rng("pcg64dxsm", seed=seed).random((runs, pilot))) < p
    fooled = float(np.mean(~hits.any(axis=1)))
    misses = []
    for row in hits[:400]:
        low, high = sf.estimate.betting_interval(row.astype(float), 0.0, 1.0)
        misses.append(not low <= p <= high)
    missed = float(np.mean(misses))
    panels = [bars({"claimed": 0.05, "missed": v}, "share of pixels that are wrong") for v in (fooled, missed)]
    return Measured(fooled, missed, panels[0], panels[1])


def _looks(seed: int) -> Measured:
    runs, n = 300, 1024
    u = np.asarray(sf.Rng("pcg64dxsm", seed=seed).random((runs, n)))
    k = np.arange(1, n + 1)
    mean = np.cumsum(u, axis=1) / k
    deviation = np.sqrt(np.maximum(np.cumsum((u - 0.5) ** 2, axis=1) / k - (mean - 0.5) ** 2, 0))
    outside = np.abs(mean - 0.5) > 1.96 * deviation / np.sqrt(k)
    ever = np.maximum.accumulate(outside[:, 15:], axis=1).mean(axis=0)
    always = np.zeros(len(range(16, n + 1, 16)))
    sequences = [sf.ConfidenceSequence(0.0, 1.0) for _ in range(runs)]
    wrong = np.zeros(runs, dtype=bool)
    for look, end in enumerate(range(16, n + 1, 16)):
        for run, sequence in enumerate(sequences):
            sequence.add(u[run, end - 16 : end])
            wrong[run] |= not sequence.lower <= 0.5 <= sequence.upper
        always[look] = wrong.mean()
    panels = [
        lines({"ever wrong": (k[15:], ever)}, "samples", "share of runs"),
        lines({"ever wrong": (np.arange(16, n + 1, 16), always)}, "samples", "share of runs"),
    ]
    return Measured(float(ever[-1]), float(always[-1]), panels[0], panels[1])


EXPERIMENTS = (
    Experiment(
        "sums-float32",
        "running sums in float32 lose the variance",
        "Sums of f and f^2 are all that a variance needs.",
        "At mean 10^6, f^2 is 10^12, and float32 keeps seven digits of it.",
        "relative error of the variance, sigma 1",
        "Welford's moments.",
        (1, 1e12),
        (0, 1e-6),  # Moments in double: condition mean/sigma = 10^6, of 2^-53
        _sums(1e6, "float32"),
    ),
    Experiment(
        "sums-float64",
        "running sums in float64 fail near mean/sigma = 10^8",
        "Double is enough.",
        "f^2 is 10^16 and its unit in the last place 2, sigma^2 is 1.",
        "relative error of the variance, sigma 1",
        "Welford's moments.",
        (0.1, 1e12),
        (0, 1e-6),
        _sums(1e8, "float64"),
    ),
    Experiment(
        "float32-radiance",
        "a float32 sum of radiance stops growing",
        "A pixel gets better with every sample.",
        "From 2^24 on, adding less than 1 changes nothing.",
        "error of the mean of 40 million uniforms, which is 1/2",
        "Sum in double.",
        (0.08, 0.5),  # 2^24 / (40 2^20) = 0.4: wrong by 0.1
        (0, 0.0003),  # sigma 0.289 / sqrt(4.2e7) = 4.5e-5, six of them
        _growth,
    ),
    Experiment(
        "standard-error-on-sobol",
        "s / sqrt(n) says nothing about a Sobol sequence",
        "The standard error is the error.",
        "It holds for independent samples; the points of a net are not.",
        "standard error over true RMS error, n = 1024, smooth integrand",
        "Replicates: independent scrambles.",
        (5, 1000),
        (0.7, 1.4),  # 25 groups of 8 and 200 runs: relative sigma 5 % each, six of 7 %
        _qmc_error,
    ),
    Experiment(
        "pilot-too-small",
        "a pilot that sees nothing stops at nothing",
        "Sixteen samples tell the variance.",
        "Of a source seen with probability 0.02, 72 % of the pixels see zeros only: variance 0, done.",
        "share of pixels that stop with a wrong answer",
        "An interval that is finite at zero variance: betting_interval.",
        (0.68, 0.77),  # 0.98^16 = 0.724, sigma 0.007 of 4000, six of them
        (0, 0.115),  # 0.05 at the most; sigma of 400 is 0.011, six of them
        _pilot,
    ),
    Experiment(
        "every-look-a-test",
        "each look at a 95 % interval is another chance to stop wrongly",
        "A 95 % interval is wrong in 5 % of the runs.",
        "Looked at after every sample, it is wrong at some look far more often.",
        "share of runs whose interval was ever wrong, 16 to 1024 samples",
        "A confidence sequence, which holds at all looks at once.",
        (0.2, 1),
        (0, 0.126),  # 0.05 at the most; sigma of 300 is 0.0126, six of them
        _looks,
    ),
)
