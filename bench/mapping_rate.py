# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Speed and accuracy of the bulk mappings: float32, 2^16 points, one core, outputs allocated beforehand.

Nanoseconds a point of `sample` (with its check of u), `pdf` and `invert`; beside them, in the same
run and in turn, (a) the copy of the bytes that sample reads and writes, and (b) the lecture's
formula as one writes it in NumPy, float32 throughout. Then the largest difference of
float32 from float64 samples at the same u, over 2^20 Sobol points, in units of 2^-24, and the largest
way a round trip ends from u.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from measure import describe_build, describe_machine

import sunfleck as sf
from sunfleck.chart.mapping_chart import PARAMETERS, accuracy

N = 1 << 16
F = np.float32
PI2 = F(2 * np.pi)
TRIANGLE = PARAMETERS["triangle"]


def polar(x: np.ndarray, radius: np.ndarray, turns: np.ndarray) -> None:
    angle = PI2 * turns
    x[:, 0] = radius * np.cos(angle)
    x[:, 1] = radius * np.sin(angle)


class Plain:
    """The lecture's formulas as one writes them in NumPy, float32 throughout, the result into `x`."""

    def __init__(self, u: np.ndarray, width: int) -> None:
        self.s, self.t = np.ascontiguousarray(u[:, 0]), np.ascontiguousarray(u[:, 1])
        self.x = np.empty((len(u), width), F)

    def pixel_tent(self) -> None:
        for k, v in enumerate((self.s, self.t)):
            self.x[:, k] = np.where(v < F(0.5), np.sqrt(F(2) * v) - F(0.5), F(1.5) - np.sqrt(F(2) - F(2) * v))

    def pixel_gaussian(self) -> None:
        a, b = F(0.4) * np.sqrt(F(-2) * np.log1p(-self.s)), PI2 * self.t
        self.x[:, 0] = F(0.5) + a * np.sin(b)
        self.x[:, 1] = F(0.5) + a * np.cos(b)

    def triangle(self) -> None:
        a, b, c = (np.array(TRIANGLE[k], F) for k in "abc")
        root = np.sqrt(self.s)
        alpha, beta = root * self.t, F(1) - root
        for k in range(3):
            self.x[:, k] = a[k] + alpha * (b[k] - a[k]) + beta * (c[k] - a[k])

    def disk_polar(self) -> None:
        polar(self.x, np.sqrt(self.t), self.s)

    def disk_naive(self) -> None:
        polar(self.x, self.t, self.s)

    def sphere(self) -> None:
        polar(self.x, F(2) * np.sqrt(self.t * (F(1) - self.t)), self.s)
        self.x[:, 2] = F(1) - F(2) * self.t

    def hemisphere(self) -> None:
        polar(self.x, np.sqrt(F(1) - self.t * self.t), self.s)
        self.x[:, 2] = self.t

    def cosine_hemisphere(self) -> None:
        polar(self.x, np.sqrt(F(1) - self.t), self.s)
        self.x[:, 2] = np.sqrt(self.t)


def seconds(calls: list[Callable[[], Any] | None], rounds: int) -> list[list[float]]:
    """Each call's times over `rounds`, in turn, so that what else the machine does meets all alike."""
    times: list[list[float]] = [[] for _ in calls]
    for _ in range(rounds):
        for call, kept in zip(calls, times, strict=True):
            if call is not None:
                start = time.perf_counter()
                call()
                kept.append(time.perf_counter() - start)
    return times


def measure(name: str, rounds: int) -> str:
    mapping, named = getattr(sf.mapping, name), PARAMETERS.get(name, {})
    u = sf.points("sobol", N)
    x = mapping.sample(u, **named)
    out, pdf, back = np.empty_like(x), np.empty(N, F), np.empty_like(u)
    read, written = np.empty_like(u), np.empty_like(x)
    plain = getattr(Plain(u, x.shape[1]), name, None)
    if plain is not None:
        plain()
        assert np.abs(plain.__self__.x - x).max() < 1e-5, name

    def copy() -> None:
        np.copyto(read, u)
        np.copyto(written, x)

    calls = [
        lambda: mapping.sample(u, out=out, **named),
        lambda: mapping.pdf(x, out=pdf, **named),
        lambda: mapping.invert(x, out=back, **named),
        copy,
        plain,
    ]
    seconds(calls, 3)
    times = [sorted(1e9 * t / N for t in kept) for kept in seconds(calls, rounds)]
    middle = [statistics.median(kept) if kept else None for kept in times]
    spread = f"{times[0][len(times[0]) // 10]:.2f}–{times[0][-1 - len(times[0]) // 10]:.2f}"
    numpy = (f"{middle[4]:.1f}", f"{middle[4] / middle[0]:.0f}") if middle[4] and middle[0] else ("", "")
    return f"{middle[0]:.2f} ({spread}) | {middle[1]:.2f} | {middle[2]:.2f} | {middle[3]:.2f} | {numpy[0]} | {numpy[1]}"


def stated_accuracy(name: str) -> str:
    return " | ".join(f"{np.quantile(e, 0.999):.1f}, {e.max():.1f}" for e in accuracy(name, 1 << 20))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="of mappings (default: all)")
    parser.add_argument("--rounds", type=int, default=101)
    args = parser.parse_args()
    print(f"{describe_machine()}; {describe_build()}; {sf._core.isa()}; NumPy {np.__version__}")
    print("| mapping | sample (10–90 %) | pdf | invert | copy | NumPy | × | float32: 99.9 %, max | round trip |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name in args.names or sf.MAPPINGS:
        print(f"| `{name}` | {measure(name, args.rounds)} | {stated_accuracy(name)} |", flush=True)


if __name__ == "__main__":
    main()
