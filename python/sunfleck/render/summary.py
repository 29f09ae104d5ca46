# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""summary: what a render came to, in numbers and in words."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from sunfleck._arguments import spoken

__all__ = ["Summary", "percent"]


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
        cut_short = [reason for reason in ("out_of_time", "interrupted") if self.reasons[reason]]
        early = "".join(f", {percent(self._share(reason))} {spoken(reason)}" for reason in cut_short)
        if self.tolerance > 0:
            met = f"{percent(self.share_met)} of pixels met {self.tolerance / unit:.3g} {confidence}"
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
        counts = ", ".join(f"{count} {spoken(reason)}" for reason, count in self.reasons.items() if count)
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


def percent(share: float) -> str:
    """Rounded down to a tenth, so that only a whole is called 100 %."""
    return f"{math.floor(1000 * share) / 10:.1f} %" if share < 1 else "100 %"
