# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""scene: the scene that a command is given: a name or a file, and how to read the file."""

from __future__ import annotations

import argparse
from dataclasses import fields

from sunfleck.io.image import RADIANCE_TYPES, read_radiance
from sunfleck.io.load import FILE_TYPES, load, scene_by_name, z_is_up
from sunfleck.io.source import Limits
from sunfleck.scene import Scene
from sunfleck.scene.sky import Environment
from sunfleck.scenes import SCENES

__all__ = ["add_environment", "add_scene", "scene_of"]


def add_scene(parser: argparse.ArgumentParser) -> None:
    """The scene's argument, and the options of files."""
    parser.add_argument(
        "scene",
        nargs="?",
        default="penumbra",
        metavar="SCENE",
        help=f"a built-in scene ({', '.join(SCENES)}; default penumbra) or a file ({', '.join(FILE_TYPES)})",
    )
    add = parser.add_argument_group("files").add_argument
    add("--camera", metavar="NAME|N", help="one of the file's cameras, by name or by number from 0; default the first")
    add("--allow-outside", action="store_true", help="the file may refer to files outside of its folder")
    defaults = ", ".join(f"{field.name}={getattr(Limits(), field.name)}" for field in fields(Limits))
    add("--limits", metavar="NAME=N,...", help=f"how much the file may ask for; default {defaults}")


def add_environment(add: argparse._ActionsContainer) -> None:
    """The options of light from all around."""
    add.add_argument(
        "--environment", metavar="FILE", help=f"light from all around: {', '.join(RADIANCE_TYPES)}, latitude-longitude"
    )
    add.add_argument(
        "--rotation",
        type=float,
        default=0.0,
        metavar="A",
        help="turns it about the scene's up axis, degrees; default 0",
    )


def _limits(text: str | None) -> Limits | None:
    if text is None:
        return None
    names, values = [field.name for field in fields(Limits)], {}
    for part in text.split(","):
        name, _, value = part.partition("=")
        if name.strip() not in names:
            raise ValueError(f"--limits has {part!r}; give NAME=N with a name of {', '.join(names)}")
        try:
            values[name.strip()] = int(value) if value.strip().isdecimal() else round(float(value))
        except (ValueError, OverflowError):
            raise ValueError(f"--limits has {part!r}; give a whole number") from None
    return Limits(**values)


def scene_of(given: argparse.Namespace) -> Scene:
    """The scene that the options tell of."""
    limits = _limits(given.limits)
    options = {"camera": given.camera, "allow_outside": given.allow_outside, "limits": limits}
    environment = getattr(given, "environment", None)
    if environment is None:
        return scene_by_name(given.scene, **options)
    image = read_radiance(environment, limits)
    if given.scene not in SCENES:
        up = (0, 0, 1) if z_is_up(given.scene) else (0, 1, 0)
        return load(given.scene, environment=Environment(image, up, given.rotation), **options)
    scene = scene_by_name(given.scene, camera=given.camera)
    around = Environment(image, scene.camera.up, given.rotation)  # the built-in cameras' up is their scene's
    return Scene(scene.shapes, scene.camera, scene.background, scene.max_bounces, environment=around)
