# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""scene: meshes over the caller's arrays, a camera, a background, and the plan of what they need."""

from __future__ import annotations

import inspect
import logging
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from sunfleck import _core
from sunfleck._arguments import Vector, flag, integer, number, text, vector
from sunfleck.exposure import exposure_of
from sunfleck.scene.fog import Fog
from sunfleck.scene.instances import Instances
from sunfleck.scene.mesh import Mesh
from sunfleck.scene.shapes import Disk, Sphere
from sunfleck.scene.sky import Environment, Sun

__all__ = ["Camera", "Plan", "PlanDimensions", "Scene", "SceneInfo"]

_log = logging.getLogger("sunfleck")


@dataclass(frozen=True)
class Camera:
    """A pinhole camera, or a thin lens where ``aperture_radius`` > 0.

    Row 0 of the image is the top, image right is forward x up.

    Parameters
    ----------
    position, target : tuple of 3 floats
        Where the camera is and what it looks at, in scene units; not the same point.
    up : tuple of 3 floats
        A direction that shall be vertical in the image; not along the line of sight.
    vertical_fov : float
        Angle from the bottom to the top of the full frame, in degrees, in (0, 180).
    aperture_radius : float
        Of the lens, in scene units, at least 0; 0 is a pinhole.
    focus_distance : float, optional
        Along the axis to the focal plane, in scene units, above 0. None: through the target.

    Raises
    ------
    TypeError, ValueError
        A value of the wrong kind or out of its range, which is named.

    Examples
    --------
    >>> import sunfleck as sf
    >>> sf.Camera((0, -4, 3.2), (0, 0, 0.3), up=(0, 0, 1), vertical_fov=35).vertical_fov
    35.0
    """

    position: Vector
    target: Vector
    up: Vector = (0.0, 1.0, 0.0)
    vertical_fov: float = 40.0
    aperture_radius: float = 0.0
    focus_distance: float | None = None

    def __post_init__(self) -> None:
        for name in ("position", "target", "up"):
            object.__setattr__(self, name, vector(name, getattr(self, name)))
        for name in ("vertical_fov", "aperture_radius"):
            object.__setattr__(self, name, number(name, getattr(self, name)))
        if self.focus_distance is not None:
            object.__setattr__(self, "focus_distance", number("focus_distance", self.focus_distance))
            if self.focus_distance == 0:  # C's word for "through the target"
                raise ValueError("focus_distance is 0; give a distance above 0, or None for the target's")
        _core.check_camera(*self._values())

    def _values(self) -> tuple[Vector, Vector, Vector, float, float, float]:
        focus = 0.0 if self.focus_distance is None else self.focus_distance
        return self.position, self.target, self.up, self.vertical_fov, self.aperture_radius, focus


_T = TypeVar("_T")


def _list_of(name: str, values: Iterable[_T], kinds: tuple[type, ...]) -> tuple[_T, ...]:
    wanted = " or ".join(f"sunfleck.{kind.__name__}" for kind in kinds)
    if isinstance(values, kinds) or not isinstance(values, Iterable):
        raise TypeError(f"{name} is {values!r}; give a list of {wanted}")
    given = tuple(values)
    for value in given:
        if not isinstance(value, kinds):
            raise TypeError(f"{name} holds {value!r}; every one must be a {wanted}")
    return given


@dataclass(frozen=True)
class PlanDimensions:
    """Some of a path's sample dimensions: ``count`` from ``first`` on, for one use.

    ``use`` is pixel, lens, light, choice or surface; ``bounce`` is the path's vertex that they
    serve (1 = the first surface hit), 0 for pixel and lens.
    """

    use: str
    bounce: int
    first: int
    count: int

    @property
    def name(self) -> str:
        """``use``, and the bounce where there is one: "pixel", "light 1"."""
        return f"{self.use} {self.bounce}" if self.bounce else self.use


@dataclass(frozen=True)
class Plan:
    """What a scene turned out to need, and what the renderer runs: nothing else.

    Attributes
    ----------
    stages : list of str
        The stages that run, in the order a path meets them.
    dimensions : list of PlanDimensions
        The uses of a path's sample dimensions, in order.
    dimensions_per_path : int
        Sample coordinates that one path takes at the most.
    camera_rays, shadow_rays, surface_rays : int
        Rays that one path traces at the most, by kind.
    max_bounces : int
        As the scene has it.
    """

    stages: list[str]
    dimensions: list[PlanDimensions]
    dimensions_per_path: int
    camera_rays: int
    shadow_rays: int
    surface_rays: int
    max_bounces: int

    @property
    def rays_per_path(self) -> int:
        """Rays of all kinds that one path traces at the most."""
        return self.camera_rays + self.shadow_rays + self.surface_rays

    def __str__(self) -> str:
        rays = f"{self.camera_rays} camera, {self.shadow_rays} shadow, {self.surface_rays} surface"
        lines = [
            f"bounces     {self.max_bounces}",
            f"stages      {', '.join(self.stages)}",
            f"rays        at most {self.rays_per_path} a path: {rays}",
            f"dimensions  {self.dimensions_per_path} a path",
        ]
        for group in self.dimensions:
            last = group.first + group.count - 1
            span = f"{group.first}" if group.count == 1 else f"{group.first}-{last}"
            lines.append(f"  {span:<10}{group.name}")
        return "\n".join(lines)


@dataclass(frozen=True)
class SceneInfo:
    """What a scene holds.

    ``light_count`` pieces are sampled for light (triangles, pairs of them, spheres, disks, suns, the
    environment), of which ``rectangle_light_count`` are pairs of triangles that form a parallelogram;
    ``degenerate_count`` triangles have no area; ``triangle_count`` has those of instances as often as they
    are placed, ``unique_triangle_count`` as often as they are held: once, but for placed lights;
    ``copied_bytes`` of the arrays could not be read in place; scenes of the same picture have
    the same ``hash``.
    """

    mesh_count: int
    sphere_count: int
    disk_count: int
    sun_count: int
    instance_count: int
    triangle_count: int
    unique_triangle_count: int
    light_count: int
    rectangle_light_count: int
    degenerate_count: int
    copied_bytes: int
    bounds_lower: Vector
    bounds_upper: Vector
    hash: int


Shape = Mesh | Sphere | Disk | Instances


class Scene:
    """Shapes, a camera and what shines on them, ready to render. Immutable.

    Parameters
    ----------
    meshes : iterable of Mesh, Sphere, Disk or Instances
        At least one. Any that emits is an area light. The arrays of meshes are read in place and
        kept alive by the scene.
    camera : Camera
    background : tuple of 3 floats
        Radiance of rays that hit nothing, linear RGB, each in [0, 1e18]. It counts as emission.
    max_bounces : int
        0 (emission seen directly), 1 (direct light), ... 64.
    suns : iterable of Sun
        At most 64.
    environment : Environment, optional
        Added to the background.
    light_sampling : str
        How light that can be sampled (all but the background) is found: "both", by light and by surface
        sampling, weighted; "light" or "surface", by one of them alone. The mean is the same, but that
        "surface" misses suns of angle 0.
    light_choice : str
        How one light of several is chosen for a vertex: "power", in proportion to what each sends out, in
        constant time; "tree", by a bound of what each may send there, from a tree over all triangles that
        emit (Conty Estevez & Kulla 2018), in time that grows as the logarithm of their number; "auto", by
        the tree where it pays, from 8 of them on. The mean is the same.
    solid_angle_ratio : float
        Triangle and rectangle lights are sampled by solid angle from points nearer to their middle than
        this many of their diagonals, and by area from all others. At least 0, which is never.
    robust : bool
        Whether no ray may pass between triangles that share an edge, at a price. Without it about 1 in
        10^7 rays within a closed box escapes.
    fog : Fog, optional
        Between the surfaces; not with a background, suns or an environment.
    exposure : float or "auto"
        With which its pictures are shown and written as PNG, where none is given; see `Image.save`.

    Raises
    ------
    TypeError, ValueError
        A value of the wrong kind or out of its range, which is named; no shape.
    MemoryError
        No memory for Embree's hierarchy.
    sunfleck.Error
        Embree reported an error of its own.

    Notes
    -----
    Construction builds Embree's hierarchy: about 0.4 s per million triangles on two
    processors. Any number of threads may render one scene.

    Examples
    --------
    >>> import sunfleck as sf
    >>> triangle = sf.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> scene = sf.Scene([triangle], sf.Camera((0, 0, 3), (0, 0, 0)), background=(1, 1, 1))
    >>> scene.info.triangle_count
    1
    """

    _quiet = False

    def __init__(
        self,
        meshes: Iterable[Shape],
        camera: Camera,
        background: Sequence[float] = (0.0, 0.0, 0.0),
        max_bounces: int = 5,
        *,
        suns: Iterable[Sun] = (),
        environment: Environment | None = None,
        light_sampling: str = "both",
        light_choice: str = "auto",
        solid_angle_ratio: float = 1.0,
        robust: bool = False,
        fog: Fog | None = None,
        exposure: float | str = 0.0,
    ) -> None:
        self._shapes = _list_of("meshes", meshes, (Mesh, Sphere, Disk, Instances))
        self._suns = _list_of("suns", suns, (Sun,))
        if not isinstance(camera, Camera):
            raise TypeError(f"camera is {camera!r}; give a sunfleck.Camera")
        if not isinstance(environment, (Environment, type(None))):
            raise TypeError(f"environment is {environment!r}; give a sunfleck.Environment")
        if not isinstance(fog, (Fog, type(None))):
            raise TypeError(f"fog is {fog!r}; give a sunfleck.Fog")
        self._camera = camera
        self._environment = environment
        self._background = vector("background", background)
        self._max_bounces = integer("max_bounces", max_bounces, bits=32)
        self._light_sampling = text("light_sampling", light_sampling)
        self._light_choice = text("light_choice", light_choice)
        self._solid_angle_ratio = number("solid_angle_ratio", solid_angle_ratio)
        self._robust = flag("robust", robust)
        self._exposure = exposure_of(exposure)
        self._core = _core.Scene()
        self._add_shapes()
        self._core.set_camera(*camera._values())
        self._core.set_background(self._background)
        self._core.set_max_bounces(self._max_bounces)
        self._core.set_light_sampling(self._light_sampling)
        self._core.set_light_choice(self._light_choice)
        self._core.set_solid_angle_ratio(self._solid_angle_ratio)
        self._core.set_robust(self._robust)
        self._fog = fog
        if fog is not None:
            self._core.set_fog(fog.scattering, fog.absorption, fog.g)
        self._core.commit()
        self._info = SceneInfo(**self._core.info())
        if not self._quiet:
            self._report()

    @classmethod
    def _silent(cls, *arguments: Any, **options: Any) -> Scene:
        """A scene of which nothing is said, nor of its pictures, before `_speak`."""
        scene = cls.__new__(cls)
        scene._quiet = True
        scene.__init__(*arguments, **options)  # type: ignore[misc]
        return scene

    def _speak(self) -> None:
        self._quiet = False
        self._report()

    def _add_shapes(self) -> None:
        prototypes: dict[tuple[int, ...], int] = {}  # by the identity of their meshes
        for shape in self._shapes:
            if isinstance(shape, Mesh):
                self._core.add_mesh(*shape._values())
            elif isinstance(shape, Sphere):
                self._core.add_sphere(*shape._values())
            elif isinstance(shape, Instances):
                which = tuple(id(mesh) for mesh in shape.meshes)
                if which not in prototypes:
                    prototypes[which] = self._core.add_prototype(shape._prototype())
                self._core.add_instances(prototypes[which], shape.transforms, shape.albedos)
            else:
                self._core.add_disk(*shape._values())
        for sun in self._suns:
            self._core.add_sun(*sun._values())
        if self._environment is not None:
            self._core.set_environment(*self._environment._values())

    def _report(self) -> None:
        info = self._info
        if info.degenerate_count:
            _log.info("%d of %d triangles have no area", info.degenerate_count, info.triangle_count)
        if info.copied_bytes:
            _log.debug(
                "%d bytes of mesh arrays were copied: they end with a page or lie far from the origin",
                info.copied_bytes,
            )

    @property
    def meshes(self) -> tuple[Mesh, ...]:
        """Those that are given themselves, not by instances."""
        return tuple(shape for shape in self._shapes if isinstance(shape, Mesh))

    @property
    def shapes(self) -> tuple[Shape, ...]:
        """All of them: meshes, spheres, disks and instances."""
        return self._shapes

    @property
    def suns(self) -> tuple[Sun, ...]:
        return self._suns

    @property
    def environment(self) -> Environment | None:
        return self._environment

    @property
    def light_sampling(self) -> str:
        return self._light_sampling

    @property
    def light_choice(self) -> str:
        return self._light_choice

    @property
    def solid_angle_ratio(self) -> float:
        return self._solid_angle_ratio

    @property
    def robust(self) -> bool:
        return self._robust

    @property
    def fog(self) -> Fog | None:
        return self._fog

    @property
    def exposure(self) -> float | str:
        """Of its pictures, in stops, or "auto"."""
        return self._exposure

    @property
    def camera(self) -> Camera:
        return self._camera

    @property
    def background(self) -> Vector:
        return self._background

    @property
    def max_bounces(self) -> int:
        return self._max_bounces

    @property
    def info(self) -> SceneInfo:
        """What the scene holds: counts, bounds, hash."""
        return self._info

    def plan(self) -> Plan:
        """The stages, sample dimensions and rays that rendering the scene takes.

        Examples
        --------
        >>> import sunfleck as sf
        >>> plan = sf.scenes.penumbra().plan()
        >>> [group.name for group in plan.dimensions]
        ['pixel', 'light 1']
        >>> plan.rays_per_path
        2
        """
        plan: dict[str, Any] = self._core.plan()
        dimensions = [PlanDimensions(*group) for group in plan.pop("dimensions")]
        return Plan(dimensions=dimensions, **plan)

    def __reduce__(self) -> tuple[Any, ...]:
        # Of what the constructor takes, each has an attribute of its name.
        names = list(inspect.signature(Scene).parameters)
        return _make_scene, ({name: self._shapes if name == "meshes" else getattr(self, name) for name in names},)

    def __copy__(self) -> Scene:
        return self

    def __repr__(self) -> str:
        others = [
            f"{count} {name}s, "
            for count, name in (
                (self._info.sphere_count, "sphere"),
                (self._info.disk_count, "disk"),
                (self._info.instance_count, "instance"),
            )
            if count
        ]
        return (
            f"Scene({self._info.mesh_count} meshes, {''.join(others)}{self._info.triangle_count} triangles, "
            f"{self._info.light_count} lights, max_bounces={self._max_bounces})"
        )


def _make_scene(arguments: dict[str, Any]) -> Scene:
    """A scene from what it was made of: what a pickle of one calls."""
    return Scene(**arguments)
