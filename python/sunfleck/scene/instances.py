# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""instances: meshes placed many times, held once."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sunfleck import _core
from sunfleck._arguments import Vector, array_of
from sunfleck.scene.mesh import Mesh

__all__ = ["Instances"]

_MeshValues = tuple[NDArray[np.float32], NDArray[np.uint32], Vector, Vector, tuple[str, float, float]]


def _meshes(value: Mesh | Iterable[Mesh]) -> tuple[Mesh, ...]:
    if isinstance(value, Mesh):
        return (value,)
    if not isinstance(value, Iterable):
        raise TypeError(f"meshes is {value!r}; give a sunfleck.Mesh or a list of them")
    given = tuple(value)
    for mesh in given:
        if isinstance(mesh, Instances):
            raise TypeError("meshes holds Instances; give the meshes themselves, and products of the transforms")
        if not isinstance(mesh, Mesh):
            raise TypeError(f"meshes holds {mesh!r}; every one must be a sunfleck.Mesh")
    if not given:
        raise ValueError("meshes is empty; give one mesh at least")
    return given


def _reals(name: str, value: Any, shapes: str) -> NDArray[Any]:
    array = array_of(name, value)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} has dtype {array.dtype}; give float32, or other real numbers, which are copied")
    return array


def _singles(array: NDArray[Any]) -> NDArray[np.float32]:
    with np.errstate(over="ignore"):  # becomes infinite, which C refuses by its number
        return np.require(array, np.float32, ["C", "A"])


def _transforms(value: Any) -> NDArray[np.float32]:
    shapes = "shape (n, 3, 4) or (n, 4, 4), or (3, 4) or (4, 4) for one"
    array = _reals("transforms", value, shapes)
    if array.ndim == 2:
        array = array[np.newaxis]
    if array.ndim != 3 or array.shape[1:] not in ((3, 4), (4, 4)):
        raise ValueError(f"transforms has shape {np.shape(value)}; give {shapes}")
    if array.shape[1] == 4:
        wrong = (array[:, 3] != (0, 0, 0, 1)).any(axis=1)
        if wrong.any():
            row = int(np.argmax(wrong))
            raise ValueError(f"transform {row} has the last row {array[row, 3].tolist()}; it must be (0, 0, 0, 1)")
        array = array[:, :3]
    return _singles(array)


def _albedos(value: Any, count: int) -> NDArray[np.float32] | None:
    if value is None:
        return None
    array = _reals("albedos", value, f"shape ({count}, 3)")
    if array.shape != (count, 3):
        raise ValueError(f"albedos has shape {array.shape}; give ({count}, 3), one for each transform")
    return _singles(array)


class Instances:
    """Meshes placed together by many transforms: their triangles are held once.

    Parameters
    ----------
    meshes : Mesh or iterable of Mesh
        What is placed. Instances of the same `Mesh` objects, in the same order, share one hierarchy in a
        scene. Meshes that emit are copied for each transform.
    transforms : array_like, shape (n, 3, 4) or (n, 4, 4)
        Affine, of column vectors: a point x is placed at ``t[:3, :3] @ x + t[:3, 3]``. Rotation, scale of
        any kind, mirror and shear are allowed, singular ones are not. (3, 4) or (4, 4) is one. A
        C-contiguous float32 array of shape (n, 3, 4) is used in place, others are copied once.
    albedos : array_like, shape (n, 3), optional
        Reflectance of all meshes of each placement, each in [0, 1]. None: as the meshes have it.

    Raises
    ------
    TypeError
        Something that is no mesh, such as Instances, or an array of no real numbers.
    ValueError
        A wrong shape, or a transform that is not finite, not affine or singular to single precision.

    Notes
    -----
    The side of a mesh that emits, or is a dielectric's outside, goes where the transform takes it: a
    mirror does not turn it inside out.

    Examples
    --------
    >>> import numpy as np
    >>> import sunfleck as sf
    >>> leaf = sf.Mesh([[0, 0, 0], [1, 0, 0], [0, 0, 1]], [[0, 1, 2]])
    >>> transforms = np.tile(np.eye(3, 4, dtype=np.float32), (100, 1, 1))
    >>> transforms[:, 1, 3] = np.arange(100)
    >>> leaves = sf.Instances(leaf, transforms)
    >>> info = sf.Scene([leaves], sf.Camera((0, -9, 0), (0, 0, 0), up=(0, 0, 1)), (1, 1, 1)).info
    >>> info.triangle_count, info.unique_triangle_count
    (100, 1)
    """

    __slots__ = ("albedos", "meshes", "transforms")

    meshes: tuple[Mesh, ...]
    transforms: NDArray[np.float32]
    albedos: NDArray[np.float32] | None

    def __init__(self, meshes: Mesh | Iterable[Mesh], transforms: ArrayLike, albedos: ArrayLike | None = None) -> None:
        self.meshes = _meshes(meshes)
        self.transforms = _transforms(transforms)
        self.albedos = _albedos(albedos, len(self.transforms))
        _core.check_instances(self._prototype(), self.transforms, self.albedos)

    def _prototype(self) -> list[_MeshValues]:
        return [mesh._values() for mesh in self.meshes]

    def __len__(self) -> int:
        return len(self.transforms)

    def __repr__(self) -> str:
        triangles = sum(len(mesh.triangles) for mesh in self.meshes)
        return f"Instances({len(self.meshes)} meshes, {triangles} triangles, {len(self)} transforms)"
