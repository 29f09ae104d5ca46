# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""lamp: files whose own light leaves dark what the camera sees get one that does not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sunfleck as sf
from gltf_files import CAMERA, SQUARE, WHITE, box, glow, write_gltf

CUBE = box((-0.5, 0, -0.5), (0.5, 1, 0.5))
ROOM = box((-3, 0, -4), (3, 3, 4))


def looking(position: Any, target: Any) -> dict[str, Any]:
    """A node with the first camera."""
    back = np.subtract(position, target) / np.linalg.norm(np.subtract(position, target))
    right = np.cross((0, 1, 0), back)
    right /= np.linalg.norm(right)
    matrix = np.eye(4)
    matrix[:3] = np.stack([right, np.cross(back, right), back, position], axis=1)
    return {"camera": 0, "matrix": matrix.T.ravel().tolist()}


def lit_share(scene: sf.Scene) -> float:
    """Of the pixels that show a surface, those that are clearly not black, in a picture of direct light alone."""
    direct = sf.Scene(scene.shapes, scene.camera, max_bounces=1, suns=scene.suns)
    image = sf.render(direct, 48, 48, spp=32)
    assert image.alpha.any()
    return float((image.color.mean(axis=-1)[image.alpha > 0.5] > 0.02).mean())


@pytest.mark.parametrize("angle", range(0, 360, 40))
@pytest.mark.parametrize("away", [1.2, 3, 12])
def test_what_the_file_s_own_camera_sees_is_lit(tmp_path: Path, angle: int, away: float) -> None:
    turn = np.radians(angle)
    nodes = [{"mesh": 0}, looking((away * np.sin(turn), 1.2, away * np.cos(turn)), (0, 0.5, 0))]
    scene = sf.load(write_gltf(tmp_path, [(*CUBE, 0)], nodes, cameras=[CAMERA]))
    assert lit_share(scene) > 0.6
    # The lamp is not in the picture: all that is seen is the cube.
    seen = sf.render(sf.Scene(scene.meshes[-1:], scene.camera, max_bounces=0), 32, 32, spp=4)
    assert not seen.alpha.any()


@pytest.mark.parametrize("normal", range(3))
@pytest.mark.parametrize("turned", [False, True])
def test_a_single_sheet_is_lit_whichever_way_it_faces(tmp_path: Path, normal: int, turned: bool) -> None:
    vertices = np.roll(np.array(SQUARE[0], float), normal, axis=1)
    triangles = np.array(SQUARE[1])[:, :: -1 if turned else 1]
    assert lit_share(sf.load(write_gltf(tmp_path, [(vertices, triangles, 0)]))) > 0.9


@pytest.mark.parametrize("position", [(0, 1.5, 2), (-2.9, 1.5, 3.9), (0, 2.95, 3), (2.5, 0.1, -3.5)])
def test_a_closed_room_is_lit_from_within(tmp_path: Path, position: Any) -> None:
    nodes = [{"mesh": 0}, {"mesh": 1}, looking(position, (0, 1, 0))]
    scene = sf.load(write_gltf(tmp_path, [(*ROOM, 0), (*CUBE, 0)], nodes, cameras=[CAMERA]))
    lamp = scene.meshes[-1].vertices
    assert ((lamp > (-3, 0, -4)) & (lamp < (3, 3, 4))).all()
    assert lit_share(scene) > 0.4
    seen = sf.render(scene, 24, 24, spp=64)
    assert (seen.color.mean(axis=-1) > 0.01).all()


def test_a_small_part_that_glows_is_no_light(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    led = box((0.49, 0.9, 0.5), (0.5, 0.91, 0.51))
    path = write_gltf(tmp_path, [(*CUBE, 0), (*led, 1)], (), [WHITE, glow(1)])
    with caplog.at_level("INFO", "sunfleck"):
        scene = sf.load(path)
    assert len(scene.meshes) == 3
    assert "% of what the camera sees; a square of side" in caplog.text
    assert lit_share(scene) > 0.6


def test_a_lamp_of_the_file_s_own_is_enough(tmp_path: Path) -> None:
    lamp = (np.add(SQUARE[0], (0, 3, 0)), np.array(SQUARE[1])[:, ::-1])
    scene = sf.load(write_gltf(tmp_path, [(*SQUARE, 0), (*CUBE, 0), (*lamp, 1)], (), [WHITE, glow(5)]))
    assert len(scene.meshes) == 3


def test_a_model_that_glows_needs_no_lamp(tmp_path: Path) -> None:
    assert len(sf.load(write_gltf(tmp_path, [(*CUBE, 0)], (), [glow(1)])).meshes) == 1


def test_suns_and_environments_are_taken_as_they_are(tmp_path: Path) -> None:
    sky = sf.Environment(np.ones((2, 4, 3), np.float32))
    assert len(sf.load(write_gltf(tmp_path, [(*CUBE, 0)]), environment=sky).meshes) == 1
    node = {"extensions": {"KHR_lights_punctual": {"light": 0}}}
    lights = {"KHR_lights_punctual": {"lights": [{"type": "directional"}]}}
    assert len(sf.load(write_gltf(tmp_path, [(*CUBE, 0)], [{"mesh": 0}, node], extensions=lights)).meshes) == 1


@pytest.mark.parametrize("looks", [0, 1, 2])
def test_ctrl_c_in_a_look_ends_the_loading(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, looks: int) -> None:
    """A render takes the signal itself and returns the picture so far; here it is stopped as if by one."""
    done = []

    def stopped(scene: sf.Scene, width: int, height: int, **options: Any) -> sf.Image:
        done.append(scene)
        if len(done) <= looks:
            return sf.render(scene, width, height, **options)
        return sf.render(scene, width, height, **{**options, "spp": 2**20}, progress=lambda _: False)

    path = write_gltf(tmp_path, [(*ROOM, 0)], [{"mesh": 0}, looking((0, 1.5, 2), (0, 1, 0))], cameras=[CAMERA])
    monkeypatch.setattr("sunfleck.io.lamp.render", stopped)
    with pytest.raises(KeyboardInterrupt):
        sf.load(path)
    assert len(done) == looks + 1


def test_glass_and_mirrors_are_seen_through_and_counted(tmp_path: Path) -> None:
    """A cube in a glass box: the lamp stands outside, and what is in the box is lit through it."""
    glass = {
        "pbrMetallicRoughness": {"metallicFactor": 0},
        "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}},
    }
    case = box((-0.6, -0.1, -0.6), (0.6, 1.1, 0.6))
    scene = sf.load(write_gltf(tmp_path, [(*CUBE, 0), (*case, 1)], (), [WHITE, glass]))
    assert scene.meshes[-1].emission == (10, 10, 10)
    assert np.linalg.norm(scene.meshes[-1].vertices.mean(axis=0)) > 2
    only = sf.load(write_gltf(tmp_path, [(*case, 0)], (), [glass]))
    assert len(only.meshes) == 2
