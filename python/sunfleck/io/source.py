# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""source: the file that is loaded, the files it refers to, and how much it may ask for."""

from __future__ import annotations

import os
import stat
from dataclasses import dataclass, fields
from pathlib import Path
from typing import BinaryIO

from sunfleck._arguments import flag, integer
from sunfleck.io.files import FilePath, given_path

__all__ = ["Limits", "Source"]


@dataclass(frozen=True)
class Limits:
    """How much a file may ask for. It is counted before memory is taken for it.

    Parameters
    ----------
    bytes : int
        Of the file, of those that it refers to, and of the arrays that are made from them, in all.
    triangles : int
        That the scene holds; those of instances once.
    instances : int
        Placements of meshes, in all.
    pixels : int
        Of any one picture.

    Raises
    ------
    TypeError, ValueError
        Not an integer, or a negative one.

    Examples
    --------
    >>> import sunfleck as sf
    >>> sf.Limits(triangles=1000)
    Limits(bytes=4000000000, triangles=1000, instances=2000000, pixels=268435456)
    """

    bytes: int = 4_000_000_000
    triangles: int = 50_000_000
    instances: int = 2_000_000
    pixels: int = 1 << 28

    def __post_init__(self) -> None:
        for field in fields(self):
            object.__setattr__(self, field.name, integer(field.name, getattr(self, field.name)))


class Source:
    """A file to load. Readers read it, and what it refers to, through this alone.

    Parameters
    ----------
    path : path-like
        The file itself, which the caller named: it may lie anywhere.
    allow_outside : bool
        Whether references may leave the file's folder.
    limits : Limits, optional
        None: ``Limits()``.

    Raises
    ------
    TypeError, ValueError
        Not a path, or one that no system has; other values of the wrong kind.
    """

    def __init__(self, path: FilePath, *, allow_outside: bool = False, limits: Limits | None = None) -> None:
        self.path = Path(given_path(path))
        self._allow_outside = flag("allow_outside", allow_outside)
        if not isinstance(limits, (Limits, type(None))):
            raise TypeError(f"limits is {limits!r}; give a sunfleck.Limits")
        self.limits = limits or Limits()
        self._taken = {field.name: 0 for field in fields(Limits)}

    # ---- how much ----

    def take_bytes(self, count: int) -> None:
        """To be called before `count` bytes of arrays are made.

        Raises
        ------
        ValueError
            Together with what was taken before they pass the limit; likewise below.
        """
        self._take("bytes", count, "bytes in all")

    def take_triangles(self, count: int) -> None:
        """To be called before `count` triangles are made."""
        self._take("triangles", count, "triangles in all")

    def take_instances(self, count: int) -> None:
        """To be called before `count` placements are made."""
        self._take("instances", count, "instances in all")

    def take_picture(self, width: int, height: int) -> None:
        """To be called before a picture's pixels are read; its bytes are counted by `take_bytes`."""
        self._taken["pixels"] = 0  # the limit is that of each
        self._take("pixels", width * height, f"pixels in a picture of {width} x {height}")

    def _take(self, name: str, count: int, what: str) -> None:
        self._taken[name] += count
        taken, allowed = self._taken[name], getattr(self.limits, name)
        if taken > allowed:
            raise ValueError(
                f"it asks for {taken:,} {what}; at most {allowed:,} are read, "
                f"unless limits=sf.Limits({name}=...) allows more"
            )

    # ---- where ----

    def locate(self, reference: str) -> Path:
        """Where a file is that this one refers to, relative to its folder; it need not exist.

        ``..`` and symbolic links count as what they lead to.

        Raises
        ------
        ValueError
            Outside of the folder, where that is not allowed; or no path at all.
        """
        if "\0" in reference:
            raise ValueError(f"it refers to {reference!r}, which holds a null character")
        folder = os.path.realpath(self.path.parent)
        try:
            target = os.path.realpath(os.path.join(folder, reference))
            inside = os.path.commonpath([folder, target]) == folder
        except (OSError, ValueError):  # Windows: another drive, or what no path there may be
            target, inside = os.path.join(folder, reference), False
        if not inside and not self._allow_outside:
            raise ValueError(
                f"it refers to {reference!r}, which lies outside of its folder; "
                "such files are read with allow_outside=True"
            )
        return Path(target)

    # ---- what ----

    def read(self) -> bytes:
        """All of the file itself.

        Raises
        ------
        OSError
            It can't be read, or is no ordinary file: a folder, a pipe, a device.
        ValueError
            It is larger than the limits allow.
        """
        return self._read(self.path, os.fspath(self.path))

    def check(self) -> None:
        """Whether the file itself can be read, for those that are read by another library.

        Raises
        ------
        OSError
            As `read`.
        """
        with _opened(self.path, os.fspath(self.path)):
            pass

    def read_beside(self, reference: str) -> bytes:
        """All of a file that this one refers to.

        Raises
        ------
        OSError, ValueError
            As `read` and `locate`; FileNotFoundError, where there is none.
        """
        return self._read(self.locate(reference), reference)

    def _read(self, path: Path, name: str) -> bytes:
        with _opened(path, name) as file:
            size = os.fstat(file.fileno()).st_size
            self.take_bytes(size)
            data = file.read(size + 1)
        if len(data) > size:
            raise OSError(f"{name!r} has {size} bytes and gives more; it grows, or is no ordinary file")
        return data


def _opened(path: Path, name: str) -> BinaryIO:
    """An ordinary file. A pipe would wait for its other end, and a device may act: told by the name before, and
    once more when it is open, where nobody can exchange it any more."""
    if stat.S_ISREG(os.stat(path).st_mode):
        file = open(path, "rb", opener=_open_at_once)  # noqa: SIM115 (the caller closes it)
        if stat.S_ISREG(os.fstat(file.fileno()).st_mode):
            return file
        file.close()
    raise OSError(f"{name!r} is not a file that can be read as a whole")


def _open_at_once(path: str, flags: int) -> int:
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))
