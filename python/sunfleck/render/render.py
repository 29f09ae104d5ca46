# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""render: the call that renders a scene, and what it says about a picture that is wholly black."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from typing import Any

from numpy.typing import ArrayLike

from sunfleck import _core
from sunfleck._arguments import flag, integer, number, text
from sunfleck.error import CheckpointError
from sunfleck.exposure import why_black
from sunfleck.io.files import FilePath, given_path
from sunfleck.render.image import Image
from sunfleck.render.options import above_zero, aovs_of, count, crop_of, mask_of, tolerance_of
from sunfleck.render.progress import Bar, Progress
from sunfleck.scene.scene import Scene
from sunfleck.tolerance import Tolerance

__all__ = ["render"]

_log = logging.getLogger("sunfleck")


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
    stop : "dyadic", "replicates" or "standard_error"
        The rule by which a pixel's half-width is told from its samples. "dyadic": from the
        differences between the halves of its sequence, the halves' halves, …, shared with its
        neighbours; it looks at 32, 64, 128, … samples. "replicates": eight independent copies of
        the pattern and Student's t, at 128, 256, … samples. "standard_error": the classic
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
    tolerance under the rule "standard_error"; a relative tolerance has the mean of the pixels of
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
    relative, absolute = tolerance_of(tolerance)
    options: dict[str, Any] = {
        "width": integer("width", width, bits=32),
        "height": integer("height", height, bits=32),
        "crop": crop_of(crop),
        "spp": count("spp", spp),
        "start": integer("start", start, bits=32),
        "relative_tolerance": relative,
        "absolute_tolerance": absolute,
        "relmse": above_zero("relmse", relmse, ", which no number of samples reaches; give one above 0"),
        "confidence": number("confidence", confidence),
        "min_spp": integer("min_spp", min_spp, bits=32),
        "max_spp": integer("max_spp", max_spp, bits=32),
        "samples": count("samples", samples, bits=64),
        "seconds": above_zero("seconds", seconds, "; give a time above 0, or None for no limit"),
        "pattern": text("pattern", pattern),
        "pixel_filter": text("pixel_filter", pixel_filter),
        "stop": text("stop", stop),
        "unbiased": flag("unbiased", unbiased),
        "seeds": text("seeds", seeds),
        "seed": integer("seed", seed),
        "threads": count("threads", threads),
        "tile_size": integer("tile_size", tile_size, bits=32),
        "roulette": integer("roulette", roulette, bits=32),
        "aovs": aovs_of(aovs),
    }
    apart: dict[str, Any] = {  # what is no option of the library's table
        "profile": flag("profile", profile),
        "mask": mask_of(mask),
        "checkpoint": None if checkpoint is None else given_path(checkpoint),
        "checkpoint_seconds": number("checkpoint_seconds", checkpoint_seconds),
        "notice": _log.warning,
    }
    if callable(progress):
        tell = progress
        film = _core.render(scene._core, options, progress=lambda p: tell(p) if p.round_finished else None, **apart)
        return _finished(film, scene)
    if not progress:
        return _finished(_core.render(scene._core, options, progress=None, **apart), scene)
    bar = Bar()
    try:
        return _finished(_core.render(scene._core, options, progress=bar, **apart), scene)
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
