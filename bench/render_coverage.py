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

"two-stage" is the rule dyadic with the option unbiased; the pilot's samples are not counted here.
"half-buffer", the usual rule of renderers, is replayed: z times half the difference between the means of
two halves of the samples, its square averaged over 3 x 3 pixels, decides at the same looks.

The truth is a reference that peers_reference.py made with Mitsuba where build/reference holds one of
this size, else a long render of our own with another seed. The oracle's variances are the
squared errors of fixed-count renders, over the same seeds and 3 x 3 pixels.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from measure import ROOT, describe_build, describe_machine
from numpy.typing import NDArray

import sunfleck as sf
from sunfleck.plot.figure import Panel, Series, draw_panels, save
from sunfleck.provenance import provenance

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


Record = dict[int, tuple[Array, Array]]


def record(scene: sf.Scene, pattern: str, seed: int) -> Record:
    """For every look at n samples: the mean, and half the difference of its two halves."""
    sums, taken, found = np.zeros((2, SIZE, SIZE)), 0, {}
    for n in looks():
        image = sf.render(
            scene, SIZE, SIZE, spp=n - taken, start=taken, pattern=pattern, seed=seed, aovs=("half_a", "half_b")
        )
        sums += (n - taken) * np.stack([image.aovs[key].mean(axis=2, dtype=np.float64) for key in ("half_a", "half_b")])
        taken = n
        found[n] = (sums.sum(axis=0) / (2 * n), (sums[0] - sums[1]) / (2 * n))
    return found


def true_variances(records: list[Record], truth: Array) -> dict[int, Array]:
    """Of the mean of n samples, for every look: the squared errors, averaged."""
    return {n: around(np.mean([(r[n][0] - truth) ** 2 for r in records], axis=0)) for n in looks()}


def oracle_samples(variances: dict[int, Array], tolerance: float) -> Array:
    """The first look at which the true half-width is within the tolerance, for every pixel."""
    samples = np.full((SIZE, SIZE), float(MOST))
    for n in reversed(list(looks())):
        samples = np.where(Z * np.sqrt(variances[n]) <= tolerance, n, samples)
    return samples


@dataclass
class Stopped:
    """How a rule left a picture."""

    level: Array
    half_width: Array
    samples: Array
    met: NDArray[np.bool_]


def run_rule(scene: sf.Scene, tolerance: float, pattern: str, rule: str, seed: int) -> Stopped:
    options = {"stop": "dyadic", "unbiased": True} if rule == "two-stage" else {"stop": rule}
    image = sf.render(
        scene, SIZE, SIZE, tolerance=tolerance, min_spp=FIRST, max_spp=MOST, pattern=pattern, seed=seed, **options
    )
    return Stopped(level_of(image), image.half_width, image.samples, image.stop_reason == MET)


def replay_half_buffer(recorded: Record, tolerance: float) -> Stopped:
    """`tolerance` is absolute here."""
    halves = {n: (mean, Z * np.sqrt(around(half**2))) for n, (mean, half) in recorded.items()}
    level, half_width = (part.copy() for part in halves[MOST])
    samples = np.full((SIZE, SIZE), float(MOST))
    for n in reversed(list(looks())):
        stops = halves[n][1] <= tolerance
        level, half_width = np.where(stops, halves[n][0], level), np.where(stops, halves[n][1], half_width)
        samples = np.where(stops, n, samples)
    return Stopped(level, half_width, samples, half_width <= tolerance)


def judge(stopped: list[Stopped], truth: Array, needed: Array, tolerance: float) -> dict[str, float]:
    """What the rule came to, over all seeds; `tolerance` is absolute."""
    met, hard = np.stack([s.met for s in stopped]), needed > FIRST
    error = np.abs(np.stack([s.level for s in stopped]) - truth)
    covered, within = error <= np.stack([s.half_width for s in stopped]), error <= tolerance
    share = {"": met, "hard_": met & hard}
    means = np.array([s.level.mean() for s in stopped])
    spread = float(np.std(means, ddof=1) / len(means) ** 0.5) if len(means) > 1 else np.inf
    return {
        **{f"{key}coverage": float(covered[chosen].mean()) if chosen.any() else 1 for key, chosen in share.items()},
        **{f"{key}within": float(within[chosen].mean()) if chosen.any() else 1 for key, chosen in share.items()},
        "cost": float(np.mean([s.samples.sum(dtype=np.float64) for s in stopped]) / needed.sum()),
        "met": float(met.mean()),
        "bias": float((means.mean() - truth.mean()) / spread),
        "bias_relative": float(means.mean() / truth.mean() - 1),
    }


def tell(row: dict[str, float | str]) -> str:
    return (
        "{scene:9} {pattern:8} {rule:16} {tolerance:<5} {coverage:.3f} ({hard_coverage:.3f})"
        "    {within:.3f} ({hard_within:.3f})  {cost:5.2f}  {met:.3f}  {bias:+.1f}"
    ).format(**row)


def measure(name: str, args: argparse.Namespace) -> Iterator[dict[str, float | str]]:
    """A row for each pattern, tolerance and rule."""
    scene = getattr(sf.scenes, name)()
    truth, source = truth_of(name, scene, args.truth_spp)
    print(f"{name}: {source}; {args.seeds} seeds")
    for pattern in args.patterns:
        records = [record(scene, pattern, seed) for seed in range(args.seeds)]
        variances = true_variances(records, truth)
        for tolerance in TOLERANCES[name]:
            absolute = tolerance * truth.mean()
            needed = oracle_samples(variances, absolute)
            for rule in args.rules:
                if rule == "half-buffer":
                    stopped = [replay_half_buffer(r, absolute) for r in records]
                else:
                    stopped = [run_rule(scene, tolerance, pattern, rule, seed) for seed in range(args.seeds)]
                got = judge(stopped, truth, needed, absolute)
                yield {"scene": name, "pattern": pattern, "rule": rule, "tolerance": tolerance, **got}


def draw(rows: list[dict[str, float | str]], path: Path) -> None:
    """Coverage of the hard pixels against the cost, a panel for each pattern."""
    panels = []
    for pattern in ("sobol", "random"):
        series = []
        for rule in dict.fromkeys(str(row["rule"]) for row in rows):
            chosen = [row for row in rows if row["rule"] == rule and row["pattern"] == pattern]
            x, y = ([float(row[key]) for row in chosen] for key in ("cost", "hard_coverage"))
            series.append(Series(rule, x, y, line=False, marker_size=5))
        ends = [min(float(row["cost"]) for row in rows), max(float(row["cost"]) for row in rows)]
        series.append(Series("0.95 asked", ends, [0.95, 0.95], style="guide"))
        panels.append(
            Panel(
                f"{pattern}: penumbra, defocus, cornell, three tolerances",
                "samples over the oracle's",
                "share of the hard pixels within the half-width",
                series,
                y_log=False,
            )
        )
    save(draw_panels(panels, provenance(range(20))), path)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", default=list(TOLERANCES), metavar="SCENE", help="default: all four")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--patterns", nargs="*", default=["sobol", "random"])
    parser.add_argument("--rules", nargs="*", default=["dyadic", "half-buffer", "standard_error"])
    parser.add_argument("--truth-spp", type=int, default=65536, help="of a reference of our own (default 65536)")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "build/coverage.json")
    parser.add_argument("--draw", type=Path, metavar="FILE", help="draw what --output holds, and measure nothing")
    args = parser.parse_args()
    if args.draw:
        draw([row for row in json.loads(args.output.read_text()) if row["scene"] != "keyhole"], args.draw)
        return
    print(describe_machine())
    print(describe_build())
    print("scene     pattern  rule             tol   coverage (hard)  within (hard)  cost   met    bias")
    args.output.parent.mkdir(parents=True, exist_ok=True)
    rows = []
    for name in args.scenes:
        for row in measure(name, args):
            rows.append(row)
            print(tell(row), flush=True)
            args.output.write_text(json.dumps(rows, indent=1))


if __name__ == "__main__":
    sys.exit(main())
