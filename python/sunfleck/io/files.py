# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""files: written beside and renamed, so that a failure leaves whatever was there."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

FilePath = str | os.PathLike[str]


def given_path(path: FilePath) -> str:
    """The path as text.

    Raises
    ------
    TypeError, ValueError
        Not a path, or one that no system has.
    """
    given = os.fspath(path)
    if not isinstance(given, str):
        raise TypeError(f"path is {path!r}; give a string or a pathlib.Path")
    if "\0" in given:
        raise ValueError(f"path is {given!r}; it must not hold a null character")
    return given


def ending(path: FilePath) -> str:
    """The path's ending, with its dot, in lower case."""
    return os.path.splitext(os.fspath(path))[1].lower()


def known_ending(path: FilePath, endings: Iterable[str], lead: str) -> str:
    """The path's ending, which is one of those; the refusal of another leads from it to them.

    Raises
    ------
    ValueError
        Another ending.
    """
    found, allowed = ending(path), tuple(endings)
    if found not in allowed:
        raise ValueError(f"{os.fspath(path)!r} ends in {found!r}; {lead} {', '.join(allowed)}")
    return found


def writable_target(path: FilePath, what: str, endings: Sequence[str]) -> Path:
    """Where the file will be, after everything that can be told before it is written.

    Raises
    ------
    TypeError
        Not a path.
    ValueError
        Another ending than those.
    OSError
        The folder is missing or can't be written to, or the path is not a file's.
    """
    given = given_path(path)
    known_ending(given, endings, f"{what} are written as")
    target = Path(os.path.realpath(given))  # through symbolic links: the rename would replace the link
    if not target.parent.is_dir():
        raise FileNotFoundError(f"can't write {given!r}: there is no folder {str(target.parent)!r}")
    if target.exists() and not target.is_file():
        raise OSError(f"can't write {given!r}: it exists and is not a file")
    if not os.access(target if target.exists() else target.parent, os.W_OK):
        raise PermissionError(f"can't write {given!r}: permission denied")
    return target


@contextmanager
def replacing(path: FilePath, what: str, endings: Sequence[str]) -> Iterator[Path]:
    """A file to write, which takes the path's place only when all went well.

    Raises
    ------
    TypeError, ValueError, OSError
        As `writable_target`; and where a write fails, as on a full disk, with the path and the reason.
    """
    target = writable_target(path, what, endings)
    beside = target.with_name(f".sunfleck-{os.urandom(8).hex()}{ending(path)}")
    os.close(os.open(beside, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
    try:
        if target.exists():
            os.chmod(beside, target.stat().st_mode & 0o7777)
        yield beside
        with open(beside, "rb") as written:
            os.fsync(written.fileno())  # a full disk shows here, not after the old file has gone
        os.replace(beside, target)
    except OSError as error:
        beside.unlink(missing_ok=True)
        if "can't write" in str(error):
            raise
        raise _named(error, path) from error
    except BaseException:
        beside.unlink(missing_ok=True)
        raise


def _named(error: OSError, path: FilePath) -> OSError:
    """The same error of a write, which says what could not be written."""
    named = type(error)(f"can't write {os.fspath(path)!r}: {error.strerror or error}")
    named.errno = error.errno
    return named
