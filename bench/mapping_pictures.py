# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""How patterns look on the shapes, and what mappings keep of them: pictures and a table for docs/mapping.md.

Writes docs/mapping/*.png (needs matplotlib) and prints the table: for 1024 points, as the mean of 8
seeds, the discrepancy (the largest difference between the share of the points and that of the
area, over 4096 half planes through the shape: of a hemisphere's equal-area projection, of a cosine
hemisphere's disk; caps of the sphere), and the least distance of two points over that of the
densest packing of as many, sqrt(2 / (sqrt(3) n / area)).
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from PIL import Image

import sunfleck as sf

mpl.use("Agg")
import matplotlib.pyplot as plt

FOLDER = Path(__file__).resolve().parent.parent / "docs/mapping"
PATTERNS = ["uniform", "random", "jittered", "halton", "sobol"]
CORNERS = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.5, 3**0.5 / 2, 0.0))
SHAPES: dict[str, tuple[str, dict[str, Any]]] = {
    "disk": ("disk_polar", {}),
    "disk_concentric": ("disk_concentric", {}),
    "disk_naive": ("disk_naive", {}),
    "triangle": ("triangle", dict(zip("abc", CORNERS, strict=True))),
    "triangle_low_distortion": ("triangle_low_distortion", dict(zip("abc", CORNERS, strict=True))),
    "hemisphere": ("hemisphere", {}),
    "cosine_hemisphere": ("cosine_hemisphere", {}),
    "cosine_hemisphere_concentric": ("cosine_hemisphere_concentric", {}),
    "sphere": ("sphere", {}),
    "parallelogram": ("parallelogram", {"a": (-0.8, -0.5, 0), "b": (0.4, -0.5, 0), "c": (-0.4, 0.5, 0)}),
    "annulus": ("annulus", {"inner": 0.5}),
    "regular_polygon": ("regular_polygon", {"sides": 6}),
    "cone": ("cone", {"angle": 0.7}),
    "power_cosine": ("power_cosine", {"exponent": 8}),
    "henyey_greenstein": ("henyey_greenstein", {"g": 0.5}),
    "ggx_visible_normals": ("ggx_visible_normals", {"w": (0.6, 0, 0.8), "alpha_x": 0.5, "alpha_y": 0.5}),
    "spherical_triangle": ("spherical_triangle", {"a": (1, 0, 0.2), "b": (-1, -1, 0.2), "c": (0, 1, 1)}),
    "spherical_rectangle": ("spherical_rectangle", {"a": (-1, -1, 0.4), "b": (1, -1, 0.4), "c": (-1, 1, 0.4)}),
    "pixel_tent": ("pixel_tent", {}),
    "pixel_gaussian": ("pixel_gaussian", {}),
    "pixel_gaussian_truncated": ("pixel_gaussian_truncated", {}),
    "pixel_blackman_harris": ("pixel_blackman_harris", {}),
    "pixel_mitchell": ("pixel_mitchell", {}),
    "pixel_lanczos": ("pixel_lanczos", {}),
}
MEASURED = ("disk_polar", "disk_concentric", "triangle", "triangle_low_distortion", "hemisphere", "cosine_hemisphere")
MEASURED += ("cosine_hemisphere_concentric", "sphere")
ABOUT_THE_POLE = ("hemisphere", "cosine_hemisphere", "cosine_hemisphere_concentric", "cone", "power_cosine")
ABOUT_THE_POLE += ("ggx_visible_normals", "spherical_triangle", "spherical_rectangle")


def points_on(shape: str, pattern: str, n: int, seed: int = 1) -> np.ndarray:
    name, named = SHAPES[shape]
    u = sf.points(pattern, n, seed=seed, dtype="float64")
    x: np.ndarray = getattr(sf.mapping, name).sample(u, **named)
    return x


def outline(ax: Any, shape: str) -> None:
    turn = np.linspace(0, 2 * np.pi, 200)
    if shape.startswith("triangle"):
        ring = np.array([*CORNERS, CORNERS[0]])[:, :2]
    elif shape.startswith("pixel"):
        ring = np.array([(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)])
    else:
        ring = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    ax.plot(*ring.T, lw=0.6, color="0.6")


def seen(shape: str, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Directions seen from a little above the horizon, the pole up, and how near they are; the flat as it is."""
    if x.shape[1] == 2 or shape.startswith(("triangle", "parallelogram")):
        return x[:, :2], np.ones(len(x))
    if shape in ABOUT_THE_POLE:
        lift = np.radians(25)
        depth = -x[:, 1] * np.cos(lift) + x[:, 2] * np.sin(lift)
        flat = np.stack([x[:, 0], x[:, 2] * np.cos(lift) + x[:, 1] * np.sin(lift)], axis=1)
    else:
        depth, flat = -x[:, 1], x[:, [0, 2]]
    return flat, depth


def draw(shape: str, n: int) -> None:
    figure, axes = plt.subplots(1, len(PATTERNS), figsize=(9, 2.1), dpi=110, constrained_layout=True)
    for ax, pattern in zip(axes, PATTERNS, strict=True):
        flat, depth = seen(shape, points_on(shape, pattern, n))
        outline(ax, shape)
        ax.scatter(*flat[depth >= 0].T, s=1.8, lw=0, color="#1d4b73")
        ax.set_title(pattern, fontsize=8)
        ax.set_aspect("equal")
        ax.axis("off")
        if shape.startswith("pixel"):
            ax.set(xlim=(-0.75, 1.75), ylim=(-0.75, 1.75))
    figure.canvas.draw()
    pixels = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())[..., :3])  # type: ignore[attr-defined]
    pixels.quantize(16).save(FOLDER / f"{shape}.png", optimize=True)
    plt.close(figure)


Test = Callable[[np.ndarray], np.ndarray]


def cuts(shape: str, rng: np.random.Generator, count: int) -> tuple[Test, np.ndarray]:
    """Cuts through the shape that no mapping of it is aligned with, and the share beyond each."""
    if shape == "sphere":
        axis = sf.mapping.sphere.sample(rng.random((count, 2)))
        d = 2 * rng.random(count) - 1
        return lambda x: x @ axis.T > d, (1 - d) / 2
    turn = 2 * np.pi * rng.random(count)
    normal = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    if shape.startswith("triangle"):
        inner = sf.mapping.triangle.sample(rng.random((count, 2)), *CORNERS)[:, :2]
        d = (inner * normal).sum(axis=1)
        # Of the corners' heights over the line: the tip beyond it, or all but the tip before it.
        low, middle, high = np.sort(np.array(CORNERS)[:, :2] @ normal.T - d, axis=0)
        tip = high**2 / ((high - low) * (high - middle))
        rest = 1 - low**2 / ((low - middle) * (low - high))
        return lambda x: x[:, :2] @ normal.T > d, np.where(middle > 0, rest, tip)
    d = 2 * rng.random(count) - 1
    share = (np.arccos(d) - d * np.sqrt(1 - d * d)) / np.pi
    if shape == "hemisphere":  # Lambert's equal-area projection
        return lambda x: (x[:, :2] / np.sqrt(1 + x[:, 2:])) @ normal.T > d, share
    return lambda x: x[:, :2] @ normal.T > d, share


def nearest(x: np.ndarray, area: float) -> float:
    square = (x**2).sum(axis=1)
    d2 = square[:, None] + square[None] - 2 * x @ x.T
    np.fill_diagonal(d2, np.inf)
    best = np.sqrt(2 / (3**0.5 * len(x) / area))
    return float(np.sqrt(np.maximum(d2.min(axis=1), 0)).min() / best)


def table(n: int, seeds: int) -> None:
    print("| shape | mapping | discrepancy: sobol | jittered | random | least distance: sobol | jittered | random |")
    print("|---|---|---|---|---|---|---|---|")
    areas = {"disk": np.pi, "triangle": 3**0.5 / 4, "hemisphere": 2 * np.pi, "cosine": np.pi, "sphere": 4 * np.pi}
    for shape, (name, _) in SHAPES.items():
        if name not in MEASURED:
            continue
        test, share = cuts(shape, np.random.default_rng(0), 4096)
        row: list[list[str]] = [[], []]
        for pattern in ("sobol", "jittered", "random"):
            sets = [points_on(shape, pattern, n, seed) for seed in range(1, seeds + 1)]
            worst = np.mean([np.abs(test(x).mean(axis=0) - share).max() for x in sets])
            # A cosine hemisphere is even seen from above: distances on its disk.
            flat = [x[:, :2] if "cosine" in shape else x for x in sets]
            least = np.mean([nearest(x, areas[shape.split("_")[0]]) for x in flat])
            row[0].append(f"{worst:.4f}")
            row[1].append(f"{least:.3f}")
        print(f"| {shape.split('_')[0]} | `{name}` | {' | '.join(row[0])} | {' | '.join(row[1])} |")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-n", type=int, default=1024, help="points (default 1024)")
    parser.add_argument("--table-only", action="store_true")
    args = parser.parse_args()
    if not args.table_only:
        FOLDER.mkdir(parents=True, exist_ok=True)
        for shape in SHAPES:
            draw(shape, args.n)
    table(args.n, seeds=8)


if __name__ == "__main__":
    main()
