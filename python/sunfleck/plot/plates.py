# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""plates: the pictures of the gallery: the figures of a lecture on random numbers and mappings, made anew.

The lecture is Rotenberg 2017, "Random numbers and mappings" (CSE 168, University of California, San Diego).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sunfleck import mapping, scenes
from sunfleck.integrate import Integral, integrate
from sunfleck.io.image import png_bytes
from sunfleck.mapping import Mapping
from sunfleck.plot.figure import COLORS, Panel, Series, draw_panels, new_figure, png
from sunfleck.plot.show import draw_points, show
from sunfleck.points import points
from sunfleck.render import Image, render

__all__ = ["PATTERNS_SHOWN", "SECTIONS", "Plate", "Section", "Studio"]

PATTERNS_SHOWN = ("uniform", "random", "jittered", "halton", "sobol")

TOLERANCE = 0.02
MAX_SPP = 512
REFERENCE_SPP = 1024
ONE_SIGMA = 0.682689  # of a Gaussian, within which the lecture's rule takes the error to be
PI_TOLERANCE = 0.002

_TURN = np.linspace(0, 2 * np.pi, 181)
_CIRCLE = np.stack([np.cos(_TURN), np.sin(_TURN)], axis=1)
_SQUARE = np.array([(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)])
_TRIANGLE = np.array([(0, 0, 0), (1, 0, 0), (0.35, 0.9, 0)])
_HORIZON = np.column_stack([_CIRCLE, np.zeros(len(_CIRCLE))])


@dataclass(frozen=True)
class Plate:
    """One picture: its file's name without the ending, what is written below it, a PNG's bytes."""

    name: str
    caption: str
    png: bytes


class Studio:
    """What the pictures are made with; what several of them show is made once.

    Parameters
    ----------
    size : int
        Width and height of the renders, in pixels.
    seed : int
        Of everything.
    threads : int, optional
        That render. None: one for each processor.
    """

    def __init__(self, size: int, seed: int, threads: int | None = None) -> None:
        self.size, self.seed, self.threads = size, seed, threads
        self.scene = scenes.penumbra()

    def render(self, **options: Any) -> Image:
        """Penumbra. A render that Ctrl-C stopped stops the gallery too."""
        image = render(self.scene, self.size, self.size, threads=self.threads, **{"seed": self.seed, **options})
        if image.interrupted:
            raise KeyboardInterrupt
        return image

    @cached_property
    def reference(self) -> Image:
        """With another seed than the pictures that are compared to it."""
        return self.render(spp=REFERENCE_SPP, seed=(self.seed + 1) % 2**64)

    @cached_property
    def adaptive(self) -> Image:
        return self.render(tolerance=TOLERANCE, max_spp=MAX_SPP)

    @cached_property
    def lecture(self) -> Image:
        """The lecture's own rule: random points, ten at first, until s / sqrt(N) is within the tolerance."""
        rule: dict[str, Any] = {"pattern": "random", "stop": "standard_error", "confidence": ONE_SIGMA, "min_spp": 10}
        return self.render(tolerance=TOLERANCE, max_spp=MAX_SPP, **rule)

    def errors(self, image: Image) -> NDArray[Any]:
        """Of (R+G+B)/3, as shares of the reference's mean; shape (h, w)."""
        grey, true = (np.asarray(i.color, dtype=np.float64).mean(axis=2) for i in (image, self.reference))
        errors: NDArray[Any] = (grey - true) / true.mean()
        return errors

    def points(self, pattern: str, count: int, scramble: str | None = "default") -> NDArray[Any]:
        return points(pattern, count, seed=self.seed, scramble=scramble)


Maker = Callable[[Studio], Plate]


@dataclass(frozen=True)
class Section:
    """A heading, a line of text, and pictures: those of one group are of one thing, and flip in place."""

    heading: str
    text: str
    groups: Sequence[Sequence[Maker]]


def _title(pattern: str) -> str:
    return pattern.capitalize()


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %"


def _circle(u: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.where(((2 * u - 1) ** 2).sum(axis=1) < 1, 4.0, 0.0)


def _pi_points(studio: Studio) -> Plate:
    count = 1024
    where = 2 * studio.points("random", count).astype(np.float64) - 1
    inside = (where**2).sum(axis=1) < 1
    drawn, axes = new_figure(1, 1, 4, 3.6)
    ax = axes[0, 0]
    for share, color, marker in ((inside, COLORS[0], "o"), (~inside, COLORS[1], "^")):
        ax.plot(*where[share].T, marker, color=color, markersize=2.5, markeredgewidth=0)
    ax.plot(*_CIRCLE.T, color="#888888", linewidth=0.8)
    ax.set(aspect="equal", xlim=(-1, 1), ylim=(-1, 1), xticks=(-1, 0, 1), yticks=(-1, 0, 1))
    hits = int(inside.sum())
    error = 4 * float(inside.std(ddof=1)) / count**0.5
    caption = f"4 × {hits} / {count:,} = {4 * hits / count:.3f}, standard error {error:.3f}"
    return Plate("pi", caption, png(drawn))


def _pi_series(pattern: str, found: Integral) -> list[Series]:
    samples, values, half_widths = zip(*found.history, strict=True)
    errors = np.abs(np.array(values) - np.pi)
    return [
        Series(f"{pattern}: half-width", samples, half_widths),
        Series(f"{pattern}: error", samples, errors, line=False),
    ]


def _pi_error(studio: Studio) -> Plate:
    found = {
        pattern: integrate(_circle, d=2, pattern=pattern, atol=PI_TOLERANCE, seed=studio.seed)
        for pattern in ("random", "sobol")
    }
    if any(integral.stop_reason == "interrupted" for integral in found.values()):
        raise KeyboardInterrupt
    series = [line for pattern, integral in found.items() for line in _pi_series(pattern, integral)]
    panel = Panel("π by the circle, 95 % confidence", "samples", "half-width, and true error", series)
    caption = "; ".join(
        f"{_title(pattern)}: {i.value:.4f} ± {i.half_width:.4f} from {i.samples:,} samples"
        for pattern, i in found.items()
    )
    return Plate("pi-error", caption, png(draw_panels([panel], "")))


def _unit_square(studio: Studio, pattern: str, scramble: str | None = "default", caption: str = "") -> Plate:
    count, cells = 256, 16
    name = pattern if scramble == "default" else f"{pattern}-plain"
    grid = np.linspace(0, 1, cells + 1)
    lines = [[(x, 0), (x, 1)] for x in grid] + [[(0, y), (1, y)] for y in grid]
    figure = show(studio.points(pattern, count, scramble), outline=lines if pattern == "jittered" else ())
    return Plate(name, caption or f"{count} {pattern} points", figure.png())


def _patterns(studio: Studio) -> Plate:
    sets = {_title(pattern): studio.points(pattern, 256) for pattern in PATTERNS_SHOWN}
    return Plate("patterns", "256 points of each", show(sets).png())


def _pixel_maps(studio: Studio) -> Plate:
    maps = {"": mapping.pixel_box, ", Gaussian": mapping.pixel_gaussian, ", Shirley": mapping.pixel_tent}
    count = 144
    patterns = ("random", "jittered", "uniform")
    drawn, axes = new_figure(len(maps), len(patterns), 2.2, 2.2)
    for row, (name, chosen) in zip(axes, maps.items(), strict=True):
        for ax, pattern in zip(row, patterns, strict=True):
            draw_points(ax, chosen.sample(studio.points(pattern, count)), [_SQUARE])
            ax.set(title=_title(pattern) + name, xlim=(-0.7, 1.7), ylim=(-0.7, 1.7))
            ax.title.set_fontsize(9)
    return Plate("pixel-maps", f"{count} points of each; the square is the pixel", png(drawn))


def _mapped(
    studio: Studio,
    name: str,
    chosen: Mapping,
    count: int,
    outline: Sequence[ArrayLike],
    columns: int = 3,
    **parameters: Any,
) -> Plate:
    """The points of every pattern on a shape; of its first columns only, as the shape is seen from +z."""
    sets = {
        _title(pattern): chosen.sample(studio.points(pattern, count), **parameters)[:, :columns]
        for pattern in PATTERNS_SHOWN
    }
    return Plate(name, f"{count:,} points of each pattern", show(sets, outline=outline).png())


def _area_light(studio: Studio, pattern: str, spp: int) -> Plate:
    image = studio.render(spp=spp, pattern=pattern)
    error = float(np.sqrt((studio.errors(image) ** 2).mean()))
    return Plate(
        f"area-light-{pattern}-{spp}", f"{_title(pattern)}: {spp} samples; error {_percent(error)}", image._repr_png_()
    )


def _adaptive(studio: Studio) -> Plate:
    image = studio.adaptive
    caption = f"{image.summary().line}; {image.samples.mean():.0f} samples a pixel"
    return Plate("adaptive", caption, image._repr_png_())


def _density(studio: Studio, channel: str, caption: str) -> Plate:
    return Plate(f"adaptive-{channel.replace('_', '-')}", caption, studio.adaptive.heatmap(channel).png())


def _window(image: Image) -> tuple[slice, slice]:
    """Where the sphere's shadow has its edge."""
    height, width = image.samples.shape
    return slice(int(0.52 * height), int(0.80 * height)), slice(int(0.06 * width), int(0.34 * width))


def _close_up(studio: Studio, name: str, image: Image, what: str) -> Plate:
    window = _window(image)
    times = max(1, round(288 / image.color[window].shape[0]))
    large = np.asarray(image.color[window]).repeat(times, axis=0).repeat(times, axis=1)
    off = float((np.abs(studio.errors(image)[window]) > 3 * TOLERANCE).mean())
    caption = f"{what}: {image.samples.mean():.0f} samples a pixel"
    if image is not studio.reference:
        caption += f"; here {_percent(off)} of the pixels are off by more than three tolerances"
    return Plate(f"close-up-{name}", caption, png_bytes([(c, large[..., i]) for i, c in enumerate("RGB")]))


def _close_ups() -> list[Maker]:
    return [
        lambda studio: _close_up(studio, "lecture", studio.lecture, "s/√N after 10 random samples"),
        lambda studio: _close_up(studio, "default", studio.adaptive, "the default rule, Sobol"),
        lambda studio: _close_up(studio, "reference", studio.reference, "the reference"),
    ]


def _on(name: str, chosen: Mapping, count: int, outline: Sequence[ArrayLike], **options: Any) -> list[list[Maker]]:
    return [[partial(_mapped, name=name, chosen=chosen, count=count, outline=outline, **options)]]


def _sequence(pattern: str, scrambled: str) -> list[list[Maker]]:
    return [
        [
            partial(_unit_square, pattern=pattern, scramble=None, caption="256 points of the plain sequence"),
            partial(_unit_square, pattern=pattern, caption=scrambled),
        ]
    ]


_DOME = [_HORIZON, _CIRCLE[: len(_CIRCLE) // 2 + 1]]
_CORNERS = dict(zip("abc", _TRIANGLE, strict=True))

SECTIONS = (
    Section(
        "Estimating π",
        "The share of points of a square that fall into the circle inside it is π/4. The half-width says how far the "
        "estimate may be off, and Sobol's points need far fewer samples for the same.",
        [[_pi_points], [_pi_error]],
    ),
    Section(
        "Random numbers",
        "Each point is drawn on its own: there are clumps, and there are holes.",
        [[partial(_unit_square, pattern="random")]],
    ),
    Section(
        "Stratified (jittered) sampling",
        "One random point in each cell of a grid: more even, and the number of points must be chosen ahead.",
        [[partial(_unit_square, pattern="jittered", caption="256 jittered points, one in each of 16 × 16 cells")]],
    ),
    Section(
        "Halton sequence",
        "Digits of the index mirrored at the point, in base 2 for x and 3 for y: any number of points is even. "
        "Permuted digits break the diagonals that the plain sequence shows.",
        _sequence("halton", "256 points with permuted digits, the default"),
    ),
    Section(
        "Sobol sequence",
        "Base 2 in both dimensions: every power of two points fills a grid of equal cells. Owen's scrambling keeps "
        "that and leaves no pattern for the eye.",
        _sequence("sobol", "256 points with Owen's scrambling, the default"),
    ),
    Section(
        "Summary of number generators",
        "The five side by side: a grid aliases, random points clump, the other three are even and yet irregular.",
        [[_patterns]],
    ),
    Section(
        "Pixel mappings",
        "Points of the unit square as places in a pixel: as they are, drawn to the centre by a Gaussian (μ = 0.4), "
        "or by Shirley's map, the tent.",
        [[_pixel_maps]],
    ),
    Section(
        "Triangle",
        "The square root of one number gives every part of a triangle its due: points on a triangular light.",
        _on("triangle", mapping.triangle, 256, [_TRIANGLE[[0, 1, 2, 0], :2]], columns=2, **_CORNERS),
    ),
    Section(
        "Disk",
        "The radius is the square root of a number, the angle 2π times the other: points on a lens, or on the sun.",
        _on("disk", mapping.disk_polar, 256, [_CIRCLE]),
    ),
    Section(
        "Disk, the wrong way",
        "Without the square root the points crowd at the centre.",
        _on("disk-wrong", mapping.disk_naive, 256, [_CIRCLE]),
    ),
    Section(
        "Sphere",
        "Directions in which fog scatters. The farther half is pale.",
        _on("sphere", mapping.sphere, 1024, [_CIRCLE]),
    ),
    Section(
        "Hemisphere",
        "Directions above a surface, each as likely as any other.",
        _on("hemisphere", mapping.hemisphere, 1024, _DOME),
    ),
    Section(
        "Cosine weighted hemisphere",
        "Fewer directions along the horizon, as a diffuse surface receives light: each sample then counts the same.",
        _on("cosine-hemisphere", mapping.cosine_hemisphere, 1024, _DOME),
    ),
    Section(
        "Mappings and number generators",
        "The hemisphere from straight above: what a pattern is in the square can still be seen on the shape.",
        _on("hemisphere-above", mapping.hemisphere, 1024, [_CIRCLE], columns=2),
    ),
    Section(
        "Area light, 9 samples",
        "Soft shadows of a square lamp, 9 samples a pixel. The grid is the same in every pixel: its error is the "
        "smallest and shows the most, as nine shadows. The others turn the error into noise. Errors are root mean "
        f"squares, as shares of the picture's mean, against {REFERENCE_SPP:,} samples a pixel.",
        [[partial(_area_light, pattern=pattern, spp=9)] for pattern in PATTERNS_SHOWN],
    ),
    Section(
        "Area light, 100 samples",
        "The same with 100: random points still show their noise, the even ones hardly.",
        [[partial(_area_light, pattern=pattern, spp=100)] for pattern in PATTERNS_SHOWN],
    ),
    Section(
        "Adaptive sampling",
        f"Each pixel takes samples until its half-width at 95 % is within {100 * TOLERANCE:g} % of the picture's "
        f"mean, or it has {MAX_SPP:,}.",
        [[_adaptive]],
    ),
    Section(
        "Adaptive sampling density",
        "Where the samples went: to the edges of shadows and shapes.",
        [
            [
                partial(_density, channel="samples", caption="samples a pixel"),
                partial(_density, channel="half_width", caption="half-width: how far each pixel may be off"),
                partial(_density, channel="stop_reason", caption="why each pixel stopped"),
            ],
        ],
    ),
    Section(
        "Close-up view",
        "An edge of the sphere's shadow. A rule that trusts its first ten samples ends where they happened to agree: "
        "single pixels stay too dark or too bright. The default rule looks later, and at the neighbours too.",
        [[maker] for maker in _close_ups()],
    ),
)
"""The gallery in the lecture's order."""
