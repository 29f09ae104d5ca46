# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""contents: what every reader of a format of scenes returns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from sunfleck._arguments import Vector
from sunfleck.scene.instances import Instances
from sunfleck.scene.mesh import Mesh
from sunfleck.scene.sky import Sun

__all__ = ["Contents", "View"]


@dataclass(frozen=True)
class View:
    """A camera of a file: where it is, where it looks, its vertical angle in degrees, its name, and the width of
    its frame over the height, which is no more than advice."""

    position: Vector
    direction: Vector
    up: Vector
    vertical_fov: float
    name: str = ""
    aspect: float = 1.0


@dataclass(frozen=True)
class Contents:
    """What a file holds of what scenes have.

    ``photometric``: whether its light is in lux, which no picture shows as it is.
    """

    meshes: Sequence[Mesh | Instances]
    views: list[View] = field(default_factory=list)
    suns: list[Sun] = field(default_factory=list)
    photometric: bool = False
