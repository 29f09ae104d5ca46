# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""gltf: shapes, cameras and suns of a glTF 2.0 file (.gltf, .glb).

Read: node transforms, triangles of all three modes, sparse and quantized positions, materials (by
`gltf_material`), instances, perspective cameras, directional lights. Not read, and said so in the log:
textures, normals and colours of vertices, points and lines, skins, morph targets, animations, orthographic
cameras, point and spot lights. Reference: Khronos Group 2021, "glTF 2.0 Specification" (ISO/IEC 12113:2022);
its extensions KHR_lights_punctual, KHR_mesh_quantization, KHR_node_visibility and EXT_mesh_gpu_instancing.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sunfleck._arguments import number, vector
from sunfleck.io.contents import Contents, View
from sunfleck.io.gltf_data import Document
from sunfleck.io.gltf_material import READ_EXTENSIONS
from sunfleck.io.gltf_mesh import Placed, shown
from sunfleck.io.source import Source
from sunfleck.scene.sky import Sun

__all__ = ["read_gltf"]

_READ = {
    "EXT_mesh_gpu_instancing",
    "KHR_lights_punctual",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
} | READ_EXTENSIONS

# May be required, since they change only what is not read in any case, or say how something is shaded.
_HARMLESS = {
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_xmp_json_ld",
    "MSFT_texture_dds",
}


def read_gltf(source: Source) -> Contents:
    """The file's triangles as meshes, one for each primitive, and as instances where nodes share many of them,
    its perspective cameras, its directional lights as suns.

    Raises
    ------
    ValueError
        The file is malformed, asks for more than the source's limits, or refers to a file that the source
        does not allow; also KeyError, IndexError, TypeError and the like, where it lacks what the
        specification demands.
    NotImplementedError
        It requires an extension, or a version, that is not read.
    OSError
        A file that it refers to can't be read.
    """
    return _Reader(Document(source, _READ | _HARMLESS)).read()


@dataclass(frozen=True)
class _Node:
    """A node of the scene and its transform to the world."""

    tree: dict[str, Any]
    transform: NDArray[np.float64]
    hidden: bool  # by itself or by one above it

    def extension(self, name: str) -> dict[str, Any] | None:
        found: dict[str, Any] | None = self.tree.get("extensions", {}).get(name)
        return found


def _rotations(quaternions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Shape (n, 3, 3), of (n, 4): any quaternion but 0 is a rotation, once its length is divided out."""
    x, y, z, w = quaternions.T
    s = 2 / (x * x + y * y + z * z + w * w)
    rows = [
        [1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)],
        [s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)],
        [s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def _transforms(
    translations: NDArray[np.float64], rotations: NDArray[np.float64], scales: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Shape (n, 4, 4): scale first, then rotation, then translation."""
    transforms = np.tile(np.eye(4), (len(translations), 1, 1))
    transforms[:, :3, :3] = _rotations(rotations) * scales[:, None, :]
    transforms[:, :3, 3] = translations
    return transforms


def _transform(node: dict[str, Any]) -> NDArray[np.float64]:
    """Of one node, without the arrays of many: files have 10^5 of them."""
    if "matrix" in node:
        matrix: NDArray[np.float64] = np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
        return matrix
    transform = np.eye(4)
    if "rotation" in node:
        transform[:3, :3] = _rotations(np.array(node["rotation"], dtype=np.float64).reshape(1, 4))[0]
    if "scale" in node:
        transform[:3, :3] *= vector("scale", node["scale"])
    if "translation" in node:
        transform[:3, 3] = vector("translation", node["translation"])
    return transform


class _Reader:
    def __init__(self, document: Document) -> None:
        self._document = document
        self._placed = Placed(document)
        self._views: list[View] = []
        self._suns: list[Sun] = []
        self._hidden = self._left_out = 0

    # ---- nodes ----

    def _roots(self) -> list[Any]:
        tree = self._document.tree
        if not tree.get("scenes"):
            nodes = tree.get("nodes", [])
            return sorted(set(range(len(nodes))) - {child for node in nodes for child in node.get("children", [])})
        if len(tree["scenes"]) > 1:
            self._document.note(f"one of {len(tree['scenes'])} scenes is read: the file's default, or else the first")
        roots: list[Any] = self._document.item("scenes", tree.get("scene", 0)).get("nodes", [])
        return roots

    def _nodes(self) -> Iterator[_Node]:
        """Every node of the scene, parents first."""
        waiting = [(root, np.eye(4), False) for root in reversed(self._roots())]
        seen: set[int] = set()
        while waiting:
            index, parent, hidden = waiting.pop()
            node = self._document.item("nodes", index)
            if index in seen:
                raise ValueError(f"nodes[{index}] is a child twice over; nodes must form a tree")
            seen.add(index)
            transform = parent @ _transform(node)
            hidden = hidden or node.get("extensions", {}).get("KHR_node_visibility", {}).get("visible") is False
            yield _Node(node, transform, hidden)
            waiting += [(child, transform, hidden) for child in reversed(node.get("children", []))]

    def _mesh(self, node: _Node) -> None:
        instancing = node.extension("EXT_mesh_gpu_instancing")
        places = node.transform[np.newaxis] if instancing is None else node.transform @ self._copies(instancing)
        if node.hidden:
            self._hidden += 1
            return
        if "skin" in node.tree:
            self._document.note("skins are not applied: the mesh is shown as it was bound")
        self._placed.add(node.tree["mesh"], places)

    def _copies(self, instancing: dict[str, Any]) -> NDArray[np.float64]:
        """Shape (n, 4, 4): where a node's mesh is placed, relative to the node."""
        attributes, document = instancing["attributes"], self._document
        given = [attributes[name] for name in ("TRANSLATION", "ROTATION", "SCALE") if name in attributes]
        counts = set(map(document.count, given))
        if len(counts) != 1:
            raise ValueError(f"EXT_mesh_gpu_instancing has {sorted(counts)} rows in its attributes; they must agree")
        [count] = counts
        if count > document.source.limits.instances:
            document.source.take_instances(count)
        document.source.take_bytes(1000 * count)
        values = []
        for name, default in (("TRANSLATION", (0, 0, 0)), ("ROTATION", (0, 0, 0, 1)), ("SCALE", (1, 1, 1))):
            rows = document.accessor(attributes[name]) if name in attributes else np.tile(default, (count, 1))
            if rows.shape != (count, len(default)):
                raise ValueError(f"{name} of EXT_mesh_gpu_instancing has {rows.shape[1]} columns")
            values.append(rows.astype(np.float64))
        return _transforms(*values)

    # ---- cameras and lights ----

    def _camera(self, node: _Node) -> None:
        camera, transform = self._document.item("cameras", node.tree["camera"]), node.transform
        if "perspective" not in camera:
            self._document.note("orthographic cameras are left out")
            return
        if not shown(transform[np.newaxis]).all():
            self._document.note("cameras of nodes of scale 0 are left out")
            return
        self._views.append(
            View(
                position=vector("camera position", transform[:3, 3]),
                direction=vector("camera direction", -transform[:3, 2]),
                up=vector("camera up", transform[:3, 1]),
                vertical_fov=float(np.degrees(number("yfov", camera["perspective"]["yfov"]))),
                aspect=number("aspectRatio", camera["perspective"].get("aspectRatio", 1)),
                name=str(node.tree.get("name") or camera.get("name") or ""),
            )
        )

    def _light(self, node: _Node, index: Any) -> None:
        """A directional light; it shines along the node's -z, with lux for irradiance."""
        lights = self._document.tree["extensions"]["KHR_lights_punctual"]["lights"]
        if not isinstance(index, int) or not 0 <= index < len(lights):
            raise ValueError(f"lights[{index!r}] is referred to, and does not exist")
        light = lights[index]
        if light["type"] != "directional":
            self._left_out += 1
            return
        color = vector("light color", light.get("color", (1, 1, 1)))
        level = vector("light", np.multiply(color, number("intensity", light.get("intensity", 1))))
        if node.hidden or not node.transform[:3, 2].any():
            self._hidden += 1
        elif any(level):
            self._suns.append(Sun(vector("light direction", node.transform[:3, 2]), 0, level))

    # ---- all of it ----

    def _tell_of(self) -> None:
        """Says what is left out, beside what readers of its parts say."""
        tree, note = self._document.tree, self._document.note
        if self._left_out:
            note(f"{self._left_out} point and spot lights are left out")
        hidden = self._hidden + self._placed.hidden
        if hidden:
            note(f"{hidden} nodes are hidden: their scale is 0, or they are marked invisible")
        if tree.get("animations"):
            note(f"{len(tree['animations'])} animations are left out: everything is where the nodes say")
        others = set(tree.get("extensionsUsed", [])) - _READ
        others = {name for name in map(str, others) if not name.startswith("KHR_materials_")}  # told of materials
        if others:
            note(f"not read: {', '.join(sorted(others))}")

    def read(self) -> Contents:
        for node in self._nodes():
            if "mesh" in node.tree:
                self._mesh(node)
            light = node.extension("KHR_lights_punctual")
            if light is not None:
                self._light(node, light["light"])
            if "camera" in node.tree:
                self._camera(node)
        eyes = np.array([view.position for view in self._views], dtype=np.float64).reshape(-1, 3)
        shapes = self._placed.shapes(eyes)
        self._tell_of()
        return Contents(shapes, self._views, self._suns, bool(self._suns))
