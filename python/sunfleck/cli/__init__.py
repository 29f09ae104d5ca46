# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""cli: the command `sunfleck`, whose parts are a module each.

`command` has the parser of the whole, the commands `render`, `points` and `plan`, and `main`; `chart`, `gallery` and
`lab` are commands, and `scene` reads the arguments by which several of them name a scene. `command` imports the others,
which import nothing of the folder but `exit_codes`. It stands above all the rest of the package.
"""

from sunfleck.cli.command import main

__all__ = ["main"]
