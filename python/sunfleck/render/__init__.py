# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""render: a scene and options in, an image out that says per pixel how far it may be off."""

from sunfleck.render.render import (
    AOVS,
    PIXEL_FILTERS,
    RENDER_PATTERNS,
    STOP_REASONS,
    Image,
    Progress,
    Summary,
    merge,
    render,
)

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
