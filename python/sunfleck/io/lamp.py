# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""lamp: the light that a file gets whose own does not reach what the camera sees.

Small renders tell how much of what the camera sees is lit: first by the file's own light, then with a lamp at the
left of the model. Where neither does, a probe, the same shapes all of them diffuse and grey, compares places for the
lamp: one in red, one in green, one in blue.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sunfleck._arguments import Vector, vector
from sunfleck.render import Image, render
from sunfleck.scene import Camera, Scene
from sunfleck.scene.bounds import Box
from sunfleck.scene.instances import Instances
from sunfleck.scene.material import Dielectric
from sunfleck.scene.mesh import Mesh
from sunfleck.scene.sky import Sun

__all__ = ["LAMP_RADIANCE", "Lamp", "emits", "lit_scene"]

_Shapes = Sequence[Mesh | Instances]
_Direction = NDArray[np.float64]

# The lamp's irradiance at the model's centre is the same wherever it is.
LAMP_RADIANCE = 10.0
_DISTANCE = 2.5  # of the bounding sphere's radius
_SIDE = 0.6  # of the distance
_IRRADIANCE = LAMP_RADIANCE * _SIDE**2
_INNER_IRRADIANCE = _IRRADIANCE / 3

# Directions to the lamp: in a frame whose y is up and whose z is the model's front; and by the camera's right,
# its up and the way back to it.
_FROM_MODEL = (-0.6, 1.0, 0.6)
_FROM_CAMERA = ((-0.5, 0.7, 1.0), (0.5, 0.7, 1.0))

# Within rooms the lamp is moved off the camera, by so much of the middle depth that it sees. Its size is a share
# of that, so that it ends before what is looked at farther out: sqrt(1/2) of the size is less than that leaves.
# Its irradiance at that depth is a third of the other's, since walls send most of it back.
_ASIDE = (0.35, 0.1)
_INNER_SIZE, _PROBE_SIZE = 0.2, 0.1
_CLEAR = 1.3

_PIXELS, _SAMPLES = 48, 16
_GREY = 0.8
_BLACK = 0.02  # albedos up to it are not judged by what they reflect

# A lamp is added where the file's own light reaches less than this share of what is seen. A pixel counts as lit
# from 15 of 255 in sRGB on.
_OWN_SHARE = 0.1
_DARK = 0.005

# A candidate is good enough from the first share on, and possible from the second. It lights a pixel that has this
# much of the radiance straight below it.
_GOOD, _POSSIBLE = 0.5, 0.3
_LIT = 0.04


@dataclass(frozen=True)
class Lamp:
    """A square that shines towards a point: its middle, its side and its radiance."""

    middle: _Direction
    towards: _Direction
    side: float
    radiance: float

    def mesh(self, up: _Direction, emission: Vector | None = None) -> Mesh:
        """Wound to face the point."""
        outward = self.middle - self.towards
        outward /= np.linalg.norm(outward)
        x = np.cross(up, outward)
        if np.linalg.norm(x) < 1e-3:
            x = np.cross(np.roll(up, 1), outward)
        x *= self.side / 2 / np.linalg.norm(x)
        y = np.cross(outward, x)
        corners = [self.middle - x - y, self.middle - x + y, self.middle + x + y, self.middle + x - y]
        glow = (self.radiance,) * 3 if emission is None else emission
        return Mesh(corners, [[0, 1, 2], [0, 2, 3]], albedo=(0, 0, 0), emission=glow)


class _View:
    """A camera's directions, each of length 1, and the pyramid that it sees."""

    def __init__(self, camera: Camera, aspect: float, up: _Direction) -> None:
        self.camera, self.scene_up = camera, up
        self.position = np.array(camera.position)
        forward = np.array(camera.target) - self.position
        self.forward = forward / np.linalg.norm(forward)
        right = np.cross(self.forward, camera.up)
        self.right = right / np.linalg.norm(right)
        self.up = np.cross(self.right, self.forward)
        self._half = np.tan(np.radians(camera.vertical_fov) / 2)
        self._aspect = aspect if 0 < aspect < np.inf else 1.0

    def direction(self, right: float, up: float, back: float) -> _Direction:
        """Of length 1."""
        direction = right * self.right + up * self.up - back * self.forward
        unit: _Direction = direction / np.linalg.norm(direction)
        return unit

    def shows(self, lamp: Lamp) -> bool:
        """Whether no side of the pyramid has all of the lamp beyond it."""
        corners = lamp.mesh(self.scene_up).vertices - self.position
        x, y, z = corners @ self.right / self._aspect, corners @ self.up, corners @ self.forward
        edge = self._half * z
        return not any(side.all() for side in (z < 0, x > edge, x < -edge, y > edge, y < -edge))


def lit_scene(
    shapes: _Shapes, camera: Camera, box: Box, *, z_up: bool, aspect: float = 1.0
) -> tuple[Scene, Lamp | None, float]:
    """A scene of the shapes, which has one lamp more where their own light does not reach what the camera sees.

    Parameters
    ----------
    shapes
        The file's, which has no suns.
    camera : Camera
    box : Box
        About the shapes.
    z_up : bool
        Whether z is up in the file, else y.
    aspect : float
        The width of the frame that the lamp is not to be seen in, over its height.

    Returns
    -------
    Scene
        Of which nothing is said yet.
    Lamp or None
        None: the file's own light suffices.
    float
        The share of what the camera sees that this light reaches, in [0, 1].

    Notes
    -----
    Where the first place for the lamp is good, it takes some ten milliseconds more than the scene itself; else the
    time of building up to four more scenes of the same shapes.
    """
    share = 0.0
    if any(map(emits, shapes)):
        scene = Scene._silent(shapes, camera)
        share = _own_share(scene)
        if share >= _OWN_SHARE:
            return scene, None, share
    up = np.array((0.0, 0.0, 1.0) if z_up else (0.0, 1.0, 0.0))
    view = _View(camera, aspect, up)
    first = _from_model(box, z_up)
    if not view.shows(first):
        scene = Scene._silent([*shapes, first.mesh(up)], camera)
        if _lit_share(scene) >= _GOOD:
            return scene, first, share
    lamp = _search(shapes, view, box, first)
    return Scene._silent([*shapes, lamp.mesh(up)], camera), lamp, share


def _rendered(scene: Scene, aovs: Sequence[str]) -> Image:
    """A small picture; Ctrl-C, which would end a picture, ends the loading."""
    image = render(scene, _PIXELS, _PIXELS, spp=_SAMPLES, aovs=aovs)
    if image.interrupted:
        raise KeyboardInterrupt
    return image


def _look(scene: Scene) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Radiance and albedo of the pixels that show a surface, as means over colours."""
    image = _rendered(scene, ("albedo",))
    seen = image.alpha > 0.5
    radiance, albedo = (a.astype(np.float64).mean(axis=-1)[seen] for a in (image.color, image.aovs["albedo"]))
    return radiance, albedo


def _own_share(scene: Scene) -> float:
    """Of the pixels that show a surface: those that emit or that light reaches, as if they were grey."""
    radiance, albedo = _look(scene)
    grey = radiance * np.where(albedo > _BLACK, _GREY / np.maximum(albedo, _BLACK), 1)
    return float(np.mean(grey > _DARK)) if grey.size else 1.0


def _lit_share(scene: Scene) -> float:
    """Of the pixels that show a surface that is not black: those that the lamp reaches."""
    radiance, albedo = _look(scene)
    lit = radiance[albedo > _BLACK] > _LIT * _IRRADIANCE / np.pi * albedo[albedo > _BLACK]
    return float(np.mean(lit)) if lit.size else 1.0


# ---- where a lamp may be ----


def _search(shapes: _Shapes, view: _View, box: Box, first: Lamp) -> Lamp:
    """The best of places about the model and the camera, or else one in the room that the camera is in."""
    outer = [first, *(_from_camera(box, view, towards) for towards in _FROM_CAMERA)]
    probe = _Probe(shapes, view.camera)
    depths = probe.look([Sun(vector("", lamp.middle - lamp.towards), 0, _color(k)) for k, lamp in enumerate(outer)])
    if not len(depths):
        return first
    shares = [0.0 if view.shows(lamp) else probe.share(k, _GREY / np.pi) for k, lamp in enumerate(outer)]
    return _best(outer, shares) or _inner(shapes, view, depths)


def _best(lamps: Sequence[Lamp], shares: Sequence[float]) -> Lamp | None:
    """The first that is good, or else the one that lights most."""
    good = [lamp for lamp, share in zip(lamps, shares, strict=True) if share >= _GOOD]
    most = int(np.argmax(shares))
    return good[0] if good else lamps[most] if shares[most] >= _POSSIBLE else None


def _from_model(box: Box, z_up: bool) -> Lamp:
    x, y, z = _FROM_MODEL
    direction = np.array((x, -z, y) if z_up else (x, y, z))
    direction /= np.linalg.norm(direction)
    return _outer(box, direction, _DISTANCE * box.radius)


def _from_camera(box: Box, view: _View, towards: tuple[float, float, float]) -> Lamp:
    """As far from the model as the one above, or else behind the camera, where that would be in its view."""
    direction = view.direction(*towards)
    lamp = _outer(box, direction, _DISTANCE * box.radius)
    if not view.shows(lamp):
        return lamp
    camera = float((view.position - box.centre) @ -view.forward) / float(direction @ -view.forward)
    return _outer(box, direction, max(_DISTANCE * box.radius, camera * (1 + _SIDE)))


def _outer(box: Box, direction: _Direction, distance: float) -> Lamp:
    return Lamp(box.centre + distance * direction, box.centre, _SIDE * distance, LAMP_RADIANCE)


def _inner(shapes: _Shapes, view: _View, depths: NDArray[np.float64]) -> Lamp:
    """A lamp in the room that the camera is in: beside or above it where that is within, else behind its lens.

    Small lamps farther out are looked at, so that the lamp itself keeps clear of the walls.
    """
    depth, nearest = float(np.median(depths)), float(depths.min())
    towards = view.position + depth * view.forward

    def lamp(offset: _Direction, size: float) -> Lamp:
        return Lamp(view.position + offset, towards, size * depth, _INNER_IRRADIANCE / size**2)

    for aside in _ASIDE:
        offsets = [aside * depth * view.direction(x, y, 0) for x, y in ((-1, 1), (1, 1), (0, 1))]
        probe = _Probe(shapes, view.camera)
        far = [lamp(_CLEAR * offset, aside * _PROBE_SIZE) for offset in offsets]
        probe.look((), [each.mesh(view.scene_up, _color(k, each.radiance)) for k, each in enumerate(far)])
        shares = [probe.share(k, _GREY / np.pi * _INNER_IRRADIANCE) for k in range(len(far))]
        found = _best([lamp(offset, aside * _INNER_SIZE) for offset in offsets], shares)
        if found:
            return found
    return lamp(-1e-3 * nearest * view.forward, _ASIDE[-1] * _PROBE_SIZE)


# ---- the probe ----


def _color(channel: int, level: float = 1.0) -> Vector:
    red, green, blue = (level * (k == channel) for k in range(3))
    return red, green, blue


def emits(shape: Mesh | Instances) -> bool:
    """Whether any of it does."""
    return any(any(mesh.emission) for mesh in (shape.meshes if isinstance(shape, Instances) else (shape,)))


class _Probe:
    """Shapes without colour: grey and diffuse, but for emitters, which are black and dark. Glass, which lets light
    through, is left out where there is anything else."""

    def __init__(self, shapes: _Shapes, camera: Camera) -> None:
        self._camera = camera
        self._greys: dict[int, Mesh] = {}
        self._shapes = self._all_grey(shapes, False) or self._all_grey(shapes, True)

    def _all_grey(self, shapes: _Shapes, with_glass: bool) -> list[Mesh | Instances]:
        grey: list[Mesh | Instances] = []
        for shape in shapes:
            meshes = shape.meshes if isinstance(shape, Instances) else (shape,)
            solid = [mesh for mesh in meshes if any(mesh.emission) or not isinstance(mesh.material, Dielectric)]
            shown = [self._grey(mesh) for mesh in (meshes if with_glass else solid)]
            if shown:
                grey.append(Instances(shown, shape.transforms) if isinstance(shape, Instances) else shown[0])
        return grey

    def _grey(self, mesh: Mesh) -> Mesh:
        """The same one for the same mesh, so that instances share it."""
        if id(mesh) not in self._greys:
            albedo = 0.0 if any(mesh.emission) else _GREY
            self._greys[id(mesh)] = Mesh(mesh.vertices, mesh.triangles, (albedo,) * 3)
        return self._greys[id(mesh)]

    def look(self, suns: Sequence[Sun], emitters: Sequence[Mesh] = ()) -> NDArray[np.float64]:
        """Renders direct light; the depths along the camera's axis of what is seen and does not emit."""
        scene = Scene._silent([*self._shapes, *emitters], self._camera, max_bounces=1, suns=suns)
        image = _rendered(scene, ("albedo", "depth"))
        cover = image.aovs["albedo"][..., 0] / _GREY
        seen = (cover > 0.5) & (image.alpha - cover < 0.02)  # no emitter in the pixel
        self._color = (image.color / np.maximum(cover, 0.5)[..., None])[seen]
        depths: NDArray[np.float64] = image.aovs["depth"][seen].astype(np.float64)
        return depths

    def share(self, channel: int, full: float) -> float:
        """Of the pixels seen that do not emit: those that have some of the radiance that a candidate gives in full."""
        return float(np.mean(self._color[:, channel] > _LIT * full))
