# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Small glTF files for tests: meshes as arrays, everything else as the file has it."""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

SQUARE: tuple[Any, Any] = ([[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]], [[0, 1, 2], [0, 2, 3]])
"""Of side 2 at y = 0, facing +y."""

WHITE: dict[str, Any] = {"pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.8, 0.8, 1], "metallicFactor": 0}}
CAMERA: dict[str, Any] = {"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.01}}


def glow(strength: float, **more: Any) -> dict[str, Any]:
    """A black material that emits."""
    return {
        "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0},
        "emissiveFactor": [1, 1, 1],
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": strength}},
        **more,
    }


def box(lower: Sequence[float], upper: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Eight corners and twelve triangles, which face outwards."""
    corners = np.array([[(lower, upper)[k][axis] for axis, k in enumerate(at)] for at in np.ndindex(2, 2, 2)], float)
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners, np.array([t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))])


def write_gltf(
    folder: Path,
    meshes: Sequence[tuple[Any, Any, int | None]],
    nodes: Sequence[dict[str, Any]] = (),
    materials: Sequence[dict[str, Any]] = (WHITE,),
    arrays: Sequence[np.ndarray] = (),
    **tree: Any,
) -> Path:
    """A file of meshes (vertices, triangles, material), each shown once where no nodes are given.

    Accessors 2 k and 2 k + 1 are mesh k's; those of ``arrays``, shape (n, 3) or (n, 4), follow.
    """
    data, views, accessors, primitives = b"", [], [], []
    pairs = [
        (np.asarray(values, kind), width)
        for vertices, triangles, _ in meshes
        for values, kind, width in ((vertices, np.float32, "VEC3"), (np.ravel(triangles), np.uint32, "SCALAR"))
    ]
    for values, width in [*pairs, *((np.asarray(array, np.float32), f"VEC{array.shape[1]}") for array in arrays)]:
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": values.nbytes})
        component = 5126 if values.dtype == np.float32 else 5125
        row = {"bufferView": len(views) - 1, "componentType": component, "count": len(values), "type": width}
        accessors.append(row)
        data += values.tobytes()
    for number, (_, _, material) in enumerate(meshes):
        primitive: dict[str, Any] = {"attributes": {"POSITION": 2 * number}, "indices": 2 * number + 1}
        primitives.append(primitive if material is None else {**primitive, "material": material})
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    nodes = nodes or [{"mesh": number} for number in range(len(meshes))]
    path = folder / "t.gltf"
    path.write_text(
        json.dumps(
            {
                "asset": {"version": "2.0"},
                "scene": 0,
                "scenes": [{"nodes": list(range(len(nodes)))}],
                "nodes": list(nodes),
                "meshes": [{"primitives": [primitive]} for primitive in primitives],
                "materials": list(materials),
                "accessors": accessors,
                "bufferViews": views,
                "buffers": [{"byteLength": len(data), "uri": uri}],
                **tree,
            }
        )
    )
    return path
