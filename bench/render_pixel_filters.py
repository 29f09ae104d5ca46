# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Pixel filters: coverage, error and time of each on penumbra, and a zone plate under each.

Prints, for 128 x 128 pixels and every filter, the share of pixels whose true error is within the half-width
at a tolerance (all, and the hard ones: those that took more than the first look), for each stopping rule; relMSE
at a fixed count against a long render under the same filter; and the time of a sample, in
turn with the others. Writes docs/images/pixel_filters.png: sf.PIXEL_FILTERS row by row, four a row.
"""

from __future__ import annotations

import argparse
import statistics
import time
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from measure import ROOT, describe_build, describe_machine
from numpy.typing import NDArray

import sunfleck as sf

SIZE = 128
MET = sf.STOP_REASONS.index("met")
RULES = ("dyadic", "standard_error", "replicates")


def level_of(image: sf.Image) -> NDArray[np.float64]:
    return image.color.mean(axis=2, dtype=np.float64)


def coverage(scene: sf.Scene, truth: NDArray[np.float64], name: str, rule: str, seeds: int) -> str:
    shares, hard_shares, samples = [], [], []
    for seed in range(seeds):
        image = sf.render(scene, SIZE, SIZE, tolerance=0.02, pixel_filter=name, stop=rule, seed=seed)
        covered, met = np.abs(level_of(image) - truth) <= image.half_width, image.stop_reason == MET
        hard = met & (image.samples > image.samples.min())
        shares.append(covered[met].mean())
        hard_shares.append(covered[hard].mean())
        samples.append(image.samples.mean())
    return f"{np.mean(shares):.3f} ({np.mean(hard_shares):.3f}), {np.mean(samples):.0f}"


def times(scene: sf.Scene, runs: int) -> dict[str, list[float]]:
    taken: dict[str, list[float]] = {name: [] for name in sf.PIXEL_FILTERS}
    for _ in range(runs):
        for name in sf.PIXEL_FILTERS:
            start = time.perf_counter()
            sf.render(scene, SIZE, SIZE, spp=64, pixel_filter=name)
            taken[name].append((time.perf_counter() - start) / (64 * SIZE * SIZE) * 1e9)
    return taken


def zone_plate() -> sf.Scene:
    """Rings of equal area, bright and dark, seen straight on: 64 pixels, finer towards the border than pixels are."""
    sides, rings = 256, 84
    angle = np.arange(sides) * (2 * np.pi / sides)
    circle = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    vertices, triangles = [], []
    for k in range(rings):
        inner, outer = (np.sqrt(12.5 * (2 * k + i)) for i in (0, 1))  # a pixel is 1/2 wide: periods of two pixels at 25
        base = 2 * sides * k
        vertices += [circle * inner, circle * outer]
        here = np.arange(sides)
        ahead = (here + 1) % sides
        triangles += [
            np.stack([base + here, base + sides + here, base + sides + ahead], axis=1),
            np.stack([base + here, base + sides + ahead, base + ahead], axis=1),
        ]
    mesh = sf.Mesh(
        np.concatenate(vertices).astype(np.float32),
        np.concatenate(triangles).astype(np.uint32),
        albedo=(0, 0, 0),
        emission=(0.8, 0.8, 0.8),
    )
    camera = sf.Camera((16, 16, 32), (16, 16, 0), up=(0, 1, 0), vertical_fov=53.1301)
    return sf.Scene([mesh], camera, max_bounces=0)


def draw(path: Path, spp: int) -> None:
    scale, columns, gap = 3, 4, 8
    step = 64 * scale + gap
    sheet = np.ones((2 * step + gap, columns * step + gap, 3), np.float32)
    for i, name in enumerate(sf.PIXEL_FILTERS):
        color = np.clip(sf.render(zone_plate(), 64, 64, spp=spp, pixel_filter=name).color, 0, 1)
        x, y = gap + i % columns * step, gap + i // columns * step
        sheet[y : y + 64 * scale, x : x + 64 * scale] = color.repeat(scale, axis=0).repeat(scale, axis=1)
    srgb = np.where(sheet <= 0.0031308, 12.92 * sheet, 1.055 * sheet ** (1 / 2.4) - 0.055)
    spec = oiio.ImageSpec(sheet.shape[1], sheet.shape[0], 3, oiio.UINT8)
    out = oiio.ImageOutput.create(str(path))
    if not (out and out.open(str(path), spec) and out.write_image((srgb * 255 + 0.5).astype(np.uint8)) and out.close()):
        raise OSError(f"{path} can't be written: {oiio.geterror()}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--runs", type=int, default=9)
    parser.add_argument("--truth-spp", type=int, default=16384)
    parser.add_argument("--only", choices=["coverage", "time", "picture"])
    args = parser.parse_args()
    print(describe_machine())
    print(describe_build())
    scene = sf.scenes.penumbra()
    if args.only in (None, "time"):
        for name, taken in times(scene, args.runs).items():
            print(f"{name:20} {statistics.median(taken):6.1f} ns a sample ({min(taken):.1f} to {max(taken):.1f})")
    if args.only in (None, "coverage"):
        print(f"filter: coverage (hard), samples a pixel: {', '.join(RULES)}; relMSE at 64")
        for name in sf.PIXEL_FILTERS:
            truth_image = sf.render(scene, SIZE, SIZE, spp=args.truth_spp, pixel_filter=name, seed=2**40)
            truth = level_of(truth_image)
            cells = [coverage(scene, truth, name, rule, args.seeds) for rule in RULES]
            errors = []
            for seed in range(args.seeds):
                color = sf.render(scene, SIZE, SIZE, spp=64, pixel_filter=name, seed=seed).color
                errors.append(np.mean((level_of_array(color) - truth) ** 2 / (truth**2 + 0.01 * truth.mean() ** 2)))
            print(f"{name:20} {' | '.join(cells)} | {np.mean(errors):.2e}", flush=True)
    if args.only in (None, "picture"):
        draw(ROOT / "docs/images/pixel_filters.png", 4096)


def level_of_array(color: NDArray[np.float32]) -> NDArray[np.float64]:
    return np.asarray(color.mean(axis=2, dtype=np.float64))


if __name__ == "__main__":
    main()
