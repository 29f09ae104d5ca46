# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Random small scenes over all that a scene can hold, with counts on both sides of every threshold.

A `World` is plain data, from which `Scene` objects of the library and the tables of the reference are made. Lights and
roughnesses are bounded below where paths could find a light by a narrow lobe alone: such light comes as few and
bright samples, which no test of means can judge.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

import sunfleck as sf

Array = NDArray[np.float64]

LIGHT_COUNTS = (0, 1, 2, 3, 6, 7, 8, 9, 10, 15, 16, 17, 24)  # 8: the tree; 16: those asked for nearness
PRIMITIVE_COUNTS = (8, 14, 20, 30, 40, 63, 64, 65, 66, 90)  # 64: rays are sorted for their packets
IDENTITY = np.eye(3, 4)


@dataclass
class Surface:
    """What `sf.Mesh` and the shapes share."""

    albedo: tuple[float, float, float]
    emission: tuple[float, float, float] = (0.0, 0.0, 0.0)
    material: Any = None


@dataclass
class Item:
    """A mesh, sphere or disk; a mesh with transforms is placed by them as an instance."""

    kind: str
    surface: Surface
    vertices: Array | None = None
    triangles: NDArray[np.uint32] | None = None
    center: Array | None = None
    normal: Array | None = None
    radius: float = 0.0
    transforms: NDArray[np.float32] | None = None
    albedos: NDArray[np.float32] | None = None
    group: int = 0  # items of one group above 0 are placed together


@dataclass
class World:
    """A scene as data."""

    items: list[Item]
    camera: dict[str, Any]
    background: tuple[float, float, float] = (0.0, 0.0, 0.0)
    suns: list[dict[str, Any]] = field(default_factory=list)
    environment: dict[str, Any] | None = None
    fog: dict[str, float] | None = None
    max_bounces: int = 3
    story: str = ""

    @property
    def primitives(self) -> int:
        count = 0
        for item in self.items:
            placed = 1 if item.transforms is None else len(item.transforms)
            count += placed * (1 if item.triangles is None else len(item.triangles))
        return count

    def scene(self, **choices: Any) -> sf.Scene:
        """The library's scene; `choices` are those that change no picture's mean."""
        shapes: list[Any] = []
        groups: dict[int, list[Item]] = {}
        for item in self.items:
            if item.kind == "mesh" and item.group:
                groups.setdefault(item.group, []).append(item)
            elif item.kind == "mesh":
                shapes.append(_mesh(item))
            elif item.kind == "sphere":
                shapes.append(sf.Sphere(_three(item.center), item.radius, **vars(item.surface)))
            else:
                shapes.append(sf.Disk(_three(item.center), _three(item.normal), item.radius, **vars(item.surface)))
        for members in groups.values():
            meshes, transforms = [_mesh(item) for item in members], members[0].transforms
            assert transforms is not None
            shapes.append(sf.Instances(meshes, transforms, members[0].albedos))
        return sf.Scene(
            shapes,
            sf.Camera(**self.camera),
            self.background,
            self.max_bounces,
            suns=[sf.Sun(**sun) for sun in self.suns],
            environment=sf.Environment(**self.environment) if self.environment else None,
            fog=sf.Fog(**self.fog) if self.fog else None,
            **choices,
        )


def _mesh(item: Item) -> sf.Mesh:
    assert item.vertices is not None
    assert item.triangles is not None
    return sf.Mesh(item.vertices.astype(np.float32), item.triangles, **vars(item.surface))


def _three(value: Array | None) -> tuple[float, float, float]:
    assert value is not None
    return float(value[0]), float(value[1]), float(value[2])


# ---- shapes ----


def _rotation(rng: np.random.Generator) -> Array:
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return np.asarray(q * np.sign(np.linalg.det(q)))


def _quad(center: Array, u: Array, v: Array) -> tuple[Array, NDArray[np.uint32]]:
    corners = np.array([center - u - v, center + u - v, center + u + v, center - u + v])
    return corners, np.array([[0, 1, 2], [0, 2, 3]], dtype=np.uint32)


BOX_FACES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))


def box(center: Array, half: Array, turn: Array, inward: bool = False) -> tuple[Array, NDArray[np.uint32]]:
    corners = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], dtype=float) * half
    faces = [(a, b, c) for a, b, c, d in BOX_FACES] + [(a, c, d) for a, b, c, d in BOX_FACES]
    triangles = np.array(faces, dtype=np.uint32)
    return corners @ turn.T + center, triangles[:, ::-1].copy() if inward else triangles


TETRAHEDRON = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], dtype=float)
TETRAHEDRON_FACES = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]], dtype=np.uint32)


class Maker:
    """Draws a world. Lengths are of a stage of some 2 units about the origin, z up, until `finish`.

    One in five is a room of large lamps, from one below the count that makes a tree of lights, where rays that
    materials chose often hit a lamp: the weights by which both ways of finding light are combined matter most there.
    """

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng([seed, 0x5CE9E])
        self.items: list[Item] = []
        rng = self.rng
        self.room = rng.random() < 0.45
        self.fogged = rng.random() < 0.2
        self.bounces = int(rng.choice([0, 1, 2, 3, 4, 6], p=[0.04, 0.2, 0.26, 0.25, 0.15, 0.1]))
        self.narrow = rng.random() < 0.4  # smooth and glossy surfaces; lights are large then
        self.rough_only = rng.random() < 0.25
        self.lamp_room = rng.random() < 0.2
        if self.lamp_room:
            self.room, self.fogged, self.narrow = True, False, False
            self.bounces = max(self.bounces, 2)

    def pick(self, *values: Any) -> Any:
        return values[int(self.rng.integers(len(values)))]

    # -- surfaces --

    def color(self, low: float, high: float) -> tuple[float, float, float]:
        if self.rng.random() < 0.3:
            return (float(self.rng.uniform(low, high)),) * 3
        a, b, c = self.rng.uniform(low, high, 3)
        return float(a), float(b), float(c)

    def surface(self, closed: bool = False) -> Surface:
        rng = self.rng
        if not (self.narrow or self.rough_only) or rng.random() < 0.5:
            return Surface(self.pick(self.color(0.2, 0.85), self.color(0.2, 0.85), (0.0, 0.0, 0.0)))
        roughness = (
            float(rng.uniform(0.5, 1)) if self.rough_only else self.pick(0.0, 0.005, float(rng.uniform(0.45, 1)))
        )
        ior = self.pick(1.33, 1.5, 1.8, 1 / 1.4, 2.4)
        glass = sf.Dielectric(ior, roughness)
        kinds: list[Any] = [sf.Conductor(roughness), glass]
        if not self.rough_only:
            kinds.append(sf.Mirror())
        if closed:
            kinds.append(glass)
        return Surface(self.color(0.5, 0.98), material=self.pick(*kinds))

    # -- what reflects --

    def add_mesh(self, shape: tuple[Array, NDArray[np.uint32]], surface: Surface) -> None:
        self.items.append(Item("mesh", surface, shape[0], shape[1]))

    def spot(self, reach: float = 0.8) -> Array:
        place = self.rng.uniform(-reach, reach, 3)
        place[2] = self.rng.uniform(-0.75, 0.35)
        return np.asarray(place)

    def add_walls(self) -> None:
        rng = self.rng
        if self.room:
            shape = box(np.zeros(3), np.array([1.3, 1.3, 1.0]), np.eye(3), inward=True)
            self.add_mesh(shape, Surface(self.color(0.3, 0.8)))
            return
        z = np.array([0, 0, -0.9 + 0.05 * rng.random()])
        self.add_mesh(_quad(z, np.array([1.6, 0, 0]), np.array([0, 1.6, 0])), Surface(self.color(0.3, 0.8)))

    def add_thing(self, room_left: int) -> int:
        """One object of at most so many primitives; returns how many it has."""
        rng = self.rng
        kind = self.pick("box", "ball", "disk", "triangle", "quad", "tetrahedron", "ball")
        size, center = float(rng.uniform(0.12, 0.4)), self.spot()
        if kind == "box" and room_left >= 12:
            self.add_mesh(box(center, size * rng.uniform(0.5, 1, 3), _rotation(rng)), self.surface(True))
            return 12
        if kind == "tetrahedron" and room_left >= 4:
            self.add_mesh((center + size * TETRAHEDRON @ _rotation(rng).T, TETRAHEDRON_FACES), self.surface(True))
            return 4
        if kind == "ball":
            self.items.append(Item("sphere", self.surface(True), center=center, radius=size))
            return 1
        if kind == "disk":
            self.items.append(Item("disk", self.surface(), center=center, normal=rng.normal(size=3), radius=size))
            return 1
        if kind == "quad" and room_left >= 2:
            turn = size * _rotation(rng)
            self.add_mesh(_quad(center, turn[0], turn[1] * rng.uniform(0.5, 1.2)), self.surface())
            return 2
        corners = center + size * rng.normal(size=(3, 3))
        self.add_mesh((corners, np.array([[0, 1, 2]], dtype=np.uint32)), self.surface())
        return 1

    def add_instances(self, group: int) -> None:
        rng = self.rng
        count = int(rng.integers(1, 6))
        transforms = np.zeros((count, 3, 4))
        for t in transforms:
            scale = np.diag(rng.uniform(0.5, 1.5, 3)) if rng.random() < 0.5 else np.eye(3) * rng.uniform(0.4, 1.6)
            scale = scale * np.array([self.pick(-1, 1), 1, 1]) if rng.random() < 0.5 else scale
            t[:, :3] = _rotation(rng) @ scale @ (_rotation(rng) if rng.random() < 0.5 else np.eye(3))
            t[:, 3] = self.spot(0.9)
        albedos = rng.uniform(0.2, 0.9, (count, 3)) if rng.random() < 0.4 else None
        for k in range(int(rng.integers(1, 3))):
            size = float(rng.uniform(0.1, 0.22))
            shape = (size * TETRAHEDRON, TETRAHEDRON_FACES)
            if rng.random() < 0.5:
                shape = box(np.zeros(3), size * rng.uniform(0.5, 1, 3), np.eye(3))
            surface = self.surface(True)
            if k == 1 and rng.random() < 0.6:
                shape = _quad(np.array([0, 0, 0.3]), np.array([self.lamp_size(), 0, 0]), np.array([0, 0.12, 0]))
                surface = Surface((0.2, 0.2, 0.2), self.color(0.5, 3))
            self.items.append(Item("mesh", surface, *shape, group=group))
        for item in self.items:
            if item.group == group:
                item.transforms = transforms.astype(np.float32)
                item.albedos = None if albedos is None else albedos.astype(np.float32)

    # -- what shines --

    def lamp_size(self) -> float:
        low = 0.25 if self.narrow or self.lamp_room else 0.05
        return float(self.rng.uniform(low, 0.4))

    def add_lamp(self, kind: str, share: float) -> None:
        rng = self.rng
        size = self.lamp_size()
        center = np.append(rng.uniform(-0.9, 0.9, 2), rng.uniform(0.45, 0.85))
        if rng.random() < 0.2:
            center = self.spot()
        turn = _rotation(rng)
        if turn[2] @ center > 0 and rng.random() < 0.8:  # mostly towards the middle
            turn[1:] *= -1
        area = {"triangle": 1.3, "rectangle": 4, "disk": math.pi, "sphere": math.pi}[kind] * size * size
        emission = tuple(float(e) * share * float(rng.uniform(0.2, 2)) / area for e in self.color(0.3, 1.5))
        albedo = self.pick((0.0, 0.0, 0.0), self.color(0.2, 0.8))
        surface = Surface(albedo, emission, self.pick(None, None, None, sf.Conductor(0.6)))  # type: ignore[arg-type]
        if kind == "sphere":
            self.items.append(Item("sphere", surface, center=center, radius=size / 2))
        elif kind == "disk":
            self.items.append(Item("disk", surface, center=center, normal=turn[2], radius=size))
        elif kind == "rectangle":
            self.add_mesh(_quad(center, size * turn[0], size * turn[1]), surface)
        else:
            corners = center + size * np.array(
                [turn[0], -0.5 * turn[0] + 0.87 * turn[1], -0.5 * turn[0] - 0.87 * turn[1]]
            )
            self.add_mesh((corners, np.array([[0, 1, 2]], dtype=np.uint32)), surface)

    def sky(self, count: int) -> dict[str, Any]:
        rng = self.rng
        out: dict[str, Any] = {"suns": [], "background": (0.0, 0.0, 0.0), "environment": None}
        if self.fogged:
            return out
        if rng.random() < 0.35 or (count == 0 and not self.room):
            out["background"] = self.color(0.05, 0.6)
        for _ in range(self.pick(0, 0, 0, 1, 2)):
            angle = self.pick(0.0, 0.265, 5.0, 20.0, 60.0) if not self.narrow else self.pick(0.0, 15.0, 40.0)
            direction = _three(np.append(rng.normal(size=2), rng.uniform(0.2, 2)))
            out["suns"].append({"direction": direction, "angular_radius": angle, "irradiance": self.color(0.3, 2)})
        if rng.random() < 0.3:
            height, width = self.pick((1, 1), (2, 3), (4, 8), (7, 12))
            picture = rng.uniform(0, 1, (height, width, 3)) ** 2
            if rng.random() < 0.5 and height > 2 and not self.narrow:  # one patch has most: a narrow light
                picture *= 0.05
                picture[rng.integers(height - 1), rng.integers(width)] = rng.uniform(3, 12, 3)
            up = _three(rng.normal(size=3)) if rng.random() < 0.5 else self.pick((0.0, 0.0, 1.0), (0.0, 1.0, 0.0))
            out["environment"] = {
                "image": picture.astype(np.float32),
                "up": up,
                "rotation": float(rng.uniform(-400, 400)),
            }
        return out

    # -- the whole --

    def camera(self) -> dict[str, Any]:
        rng = self.rng
        aim = rng.uniform(-0.3, 0.3, 3)
        way = np.append(rng.normal(size=2), rng.uniform(0.0, 0.6))
        way *= (1.0 if self.room else float(rng.uniform(2.0, 3.2))) / np.linalg.norm(way)
        out = {"position": way + aim, "target": aim, "up": self.pick(np.array([0.0, 0, 1]), rng.normal(size=3))}
        out["vertical_fov"] = float(rng.uniform(50, 90) if self.room else rng.uniform(25, 60))
        if rng.random() < 0.3:
            out["aperture_radius"] = float(rng.uniform(0.01, 0.15))
            out["focus_distance"] = self.pick(None, float(rng.uniform(0.5, 3)))
        return out

    def make(self) -> World:
        rng = self.rng
        wanted = int(self.pick(*PRIMITIVE_COUNTS))
        lights = int(self.pick(*(n for n in LIGHT_COUNTS if not self.lamp_room or 7 <= n <= 16)))
        self.add_walls()
        placed = rng.random() < 0.25 and not self.lamp_room
        for group in range(1, int(rng.integers(1, 3)) + 1 if placed else 1):
            self.add_instances(group)
        sky = self.sky(lights)
        outer = len(sky["suns"]) + (sky["environment"] is not None)
        kinds = self.pick(("triangle",), ("rectangle",), ("triangle", "rectangle"), ("sphere",), ("disk",),
                          ("triangle", "rectangle", "sphere", "disk"))  # fmt: skip
        own = max(int(self.room or self.fogged), lights - outer * int(rng.integers(2) and not self.lamp_room))
        for _ in range(own):
            self.add_lamp(self.pick(*kinds), 1 / own)
        count = World(self.items, {}).primitives
        while count < wanted:
            count += self.add_thing(wanted - count)
        if rng.random() < 0.05:  # a triangle without area
            self.add_mesh((np.zeros((3, 3)), np.array([[0, 1, 2]], dtype=np.uint32)), Surface((0.5, 0.5, 0.5)))
        fog = None
        if self.fogged:
            fog = {"scattering": self.pick(0.0, 0.1, 0.4, 1.0), "absorption": self.pick(0.0, 0.1, 0.3)}
            fog["scattering"] += 0.05 * (fog["scattering"] + fog["absorption"] == 0)
            fog["g"] = self.pick(0.0, 0.7, -0.6, float(rng.uniform(-0.8, 0.8)))
        order = rng.permutation(len(self.items))
        world = World([self.items[i] for i in order], self.camera(), fog=fog, max_bounces=self.bounces, **sky)
        self.finish(world)
        flags = [
            name
            for name, on in (
                ("room", self.room),
                ("large lamps", self.lamp_room),
                ("fog", fog),
                ("instances", placed),
            )
            if on
        ]
        world.story = (
            f"{world.primitives} primitives, {own} lamps ({'/'.join(kinds)}), {len(sky['suns'])} suns, "
            f"{'an environment, ' if sky['environment'] else ''}{'a background, ' if any(sky['background']) else ''}"
            f"bounces {self.bounces}{''.join(', ' + f for f in flags)}"
            + f"{', lens' if world.camera.get('aperture_radius') else ''}"
            + f"{', narrow lobes' if self.narrow else ', rough' if self.rough_only else ''}"
        )
        return world

    def finish(self, world: World) -> None:
        """Scales and moves the whole, and rounds all to single precision, which both sides then share."""
        rng = self.rng
        scale = float(2.0 ** rng.integers(-12, 13)) if rng.random() < 0.2 else 1.0
        shift = rng.uniform(-60, 60, 3) if rng.random() < 0.15 else np.zeros(3)

        def moved(x: Array) -> Array:
            return np.asarray((scale * (x + shift)).astype(np.float32).astype(float))

        def sized(x: float) -> float:
            return float(np.float32(scale * x))

        for item in world.items:
            if item.transforms is not None and item.vertices is not None:
                item.vertices = item.vertices.astype(np.float32).astype(float)
            elif item.vertices is not None:
                item.vertices = moved(item.vertices)
            if item.center is not None:
                item.center = moved(item.center)
                item.radius = sized(item.radius)
        for group in {item.group for item in world.items} - {0}:
            members = [item for item in world.items if item.group == group]
            transforms = members[0].transforms
            assert transforms is not None
            placed = transforms.astype(float)
            placed[:, :, 3] += shift
            for item in members:
                item.transforms = (scale * placed).astype(np.float32)
        c = world.camera
        c["position"], c["target"] = _three(moved(c["position"])), _three(moved(c["target"]))
        c["up"] = _three(c["up"])
        for name in ("aperture_radius", "focus_distance"):
            if c.get(name):
                c[name] = sized(c[name])
        if world.fog:
            world.fog["scattering"] /= scale
            world.fog["absorption"] /= scale


def random_world(seed: int) -> World:
    """The world of a seed: the same on every machine with the same NumPy."""
    return Maker(seed).make()
