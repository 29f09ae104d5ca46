# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""image: channels of a film written, pictures of single channels, radiance read, through OpenImageIO."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sunfleck.exposure import encode_srgb
from sunfleck.io.files import FilePath, ending, given_path, known_ending, replacing, writable_target
from sunfleck.io.source import Limits, Source

__all__ = [
    "IMAGE_TYPES",
    "RADIANCE_TYPES",
    "encode_color",
    "encode_srgb",
    "false_color",
    "png_bytes",
    "read_radiance",
    "write_channels",
    "write_false_color",
]

IMAGE_TYPES = (".exr", ".png")
RADIANCE_TYPES = (".exr", ".hdr", ".pfm")

Channels = Sequence[tuple[str, NDArray[Any]]]

# Every 15th of the 256 colours of viridis (Smith & van der Walt 2015, released as CC0): straight
# lines between them stay within 5/255 of the whole table.
_VIRIDIS = np.array(
    [
        (68, 1, 84), (72, 23, 105), (71, 42, 122), (67, 61, 132), (61, 78, 138), (53, 94, 141),
        (46, 109, 142), (41, 123, 142), (35, 137, 142), (31, 151, 139), (33, 165, 133), (46, 179, 124),
        (70, 192, 111), (101, 203, 94), (137, 213, 72), (176, 221, 47), (216, 226, 25), (253, 231, 37),
    ]
)  # fmt: skip


def false_color(values: ArrayLike, low: float | None = None, high: float | None = None) -> NDArray[np.uint8]:
    """Values as colours from dark blue (low) to yellow (high), on a logarithmic scale.

    The colours are viridis: even steps to the eye, also to colour-blind ones and in grey.

    Parameters
    ----------
    values : array_like, shape (h, w)
        At least 0; infinite values become white.
    low, high : float, optional
        The ends of the scale, above 0. None: the smallest positive and the largest finite value.

    Returns
    -------
    ndarray of uint8, shape (h, w, 3)

    Examples
    --------
    >>> from sunfleck.io.image import false_color
    >>> false_color([[1, 100]]).tolist()
    [[[68, 1, 84], [253, 231, 37]]]
    """
    x = np.asarray(values, dtype=np.float64)
    finite = np.isfinite(x)
    positive = x[finite & (x > 0)]
    low = low if low is not None else positive.min(initial=np.inf)
    high = high if high is not None else positive.max(initial=0)
    if low < high:
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.clip(np.log(x / low) / np.log(high / low), 0, 1)
        t = np.where(finite, t, 1)
    else:  # one value only: one colour
        t = np.zeros_like(x)
    steps = np.linspace(0, 1, len(_VIRIDIS))
    colors = np.stack([np.interp(t, steps, column) for column in _VIRIDIS.T], axis=-1)
    colors[~finite] = 255
    return (colors + 0.5).astype(np.uint8)


def _exr(channels: Channels) -> NDArray[np.float32]:
    """Every channel, as float32: counts up to 2^24 are exact."""
    height, width = channels[0][1].shape
    pixels = np.empty((height, width, len(channels)), dtype=np.float32)
    for index, (_, values) in enumerate(channels):
        pixels[..., index] = values
    return pixels


def encode_color(channels: Channels, stops: float = 0.0) -> NDArray[np.uint8]:
    """R, G and B times 2^stops as 8-bit sRGB, shape (h, w, 3); nothing else is kept."""
    named = dict(channels)
    with np.errstate(over="ignore"):  # becomes infinite, which is white
        return np.stack([encode_srgb(named[name] * np.float32(2.0**stops)) for name in "RGB"], axis=-1)


def _write(path: FilePath, pixels: NDArray[Any], names: Sequence[str], attributes: Mapping[str, str]) -> None:
    import OpenImageIO as oiio

    height, width, count = pixels.shape
    spec = oiio.ImageSpec(width, height, count, oiio.TypeDesc(str(pixels.dtype).replace("float32", "float")))
    spec.channelnames = tuple(names)
    spec.attribute("Software", "sunfleck")
    spec.alpha_channel = list(names).index("A") if "A" in names else -1
    spec.attribute("oiio:ColorSpace", "sRGB" if pixels.dtype == np.uint8 else "Linear")
    if pixels.dtype != np.uint8:
        spec.attribute("compression", "zip")
    for name, text in attributes.items():
        spec.attribute(f"sunfleck:{name}", text)
    with replacing(path, "pictures", IMAGE_TYPES) as beside:
        output = oiio.ImageOutput.create(str(beside))
        if not output:
            raise OSError(f"can't write {str(path)!r}: {oiio.geterror()}")
        done = output.open(str(beside), spec) and output.write_image(pixels)
        reason = output.geterror()
        closed = output.close()
        reason += output.geterror()  # PNG's writer notes a full disk here, and returns True
        if reason or not (done and closed):
            raise OSError(f"can't write {str(path)!r}: {' '.join(reason.split())}")


def write_channels(path: FilePath, channels: Channels, attributes: Mapping[str, str], stops: float = 0.0) -> None:
    """Writes a film's list of channels, by the path's ending.

    ``.exr``: one part, float32, linear, every channel in order, and every attribute as
    "sunfleck:NAME". ``.png``: 8 bits, R, G and B times 2^stops, sRGB, values beyond [0, 1] clipped.

    The file is written beside and renamed, so that a failure leaves whatever was there.

    Raises
    ------
    ValueError
        Another ending.
    OSError
        The file can't be written; with the reason.
    """
    writable_target(path, "pictures", IMAGE_TYPES)  # before the pixels are put together
    if ending(path) == ".png":
        _write(path, encode_color(channels, stops), "RGB", {})
    else:
        _write(path, _exr(channels), [name for name, _ in channels], attributes)


def png_bytes(channels: Channels, stops: float = 0.0) -> bytes:
    """What `write_channels` writes into a .png."""
    with tempfile.TemporaryDirectory(prefix="sunfleck-") as folder:  # OpenImageIO's Python writes files only
        path = Path(folder, "picture.png")
        write_channels(path, channels, {}, stops)
        return path.read_bytes()


def write_false_color(path: FilePath, values: ArrayLike, low: float | None = None, high: float | None = None) -> None:
    """Writes `false_color` of the values as a PNG.

    Raises
    ------
    ValueError
        Another ending.
    OSError
        The file can't be written; with the reason.
    """
    writable_target(path, "false colours", (".png",))
    _write(path, false_color(values, low, high), "RGB", {})


def read_radiance(path: FilePath, limits: Limits | None = None) -> NDArray[np.float32]:
    """The first three channels of a file of linear values; a single one stands for all three.

    Parameters
    ----------
    path : path-like
        Ending in .exr, .hdr or .pfm.
    limits : Limits, optional
        Of its pixels and bytes. None: ``Limits()``.

    Returns
    -------
    ndarray of float32, shape (h, w, 3)

    Raises
    ------
    ValueError
        Another ending, or two channels; a picture beyond the limits.
    OSError
        The file can't be read, or is no ordinary file; with the reason.
    """
    given = given_path(path)
    known_ending(given, RADIANCE_TYPES, "radiance, which is linear, is read from")
    file = Source(given, limits=limits)
    file.check()
    import OpenImageIO as oiio

    source = oiio.ImageInput.open(given)
    if not source:
        raise OSError(f"can't read {given!r}: {' '.join(oiio.geterror().split())}")
    spec = source.spec()
    try:
        file.take_picture(spec.width, spec.height)
        file.take_bytes(4 * spec.width * spec.height * (spec.nchannels + 3))
    except ValueError as error:
        source.close()
        raise ValueError(f"{given!r}: {error}") from error
    pixels = source.read_image(oiio.FLOAT)
    reason = source.geterror()
    source.close()
    if pixels is None or reason:
        raise OSError(f"can't read {given!r}: {' '.join(reason.split())}")
    if pixels.ndim == 2 or pixels.shape[2] == 1:
        pixels = np.repeat(pixels.reshape(*pixels.shape[:2], 1), 3, axis=2)
    if pixels.shape[2] < 3:
        raise ValueError(f"{given!r} has {pixels.shape[2]} channels; radiance has 1 or 3")
    return np.ascontiguousarray(pixels[..., :3], dtype=np.float32)
