# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""notices: what a file holds and its scene does not show, a line each in the log."""

from __future__ import annotations

import logging
from pathlib import Path

__all__ = ["Notices"]

_log = logging.getLogger("sunfleck")


class Notices:
    """Logs each notice about a file once, under "sunfleck" at level INFO."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._given: set[str] = set()

    def __call__(self, message: str) -> None:
        if message not in self._given:
            self._given.add(message)
            _log.info("%s: %s", self._path, message)
