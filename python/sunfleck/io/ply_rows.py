# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""ply_rows: the rows of a PLY file's elements, in text or binary, of which each may have lists of its own length."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sunfleck.io.text import BadLine, Lines, blocks, refusal

__all__ = ["BinaryBody", "Element", "Lists", "Property", "TextBody"]

_Indices = NDArray[np.int64]

_LETTERS = {
    "i1": "b",
    "u1": "B",
    "i2": "h",
    "u2": "H",
    "i4": "i",
    "u4": "I",
    "i8": "q",
    "u8": "Q",
    "f4": "f",
    "f8": "d",
}


@dataclass(frozen=True)
class Property:
    """A column: its type as NumPy's, and of a list that of its length."""

    name: str
    type: str
    length: str | None


@dataclass(frozen=True)
class Element:
    """A table: so many rows of those columns."""

    name: str
    count: int
    properties: list[Property]


@dataclass(frozen=True)
class Lists:
    """The values of all rows' lists, one after the other, and how many each row has."""

    values: NDArray[Any]
    counts: _Indices


@dataclass(frozen=True)
class _Evenly:
    """Offsets of rows that all have the same size."""

    first: int
    stride: int
    count: int

    def moved(self, by: int) -> _Evenly:
        return _Evenly(self.first + by, self.stride, self.count)

    def index(self) -> _Indices:
        return self.first + self.stride * np.arange(self.count)


_Starts = _Evenly | _Indices


def _ranges(starts: _Indices, counts: _Indices, step: int) -> _Indices:
    """``starts[i] + step * k`` for each k below ``counts[i]``, one i after the other."""
    ends = np.cumsum(counts)
    total = int(ends[-1]) if len(ends) else 0
    result: _Indices = np.repeat(starts - step * (ends - counts), counts) + step * np.arange(total)
    return result


class BinaryBody:
    """What follows the header of a binary file; elements are asked for in their order.

    Raises
    ------
    ValueError
        From each of the methods: the file is cut short, or a list has no length that there is.
    """

    def __init__(self, data: bytes, order: str) -> None:
        self._data, self._order, self._at = data, order, 0

    def skip(self, element: Element) -> None:
        self._columns(element)

    def scalars(self, element: Element, names: Sequence[str]) -> list[NDArray[Any]]:
        """The columns of those names, each of shape (count,)."""
        columns = self._columns(element)
        return [
            self._values(columns[name], next(p.type for p in element.properties if p.name == name)) for name in names
        ]

    def lists(self, element: Element, name: str) -> Lists:
        """The lists of that name."""
        starts = self._columns(element)[name]
        prop = next(p for p in element.properties if p.name == name)
        assert prop.length is not None
        counts = self._values(starts, prop.length).astype(np.int64)
        before, size = _size(prop.length), _size(prop.type)
        if isinstance(starts, _Evenly) and starts.count:
            shape, strides = (starts.count, int(counts[0])), (starts.stride, size)
            rows = np.ndarray(shape, self._order + prop.type, self._data, starts.first + before, strides)
            return Lists(rows.astype(prop.type).ravel(), counts)
        first = starts.index() if isinstance(starts, _Evenly) else starts
        return Lists(self._values(_ranges(first + before, counts, size), prop.type), counts)

    def left(self) -> str:
        """What no element has asked for."""
        size = len(self._data) - self._at
        return f"{size} bytes" if size else ""

    def _values(self, at: _Starts, kind: str) -> NDArray[Any]:
        """Numbers of a type from anywhere in the file."""
        dtype = np.dtype(self._order + kind)
        if isinstance(at, _Evenly):
            there: NDArray[Any] = np.ndarray((at.count,), dtype, self._data, at.first, (at.stride,))
            return there.astype(kind)
        if not len(at):
            return np.empty(0, kind)
        everywhere: NDArray[Any] = np.ndarray((len(self._data) - dtype.itemsize + 1,), dtype, self._data, strides=(1,))
        return everywhere[at].astype(kind, copy=False)

    def _columns(self, element: Element) -> dict[str, _Starts]:
        """Where each column of each row starts; of a list, where its length stands."""
        pieces = self._pieces(element)
        starts = self._walk(element, pieces)
        columns: dict[str, _Starts] = {}
        for piece, start in zip(pieces, starts, strict=True):
            offset = 0
            for prop in piece:
                columns[prop.name] = start.moved(offset) if isinstance(start, _Evenly) else start + offset
                offset += _size(prop.length or prop.type)
        return columns

    @staticmethod
    def _pieces(element: Element) -> list[list[Property]]:
        """The columns, cut behind each list: within a piece all but the end is at fixed distances."""
        pieces: list[list[Property]] = [[]]
        for prop in element.properties:
            pieces[-1].append(prop)
            if prop.length is not None:
                pieces.append([])
        return pieces

    def _walk(self, element: Element, pieces: list[list[Property]]) -> Sequence[_Starts]:
        """Where each piece of each row starts."""
        widths = [sum(_size(p.length or p.type) for p in piece) for piece in pieces]
        if len(pieces) == 1:
            end = self._at + element.count * widths[0]
            if end > len(self._data):
                raise self._cut_short(element, (len(self._data) - self._at) // widths[0])
            starts = _Evenly(self._at, widths[0], element.count)
            self._at = end
            return [starts]
        lengths = [p for p in element.properties if p.length is not None]
        steps = [
            (width - _size(p.length or ""), width, _size(p.type), self._reader(p.length or ""))
            for width, p in zip(widths, lengths, strict=False)
        ]
        alike = self._alike(element, steps, widths[-1])
        return self._row_by_row(element, steps, widths[-1]) if alike is None else alike

    def _alike(self, element: Element, steps: list[_Step], tail: int) -> list[_Evenly] | None:
        """The pieces' starts, if all rows' lists are as long as the first row's."""
        if element.count == 0:
            return [_Evenly(self._at, 1, 0)] * (len(steps) + 1)
        at, starts, lengths = self._at, [self._at], []
        for before, width, size, read in steps:
            try:
                lengths.append(read(at + before))
            except (IndexError, struct.error):
                raise self._cut_short(element, 0) from None
            at += width + size * lengths[-1]
            starts.append(at)
        stride = at + tail - self._at
        if self._at + stride * element.count > len(self._data):
            return None
        kinds = [p.length for p in element.properties if p.length is not None]
        for (before, *_), start, length, kind in zip(steps, starts, lengths, kinds, strict=False):
            there = np.ndarray((element.count,), self._order + kind, self._data, start + before, (stride,))
            if not (there == length).all():
                return None
        self._at += stride * element.count
        return [_Evenly(start, stride, element.count) for start in starts]

    def _row_by_row(self, element: Element, steps: list[_Step], tail: int) -> list[_Indices]:
        """The same where lists differ: each length leads to what follows."""
        starts: list[int] = []
        at = self._at
        append = starts.append
        try:
            for _ in range(element.count):
                for before, width, size, read in steps:
                    append(at)
                    at += width + size * read(at + before)
                append(at)
                at += tail
        except (IndexError, struct.error):
            at = len(self._data) + 1
        if at > len(self._data):
            raise self._cut_short(element, max(len(starts) - 1, 0) // (len(steps) + 1))
        self._at = at
        return list(np.array(starts, np.int64).reshape(element.count, -1).T)

    def _reader(self, kind: str) -> Callable[[int], int]:
        """Reads one length."""
        data = self._data
        if kind == "u1":
            return data.__getitem__
        unpack = struct.Struct(self._order + _LETTERS[kind]).unpack_from

        def read(at: int) -> int:
            (length,) = unpack(data, at)
            if length < 0 or length != int(length):
                raise ValueError(
                    f"a list has the length {length} at byte {at} behind the header; lengths are 0 or more"
                )
            return int(length)

        return read

    @staticmethod
    def _cut_short(element: Element, whole: int) -> ValueError:
        return ValueError(f"it is cut short: of {element.count} elements {element.name!r} {whole} are there")


_Step = tuple[int, int, int, Callable[[int], int]]  # bytes before a list's length; with it; of each value; reads it


def _size(kind: str) -> int:
    return int(kind[1])


class TextBody:
    """What follows the header of a file of text, a line for each row; elements are asked for in their order.

    Raises
    ------
    ValueError
        From each of the methods: a line can't be read, which is named; the file is cut short.
    """

    def __init__(self, text: bytes, start: int) -> None:
        self._text, self._start = text, start
        self._blocks = blocks(text, start)
        self._lines, self._offset = Lines(b""), start
        self._rows = np.empty(0, np.int64)  # of the block, not yet read

    def skip(self, element: Element) -> None:
        for _ in self._pieces(element):
            pass

    def scalars(self, element: Element, names: Sequence[str]) -> list[NDArray[Any]]:
        """The columns of those names, each of shape (count,)."""
        parts = [[columns[name][0] for name in names] for columns in self._tables(element)]
        return [np.concatenate([part[k] for part in parts] or [np.empty(0)]) for k in range(len(names))]

    def lists(self, element: Element, name: str) -> Lists:
        """The lists of that name."""
        parts = [columns[name] for columns in self._tables(element)]
        values = np.concatenate([values for values, _ in parts] or [np.empty(0)])
        counts = np.concatenate([counts for _, counts in parts] or [np.empty(0, np.int64)])
        return Lists(values.astype(np.int64), counts)

    def left(self) -> str:
        """What no element has asked for."""
        count = len(self._rows) + sum(int((Lines(block).words > 0).sum()) for _, block in self._blocks)
        return f"{count} lines" if count else ""

    def _pieces(self, element: Element) -> Iterator[_Indices]:
        """The element's rows, as lines of the block at hand, block by block."""
        missing = element.count
        while missing:
            if not len(self._rows):
                self._offset, block = next(self._blocks, (0, b""))
                if not block:
                    there = element.count - missing
                    raise ValueError(f"it is cut short: of {element.count} elements {element.name!r} {there} are there")
                self._lines = Lines(block)
                self._rows = np.flatnonzero(self._lines.words > 0)
            rows, self._rows = self._rows[:missing], self._rows[missing:]
            missing -= len(rows)
            if len(rows):
                yield rows

    def _tables(self, element: Element) -> Iterator[dict[str, tuple[NDArray[np.float64], _Indices]]]:
        for rows in self._pieces(element):
            try:
                yield self._table(element, rows)
            except BadLine as bad:
                offset = self._offset + int(self._lines.starts[bad.index])
                raise refusal(self._text, offset, bad.why) from None

    def _table(self, element: Element, rows: _Indices) -> dict[str, tuple[NDArray[np.float64], _Indices]]:
        """Each column's values and how many each row has."""
        lines = self._lines
        chosen = np.zeros(len(lines), np.bool_)
        chosen[rows] = True
        values = lines.numbers(chosen, np.float64, f"elements {element.name!r} are numbers")
        ends = np.cumsum(lines.words[rows])
        at = ends - lines.words[rows]
        columns = [p.name + (" (a list)" if p.length else "") for p in element.properties]
        why = f"elements {element.name!r} have {', '.join(columns)}"
        table = {}
        for prop in element.properties:
            counts = np.ones(len(rows), np.int64)
            if prop.length is not None:
                _refuse_rows(rows, at >= ends, why)
                lengths = values[at]
                _refuse_rows(
                    rows, ~((lengths >= 0) & (lengths < 1e9) & (lengths % 1 == 0)), "a list starts with its length"
                )
                counts, at = lengths.astype(np.int64), at + 1
            _refuse_rows(rows, at + counts > ends, why)
            found = values[_ranges(at, counts, 1)]
            if prop.length is not None and prop.type[0] in "iu" and len(found):
                wrong = ~(np.abs(found) < 2.0**62) | (found % 1 != 0)
                if wrong.any():
                    _refuse_rows(
                        rows,
                        np.bincount(np.repeat(np.arange(len(rows)), counts), wrong) > 0,
                        "values of lists are whole",
                    )
            table[prop.name] = (found, counts)
            at = at + counts
        _refuse_rows(rows, at < ends, why)
        return table


def _refuse_rows(rows: _Indices, wrong: NDArray[np.bool_], why: str) -> None:
    if wrong.any():
        raise BadLine(int(rows[np.argmax(wrong)]), why)
