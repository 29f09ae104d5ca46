# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""error: the exceptions for what no built-in one says."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sunfleck.render import Image

__all__ = ["CheckpointError", "Error"]


class Error(RuntimeError):
    """What only the libraries underneath can tell: Embree reported an error of its own."""


class CheckpointError(OSError):
    """The render ended and its checkpoint could not be written: the picture is not lost.

    Attributes
    ----------
    image : Image
        The picture, as `render` would have returned it.
    """

    def __init__(self, message: str, image: Image) -> None:
        super().__init__(message)
        self.image = image

    def __reduce__(self) -> tuple[type[CheckpointError], tuple[str, Image]]:
        return CheckpointError, (str(self), self.image)
