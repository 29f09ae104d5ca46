# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""render: a scene and options in, an image out that says per pixel how far it may be off."""

from __future__ import annotations

import logging
import math
import os
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sunfleck import _core
from sunfleck._arguments import array_of, choice, flag, integer, number, text
from sunfleck._core import Progress
from sunfleck.error import CheckpointError
from sunfleck.exposure import blank, exposure_of, stops, why_black
from sunfleck.io.files import FilePath, ending, given_path
from sunfleck.io.image import png_bytes, write_channels, write_false_color
from sunfleck.plot.figure import Figure
from sunfleck.plot.heatmap import heatmap
from sunfleck.scene import Scene
from sunfleck.tolerance import Tolerance

__all__ = [
    "AOVS",
    "PIXEL_FILTERS",
    "RENDER_PATTERNS",
    "STOP_REASONS",
    "Image",
    "Progress",
    "Summary",
    "merge",
    "render",
]

_log = logging.getLogger("sunfleck")

STOP_REASONS: tuple[str, ...] = tuple(_core.stop_reasons())
"""The names of the numbers in `Image.stop_reason`."""

AOVS: tuple[str, ...] = tuple(_core.aov_names())
"""What an image can hold beside the colours; see `render`."""

RENDER_PATTERNS: tuple[str, ...] = tuple(_core.render_patterns())
"""The patterns that a picture can be rendered with."""

PIXEL_FILTERS: tuple[str, ...] = tuple(_core.pixel_filters())
"""What a pixel can average over: the mappings pixel_NAME; see `render`."""


@dataclass(frozen=True)
class Summary:
    """What a render came to, over the image's pixels; those that a mask leaves out count nowhere.

    Attributes
    ----------
    pixels, samples : int
        Pixels, and the samples that they took.
    traced_samples : int
        With those of the crop's and the mask's margin.
    reasons : dict of str to int
        Pixels by stop reason. They add up to ``pixels``.
    nonfinite_samples : int
        Samples that were NaN or infinite: dropped, never averaged in.
    level : float
        Mean of (R+G+B)/3 that a relative tolerance refers to.
    tolerance : float
        In linear radiance; 0 where none was asked for.
    confidence : float
        Of the half-widths.
    worst_half_width, mean_half_width : float
        In linear radiance.
    relmse : float
        Estimate of the mean over pixels and channels of (x − r)² / (r² + 0.01), from the variances that
        the half-widths came from; infinite where a pixel has fewer than two samples.
    worst_pixel : tuple of 2 ints
        (x, y) of the worst half-width, in pixels of the full frame.
    seconds : float
        That the render took.
    threads, rounds : int
        As used.
    work : dict of str to float
        With ``profile``: seconds of all threads by what they did ("camera rays", "shadow rays" and
        "surface rays" are Embree's, with the packing of packets). What is left of ``threads *
        seconds`` is decisions and waiting.
    relative : bool
        Whether the tolerance was asked for as a share of the level.
    goal : float
        The relMSE that was asked for; 0 where none was.
    """

    pixels: int
    samples: int
    traced_samples: int
    reasons: dict[str, int]
    nonfinite_samples: int
    level: float
    tolerance: float
    confidence: float
    worst_half_width: float
    worst_pixel: tuple[int, int]
    mean_half_width: float
    seconds: float
    threads: int
    rounds: int
    work: dict[str, float] = field(default_factory=dict)
    relative: bool = False
    relmse: float = math.inf
    goal: float = 0.0

    @property
    def share_met(self) -> float:
        """Share of pixels that met the tolerance, in [0, 1]."""
        return self.reasons["met"] / self.pixels

    @property
    def line(self) -> str:
        """The render in one line: how many pixels met what was asked for, and the worst one.

        Where the tolerance was a share of the level, so is the worst half-width; else both are
        linear radiance.
        """
        unit = self.level if self.relative else 1.0
        x, y = self.worst_pixel
        worst = f"worst {self.worst_half_width / unit:.3g} at ({x}, {y})"
        confidence = f"at {100 * self.confidence:g} %"
        early = "".join(f", {_percent(self._share(r))} {r}" for r in ("out of time", "interrupted") if self.reasons[r])
        if self.tolerance > 0:
            met = f"{_percent(self.share_met)} of pixels met {self.tolerance / unit:.3g} {confidence}"
            return f"{met}{early}; {worst}"
        early = early.replace("100 % ", "")
        samples = f"{self.samples / self.pixels:.4g} samples a pixel{early}"
        if self.goal > 0:
            reached = "reached" if self.relmse <= self.goal else "not reached"
            relmse = f"relMSE {self.relmse:.3g}, {reached}: {self.goal:.3g} was asked for"
            return f"{relmse}; {samples}; {worst} {confidence}"
        return f"{samples}; half-width {confidence}: mean {self.mean_half_width:.3g}, {worst}"

    def _share(self, reason: str) -> float:
        return self.reasons[reason] / self.pixels

    def __str__(self) -> str:
        counts = ", ".join(f"{count} {reason}" for reason, count in self.reasons.items() if count)
        rate = self.samples / self.seconds / 1e6 if self.seconds > 0 else 0.0
        lines = [
            self.line,
            f"pixels      {self.pixels}: {counts}",
            f"samples     {self.samples}, {self.samples / self.pixels:.1f} a pixel",
            f"time        {self.seconds:.2f} s on {self.threads} threads: {rate:.1f} million samples a second",
            f"half-width  {self.mean_half_width:.3g} mean, {self.worst_half_width:.3g} worst at pixel "
            f"{self.worst_pixel}, {100 * self.confidence:g} % confidence",
        ]
        if self.tolerance > 0:
            share = f"{self.tolerance / self.level:.3g} of the level {self.level:.3g}: " if self.relative else ""
            lines.insert(1, f"tolerance   {share}{self.tolerance:.3g} in linear radiance")
        if self.work:
            lines.append("work        nanoseconds of a thread by the path, and share")
            whole = self.threads * self.seconds
            rest = {"decisions, waiting": whole - sum(self.work.values())}
            for name, seconds in (self.work | rest).items():
                lines.append(f"  {name:<20}{1e9 * seconds / self.traced_samples:8.2f}  {100 * seconds / whole:4.1f} %")
        if self.nonfinite_samples:
            lines.append(f"dropped     {self.nonfinite_samples} samples that were not finite")
        return "\n".join(lines)


def _percent(share: float) -> str:
    """Rounded down to a tenth, so that only a whole is called 100 %."""
    return f"{math.floor(1000 * share) / 10:.1f} %" if share < 1 else "100 %"


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


def _tolerance(value: float | Tolerance | None) -> tuple[float, float]:
    """Relative and absolute; both 0 where none is asked for."""
    if value is None:
        return 0.0, 0.0
    if not isinstance(value, Tolerance):
        value = Tolerance(relative=number("tolerance", value))
    return value.relative, value.absolute


def _count(name: str, value: int | None, bits: int = 32) -> int:
    """A count that may be None, which is C's 0; so that 0 itself must be refused here."""
    if value is None:
        return 0
    count = integer(name, value, bits=bits)
    if count == 0:
        raise ValueError(f"{name} is 0; give at least 1, or None")
    return count


def _above_zero(name: str, value: float | None, refusal: str) -> float:
    """A number that may be None, which is C's 0; so that 0 itself must be refused here, in these words."""
    if value is None:
        return 0.0
    given = number(name, value)
    if given == 0:
        raise ValueError(f"{name} is 0{refusal}")
    return given


def _crop(value: Sequence[int] | None) -> tuple[int, int, int, int]:
    if value is None:
        return 0, 0, 0, 0
    try:
        x0, y0, x1, y1 = value
    except (TypeError, ValueError):
        raise ValueError(f"crop is {value!r}; give (x0, y0, x1, y1), half open, in pixels of the full frame") from None
    names = ("x0", "y0", "x1", "y1")
    crop = [integer(f"crop {name}", v, bits=32) for name, v in zip(names, (x0, y0, x1, y1), strict=True)]
    if not any(crop):
        raise ValueError("crop is (0, 0, 0, 0), which is empty; give x0 < x1 and y0 < y1")
    return crop[0], crop[1], crop[2], crop[3]


def _aovs(value: Sequence[str]) -> list[str]:
    if isinstance(value, str):
        value = [name.strip() for name in value.split(",") if name.strip()]
    try:
        names = list(value)
    except TypeError:
        raise TypeError(f"aovs is {value!r}; give names of {', '.join(AOVS)}") from None
    return [text("aovs", name) for name in names]


def _mask(value: ArrayLike | None) -> NDArray[np.uint8] | None:
    """As bytes, without a copy where it can be."""
    if value is None:
        return None
    mask = array_of("mask", value)
    if mask.dtype not in (np.bool_, np.uint8):
        raise TypeError(f"mask has dtype {mask.dtype}; give bool or uint8")
    if mask.ndim != 2:
        raise ValueError(f"mask has shape {mask.shape}; give (height, width)")
    return np.ascontiguousarray(mask).view(np.uint8)


class _Bar:
    """A tqdm bar: samples of a fixed count, or pixels that are done."""

    def __init__(self) -> None:
        from tqdm import tqdm

        self._bar = tqdm(unit="px", dynamic_ncols=True, leave=False)

    def __call__(self, progress: Progress) -> None:
        if progress.expected_samples:
            self._bar.unit, self._bar.total, self._bar.unit_scale = "sample", progress.expected_samples, True
            self._bar.update(progress.samples - self._bar.n)
            return
        self._bar.total = progress.pixels
        spent = f"{progress.samples / progress.pixels:.0f} samples a pixel"
        if progress.time_limit:
            spent += f", {progress.seconds:.0f} of {progress.time_limit:g} s"
        if progress.relmse > 0:
            spent = f"relMSE {progress.relmse:.2g}, {spent}"
        if progress.tolerance > 0:
            spent = f"{_percent(progress.pixels_met / progress.pixels)} met, {spent}"
        self._bar.set_postfix_str(spent, refresh=False)
        self._bar.update(progress.pixels_done - self._bar.n)

    def close(self) -> None:
        self._bar.close()


def render(
    scene: Scene,
    width: int = 512,
    height: int = 512,
    *,
    spp: int | None = None,
    start: int = 0,
    tolerance: float | Tolerance | None = None,
    relmse: float | None = None,
    confidence: float = 0.95,
    min_spp: int = 32,
    max_spp: int = 4096,
    samples: int | None = None,
    seconds: float | None = None,
    pattern: str = "sobol",
    pixel_filter: str = "box",
    stop: str = "dyadic",
    unbiased: bool = False,
    seeds: str = "pixel",
    seed: int = 0,
    threads: int | None = None,
    tile_size: int = 16,
    roulette: int = 0,
    profile: bool = False,
    crop: Sequence[int] | None = None,
    aovs: Sequence[str] = (),
    mask: ArrayLike | None = None,
    checkpoint: FilePath | None = None,
    checkpoint_seconds: float = 30.0,
    progress: bool | Callable[[Progress], object] | None = None,
) -> Image:
    """Renders a scene to a stated accuracy, a fixed count of samples, or a time.

    Parameters
    ----------
    scene : Scene
    width, height : int
        Of the full frame, in pixels, 1 to 65,536.
    spp : int, optional
        A fixed count of samples a pixel; not with ``tolerance``.
    start : int
        Index of the first of ``spp`` samples: a picture's samples can be had in parts.
    tolerance : float or Tolerance, optional
        A pixel is done when its half-width is within it. A plain number is relative to the
        level: the mean of (R+G+B)/3 over the frame after ``min_spp``. With nothing given: 0.01.
    relmse : float, optional
        A goal for the whole picture in place of a tolerance: that the mean over pixels and channels of
        (x − r)² / (r² + 0.01), by what the half-widths came from, be at most this. Samples go where one more
        lowers it most, which takes the fewest: pixels end with half-widths of their own. Not with ``spp``,
        ``tolerance`` or ``samples``.
    confidence : float
        Of the half-widths, per pixel, in (0, 1).
    min_spp, max_spp : int
        Samples a pixel before the first decision, and at the most.
    samples : int, optional
        A budget of samples of the whole picture, alone or with ``seconds``: they go where they
        lower the largest half-width most.
    seconds : float, optional
        A time limit. Alone it is a budget, spent likewise.
    pattern : str
        One of `sunfleck.RENDER_PATTERNS`.
    pixel_filter : str
        What a pixel averages over, one of `sunfleck.PIXEL_FILTERS`: "box" (itself), "tent" (two
        pixels' width), "gaussian" (sigma 0.4 pixel), "gaussian_truncated" (the same within 1.5
        pixels), "blackman_harris" (three pixels' width), and two with negative lobes, "mitchell"
        (four pixels' width, B = C = 1/3) and "lanczos" (six). A constant image stays exact under each,
        at any number of samples. The last two need more samples for the same half-width, take
        104 bytes more a pixel, and may leave pixels below 0.
    stop : "dyadic", "replicates" or "standard-error"
        The rule by which a pixel's half-width is told from its samples. "dyadic": from the
        differences between the halves of its sequence, the halves' halves, …, shared with its
        neighbours; it looks at 32, 64, 128, … samples. "replicates": eight independent copies of
        the pattern and Student's t, at 128, 256, … samples. "standard-error": the classic
        z·s/√N, which takes a pattern's points for independent.
    unbiased : bool
        Two stages: a pilot decides each pixel's count by the rule, and gives half-width and stop
        reason; then a second, independent set of as many samples is averaged. It ends a bias of
        rules that stop on the samples they average, and costs as much again: of ``samples`` and
        ``seconds`` the pilot has half. Not with ``spp``, which has no bias.
    seeds : "pixel", "thread" or "shared"
        How threads come by random numbers: keyed by pixel; a stream for each thread; the same
        stream for all, which repeats their noise and is there to be seen.
    seed : int
        In [0, 2^64).
    threads : int, optional
        1 to 1,024. None: one for each processor.
    tile_size : int
        Pixels a side that a thread takes at a time: a multiple of 8, 8 to 1,024.
    roulette : int
        The bounce from which on paths end by Russian roulette, 2 to 64; 0 is never. A path goes on with
        the probability of its throughput's largest channel, 1/32 at least, by which it is then divided:
        the mean stays the same, with less work a sample and more noise.
    crop : (x0, y0, x1, y1), optional
        Half open, in pixels of the full frame; the image has the crop's size.
    profile : bool
        Whether the summary is to tell what the threads' time went to; see `Summary`. Costs up to
        1 % of the time; the picture is the same.
    aovs : sequence of str, or str with commas between
        What `Image.aovs` is to hold, of `sunfleck.AOVS`. Of the camera rays' first hits, averaged
        over the pixel's samples: "albedo" (a light's own, without its emission), "normal" (unit
        normals, facing the viewer) — both 0 in samples that hit nothing — and "depth" (along the
        camera's axis, over the samples that hit; infinite where none did). "variance": of the
        pixel's mean of (R+G+B)/3, as the half-width has it. "half_a", "half_b": the means over the
        even and the odd blocks of 16 samples; give at least 32 samples for both.
    mask : array_like of bool or uint8, shape (height, width), optional
        Which pixels of the full frame to render, whatever the crop: those not 0. The others have
        no samples, an infinite half-width and the stop reason "masked". Costs whole cells of 8 x 8
        pixels, as a crop does.
    checkpoint : path-like, optional
        A file that the state of the render is written to while it runs, when it is stopped and at
        its end, and that it goes on from where the file exists, bit for bit as if it had never
        stopped. ``spp``, ``max_spp`` and ``seconds`` may be larger than the file's, the tolerance or
        ``relmse`` smaller: what was sampled is kept. Any other difference is refused. Not with other
        ``seeds`` than "pixel".
    checkpoint_seconds : float
        Between two writes while the render runs; at least 0.
    progress : bool or callable, optional
        True: a bar on stderr. A callable gets a `Progress` after every round and may return
        False to stop.

    Returns
    -------
    Image

    Raises
    ------
    ValueError, TypeError
        An option out of its range or of the wrong kind, which is named, before any work.
    MemoryError
        No memory for the film.
    OSError
        The checkpoint can't be read, or no file can be written there; before any work.
    sunfleck.CheckpointError
        The last write of the checkpoint failed (the old file is left); its ``image`` is the
        picture. A write that fails earlier is a warning of the logger "sunfleck".
    sunfleck.Error
        Embree reported an error of its own.

    Notes
    -----
    With ``seeds="pixel"`` the same scene, options and seed give the same picture bit for bit,
    for any ``threads`` and ``tile_size``, on one instruction set. The pixels of
    a crop or a mask are those of the full frame bit for bit with ``spp``, and with an absolute
    tolerance under the rule "standard-error"; a relative tolerance has the mean of the pixels of
    the picture for its level.
    Releases the GIL. Ctrl-C
    stops the render and returns the partial picture, its unfinished pixels marked interrupted.

    Examples
    --------
    >>> import sunfleck as sf
    >>> image = sf.render(sf.scenes.penumbra(), 32, 24, spp=16)
    >>> image.color.shape, int(image.samples.min())
    ((24, 32, 3), 16)
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"scene is {scene!r}; give a sunfleck.Scene")
    if spp is not None and tolerance is not None:
        raise ValueError(f"spp={spp} and tolerance={tolerance} are both given; choose a fixed count or an accuracy")
    if progress is not None and not isinstance(progress, bool) and not callable(progress):
        raise TypeError(f"progress is {progress!r}; give True, False or a callable")
    relative, absolute = _tolerance(tolerance)
    options: dict[str, Any] = {
        "width": integer("width", width, bits=32),
        "height": integer("height", height, bits=32),
        "crop": _crop(crop),
        "spp": _count("spp", spp),
        "start": integer("start", start, bits=32),
        "relative_tolerance": relative,
        "absolute_tolerance": absolute,
        "relmse": _above_zero("relmse", relmse, ", which no number of samples reaches; give one above 0"),
        "confidence": number("confidence", confidence),
        "min_spp": integer("min_spp", min_spp, bits=32),
        "max_spp": integer("max_spp", max_spp, bits=32),
        "samples": _count("samples", samples, bits=64),
        "seconds": _above_zero("seconds", seconds, "; give a time above 0, or None for no limit"),
        "pattern": text("pattern", pattern),
        "pixel_filter": text("pixel_filter", pixel_filter),
        "stop": text("stop", stop),
        "unbiased": flag("unbiased", unbiased),
        "seeds": text("seeds", seeds),
        "seed": integer("seed", seed),
        "threads": _count("threads", threads),
        "tile_size": integer("tile_size", tile_size, bits=32),
        "roulette": integer("roulette", roulette, bits=32),
        "profile": flag("profile", profile),
        "aovs": _aovs(aovs),
        "mask": _mask(mask),
        "checkpoint": None if checkpoint is None else given_path(checkpoint),
        "checkpoint_seconds": number("checkpoint_seconds", checkpoint_seconds),
        "notice": _log.warning,
    }
    if callable(progress):
        tell = progress
        film = _core.render(scene._core, progress=lambda p: tell(p) if p.round_finished else None, **options)
        return _finished(film, scene)
    if not progress:
        return _finished(_core.render(scene._core, progress=None, **options), scene)
    bar = _Bar()
    try:
        return _finished(_core.render(scene._core, progress=bar, **options), scene)
    finally:
        bar.close()


def _finished(film: _core.Film, scene: Scene) -> Image:
    image = Image(film, scene.exposure)
    if film.failure:
        raise CheckpointError(film.failure, image)
    if not scene._quiet and not image.color.any() and image.samples.any():
        reason = why_black(
            any_dropped=image.summary().nonfinite_samples > 0,
            any_light=scene.info.light_count > 0 or any(scene.background),
            any_surface=bool(image.alpha.any()),
            max_bounces=scene.max_bounces,
        )
        _log.warning("the picture is wholly black: %s", reason)
    return image


def merge(images: Sequence[Image | FilePath]) -> Image:
    """One image of several of the same scene, from their statistics rather than their colours.

    Replicates (the same pixels, each with a seed of its own) merge by their counts of samples;
    tiles (crops that together fill a rectangle) are put side by side; both at once too.

    Parameters
    ----------
    images : sequence of Image or path-like
        Images, or checkpoint files. One alone is that image, or what the file holds so far.

    Returns
    -------
    Image
        A pixel of n_i samples with half-widths h_i has half-width sqrt(sum (n_i h_i)^2) / sum n_i. The exposure
        is that of the first image that is no file.

    Raises
    ------
    ValueError
        Images that share a seed and a pixel; other scenes, frame sizes, patterns, filters, stop
        rules or confidences; crops that leave a gap.
    TypeError
        Neither an image nor a path.
    OSError
        A file that can't be read, is damaged, or is no checkpoint.

    Notes
    -----
    The order of the images decides the last bits. The cost is that of reading them once.

    Examples
    --------
    >>> import sunfleck as sf
    >>> parts = [sf.render(sf.scenes.penumbra(), 32, 24, spp=16, seed=seed) for seed in (1, 2)]
    >>> merged = sf.merge(parts)
    >>> int(merged.samples.min()), merged.metadata["merged_seeds"]
    (32, '1 2')
    """
    if isinstance(images, (str, bytes, os.PathLike)) or not isinstance(images, Sequence):
        raise TypeError(f"images is {images!r}; give a list of images or checkpoint files")
    exposures = [image.exposure for image in images if isinstance(image, Image)]
    exposure = exposures[0] if exposures else 0.0
    films = [image._film if isinstance(image, Image) else _core.load_film(given_path(image)) for image in images]
    if len(films) == 1:  # as it is, a mask and AOVs too
        return Image(films[0], exposure)
    return Image(_core.merge_films(films), exposure)
