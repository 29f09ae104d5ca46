# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Renders two pictures to a stated accuracy, into out/: penumbra, and a glTF model of an engine.

Beside each picture: where its samples went, and how far each pixel may be off. `make demo` runs
this; the model is Debian's, of the package assimp-testmodels.
"""

from __future__ import annotations

import logging
import sys
import time
from pathlib import Path

import numpy as np

import sunfleck as sf

OUT = Path("out")
ENGINE = Path("/usr/share/assimp/models/glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb")
SIZE = 512
SECONDS = 40.0  # at the most for each, so that the demo ends on any machine


def engine_on_a_floor() -> sf.Scene:
    """The model under the light that `load` gives it, standing on a floor, in a little daylight."""
    scene = sf.load(ENGINE)
    lower, upper = np.array(scene.info.bounds_lower), np.array(scene.info.bounds_upper)
    solid = sf.Scene([shape for shape in scene.shapes if shape is not scene.meshes[-1]], scene.camera)  # but the light
    height = solid.info.bounds_lower[1]
    reach = 4 * float(np.linalg.norm(upper - lower))
    x, z = (lower + upper)[[0, 2]] / 2
    corners = [(x - reach, height, z - reach), (x - reach, height, z + reach)]
    corners += [(x + reach, height, z + reach), (x + reach, height, z - reach)]
    floor = sf.Mesh(corners, [[0, 1, 2], [0, 2, 3]], albedo=(0.6, 0.6, 0.6))
    return sf.Scene([*scene.shapes, floor], scene.camera, background=(0.1, 0.12, 0.15), max_bounces=3)


def render(name: str, scene: sf.Scene, tolerance: float) -> None:
    """One picture in four files, and what it came to."""
    print(f"{name}: {scene}, every pixel to {tolerance:.1%} of the mean level", flush=True)
    image = sf.render(
        scene, SIZE, SIZE, tolerance=tolerance, max_spp=65536, seconds=SECONDS, progress=sys.stderr.isatty()
    )
    image.save(OUT / f"{name}.exr")
    image.save(OUT / f"{name}.png")
    image.save_map("samples", OUT / f"{name}_samples.png")
    image.save_map("half_width", OUT / f"{name}_half_width.png")
    print(image.summary(), end="\n\n", flush=True)
    if image.interrupted:
        sys.exit(130)


def main() -> None:
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    if not ENGINE.exists():
        sys.exit(f"there is no {ENGINE}; install Debian's assimp-testmodels, as `make demo` does")
    OUT.mkdir(exist_ok=True)
    start = time.perf_counter()
    render("penumbra", sf.scenes.penumbra(), tolerance=0.02)
    render("engine", engine_on_a_floor(), tolerance=0.05)
    print(f"out/ holds an .exr and three .png of each, after {time.perf_counter() - start:.1f} s")


if __name__ == "__main__":
    main()
