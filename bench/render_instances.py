# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Memory and time of instances beside the same meshes flattened, each in a process of its own.

One bumpy ball of 9,800 triangles; the same placed 1,000 times (rotated, scaled along three axes); and these
flattened, in which case the arrays are the scene's too. Resident memory is what building the scene and rendering
it adds; the time that of one thread, by processor time of the render call, median of the rounds.
"""

from __future__ import annotations

import argparse
import json
import resource
import statistics
import subprocess
import sys
import time

import numpy as np

import sunfleck as sf

COPIES = 1000
SIDE = 70


def ball() -> sf.Mesh:
    """A ball of SIDE x SIDE quads in latitude and longitude, with bumps."""
    u, v = np.meshgrid(np.linspace(0, np.pi, SIDE + 1), np.linspace(0, 2 * np.pi, SIDE + 1), indexing="ij")
    radius = 1 + 0.05 * np.sin(9 * u) * np.sin(9 * v)
    points = radius[..., None] * np.stack([np.sin(u) * np.cos(v), np.sin(u) * np.sin(v), np.cos(u)], axis=-1)
    first = (np.arange(SIDE)[:, None] * (SIDE + 1) + np.arange(SIDE)).ravel()
    faces = first[:, None, None] + np.array([[0, SIDE + 1, SIDE + 2], [0, SIDE + 2, 1]])
    return sf.Mesh(points.reshape(-1, 3).astype(np.float32), faces.reshape(-1, 3).astype(np.uint32), (0.7, 0.6, 0.5))


def transforms(count: int) -> np.ndarray:
    rng = np.random.default_rng(1)
    out = np.zeros((count, 3, 4), dtype=np.float32)
    for one in out:
        one[:, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0] @ np.diag(rng.uniform(0.3, 1, 3))
        one[:, 3] = rng.uniform(-10, 10, 3)
    return out


def resident() -> int:
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


def measure(kind: str, rounds: int) -> dict[str, float]:
    mesh, placed = ball(), transforms(1 if kind == "one" else COPIES)
    before = resident()
    started = time.perf_counter()
    if kind == "flattened":
        points = [np.float32(mesh.vertices @ t[:, :3].T + t[:, 3]) for t in placed]
        corners = [mesh.triangles if np.linalg.det(t[:, :3]) > 0 else mesh.triangles[:, ::-1].copy() for t in placed]
        shapes: list[sf.Mesh | sf.Instances] = [
            sf.Mesh(p, c, mesh.albedo) for p, c in zip(points, corners, strict=True)
        ]
    else:
        shapes = [sf.Instances(mesh, placed)]
    scene = sf.Scene(shapes, sf.Camera((0, -40, 5), (0, 0, 0), up=(0, 0, 1)), (1, 1, 1), max_bounces=3)
    built = time.perf_counter() - started
    seconds = []
    for _ in range(rounds):
        start = time.process_time()
        image = sf.render(scene, 192, 192, spp=16, threads=1)
        seconds.append(time.process_time() - start)
    return {
        "MB": (resident() - before) / 1e6,
        "build_s": built,
        "render_s": statistics.median(seconds),
        "spread": (max(seconds) - min(seconds)) / statistics.median(seconds),
        "mean": float(image.color.mean()),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--kind", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.kind:
        print(json.dumps(measure(options.kind, options.rounds)))
        return
    print(f"{'scene':<12}{'MB':>8}{'build s':>10}{'render s':>10}{'spread':>8}{'mean':>8}")
    for kind in ("one", "instances", "flattened"):
        command = [sys.executable, __file__, "--kind", kind, "--rounds", str(options.rounds)]
        got = json.loads(subprocess.check_output(command, text=True))
        print(
            f"{kind:<12}{got['MB']:8.1f}{got['build_s']:10.3f}{got['render_s']:10.3f}"
            f"{got['spread']:8.2f}{got['mean']:8.4f}"
        )


if __name__ == "__main__":
    main()
