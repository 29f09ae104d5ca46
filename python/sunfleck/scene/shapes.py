# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""shapes: spheres and disks, exactly, beside meshes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sunfleck import _core
from sunfleck._arguments import Vector, number, vector
from sunfleck.scene.material import Material, default_albedo, material_values

__all__ = ["Disk", "Sphere"]

_Surface = tuple[Vector, Vector, tuple[str, float, float]]


def _surface(albedo: Sequence[float] | None, emission: Sequence[float], material: Material | None) -> _Surface:
    color = default_albedo(material) if albedo is None else vector("albedo", albedo)
    return color, vector("emission", emission), material_values(material)


@dataclass(frozen=True)
class Sphere:
    """A sphere, intersected as what it is; its normals are smooth.

    Parameters
    ----------
    center : tuple of 3 floats
        In scene units, finite.
    radius : float
        In scene units, in [1e-15, 1e12].
    albedo : tuple of 3 floats, optional
        As of a `Mesh`. None: 0.5 grey, and 1 for a material.
    emission : tuple of 3 floats
        Radiance, linear RGB, each in [0, 1e18], outwards: from inside it shows none. As a light it is
        sampled by the cone of directions that it fills.
    material : Mirror, Dielectric or Conductor, optional
        None: diffuse, on both sides.

    Raises
    ------
    TypeError, ValueError
        A value of the wrong kind or out of its range, which is named.

    Examples
    --------
    >>> import sunfleck as sf
    >>> ball = sf.Sphere((0, 0, 0.5), 0.5, albedo=(0.7, 0.7, 0.7))
    >>> sf.Scene([ball], sf.Camera((0, -4, 1), (0, 0, 0.5), up=(0, 0, 1)), (1, 1, 1)).info.sphere_count
    1
    """

    center: Vector
    radius: float
    albedo: Vector | None = None
    emission: Vector = (0.0, 0.0, 0.0)
    material: Material | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "center", vector("center", self.center))
        object.__setattr__(self, "radius", number("radius", self.radius))
        albedo, emission, _ = _surface(self.albedo, self.emission, self.material)
        object.__setattr__(self, "albedo", albedo)
        object.__setattr__(self, "emission", emission)
        _core.check_sphere(*self._values())

    def _values(self) -> tuple[Vector, float, Vector, Vector, tuple[str, float, float]]:
        return self.center, self.radius, *_surface(self.albedo, self.emission, self.material)


@dataclass(frozen=True)
class Disk:
    """A flat disk, intersected as what it is.

    Parameters
    ----------
    center : tuple of 3 floats
        In scene units, finite.
    normal : tuple of 3 floats
        Of any length but 0.
    radius : float
        In scene units, in [1e-15, 1e12].
    albedo : tuple of 3 floats, optional
        As of a `Mesh`. None: 0.5 grey, and 1 for a material.
    emission : tuple of 3 floats
        Radiance, linear RGB, each in [0, 1e18], on the side of the normal. As a light it is sampled by
        area, with the concentric map.
    material : Mirror, Dielectric or Conductor, optional
        None: diffuse, on both sides.

    Raises
    ------
    TypeError, ValueError
        A value of the wrong kind or out of its range, which is named.

    Examples
    --------
    >>> import sunfleck as sf
    >>> lamp = sf.Disk((0, 0, 3), (0, 0, -1), 0.5, albedo=(0, 0, 0), emission=(10, 10, 10))
    >>> lamp.radius
    0.5
    """

    center: Vector
    normal: Vector
    radius: float
    albedo: Vector | None = None
    emission: Vector = (0.0, 0.0, 0.0)
    material: Material | None = None

    def __post_init__(self) -> None:
        for name in ("center", "normal"):
            object.__setattr__(self, name, vector(name, getattr(self, name)))
        object.__setattr__(self, "radius", number("radius", self.radius))
        albedo, emission, _ = _surface(self.albedo, self.emission, self.material)
        object.__setattr__(self, "albedo", albedo)
        object.__setattr__(self, "emission", emission)
        _core.check_disk(*self._values())

    def _values(self) -> tuple[Vector, Vector, float, Vector, Vector, tuple[str, float, float]]:
        return self.center, self.normal, self.radius, *_surface(self.albedo, self.emission, self.material)
