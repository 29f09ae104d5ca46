# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""progress: a bar on standard error that tells how far a render is."""

from __future__ import annotations

from sunfleck._core import Progress
from sunfleck.render.summary import percent

__all__ = ["Bar", "Progress"]


class Bar:
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
            spent = f"{percent(progress.pixels_met / progress.pixels)} met, {spent}"
        self._bar.set_postfix_str(spent, refresh=False)
        self._bar.update(progress.pixels_done - self._bar.n)

    def close(self) -> None:
        self._bar.close()
