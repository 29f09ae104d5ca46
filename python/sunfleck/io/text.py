# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""text: files of lines of words and numbers, in bulk through NumPy."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["BadLine", "Lines", "blocks", "decoded", "line_number", "parsed", "refusal", "with_newlines"]

_Mask = NDArray[np.bool_]
_Indices = NDArray[np.int64]

# A block takes some tenths of a second, between which Ctrl-C is heard, and a few times its size of memory.
BLOCK = 1 << 22
_NEWLINE, _SPACE, _HASH, _SLASH = b"\n #/"


def decoded(data: bytes) -> str:
    """Text as UTF-8, or else Latin-1, which takes every byte."""
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def with_newlines(data: bytes) -> bytes:
    """Text in bytes that hold ASCII, without a byte-order mark, whose lines end in a line feed alone."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        data = data.decode("utf-16", errors="replace").encode()
    data = data.removeprefix(b"\xef\xbb\xbf")
    return data.replace(b"\r\n", b"\n").replace(b"\r", b"\n") if b"\r" in data else data


def blocks(text: bytes, start: int = 0) -> Iterator[tuple[int, bytes]]:
    """Pieces that end with a line, from an offset on, and where they start."""
    while start < len(text):
        end = text.find(b"\n", min(start + BLOCK, len(text)) - 1) + 1 or len(text)
        yield start, text[start:end]
        start = end


class Lines:
    """The lines of a block.

    Attributes
    ----------
    starts, ends : ndarray, shape (lines,)
        Of each line, without its line feed.
    words : ndarray, shape (lines,)
        How many each has.
    first : ndarray, shape (lines,)
        Where its first word starts; where the line starts, if it has none.
    """

    def __init__(self, block: bytes) -> None:
        padded = block if block.endswith(b"\n") else block + b"\n"
        self.bytes = np.frombuffer(bytearray(padded), np.uint8)
        self.ends = np.flatnonzero(self.bytes == _NEWLINE)
        self.starts = np.concatenate([[0], self.ends[:-1] + 1])
        self._find_words()

    def _find_words(self) -> None:
        dark = self.bytes > _SPACE
        opens = dark.copy()
        opens[1:] &= ~dark[:-1]
        word_starts = np.flatnonzero(opens)
        before = np.searchsorted(word_starts, self.starts)
        self.words = np.diff(before, append=len(word_starts))
        self.first = self.starts.copy()
        some = self.words > 0
        self.first[some] = word_starts[before[some]]

    def __len__(self) -> int:
        return len(self.starts)

    def line(self, index: int) -> bytes:
        """One line, without spaces around it."""
        return self.bytes[self.starts[index] : self.ends[index]].tobytes().strip()

    def starting_with(self, word: bytes) -> _Mask:
        """Lines whose first word is that, in small letters or large ones."""
        found = self.words > 0
        last = len(self.bytes) - 1
        for k, letter in enumerate(word):
            found &= (self.bytes[np.minimum(self.first + k, last)] | 0x20) == letter
        found &= self.bytes[np.minimum(self.first + len(word), last)] <= _SPACE
        return found

    def without_comments(self, chosen: _Mask) -> None:
        """Blanks what follows a number sign in those lines."""
        hashes = np.flatnonzero(self.bytes == _HASH)
        if not len(hashes):
            return
        lines = np.searchsorted(self.ends, hashes)
        hit = chosen[lines]
        for at, line in zip(hashes[hit].tolist(), lines[hit].tolist(), strict=True):
            self.bytes[at : self.ends[line]] = _SPACE
        if hit.any():
            self._find_words()

    def blank(self, chosen: _Mask, width: int) -> None:
        """Blanks so many bytes of those lines' first word, and no longer counts it where that is all of it."""
        for k in range(width):
            self.bytes[self.first[chosen] + k] = _SPACE
        self.words = self.words - chosen

    def numbers(self, chosen: _Mask, dtype: Any, rule: str) -> NDArray[Any]:
        """All words of those lines as numbers; of a word for an integer only what stands before a slash.

        Raises
        ------
        BadLine
            A word of a line is no such number, against the rule.
        """
        until_slash = dtype is np.int64
        values = parsed(self._text(chosen, until_slash), dtype)
        if len(values) == int(self.words[chosen].sum()):
            return values
        rows, one = np.flatnonzero(chosen), np.zeros(len(self), np.bool_)
        while len(rows) > 1:  # bisected: each half is parsed on its own
            half = rows[: len(rows) // 2]
            one[:] = False
            one[half] = True
            whole = len(parsed(self._text(one, until_slash), dtype)) == int(self.words[half].sum())
            rows = rows[len(half) :] if whole else half
        raise BadLine(int(rows[0]), rule)

    def _text(self, chosen: _Mask, until_slash: bool) -> bytes:
        """The bytes of those lines, one after the other."""
        taken = self.bytes[np.repeat(chosen, self.ends + 1 - self.starts)]
        slashes = np.flatnonzero((taken == _SLASH) & until_slash)
        if len(slashes):
            # Whether the last space or slash up to each byte is a slash.
            spaces = np.flatnonzero(taken <= _SPACE)
            latest = np.zeros(len(taken), np.int32)
            latest[slashes], latest[spaces] = 2 * slashes + 1, 2 * spaces
            np.maximum.accumulate(latest, out=latest)
            taken[(latest & 1).astype(np.bool_)] = _SPACE
        return taken.tobytes()


class BadLine(Exception):
    """A line of a block that can't be read: its number in the block, and why."""

    def __init__(self, index: int, why: str) -> None:
        super().__init__(index, why)
        self.index, self.why = index, why


def line_number(text: bytes, offset: int) -> int:
    """The line, from 1 on, that an offset lies in."""
    return text.count(b"\n", 0, offset) + 1


def refusal(text: bytes, offset: int, why: str) -> ValueError:
    """An error that names the line at an offset."""
    end = text.find(b"\n", offset)
    line = decoded(text[offset : end if end >= 0 else None].strip())
    return ValueError(f"line {line_number(text, offset)} is {line[:60]!r}: {why}")


def parsed(text: bytes, dtype: Any) -> NDArray[Any]:
    """Numbers between spaces, up to the first word that is none."""
    if not text or text.isspace():
        return np.empty(0, dtype)
    try:
        return np.fromstring(text, dtype, sep=" ")
    except (ValueError, DeprecationWarning):  # a later NumPy's refusal, or today's warning made an error
        return np.empty(0, dtype)
