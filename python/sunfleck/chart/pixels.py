# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""pixels: a scene's pixels and their reference, which our own long renders make."""

from __future__ import annotations

import functools
import hashlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sunfleck.chart.cells import Cell, Key, Store
from sunfleck.io.load import scene_by_name
from sunfleck.render import Image, render
from sunfleck.scene import Scene
from sunfleck.scenes import SCENES

__all__ = ["RENDER_PATTERNS", "Pixels", "relative_mse"]

RENDER_PATTERNS = ("uniform", "random", "jittered", "halton", "sobol")
"""Those that the renderer takes."""

_REFERENCE_SEED = 2**40
_SHORT, _TIMINGS = 0.05, 3  # a render below so many seconds is timed so often
_PIXEL_SEEDS = 8  # a render's error is a mean over its pixels already

Array = NDArray[np.float64]


def relative_mse(color: Any, truth: Array) -> float:
    """mean((x - r)² / (r² + 0.01)), over pixels and channels."""
    return float(np.mean((np.asarray(color, np.float64) - truth) ** 2 / (truth**2 + 0.01)))


def level_of(color: Any) -> Array:
    """(R+G+B)/3 of every pixel."""
    return np.asarray(np.mean(color, axis=2, dtype=np.float64))


class Pixels:
    """A scene at a size under a pixel filter.

    Parameters
    ----------
    scene : str or Scene
        The name of a built-in one, a file, or a scene.
    size : int
        Pixels a side.
    reference_spp : int
        Of the reference, a power of two.
    pixel_filter : str

    Raises
    ------
    ValueError, OSError
        There is no such scene, or it can't be read.
    """

    def __init__(self, scene: str | Scene, size: int, reference_spp: int, pixel_filter: str = "box") -> None:
        self.scene = scene if isinstance(scene, Scene) else scene_by_name(scene)
        self.size, self._spp, self._filter = size, reference_spp, pixel_filter
        name = f"the scene given {scene.info.hash:08x}"[:24] if isinstance(scene, Scene) else scene
        if isinstance(scene, str) and scene not in SCENES:  # a file that has changed is another scene
            name = f"{Path(scene).name} {hashlib.sha256(Path(scene).read_bytes()).hexdigest()[:8]}"
        self.title = f"{name}, {size} x {size} pixels" + (f", {pixel_filter}" if pixel_filter != "box" else "")

    def render(self, **options: Any) -> Image:
        """A render of these pixels.

        Raises
        ------
        KeyboardInterrupt
            It was stopped by Ctrl-C; `sunfleck.render` itself returns what there is.
        """
        image = render(self.scene, self.size, self.size, pixel_filter=self._filter, **options)
        if image.interrupted:
            raise KeyboardInterrupt
        return image

    def timed(self, **options: Any) -> tuple[Image, float]:
        """A render, and its seconds: of one that is short, the least of three."""
        image = self.render(**options)
        seconds = [image.summary().seconds]
        while len(seconds) < _TIMINGS and seconds[0] < _SHORT:
            seconds.append(self.render(**options).summary().seconds)
        return image, min(seconds)

    @functools.cached_property
    def halves(self) -> tuple[Array, Array]:
        """Two independent renders of half the reference's samples each."""
        a, b = (self.render(spp=self._spp // 2, seed=_REFERENCE_SEED + k).color.astype(np.float64) for k in (0, 1))
        return a, b

    @functools.cached_property
    def truth(self) -> Array:
        """The reference, shape (size, size, 3)."""
        return (self.halves[0] + self.halves[1]) / 2

    def _own_error(self, _seed: int) -> dict[str, float]:
        """E|A - B|² is four times the squared error of the mean of A and B."""
        a, b = self.halves
        level = float(self.truth.mean())
        return {"error": float(np.sqrt(np.mean((level_of(a) - level_of(b)) ** 2)) / 2 / level),
                "relmse": float(np.mean((a - b) ** 2 / 4 / (self.truth**2 + 0.01)))}  # fmt: skip

    def reference_cell(self) -> Cell:
        """The reference's own error."""
        return Cell(self.reference_key, self._own_error, self.weight("sobol", self._spp), most=1)

    @property
    def reference_key(self) -> Key:
        return self.title, "reference", self._spp

    def about(self, store: Store) -> str:
        """How the reference was made, and how far it may be off."""
        known = store.get(self.reference_key, 1)
        error = f"{known['error'][0]:.1e} of the level, relMSE {known['relmse'][0]:.1e}" if known else "unknown"
        return f"reference: our own {self._spp} samples a pixel, two seeds; its own error {error}"

    def _fixed(self, pattern: str, spp: int, seed: int) -> dict[str, float]:
        truth = self.truth
        image, seconds = self.timed(spp=spp, pattern=pattern, seed=(spp << 24) + seed)
        miss = level_of(image.color) - level_of(truth)
        return {"error": float(np.sqrt(np.mean(miss**2)) / truth.mean()), "relmse": relative_mse(image.color, truth),
                "seconds": seconds}  # fmt: skip

    def fixed_cell(self, pattern: str, spp: int) -> Cell:
        """Error, relMSE and seconds of a fixed count; the error is over the picture's mean level."""
        measure = functools.partial(self._fixed, pattern, spp)
        return Cell((self.title, pattern, spp), measure, self.weight(pattern, spp), _PIXEL_SEEDS)

    def weight(self, pattern: str, spp: float) -> float:
        """What a render costs, as a cell has it: some 80 ns a sample, of halton 3 microseconds."""
        return self.size**2 * spp * (600 if pattern == "halton" else 16)
