# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Lights by area and by solid angle: which has less error, and which less error a second.

A square light of side 2 at several heights above a floor, half of it as a triangle, the Cornell box
under a light as large as its ceiling, and the built-in scenes; 64 samples a pixel, 96 x 96, direct
light (keyhole and cornell: 5 bounces). relMSE against 8,192 samples a pixel; the ways take turns,
medians over the seeds.
Writes docs/images/area-lights.png.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib import pyplot
from measure import ROOT, describe_build, describe_machine

import sunfleck as sf

SIZE, SPP, SEEDS, TRUTH_SPP = 96, 64, 7, 4096
ALWAYS = float("inf")
RATIOS = (0.0, 0.5, 1.0, 2.0, ALWAYS)
HEIGHTS = (0.03, 0.1, 0.3, 1.0, 2.0, 4.0)

Make = Callable[[float], sf.Scene]


def panel(height: float, triangles: int = 2) -> Make:
    """A floor under a square of side 2, or under the half of it that one triangle is."""

    def make(ratio: float) -> sf.Scene:
        quad = [[0, 1, 2], [0, 2, 3]]
        floor = sf.Mesh([[-5, -5, 0], [5, -5, 0], [5, 5, 0], [-5, 5, 0]], quad, (0.7, 0.7, 0.7))
        corners = [[-1, -1, height], [-1, 1, height], [1, 1, height], [1, -1, height]]
        light = sf.Mesh(corners, quad[:triangles], (0, 0, 0), (10, 10, 10))
        camera = sf.Camera((0, -4, 0.02 + 0.5 * min(height, 1)), (0, 0, 0), up=(0, 0, 1), vertical_fov=50)
        return sf.Scene([floor, light], camera, max_bounces=1, solid_angle_ratio=ratio)

    return make


def ceiling(ratio: float) -> sf.Scene:
    """The Cornell box under a light of 97 % of its ceiling's width."""
    box = sf.scenes.cornell()
    corners = [[-0.97, 0.99, -0.97], [0.97, 0.99, -0.97], [0.97, 0.99, 0.97], [-0.97, 0.99, 0.97]]
    light = sf.Mesh(corners, [[0, 1, 2], [0, 2, 3]], (0, 0, 0), (1, 0.8, 0.5))
    return sf.Scene([*box.meshes[:7], light], box.camera, max_bounces=1, solid_angle_ratio=ratio)


def built_in(name: str) -> Make:
    def make(ratio: float) -> sf.Scene:
        scene: sf.Scene = getattr(sf.scenes, name)()
        return sf.Scene(scene.meshes, scene.camera, scene.background, scene.max_bounces, solid_angle_ratio=ratio)

    return make


def measure(make: Make) -> dict[float, tuple[float, float, bool]]:
    """relMSE, seconds, and whether the plan has the stage, by ratio."""
    scenes = {ratio: make(ratio) for ratio in RATIOS}
    truths = [sf.render(scenes[ALWAYS], SIZE, SIZE, spp=TRUTH_SPP, seed=s).color for s in (1001, 1002)]
    truth = np.mean(truths, axis=0, dtype=np.float64)
    results: dict[float, list[tuple[float, float]]] = {ratio: [] for ratio in RATIOS}
    for seed in range(SEEDS):
        for ratio, scene in scenes.items():
            start = time.perf_counter()
            image = sf.render(scene, SIZE, SIZE, spp=SPP, seed=seed)
            seconds = time.perf_counter() - start
            error = (image.color - truth) ** 2 / (truth**2 + (0.1 * truth.mean()) ** 2)
            results[ratio].append((float(error.mean()), seconds))
    return {
        ratio: (*np.median(runs, axis=0).tolist(), "light shapes" in scenes[ratio].plan().stages)
        for ratio, runs in results.items()
    }


def chart(rows: list[dict[float, tuple[float, float, bool]]], path: Path) -> None:
    mpl.rcParams["svg.hashsalt"] = "sunfleck"
    figure, axes = pyplot.subplots(1, 2, figsize=(9, 3.4), sharex=True, layout="constrained")
    distance = np.array(HEIGHTS) / np.sqrt(8)
    for ratio, color, marker in ((1.0, "#0072B2", "o"), (ALWAYS, "#D55E00", "s")):
        label = "ratio 1 (default)" if ratio == 1 else "always by solid angle"
        error = np.array([row[ratio][0] / row[0.0][0] for row in rows])
        seconds = np.array([row[ratio][1] / row[0.0][1] for row in rows])
        axes[0].loglog(distance, error, color=color, marker=marker, label=label)
        axes[1].loglog(distance, error * seconds, color=color, marker=marker, label=label)
    for axis, title in zip(axes, ("relMSE, over that by area", "relMSE x seconds, over that by area"), strict=True):
        axis.axhline(1, color="#000000", linewidth=0.8)
        axis.axvline(1, color="#999999", linewidth=0.8, linestyle="--")
        axis.set_xlabel("height of the light over its diagonal")
        axis.set_title(title, fontsize=10)
        axis.grid(alpha=0.3)
    axes[0].legend(fontsize=9)
    figure.savefig(path, dpi=110, metadata={"Software": None})


def main() -> None:
    """Arguments: the names of the cases that shall be measured; none: all."""
    print(describe_machine())
    print(describe_build())
    print(f"{'':16}" + "".join(f"{'ratio ' + format(r, 'g'):>22}" for r in RATIOS))
    print(f"{'':16}" + f"{'relMSE   ms':>22}" + f"{'relMSE x   seconds x':>22}" * (len(RATIOS) - 1))
    cases = {f"panel at {h:g}": panel(h) for h in HEIGHTS} | {"ceiling": ceiling}
    cases |= {f"triangle at {h:g}": panel(h, 1) for h in (0.3, 1.0, 2.0)}
    cases |= {name: built_in(name) for name in ("penumbra", "defocus", "cornell", "keyhole")}
    rows = []
    for name, make in cases.items():
        if len(sys.argv) > 1 and name not in sys.argv[1:]:
            continue
        row = measure(make)
        error, seconds, _ = row[0.0]
        text = f"{name:16}{error:14.2e}{1e3 * seconds:8.1f}"
        for ratio in RATIOS[1:]:
            planned = " " if row[ratio][2] else "-"
            text += f"{row[ratio][0] / error:14.3f}{row[ratio][1] / seconds:7.2f}{planned}"
        print(text, flush=True)
        rows.append(row)
        if len(rows) == len(HEIGHTS) and name == f"panel at {HEIGHTS[-1]:g}":
            chart(rows, ROOT / "docs/images/area-lights.png")


if __name__ == "__main__":
    main()
