# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""The figures and tables of docs/high-dimensional-jittering.md.

    python bench/points_high_dimensions.py [--quick] [-o docs/images]

Errors of integrands with known answers in 10 and 100 dimensions, by pattern and count; what a pair
of dimensions gets of each pattern; and pixel and lens jitter in step. No figure here is timed, and
all are repeatable: seeds are 0, 1, 2, …
"""

from __future__ import annotations

import argparse
import io
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib import pyplot
from numpy.typing import NDArray
from PIL import Image

import sunfleck as sf

Array = NDArray[np.float64]

# Okabe & Ito's colours, which the colour-blind tell apart; a marker each besides.
PATTERNS: dict[str, tuple[str, dict[str, Any], str, str]] = {
    "random": ("random", {}, "#000000", "x"),
    "jittered": ("jittered", {}, "#999999", "s"),
    "latin": ("latin", {}, "#E69F00", "o"),
    "multijittered pairs": ("multijittered", {}, "#CC79A7", "D"),
    "orthogonal array": ("orthogonal", {}, "#D55E00", "P"),
    "Sobol, pairs padded": ("sobol", {"pad": 2}, "#56B4E9", "v"),
    "Sobol, fours padded": ("sobol", {"pad": 4}, "#0072B2", "^"),
    "Sobol, all dimensions": ("sobol", {}, "#009E73", "*"),
}

# ---- integrands: mean 0 and variance 1 over the unit cube, so that the root mean square error of n
# random points is n^-1/2 ----

_MEAN, _DEVIATION = math.e - 1, math.sqrt((math.e - 1) * (3 - math.e) / 2)


def _g(u: Array) -> Any:
    """Of one coordinate, mean 0 and variance 1: smooth, and neither odd nor even about 1/2."""
    return (np.exp(u) - _MEAN) / _DEVIATION


def _total(u: Array, g: Array) -> Any:
    return g.sum(axis=1) / math.sqrt(g.shape[1])


def _pairs(u: Array, g: Array) -> Any:
    return (g[:, ::2] * g[:, 1::2]).sum(axis=1) / math.sqrt(g.shape[1] // 2)


def _all_pairs(u: Array, g: Array) -> Any:
    d = g.shape[1]
    return (g.sum(axis=1) ** 2 - (g**2).sum(axis=1)) / math.sqrt(2 * d * (d - 1))


def _product(u: Array, g: Array) -> Any:
    d = g.shape[1]
    return (np.prod(1 + g / math.sqrt(d), axis=1) - 1) / math.sqrt((1 + 1 / d) ** d - 1)


def _fading(u: Array, g: Array) -> Any:
    weights = 1 / np.arange(1, g.shape[1] + 1)
    return (np.prod(1 + weights * g, axis=1) - 1) / math.sqrt(np.prod(1 + weights**2) - 1)


def _edge(u: Array, g: Array) -> Any:
    return np.where(u.sum(axis=1) > u.shape[1] / 2, 1.0, -1.0)


INTEGRANDS: dict[str, Callable[[Array, Array], Any]] = {
    "a sum": _total,
    "products of neighbours (1·2 + 3·4 + …)": _pairs,
    "products of all pairs": _all_pairs,
    "a product, all alike": _product,
    "a product, fading as 1/k": _fading,
    "an edge: sum above d/2": _edge,
}


def counts(pattern: str, d: int, largest: int) -> list[int]:
    """Powers of two; of orthogonal arrays also the first that there is."""
    if pattern == "orthogonal":
        low, high = sf.valid_counts("orthogonal", (d - 1) ** 2, d)
        first = high if low is None or low < (d - 1) ** 2 else low
        squares = [4**m for m in range(1, 12)]
        return [n for n in sorted({first, *squares}) if n and sf.valid_counts(pattern, n, d) == (n, n) and n <= largest]
    return [1 << m for m in range(4, largest.bit_length())]


def errors(label: str, d: int, n: int, seeds: int) -> Array:
    """The root mean square error of each integrand over the seeds."""
    pattern, options, _, _ = PATTERNS[label]
    squares = np.zeros(len(INTEGRANDS))
    for seed in range(seeds):
        u = sf.points(pattern, n, d, seed=seed, dtype="float64", **options)
        g = _g(u)
        squares += [f(u, g).mean() ** 2 for f in INTEGRANDS.values()]
    result: Array = np.sqrt(squares / seeds)
    return result


def measure(d: int, largest: int, seeds: int) -> dict[str, tuple[list[int], Array]]:
    """Errors (counts, integrands) of the patterns that exist in d dimensions."""
    found = {}
    for label, (pattern, _, _, _) in PATTERNS.items():
        if pattern == "jittered" and d > 32:
            continue  # its fewest points, all strata halved, are 2^d
        if sizes := counts(pattern, d, largest):
            found[label] = sizes, np.array([errors(label, d, n, seeds) for n in sizes])
    return found


# ---- figures ----


def draw_errors(d: int, measured: dict[str, tuple[list[int], Array]], seeds: int, path: Path) -> None:
    figure, axes = pyplot.subplots(2, 3, figsize=(11, 7), sharex=True, sharey=True, layout="constrained")
    for k, (axis, title) in enumerate(zip(axes.flat, INTEGRANDS, strict=True)):
        for label, (sizes, rmse) in measured.items():
            _, _, colour, marker = PATTERNS[label]
            axis.loglog(sizes, rmse[:, k], color=colour, marker=marker, markersize=5, linewidth=1.2, label=label)
        axis.set_title(title, fontsize=10)
        axis.grid(alpha=0.3)
        axis.set_xscale("log", base=2)
        axis.set_ylim(1e-6, 1)
    for axis in axes[1]:
        axis.set_xlabel("points")
    figure.supylabel(f"root mean square error, {seeds} seeds", fontsize=10)
    figure.suptitle(f"{d} dimensions, integrands of variance 1", fontsize=11)
    figure.legend(*axes.flat[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=9)
    save(figure, path)


def edge_profile(pixel: Array, lens: Array, blur: float, offsets: Array) -> Array:
    """The share of samples that see the bright side of a vertical edge, pixel by pixel across it:
    a lens point moves what is out of focus by up to half the blur."""
    seen = (pixel[:, None, 0] - 0.5) + blur * (lens[:, None, 0] - 0.5) + offsets > 0
    share: Array = seen.mean(axis=0)
    return share


def true_profile(blur: float, offsets: Array) -> Array:
    """The same by integration: a box of width 1 over a box of the blur's width."""
    x = (np.arange(4000) + 0.5) / 4000 - 0.5
    share: Array = np.clip((x[:, None] + offsets) / abs(blur) + 0.5, 0, 1).mean(axis=0)
    return share


def pixel_and_lens(n: int, seed: int) -> Iterator[tuple[str, Array, Array]]:
    """Samples of pixel and lens: jittered cell by cell in the same order; the same points, one set
    shuffled; and one pattern of four dimensions."""
    pixel, lens = (sf.points("jittered", n, 2, seed=2 * seed + k, dtype="float64") for k in range(2))
    yield "in step", pixel, lens
    order = np.argsort(sf.Rng("pcg64dxsm" if "pcg64dxsm" in sf.RNGS else "pcg32", seed=seed).random(n))
    yield "shuffled", pixel, lens[order]
    both = sf.points("sobol", n, 4, seed=seed, dtype="float64")
    yield "Sobol, 4 dimensions", both[:, :2], both[:, 2:]


STYLES = {"in step": ("#D55E00", "o"), "shuffled": ("#0072B2", "s"), "Sobol, 4 dimensions": ("#009E73", "*")}


def draw_in_step(path: Path, seeds: int) -> list[tuple[int, dict[str, float]]]:
    """Two scatters, the edge, and its errors by count, which are returned."""
    blur, n = -1.0, 64
    offsets = np.linspace(-1.25, 1.25, 51)
    truth = true_profile(blur, offsets)
    figure, axes = pyplot.subplots(1, 4, figsize=(13, 3.6), layout="constrained")
    for axis, (label, pixel, lens) in zip(axes, pixel_and_lens(n, 0), strict=False):
        if label == "Sobol, 4 dimensions":
            break
        axis.plot(pixel[:, 0], lens[:, 0], STYLES[label][1], color=STYLES[label][0], markersize=4)
        axis.set(xlim=(0, 1), ylim=(0, 1), aspect="equal", xlabel="pixel x", ylabel="lens x", title=label)
        axis.set_xticks(np.arange(9) / 8, ["0", *[""] * 7, "1"])
        axis.set_yticks(np.arange(9) / 8, ["0", *[""] * 7, "1"])
        axis.grid(alpha=0.4)
    axes[2].plot(offsets, truth, color="black", linewidth=2, label="exact")
    for label, pixel, lens in pixel_and_lens(n, 0):
        colour, marker = STYLES[label]
        shares = edge_profile(pixel, lens, blur, offsets)
        axes[2].plot(offsets, shares, color=colour, marker=marker, markersize=3, linewidth=1, label=label)
    axes[2].set(xlabel="pixels from the edge", ylabel="share", title=f"a defocused edge, {n} samples")
    axes[2].legend(fontsize=8, loc="lower right")
    table = []
    for size in (16, 64, 256, 1024, 4096):
        squares: dict[str, float] = dict.fromkeys(STYLES, 0.0)
        for seed in range(seeds):
            for label, pixel, lens in pixel_and_lens(size, seed):
                squares[label] += float(((edge_profile(pixel, lens, blur, offsets) - truth) ** 2).mean())
        table.append((size, {label: math.sqrt(square / seeds) for label, square in squares.items()}))
    for label, (colour, marker) in STYLES.items():
        axes[3].loglog([s for s, _ in table], [e[label] for _, e in table], color=colour, marker=marker, label=label)
    axes[3].set_xscale("log", base=2)
    axes[3].set(xlabel="samples", ylabel="root mean square error", title=f"its error, {seeds} seeds")
    axes[3].grid(alpha=0.3)
    axes[3].legend(fontsize=8)
    save(figure, path)
    return table


def save(figure: Any, path: Path) -> None:
    """As a PNG of few colours, below 100 kB."""
    drawn = io.BytesIO()
    figure.savefig(drawn, dpi=80, facecolor="white")
    pyplot.close(figure)
    Image.open(drawn).convert("RGB").quantize(64).save(path, optimize=True)
    print(f"\n{path}: {path.stat().st_size / 1000:.0f} kB")


# ---- tables ----


def pair_discrepancies(label: str, n: int, d: int, seeds: int) -> tuple[Array, Array]:
    """Squared l2-star discrepancies of pairs of dimensions over that of random points, on average:
    of pairs 1·2, 3·4, …, and of 200 others."""
    pattern, options, _, _ = PATTERNS[label]
    random = (1 / 4 - 1 / 9) / n
    inside: list[float] = []
    across: list[float] = []
    chooser = np.random.default_rng(0)
    for seed in range(seeds):
        u = sf.points(pattern, n, d, seed=seed, dtype="float64", **options)
        pairs = [tuple(sorted(chooser.choice(d, 2, replace=False))) for _ in range(200)]
        for i, j in [(i, i + 1) for i in range(0, d, 2)] + [p for p in pairs if p[0] // 2 != p[1] // 2]:
            square = sf.uniformity.discrepancy(u[:, [i, j]], "l2-star") ** 2 / random
            (inside if i // 2 == j // 2 else across).append(square)
    return np.array(inside), np.array(across)


def print_pairs(d: int, sizes: dict[str, int], seeds: int) -> None:
    print(f"\n| {d} dimensions | n | pairs 1·2, 3·4, …: mean, worst | others: mean, worst |\n|---|---|---|---|")
    for label, n in sizes.items():
        inside, across = pair_discrepancies(label, n, d, seeds)
        print(
            f"| {label} | {n:,} | {inside.mean():.3f}, {inside.max():.3f} | {across.mean():.3f}, {across.max():.3f} |"
        )


def print_t_values(n: int, d: int) -> None:
    print(f"\nshare of the pairs of {d} dimensions by t-value, {n} points:")
    for label, (pattern, options, _, _) in PATTERNS.items():
        if pattern == "sobol":
            u = sf.points(pattern, n, d, dtype="float64", **options)
            t = sf.uniformity.pair_t_values(u)[np.triu_indices(d, 1)]
            print(f"{label}: " + ", ".join(f"{k}: {share:.1%}" for k, share in enumerate(np.bincount(t) / t.size)))


def print_errors(d: int, measured: dict[str, tuple[list[int], Array]], least: int) -> None:
    print(f"\n| {d} dimensions | n | " + " | ".join(INTEGRANDS) + " |\n|---|---|" + "---|" * len(INTEGRANDS))
    for label, (sizes, rmse) in measured.items():
        for n, row in zip(sizes, rmse, strict=True):
            if n in (least, sizes[-1]):
                gains = (f"{1 / (e * math.sqrt(n)):.3g}" for e in row)
                print(f"| {label} | {n:,} | " + " | ".join(gains) + " |")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, default=Path(__file__).resolve().parent.parent / "docs/images")
    parser.add_argument("--quick", action="store_true", help="few seeds and small counts, to see that it runs")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    mpl.use("agg")
    seeds, largest = (4, 1 << 10) if options.quick else (64, 1 << 14)
    print("pixel and lens in step: root mean square error of the edge's profile")
    for n, row in draw_in_step(options.output / "pixel-and-lens-in-step.png", 4 if options.quick else 64):
        print(n, {label: float(f"{error:.3g}") for label, error in row.items()})
    for d in (10, 100):
        measured = measure(d, largest, seeds)
        draw_errors(d, measured, seeds, options.output / f"high-dimensions-{d}.png")
        print("\nhow many times less error than n random points:")
        print_errors(d, measured, 1 << 10)
    n = 1 << 10
    sizes = {label: n for label in PATTERNS if label not in ("jittered", "orthogonal array")}
    if not options.quick:
        sizes["orthogonal array"] = counts("orthogonal", 100, 1 << 14)[0]
    print("\nsquared discrepancy of pairs of dimensions, random points = 1:")
    print_pairs(100, sizes, 1 if options.quick else 4)
    print_t_values(n, 10 if options.quick else 100)


if __name__ == "__main__":
    main()
