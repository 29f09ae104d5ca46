# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""streams: seeds, threads, and words that become floats."""

from __future__ import annotations

import numpy as np

import sunfleck as sf
from sunfleck.lab.experiment import Array, Experiment, Measured, bars, lines, scatter

__all__ = ["EXPERIMENTS"]


def _one_seed(seed: int) -> Measured:
    threads, n, runs = 8, 256, 400

    def rms(shared: bool) -> tuple[float, Array]:
        roots = [sf.Rng("pcg64dxsm", seed=seed * runs + run) for run in range(runs)]
        means = np.empty((runs, threads))
        for run, root in enumerate(roots):
            children = [sf.Rng("pcg64dxsm", seed=root.seed)] * threads if shared else root.spawn(threads)
            for thread, rng in enumerate(children):
                rng.reset()
                means[run, thread] = np.mean(rng.random(n))
        alone = np.sqrt(np.mean((means - 0.5) ** 2))
        return float(np.sqrt(np.mean((means.mean(axis=1) - 0.5) ** 2)) / alone), means[:, :2]

    before, pairs = rms(True)
    after, spawned = rms(False)
    show = [scatter(p, "mean of thread 0", "mean of thread 1") for p in (pairs, spawned)]
    return Measured(before, after, show[0], show[1])


def _neighbours(seed: int) -> Measured:
    n = 1000
    seeds = seed + np.arange(n)
    in_step = np.array([sf.Rng("minstd", seed=int(s)).bits() for s in seeds]) / (2.0**31 - 1)
    hashed = np.array([sf.Rng("minstd", seed=seed, stream=k).bits() for k in range(1, n + 1)]) / (2.0**31 - 1)

    def proportional(u: Array) -> float:
        step = np.diff(u) - 16807 / (2.0**31 - 1)
        return float(np.mean(np.abs(step - np.round(step)) < 1e-8))

    show = [scatter(np.stack([seeds, u], 1), "thread", "first draw") for u in (in_step, hashed)]
    return Measured(proportional(in_step), proportional(hashed), show[0], show[1])


def _float_one(seed: int) -> Measured:
    words = np.arange(2**32 - 1024, 2**32, dtype=np.uint64).astype(np.uint32)
    nearest = words.astype(np.float32) * np.float32(2.0**-32)
    down = (words >> np.uint32(8)).astype(np.float32) * np.float32(2.0**-24)
    show = [
        lines({"float": (words.astype(float) - 2.0**32, f.astype(float))}, "word - 2^32", "float")
        for f in (nearest, down)
    ]
    drawn = np.asarray(sf.Rng("pcg32", seed=seed).random(1 << 16, dtype="float32"))
    return Measured(float(np.sum(nearest == 1)), float(np.sum(down == 1) + np.sum(drawn == 1)), show[0], show[1])


def _modulo(seed: int) -> Measured:
    sides, n = 3 << 14, 1 << 18
    words = np.asarray(sf.Rng("pcg32", seed=seed).bits(n)) & 0xFFFF  # 16-bit words, 49,152 faces
    folded = words % sides
    kept = words[words < sides]

    def low(faces: Array) -> float:
        return float(np.mean(faces < 1 << 14))

    show = [
        bars({f"third {k + 1}": float(np.mean(faces >> 14 == k)) for k in range(3)}, "share")
        for faces in (folded, kept)
    ]
    return Measured(low(folded), low(kept), show[0], show[1])


EXPERIMENTS = (
    Experiment(
        "threads-one-seed",
        "N threads that share a seed buy the accuracy of one",
        "Eight threads with n samples each are as good as 8 n samples.",
        "They draw the same n samples eight times.",
        "RMS error of eight threads together over that of one",
        "A stream for each thread: spawn().",
        (0.999, 1.001),
        (0.28, 0.43),  # 8^-1/2 = 0.354; 400 runs: a relative sigma of 1/sqrt(800) = 3.5 %, six of them
        _one_seed,
    ),
    Experiment(
        "seed-plus-thread",
        "minstd's first draws of seeds 1, 2, 3 are proportional",
        "Seed + thread number gives each thread noise of its own.",
        "The first draw is 16807 seed / m.",
        "share of neighbouring seeds whose first draws differ by 16807/m",
        "Streams: the seed is hashed with the stream's number.",
        (1, 1),
        (0, 0.005),  # each pair with probability 2e-8
        _neighbours,
    ),
    Experiment(
        "float-one",
        "u 2^-32 rounded to nearest returns exactly 1",
        "Dividing a 32-bit word by 2^32 gives a float below 1.",
        "The 128 largest words round up to 2^32.",
        "words that become 1",
        "Round down: the top 24 bits.",
        (128, 128),  # spacing 256 below 2^32: half of it, the tie goes to the even 2^32
        (0, 0),
        _float_one,
    ),
    Experiment(
        "modulo-bias",
        "word % n favours small results where n does not divide 2^k",
        "word % n is uniform over n faces.",
        "49,152 faces from 16-bit words: the first third has two words for each face, the others one.",
        "share of the first third",
        "Draw again above the largest multiple of n.",
        (0.48, 0.52),  # 1/2; 2^18 draws: sigma 0.001
        (0.32, 0.35),  # 1/3; sigma 0.0011
        _modulo,
    ),
)
