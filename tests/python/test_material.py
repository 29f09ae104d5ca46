# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""material: energy, Fresnel's equations, masking, and that all ways to sample light agree."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import sunfleck as sf
from sunfleck.scene.material import Material

WHITE = (1.0, 1.0, 1.0)


def quad(centre: Any, u: Any, v: Any, **options: Any) -> sf.Mesh:
    """A parallelogram centre ± u ± v, whose front is along u x v."""
    c, u, v = (np.asarray(x, float) for x in (centre, u, v))
    corners = np.array([c - u - v, c + u - v, c + u + v, c - u + v], dtype=np.float32)
    return sf.Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]], dtype=np.uint32), **options)


def looking_down(shapes: list[sf.Mesh], degrees: float = 0.0, **options: Any) -> sf.Scene:
    """At the origin of the plane z = 0, so many degrees off its normal, through a narrow window."""
    angle = np.radians(degrees)
    position = (10 * np.sin(angle), 0.0, 10 * np.cos(angle))
    camera = sf.Camera(position, (0, 0, 0), up=(0, 1, 0), vertical_fov=0.01)
    return sf.Scene(shapes, camera, **options)


def level(scene: sf.Scene, spp: int = 16384, seed: int = 1) -> float:
    return float(sf.render(scene, 4, 4, spp=spp // 16, seed=seed).color.mean())


def fresnel(cosine: float, ior: float) -> float:
    """Of unpolarized light on a smooth dielectric (Fresnel's equations)."""
    inside = np.sqrt(1 - (1 - cosine**2) / ior**2)
    parallel = (ior * cosine - inside) / (ior * cosine + inside)
    perpendicular = (cosine - ior * inside) / (cosine + ior * inside)
    return float((parallel**2 + perpendicular**2) / 2)


@pytest.mark.parametrize("material", [sf.Mirror(), sf.Conductor(0.0), None])
def test_white_furnace_of_what_loses_nothing(material: Material | None) -> None:
    mesh = quad((0, 0, 0), (5, 0, 0), (0, 5, 0), albedo=WHITE, material=material)
    scene = looking_down([mesh], 40, background=WHITE, max_bounces=2)
    assert np.abs(sf.render(scene, 8, 8, spp=64).color - 1).max() < 1e-5  # 64 sums of rounded ones


@pytest.mark.parametrize("degrees", [0, 60])
def test_radiance_shrinks_on_its_way_out_of_glass(degrees: float) -> None:
    """Light as bright inside as outside: what comes out of the glass has 1 / 1.5^2 of its radiance."""
    half = quad((0, 0, 0), (5, 0, 0), (0, 5, 0), albedo=WHITE, material=sf.Dielectric(1.5))
    reflected = fresnel(np.cos(np.radians(degrees)), 1.5)
    got = level(looking_down([half], degrees, background=WHITE, max_bounces=2))
    assert got == pytest.approx(reflected + (1 - reflected) / 1.5**2, abs=5 * np.sqrt(reflected / 16384))


@pytest.mark.parametrize("roughness", [0.0, 0.3])
def test_white_furnace_of_a_pane_of_glass(roughness: float) -> None:
    """Smooth panes lose nothing (of 63 bounces inside F^63 is left out); rough ones lose by masking alone:
    with alpha = 0.09 under 1 % a crossing (the conductor's integral below), and few cross often."""
    front = quad((0, 0, 0), (500, 0, 0), (0, 500, 0), albedo=WHITE, material=sf.Dielectric(1.5, roughness))
    back = quad((0, 0, -1), (500, 0, 0), (0, -500, 0), albedo=WHITE, material=sf.Dielectric(1.5, roughness))
    got = level(looking_down([front, back], background=WHITE, max_bounces=64))
    if roughness == 0:
        assert got == pytest.approx(1, abs=1e-5)
    else:
        assert 0.96 < got <= 1


@pytest.mark.parametrize("degrees", [0, 30, 45, 60, 80])
def test_smooth_glass_reflects_by_fresnel(degrees: float) -> None:
    """Everything on the camera's side shines 1, below is black. 16,384 choices with probability F: the
    mean is within 5 sqrt(F (1 - F) / 16384), and a stratified choice does better."""
    half = quad((0, 0, 0), (5, 0, 0), (0, 5, 0), albedo=WHITE, material=sf.Dielectric(1.5))
    sky = quad((0, 0, 50), (1000, 0, 0), (0, -1000, 0), albedo=(0, 0, 0), emission=WHITE)
    got = level(looking_down([half, sky], degrees, max_bounces=1))
    expected = fresnel(np.cos(np.radians(degrees)), 1.5)
    assert got == pytest.approx(expected, abs=5 * np.sqrt(expected / 16384))


def test_total_internal_reflection() -> None:
    """From inside, beyond asin(1 / 1.5) = 41.8 degrees, nothing leaves."""
    half = quad((0, 0, 0), (5, 0, 0), (0, -5, 0), albedo=WHITE, material=sf.Dielectric(1.5))  # its inside is up
    beyond = quad((0, 0, -50), (1000, 0, 0), (0, 1000, 0), albedo=(0, 0, 0), emission=WHITE)  # shines up
    assert level(looking_down([half, beyond], 45, max_bounces=1)) == 0
    assert level(looking_down([half, beyond], 35, max_bounces=1)) > 0.5


@pytest.mark.parametrize("roughness", [0.3, 0.6, 0.8])
def test_a_conductor_loses_what_its_masking_says(roughness: float) -> None:
    """Seen along the normal, the visible normals h have tan = alpha sqrt(u / (1 - u)) and are never
    masked; the mirrored direction, at twice the angle, is seen with probability G1 (Heitz 2014)."""
    alpha = roughness**2
    u = (np.arange(200_000) + 0.5) / 200_000
    twice = 2 * np.arctan(alpha * np.sqrt(u / (1 - u)))
    above = twice < np.pi / 2
    tangent = np.tan(np.where(above, twice, 0))
    expected = np.mean(np.where(above, 2 / (1 + np.sqrt(1 + (alpha * tangent) ** 2)), 0))
    mesh = quad((0, 0, 0), (5, 0, 0), (0, 5, 0), albedo=WHITE, material=sf.Conductor(roughness))
    got = level(looking_down([mesh], background=WHITE, max_bounces=1))
    assert got == pytest.approx(expected, abs=5 * 0.5 / 128)  # a spread of at most 1/2 over 16,384 samples


@pytest.mark.parametrize("material", [None, sf.Conductor(0.5), sf.Dielectric(1.5, 0.5)])
def test_light_sampling_surface_sampling_and_both_agree(material: Material | None) -> None:
    """A lamp over the surface, seen at 30 degrees by three estimators of one integral."""
    shapes = [
        quad((0, 0, 0), (5, 0, 0), (0, 5, 0), albedo=(0.9,) * 3, material=material),
        quad((-2, 0, 3), (1, 0, 0), (0, -1, 0), albedo=(0, 0, 0), emission=WHITE),
    ]
    means, errors = [], []
    for way in ("both", "light", "surface"):
        scene = looking_down(shapes, 30, max_bounces=1, light_sampling=way)
        runs = [level(scene, 65536, seed) for seed in range(8)]
        means.append(np.mean(runs))
        errors.append(np.std(runs, ddof=1) / np.sqrt(8))
    for mean, error in zip(means[1:], errors[1:], strict=True):
        assert abs(mean - means[0]) < 5.4 * np.hypot(error, errors[0])  # t of 7 degrees, 1 in 1,000
    assert means[0] > 100 * errors[0]


def test_light_in_a_mirror_is_one_bounce() -> None:
    mirror = quad((0, 0, 0), (5, 0, 0), (0, 5, 0), albedo=(0.5,) * 3, material=sf.Mirror())
    lamp = quad((0, 0, 20), (9, 0, 0), (0, -9, 0), albedo=(0, 0, 0), emission=WHITE)
    assert level(looking_down([mirror, lamp], max_bounces=0), 16) == 0
    assert level(looking_down([mirror, lamp], max_bounces=1), 16) == pytest.approx(0.5, abs=1e-6)


def test_diffuse_scenes_do_not_plan_for_materials() -> None:
    diffuse = quad((0, 0, 0), (5, 0, 0), (0, 5, 0))
    assert "scatter" not in looking_down([diffuse], background=WHITE).plan().stages
    glass = quad((0, 0, 0), (5, 0, 0), (0, 5, 0), material=sf.Dielectric(1.5))
    plan = looking_down([glass], background=WHITE, max_bounces=1).plan()
    assert "scatter" in plan.stages
    assert [d.use for d in plan.dimensions] == ["pixel", "lobe"]  # smooth glass has one choice to make


def test_threads_change_no_bit() -> None:
    glass = quad((0, 0, 0), (5, 0, 0), (0, 5, 0), material=sf.Dielectric(1.5, 0.4))
    metal = quad((0, 0, -1), (5, 0, 0), (0, 5, 0), albedo=(0.9, 0.6, 0.3), material=sf.Conductor(0.4))
    camera = sf.Camera((0, -8, 6), (0, 0, 0), up=(0, 0, 1))
    scene = sf.Scene([glass, metal], camera, background=WHITE, max_bounces=6)
    films = [sf.render(scene, 40, 30, spp=32, threads=threads).color for threads in (1, 2, 3)]
    assert np.array_equal(films[0], films[1])
    assert np.array_equal(films[0], films[2])


@pytest.mark.parametrize("beside", [None, sf.Conductor(roughness=0.5), sf.Dielectric(1.5, roughness=0.3)])
@pytest.mark.parametrize("lamp", ["sphere", "disk", "rectangle", "triangle"])
def test_a_lamp_is_not_lit_by_itself(lamp: str, beside: sf.Conductor | sf.Dielectric | None) -> None:
    more: dict[str, Any] = {"albedo": (0.7, 0.7, 0.7), "emission": (1, 1, 1)}
    corners = [[-73, -100, 41], [-33, -100, 41], [-33, -60, 41], [-73, -60, 41]]
    shapes: dict[str, Any] = {
        "sphere": sf.Sphere((-53, -80, 41), 16, **more),
        "disk": sf.Disk((-53, -80, 41), (0, 0, 1), 16, **more),
        "rectangle": sf.Mesh(corners, [[0, 1, 2], [0, 2, 3]], **more),
        "triangle": sf.Mesh([*corners[:2], [-53, -40, 41]], [[0, 1, 2]], **more),
    }
    far = sf.Mesh([[80, 20, -110], [90, -30, -80], [110, 30, -60]], [[0, 1, 2]], albedo=(0, 0, 0), material=beside)
    camera = sf.Camera((-51, -78, 60), (-53, -80, 41), up=(0, 1, 0), vertical_fov=4)
    for sampling in ("both", "light"):
        scene = sf.Scene([shapes[lamp], far], camera, max_bounces=1, light_sampling=sampling)
        assert np.array_equal(sf.render(scene, 8, 8, spp=64).color, np.ones((8, 8, 3)))
