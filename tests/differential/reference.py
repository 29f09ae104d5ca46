# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Compiles reference.c and hands it a `World`, triangle by triangle, in the scene's own coordinates."""

from __future__ import annotations

import ctypes
import math
import os
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes import World

FILTERS = ("box", "tent", "gaussian", "gaussian_truncated", "blackman_harris", "mitchell", "lanczos")
KINDS = {"NoneType": 0, "Mirror": 1, "Dielectric": 2, "Conductor": 3}
SHAPES = {"mesh": 0, "sphere": 1, "disk": 2}
Array = NDArray[np.float64]

_double, _long = ctypes.c_double, ctypes.c_int64
_vec = _double * 3


class _Scene(ctypes.Structure):
    _fields_ = (
        [(name, ctypes.c_void_p) for name in ("materials", "primitives", "suns", "sky")]
        + [(name, _long) for name in ("primitive_count", "sun_count", "sky_width", "sky_height")]
        + [(name, _vec) for name in ("sky_up", "sky_front", "sky_left", "background")]
        + [(name, _double) for name in ("scattering", "absorption", "g")]
        + [(name, _vec) for name in ("eye", "forward", "right", "up")]
        + [(name, _double) for name in ("pixel", "lens", "focus")]
        + [(name, _long) for name in ("width", "height", "filter", "max_bounces")]
        + [("size", _double)]
    )


def build(folder: Path) -> ctypes.CDLL:
    """Compiles the reference into the folder and loads it."""
    source, library = Path(__file__).with_name("reference.c"), folder / "reference.so"
    compiler = os.environ.get("CC") or shutil.which("cc") or "cc"
    flags = ["-std=c99", "-O2", "-Wall", "-Wextra", "-shared", "-fPIC"]
    subprocess.run([*compiler.split(), *flags, str(source), "-o", str(library), "-lm"], check=True)
    loaded = ctypes.CDLL(str(library))
    loaded.reference_render.argtypes = [
        ctypes.POINTER(_Scene),
        ctypes.c_uint64,
        _long,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    loaded.reference_render.restype = None
    return loaded


def load() -> ctypes.CDLL:
    """Compiled anew, into a folder that goes when the process does."""
    with tempfile.TemporaryDirectory() as folder:
        return build(Path(folder))  # stays mapped when its file is gone


def _unit(v: Any) -> Array:
    array = np.asarray(v, dtype=float)
    return np.asarray(array / np.linalg.norm(array))


def _material(surface: Any, albedo: Any = None) -> list[float]:
    material = surface.material
    roughness = float(np.float32(getattr(material, "roughness", 0.0)))
    alpha = roughness**2 if roughness >= 0.01 else 0.0
    ior = float(np.float32(getattr(material, "ior", 1.5)))
    kind = KINDS[type(material).__name__]
    return [kind, ior, alpha, *(surface.albedo if albedo is None else albedo), *surface.emission]


def _triangle(material: int, corners: Array) -> list[float]:
    a, b, c = corners[0], corners[1] - corners[0], corners[2] - corners[0]
    normal = np.cross(b, c)
    length = float(np.linalg.norm(normal))
    return [0, material, *a, *b, *c, *(normal / (length or 1.0)), length / 2]


class Reference:
    """A world as the reference has it."""

    def __init__(self, library: ctypes.CDLL, world: World, width: int, height: int, pixel_filter: str) -> None:
        self._library = library
        self.width, self.height = width, height
        self._materials: list[list[float]] = []
        self._primitives: list[list[float]] = []
        for item in world.items:
            if item.kind != "mesh":
                self._add_round(item)
            elif item.transforms is None:
                self._add_mesh(item, IDENTITY, None)
            else:
                for k, transform in enumerate(item.transforms):
                    self._add_mesh(item, transform.astype(float), None if item.albedos is None else item.albedos[k])
        self._tables = [np.array(self._materials), np.array(self._primitives)]
        self._scene = _Scene(width=width, height=height, filter=FILTERS.index(pixel_filter))
        self._scene.max_bounces = world.max_bounces
        self._scene.materials, self._scene.primitives = (t.ctypes.data for t in self._tables)
        self._scene.primitive_count = len(self._primitives)
        self._set_sky(world)
        self._set_camera(world.camera)
        if world.fog:
            for name, value in world.fog.items():
                setattr(self._scene, name, float(np.float32(value)))
        corners = self._tables[1][:, 2:5]
        self._scene.size = float(np.abs(corners - corners.mean(axis=0)).max() + 1e-300)

    def _add_mesh(self, item: Any, transform: Array, albedo: Any) -> None:
        self._materials.append(_material(item.surface, albedo))
        corners = item.vertices @ transform[:, :3].T + transform[:, 3]
        turned = np.linalg.det(transform[:, :3]) < 0  # a mirror does not turn a mesh inside out
        for triangle in item.triangles:
            order = triangle[::-1] if turned else triangle
            self._primitives.append(_triangle(len(self._materials) - 1, corners[order]))

    def _add_round(self, item: Any) -> None:
        self._materials.append(_material(item.surface))
        number, r = len(self._materials) - 1, item.radius
        if item.kind == "sphere":
            shape = [*item.center, r, 0, 0, 0, 0, 0, 0, 0, 0, 4 * math.pi * r * r]
        else:
            normal = _unit(item.normal)
            shape = [*item.center, *normal, r, 0, 0, *normal, math.pi * r * r]
        self._primitives.append([SHAPES[item.kind], number, *shape])

    def _set_sky(self, world: World) -> None:
        rows = []
        for sun in world.suns:
            angle = math.radians(float(np.float32(sun["angular_radius"])))
            scale = 1 / (math.pi * math.sin(angle) ** 2) if angle else 1.0
            rows.append([*_unit(sun["direction"]), angle, *(scale * c for c in sun["irradiance"])])
        self._tables.append(np.array(rows, dtype=float).reshape(-1, 7))
        self._scene.suns, self._scene.sun_count = self._tables[-1].ctypes.data, len(rows)
        self._scene.background = _vec(*world.background)
        if not world.environment:
            return
        picture = np.ascontiguousarray(world.environment["image"], dtype=float)
        self._tables.append(picture)
        self._scene.sky, (self._scene.sky_height, self._scene.sky_width) = picture.ctypes.data, picture.shape[:2]
        up = _unit(world.environment["up"])
        along_z = abs(up[2]) > 0.9999995
        ahead = np.array([1.0, 0, 0]) if along_z else np.array([0, 0, 1.0])
        front = _unit(ahead - (ahead @ up) * up)
        turn = math.radians(world.environment["rotation"])
        front, left = (math.cos(t) * front + math.sin(t) * np.cross(up, front) for t in (turn, turn + math.pi / 2))
        self._scene.sky_up, self._scene.sky_front, self._scene.sky_left = _vec(*up), _vec(*front), _vec(*left)

    def _set_camera(self, camera: dict[str, Any]) -> None:
        eye, target = (np.array(camera[name]) for name in ("position", "target"))
        forward = _unit(target - eye)
        right = _unit(np.cross(forward, _unit(camera["up"])))
        s = self._scene
        s.eye, s.forward, s.right, s.up = (_vec(*v) for v in (eye, forward, right, np.cross(right, forward)))
        s.pixel = 2 * math.tan(math.radians(float(np.float32(camera["vertical_fov"]))) / 2) / self.height
        s.lens = camera.get("aperture_radius", 0.0)
        s.focus = camera.get("focus_distance") or float(np.linalg.norm(target - eye))

    def render(self, seed: int, spp: int, wanted: NDArray[np.bool_]) -> Array:
        """(height, width, 4): radiance, and the share of camera rays that met something."""
        out = np.zeros((self.height, self.width, 4))
        marks = np.ascontiguousarray(wanted, dtype=np.uint8)
        self._library.reference_render(ctypes.byref(self._scene), seed, spp, marks.ctypes.data, out.ctypes.data)
        return out


IDENTITY = np.eye(3, 4)
