# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""gltf: meshes and camera of a glTF 2.0 file (.gltf, .glb).

Read: node transforms, triangles of all three modes, sparse and quantized positions, materials (by
`gltf_material`), perspective cameras, directional lights. Not read, and said so in the log: textures, points and lines,
skins, morph targets, orthographic cameras, point and spot lights. Reference: Khronos Group 2021, "glTF 2.0
Specification" (ISO/IEC 12113:2022).

trimesh, which reads the other formats, is not used here: it gives sparse accessors as zeros,
leaves out triangle fans and the emissive strength, and finds only cameras that are children of
the root.
"""

from __future__ import annotations

import base64
import json
import logging
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlparse

import numpy as np
from numpy.typing import NDArray

from sunfleck._arguments import Vector, number, vector
from sunfleck.gltf_material import READ_EXTENSIONS, read_material
from sunfleck.mesh import Mesh
from sunfleck.sky import Sun

__all__ = ["Contents", "View", "read_gltf"]

_log = logging.getLogger("sunfleck")

_SUPPORTED = {"KHR_lights_punctual", "KHR_mesh_quantization"} | READ_EXTENSIONS
_COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_LINES_AND_POINTS, _TRIANGLES, _STRIP, _FAN = (0, 1, 2, 3), 4, 5, 6


@dataclass(frozen=True)
class View:
    """A camera of a file: where it is, where it looks, and its vertical angle in degrees."""

    position: Vector
    direction: Vector
    up: Vector
    vertical_fov: float


@dataclass(frozen=True)
class Contents:
    """What a file holds of what scenes have."""

    meshes: list[Mesh]
    view: View | None = None
    suns: list[Sun] = field(default_factory=list)


def read_gltf(path: Path) -> Contents:
    """The file's triangles as meshes, one for each primitive, its first perspective camera, its
    directional lights as suns.

    Raises
    ------
    ValueError
        The file is malformed; also KeyError, IndexError, TypeError and the like, where it lacks
        what the specification demands.
    NotImplementedError
        It requires an extension, or a version, that is not read.
    OSError
        A file that it refers to can't be read.
    """
    return _File(path).read()


class _File:
    def __init__(self, path: Path) -> None:
        self._folder = path.parent
        data = path.read_bytes()
        self._chunk: bytes | None = None
        if data[:4] == b"glTF":
            data = self._open_binary(data)
        self._tree: dict[str, Any] = json.loads(data.decode("utf-8-sig"))
        if not isinstance(self._tree, dict):
            raise ValueError("the JSON is not an object")
        version = str(self._tree["asset"]["version"])
        if version.split(".")[0] != "2":
            raise NotImplementedError(f"glTF version {version}; only version 2 is read")
        unknown = sorted(set(self._tree.get("extensionsRequired", [])) - _SUPPORTED)
        if unknown:
            raise NotImplementedError(
                f"the file requires {', '.join(map(str, unknown))}, which is not read; export it without"
            )
        self._buffers: dict[int, bytes] = {}
        self._noted: set[str] = set()

    def _note(self, message: str) -> None:
        if message not in self._noted:
            self._noted.add(message)
            _log.info("%s", message)

    def _open_binary(self, data: bytes) -> bytes:
        """The JSON chunk of a .glb; the binary one is kept for the first buffer."""
        version, length, size, kind = struct.unpack("<IIII", data[4:20])
        if version != 2:
            raise NotImplementedError(f"glTF version {version}; only version 2 is read")
        if length > len(data) or kind != 0x4E4F534A or 20 + size > length:
            raise ValueError(f"the file is cut short, or not a glTF: {len(data)} bytes of {length}")
        after = 20 + size
        if after + 8 <= length:
            chunk, kind = struct.unpack("<II", data[after : after + 8])
            if kind == 0x004E4942:
                self._chunk = data[after + 8 : after + 8 + chunk]
        return data[20 : 20 + size]

    # ---- arrays ----

    def _item(self, kind: str, index: Any) -> dict[str, Any]:
        """An object of a top-level list; Python's negative indices are not glTF's."""
        if not isinstance(index, int) or not 0 <= index < len(self._tree.get(kind, [])):
            raise ValueError(f"{kind}[{index!r}] is referred to, and does not exist")
        item = self._tree[kind][index]
        if not isinstance(item, dict):
            raise ValueError(f"{kind}[{index}] is {item!r}, not an object")
        return item

    def _buffer(self, index: int) -> bytes:
        if index not in self._buffers:
            buffer = self._item("buffers", index)
            data, size = self._fetch(buffer.get("uri"), index), buffer["byteLength"]
            if len(data) < size:
                raise ValueError(f"buffers[{index}] holds {len(data)} bytes; the file says {size}")
            self._buffers[index] = data
        return self._buffers[index]

    def _fetch(self, uri: str | None, index: int) -> bytes:
        if uri is None:
            if index != 0 or self._chunk is None:
                raise ValueError(f"buffers[{index}] has no data")
            return self._chunk
        if uri.startswith("data:"):
            return base64.b64decode(uri.partition(",")[2], validate=True)
        if urlparse(uri).scheme not in ("", "file"):
            raise NotImplementedError(f"{uri!r} is not a file beside this one; nothing is fetched from elsewhere")
        beside = self._folder / unquote(urlparse(uri).path)
        if beside.exists() and not beside.is_file():
            raise OSError(f"{str(beside)!r} is not a file")
        return beside.read_bytes()

    def _view(self, index: Any, offset: int) -> tuple[memoryview, int | None]:
        """The bytes of a buffer view from an offset on, and its stride."""
        view = self._item("bufferViews", index)
        start, length = view.get("byteOffset", 0), view["byteLength"]
        data = memoryview(self._buffer(view["buffer"]))
        if start < 0 or offset < 0 or offset > length or start + length > len(data):
            raise ValueError(f"bufferViews[{index}] reaches beyond its buffer of {len(data)} bytes")
        return data[start + offset : start + length], view.get("byteStride")

    def _array(self, place: dict[str, Any], count: int, component: Any, width: int) -> NDArray[Any]:
        """`count` rows in a buffer view, without a copy; NumPy refuses what lies beyond it."""
        dtype = np.dtype(_COMPONENTS[component])
        data, stride = self._view(place["bufferView"], place.get("byteOffset", 0))
        if count < 1 or (stride is not None and stride < width * dtype.itemsize):
            raise ValueError(f"an accessor of {count} rows, {stride} bytes apart")
        strides = (stride or width * dtype.itemsize, dtype.itemsize)
        rows: NDArray[Any] = np.ndarray((count, width), dtype, data, strides=strides)
        return rows

    def _accessor(self, index: Any) -> NDArray[Any]:
        """Shape (count, width), integers where they are not normalized."""
        accessor = self._item("accessors", index)
        count, component, width = accessor["count"], accessor["componentType"], _WIDTHS[accessor["type"]]
        sparse = accessor.get("sparse")
        if "bufferView" in accessor:
            values = self._array(accessor, count, component, width)
        elif sparse:
            values = np.zeros((count, width), _COMPONENTS[component])
        else:
            raise ValueError(f"accessors[{index}] has no data")
        if sparse:
            values = values.copy()
            changed = sparse["count"]
            rows = self._array(sparse["indices"], changed, sparse["indices"]["componentType"], 1)
            values[rows[:, 0]] = self._array(sparse["values"], changed, component, width)
        if accessor.get("normalized") and values.dtype.kind in "iu":
            scaled: NDArray[np.float32] = np.maximum(values / np.float32(np.iinfo(values.dtype).max), np.float32(-1))
            return scaled
        return values

    # ---- meshes ----

    def _triangles(self, primitive: dict[str, Any], vertex_count: int) -> NDArray[Any] | None:
        mode = primitive.get("mode", _TRIANGLES)
        if mode in _LINES_AND_POINTS:
            self._note("points and lines are left out")
            return None
        if "indices" in primitive:
            order: NDArray[Any] = self._accessor(primitive["indices"])[:, 0]
            if order.dtype.kind != "u":
                raise ValueError(f"vertex indices of type {order.dtype}; they must be unsigned integers")
        else:
            order = np.arange(vertex_count, dtype=np.uint32)
        if mode == _TRIANGLES:
            rows = np.arange(len(order) // 3 * 3).reshape(-1, 3)
        elif mode == _STRIP:  # every second one is wound the other way
            i = np.arange(max(len(order) - 2, 0))
            rows = np.stack([i, i + 1 + i % 2, i + 2 - i % 2], axis=1)
        elif mode == _FAN:
            i = np.arange(1, max(len(order) - 1, 1))
            rows = np.stack([i, i + 1, np.zeros_like(i)], axis=1)
        else:
            raise ValueError(f"a primitive has mode {mode!r}; 0 to 6 exist")
        triangles: NDArray[Any] = order[rows]
        return triangles

    def _material(self, primitive: dict[str, Any]) -> dict[str, Any]:
        """Albedo, emission and material, where the file has them."""
        if "material" not in primitive:
            return {}
        return read_material(self._item("materials", primitive["material"]), self._note)

    def _meshes(self, index: Any, transform: NDArray[np.float64]) -> Iterator[Mesh]:
        for primitive in self._item("meshes", index)["primitives"]:
            if "targets" in primitive:
                self._note("morph targets are not applied")
            if "POSITION" not in primitive["attributes"]:
                continue
            positions = self._accessor(primitive["attributes"]["POSITION"])
            triangles = self._triangles(primitive, len(positions))
            if triangles is None or len(triangles) == 0:
                continue
            if not np.array_equal(transform, np.eye(4)):
                positions = positions @ transform[:3, :3].T + transform[:3, 3]
                if np.linalg.det(transform[:3, :3]) < 0:  # a mirror turns triangles over
                    triangles = triangles[:, [0, 2, 1]]
            yield Mesh(positions, triangles, **self._material(primitive))

    # ---- nodes ----

    def _transform(self, node: dict[str, Any]) -> NDArray[np.float64]:
        if "matrix" in node:
            matrix: NDArray[np.float64] = np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
            return matrix
        x, y, z, w = np.array(node.get("rotation", (0, 0, 0, 1)), dtype=np.float64)
        # Any quaternion but 0 is a rotation, once its length is divided out.
        s = 2 / (x * x + y * y + z * z + w * w)
        rotation = [
            [1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)],
            [s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)],
            [s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)],
        ]
        transform = np.eye(4)
        transform[:3, :3] = np.multiply(rotation, vector("scale", node.get("scale", (1, 1, 1))))
        transform[:3, 3] = vector("translation", node.get("translation", (0, 0, 0)))
        return transform

    def _nodes(self) -> Iterator[tuple[dict[str, Any], NDArray[np.float64]]]:
        """Every node of the scene and its transform to the world, parents first."""
        if self._tree.get("scenes"):
            roots = self._item("scenes", self._tree.get("scene", 0)).get("nodes", [])
        else:
            nodes = self._tree.get("nodes", [])
            roots = sorted(set(range(len(nodes))) - {child for node in nodes for child in node.get("children", [])})
        waiting = [(root, np.eye(4)) for root in reversed(roots)]
        seen: set[int] = set()
        while waiting:
            index, parent = waiting.pop()
            node = self._item("nodes", index)
            if index in seen:
                raise ValueError(f"nodes[{index}] is a child twice over; nodes must form a tree")
            seen.add(index)
            transform = parent @ self._transform(node)
            yield node, transform
            waiting += [(child, transform) for child in reversed(node.get("children", []))]

    def _camera(self, index: Any, transform: NDArray[np.float64]) -> View | None:
        camera = self._item("cameras", index)
        if "perspective" not in camera:
            self._note("an orthographic camera is left out")
            return None
        return View(
            position=vector("camera position", transform[:3, 3]),
            direction=vector("camera direction", -transform[:3, 2]),
            up=vector("camera up", transform[:3, 1]),
            vertical_fov=float(np.degrees(number("yfov", camera["perspective"]["yfov"]))),
        )

    def _sun(self, index: Any, transform: NDArray[np.float64]) -> Sun | None:
        """A directional light; it shines along the node's -z, with lux for irradiance. None: another kind."""
        lights = self._tree["extensions"]["KHR_lights_punctual"]["lights"]
        if not isinstance(index, int) or not 0 <= index < len(lights):
            raise ValueError(f"lights[{index!r}] is referred to, and does not exist")
        light = lights[index]
        if light["type"] != "directional":
            return None
        color = vector("light color", light.get("color", (1, 1, 1)))
        level = vector("light", np.multiply(color, number("intensity", light.get("intensity", 1))))
        return Sun(vector("light direction", transform[:3, 2]), 0, level) if any(level) else None

    def read(self) -> Contents:
        meshes: list[Mesh] = []
        suns: list[Sun] = []
        left_out = 0
        view = None
        for node, transform in self._nodes():
            if "mesh" in node:
                meshes += self._meshes(node["mesh"], transform)
            if "skin" in node:
                self._note("skins are not applied: the mesh is shown as it was bound")
            if "KHR_lights_punctual" in node.get("extensions", {}):
                sun = self._sun(node["extensions"]["KHR_lights_punctual"]["light"], transform)
                suns += [sun] if sun else []
                left_out += sun is None
            if "camera" in node and view is None:
                view = self._camera(node["camera"], transform)
        if left_out:
            self._note(f"{left_out} point and spot lights are left out")
        return Contents(meshes, view, suns)
