# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""material: how surfaces scatter light."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sunfleck import _core
from sunfleck._arguments import Vector, number

__all__ = ["Conductor", "Dielectric", "Material", "Mirror"]


@dataclass(frozen=True)
class Mirror:
    """An ideal mirror: reflects ``albedo`` of its mesh at every angle, on both sides.

    Examples
    --------
    >>> import sunfleck as sf
    >>> sf.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], albedo=(0.9, 0.9, 0.9), material=sf.Mirror())
    Mesh(3 vertices, 1 triangles, albedo=(0.9, 0.9, 0.9), emission=(0.0, 0.0, 0.0), material=Mirror())
    """


@dataclass(frozen=True)
class Dielectric:
    """Glass, water: the border of a transparent medium.

    Reflects by Fresnel's equations, untinted, and refracts the rest, times ``albedo`` of its
    mesh at each crossing. The side that (v1 - v0) x (v2 - v0) points to is the outside: a solid
    is a closed mesh whose normals point out of it.

    Parameters
    ----------
    ior : float
        Index of refraction inside over that outside, in [0.1, 10]: 1.5 for glass, 1.33 for
        water, 1 / 1.33 for an air bubble in it.
    roughness : float
        In [0, 1], the square root of GGX's alpha, as in glTF; smooth below 0.01.

    Raises
    ------
    TypeError, ValueError
        A value of the wrong kind or out of its range, which is named.

    Examples
    --------
    >>> import sunfleck as sf
    >>> sf.Dielectric(ior=1.33)
    Dielectric(ior=1.33, roughness=0.0)
    """

    ior: float = 1.5
    roughness: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "ior", number("ior", self.ior))
        object.__setattr__(self, "roughness", number("roughness", self.roughness))
        _core.check_material(material_values(self))


@dataclass(frozen=True)
class Conductor:
    """Metal: ``albedo`` of its mesh is the reflectance at normal incidence.

    It rises to 1 at grazing angles (Schlick 1994). Both sides reflect.

    Parameters
    ----------
    roughness : float
        In [0, 1], the square root of GGX's alpha, as in glTF; smooth below 0.01.

    Raises
    ------
    TypeError, ValueError
        A value of the wrong kind or out of its range, which is named.

    Examples
    --------
    >>> import sunfleck as sf
    >>> sf.Conductor(roughness=1.5)
    Traceback (most recent call last):
        ...
    ValueError: roughness is 1.5; it must be in [0, 1]
    """

    roughness: float = 0.2

    def __post_init__(self) -> None:
        object.__setattr__(self, "roughness", number("roughness", self.roughness))
        _core.check_material(material_values(self))


Material = Mirror | Dielectric | Conductor


def default_albedo(material: Material | None) -> Vector:
    """Grey for a diffuse surface, white for a material."""
    return (0.5, 0.5, 0.5) if material is None else (1.0, 1.0, 1.0)


def material_values(material: Any) -> tuple[str, float, float]:
    """Kind, ior and roughness, as C takes them."""
    if material is None:
        return "diffuse", 1.5, 0.0
    if not isinstance(material, (Mirror, Dielectric, Conductor)):
        raise TypeError(f"material is {material!r}; give a Mirror, Dielectric, Conductor or None")
    kind = type(material).__name__.lower()
    return kind, getattr(material, "ior", 1.5), getattr(material, "roughness", 0.0)
