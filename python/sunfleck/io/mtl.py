# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""mtl: the materials of an OBJ file's libraries, each as the one kind of surface that it is most of.

References: Wavefront Technologies 1995, "MTL material format (Lightwave, OBJ)"; Clara.io 2014 for the extension by
Pr, Pm and the like; Blender's importer (2022) for what its exporter means by illum 3, 6 and Ka.
"""

from __future__ import annotations

import errno
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sunfleck._arguments import Vector
from sunfleck.io.source import Source
from sunfleck.io.text import decoded, with_newlines
from sunfleck.scene.material import Conductor, Dielectric, Material, Mirror

__all__ = ["Materials"]

_Note = Callable[[str], None]

_HALF = 0.5  # from this weight on a part of a mixture is taken for the whole, as in glTF files
_ROUGH = 0.6  # metal beyond it is nearer to a diffuse surface than to `Conductor`, likewise
_TEXTURED = 0.5  # what a texture of colour that is not read is taken to be on average, likewise
_GLASS = 1.5  # index of refraction where Ni is missing
_IOR_RANGE = (0.1, 10.0)  # of `Dielectric`

# illum: whether it reflects what is around ("Reflection on"), and whether it refracts; both also by Fresnel's law.
_REFLECTING, _REFRACTING, _TRANSPARENT, _FRESNEL = (3, 4, 5, 6, 7, 8, 9), (6, 7), (4, 6, 7, 9), (5, 7)

_COLORS, _NUMBERS = ("kd", "ks", "ke", "ka", "tf"), ("ns", "ni", "tr", "illum", "pr", "pm", "ps", "pc", "pcr")
_EXTRA = ("ps", "pc", "aniso", "anisor")  # sheen, clearcoat, anisotropy
_WITHOUT_EFFECT = {"newmtl", "sharpness", "map_aat", "ka", "pcr", "#"}


class Materials:
    """The materials of several libraries; where two have one name, the first counts.

    Parameters
    ----------
    source : Source
        The OBJ file.
    libraries : iterable of str
        What stands behind each mtllib: a file's name, which may hold spaces, or several names.
    note : callable
        Is told what is missing, assumed or left out.

    Raises
    ------
    ValueError
        A line that can't be read, which is named; a library outside of the folder.
    OSError
        A library is there and can't be read.
    """

    def __init__(self, source: Source, libraries: Iterable[str], note: _Note) -> None:
        self._source, self._note = source, note
        self._given: dict[str, _Given] = {}
        self._read: set[str] = set()
        for names in libraries:
            if not self._library(names) and not self._library(names.strip('"').replace("\\", "/")):
                missing = [name for name in names.split() if not self._library(name)]
                if missing:
                    self._note(f"the library of materials {' '.join(missing)!r} is missing")

    def miss(self, names: set[str]) -> None:
        """Says which of the names are no material's."""
        unknown = sorted(names - set(self._given))
        if unknown:
            more = f" and {len(unknown) - 5} more" if len(unknown) > 5 else ""
            self._note(f"materials that no library has are 0.5 grey: {', '.join(map(repr, unknown[:5]))}{more}")

    def of(self, name: str) -> dict[str, Any]:
        """Albedo, emission and material, as `Mesh` takes them; nothing, where there is no such material."""
        return _surface(self._given[name], self._note) if name in self._given else {}

    def _library(self, name: str) -> bool:
        """Whether there is a file of that name; then its materials are known."""
        if name in self._read:
            return True
        try:
            text = decoded(with_newlines(self._source.read_beside(name)))
        except FileNotFoundError:
            return False
        except OSError as error:
            if error.errno in (errno.ENAMETOOLONG, errno.ENOTDIR):
                return False
            raise
        self._read.add(name)
        lines = text.split("\n")
        blender = lines[0].startswith("# Blender")
        current = _Given("", blender)  # what stands before any material is no material's
        for number, line in enumerate(lines, 1):
            words = line.split()
            if not words or words[0].startswith("#"):
                continue
            if words[0].lower() == "newmtl":
                given = _Given(line.split(None, 1)[1].strip() if len(words) > 1 else "", blender)
                current = self._given.setdefault(given.name, given)
                if current is not given:
                    self._note(f"material {given.name!r} is there twice: the first counts")
                    current = given
                continue
            try:
                current.add(words, self._note)
            except ValueError as error:
                raise ValueError(f"{name}, line {number} is {line.strip()[:60]!r}: {error}") from None
        return True


@dataclass
class _Given:
    """What a library says of one material."""

    name: str
    by_blender: bool
    colors: dict[str, Vector] = field(default_factory=dict)
    numbers: dict[str, float] = field(default_factory=dict)
    textures: set[str] = field(default_factory=set)

    def add(self, words: list[str], note: _Note) -> None:
        """One statement."""
        word, values = words[0].lower(), words[1:]
        if word in _COLORS:
            if values[:1] in (["spectral"], ["xyz"]):
                note(f"colours in {values[0]} are left out: give red, green and blue")
            else:
                self.colors[word] = _color(values)
        elif word in _NUMBERS:
            self.numbers[word] = _finite(values[:1])[0]
        elif word == "d":
            self.numbers["d"] = _finite([v for v in values if v != "-halo"][:1])[0]
        elif word in _EXTRA:
            self.numbers[word] = _finite(values[:1])[0]
        elif word.startswith("map_") or word in ("bump", "disp", "decal", "refl", "norm"):
            self.textures.add(word)
        elif word not in _WITHOUT_EFFECT:
            note(f"statements {words[0]!r} of materials are left out")

    def level(self, name: str) -> float:
        """The mean of a colour; 0 where it is missing."""
        return float(np.mean(self.colors.get(name, (0, 0, 0))))


def _finite(words: list[str]) -> list[float]:
    try:
        values = [float(word) for word in words]
    except ValueError:
        values = []
    if not values or not np.isfinite(values).all():
        raise ValueError("a finite number must follow")
    return values


def _color(words: list[str]) -> Vector:
    """Three numbers; one stands for all three."""
    values = _finite(words[:3])
    if len(values) == 2:
        raise ValueError("one or three numbers must follow")
    red, green, blue = values * 3 if len(values) == 1 else values
    return red, green, blue


def _surface(given: _Given, note: _Note) -> dict[str, Any]:
    material, name = _scattering(given, note)
    albedo = given.colors.get(name)
    if name == "kd" and "map_kd" in given.textures:
        note(f"textures are not read: each of colour is taken as {_TEXTURED} on average")
        albedo = tuple(_TEXTURED * v for v in albedo or (1.0, 1.0, 1.0))  # type: ignore[assignment]
    if given.textures - {"map_kd", "map_ke"}:
        note(f"textures are not read: {', '.join(sorted(given.textures - {'map_kd', 'map_ke'}))}")
    extra = [word for word in _EXTRA if given.numbers.get(word, 0) > 0]
    if extra:
        note(f"sheen, clearcoat and anisotropy of materials are left out ({', '.join(extra)})")
    return {
        "albedo": None if albedo is None else _reflectance(given, name, albedo, note),
        "emission": _emission(given, note),
        "material": material,
    }


def _reflectance(given: _Given, name: str, color: Vector, note: _Note) -> Vector:
    red, green, blue = (min(max(v, 0.0), 1.0) for v in color)
    if (red, green, blue) != color:
        note(f"{name.capitalize()} of material {given.name!r} is {color}, and is taken as {(red, green, blue)}")
    return red, green, blue


def _emission(given: _Given, note: _Note) -> Vector:
    color = given.colors.get("ke", (0.0, 0.0, 0.0))
    if "map_ke" in given.textures:
        note("emissive textures are not read: their materials do not emit")
        return (0.0, 0.0, 0.0)
    if min(color) < 0:
        note(f"Ke of material {given.name!r} is {color}: less than 0 is taken as 0")
    red, green, blue = (max(v, 0.0) for v in color)
    return red, green, blue


# ---- which kind of surface ----


def _opacity(given: _Given) -> float:
    return given.numbers.get("d", 1 - given.numbers.get("tr", 0.0))


def _scattering(given: _Given, note: _Note) -> tuple[Material | None, str]:
    """The material, and the colour that is its albedo."""
    illum = int(given.numbers.get("illum", 2))
    metallic = _metallic(given, illum)
    if metallic >= _HALF:
        return _metal(given, note), "kd"
    if metallic > 0:
        note(f"materials are not mixed: those of a metallic weight of {_HALF} or more are metal, the others not")
    if _is_glass(given, illum):
        return Dielectric(_ior(given, note)), "tf" if given.level("tf") > 0 else ""
    if _opacity(given) < 1:
        note("d and Tr are left out: materials that are no glass (illum 4, 6, 7, 9) are opaque")
    if given.level("ks") > 0 and metallic < 0:
        diffuse = given.level("kd") if "kd" in given.colors or "map_kd" not in given.textures else 1.0
        if illum in _REFLECTING and given.level("ks") >= diffuse:
            if diffuse > 0:
                note("materials are not mixed: those that reflect, and whose Ks is not below Kd, are mirrors")
            return (Conductor(0.0) if illum in _FRESNEL else Mirror()), "ks"
        note("highlights and reflections (Ks, Ns) of materials that are no mirrors are left out")
    return None, "kd"


def _metallic(given: _Given, illum: int) -> float:
    """The weight of metal, where a library tells it; else -1. Blender gives it as Ka, in the models that reflect."""
    if "pm" in given.numbers:
        return given.numbers["pm"]
    if given.by_blender and illum in (3, 6):
        return given.level("ka")
    return -1.0


def _metal(given: _Given, note: _Note) -> Material | None:
    roughness = given.numbers.get("pr", -1.0)
    if roughness < 0:  # of Blender's, Ns = 1000 (1 - roughness)^2
        roughness = 1 - float(np.sqrt(min(max(given.numbers.get("ns", 1000.0), 0.0), 1000.0) / 1000))
    if roughness > _ROUGH:
        note(f"metal of a roughness beyond {_ROUGH} is taken as diffuse")
        return None
    return Conductor(roughness)


def _is_glass(given: _Given, illum: int) -> bool:
    """Models that refract, unless Kd is more; others only where d says so: some programs write 4 for all they have."""
    if illum in _TRANSPARENT and _opacity(given) <= _HALF:
        return True
    if illum not in _REFRACTING:
        return False
    if "tf" in given.colors:
        return given.level("tf") > 0 and given.level("tf") >= given.level("kd")
    return given.level("kd") < _HALF


def _ior(given: _Given, note: _Note) -> float:
    ior = given.numbers.get("ni", _GLASS)
    allowed = min(max(ior, _IOR_RANGE[0]), _IOR_RANGE[1])
    if ior != allowed:
        note(f"Ni of material {given.name!r} is {ior}; it is taken as {allowed}")
    return allowed
