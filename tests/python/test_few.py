# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Scenes of few primitives sort their surface rays: the paths stay what they are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

import sunfleck as sf
from sunfleck.scene.material import Material

MANY = 100  # more than are few, by csrc/scene/scene.c


def specks() -> sf.Mesh:
    """Triangles within the taller box of the Cornell box, where no path comes."""
    corner = np.random.default_rng(1).uniform((-0.4, -0.5, -0.4), (-0.3, -0.3, -0.2), (MANY, 1, 3))
    vertices = corner + 1e-2 * np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    return sf.Mesh(vertices.reshape(-1, 3), np.arange(3 * MANY).reshape(-1, 3))


def furnished(materials: dict[int, Material]) -> list[sf.Mesh | sf.Sphere]:
    meshes: list[sf.Mesh | sf.Sphere] = []
    for k, mesh in enumerate(sf.scenes.cornell().meshes):
        material = materials.get(k)
        albedo = (0.9, 0.9, 0.9) if k in materials else mesh.albedo
        meshes.append(sf.Mesh(mesh.vertices, mesh.triangles, albedo, mesh.emission, material=material))
    return meshes


ROOMS: dict[str, Sequence[sf.Mesh | sf.Sphere]] = {
    "diffuse": furnished({}),
    "materials": furnished({3: sf.Conductor(0.2), 5: sf.Dielectric(1.5), 6: sf.Conductor(0)}),
    "rough": furnished({0: sf.Conductor(0.4), 5: sf.Dielectric(1.5, roughness=0.3)}),
    "spheres": [*furnished({}), sf.Sphere((0.3, 0.2, 0.3), 0.3, (1, 1, 1), material=sf.Dielectric(1.5))],
}


def picture(meshes: Sequence[sf.Mesh | sf.Sphere], sky: bool, roulette: int, spp: int) -> np.ndarray:
    environment = sf.Environment(np.random.default_rng(0).random((8, 16, 3), np.float32)) if sky else None
    scene = sf.Scene(meshes, sf.scenes.cornell().camera, max_bounces=5, environment=environment)
    return np.asarray(sf.render(scene, 48, 48, spp=spp, seed=3, roulette=roulette).color)


@pytest.mark.parametrize("room", ROOMS)
@pytest.mark.parametrize(("sky", "roulette", "spp"), [(False, 0, 24), (True, 0, 16), (False, 2, 5)])
def test_sorted_rays_are_the_same_paths(room: str, sky: bool, roulette: int, spp: int) -> None:
    """But for rays through the seams of triangles: Embree's answers there hang on how it was asked."""
    few = picture(ROOMS[room], sky, roulette, spp)
    many = picture([*ROOMS[room], specks()], sky, roulette, spp)
    assert np.isfinite(few).all()
    assert (few != many).any(axis=2).mean() < 2e-3
    assert few.mean() == pytest.approx(many.mean(), rel=1e-4)
