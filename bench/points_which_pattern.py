# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""The tables of docs/which-pattern.md: errors of every pattern at equal samples and at equal time.

    python bench/points_which_pattern.py times            # the timed part alone, to build/which_pattern.json
    python bench/points_which_pattern.py errors [--quick] # the tables, with the times that were kept
    python bench/points_which_pattern.py                  # both

Integrands with known means, scaled to variance 1, in 2, 8 and 20 dimensions; the built-in scenes at
64 x 64. Nothing but the part `times` is timed; seeds are 0, 1, 2, …
"""

from __future__ import annotations

import argparse
import json
import math
import time
import warnings
from collections.abc import Callable
from statistics import median
from typing import Any

import numpy as np
from measure import ROOT, describe_build, describe_machine
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

import sunfleck as sf

Array = NDArray[np.float64]
KEPT = ROOT / "build/which_pattern.json"

PATTERNS: dict[str, tuple[str, dict[str, Any]]] = {
    "random": ("random", {}),
    "jittered": ("jittered", {}),
    "latin": ("latin", {}),
    "multijittered": ("multijittered", {}),
    "orthogonal": ("orthogonal", {}),
    "r2, shift": ("r2", {"scramble": "shift"}),
    "lattice, shift": ("lattice", {"scramble": "shift"}),
    "halton": ("halton", {}),
    "halton, owen": ("halton", {"scramble": "owen"}),
    "sobol, pad=2": ("sobol", {"pad": 2}),
    "sobol, lms": ("sobol", {"scramble": "lms"}),
    "sobol": ("sobol", {}),
    "sz": ("sz", {}),
}
DIMENSIONS = (2, 8, 20)
UNEVEN = 3000  # a count that suits nobody
BUDGET, COST = 1.6e-3, 100e-9  # seconds for an integral, and for one value of its integrand
RENDERED = sf.RENDER_PATTERNS
SCENES = ("penumbra", "defocus", "cornell")
SPP = (16, 64, 256)
SIZE = 64  # pixels a side

# ---- integrands of mean 0 and variance 1, of points u and their z = _normal(u) ----


def _normal(u: Array) -> Array:
    """A standard normal number of all coordinates alike; 0 as a coordinate gives minus infinity."""
    made: Array = ndtri(u).sum(axis=1) / math.sqrt(u.shape[1])
    return made


def _smooth(u: Array, z: Array) -> Array:
    """A product of exponentials, the k-th of weight 1/k: each of mean 1, so that the product's is."""
    weights = 1 / np.arange(1, u.shape[1] + 1)
    deviation = math.sqrt((math.e - 1) * (3 - math.e) / 2)
    made: Array = np.prod(1 + weights * (np.exp(u) - (math.e - 1)) / deviation, axis=1) - 1
    return made / math.sqrt(np.prod(1 + weights**2) - 1)


def _kinked(u: Array, z: Array) -> Array:
    """max(0, z): of mean 1 / sqrt(2 pi) and mean square 1/2."""
    return (np.maximum(0, z) - 1 / math.sqrt(2 * math.pi)) / math.sqrt(0.5 - 0.5 / math.pi)


def _edge(u: Array, z: Array) -> Array:
    """1 where z > 1/2: of mean p and variance p (1 - p)."""
    p = float(ndtr(-0.5))
    return ((z > 0.5) - p) / math.sqrt(p * (1 - p))


INTEGRANDS: dict[str, Callable[[Array, Array], Array]] = {"smooth": _smooth, "kinked": _kinked, "discontinuous": _edge}


def made(label: str, n: int, d: int, seed: int) -> Array:
    pattern, options = PATTERNS[label]
    return sf.points(pattern, n, d, seed=seed, dtype="float64", **options)


def exists(label: str, n: int, d: int) -> bool:
    try:
        return sf.valid_counts(PATTERNS[label][0], n, d) == (n, n)
    except ValueError:  # so many dimensions
        return False


def errors(label: str, n: int, d: int, seeds: int) -> Array:
    """|error| of each seed and integrand."""
    found = np.empty((seeds, len(INTEGRANDS)))
    for seed in range(seeds):
        u = made(label, n, d, seed)
        z = _normal(u)
        found[seed] = [abs(f(u, z).mean()) for f in INTEGRANDS.values()]
    return found


# ---- times ----


def points_times() -> dict[str, float]:
    """Seconds a point, "label/d": one thread, 2^14 points of a new seed, its tables with it, median of 7."""
    found = {}
    for d in DIMENSIONS:
        for label, (pattern, options) in PATTERNS.items():
            n = 1 << 14
            if not exists(label, n, d):
                continue
            out, turns = np.empty((n, d)), []
            for turn in range(7):
                begun = time.perf_counter()
                sf.points(pattern, n, d, seed=turn, dtype="float64", threads=1, out=out, **options)
                turns.append(time.perf_counter() - begun)
            found[f"{label}/{d}"] = median(turns) / n
    return found


def scene_times() -> dict[str, list[float]]:
    """Seconds of a 64-spp render, "scene/pattern": turn by turn, so that all see the same machine."""
    found: dict[str, list[float]] = {}
    for name in SCENES:
        scene = getattr(sf.scenes, name)()
        for turn in range(8):
            for pattern in RENDERED:
                begun = time.perf_counter()
                sf.render(scene, SIZE, SIZE, spp=64, pattern=pattern, seed=turn)
                if turn:  # the first warms up
                    found.setdefault(f"{name}/{pattern}", []).append(time.perf_counter() - begun)
    return found


def keep_times() -> None:
    KEPT.parent.mkdir(exist_ok=True)
    about = f"{describe_machine()}; {describe_build()}"
    KEPT.write_text(json.dumps({"about": about, "points": points_times(), "scenes": scene_times()}, indent=1))
    print(about)


# ---- tables ----


def cell(values: Array) -> str:
    """Median, and the tenth and ninetieth hundredth: "1.2e-3 (2e-4 … 3e-3)"; then the root mean square."""
    low, middle, high = np.quantile(values, (0.1, 0.5, 0.9))
    square = math.sqrt((values**2).mean())
    return f"{middle:.1e} ({low:.0e} … {high:.0e}), {square:.1e}".replace("e-0", "e-")


def print_samples(d: int, n: int, measured: dict[str, dict[int, Array]]) -> None:
    print(f"\n| {d} dimensions, n = {n:,} | {' | '.join(INTEGRANDS)} |\n|---|{'---|' * len(INTEGRANDS)}")
    for label, by_count in measured.items():
        if n in by_count:
            print(f"| {label} | {' | '.join(cell(by_count[n][:, k]) for k in range(len(INTEGRANDS)))} |")


def print_seconds(d: int, measured: dict[str, dict[int, Array]], times: dict[str, float]) -> None:
    """Medians at the count that the budget pays for, between the powers of two on a straight line of
    logarithms."""
    print(f"\n| {d} dimensions, {BUDGET * 1e3:.1f} ms | ns a point | n | {' | '.join(INTEGRANDS)} |")
    print(f"|---|---|---|{'---|' * len(INTEGRANDS)}")
    for label, by_count in measured.items():
        cost = times[f"{label}/{d}"]
        n = BUDGET / (cost + COST)
        sizes = sorted(by_count)
        curves = np.log(np.median([by_count[size] for size in sizes], axis=1))
        gone = [math.exp(np.interp(math.log(n), np.log(sizes), curves[:, k])) for k in range(len(INTEGRANDS))]
        row = " | ".join(f"{e:.1e}".replace("e-0", "e-") for e in gone)
        print(f"| {label} | {cost * 1e9:.3g} | {n:,.0f} | {row} |")


def relative_squares(image: Any, truth: Array) -> float:
    """relMSE: the mean over the pixels of (x - t)^2 / (t^2 + 0.01 mean(t)^2), of (R+G+B)/3."""
    x = image.color.astype("float64").mean(axis=2)
    return float(((x - truth) ** 2 / (truth**2 + 0.01 * truth.mean() ** 2)).mean())


def print_scenes(times: dict[str, list[float]], seeds: int, reference: int) -> None:
    for name in SCENES:
        scene = getattr(sf.scenes, name)()
        truth = sf.render(scene, SIZE, SIZE, spp=reference, seed=2**40).color.astype("float64").mean(axis=2)
        budget = median(times[f"{name}/sobol"])
        print(f"\n| {name} | {' | '.join(f'{spp} spp' for spp in SPP)} | ms at 64 spp | in sobol's time at 64 |")
        print(f"|---|{'---|' * len(SPP)}---|---|")
        for pattern in RENDERED:
            made = [
                np.array(
                    [
                        relative_squares(sf.render(scene, SIZE, SIZE, spp=spp, pattern=pattern, seed=s), truth)
                        for s in range(seeds)
                    ]
                )
                for spp in SPP
            ]
            turns = times[f"{name}/{pattern}"]
            paid = 64 * budget / median(turns)  # samples a pixel
            curve = np.log([np.median(m) for m in made])
            equal = f"{math.exp(np.interp(math.log(paid), np.log(SPP), curve)):.2e}"
            if paid < SPP[0]:
                equal = f"above {equal}: pays for {paid:.1f} spp"
            spread = f"{median(turns) * 1e3:.3g} ({min(turns) * 1e3:.3g} … {max(turns) * 1e3:.3g})"
            cells = " | ".join(f"{np.median(m):.2e} ({m.min():.2e} … {m.max():.2e})" for m in made)
            print(f"| {pattern} | {cells} | {spread} | {equal} |".replace("e-0", "e-"))


def print_tables(quick: bool) -> None:
    warnings.filterwarnings("ignore", message=".*not an aligned block")  # UNEVEN is none, to be seen
    kept = json.loads(KEPT.read_text())
    print(kept["about"])
    seeds, largest = (8, 12) if quick else (64, 14)
    for d in DIMENSIONS:
        sizes = [1 << m for m in range(6, largest + 1)]
        measured = {label: {n: errors(label, n, d, seeds) for n in sizes if exists(label, n, d)} for label in PATTERNS}
        measured = {label: by_count for label, by_count in measured.items() if by_count}
        for n in (1 << 8, 1 << 12):
            print_samples(d, n, measured)
        print_samples(d, UNEVEN, {k: {UNEVEN: errors(k, UNEVEN, d, seeds)} for k in PATTERNS if exists(k, UNEVEN, d)})
        print_seconds(d, {k: v for k, v in measured.items() if f"{k}/{d}" in kept["points"]}, kept["points"])
    print_scenes(kept["scenes"], 3 if quick else 5, 512 if quick else 8192)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("part", nargs="?", choices=("times", "errors"), help="both, if not given")
    parser.add_argument("--quick", action="store_true", help="few seeds and small counts, to see that it runs")
    options = parser.parse_args()
    if options.part != "errors":
        keep_times()
    if options.part != "times":
        print_tables(options.quick)


if __name__ == "__main__":
    main()
