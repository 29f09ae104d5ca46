# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""What adaptive sampling saves: samples and seconds of a fixed count with the same error.

For each scene, 128 x 128, renders to a tolerance, and renders of 32, 64, … samples a pixel; the
fixed count that would have the same 99 % quantile of the error of (R+G+B)/3, or the same relMSE,
is interpolated between logarithms. Medians over the seeds; both take turns on the machine.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from measure import describe_build, describe_machine
from render_coverage import SIZE, TOLERANCES, Array, level_of, truth_of

import sunfleck as sf

COUNTS = [32 << k for k in range(9)]


def measure(scene: sf.Scene, truth: Array, **options: object) -> tuple[float, float, float, float]:
    """Samples a pixel, seconds, the 99 % quantile of the error, relMSE."""
    start = time.perf_counter()
    image = sf.render(scene, SIZE, SIZE, **options)  # type: ignore[arg-type]
    seconds = time.perf_counter() - start
    error = level_of(image) - truth
    relative = float(np.mean(error**2 / (truth**2 + 0.01)))
    return float(image.samples.mean()), seconds, float(np.quantile(np.abs(error), 0.99)), relative


def cost_at(error: float, errors: Array, costs: Array) -> float:
    """The cost at which the falling errors reach `error`, on straight lines between logarithms."""
    return float(np.exp(np.interp(-np.log(error), -np.log(errors), np.log(costs))))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", default=["penumbra", "defocus", "cornell"])
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--truth-spp", type=int, default=65536)
    args = parser.parse_args()

    print(describe_machine())
    print(describe_build())
    print("fixed over adaptive       at the same 99 % quantile      at the same relMSE")
    print("scene     tolerance       samples    seconds             samples    seconds")
    for name in args.scenes:
        scene = getattr(sf.scenes, name)()
        truth, _ = truth_of(name, scene, args.truth_spp)
        fixed = np.array(
            [[measure(scene, truth, spp=n, seed=seed) for n in COUNTS] for seed in range(args.seeds)]
        )  # (seed, count, what)
        curves = np.median(fixed, axis=0)
        for tolerance in TOLERANCES[name]:
            runs = [measure(scene, truth, tolerance=tolerance, max_spp=COUNTS[-1], seed=s) for s in range(args.seeds)]
            samples, seconds, quantile, relative = np.median(np.array(runs), axis=0)
            ratios = []
            for column, error in ((2, quantile), (3, relative)):
                ratios.append(cost_at(error, curves[:, column], curves[:, 0]) / samples)
                ratios.append(cost_at(error, curves[:, column], curves[:, 1]) / seconds)
            print(f"{name:9} {tolerance:<14} {ratios[0]:8.2f} {ratios[1]:10.2f} {ratios[2]:19.2f} {ratios[3]:10.2f}")


if __name__ == "__main__":
    main()
