# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""cli: the command `sunfleck`, whose parts are a module each.

`command` has the parser of the whole, the exit codes and `main`; `chart`, `gallery` and `lab` are commands, and
`scene` reads the arguments by which several of them name a scene. `command` imports the others, and none of them
imports another. The folder stands above all the rest of the package, which does not import it.
"""

from sunfleck.cli.command import main

__all__ = ["main"]
