# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""load: files of geometry as scenes."""

from __future__ import annotations

import io
import logging
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sunfleck._arguments import Vector, vector
from sunfleck._files import FilePath, given_path
from sunfleck.gltf import Contents, View, read_gltf
from sunfleck.mesh import Mesh
from sunfleck.scene import Camera, Scene
from sunfleck.scenes import SCENES
from sunfleck.sky import Environment

__all__ = ["FILE_TYPES", "load", "scene_by_name", "z_is_up"]

_log = logging.getLogger("sunfleck")

# Of the default camera and light, in a frame whose y is up and whose z is the model's front. The
# camera's angle and distance show the whole bounding sphere; the light lies outside of it, to the
# left and in front, where its irradiance at the centre is 10 * (1.5 / 2.5)^2 = 3.6.
_FOV = 40.0
_CAMERA_DIRECTION = (0.5, 0.4, 1.0)
_LIGHT_DIRECTION = (-0.6, 1.0, 0.6)
_LIGHT_DISTANCE = 2.5  # of the bounding sphere's radius
_LIGHT_SIDE = 1.5  # likewise
_RADIANCE = 10.0


def _decode(data: bytes) -> bytes:
    """Text as UTF-8, from UTF-16 with its mark, UTF-8, or else Latin-1, which takes every byte."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return data.decode("utf-16").encode()
    try:
        data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1").encode()
    return data


def _colors(material: Any) -> dict[str, Any]:
    """Kd and Ke of an OBJ material, where it has them."""
    values = getattr(material, "kwargs", {})
    colors = {}
    for ours, theirs in (("albedo", "kd"), ("emission", "ke")):
        if theirs in values:
            given = values[theirs] if isinstance(values[theirs], list) else [values[theirs]]
            # A single number stands for all three.
            colors[ours] = vector(theirs, [float(v) for v in (given * 3 if len(given) == 1 else given)[:3]])
    return colors


def _read_by_trimesh(path: Path) -> Contents:
    import trimesh

    kind = path.suffix[1:].lower()
    data = path.read_bytes()
    scene = trimesh.load_scene(
        io.BytesIO(_decode(data) if kind == "obj" else data),
        file_type=kind,
        process=False,
        resolver=trimesh.resolvers.FilePathResolver(str(path)),
    )
    meshes = []
    for geometry in scene.geometry.values():
        if not isinstance(geometry, trimesh.Trimesh) or len(geometry.faces) == 0:
            _log.info("%s: points and lines are left out", path)
            continue
        colors = _colors(getattr(geometry.visual, "material", None))
        meshes.append(Mesh(geometry.vertices.view(np.ndarray), geometry.faces.view(np.ndarray), **colors))
    return Contents(meshes)


# Ending: the reader, and whether z is up (else y).
FILE_TYPES: dict[str, tuple[Callable[[Path], Contents], bool]] = {
    ".obj": (_read_by_trimesh, False),
    ".ply": (_read_by_trimesh, True),
    ".stl": (_read_by_trimesh, True),
    ".gltf": (read_gltf, False),
    ".glb": (read_gltf, False),
}


def _read(path: Path) -> Contents:
    """The reader's answer, or its refusal under the file's name; readers trip in many ways."""
    reader, _ = FILE_TYPES[path.suffix.lower()]
    try:
        with np.errstate(all="ignore"):  # what comes out not finite is refused with the mesh or camera
            return reader(path)
    except (OSError, MemoryError):
        raise
    except NotImplementedError as error:
        raise NotImplementedError(f"{path}: {error}") from error
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error
    except Exception as error:
        raise ValueError(f"{path}: malformed ({type(error).__name__}: {error})") from error


def _direction(value: Vector, z_up: bool) -> NDArray[np.float64]:
    x, y, z = value
    direction = np.array((x, -z, y) if z_up else value, dtype=np.float64)
    direction /= np.linalg.norm(direction)
    return direction


def _default_camera(centre: NDArray[np.float64], radius: float, z_up: bool) -> Camera:
    distance = radius / np.sin(np.radians(_FOV / 2))
    position = centre + distance * _direction(_CAMERA_DIRECTION, z_up)
    return Camera(vector("", position), vector("", centre), up=(0, 0, 1) if z_up else (0, 1, 0), vertical_fov=_FOV)


def _default_light(centre: NDArray[np.float64], radius: float, z_up: bool) -> Mesh:
    towards = _direction(_LIGHT_DIRECTION, z_up)
    x = np.cross((0, 0, 1) if z_up else (0, 1, 0), towards)
    x *= _LIGHT_SIDE * radius / 2 / np.linalg.norm(x)
    y = np.cross(towards, x)
    middle = centre + _LIGHT_DISTANCE * radius * towards
    corners = [middle - x - y, middle - x + y, middle + x + y, middle + x - y]  # wound to face the model
    return Mesh(corners, [[0, 1, 2], [0, 2, 3]], albedo=(0, 0, 0), emission=(_RADIANCE,) * 3)


def _camera_of(view: View, centre: NDArray[np.float64], radius: float) -> Camera:
    """The file's camera; its target, which sets no more than the focus, at the model's depth."""
    length = float(np.linalg.norm(view.direction))
    if not 0 < length < np.inf:
        raise ValueError(f"the camera looks along {view.direction}, which is no direction")
    direction = np.asarray(view.direction) / length
    depth = max(float((centre - view.position) @ direction), radius)
    return Camera(view.position, vector("", view.position + depth * direction), view.up, vertical_fov=view.vertical_fov)


def _bounds(meshes: list[Mesh]) -> tuple[NDArray[np.float64], float]:
    """Centre and radius of the sphere about the box about everything."""
    lower = np.min([mesh.vertices.min(axis=0) for mesh in meshes], axis=0).astype(np.float64)
    upper = np.max([mesh.vertices.max(axis=0) for mesh in meshes], axis=0).astype(np.float64)
    return (lower + upper) / 2, float(np.linalg.norm(upper - lower) / 2)


def z_is_up(path: FilePath) -> bool:
    """Whether z is up in files of that ending, else y; False for an ending that is not known."""
    return FILE_TYPES.get(Path(path).suffix.lower(), (None, False))[1]


def load(path: FilePath, *, environment: Environment | None = None) -> Scene:
    """A scene of the triangles in a file.

    Parameters
    ----------
    path : path-like
        Ending in .obj, .ply, .stl, .gltf or .glb.
    environment : Environment, optional
        Light from all around, which takes the place of the light that a file without one gets.

    Returns
    -------
    Scene
        With 5 bounces and a black background. Another camera, say, is one line away:
        ``sf.Scene(scene.meshes, camera)``.

    Raises
    ------
    ValueError
        An unknown ending; a malformed file; a file without triangles.
    NotImplementedError
        A glTF that requires an extension or version that is not read.
    OSError
        The file, or one that it refers to, can't be read.
    TypeError
        ``path`` is not a path.
    MemoryError, sunfleck.Error
        As `Scene`.

    Notes
    -----
    Surfaces of OBJ, PLY and STL are diffuse: OBJ's Kd and Ke, 0.5 grey where there is none. glTF's
    have its base colour and emission (times emissive strength), and are one thing each, since
    materials are not mixed: ``Conductor(roughness)`` where metallicFactor, by default 1, is 0.5 or
    more and the roughness at most 0.6; else ``Dielectric(ior, roughness)`` where transmissionFactor
    of KHR_materials_transmission is, with KHR_materials_ior, by default 1.5; else diffuse, as are
    rougher metal, materials without pbrMetallicRoughness, and those with a texture of it. Glass
    refracts, as the border of a solid whose normals point out, also where the extension means a
    thin pane. Textures are not read: one of colour counts as 0.5. Alpha, coats and the like are
    left out.

    A file without a perspective camera gets one of 40 degrees that sees the whole model from the
    front, to the right and above. glTF's directional lights become suns of angle 0; point and spot
    lights are left out, and their number is said. A file without emission and suns gets a square
    light of radiance 10, as wide as 1.5 radii of the model, 2.5 radii from its centre, to the left,
    above and in front. Both are said through ``logging`` under "sunfleck", at level INFO, as is all
    that was left out. y is up in OBJ and glTF, z in PLY and STL.

    Examples
    --------
    >>> import sunfleck as sf
    >>> sf.load("room.max")
    Traceback (most recent call last):
        ...
    ValueError: 'room.max' ends in '.max'; files that can be loaded end in .obj, .ply, .stl, .gltf, .glb
    """
    given = given_path(path)
    file = Path(given)
    if file.suffix.lower() not in FILE_TYPES:
        raise ValueError(f"{given!r} ends in {file.suffix!r}; files that can be loaded end in {', '.join(FILE_TYPES)}")
    if file.exists() and not file.is_file():
        raise OSError(f"{given!r} is not a file")
    contents = _read(file)
    meshes, view = contents.meshes, contents.view
    if not meshes:
        raise ValueError(f"{file}: it holds no triangles")
    centre, radius = _bounds(meshes)
    if not radius > 0:
        raise ValueError(f"{file}: all of it lies in one point")
    z_up = FILE_TYPES[file.suffix.lower()][1]
    if view is None:
        camera = _default_camera(centre, radius, z_up)
        _log.info(
            "%s: no camera in it; one of %g degrees at (%.4g, %.4g, %.4g) looks at (%.4g, %.4g, %.4g)",
            *(file, camera.vertical_fov, *camera.position, *camera.target),
        )
    else:
        camera = _camera_of(view, centre, radius)
    if environment is None and not contents.suns and not any(any(mesh.emission) for mesh in meshes):
        light = _default_light(centre, radius, z_up)
        meshes.append(light)
        _log.info(
            "%s: no light in it; a square of side %.4g and radiance %g shines from (%.4g, %.4g, %.4g)",
            *(file, _LIGHT_SIDE * radius, _RADIANCE, *light.vertices.mean(axis=0)),
        )
    return Scene(meshes, camera, suns=contents.suns, environment=environment)


def scene_by_name(name: str) -> Scene:
    """A built-in scene by its name, or a file's.

    Parameters
    ----------
    name : str
        One of `sunfleck.scenes.SCENES`, or a path.

    Returns
    -------
    Scene

    Raises
    ------
    ValueError
        Neither: no such scene, and no ending.
    Exception
        As `load` raises.

    Examples
    --------
    >>> from sunfleck.load import scene_by_name
    >>> scene_by_name("cornell").max_bounces
    5
    """
    if name not in SCENES and not Path(name).suffix:
        raise ValueError(f"there is no scene {name!r}; give one of {', '.join(SCENES)}, or a file")
    return SCENES[name]() if name in SCENES else load(name)
