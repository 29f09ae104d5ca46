# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""scene: what is rendered, the camera that looks at it, and the plan of what that takes."""

# `material` comes first; `mesh` and `shapes` have materials; `instances` repeat meshes, and `bounds` are boxes about
# both; `fog` and `sky` import none of these. `scene` imports all of them but `bounds`. The folder stands above the
# sampling modules and `sunfleck.exposure`, and below `sunfleck.render`.

from sunfleck.scene.fog import Fog
from sunfleck.scene.instances import Instances
from sunfleck.scene.material import Conductor, Dielectric, Mirror
from sunfleck.scene.mesh import Mesh
from sunfleck.scene.scene import Camera, Plan, PlanDimensions, Scene, SceneInfo
from sunfleck.scene.shapes import Disk, Sphere
from sunfleck.scene.sky import Environment, Sun

__all__ = [
    "Camera",
    "Conductor",
    "Dielectric",
    "Disk",
    "Environment",
    "Fog",
    "Instances",
    "Mesh",
    "Mirror",
    "Plan",
    "PlanDimensions",
    "Scene",
    "SceneInfo",
    "Sphere",
    "Sun",
]
