# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""render: a scene and options in, an image out that says per pixel how far it may be off."""

# `options` and `summary` come first and import none of the others; `progress` and `image` import `summary`; `merge`
# and `render`, which hold the functions of those names, stand above them. The folder stands above `sunfleck.scene`,
# `sunfleck.io.image` and `sunfleck.plot.heatmap`, and below whatever renders: `sunfleck.io.load`, the gallery, the
# charts and the laboratory.

from sunfleck.render.image import Image
from sunfleck.render.merge import merge
from sunfleck.render.options import AOVS, PIXEL_FILTERS, RENDER_PATTERNS, STOP_REASONS
from sunfleck.render.progress import Progress
from sunfleck.render.render import render
from sunfleck.render.summary import Summary

__all__ = [
    "AOVS",
    "PIXEL_FILTERS",
    "RENDER_PATTERNS",
    "STOP_REASONS",
    "Image",
    "Progress",
    "Summary",
    "merge",
    "render",
]
