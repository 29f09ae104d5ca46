# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""bounds: boxes about shapes, along the axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sunfleck.scene.instances import Instances
from sunfleck.scene.mesh import Mesh

__all__ = ["Box", "box_of", "box_of_points"]


@dataclass(frozen=True)
class Box:
    """What lies between two corners, each an array of shape (3,)."""

    lower: NDArray[np.float64]
    upper: NDArray[np.float64]

    @property
    def centre(self) -> NDArray[np.float64]:
        return (self.lower + self.upper) / 2

    @property
    def radius(self) -> float:
        """Of the sphere about the box."""
        return float(np.linalg.norm(self.upper - self.lower) / 2)

    def holds(self, points: NDArray[np.float64]) -> bool:
        """Whether any of the points, shape (n, 3), lies in it."""
        return bool(((points >= self.lower) & (points <= self.upper)).all(axis=1).any())

    def meets(self, other: Box) -> bool:
        """Whether the two have more than borders in common."""
        return bool(((self.lower < other.upper) & (other.lower < self.upper)).all())


def box_of_points(points: NDArray[np.float32]) -> Box:
    """The smallest about points, shape (n, 3), n > 0."""
    return Box(points.min(axis=0).astype(np.float64), points.max(axis=0).astype(np.float64))


def _box(shape: Mesh | Instances) -> Box:
    """Of instances, about the transformed boxes, each the smallest about its corners."""
    if isinstance(shape, Mesh):
        return box_of_points(shape.vertices)
    whole = _union([box_of_points(mesh.vertices) for mesh in shape.meshes])
    linear, translation = shape.transforms[:, :, :3].astype(np.float64), shape.transforms[:, :, 3]
    centres = linear @ whole.centre + translation
    halves = np.abs(linear) @ ((whole.upper - whole.lower) / 2)
    return Box((centres - halves).min(axis=0), (centres + halves).max(axis=0))


def _union(boxes: Sequence[Box]) -> Box:
    lower, upper = np.array([box.lower for box in boxes]), np.array([box.upper for box in boxes])
    return Box(lower.min(axis=0), upper.max(axis=0))


def box_of(shapes: Sequence[Mesh | Instances]) -> Box:
    """About all of the shapes, of which there must be one."""
    return _union([_box(shape) for shape in shapes])
