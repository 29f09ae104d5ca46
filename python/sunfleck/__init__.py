# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Sunfleck turns random numbers into pictures of stated accuracy.

A sampling library (`Rng`, `points`, `mapping`, `Moments`) and an adaptive renderer (`Scene`,
`render`) that is asked for an accuracy, reaches it, and says per pixel whether it did.

Examples
--------
>>> import sunfleck as sf
>>> image = sf.render(sf.scenes.penumbra(), 64, 64, tolerance=0.05)
>>> image.color.shape
(64, 64, 3)
"""

# What is heavy (OpenImageIO, trimesh, tqdm) is imported where it is used, not here.
from sunfleck import mapping, scenes
from sunfleck._core import version as _version
from sunfleck.discrete import AliasTable, PiecewiseConstant1D, PiecewiseConstant2D
from sunfleck.error import Error
from sunfleck.estimate import Moments, VectorMoments
from sunfleck.load import load
from sunfleck.mapping import MAPPINGS
from sunfleck.points import PATTERNS, points, valid_counts
from sunfleck.render import STOP_REASONS, Image, Progress, Summary, Tolerance, render
from sunfleck.rng import RNGS, Rng
from sunfleck.scene import Camera, Mesh, Plan, PlanDimensions, Scene, SceneInfo

__version__ = _version()

__all__ = [
    "MAPPINGS",
    "PATTERNS",
    "RNGS",
    "STOP_REASONS",
    "AliasTable",
    "Camera",
    "Error",
    "Image",
    "Mesh",
    "Moments",
    "PiecewiseConstant1D",
    "PiecewiseConstant2D",
    "Plan",
    "PlanDimensions",
    "Progress",
    "Rng",
    "Scene",
    "SceneInfo",
    "Summary",
    "Tolerance",
    "VectorMoments",
    "load",
    "mapping",
    "points",
    "render",
    "scenes",
    "valid_counts",
]
