# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""pickle: what the library hands out is copied and comes back from other processes as it was."""

import copy
import inspect
import pickle
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

import numpy as np
import pytest

import sunfleck as sf
from sunfleck.qmc import Engine

SQUARE = sf.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]], albedo=(0.2, 0.4, 0.6))
CAMERA = sf.Camera((0, 0, 3), (0, 0, 0), vertical_fov=50, aperture_radius=0.1)


def every_kind() -> dict[str, Any]:
    moments, vectors = sf.Moments(), sf.VectorMoments()
    moments.add([1, 2, 4])
    vectors.add([[1, 2, 4]])
    scene = sf.scenes.penumbra()
    seen: list[sf.Progress] = []
    image = sf.render(scene, 12, 9, spp=4, aovs=["albedo"], progress=seen.append)
    return {
        "Scene": sf.Scene(
            [SQUARE, sf.Sphere((0, 0, 1), 0.2, emission=(1, 2, 3)), sf.Instances(SQUARE, np.eye(4)[None, :3])],
            CAMERA,
            max_bounces=2,
            suns=[sf.Sun((0, 0, -1), irradiance=(1, 1, 1))],
            light_choice="tree",
            robust=True,
            exposure=1.5,
        ),
        "Image": image,
        "CheckpointError": sf.CheckpointError("full", image),
        "Error": sf.Error("of Embree"),
        "Summary": image.summary(),
        "Progress": seen[0],
        "Plan": scene.plan(),
        "SceneInfo": scene.info,
        "Camera": CAMERA,
        "Mesh": SQUARE,
        "Sphere": sf.Sphere((0, 0, 1), 0.2),
        "Disk": sf.Disk((0, 0, 1), (0, 0, 1), 0.2),
        "Instances": sf.Instances(SQUARE, np.eye(4)[None, :3]),
        "Sun": sf.Sun((0, 0, -1), irradiance=(1, 1, 1)),
        "Environment": sf.Environment(np.ones((2, 4, 3), np.float32)),
        "Fog": sf.Fog(0.5),
        "Dielectric": sf.Dielectric(),
        "Tolerance": sf.Tolerance(relative=0.1),
        "Limits": sf.Limits(),
        "Rng": sf.Rng("mt19937", seed=1),
        "BitGenerator": sf.Rng("pcg32", seed=1).bit_generator,
        "Moments": moments,
        "VectorMoments": vectors,
        "BatchMeans": sf.BatchMeans(4),
        "ConfidenceSequence": sf.ConfidenceSequence(0, 1),
        "AliasTable": sf.AliasTable([1, 0, 3]),
        "PiecewiseConstant1D": sf.PiecewiseConstant1D([1, 3]),
        "PiecewiseConstant2D": sf.PiecewiseConstant2D([[1, 0], [0, 3]]),
        "Integral": sf.integrate(lambda u: u[:, 0], d=1),
        "Engine": Engine("sobol", 2, seed=1),
    }


KINDS = every_kind()


def fingerprint(value: Any) -> Any:
    """What two things that are the same have in common."""
    if isinstance(value, sf.Scene):
        return value.info, value.plan(), value.camera, value.light_choice, value.robust, value.exposure
    if isinstance(value, sf.Image):
        return value.color.tobytes(), value.half_width.tobytes(), value.metadata, value.summary(), sorted(value.aovs)
    if isinstance(value, sf.CheckpointError):
        return str(value), fingerprint(value.image)
    if isinstance(value, (sf.AliasTable, sf.PiecewiseConstant1D)):
        return value.sample(np.linspace(0, 0.99, 50)).tobytes()
    if isinstance(value, sf.PiecewiseConstant2D):
        return value.sample(sf.points("sobol", 64)).tobytes()
    if isinstance(value, (sf.Rng, np.random.BitGenerator)):
        return value.state
    if isinstance(value, (sf.BatchMeans, sf.ConfidenceSequence)):
        return value.__getstate__()
    if isinstance(value, Engine):
        return value.random(8).tobytes()
    if isinstance(value, sf.Progress):
        return {name: getattr(value, name) for name in dir(value) if not name.startswith("_")}
    if isinstance(value, sf.Error):
        return value.args
    return repr(value)


WAYS: dict[str, Callable[[Any], Any]] = {
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle": lambda value: pickle.loads(pickle.dumps(value)),
}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", KINDS)
def test_copies_are_what_they_are_of(name: str, way: str) -> None:
    value = every_kind()[name] if name == "Engine" else KINDS[name]
    again = WAYS[way](value)
    assert type(again) is type(value)
    assert fingerprint(again) == fingerprint(value)


def test_every_public_class_is_among_them() -> None:
    classes = {name for name in sf.__all__ if inspect.isclass(getattr(sf, name))}
    same = {"Conductor", "Mirror", "ChannelMoments", "WeightedMoments", "RunningSums", "IntegralLook", "PlanDimensions"}
    assert classes - same <= set(KINDS), "a class without a test of its copies"


def _replicate(seed: int) -> sf.Image:
    return sf.render(sf.scenes.penumbra(), 12, 9, spp=8, seed=seed, threads=1)


def test_images_of_other_processes_merge() -> None:
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        images = list(pool.map(_replicate, [1, 2]))
    expected = sf.merge([_replicate(1), _replicate(2)])
    merged = pickle.loads(pickle.dumps(sf.merge(images)))
    assert fingerprint(merged)[:2] == fingerprint(expected)[:2]
    assert merged.metadata["merged_seeds"] == "1 2"
    with pytest.raises(ValueError, match="both have seed 1"):
        sf.merge([merged, images[0]])


@pytest.mark.parametrize(
    "options",
    [
        {"tolerance": 0.02, "unbiased": True},
        {"samples": 12 * 9 * 100, "stop": "replicates"},
        {"relmse": 1e-4, "pixel_filter": "lanczos", "crop": (2, 1, 9, 8)},
        {"spp": 64, "seeds": "thread", "threads": 2},
    ],
)
def test_pictures_of_every_kind_come_back_bit_for_bit(penumbra: sf.Scene, options: dict[str, Any]) -> None:
    image = sf.render(penumbra, 12, 9, **options)
    again = pickle.loads(pickle.dumps(image))
    assert fingerprint(again) == fingerprint(image)
    assert again.stop_reason.tobytes() == image.stop_reason.tobytes()
    assert pickle.dumps(again)[:64] == pickle.dumps(image)[:64]


def test_the_exposure_comes_back() -> None:
    image = sf.render(KINDS["Scene"], 8, 8, spp=1)
    assert pickle.loads(pickle.dumps(image)).exposure == image.exposure == 1.5


def test_an_interrupted_picture_stays_one(penumbra: sf.Scene) -> None:
    image = sf.render(penumbra, 64, 64, tolerance=1e-4, progress=lambda p: p.round < 1)
    again = copy.deepcopy(image)
    assert image.interrupted
    assert again.interrupted
    assert fingerprint(again) == fingerprint(image)


def test_a_pickled_state_that_no_samples_lead_to_is_refused() -> None:
    means = sf.BatchMeans(4)
    state = bytearray(means.__getstate__())
    state[:8] = bytes(8)  # a size of 0
    with pytest.raises(ValueError, match="no samples lead to"):
        means.__setstate__(bytes(state))
    with pytest.raises(ValueError, match="no samples lead to"):
        sf.Moments().__setstate__((3, 1.0, -1.0, 0))
