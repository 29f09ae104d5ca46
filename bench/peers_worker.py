# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""One renderer at work for peers_render.py, in a process and an environment of its own.

    peers_worker.py WHO SCENE.npz                    reads requests, a JSON object a line, from standard input
    peers_worker.py WHO SCENE.npz --spp N -o FILE    renders once into an EXR, to be timed from outside

WHO is sunfleck, mitsuba, cycles or luxcore; SCENE.npz holds the arrays that peers_render.py wrote.
A request is {"mode", "value", "seed"}; the answer, a line that begins with @, tells the seconds of
the render call alone, the samples taken, and the file that holds the picture.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import sys
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

SIZE = 256


def load_arrays(path: Path) -> SimpleNamespace:
    """The scene as peers_render.py wrote it, with the names that sf.Scene has."""
    stored = np.load(path)
    given = json.loads(str(stored["description"]))
    meshes = [
        SimpleNamespace(vertices=stored[f"vertices{i}"], triangles=stored[f"triangles{i}"], **mesh)
        for i, mesh in enumerate(given["meshes"])
    ]
    camera = SimpleNamespace(**given["camera"])
    return SimpleNamespace(meshes=meshes, camera=camera, max_bounces=given["max_bounces"], background=(0, 0, 0))


def look(camera: SimpleNamespace) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Unit vectors right, up and forward, and the focal distance along the last."""
    position, target = np.array(camera.position), np.array(camera.target)
    forward = (target - position) / np.linalg.norm(target - position)
    right = np.cross(forward, np.array(camera.up))
    right /= np.linalg.norm(right)
    focus = camera.focus_distance or float(np.linalg.norm(target - position))
    return right, np.cross(right, forward), forward, focus


class Sunfleck:
    """Modes: fixed (value: spp), adaptive (relative tolerance), goal (relMSE), roulette (spp; from bounce 2)."""

    def __init__(self, scene: SimpleNamespace) -> None:
        import sunfleck as sf

        meshes = [sf.Mesh(m.vertices, m.triangles, m.albedo, m.emission) for m in scene.meshes]
        self.scene = sf.Scene(meshes, sf.Camera(**vars(scene.camera)), max_bounces=scene.max_bounces)
        self.scene.plan()  # builds what is built once
        self.render_scene = sf.render

    def render(self, mode: str, value: float, seed: int) -> tuple[float, float, np.ndarray]:
        options: dict[str, Any] = {
            "fixed": {"spp": int(value)},
            "roulette": {"spp": int(value), "roulette": 2},
            "adaptive": {"tolerance": value, "max_spp": 65536},
            "goal": {"relmse": value, "max_spp": 65536},
        }[mode]
        start = time.perf_counter()
        image = self.render_scene(self.scene, SIZE, SIZE, seed=seed, **options)
        seconds = time.perf_counter() - start
        return seconds, float(image.samples.mean()), image.color

    def render_to_file(self, spp: int, path: Path) -> None:
        self.render_scene(self.scene, SIZE, SIZE, spp=spp).save(path)


class Mitsuba:
    """Modes: direct and path (no roulette), with multijitter; roulette; direct-independent, path-independent.

    The counts should be squares, as multijitter wants. More than MOST samples a pixel, whose paths would not
    fit into memory at once, are the mean of several pictures of as many.
    """

    MOST = 4096

    def __init__(self, scene: SimpleNamespace) -> None:
        import peers_reference as reference

        variant = reference.choose_variant()
        if not variant.startswith("llvm"):
            raise RuntimeError(f"Mitsuba found no LLVM; its variant would be {variant}")
        self.reference, self.scene = reference, scene
        self.built: dict[str, Any] = {}

    def build(self, mode: str) -> Any:
        if mode not in self.built:
            integrator, _, sampler = mode.partition("-")
            self.built[mode] = self.reference.make_scene(
                self.scene,
                SIZE,
                sampler=sampler or "multijitter",
                fastest=integrator == "direct",
                roulette=2 if mode == "roulette" else 1000,
            )
        return self.built[mode]

    def render(self, mode: str, value: float, seed: int) -> tuple[float, float, np.ndarray]:
        scene, mi = self.build(mode), self.reference.mi
        parts = max(1, int(value) // self.MOST)
        start = time.perf_counter()  # to ask for the array evaluates it
        images = [np.asarray(mi.render(scene, seed=seed + 1000 * k, spp=int(value) // parts)) for k in range(parts)]
        return time.perf_counter() - start, value, np.mean(images, axis=0)

    def render_to_file(self, spp: int, path: Path) -> None:
        scene = self.build("direct" if self.scene.max_bounces == 1 else "path")
        image = self.reference.mi.render(scene, spp=spp)
        self.reference.mi.Bitmap(image).write(str(path))


class Cycles:
    """Modes: fixed (value: spp), adaptive (value: noise threshold). Sobol, no clamping, data kept."""

    def __init__(self, scene: SimpleNamespace) -> None:
        import bpy

        self.bpy = bpy
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.scene = bpy.context.scene
        for i, mesh in enumerate(scene.meshes):
            self.add_mesh(f"mesh{i}", mesh)
        self.add_camera(scene.camera)
        self.choose_settings(scene.max_bounces)

    def add_mesh(self, name: str, mesh: SimpleNamespace) -> None:
        data = self.bpy.data.meshes.new(name)
        data.from_pydata(mesh.vertices.tolist(), [], mesh.triangles.tolist())
        material = self.bpy.data.materials.new(name)
        material.use_nodes = True
        nodes, links = material.node_tree.nodes, material.node_tree.links
        nodes.clear()
        surface = nodes.new("ShaderNodeBsdfDiffuse").outputs[0]
        surface.node.inputs["Color"].default_value = (*mesh.albedo, 1)
        if any(mesh.emission):  # on the front side only
            strength = max(mesh.emission)
            emission = nodes.new("ShaderNodeEmission")
            emission.inputs["Color"].default_value = (*(e / strength for e in mesh.emission), 1)
            emission.inputs["Strength"].default_value = strength
            mix, geometry = nodes.new("ShaderNodeMixShader"), nodes.new("ShaderNodeNewGeometry")
            links.new(geometry.outputs["Backfacing"], mix.inputs[0])
            links.new(emission.outputs[0], mix.inputs[1])
            links.new(surface, mix.inputs[2])
            surface = mix.outputs[0]
            material.cycles.emission_sampling = "FRONT"
        links.new(surface, nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
        data.materials.append(material)
        self.scene.collection.objects.link(self.bpy.data.objects.new(name, data))

    def add_camera(self, camera: SimpleNamespace) -> None:
        right, up, forward, focus = look(camera)
        data = self.bpy.data.cameras.new("camera")
        data.sensor_fit, data.angle = "VERTICAL", math.radians(camera.vertical_fov)
        data.clip_start, data.clip_end = 1e-3, 1e4
        if camera.aperture_radius > 0:
            data.dof.use_dof, data.dof.focus_distance = True, focus
            data.dof.aperture_fstop = data.lens * 1e-3 / (2 * camera.aperture_radius)
        thing = self.bpy.data.objects.new("camera", data)
        axes = np.stack([right, up, -forward, np.array(camera.position)], axis=1)
        self.scene.collection.objects.link(thing)
        self.scene.camera = thing
        from mathutils import Matrix

        thing.matrix_world = Matrix([*axes.tolist(), [0, 0, 0, 1]])

    def choose_settings(self, max_bounces: int) -> None:
        render, cycles = self.scene.render, self.scene.cycles
        render.engine, render.use_persistent_data = "CYCLES", True
        render.resolution_x = render.resolution_y = SIZE
        render.resolution_percentage = 100
        settings = render.image_settings
        settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR", "32", "NONE"
        cycles.device, cycles.use_denoising, cycles.pixel_filter_type = "CPU", False, "BOX"
        cycles.sampling_pattern = "TABULATED_SOBOL"
        cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0
        cycles.max_bounces = cycles.diffuse_bounces = max_bounces - 1  # Cycles counts those after the first hit

    def render(self, mode: str, value: float, seed: int) -> tuple[float, float, Path]:
        cycles = self.scene.cycles
        cycles.seed, cycles.use_adaptive_sampling = seed, mode == "adaptive"
        cycles.samples = 65536 if mode == "adaptive" else int(value)
        if mode == "adaptive":
            cycles.adaptive_threshold = value
        self.scene.update_tag()  # kept data would else keep the settings of the render before
        start = time.perf_counter()
        self.bpy.ops.render.render()
        seconds = time.perf_counter() - start
        path = Path(f"cycles{seed % 2}.exr").resolve()
        self.bpy.data.images["Render Result"].save_render(str(path), scene=self.scene)
        return seconds, float("nan") if mode == "adaptive" else value, path

    def render_to_file(self, spp: int, path: Path) -> None:
        _, _, made = self.render("fixed", spp, 0)
        made.replace(path)


class LuxCore:
    """Mode fixed (value: spp): PATHCPU with Sobol, no roulette, no clamping; a start builds its tree too."""

    def __init__(self, scene: SimpleNamespace) -> None:
        import pyluxcore

        self.lux = pyluxcore
        pyluxcore.Init(lambda message: None)
        self.max_bounces = scene.max_bounces
        self.scene = pyluxcore.Scene()
        props = self.describe_camera(scene.camera)
        for i, mesh in enumerate(scene.meshes):
            points, triangles = map(tuple, mesh.vertices.tolist()), map(tuple, mesh.triangles.tolist())
            self.scene.DefineMesh(f"mesh{i}", list(points), list(triangles), None, None, None, None)
            material = f"scene.materials.material{i}"
            props[f"{material}.type"], props[f"{material}.kd"] = ["matte"], list(mesh.albedo)
            if any(mesh.emission):
                props[f"{material}.emission"] = list(mesh.emission)
                props[f"{material}.emission.gain.normalizebycolor"] = [False]
            props[f"scene.objects.object{i}.shape"] = [f"mesh{i}"]
            props[f"scene.objects.object{i}.material"] = [f"material{i}"]
        self.scene.Parse(self.to_properties(props))

    def to_properties(self, values: dict[str, list[Any]]) -> Any:
        out = self.lux.Properties()
        for key, value in values.items():
            out.Set(self.lux.Property(key, value))
        return out

    @staticmethod
    def describe_camera(camera: SimpleNamespace) -> dict[str, list[Any]]:
        _, _, _, focus = look(camera)
        return {
            "scene.camera.lookat.orig": list(camera.position),
            "scene.camera.lookat.target": list(camera.target),
            "scene.camera.up": list(camera.up),
            "scene.camera.fieldofview": [camera.vertical_fov],
            "scene.camera.lensradius": [camera.aperture_radius],
            "scene.camera.focaldistance": [focus],
            "scene.camera.autofocus.enable": [False],
        }

    def configure(self, spp: int, seed: int) -> Any:
        values: dict[str, list[Any]] = {
            "renderengine.type": ["PATHCPU"],
            "renderengine.seed": [seed + 1],
            "sampler.type": ["SOBOL"],
            "sampler.sobol.adaptive.strength": [0.0],
            "path.pathdepth.total": [self.max_bounces + 1],
            "path.pathdepth.diffuse": [self.max_bounces + 1],
            "path.russianroulette.depth": [1000],
            "path.clamping.variance.maxvalue": [0.0],
            "film.width": [SIZE],
            "film.height": [SIZE],
            "film.filter.type": ["BOX"],
            "film.filter.width": [0.5],
            "film.imagepipelines.0.0.type": ["NOP"],
            "film.noiseestimation.warmup": [2**30],
            "batch.haltspp": [spp, 0],
        }
        return self.lux.RenderConfig(self.to_properties(values), self.scene)

    def render(self, mode: str, value: float, seed: int) -> tuple[float, float, np.ndarray]:
        session = self.lux.RenderSession(self.configure(int(value), seed))
        start = time.perf_counter()
        session.Start()
        while not session.HasDone():
            time.sleep(1e-3)
            session.UpdateStats()
        seconds = time.perf_counter() - start
        pixels = np.zeros((SIZE, SIZE, 3), np.float32)
        session.GetFilm().GetOutputFloat(self.lux.FilmOutputType.RGB_IMAGEPIPELINE, pixels, 0)
        taken = session.GetStats().Get("stats.renderengine.pass").GetInt()
        session.Stop()
        return seconds, float(taken), pixels[::-1]

    def render_to_file(self, spp: int, path: Path) -> None:
        session = self.lux.RenderSession(self.configure(spp, 0))
        session.Start()
        while not session.HasDone():
            time.sleep(1e-3)
            session.UpdateStats()
        output = self.lux.FilmOutputType.RGB_IMAGEPIPELINE
        session.GetFilm().SaveOutput(str(path), output, self.lux.Properties())
        os._exit(0)  # the file is there; its threads may crash the interpreter's own end


RENDERERS: dict[str, type[Any]] = {"sunfleck": Sunfleck, "mitsuba": Mitsuba, "cycles": Cycles, "luxcore": LuxCore}


def answer(renderer: Any, request: dict[str, Any], who: str) -> str:
    seconds, samples, picture = renderer.render(request["mode"], request["value"], request["seed"])
    if not isinstance(picture, Path):
        path = Path(f"{who}{request['seed'] % 2}.npy").resolve()
        np.save(path, picture)
        picture = path
    return json.dumps({"seconds": seconds, "samples": samples, "file": str(picture)})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("who", choices=sorted(RENDERERS))
    parser.add_argument("scene", type=Path)
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("-o", "--output", type=Path)
    args = parser.parse_args()

    renderer = RENDERERS[args.who](load_arrays(args.scene))
    if args.output:
        renderer.render_to_file(args.spp, args.output.resolve())
        return
    print("\n@ready", flush=True)
    for line in sys.stdin:
        print("\n@" + answer(renderer, json.loads(line), args.who), flush=True)


if __name__ == "__main__":
    main()
