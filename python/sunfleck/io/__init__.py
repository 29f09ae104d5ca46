# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""io: files that are read and written.

Three groups of modules stand one above the other, and each imports only what stands below it.

1. Any file: `files` replaces a file whole, `source` reads one within limits, `text` parses lines of numbers,
   `notices` logs what a file holds and its scene does not show, `polygon` cuts polygons into triangles, and `image`
   writes and reads pictures. They know nothing of scenes, and `sunfleck.plot` and `sunfleck.render` use them.
2. A format of scenes each, above `sunfleck.scene`: `gltf` (with `gltf_data`, `gltf_material`, `gltf_mesh`), `obj`
   (with `mtl`), `ply` (with `ply_rows`) and `stl`. A reader takes a `Source` and returns `Contents`.
3. The way from a path to a scene, above `sunfleck.render`: `load` has the table of formats, chooses a camera, and has
   `lamp` light what would be dark.
"""
