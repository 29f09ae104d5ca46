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

# What is heavy (OpenImageIO, tqdm, SciPy) is imported where it is used, not here.
from typing import TYPE_CHECKING, Any

from sunfleck import estimate, mapping, scenes, uniformity
from sunfleck._core import version as _version
from sunfleck._former import keep_former_names as _keep_former_names
from sunfleck.discrete import AliasTable, PiecewiseConstant1D, PiecewiseConstant2D
from sunfleck.error import CheckpointError, Error
from sunfleck.estimate import (
    BatchMeans,
    ChannelMoments,
    ConfidenceSequence,
    Moments,
    RunningSums,
    VectorMoments,
    WeightedMoments,
)
from sunfleck.integrate import Integral, IntegralLook, integrate
from sunfleck.io.load import load
from sunfleck.io.source import Limits
from sunfleck.mapping import MAPPINGS
from sunfleck.plot.gallery import gallery
from sunfleck.plot.show import show
from sunfleck.points import PATTERNS, SCRAMBLES, points, valid_counts
from sunfleck.render import AOVS, PIXEL_FILTERS, RENDER_PATTERNS, STOP_REASONS, Image, Progress, Summary, merge, render
from sunfleck.rng import RNGS, Rng
from sunfleck.scene import Camera, Plan, PlanDimensions, Scene, SceneInfo
from sunfleck.scene.fog import Fog
from sunfleck.scene.instances import Instances
from sunfleck.scene.material import Conductor, Dielectric, Mirror
from sunfleck.scene.mesh import Mesh
from sunfleck.scene.shapes import Disk, Sphere
from sunfleck.scene.sky import Environment, Sun
from sunfleck.tolerance import Tolerance

if TYPE_CHECKING:
    from sunfleck import chart as chart
    from sunfleck import lab as lab
    from sunfleck import qmc as qmc
else:

    def __getattr__(name: str) -> Any:
        """Modules that need more (qmc needs SciPy, chart matplotlib) or are large, when they are first asked for."""
        if name not in ("chart", "lab", "qmc"):
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        import importlib

        return importlib.import_module(f"sunfleck.{name}")


__version__ = _version()
_keep_former_names()

__all__ = [
    "AOVS",
    "MAPPINGS",
    "PATTERNS",
    "PIXEL_FILTERS",
    "RENDER_PATTERNS",
    "RNGS",
    "SCRAMBLES",
    "STOP_REASONS",
    "AliasTable",
    "BatchMeans",
    "Camera",
    "ChannelMoments",
    "CheckpointError",
    "Conductor",
    "ConfidenceSequence",
    "Dielectric",
    "Disk",
    "Environment",
    "Error",
    "Fog",
    "Image",
    "Instances",
    "Integral",
    "IntegralLook",
    "Limits",
    "Mesh",
    "Mirror",
    "Moments",
    "PiecewiseConstant1D",
    "PiecewiseConstant2D",
    "Plan",
    "PlanDimensions",
    "Progress",
    "Rng",
    "RunningSums",
    "Scene",
    "SceneInfo",
    "Sphere",
    "Summary",
    "Sun",
    "Tolerance",
    "VectorMoments",
    "WeightedMoments",
    "estimate",
    "gallery",
    "integrate",
    "load",
    "mapping",
    "merge",
    "points",
    "render",
    "scenes",
    "show",
    "uniformity",
    "valid_counts",
]
