# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""plot: figures and pages that show what was sampled, measured or rendered.

Two groups of modules stand one above the other, and each imports only what stands below it.

1. `figure` draws panels through matplotlib or Plotly and imports neither before it must; `heatmap`, `show` and `page`
   (an HTML file that needs no network) are made of it. They know nothing of scenes, and `sunfleck.render` uses them.
2. `plates` makes the figures of the gallery and `gallery` puts them on a page, above `sunfleck.render`.
"""
