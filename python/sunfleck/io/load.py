# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""load: files of geometry as scenes."""

from __future__ import annotations

import logging
import operator
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sunfleck._arguments import vector
from sunfleck.error import Error
from sunfleck.io.contents import Contents, View
from sunfleck.io.files import FilePath, ending, known_ending
from sunfleck.io.gltf import read_gltf
from sunfleck.io.lamp import emits, lit_scene
from sunfleck.io.obj import read_obj
from sunfleck.io.ply import read_ply
from sunfleck.io.source import Limits, Source
from sunfleck.io.stl import read_stl
from sunfleck.scene import Camera, Scene
from sunfleck.scene.bounds import Box, box_of
from sunfleck.scene.instances import Instances
from sunfleck.scene.mesh import Mesh
from sunfleck.scene.sky import Environment
from sunfleck.scenes import SCENES

__all__ = ["FILE_TYPES", "load", "scene_by_name", "z_is_up"]

_log = logging.getLogger("sunfleck")

# Of the default camera, in a frame whose y is up and whose z is the model's front. Its angle and
# distance show the whole bounding sphere.
_FOV = 40.0
_CAMERA_DIRECTION = (0.5, 0.4, 1.0)


# Ending: the reader, and whether z is up (else y).
FILE_TYPES: dict[str, tuple[Callable[[Source], Contents], bool]] = {
    ".obj": (read_obj, False),
    ".ply": (read_ply, True),
    ".stl": (read_stl, True),
    ".gltf": (read_gltf, False),
    ".glb": (read_gltf, False),
}


def _read(source: Source) -> Contents:
    """The reader's answer, or its refusal under the file's name; readers trip in many ways."""
    path = source.path
    reader, _ = FILE_TYPES[ending(path)]
    try:
        with np.errstate(all="ignore"):  # what comes out not finite is refused with the mesh or camera
            return reader(source)
    except (OSError, MemoryError, Error):
        raise
    except ImportError as error:
        raise NotImplementedError(f"{path}: it takes {error.name!r} to read it, which is not installed") from error
    except NotImplementedError as error:
        raise NotImplementedError(f"{path}: {error}") from error
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error
    except Exception as error:
        raise ValueError(f"{path}: malformed ({type(error).__name__}: {error})") from error


def _default_camera(box: Box, z_up: bool) -> Camera:
    x, y, z = _CAMERA_DIRECTION
    direction = np.array((x, -z, y) if z_up else (x, y, z))
    direction /= np.linalg.norm(direction)
    position = box.centre + box.radius / np.sin(np.radians(_FOV / 2)) * direction
    up = (0, 0, 1) if z_up else (0, 1, 0)
    return Camera(vector("", position), vector("", box.centre), up=up, vertical_fov=_FOV)


def _camera_of(view: View, box: Box) -> Camera:
    """The file's camera; its target, which sets no more than the focus, at the model's depth."""
    length = float(np.linalg.norm(view.direction))
    if not 0 < length < np.inf:
        raise ValueError(f"the camera looks along {view.direction}, which is no direction")
    direction = np.asarray(view.direction) / length
    depth = max(float((box.centre - view.position) @ direction), box.radius)
    return Camera(view.position, vector("", view.position + depth * direction), view.up, vertical_fov=view.vertical_fov)


def _names(views: list[View]) -> str:
    return ", ".join(f"{number} {view.name!r}" for number, view in enumerate(views))


def _number(camera: Any) -> int:
    try:
        if not isinstance(camera, (bool, np.bool_)):
            return operator.index(camera)
    except TypeError:
        pass
    raise TypeError(f"camera is {camera!r}; give a name or a number")


def _chosen(views: list[View], wanted: str | int | None) -> int:
    """The number of the camera that is wanted, by its name or number; the first, where none is.

    Raises
    ------
    ValueError
        There is no such camera, or there are several.
    """
    if wanted is None:
        return 0
    found = [k for k, view in enumerate(views) if (view.name if isinstance(wanted, str) else k) == wanted]
    if not found and isinstance(wanted, str) and wanted.isdecimal() and int(wanted) < len(views):
        return int(wanted)
    if len(found) != 1:
        there = f"the file's are {_names(views)}" if views else "the file has none that is read"
        several = "; several have that name, so give a number" if found else ""
        raise ValueError(f"there is no one camera {wanted!r}; {there}{several}")
    return found[0]


def _camera(file: Path, views: list[View], wanted: str | int | None, box: Box) -> tuple[Camera, float]:
    """And the frame's width over its height that it is made for."""
    try:
        number = _chosen(views, wanted)
        camera = _camera_of(views[number], box) if views else _default_camera(box, z_is_up(file))
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from error
    if not views:
        _log.info(
            "%s: no camera in it; one of %g degrees at (%.4g, %.4g, %.4g) looks at (%.4g, %.4g, %.4g)",
            *(file, camera.vertical_fov, *camera.position, *camera.target),
        )
    elif len(views) > 1 and wanted is None:
        _log.info("%s: %d cameras: %s; the first is taken, camera= chooses", file, len(views), _names(views))
    return camera, views[number].aspect if views else 1.0


def _lit_scene(file: Path, shapes: Sequence[Mesh | Instances], camera: Camera, aspect: float, box: Box) -> Scene:
    """What the shapes' own light leaves dark is lit by one mesh more."""
    scene, lamp, share = lit_scene(shapes, camera, box, z_up=z_is_up(file), aspect=aspect)
    if lamp is not None:
        lit = any(map(emits, shapes))
        why = f"its light reaches {100 * share:.1f} % of what the camera sees" if lit else "no light in it"
        _log.info(
            "%s: %s; a square of side %.4g and radiance %.4g shines from (%.4g, %.4g, %.4g)",
            *(file, why, lamp.side, lamp.radiance, *lamp.middle),
        )
    scene._speak()
    return scene


def z_is_up(path: FilePath) -> bool:
    """Whether z is up in files of that ending, else y; False for an ending that is not known."""
    return FILE_TYPES.get(ending(path), (None, False))[1]


def load(
    path: FilePath,
    *,
    camera: str | int | None = None,
    environment: Environment | None = None,
    allow_outside: bool = False,
    limits: Limits | None = None,
) -> Scene:
    """A scene of the triangles in a file.

    Parameters
    ----------
    path : path-like
        Ending in .obj, .ply, .stl, .gltf or .glb.
    camera : str or int, optional
        One of the file's cameras, by its name (its node's, or else its own) or by its number in the order of the
        scene's nodes, from 0. None: the first.
    environment : Environment, optional
        Light from all around, which takes the place of the lamp that a file without light gets.
    allow_outside : bool
        Whether the file may refer to files outside of its folder: by absolute paths, by ``..``, or by symbolic
        links that lead there. Such a file may be anybody's who reads what comes of it.
    limits : Limits, optional
        How much the file may ask for. None: ``Limits()``.

    Returns
    -------
    Scene
        With 5 bounces and a black background. Another setting is one line away, say:
        ``sf.Scene(scene.shapes, scene.camera, suns=scene.suns, max_bounces=9)``.

    Raises
    ------
    ValueError
        An unknown ending; a malformed file, of which the line is named where it is text; a file without triangles;
        one that refers to files outside of its folder, or asks for more than the limits; a camera that is not in it.
    NotImplementedError
        A glTF that requires an extension or version that is not read.
    OSError
        The file, or one that it refers to, can't be read, or is no ordinary file (a pipe, a device). A library of
        materials that is missing is no error: its materials are 0.5 grey, and the log says so.
    TypeError
        ``path`` is not a path; another argument of the wrong kind.
    MemoryError, sunfleck.Error
        As `Scene`.

    Notes
    -----
    Polygons of any shape become triangles. Surfaces of PLY and STL are diffuse and 0.5 grey. OBJ's
    are, by illum, Kd, Ks, Tf and d, one thing each: ``Mirror()`` or, where Fresnel's law is asked for,
    ``Conductor(0)`` of albedo Ks; ``Dielectric(Ni)`` of albedo Tf; ``Conductor`` of albedo Kd, where Pm
    or Blender's Ka say metal; else diffuse, of albedo Kd. All emit Ke. docs/scene.md has the rules. glTF's
    have its base colour and emission (times emissive strength), and are one thing each, since
    materials are not mixed: ``Conductor(roughness)`` where metallicFactor, by default 1, is 0.5 or
    more and the roughness at most 0.6; else ``Dielectric(ior, roughness)`` where transmissionFactor
    of KHR_materials_transmission is, with KHR_materials_ior, by default 1.5; else diffuse, as are
    rougher metal, materials without pbrMetallicRoughness, and those with a texture of it. Glass
    refracts, as the border of a solid whose normals point out, also where the extension means a
    thin pane. Textures are not read: one of colour counts as 0.5. Alpha, coats and the like are
    left out. Double-sided materials emit on both sides.

    A mesh that several nodes of a glTF share, or that EXT_mesh_gpu_instancing repeats, becomes `Instances` where
    more than 10,000 triangles would be copied. Nodes of scale 0 are hidden.

    A file without a perspective camera gets one of 40 degrees that sees the whole model from the
    front, to the right and above. glTF's directional lights become suns of angle 0; point and spot
    lights are left out, and their number is said. Where a file has no suns, and what emits in it reaches less
    than a tenth of what the camera sees (as a render of 48 x 48 pixels tells), it gets a lamp,
    a square: of radiance 10, as wide as 1.5 radii of the model, 2.5 radii from its centre, to the left, above and
    in front of the model, or else of the camera; in rooms a small one beside the camera. All of this is said
    through ``logging`` under "sunfleck", at level INFO, as is all that was left out. y is up in OBJ and glTF, z in
    PLY and STL.

    Suns of a glTF are in lux. The scene's ``exposure`` is then "auto": see `Image.save`.

    Examples
    --------
    >>> import sunfleck as sf
    >>> sf.load("room.max")
    Traceback (most recent call last):
        ...
    ValueError: 'room.max' ends in '.max'; files that can be loaded end in .obj, .ply, .stl, .gltf, .glb
    """
    source = Source(path, allow_outside=allow_outside, limits=limits)
    if not isinstance(camera, (str, type(None))):
        camera = _number(camera)
    if not isinstance(environment, (Environment, type(None))):
        raise TypeError(f"environment is {environment!r}; give a sunfleck.Environment")
    file = source.path
    known_ending(file, FILE_TYPES, "files that can be loaded end in")
    contents = _read(source)
    if not contents.meshes:
        raise ValueError(f"{file}: it holds no triangles")
    box = box_of(contents.meshes)
    if not box.radius > 0:
        raise ValueError(f"{file}: all of it lies in one point")
    eye, aspect = _camera(file, contents.views, camera, box)
    if environment is None and not contents.suns:
        return _lit_scene(file, contents.meshes, eye, aspect, box)
    exposure = "auto" if contents.photometric else 0.0
    return Scene(contents.meshes, eye, suns=contents.suns, environment=environment, exposure=exposure)


def scene_by_name(name: str, **options: Any) -> Scene:
    """A built-in scene by its name, or a file's.

    Parameters
    ----------
    name : str
        One of `sunfleck.scenes.SCENES`, or a path.
    **options
        Of `load`; where any is given, but for None and False, a built-in scene is refused.

    Returns
    -------
    Scene

    Raises
    ------
    ValueError
        Neither: no such scene, and no ending; or options that are files' for a built-in scene.
    Exception
        As `load` raises.

    Examples
    --------
    >>> from sunfleck.io.load import scene_by_name
    >>> scene_by_name("cornell").max_bounces
    5
    """
    known = next((scene for scene in SCENES if scene == name.lower()), None)
    if known is None and not Path(name).suffix:
        raise ValueError(f"there is no scene {name!r}; give one of {', '.join(SCENES)}, or a file")
    if known is None:
        return load(name, **options)
    given = [option for option, value in options.items() if value is not None and value is not False]
    if given:
        raise ValueError(f"{', '.join(given)} can be given for files; {name!r} is a built-in scene")
    return SCENES[known]()
