# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Up to how many primitives it pays to sort surface rays, and to trace their packets as coherent.

    render_sort_threshold.py [--rounds N]

Two builds, in build/few/: one sorts in all scenes, one in none (FEW of csrc/scene/scene.c). Each renders
the Cornell box with walls left out, boxes or balls added, or all walls and boxes split, and the
keyhole; in turn, each time in a process of its own. A ratio is the time with sorting over that without.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import cast

from measure import ROOT, describe_build, describe_machine, state
from variants import build, run

WORK = ROOT / "build/few"
TIMED = """
import json, time
import numpy as np

def split(mesh, n):
    corners, vertices, triangles = np.asarray(mesh.vertices, float), [], []
    for a, b, c in np.asarray(mesh.triangles):
        at = {}
        for i in range(n + 1):
            for j in range(n + 1 - i):
                at[i, j] = len(vertices)
                vertices.append(corners[a] + (corners[b] - corners[a]) * i / n + (corners[c] - corners[a]) * j / n)
        for i in range(n):
            for j in range(n - i):
                triangles.append((at[i, j], at[i + 1, j], at[i, j + 1]))
                if i + j < n - 1:
                    triangles.append((at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]))
    return sf.Mesh(np.array(vertices, np.float32), np.array(triangles, np.uint32), mesh.albedo, mesh.emission)

def several(count, shape):
    rng = np.random.default_rng(count)
    return [sf.Mesh(*shape(rng), (0.7, 0.6, 0.5)) for _ in range(count)]

def box(rng):
    return sf.scenes._turned_box((0.08, 0.08, 0.08), float(rng.uniform(0, 90)), rng.uniform(-0.8, 0.8, 3))

def ball(subdivisions):
    return lambda rng: sf.scenes._icosphere(subdivisions, 0.15, rng.uniform(-0.8, 0.8, 3))

cornell, keyhole = sf.scenes.cornell(), sf.scenes.keyhole()
room, lamp = cornell.meshes[:-1], cornell.meshes[-1]
meshes = {
    "cornell": [*room, lamp],
    "its first 5 walls": [*room[:5], lamp],
    "one box": [*room[:6], lamp],
    **{f"{n} small boxes more": [*room, lamp, *several(n, box)] for n in (1, 2, 3, 4, 6, 10, 20, 40)},
    **{f"a ball of {20 * 4**n}": [*room, lamp, *several(1, ball(n))] for n in range(6)},
    **{f"{n} balls of 320": [*room, lamp, *several(n, ball(2))] for n in (3, 5)},
    **{f"{n} meshes split in 2": [*(split(m, 2) for m in room[:n]), *room[n:], lamp] for n in (2, 5, 6)},
    **{f"all split in {n}": [*(split(m, n) for m in room), lamp] for n in (2, 3, 4, 8, 16)},
}
scenes = {name: sf.Scene(parts, cornell.camera, max_bounces=5) for name, parts in meshes.items()}
taken = {}
for name, scene in {**scenes, "keyhole": keyhole}.items():
    seconds = []
    for seed in range(4):
        start = time.perf_counter()
        sf.render(scene, 256, 256, spp=16 if seed else 2, seed=seed)
        seconds.append(time.perf_counter() - start)
    taken[f"{name} ({scene.info.triangle_count} triangles)"] = min(seconds[1:])
print(json.dumps(taken))
"""


def set_few(few: int) -> Callable[[Path], None]:
    def change(folder: Path) -> None:
        path = folder / "csrc/scene/scene.c"
        before, line, after = path.read_text().partition("#define FEW ")
        assert line, path
        path.write_text(f"{before}{line}{few}\n{after.partition(chr(10))[2]}")

    return change


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5)
    given = parser.parse_args()
    never, always = build(WORK / "never", set_few(0)), build(WORK / "always", set_few(2**30))
    print(describe_machine())
    print(describe_build())
    ratios: dict[str, list[float]] = {}
    for k in range(given.rounds):
        first, second = (never, always) if k % 2 else (always, never)
        taken = {installed: cast("dict[str, float]", run(installed, TIMED)) for installed in (first, second)}
        for name, seconds in taken[always].items():
            ratios.setdefault(name, []).append(seconds / taken[never][name])
    for name, values in ratios.items():
        print(f"{name}: {state(values)}")


if __name__ == "__main__":
    main()
