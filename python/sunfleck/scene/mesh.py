# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""mesh: triangles over the caller's arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sunfleck import _core
from sunfleck._arguments import Vector, array_of, vector
from sunfleck.scene.material import Material, default_albedo, material_values

__all__ = ["Mesh"]


def _rows_of_three(name: str, value: Any, kinds: str, wanted: str) -> NDArray[Any]:
    array = array_of(name, value)
    if array.dtype.kind not in kinds:
        raise TypeError(f"{name} has dtype {array.dtype}; give {wanted}")
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name} has shape {array.shape}; give (n, 3)")
    return array


def _vertices(value: Any) -> NDArray[np.float32]:
    array = _rows_of_three("vertices", value, "fiu", "float32, or other real numbers, which are copied")
    with np.errstate(over="ignore"):  # becomes infinite, which C refuses by its number
        return np.require(array, np.float32, ["C", "A"])


def _triangles(value: Any, vertex_count: int) -> NDArray[np.uint32]:
    array = _rows_of_three("triangles", value, "iu", "uint32, or other integers, which are copied")
    if array.dtype != np.uint32 and array.size:
        # Conversion would wrap what does not fit, so the range is checked while it can be.
        wrong = (array < 0) | (array >= max(vertex_count, 1))
        if wrong.any():
            row = int(np.argmax(wrong.any(axis=1)))
            raise ValueError(
                f"triangle {row} has vertex indices {array[row].tolist()}; the mesh has {vertex_count} vertices"
            )
    return np.require(array, np.uint32, ["C", "A"])


class Mesh:
    """Triangles with one material, one reflectance and one emission.

    Parameters
    ----------
    vertices : array_like, shape (n, 3)
        Positions in scene units, finite. A C-contiguous float32 array is used in place, other
        real dtypes are copied once.
    triangles : array_like, shape (m, 3)
        Vertex indices, each in [0, n). A C-contiguous uint32 array is used in place, other
        integer dtypes are copied once.
    albedo : tuple of 3 floats, optional
        Reflectance, linear RGB, each in [0, 1]: of a diffuse surface, which it is without a
        ``material`` (both sides reflect, with the flat normal of the triangle), or what the
        material says. None: 0.5 grey, and 1 for a material.
    emission : tuple of 3 floats
        Radiance, linear RGB, each in [0, 1e18]. Only the side that (v1 - v0) x (v2 - v0)
        points to emits.
    material : Mirror, Dielectric or Conductor, optional
        How the surface scatters. None: diffuse.

    Raises
    ------
    TypeError
        An array of strings, objects or booleans, or indices that are not integers.
    ValueError
        A wrong shape, a vertex that is not finite, an index out of range, a colour out of
        range, or an emissive mesh without area.

    Notes
    -----
    The arrays must not change while the mesh is in use: Embree reads them in place.
    Construction takes one pass over them.

    Examples
    --------
    >>> import numpy as np
    >>> import sunfleck as sf
    >>> vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=np.float32)
    >>> triangles = np.array([[0, 1, 2]], dtype=np.uint32)
    >>> mesh = sf.Mesh(vertices, triangles, albedo=(0.7, 0.7, 0.7))
    >>> mesh.vertices is vertices
    True
    """

    __slots__ = ("albedo", "emission", "material", "triangles", "vertices")

    vertices: NDArray[np.float32]
    triangles: NDArray[np.uint32]
    albedo: Vector
    emission: Vector
    material: Material | None

    def __init__(
        self,
        vertices: ArrayLike,
        triangles: ArrayLike,
        albedo: Sequence[float] | None = None,
        emission: Sequence[float] = (0.0, 0.0, 0.0),
        material: Material | None = None,
    ) -> None:
        self.vertices = _vertices(vertices)
        self.triangles = _triangles(triangles, len(self.vertices))
        self.material = material
        self.albedo = default_albedo(material) if albedo is None else vector("albedo", albedo)
        self.emission = vector("emission", emission)
        _core.check_mesh(*self._values())

    def _values(self) -> tuple[NDArray[np.float32], NDArray[np.uint32], Vector, Vector, tuple[str, float, float]]:
        return self.vertices, self.triangles, self.albedo, self.emission, material_values(self.material)

    def __repr__(self) -> str:
        return (
            f"Mesh({len(self.vertices)} vertices, {len(self.triangles)} triangles, "
            f"albedo={self.albedo}, emission={self.emission}"
            + (")" if self.material is None else f", material={self.material})")
        )
