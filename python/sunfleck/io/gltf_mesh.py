# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""gltf_mesh: meshes of a glTF 2.0 file, and their placements as meshes or as instances.

Reference: Khronos Group 2021, "glTF 2.0 Specification" (ISO/IEC 12113:2022), 3.7.2 and 3.9.6.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sunfleck.io.gltf_data import Document
from sunfleck.io.gltf_material import read_material
from sunfleck.scene.bounds import box_of, box_of_points
from sunfleck.scene.instances import Instances
from sunfleck.scene.mesh import Mesh

__all__ = ["Placed", "shown"]

_LINES_AND_POINTS, _TRIANGLES, _STRIP, _FAN = (0, 1, 2, 3), 4, 5, 6

# So many triangles, about a megabyte, are copied for all placements of a mesh but the first rather than placed by
# instances, which are a stage more for every ray that meets them.
_COPIED = 10_000

# Transforms beyond these are flattened: the largest quotient of singular values, and the determinant's size.
# Instances allow three times the quotient (csrc/scene/instances.c: Frobenius's norms), and ten times the sizes.
_CONDITION_LIMIT = 5e4
_DETERMINANTS = (1e-35, 1e35)

# A normal turned by more than a degree from its triangle's is one of a smooth surface.
_SMOOTH = float(np.cos(np.radians(1)))
_LOOKED_AT = 4096  # triangles, to tell that

_MESH_BYTES = 2000  # what Python and Embree take for a mesh beside its arrays, rounded up
_COMPARED = 10**8  # pairs of boxes that are compared at the most

# A node whose transform squashes everything by more than this, along two axes, shows nothing. It is what
# rounding leaves of a scale of 0 under rotations; beyond the largest coordinate it is scale that is wrong.
_FLAT = 1e-14
_LARGEST = 1e12


@dataclass(frozen=True, eq=False)
class _Part:
    """A primitive that has triangles: what `Mesh` takes, in the mesh's own space."""

    positions: NDArray[np.float32]
    triangles: NDArray[np.uint32]
    surface: dict[str, Any]
    double_sided: bool

    @property
    def emits(self) -> bool:
        return any(self.surface.get("emission", ()))


class Placed:
    """Meshes of the document where nodes place them."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self.hidden = 0  # placements that show nothing, which `shapes` counts
        self._places: dict[int, list[NDArray[np.float64]]] = {}
        self._positions: dict[int, NDArray[np.float32]] = {}
        self._shapes: list[Mesh | Instances] = []
        self._double_sided: list[Mesh] = []

    def add(self, index: int, transforms: NDArray[np.float64]) -> None:
        """Places a mesh by each of the transforms, shape (n, 4, 4)."""
        self._document.item("meshes", index)
        self._places.setdefault(index, []).append(transforms)

    def shapes(self, eyes: NDArray[np.float64]) -> list[Mesh | Instances]:
        """All of it. Emitters of two sides shine into the closed space within them only where something else
        is there, such as one of the eyes, shape (n, 3)."""
        for index, places in self._places.items():
            transforms = np.concatenate(places)
            seen = shown(transforms)
            self.hidden += int(np.count_nonzero(~seen))
            parts = self._parts(index) if seen.any() else []
            if parts:
                self._place(parts, transforms[seen])
        self._shapes += self._backs(eyes)
        return self._shapes

    # ---- primitives ----

    def _parts(self, index: int) -> list[_Part]:
        parts = [self._part(primitive) for primitive in self._document.item("meshes", index)["primitives"]]
        return [part for part in parts if part is not None]

    def _part(self, primitive: dict[str, Any]) -> _Part | None:
        note = self._document.note
        attributes = primitive["attributes"]
        if "targets" in primitive:
            note("morph targets are not applied")
        if primitive.get("mode", _TRIANGLES) in _LINES_AND_POINTS:
            note("points and lines are left out")
            return None
        if "POSITION" not in attributes:
            note("primitives without positions are left out")
            return None
        positions = self._vertices(attributes["POSITION"])
        triangles = self._triangles(primitive, len(positions))
        if len(triangles) == 0:
            return None
        self._tell_of(attributes, positions, triangles)
        double_sided, surface = False, {}
        if "material" in primitive:
            material = self._document.item("materials", primitive["material"])
            double_sided, surface = bool(material.get("doubleSided", False)), read_material(material, note)
        return _Part(*self._compact(positions, triangles), surface, double_sided)

    def _vertices(self, index: Any) -> NDArray[np.float32]:
        """Positions as `Mesh` uses them in place; converted once, since primitives may share them."""
        if index not in self._positions:
            values = self._document.accessor(index)
            if values.dtype != np.float32 or not (values.flags.c_contiguous and values.flags.aligned):
                self._document.source.take_bytes(12 * len(values))
                values = np.require(values, np.float32, ["C", "A"])
            self._positions[index] = values
        return self._positions[index]

    def _triangles(self, primitive: dict[str, Any], vertex_count: int) -> NDArray[np.uint32]:
        """Vertex indices, shape (n, 3), of any of the modes that have triangles."""
        source, mode = self._document.source, primitive.get("mode", _TRIANGLES)
        indexed = "indices" in primitive
        count = self._document.count(primitive["indices"]) if indexed else vertex_count
        if mode not in (_TRIANGLES, _STRIP, _FAN):
            raise ValueError(f"a primitive has mode {mode!r}; 0 to 6 exist")
        number = count // 3 if mode == _TRIANGLES else max(count - 2, 0)
        if number > source.limits.triangles:
            source.take_triangles(number)  # refused before they are made; those that are placed count
        source.take_bytes((12 if mode == _TRIANGLES else 36) * number)
        if indexed:
            order: NDArray[Any] = self._document.accessor(primitive["indices"])[:, 0]
            if order.dtype.kind != "u":
                raise ValueError(f"vertex indices of type {order.dtype}; they must be unsigned integers")
        else:
            order = np.arange(vertex_count, dtype=np.uint32)
        if mode == _TRIANGLES:
            return order[: 3 * number].reshape(-1, 3).astype(np.uint32, copy=False)
        i = np.arange(number)
        if mode == _STRIP:  # every second one is wound the other way
            rows = np.stack([i, i + 1 + i % 2, i + 2 - i % 2], axis=1)
        else:
            rows = np.stack([i + 1, i + 2, np.zeros_like(i)], axis=1)
        return order[rows].astype(np.uint32, copy=False)

    def _compact(
        self, positions: NDArray[np.float32], triangles: NDArray[np.uint32]
    ) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
        """Without the vertices of others, where most are such: exporters share one array among many primitives."""
        if len(positions) <= 3 * len(triangles) or triangles.max() >= len(positions):
            return positions, triangles
        self._document.source.take_bytes(72 * len(triangles))
        used, order = np.unique(triangles, return_inverse=True)
        return positions[used], order.reshape(-1, 3).astype(np.uint32)

    def _tell_of(
        self, attributes: dict[str, Any], positions: NDArray[np.float32], triangles: NDArray[np.uint32]
    ) -> None:
        """Says what of the vertices is not shown, where it would be seen. It is no reason to refuse a file."""
        seen = triangles[:: max(len(triangles) // _LOOKED_AT, 1)]
        if (seen >= len(positions)).any():
            return  # which `Mesh` refuses
        for name, matters, message in (
            ("NORMAL", _smooth, "normals of vertices are not read: every triangle is flat"),
            ("COLOR_0", _colored, "colours of vertices are not read"),
        ):
            try:
                if name in attributes and matters(positions, seen, self._document.accessor(attributes[name])[seen]):
                    self._document.note(message)
            except (ValueError, KeyError, IndexError, TypeError, AttributeError, OSError, NotImplementedError) as error:
                self._document.note(f"{name} of vertices is passed over: {error!r}")

    # ---- placements ----

    def _place(self, parts: list[_Part], transforms: NDArray[np.float64]) -> None:
        instanced = np.zeros(len(transforms), dtype=bool)
        if (len(transforms) - 1) * sum(len(part.triangles) for part in parts) > _COPIED:
            instanced = _regular(transforms)
        together = [part for part in parts if not (part.emits and part.double_sided)] if instanced.any() else []
        if together:
            self._instance(together, transforms[instanced])
        alone = [part for part in parts if part not in together]
        flat = (len(parts) - len(alone)) * int(np.count_nonzero(~instanced)) + len(alone) * len(transforms)
        self._document.source.take_bytes(_MESH_BYTES * flat)
        for transform, is_instance in zip(transforms, instanced, strict=True):
            for part in alone if is_instance else parts:
                self._flatten(part, transform)

    def _instance(self, parts: list[_Part], transforms: NDArray[np.float64]) -> None:
        source, number = self._document.source, len(transforms)
        source.take_instances(number)
        for part in parts:
            copies = number if part.emits else 1  # emitters are copied for each
            source.take_triangles(copies * len(part.triangles))
            source.take_bytes((copies - 1) * 12 * (len(part.positions) + len(part.triangles)))
        meshes = [Mesh(part.positions, part.triangles, **part.surface) for part in parts if self._has_area(part)]
        if meshes:
            self._shapes.append(Instances(meshes, transforms[:, :3].astype(np.float32)))

    def _flatten(self, part: _Part, transform: NDArray[np.float64]) -> None:
        positions, triangles = part.positions, part.triangles
        self._document.source.take_triangles(len(triangles))
        if not np.array_equal(transform, np.eye(4)):
            self._document.source.take_bytes(36 * len(positions) + 12 * len(triangles))
            positions = (positions @ transform[:3, :3].T + transform[:3, 3]).astype(np.float32)
            if np.linalg.det(transform[:3, :3]) < 0:  # a mirror turns triangles over
                triangles = triangles[:, [0, 2, 1]]
        if not self._has_area(_Part(positions, triangles, part.surface, part.double_sided)):
            return
        mesh = Mesh(positions, triangles, **part.surface)
        self._shapes.append(mesh)
        if part.emits and part.double_sided:
            self._double_sided.append(mesh)

    def _has_area(self, part: _Part) -> bool:
        """Emitters without any, which scenes refuse, are left out and told."""
        if not part.emits or (part.triangles >= len(part.positions)).any() or _normals(part).any():
            return True
        self._document.note("emitters without area are left out")
        return False

    # ---- emitters of two sides ----

    def _backs(self, eyes: NDArray[np.float64]) -> list[Mesh | Instances]:
        """What double-sided emitters send backwards: a mesh turned over, a little behind each of them.

        A mesh emits on one side. The gap is as small as single precision keeps apart, so that no light
        passes between the two and the picture is that of one sheet of two sides.
        """
        if not self._double_sided:
            return []
        boxes = [box_of([shape]) for shape in self._shapes]
        lower, upper = np.array([box.lower for box in boxes]), np.array([box.upper for box in boxes])
        radius = float(np.linalg.norm(upper.max(axis=0) - lower.min(axis=0)) / 2)
        gap = max(radius * 2**-15, float(max(np.abs(lower).max(), np.abs(upper).max())) * 2**-20)
        backs: list[Mesh | Instances] = []
        places = {id(shape): place for place, shape in enumerate(self._shapes)}
        few = len(self._double_sided) * len(boxes) <= _COMPARED
        for mesh in self._double_sided:
            box = boxes[places[id(mesh)]]
            meetings = np.count_nonzero(((lower < box.upper) & (box.lower < upper)).all(axis=1)) if few else 2
            self._document.source.take_bytes(120 * len(mesh.vertices) + 300 * len(mesh.triangles))
            if meetings <= 1 and not box.holds(eyes) and _closed_outward(mesh):  # it meets itself
                continue
            self._document.source.take_triangles(len(mesh.triangles))
            backs.append(_turned_over(mesh, gap))
        return backs


def _normals(part: _Part | Mesh) -> NDArray[np.float64]:
    """Of the triangles, twice as long as their areas."""
    positions = part.vertices if isinstance(part, Mesh) else part.positions
    a, b, c = (positions[part.triangles[:, k]].astype(np.float64) for k in range(3))
    normals: NDArray[np.float64] = np.cross(b - a, c - a)
    return normals


def _smooth(positions: NDArray[np.float32], triangles: NDArray[np.uint32], normals: NDArray[Any]) -> bool:
    """Whether any of the normals, one for each corner, shape (n, 3, 3), leans off its triangle's."""
    flat = _normals(_Part(positions, triangles, {}, False))
    given = normals.astype(np.float64)
    lengths = np.linalg.norm(flat, axis=1)
    cosines = np.einsum("nc,nkc->nk", flat, given)
    limit = _SMOOTH * lengths[:, None] * np.linalg.norm(given, axis=2)
    return bool((np.abs(cosines) < limit)[lengths > 0].any())


def _colored(_positions: NDArray[np.float32], _triangles: NDArray[np.uint32], colors: NDArray[Any]) -> bool:
    """Whether any of the colours, one for each corner, shape (n, 3, 3 or 4), is not white."""
    white = 1 if colors.dtype.kind == "f" else np.iinfo(colors.dtype).max
    return bool((colors[..., :3] != white).any())


def shown(transforms: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which of the transforms leave two dimensions at least; those that are not finite are the mesh's to refuse."""
    linear = transforms[:, :3, :3]
    finite: NDArray[np.bool_] = np.all(np.isfinite(linear), axis=(1, 2))
    singular = _singular_values(np.where(finite.reshape(-1, 1, 1), linear, np.eye(3)))
    wrong: NDArray[np.bool_] = ~finite | (singular[:, 0] > _LARGEST)
    seen: NDArray[np.bool_] = wrong | (singular[:, 1] > _FLAT * singular[:, 0])
    return seen


def _singular_values(linear: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of matrices, shape (n, 3, 3), finite: shape (n, 3), falling."""
    values: NDArray[np.float64] = np.linalg.svd(linear, full_matrices=False, compute_uv=False).astype(np.float64)
    return values


def _regular(transforms: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which transforms instances allow."""
    singular = _singular_values(transforms[:, :3, :3])
    least, determinants = singular[:, 2], singular.prod(axis=1)
    conditioned = singular[:, 0] <= _CONDITION_LIMIT * least
    regular: NDArray[np.bool_] = conditioned & (determinants > _DETERMINANTS[0]) & (determinants < _DETERMINANTS[1])
    return regular


def _closed_outward(mesh: Mesh) -> bool:
    """Whether the mesh bounds a solid and faces away from it: every edge is passed once each way."""
    _, vertex = np.unique(mesh.vertices, axis=0, return_inverse=True)
    corners = vertex.reshape(-1)[mesh.triangles].astype(np.int64)
    edges = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    edges = edges[edges[:, 0] != edges[:, 1]]
    there, back = (np.sort(edges @ np.array(order)) for order in ((1 << 32, 1), (1, 1 << 32)))
    if not np.array_equal(there, back) or (there[1:] == there[:-1]).any():
        return False
    middle = box_of_points(mesh.vertices).centre
    return bool(np.einsum("nc,nc->", mesh.vertices[mesh.triangles[:, 0]] - middle, _normals(mesh)) > 0)


def _turned_over(mesh: Mesh, gap: float) -> Mesh:
    """Corners go along the mean of their triangles' normals, by the angles there (Thürmer & Wüthrich 1998), which
    leaves what is flat flat however it is cut into triangles."""
    normals = np.zeros((len(mesh.vertices), 3))
    flat = _units(_normals(mesh))
    corners = mesh.vertices[mesh.triangles].astype(np.float64)
    for k in range(3):
        one, other = (_units(corners[:, k - step] - corners[:, k]) for step in (1, 2))
        angles = np.arccos(np.clip(np.einsum("nc,nc->n", one, other), -1, 1))
        np.add.at(normals, mesh.triangles[:, k], angles[:, None] * flat)
    behind = (mesh.vertices - gap * _units(normals)).astype(np.float32)
    return Mesh(behind, mesh.triangles[:, [0, 2, 1]], mesh.albedo, mesh.emission, mesh.material)


def _units(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of length 1, but for those of length 0."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    units: NDArray[np.float64] = np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0)
    return units
