#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""make-gallery.py: writes docs/gallery.md and docs/images/gallery/ anew; `make gallery` runs it."""

import sys
from pathlib import Path

from sunfleck.plot.gallery import write_gallery_markdown

docs = Path(__file__).resolve().parents[1] / "docs"
write_gallery_markdown(docs / "gallery.md", docs / "images" / "gallery", progress=sys.stderr.isatty())
