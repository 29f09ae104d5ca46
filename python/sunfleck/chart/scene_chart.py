# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""scene_chart: seconds against relMSE of fixed and adaptive renders; tolerance asked against error got."""

from __future__ import annotations

import functools
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sunfleck.chart.cells import Cell, Key, Store, least_time
from sunfleck.chart.fit import pareto_front, winners
from sunfleck.chart.pixels import Pixels, level_of, relative_mse
from sunfleck.estimate import normal_quantile
from sunfleck.plot.figure import Panel, Series
from sunfleck.render import STOP_REASONS, Image

__all__ = ["RULES", "scene_cells", "scene_panels", "scene_pictures"]

RULES = ("dyadic", "standard_error", "replicates")

_MET = STOP_REASONS.index("met")
_CONFIDENCE = 0.95
_LEGEND = """\
errors: medians over seeds; coverage: share of the pixels that met the tolerance whose true error is within
the half-width; hard: of those of them that took more than the first look; within: the tolerance"""


class _Run(NamedTuple):
    """An adaptive render's options."""

    pattern: str
    rule: str
    tolerance: float


def _mean(values: Any) -> float:
    """NaN where there are none, without a warning."""
    return float(np.mean(values)) if np.size(values) else float("nan")


def _adaptive(pixels: Pixels, run: _Run, seed: int) -> dict[str, float]:
    truth, level = pixels.truth, float(pixels.truth.mean())
    image, seconds = pixels.timed(
        tolerance=run.tolerance, confidence=_CONFIDENCE, pattern=run.pattern, stop=run.rule, seed=seed
    )
    miss = np.abs(level_of(image.color) - level_of(truth))
    met = image.stop_reason == _MET
    hard = met & (image.samples > image.samples.min())
    covered = miss <= image.half_width
    return {"seconds": seconds, "relmse": relative_mse(image.color, truth),
            "error": _mean(miss[met] ** 2) ** 0.5 / level, "coverage": _mean(covered[met]),
            "hard_coverage": _mean(covered[hard]), "within": _mean(miss[met] <= image.summary().tolerance),
            "met": _mean(met), "samples": _mean(image.samples)}  # fmt: skip


def scene_cells(
    all_pixels: Sequence[Pixels],
    patterns: Sequence[str],
    rules: Sequence[str],
    tolerances: Sequence[float],
    max_spp: int,
) -> list[Cell]:
    """What a chart of a scene measures, under each pixel filter."""
    cells = []
    for pixels in all_pixels:
        cells.append(pixels.reference_cell())
        for pattern in patterns:
            cells += [pixels.fixed_cell(pattern, 1 << k) for k in range(2, max_spp.bit_length())]
            for run in (_Run(pattern, rule, tolerance) for rule in rules for tolerance in tolerances):
                spp = min(4096.0, max(32.0, 4 / run.tolerance**1.5))  # a guess, for the bar alone
                weight = pixels.weight(pattern, spp)
                key = (pixels.title, f"{pattern}, {run.rule}", run.tolerance)
                cells.append(Cell(key, functools.partial(_adaptive, pixels, run), weight))
    return cells


def _middle(store: Store, key: Key, seeds: int, name: str) -> float:
    """The least of seconds, medians of errors, means of shares and counts; NaN where nothing is known."""
    numbers = store.get(key, seeds)
    if not numbers or not np.isfinite(numbers[name]).any():
        return float("nan")
    if name == "seconds":
        return least_time(numbers[name])
    return float((np.nanmedian if name in ("relmse", "error") else np.nanmean)(numbers[name]))


def _series(method: str, keys: Sequence[Key], seeds: int, store: Store, x: str | None, y: str) -> Series | None:
    """The method's y over its x, as `_middle` has them, or over the key's own number; None where there are none."""
    shown = sorted(key for key in keys if key[1] == method)
    rows = [(_middle(store, k, seeds, x) if x else k[2], _middle(store, k, seeds, y)) for k in shown]
    kept = [row for row in rows if np.isfinite(row).all()]
    name = method if "," in method else f"{method}, fixed"
    return Series(name, [a for a, _ in kept], [b for _, b in kept]) if kept else None


def _speed_panel(title: str, lines: list[Series]) -> tuple[Panel, str]:
    x = np.concatenate([np.asarray(line.x, float) for line in lines])
    y = np.concatenate([np.asarray(line.y, float) for line in lines])
    names = [line.name for line in lines for _ in np.asarray(line.x)]
    front = pareto_front(x, y)
    best = [f"in {budget:.0e} s: {name} {error:.1e}" for budget, name, error in winners(names, x, y)]
    series = [*lines, Series("Pareto front", x[front], y[front], line=False, style="front")]
    return Panel(title, "seconds", "relMSE", series, note="\n".join(best)), "; ".join(best)


def _share_panel(title: str, lines: list[Series], tolerances: Sequence[float]) -> Panel:
    guide = Series("asked", [min(tolerances), max(tolerances)], [_CONFIDENCE] * 2, style="guide")
    return Panel(
        title, "tolerance asked, of the level", "coverage (dashed: asked)", [*lines, guide], y_log=False, legend=False
    )


def scene_panels(
    all_pixels: Sequence[Pixels], cells: Sequence[Cell], tolerances: Sequence[float], seeds: int, store: Store
) -> tuple[list[Panel], str]:
    """Four panels a filter, and the findings in words."""
    panels: list[Panel] = []
    text = [_LEGEND]
    z = normal_quantile(0.5 + _CONFIDENCE / 2)
    ends = np.array([min(tolerances), max(tolerances)])
    for pixels in all_pixels:
        keys = [cell.key for cell in cells if cell.key[0] == pixels.title and cell.key[1] != "reference"]
        methods = list(dict.fromkeys(key[1] for key in keys))
        adaptive = [m for m in methods if "," in m]

        def lines(names: list[str], x: str | None, y: str, keys: list[Key] = keys) -> list[Series]:
            made = [_series(name, keys, seeds, store, x, y) for name in names]
            return [line for line in made if line is not None]

        speed = lines(methods, "seconds", "relmse")
        if not speed:
            continue
        shares: list[Panel] = []
        panel, best = _speed_panel(pixels.title, speed)
        calibration = Panel("calibration", "tolerance asked, of the level", "RMS error got, of the level", [
            *lines(adaptive, None, "error"),
            Series("error that just meets it", ends, ends / z, style="guide"),
        ])  # fmt: skip
        for title, what in (("coverage", "coverage"), ("coverage, hard pixels", "hard_coverage")):
            shares.append(_share_panel(title, lines(adaptive, None, what), tolerances))
        panels += [panel, calibration, *shares]
        text += [pixels.title, f"  best    {best}", f"  {pixels.about(store)}", *_table(keys, adaptive, seeds, store)]
    return panels, "\n".join(text)


def _table(keys: Sequence[Key], methods: Sequence[str], seeds: int, store: Store) -> list[str]:
    rows = [f"  {'':24} tolerance  error    coverage (hard)  within   met    samples a pixel"]
    for key in (key for method in methods for key in keys if key[1] == method and store.seeds(key)):
        names = ("error", "coverage", "hard_coverage", "within", "met", "samples")
        error, cover, hard, within, met, samples = (_middle(store, key, seeds, name) for name in names)
        shares = f"{cover:.3f} ({hard:.3f})    {within:.3f}    {met:.3f}"
        rows.append(f"  {key[1]:24} {key[2]:<9.3g}  {error:.1e}  {shares}  {samples:.0f}")
    return rows


def _png(image: Image, channel: str | None = None) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.png"
        if channel is None:
            image.save(path)
        else:
            image.save_map(channel, path)
        return path.read_bytes()


def scene_pictures(pixels: Pixels, size: int, tolerance: float) -> dict[str, bytes]:
    """PNGs by their captions: an adaptive picture, a fixed count of as many samples at the most, two maps."""
    large = Pixels(pixels.scene, size, 2)
    adaptive = large.render(tolerance=tolerance)
    spp = max(1, round(float(adaptive.samples.mean())))
    fixed = large.render(spp=1 << (spp.bit_length() - 1))
    samples, widths = adaptive.samples, adaptive.half_width
    said = f"tolerance {tolerance:g}"
    captions = {
        f"adaptive, {said}: {spp} samples a pixel": _png(adaptive),
        f"fixed: {int(fixed.samples.min())} samples a pixel": _png(fixed),
        f"samples a pixel, {said}: {samples.min()} (dark) to {samples.max()}": _png(adaptive, "samples"),
    }
    ends = f"{widths.min():.2g} (dark) to {widths.max():.2g} in radiance"
    return {**captions, f"half-width, {said}: {ends}": _png(adaptive, "half_width")}
