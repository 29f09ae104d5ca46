#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""make-lab.py: writes the table of docs/lab.md anew."""

from pathlib import Path

import sunfleck as sf

PAGE = Path(__file__).resolve().parents[1] / "docs" / "lab.md"
MARK = "<!-- the table: scripts/make-lab.py -->\n"

head = PAGE.read_text(encoding="utf-8").split(MARK)[0]
PAGE.write_text(head + MARK + sf.lab.table(sf.lab.run(name) for name in sf.lab.EXPERIMENTS), encoding="utf-8")
