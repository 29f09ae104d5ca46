# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Converged references of the built-in scenes, made by Mitsuba on the very same arrays.

    make build/reference/penumbra_256.npy       (any of penumbra, cornell, defocus, keyhole)

Writes NAME_SIZE.npy, (SIZE, SIZE, 3) float32 linear radiance under the box filter, and
NAME_SIZE.txt, which says how it was made and how far it may itself be off.

Mitsuba's `multijitter` sampler takes `PASS_SPP` samples of every pixel in a pass; passes have
seeds 0, 1, 2, … and are averaged in float64. The reference's own error comes from the two
halves of the passes, A of the even ones and B of the odd ones: E|A - B|^2 is four times the
squared error of their mean, so relMSE((A + B)/2) = mean((A - B)^2 / 4 / (r^2 + 0.01)).

The LLVM variant is used where Mitsuba finds an LLVM that it accepts (DRJIT_LIBLLVM_PATH may name
one; Debian's libllvm19 works), else the scalar one, which is about ten times slower.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import mitsuba as mi
import numpy as np

if TYPE_CHECKING:
    import sunfleck as sf

PASS_SPP = 256  # a square, as multijitter wants; at 256 x 256 a pass takes under 1 GB
PASSES = {"penumbra": 128, "cornell": 48, "defocus": 128, "keyhole": 128}


def choose_variant() -> str:
    """Sets the fastest variant that runs here, and returns its name."""
    try:
        mi.set_variant("llvm_ad_rgb")
        mi.Float(1.0) + mi.Float(1.0)
        return "llvm_ad_rgb"
    except (ImportError, RuntimeError):
        mi.set_variant("scalar_rgb")
        return "scalar_rgb"


def make_mesh(name: str, mesh: sf.Mesh) -> Any:
    """The mesh with flat normals, reflecting on both sides, emitting on its normals' side."""
    props = mi.Properties()
    diffuse = {"type": "diffuse", "reflectance": {"type": "rgb", "value": list(map(float, mesh.albedo))}}
    props["bsdf"] = mi.load_dict({"type": "twosided", "bsdf": diffuse})
    if any(mesh.emission):
        radiance = {"type": "rgb", "value": list(map(float, mesh.emission))}
        props["emitter"] = mi.load_dict({"type": "area", "radiance": radiance})
    vertices = np.asarray(mesh.vertices, np.float32)
    triangles = np.asarray(mesh.triangles, np.uint32)
    out = mi.Mesh(name, len(vertices), len(triangles), props=props)
    params = mi.traverse(out)
    params["vertex_positions"] = vertices.ravel()
    params["faces"] = triangles.ravel()
    params.update()
    return out


def make_sensor(camera: sf.Camera, size: int, sampler: str) -> dict[str, Any]:
    position, target = np.asarray(camera.position, float), np.asarray(camera.target, float)
    up = np.asarray(camera.up, float)
    sensor: dict[str, Any] = {
        "type": "perspective",
        "fov": float(camera.vertical_fov),
        "fov_axis": "y",
        "near_clip": 1e-3,
        "far_clip": 1e4,
        "to_world": mi.ScalarTransform4f().look_at(origin=list(position), target=list(target), up=list(up)),
        "film": {
            "type": "hdrfilm",
            "width": size,
            "height": size,
            "pixel_format": "rgb",
            "component_format": "float32",
            "rfilter": {"type": "box"},
        },
        "sampler": {"type": sampler, "sample_count": PASS_SPP},
    }
    if camera.aperture_radius > 0:
        distance = camera.focus_distance
        sensor["type"] = "thinlens"
        sensor["aperture_radius"] = float(camera.aperture_radius)
        sensor["focus_distance"] = float(np.linalg.norm(target - position) if distance is None else distance)
    return sensor


def make_scene(
    scene: sf.Scene, size: int, sampler: str = "multijitter", fastest: bool = False, roulette: int = 1000
) -> Any:
    """The scene for Mitsuba; `fastest` takes its direct-light integrator where that will do.

    `roulette` is the path segment from which on paths may end by roulette: by default none of them.
    """
    if any(scene.background):
        raise ValueError(f"background is {scene.background}; a reference is made before a black one only")
    # Mitsuba counts path segments: depth 1 is emission seen directly.
    integrator = {"type": "path", "max_depth": scene.max_bounces + 1, "rr_depth": roulette}
    if fastest and scene.max_bounces == 1:
        integrator = {"type": "direct", "emitter_samples": 1, "bsdf_samples": 0}
    sensor = make_sensor(scene.camera, size, sampler)
    parts: dict[str, Any] = {"type": "scene", "integrator": integrator, "sensor": sensor}
    for i, mesh in enumerate(scene.meshes):
        parts[f"mesh{i}"] = make_mesh(f"mesh{i}", mesh)
    return mi.load_dict(parts)


def render(scene: Any, size: int, passes: int) -> tuple[np.ndarray, float]:
    """The mean over all passes, and its relMSE estimated from the two halves."""
    halves = np.zeros((2, size, size, 3))
    for i in range(passes):
        halves[i % 2] += np.asarray(mi.render(scene, seed=i, spp=PASS_SPP), np.float64)
    halves /= passes / 2
    mean = halves.mean(axis=0)
    return mean, float(np.mean((halves[0] - halves[1]) ** 2 / 4 / (mean**2 + 0.01)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("name", choices=sorted(PASSES))
    parser.add_argument("--size", type=int, default=256, help="pixels a side (default 256)")
    parser.add_argument("--passes", type=int, help=f"of {PASS_SPP} samples a pixel each, even (default by scene)")
    parser.add_argument("-o", "--directory", type=Path, default=Path("build/reference"))
    args = parser.parse_args()
    import sunfleck as sf  # peers_worker.py builds scenes where this package is not

    passes = args.passes or PASSES[args.name]
    if passes < 2 or passes % 2:
        parser.error(f"--passes is {passes}; it must be even, and 2 at least, so that there are two halves")

    variant = choose_variant()
    scene = make_scene(getattr(sf.scenes, args.name)(), args.size, fastest=True)
    start = time.perf_counter()
    image, error = render(scene, args.size, passes)
    seconds = time.perf_counter() - start

    args.directory.mkdir(parents=True, exist_ok=True)
    path = args.directory / f"{args.name}_{args.size}.npy"
    np.save(path, image.astype(np.float32))
    note = (
        f"{path.name}: sf.scenes.{args.name}() by Mitsuba {mi.__version__} {variant}, "
        f"multijitter, box filter, {passes} passes of {PASS_SPP} samples a pixel, {seconds:.0f} s; "
        f"own relMSE {error:.1e}, mean radiance {image.mean():.6f}\n"
    )
    path.with_suffix(".txt").write_text(note)
    print(note, end="")


if __name__ == "__main__":
    main()
