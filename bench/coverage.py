# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Whether error bars hold: coverage, accuracy and cost of the stopping rules, on whole renders.

Every rule renders each scene to each tolerance with several seeds, 128 x 128. Printed for each:

coverage    share of pixels whose true error is within the half-width, and of the hard ones alone:
            those for which an oracle needs more than the first look
within      share of pixels whose true error is within the tolerance, and of the hard ones
cost        samples over those of an oracle that knows every pixel's true variance at every look,
            looks at the same counts, and has the same minimum
met         share of pixels that met the tolerance before max_spp; the shares above are of these
bias        mean over seeds of the picture's mean against the truth, in standard errors

The truth is a reference that reference.py made with Mitsuba where build/reference holds one of
this size, else a long render of our own with another seed. The oracle's variances are the
squared errors of fixed-count renders, over the same seeds and 3 x 3 pixels.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from measure import ROOT, describe_build, describe_machine
from numpy.typing import NDArray

import sunfleck as sf

SIZE = 128
FIRST, MOST = 32, 4096
Z = 1.959963984540054
TOLERANCES = {
    "penumbra": (0.05, 0.02, 0.01),
    "defocus": (0.05, 0.02, 0.01),
    "cornell": (0.1, 0.05, 0.03),
    "keyhole": (0.1, 0.05, 0.03),
}
MET = sf.STOP_REASONS.index("met")

Array = NDArray[np.float64]


def level_of(image: sf.Image) -> Array:
    """(R+G+B)/3 of every pixel."""
    return image.color.mean(axis=2, dtype=np.float64)


def truth_of(name: str, scene: sf.Scene, spp: int) -> tuple[Array, str]:
    path = ROOT / f"build/reference/{name}_{SIZE}.npy"
    if path.exists():
        return np.load(path).astype(np.float64).mean(axis=2), path.with_suffix(".txt").read_text().strip()
    image = sf.render(scene, SIZE, SIZE, spp=spp, seed=2**40)
    return level_of(image), f"our own {spp} samples a pixel, seed 2^40"


def around(x: Array) -> Array:
    """The mean over the 3 x 3 pixels around, edges repeated."""
    padded = np.pad(x, 1, mode="edge")
    return sum(padded[i : i + SIZE, j : j + SIZE] for i in range(3) for j in range(3)) / 9


def looks() -> Iterator[int]:
    n = FIRST
    while n <= MOST:
        yield n
        n *= 2


def true_variances(scene: sf.Scene, pattern: str, truth: Array, seeds: int) -> dict[int, Array]:
    """Of the mean of n samples, for every look: the squared errors, averaged."""
    squares = {n: np.zeros((SIZE, SIZE)) for n in looks()}
    for seed in range(seeds):
        mean, taken = np.zeros((SIZE, SIZE)), 0
        for n in looks():
            part = level_of(sf.render(scene, SIZE, SIZE, spp=n - taken, start=taken, pattern=pattern, seed=seed))
            mean, taken = mean + (part - mean) * (n - taken) / n, n
            squares[n] += (mean - truth) ** 2 / seeds
    return {n: around(square) for n, square in squares.items()}


def oracle_samples(variances: dict[int, Array], tolerance: float) -> Array:
    """The first look at which the true half-width is within the tolerance, for every pixel."""
    samples = np.full((SIZE, SIZE), float(MOST))
    for n in reversed(list(looks())):
        samples = np.where(Z * np.sqrt(variances[n]) <= tolerance, n, samples)
    return samples


def try_rule(scene: sf.Scene, truth: Array, needed: Array, seeds: int, **options: object) -> dict[str, float]:
    """What the rule came to, over all seeds."""
    hard = needed > FIRST
    sums = dict.fromkeys(("met", "covered", "within", "hard", "hard_covered", "hard_within"), 0)
    samples, means = 0.0, []
    for seed in range(seeds):
        image = sf.render(scene, SIZE, SIZE, max_spp=MOST, seed=seed, **options)  # type: ignore[arg-type]
        met, error = image.stop_reason == MET, np.abs(level_of(image) - truth)
        covered, within = error <= image.half_width, error <= image.summary().tolerance
        for key, chosen in (
            ("met", met),
            ("covered", met & covered),
            ("within", met & within),
            ("hard", met & hard),
            ("hard_covered", met & hard & covered),
            ("hard_within", met & hard & within),
        ):
            sums[key] += int(chosen.sum())
        samples += float(image.samples.sum(dtype=np.float64))
        means.append(level_of(image).mean())
    spread = float(np.std(means, ddof=1) / seeds**0.5) if seeds > 1 else np.inf
    met_count, hard_count = max(1, sums["met"]), max(1, sums["hard"])
    return {
        "coverage": sums["covered"] / met_count,
        "hard_coverage": sums["hard_covered"] / hard_count,
        "within": sums["within"] / met_count,
        "hard_within": sums["hard_within"] / hard_count,
        "cost": samples / seeds / needed.sum(),
        "met": sums["met"] / seeds / SIZE**2,
        "bias": float((np.mean(means) - truth.mean()) / spread),
        "bias_relative": float(np.mean(means) / truth.mean() - 1),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", default=list(TOLERANCES), metavar="SCENE", help="default: all four")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--patterns", nargs="*", default=["sobol", "random"])
    parser.add_argument("--rules", nargs="*", default=["dyadic", "standard-error", "replicates"])
    parser.add_argument("--truth-spp", type=int, default=65536, help="of a reference of our own (default 65536)")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "build/coverage.json")
    args = parser.parse_args()

    print(describe_machine())
    print(describe_build(Path(sf._core.__file__)))
    rows = []
    print("scene     pattern  rule             tol   coverage (hard)  within (hard)  cost   met    bias")
    for name in args.scenes:
        scene = getattr(sf.scenes, name)()
        truth, source = truth_of(name, scene, args.truth_spp)
        print(f"{name}: {source}; {args.seeds} seeds")
        for pattern in args.patterns:
            variances = true_variances(scene, pattern, truth, args.seeds)
            for tolerance in TOLERANCES[name]:
                needed = oracle_samples(variances, tolerance * truth.mean())
                for rule in args.rules:
                    got = try_rule(
                        scene, truth, needed, args.seeds, tolerance=tolerance, pattern=pattern, stop=rule, min_spp=FIRST
                    )
                    rows.append({"scene": name, "pattern": pattern, "rule": rule, "tolerance": tolerance, **got})
                    print(
                        f"{name:9} {pattern:8} {rule:16} {tolerance:<5}"
                        f" {got['coverage']:.3f} ({got['hard_coverage']:.3f})"
                        f"    {got['within']:.3f} ({got['hard_within']:.3f})  {got['cost']:5.2f}  {got['met']:.3f}"
                        f"  {got['bias']:+.1f}",
                        flush=True,
                    )
                    args.output.parent.mkdir(parents=True, exist_ok=True)
                    args.output.write_text(json.dumps(rows, indent=1))


if __name__ == "__main__":
    sys.exit(main())
