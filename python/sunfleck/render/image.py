# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""image: a rendered picture and its statistics, which saves, shows and pickles itself."""

from __future__ import annotations

import logging
import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sunfleck import _core
from sunfleck._arguments import choice
from sunfleck.exposure import blank, exposure_of, stops
from sunfleck.io.files import FilePath, ending
from sunfleck.io.image import png_bytes, write_channels, write_false_color
from sunfleck.plot.figure import Figure
from sunfleck.plot.heatmap import heatmap
from sunfleck.render.summary import Summary

__all__ = ["Image"]

_log = logging.getLogger("sunfleck")


class Image:
    """A rendered picture and its statistics. Made by `render` and `merge`.

    Attributes
    ----------
    color : ndarray of float32, shape (h, w, 3)
        Mean radiance, linear RGB, at least 0; below it beside bright things under a filter with
        negative lobes. Row 0 is the top.
    alpha : ndarray of float32, shape (h, w)
        Share of samples that hit a surface, in [0, 1].
    samples : ndarray of uint32, shape (h, w)
        Samples taken.
    half_width : ndarray of float32, shape (h, w)
        Bounds the error of (R+G+B)/3 at the confidence asked for; infinite below 2 samples.
    stop_reason : ndarray of uint8, shape (h, w)
        Why the pixel stopped: an index into `sunfleck.STOP_REASONS`.
    aovs : dict of str to ndarray of float32, shape (h, w, 3) or (h, w)
        Those that were asked for, by name; see `render`.
    channels : list of (str, ndarray)
        All of these as they are written: R G B A samples half_width stop_reason, then the AOVs'
        (albedo.R …, normal.X …, Z, variance, half_a.R …, half_b.R …).
    metadata : dict of str to str
        Every option as it was used, the seed, version, instruction set, and what came of it.
    interrupted : bool
        Whether the render was stopped before its time, by Ctrl-C or by ``progress``.
    exposure : float or "auto"
        With which it is shown and saved as PNG where none is given: the scene's; see `save`.

    Notes
    -----
    The arrays are read-only views of the library's memory, which lives as long as any of them.
    In a notebook an image shows its colours. A pickle has the whole film, some 120 bytes a pixel: images that
    other processes rendered come back to be merged.
    """

    def __init__(self, film: _core.Film, exposure: float | str = 0.0) -> None:
        self._film = film
        self.exposure = exposure
        self.width: int = film.width
        self.height: int = film.height
        self.channels: list[tuple[str, NDArray[Any]]] = film.channels()
        named = dict(self.channels)
        self.color: NDArray[np.float32] = film.color()
        self.alpha: NDArray[np.float32] = named["A"]
        self.samples: NDArray[np.uint32] = named["samples"]
        self.half_width: NDArray[np.float32] = named["half_width"]
        self.stop_reason: NDArray[np.uint8] = named["stop_reason"]
        self.aovs: dict[str, NDArray[np.float32]] = film.aovs()
        self.metadata: dict[str, str] = film.attributes()

    @property
    def interrupted(self) -> bool:
        return self._film.signalled or self.summary().reasons["interrupted"] > 0

    def summary(self) -> Summary:
        """What the render came to; printed, it is a line (`Summary.line`) and a small table."""
        counts = self._film.summary()
        share = float(self.metadata["relative_tolerance"]) * counts["level"]
        counts["goal"] = float(self.metadata["relmse"])
        return Summary(**counts, relative=share > 0 and share >= float(self.metadata["absolute_tolerance"]))

    def save(self, path: FilePath, exposure: float | str | None = None) -> None:
        """Writes the picture, by the path's ending.

        ``.exr``: one part, float32, linear: every channel, and the metadata as "sunfleck:NAME".
        ``.png``: 8-bit sRGB, values beyond [0, 1] clipped.

        The file is written beside and renamed: a failure leaves whatever was there.

        Parameters
        ----------
        path : path-like
        exposure : float or "auto", optional
            Of a PNG: its colours are the radiance times 2^exposure, so that 1 is twice as bright. "auto" brings
            nine tenths of what is lit below 0.8 of white, and says through ``logging`` which number that is.
            None: the image's own `exposure`, which is 0 but for files in photometric units.

        Raises
        ------
        ValueError
            Another ending; an exposure out of its range, or of what is not a PNG.
        TypeError
            An exposure that is no number.
        OSError
            The file can't be written; with the reason.
        """
        chosen = self.exposure if exposure is None else exposure_of(exposure)
        if ending(path) != ".png":
            if exposure is not None:
                raise ValueError(
                    f"exposure is {exposure!r}; {os.fspath(path)!r} holds radiance, only a .png is exposed"
                )
            write_channels(path, self.channels, self.metadata)
            return
        number = stops(chosen, self.color)
        write_channels(path, self.channels, self.metadata, number)
        if chosen == "auto":
            _log.info("%s: exposure %.2f stops, chosen by what is lit", os.fspath(path), number)
        reason = blank(self.color, number)
        if reason:
            _log.warning("%s: %s", os.fspath(path), reason)

    def save_map(self, channel: str, path: FilePath) -> None:
        """Writes one channel as a PNG in false colours: dark blue is low, yellow high, logarithmic.

        Parameters
        ----------
        channel : str
            "samples", "half_width", or another of ``channels``.
        path : path-like
            Ending in .png.

        Raises
        ------
        ValueError
            An unknown channel, or another ending.
        OSError
            The file can't be written; with the reason.
        """
        named = dict(self.channels)
        write_false_color(path, named[choice("channel", channel, named, "the image has")])

    def heatmap(self, channel: str = "samples") -> Figure:
        """A channel in colours, with its scale and unit; it shows itself in a notebook.

        Parameters
        ----------
        channel : "samples", "half_width" or "stop_reason"
            Counts and half-widths have a logarithmic scale from dark to light, the tolerance is
            marked on it, and pixels of which nothing is known are grey. Stop reasons have a
            colour each, and the share of their pixels. All are told apart with every kind of
            colour vision. A pixel of the image is a whole number of the figure's.

        Returns
        -------
        sunfleck.plot.figure.Figure
            With ``save`` to .png or .svg.

        Raises
        ------
        ValueError
            Another channel.
        sunfleck.Error
            matplotlib is not installed.

        Examples
        --------
        >>> import sunfleck as sf
        >>> image = sf.render(sf.scenes.penumbra(), 32, 24, tolerance=0.1)
        >>> image.heatmap("half_width").png()[1:4]
        b'PNG'
        """
        return heatmap(dict(self.channels), channel, self.metadata)

    def __reduce__(self) -> tuple[Any, ...]:
        with tempfile.TemporaryDirectory(prefix="sunfleck-") as folder:  # C writes files only
            path = Path(folder, "image")
            self._film.save(str(path))
            return _make_image, (path.read_bytes(), self._film.signalled, self.exposure)

    def __copy__(self) -> Image:
        return self

    def _repr_png_(self) -> bytes:
        return png_bytes(self.channels, stops(self.exposure, self.color))

    def __repr__(self) -> str:
        return f"Image({self.width} x {self.height}, {int(self.samples.sum(dtype=np.uint64))} samples)"


def _make_image(film: bytes, signalled: bool, exposure: float | str) -> Image:
    """An image from its film's file: what a pickle of one calls."""
    with tempfile.TemporaryDirectory(prefix="sunfleck-") as folder:
        path = Path(folder, "image")
        path.write_bytes(film)
        loaded = _core.load_film(str(path))
    loaded.signalled = signalled
    return Image(loaded, exposure)
