# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""_former: modules that lay flat in the package until they got folders, under the names that they had.

`from sunfleck.material import Material` goes on working, and gives the very module that `sunfleck.scene.material` is.
New code names the folder; type checkers know no other way.
"""

import sys

_FOLDERS = {
    "scene": ("bounds", "fog", "instances", "material", "mesh", "shapes", "sky"),
    "io": (
        *("gltf", "gltf_data", "gltf_material", "gltf_mesh", "image", "lamp", "load", "mtl", "notices", "obj"),
        *("ply", "ply_rows", "polygon", "source", "stl"),
    ),
    "plot": ("figure", "gallery", "heatmap", "page", "plates", "show"),
}


def keep_former_names() -> None:
    """Gives those modules, all of which have been imported, their former names beside their own.

    What the package has under such a name by then, as the function `sunfleck.load`, stays what it is.
    """
    package = sys.modules["sunfleck"]
    for folder, names in _FOLDERS.items():
        for name in names:
            module = sys.modules[f"sunfleck.{folder}.{name}"]
            sys.modules[f"sunfleck.{name}"] = module
            if not hasattr(package, name):
                setattr(package, name, module)
