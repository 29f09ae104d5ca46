# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""gltf_data: the JSON of a glTF 2.0 file, and its buffers and accessors as arrays.

Reference: Khronos Group 2021, "glTF 2.0 Specification" (ISO/IEC 12113:2022), 3.6 and 4.
"""

from __future__ import annotations

import base64
import json
import logging
import struct
from typing import Any
from urllib.parse import unquote, urlsplit

import numpy as np
from numpy.typing import NDArray

from sunfleck._arguments import integer
from sunfleck.io.source import Source

__all__ = ["Document"]

_log = logging.getLogger("sunfleck")

_COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}

# What Python takes for a value of the JSON and for the head of an object; both rounded up.
_VALUE_BYTES = 64
_OBJECT_BYTES = 256


class Document:
    """The file's tree, whose arrays are read when they are asked for.

    Raises
    ------
    ValueError
        The file is malformed, or larger than the source's limits allow.
    NotImplementedError
        It has another version, or requires an extension that is not among those ``supported``.
    OSError
        It can't be read.
    """

    def __init__(self, source: Source, supported: set[str]) -> None:
        self.source = source
        self._chunk: bytes | None = None
        data = source.read()
        if data[:4] == b"glTF":
            data = self._open_binary(data)
        source.take_bytes(_VALUE_BYTES * sum(map(data.count, (b",", b":", b"["))) + _OBJECT_BYTES * data.count(b"{"))
        self.tree: dict[str, Any] = json.loads(data.decode("utf-8-sig"))
        if not isinstance(self.tree, dict):
            raise ValueError("the JSON is not an object")
        version = str(self.tree["asset"]["version"])
        if version.split(".")[0] != "2":
            raise NotImplementedError(f"glTF version {version}; only version 2 is read")
        unknown = sorted(set(self.tree.get("extensionsRequired", [])) - supported)
        if unknown:
            raise NotImplementedError(
                f"the file requires {', '.join(map(str, unknown))}, which is not read; export it without"
            )
        self._buffers: dict[int, bytes] = {}
        self._made: dict[int, NDArray[Any]] = {}
        self._noted: set[str] = set()

    def note(self, message: str) -> None:
        """Says something of the file, once."""
        if message not in self._noted:
            self._noted.add(message)
            _log.info("%s: %s", self.source.path, message)

    def _open_binary(self, data: bytes) -> bytes:
        """The JSON chunk of a .glb; the binary one is kept for the first buffer."""
        version, length, size, kind = struct.unpack("<IIII", data[4:20])
        if version != 2:
            raise NotImplementedError(f"glTF version {version}; only version 2 is read")
        if length > len(data) or kind != 0x4E4F534A or 20 + size > length:
            raise ValueError(f"the file is cut short, or not a glTF: {len(data)} bytes of {length}")
        after = 20 + size
        if after + 8 <= length:
            chunk, kind = struct.unpack("<II", data[after : after + 8])
            if kind == 0x004E4942:
                self._chunk = data[after + 8 : after + 8 + chunk]
        return data[20 : 20 + size]

    def item(self, kind: str, index: Any) -> dict[str, Any]:
        """An object of a top-level list; Python's negative indices are not glTF's."""
        if not isinstance(index, int) or not 0 <= index < len(self.tree.get(kind, [])):
            raise ValueError(f"{kind}[{index!r}] is referred to, and does not exist")
        item = self.tree[kind][index]
        if not isinstance(item, dict):
            raise ValueError(f"{kind}[{index}] is {item!r}, not an object")
        return item

    # ---- buffers ----

    def _buffer(self, index: int) -> bytes:
        if index not in self._buffers:
            buffer = self.item("buffers", index)
            data, size = self._fetch(buffer.get("uri"), index), buffer["byteLength"]
            if len(data) < size:
                raise ValueError(f"buffers[{index}] holds {len(data)} bytes; the file says {size}")
            self._buffers[index] = data
        return self._buffers[index]

    def _fetch(self, uri: str | None, index: int) -> bytes:
        if uri is None:
            if index != 0 or self._chunk is None:
                raise ValueError(f"buffers[{index}] has no data")
            return self._chunk
        if uri.startswith("data:"):
            text = uri.partition(",")[2]
            self.source.take_bytes(2 * len(text))  # the text apart, and what it says
            return base64.b64decode(text, validate=True)
        parts = urlsplit(uri)
        if parts.scheme not in ("", "file") or parts.netloc not in ("", "localhost"):
            raise NotImplementedError(f"{uri!r} is not a file beside this one; nothing is fetched from elsewhere")
        return self.source.read_beside(unquote(parts.path))

    def _view(self, index: Any, offset: int) -> tuple[memoryview, int | None]:
        """The bytes of a buffer view from an offset on, and its stride."""
        view = self.item("bufferViews", index)
        start, length = view.get("byteOffset", 0), view["byteLength"]
        data = memoryview(self._buffer(view["buffer"]))
        if start < 0 or offset < 0 or offset > length or start + length > len(data):
            raise ValueError(f"bufferViews[{index}] reaches beyond its buffer of {len(data)} bytes")
        return data[start + offset : start + length], view.get("byteStride")

    # ---- accessors ----

    def _array(self, place: dict[str, Any], count: int, component: Any, width: int) -> NDArray[Any]:
        """`count` rows in a buffer view, without a copy; NumPy refuses what lies beyond it."""
        dtype = np.dtype(_COMPONENTS[component])
        data, stride = self._view(place["bufferView"], place.get("byteOffset", 0))
        if count < 1 or (stride is not None and stride < width * dtype.itemsize):
            raise ValueError(f"an accessor of {count} rows, {stride} bytes apart")
        strides = (stride or width * dtype.itemsize, dtype.itemsize)
        rows: NDArray[Any] = np.ndarray((count, width), dtype, data, strides=strides)
        return rows

    def count(self, index: Any) -> int:
        """How many rows an accessor says that it has."""
        return integer(f"accessors[{index}].count", self.item("accessors", index)["count"])

    def accessor(self, index: Any) -> NDArray[Any]:
        """Shape (count, width), integers where they are not normalized; not to be written to.

        An accessor without a buffer view is zeros (3.6.2.3), but for what is sparse.
        """
        if index in self._made:
            return self._made[index]
        accessor = self.item("accessors", index)
        count, component, width = accessor["count"], accessor["componentType"], _WIDTHS[accessor["type"]]
        sparse = accessor.get("sparse")
        if "bufferView" in accessor and not sparse and not accessor.get("normalized"):
            return self._array(accessor, count, component, width)
        count = self.count(index)
        self.source.take_bytes(count * width * (np.dtype(_COMPONENTS[component]).itemsize + 8))
        if "bufferView" in accessor:
            values = self._array(accessor, count, component, width)
        else:
            values = np.zeros((count, width), _COMPONENTS[component])
        if sparse:
            values = values.copy()
            changed = sparse["count"]
            rows = self._array(sparse["indices"], changed, sparse["indices"]["componentType"], 1)
            values[rows[:, 0]] = self._array(sparse["values"], changed, component, width)
        if accessor.get("normalized") and values.dtype.kind in "iu":
            values = values.astype(np.float32) / np.float32(np.iinfo(values.dtype).max)
            np.maximum(values, np.float32(-1), out=values)
        self._made[index] = values
        return values
