# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""How a render scales: time over threads, memory over the image's and the scene's size.

    render_scaling.py threads      penumbra and cornell, 64 samples a pixel, 256 x 256, on 1, 2, 4, … threads
    render_scaling.py memory       the greatest resident memory of an 8K image, and of 10 million triangles

Thread counts take turns within a run; ratios are of one run. Each case of memory runs in a process
of its own, whose peak includes the interpreter, NumPy, the scene's arrays and the picture.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable

import numpy as np
from measure import describe_machine, state

import sunfleck as sf

SIZE, SPP = 256, 64


def measure_threads(runs: int) -> None:
    available = len(os.sched_getaffinity(0))
    counts = sorted({2**k for k in range(available.bit_length())} | {available})
    for name in ("penumbra", "cornell"):
        scene = getattr(sf.scenes, name)()
        sf.render(scene, SIZE, SIZE, spp=4)
        seconds: dict[int, list[float]] = {count: [] for count in counts}
        for seed in range(runs):
            for count in counts:
                start = time.perf_counter()
                sf.render(scene, SIZE, SIZE, spp=SPP, seed=seed, threads=count)
                seconds[count].append(time.perf_counter() - start)
        for count in counts:
            gains = [one / many for one, many in zip(seconds[1], seconds[count], strict=True)]
            print(f"{name}, {count} threads: {state(seconds[count])} s; one thread's over it: {state(gains)}")


def make_terrain(side: int) -> sf.Scene:
    """A displaced grid of 2 side^2 triangles under penumbra's light, seen by its camera."""
    x, y = np.meshgrid(np.linspace(-5, 5, side + 1), np.linspace(-5, 5, side + 1), indexing="ij")
    z = 0.1 * np.sin(7 * x) * np.cos(5 * y) + 0.002 * np.sin(900 * x) * np.sin(700 * y)
    vertices = np.stack([x, y, z], axis=-1).reshape(-1, 3).astype(np.float32)
    corner = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).reshape(-1, 1).astype(np.uint32)
    triangles = (corner + np.array([0, side + 1, side + 2, 0, side + 2, 1], np.uint32)).reshape(-1, 3)
    penumbra = sf.scenes.penumbra()
    ground = sf.Mesh(vertices, triangles, (0.7, 0.7, 0.7))
    return sf.Scene([ground, penumbra.meshes[-1]], penumbra.camera, max_bounces=1)


CASES: dict[str, tuple[Callable[[], sf.Scene], int, int, dict[str, float]]] = {
    "nothing rendered": (sf.scenes.penumbra, 0, 0, {}),
    "8K, 4 spp": (sf.scenes.penumbra, 7680, 4320, {"spp": 4}),
    "8K, tolerance 0.1": (sf.scenes.penumbra, 7680, 4320, {"tolerance": 0.1}),
    "10 million triangles, 4 spp": (lambda: make_terrain(2237), 1920, 1080, {"spp": 4}),
}


def run_case(name: str) -> None:
    make, width, height, options = CASES[name]
    start = time.perf_counter()
    scene = make()
    scene.plan()
    built = time.perf_counter()
    if width:
        image = sf.render(scene, width, height, **options)  # type: ignore[arg-type]
        assert np.isfinite(image.color).all()
        assert image.samples.min() > 0
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    triangles = sum(len(mesh.triangles) for mesh in scene.meshes)
    print(
        f"{name}: {width} x {height}, {triangles:,} triangles: peak {peak:.2f} GiB resident, "
        f"{built - start:.1f} s to build the scene, {time.perf_counter() - built:.1f} s to render"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=["threads", "memory"])
    parser.add_argument("--case", choices=sorted(CASES), help="one case of memory, in this process")
    parser.add_argument("--runs", type=int, default=9)
    args = parser.parse_args()
    if args.case:
        run_case(args.case)
        return
    print(describe_machine())
    if args.what == "threads":
        measure_threads(args.runs)
        return
    for case in CASES:
        subprocess.run([sys.executable, __file__, "memory", "--case", case], check=True)


if __name__ == "__main__":
    main()
