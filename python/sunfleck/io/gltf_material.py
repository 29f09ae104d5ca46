# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""gltf_material: materials of a glTF 2.0 file as those that the renderer has.

glTF mixes metal, glass and a coated diffuse surface by weights; the renderer has one of them for a
mesh: metal where metallicFactor is 0.5 or more, else glass where transmissionFactor is, else a
diffuse surface without a coat. Rough metal is diffuse too: `Conductor` has no light that is
scattered within its surface more than once, and loses a fifth at a roughness of 0.6 and two thirds
at 1 of what such metal reflects. References: Khronos Group 2021, "glTF 2.0 Specification" (ISO/IEC
12113:2022), 3.9; its extensions KHR_materials_emissive_strength, KHR_materials_ior and
KHR_materials_transmission.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from sunfleck._arguments import Vector, number, vector
from sunfleck.scene.material import Conductor, Dielectric, Material

__all__ = ["READ_EXTENSIONS", "read_material"]

READ_EXTENSIONS = {"KHR_materials_emissive_strength", "KHR_materials_ior", "KHR_materials_transmission"}

_Note = Callable[[str], None]
_TEXTURED = 0.5  # what a colour texture that is not read is taken to be on average
_ROUGH = 0.6  # metal beyond it is nearer to a diffuse surface than to `Conductor`
_HALF = 0.5  # from this weight on a part of a mixture is taken for the whole


def read_material(tree: dict[str, Any], note: _Note) -> dict[str, Any]:
    """Albedo, emission and material of an object of the file's "materials", as `Mesh` takes them.

    ``note`` is told what is assumed and what is left out.

    Raises
    ------
    ValueError
        A factor out of its range, which is named.
    TypeError
        A value of the wrong kind; AttributeError, where it is a whole object.
    """
    extensions = tree.get("extensions", {})
    for name in sorted(set(extensions) - READ_EXTENSIONS):
        note(f"{name} of materials is not read")
    if "normalTexture" in tree:
        note("normal maps are not read")
    mode = tree.get("alphaMode", "OPAQUE")
    if mode != "OPAQUE":
        note(f"alpha is not read: materials of alphaMode {mode} are opaque")
    return {
        "albedo": _color(tree.get("pbrMetallicRoughness", {}), note),
        "emission": _emission(tree, extensions, note),
        "material": _scattering(tree, extensions, note),
    }


def _factor(place: dict[str, Any], name: str, default: float) -> float:
    value = number(name, place.get(name, default))
    if not 0 <= value <= 1:
        raise ValueError(f"{name} is {value}; it must be in [0, 1]")
    return value


def _color(surface: dict[str, Any], note: _Note) -> Vector:
    color = vector("baseColorFactor", surface.get("baseColorFactor", (1, 1, 1, 1))[:3])
    if "baseColorTexture" in surface:
        note(f"textures are not read: each is taken as {_TEXTURED} on average")
        color = vector("baseColorFactor", np.multiply(color, _TEXTURED))
    return color


def _emission(tree: dict[str, Any], extensions: dict[str, Any], note: _Note) -> Vector:
    strength = extensions.get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1)
    glow = vector("emissiveFactor", tree.get("emissiveFactor", (0, 0, 0)))
    glow = vector("emission", np.multiply(glow, number("emissiveStrength", strength)))
    if "emissiveTexture" in tree and any(glow):
        note("emissive textures are not read: their materials do not emit")
        return (0.0, 0.0, 0.0)
    return glow


def _scattering(tree: dict[str, Any], extensions: dict[str, Any], note: _Note) -> Material | None:
    """Metal hides what it is mixed with, so that its weight is asked for first."""
    surface = tree.get("pbrMetallicRoughness", {})
    roughness = _factor(surface, "roughnessFactor", 1)
    metallic = _metallic(tree, note)
    transmission = _transmission(extensions, note)
    ior = number("ior", extensions.get("KHR_materials_ior", {}).get("ior", 1.5))
    if metallic >= _HALF and roughness > _ROUGH:
        note(f"metal of a roughness beyond {_ROUGH} is taken as diffuse")
        return None
    if metallic >= _HALF:
        return Conductor(roughness)
    return Dielectric(ior, roughness) if transmission >= _HALF else None


def _metallic(tree: dict[str, Any], note: _Note) -> float:
    """The specification's default is a rough white metal, which hardly any file means that says nothing of
    metal at all: those of other models of materials and unlit ones leave the object out. They are diffuse."""
    if "pbrMetallicRoughness" not in tree:
        note("materials without pbrMetallicRoughness are taken as diffuse, not as the specification's white metal")
        return 0.0
    surface = tree["pbrMetallicRoughness"]
    metallic = _factor(surface, "metallicFactor", 1)
    if "metallicRoughnessTexture" in surface:
        note("metallic-roughness textures are not read: their materials are taken as no metal")
        return 0.0
    if metallic > 0:
        note(f"materials are not mixed: those of metallicFactor {_HALF} or more are metal, the others not")
    return metallic


def _transmission(extensions: dict[str, Any], note: _Note) -> float:
    glass = extensions.get("KHR_materials_transmission", {})
    if "transmissionTexture" in glass:
        note("transmission textures are not read: transmissionFactor stands alone")
    transmission = _factor(glass, "transmissionFactor", 0)
    if transmission > 0:
        note(
            f"materials are not mixed: those of transmissionFactor {_HALF} or more are glass, the others not; "
            "glass refracts, as the border of a solid"
        )
    return transmission
