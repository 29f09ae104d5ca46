# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Choosing among many lights: what the tree saves against a choice by power, and what it costs.

A floor with walls under 2 to 10,000 emissive triangles, of four radiances: spread through the room and
facing anywhere, over a field of 20 x 20, in 8 clusters, as one sphere of triangles (a bumpy lamp), or as
one flat panel. Error: relMSE over the pixels in which no lamp is seen (the edges of lamps are the same
noise for both), against a reference of 64 times the samples. Time: of renders alternately with both, in
one process.

    python bench/render_many_lights.py [--seeds 5] [--counts 2 8 32] [--layouts spread panel]
"""

from __future__ import annotations

import argparse
import statistics
import time

import numpy as np
import numpy.typing as npt

import sunfleck as sf

Vertices = npt.NDArray[np.float32]

COUNTS = (2, 8, 32, 128, 1024, 10_000)
LAYOUTS = ("spread", "field", "clusters", "bumpy", "panel")
SIZE, SPP, REFERENCE_SPP = 64, 32, 2048


def triangles_about(middles: Vertices, size: float, rng: np.random.Generator) -> Vertices:
    """Triangles of that size about the points, facing anywhere."""
    return (middles[:, None] + size * rng.uniform(-1, 1, (len(middles), 3, 3))).astype(np.float32)


def panel(count: int) -> Vertices:
    """A square facing down, cut into a fan-free grid of `count` triangles whose halves differ."""
    rows = max(1, int(np.sqrt(count / 2)))
    columns = -(-count // (2 * rows))
    x, y = np.meshgrid(np.linspace(-0.7, 0.7, columns + 1), np.linspace(-0.7, 0.7, rows + 1))
    a, b, c, d = (
        np.stack([x[s], np.full_like(x[s], 1.9), y[s]], -1).reshape(-1, 3)
        for s in (np.s_[:-1, :-1], np.s_[:-1, 1:], np.s_[1:, 1:], np.s_[1:, :-1])
    )
    return np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])[:count].astype(np.float32)


def bumpy(count: int, rng: np.random.Generator) -> Vertices:
    """Small triangles over a sphere that face outwards, each tilted a little."""
    k = np.arange(count) + 0.5
    height, turn = 1 - 2 * k / count, np.pi * (1 + 5**0.5) * k
    ring = np.sqrt(1 - height**2)
    out = np.stack([ring * np.cos(turn), height, ring * np.sin(turn)], 1)
    tilted = out + 0.2 * rng.normal(size=out.shape)
    tilted /= np.linalg.norm(tilted, axis=1, keepdims=True)
    across = np.cross(tilted, [0.3, 0.5, 0.8])
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    along, half = np.cross(tilted, across), 0.4 * 1.5 / np.sqrt(count)
    corners = [across, -0.5 * across + 0.87 * along, -0.5 * across - 0.87 * along]
    return np.stack([[0, 1, 0] + 0.4 * out + half * c for c in corners], 1).astype(np.float32)


def lamps_of(layout: str, count: int, rng: np.random.Generator) -> Vertices:
    size = 0.3 / np.sqrt(count)
    if layout == "spread":
        return triangles_about(rng.uniform((-0.9, 0.1, -0.9), (0.9, 1.9, 0.9), (count, 3)), size, rng)
    if layout == "field":
        return triangles_about(rng.uniform((-10, 0.1, -20), (10, 1, 0), (count, 3)), 4 * size, rng)
    if layout == "clusters":
        middles = rng.uniform((-0.8, 0.3, -0.8), (0.8, 1.8, 0.8), (8, 3))
        return triangles_about(middles[np.arange(count) % 8] + 0.08 * rng.normal(size=(count, 3)), size, rng)
    return bumpy(count, rng) if layout == "bumpy" else panel(count)


def scene_of(layout: str, count: int, choice: str) -> sf.Scene:
    rng = np.random.default_rng(count)
    corners = lamps_of(layout, count, rng)
    groups = np.array_split(np.arange(count), min(4, count))  # of different radiance
    radiance = (np.full(4, 6.0) if layout in ("panel", "bumpy") else np.array([2.0, 5.0, 10.0, 20.0])).tolist()
    meshes = [
        sf.Mesh(corners[g].reshape(-1, 3), np.arange(3 * len(g)).reshape(-1, 3), (0, 0, 0), (radiance[k],) * 3)
        for k, g in enumerate(groups)
    ]
    room = [[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1], [-1, 2, -1], [1, 2, -1], [1, 2, 1], [-1, 2, 1]]
    faces = [[0, 1, 2], [0, 2, 3], [0, 4, 1], [1, 4, 5], [0, 3, 4], [3, 7, 4], [1, 5, 2], [2, 5, 6]]
    camera = sf.Camera((0, 1, 3.2), (0, 0.8, 0), vertical_fov=45)
    if layout == "field":
        room, faces = [[-15, 0, -25], [15, 0, -25], [15, 0, 5], [-15, 0, 5]], [[0, 2, 1], [0, 3, 2]]
        camera = sf.Camera((0, 3, 3), (0, 0, -4), vertical_fov=45)
    walls = sf.Mesh(room, faces, albedo=(0.6, 0.6, 0.6))
    return sf.Scene([walls, *meshes], camera, max_bounces=2, light_choice=choice)


def measure(layout: str, count: int, seeds: int) -> tuple[list[float], list[float], int]:
    """Error and time of the tree over those of power, seed by seed; pieces."""
    scenes = {choice: scene_of(layout, count, choice) for choice in ("power", "tree")}
    film = sf.render(scenes["tree"], SIZE, SIZE, spp=REFERENCE_SPP, seed=10**6, aovs=["albedo"])
    reference, lit = film.color.astype(float), film.aovs["albedo"][..., 0] > 0.599
    errors, times = [], []
    for seed in range(seeds):
        error, seconds = {}, {}
        for choice in ("power", "tree") if seed % 2 else ("tree", "power"):
            begin = time.perf_counter()
            image = sf.render(scenes[choice], SIZE, SIZE, spp=SPP, seed=seed)
            seconds[choice] = time.perf_counter() - begin
            off = ((image.color - reference) ** 2 / (reference**2 + 1e-4))[lit]
            error[choice] = float(off.mean())
        errors.append(error["tree"] / error["power"])
        times.append(seconds["tree"] / seconds["power"])
    return errors, times, scenes["tree"].info.light_count


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--counts", type=int, nargs="*", default=COUNTS)
    parser.add_argument("--layouts", nargs="*", default=LAYOUTS)
    options = parser.parse_args()
    print("| layout | triangles | pieces | error × | time × | error × time: median | least .. most |")
    print("|---|---|---|---|---|---|---|")
    for layout in options.layouts:
        for count in options.counts:
            errors, times, pieces = measure(layout, count, options.seeds)
            cost = sorted(e * t for e, t in zip(errors, times, strict=True))
            error, seconds, middle = (statistics.median(x) for x in (errors, times, cost))
            print(
                f"| {layout} | {count} | {pieces} | {error:.3f} | {seconds:.2f} | {middle:.3f} |"
                f" {cost[0]:.3f} .. {cost[-1]:.3f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
