# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""chart: speed against accuracy.

`patterns`, `scenes`, `generators` and `mappings` measure and return a `Chart`, which shows itself
in a notebook and is saved as a figure, a page or a table; ``sf.chart("patterns", ...)`` calls
them by name. What is measured falls into cells, each a function of its key and seed; with
``keep=FILE`` they are kept as they come, and a run that was stopped goes on from there.

Needs matplotlib, and plotly for pages: ``pip install sunfleck[chart]``.

Examples
--------
>>> import sunfleck as sf
>>> made = sf.chart.patterns("random,sobol", integrands="product", scene=None, seeds=4, max_samples=256)
>>> [panel.x for panel in made.panels]
['samples', 'seconds']
>>> made.complete
True
"""

from __future__ import annotations

import sys
import types
from collections.abc import Callable, Sequence
from typing import Any

from sunfleck._arguments import choice, integer, text
from sunfleck.chart.cells import Store
from sunfleck.chart.generator_chart import generator_cells, generator_panels
from sunfleck.chart.mapping_chart import mapping_cells, mapping_panels
from sunfleck.chart.pattern_chart import DEFAULT_PATTERNS, method_named, pattern_cells, pattern_panels
from sunfleck.chart.pixels import RENDER_PATTERNS, Pixels
from sunfleck.chart.result import CHART_TYPES, Chart, measured
from sunfleck.chart.scene_chart import RULES, scene_cells, scene_panels, scene_pictures
from sunfleck.integrands import INTEGRANDS
from sunfleck.io.files import FilePath
from sunfleck.mapping import MAPPINGS
from sunfleck.render import PIXEL_FILTERS
from sunfleck.rng import RNGS
from sunfleck.scene import Scene

__all__ = ["CHART_TYPES", "KINDS", "Chart", "generators", "mappings", "patterns", "scenes"]

_QUICK_INTEGRANDS = ("product", "kink", "circle", "pole", "exp-mean")


def _names(
    name: str, given: str | Sequence[str] | None, default: Sequence[str], allowed: Sequence[str] = ()
) -> list[str]:
    """Names, from a sequence or a text with commas; those that are not allowed are refused."""
    if given is None:
        return list(default)
    names = [text(name, one).strip() for one in (given.split(",") if isinstance(given, str) else given)]
    names = [choice(name, one, allowed) if allowed else one for one in names if one]
    names = list(dict.fromkeys(names))
    if not names:
        raise ValueError(f"{name} is {given!r}; give at least one name")
    return names


def _count(name: str, given: int | None, default: int, least: int, most: int) -> int:
    count = default if given is None else integer(name, given)
    if not least <= count <= most:
        raise ValueError(f"{name} is {count}; give {least} to {most}")
    return count


def _tolerances(given: str | Sequence[float] | None, default: tuple[float, ...]) -> list[float]:
    if given is None:
        return list(default)
    try:
        values = [float(one) for one in (given.split(",") if isinstance(given, str) else given)]
    except (TypeError, ValueError):
        raise ValueError(f"tolerances is {given!r}; give numbers in (0, 1)") from None
    if not values or not all(0 < value < 1 for value in values):
        raise ValueError(f"tolerances is {given!r}; give numbers in (0, 1)")
    return values


def patterns(
    patterns: str | Sequence[str] | None = None,
    *,
    integrands: str | Sequence[str] | None = None,
    scene: str | Scene | None = "penumbra",
    seeds: int | None = None,
    max_samples: int | None = None,
    quick: bool = False,
    keep: FilePath | None = None,
    fresh: bool = False,
    progress: bool = False,
) -> Chart:
    """Error against samples and against seconds, on integrands with known answers and on pixels.

    Parameters
    ----------
    patterns : str with commas, or sequence of str, optional
        Names of `sunfleck.PATTERNS`, also with a scramble ("sobol:lms"), and of patterns broken
        on purpose (`sunfleck.chart.pattern_chart.VARIANTS`). None: the usual ones.
    integrands : likewise, optional
        Names of `sunfleck.integrands.INTEGRANDS`. None: all of them; one of each kind if quick.
    scene : str, Scene or None
        Whose pixels are charted too: a built-in one's name, a file, a scene; None: no pixels.
    seeds : int, optional
        At least 2. None: 64; 16 if quick.
    max_samples : int, optional
        64 to 2^24. None: 2^16; 2^13 if quick. Pixels get a 128th of that, 16 to 256.
    quick : bool
        Fewer seeds, samples and integrands: some seconds instead of minutes.
    keep : path-like, optional
        A .json file that keeps the numbers as they come; where it exists, they are not measured
        again. Numbers of another machine, compiler or version are refused.
    fresh : bool
        Forget what ``keep`` holds.
    progress : bool
        A bar on stderr, with the time that is left.

    Returns
    -------
    Chart
        Ctrl-C returns what there is, with ``complete`` False.

    Raises
    ------
    ValueError, TypeError, OSError
        A name, count or file that can't be, before anything is measured.

    Notes
    -----
    Seconds are those of one thread that makes the points and evaluates the integrand; of pixels,
    those of the render. Errors at different n have different seeds, and are independent.

    Examples
    --------
    A pattern that is broken departs from its theory, and is marked:

    >>> import sunfleck as sf
    >>> made = sf.chart.patterns("sobol,sobol-dropped-first", integrands="product", scene=None, quick=True)
    >>> made.text.count("✗")
    1
    """
    methods = [method_named(name) for name in _names("patterns", patterns, DEFAULT_PATTERNS)]
    cases = _names("integrands", integrands, _QUICK_INTEGRANDS if quick else tuple(INTEGRANDS), tuple(INTEGRANDS))
    seeds = _count("seeds", seeds, 16 if quick else 64, 2, 10**6)
    most = _count("max_samples", max_samples, 2**13 if quick else 2**16, 64, 2**24)
    pixels = None if scene is None else Pixels(scene, 24 if quick else 48, 2**14 if quick else 2**15)
    cells = pattern_cells(methods, cases, pixels, most, min(256, max(16, most // 128)))
    store = Store(keep, fresh)
    return measured(
        "Patterns: error against samples and seconds", cells, seeds, store, progress,
        lambda: pattern_panels(methods, cells, pixels, seeds, store),
    )  # fmt: skip


def scenes(
    scene: str | Scene = "penumbra",
    *,
    patterns: str | Sequence[str] | None = None,
    stops: str | Sequence[str] | None = None,
    pixel_filters: str | Sequence[str] | None = None,
    tolerances: str | Sequence[float] | None = None,
    seeds: int | None = None,
    quick: bool = False,
    keep: FilePath | None = None,
    fresh: bool = False,
    progress: bool = False,
) -> Chart:
    """Seconds against relMSE of a scene, fixed counts and adaptive on one chart; tolerance against error.

    Parameters
    ----------
    scene : str or Scene
        A built-in one's name, a file, or a scene.
    patterns, stops, pixel_filters : str with commas, or sequence of str, optional
        As `sunfleck.render` takes them. None: sobol and random, all three rules, box and
        gaussian_truncated; if quick, sobol, dyadic and standard_error, box.
    tolerances : str with commas, or sequence of float, optional
        Relative to the level, each in (0, 1). None: 0.2, 0.1, 0.05, 0.02, without the last if quick.
    seeds, quick, keep, fresh, progress
        As in `patterns`. Seeds: 4; 2 if quick.

    Returns
    -------
    Chart
        Its page also has pictures that flip: adaptive, fixed, samples, half-widths.

    Raises
    ------
    ValueError, TypeError, OSError
        A name, count or file that can't be, before anything is measured.

    Notes
    -----
    The truth is a render of our own under each filter, with many samples and other seeds; how far
    it may be off is told from its two halves, and stated. relMSE is mean((x - r)² / (r² + 0.01)).
    An error that just meets a tolerance at 95 % has a root mean square of tolerance / 1.96.

    Examples
    --------
    >>> import sunfleck as sf
    >>> made = sf.chart.scenes("penumbra", stops="dyadic", tolerances=[0.2], quick=True)
    >>> [panel.title for panel in made.panels]
    ['penumbra, 64 x 64 pixels', 'calibration', 'coverage', 'coverage, hard pixels']
    """
    open_ended = [name for name in RENDER_PATTERNS if name != "uniform"]  # that one needs its count ahead
    named = _names("patterns", patterns, ("sobol",) if quick else ("sobol", "random"), open_ended)
    rules = _names("stops", stops, RULES[:2] if quick else RULES, RULES)
    filters = _names(
        "pixel_filters", pixel_filters, ("box",) if quick else ("box", "gaussian_truncated"), PIXEL_FILTERS
    )
    asked = _tolerances(tolerances, (0.2, 0.1, 0.05) if quick else (0.2, 0.1, 0.05, 0.02))
    seeds = _count("seeds", seeds, 2 if quick else 4, 2, 10**6)
    size = 64 if quick else 96  # not those of `patterns`: the references differ, and keys tell cells by size
    store = Store(keep, fresh)
    all_pixels = [Pixels(scene, size, 2**14, name) for name in filters]
    cells = scene_cells(all_pixels, named, rules, asked, 256 if quick else 1024)
    made = measured(
        f"Seconds against error: {all_pixels[0].title}", cells, seeds, store, progress,
        lambda: scene_panels(all_pixels, cells, asked, seeds, store),
    )  # fmt: skip
    if made.complete:
        made.pictures = scene_pictures(all_pixels[0], 128 if quick else 256, asked[len(asked) // 2])
    return made


def generators(
    generators: str | Sequence[str] | None = None,
    *,
    seeds: int | None = None,
    quick: bool = False,
    keep: FilePath | None = None,
    fresh: bool = False,
    progress: bool = False,
) -> Chart:
    """Nanoseconds a number against what seven quick tests of randomness find.

    Parameters
    ----------
    generators : str with commas, or sequence of str, optional
        Names of `sunfleck.RNGS`. None: all.
    seeds, quick, keep, fresh, progress
        As in `patterns`. Seeds: 16; 2 if quick.

    Returns
    -------
    Chart

    Raises
    ------
    ValueError, TypeError, OSError
        A name, count or file that can't be, before anything is measured.

    Notes
    -----
    `sunfleck.chart.generator_chart` has the tests and their sources. They take 2^17 words a seed,
    see nothing of periods beyond, and pass generators that a battery fails.

    Examples
    --------
    >>> import sunfleck as sf
    >>> made = sf.chart.generators("randu,sfc64", quick=True)
    >>> [line.split()[3] for line in made.text.splitlines()[2:]]  # tests failed
    ['4', '0']
    """
    names = _names("generators", generators, tuple(RNGS), tuple(RNGS))
    seeds = _count("seeds", seeds, 2 if quick else 16, 2, 10**6)
    store = Store(keep, fresh)
    return measured(
        "Generators: nanoseconds a number against quality", generator_cells(names), seeds, store, progress,
        lambda: generator_panels(names, seeds, store), columns=2, size=(6.0, 4.4),
    )  # fmt: skip


def mappings(
    mappings: str | Sequence[str] | None = None,
    *,
    seeds: int | None = None,
    quick: bool = False,
    keep: FilePath | None = None,
    fresh: bool = False,
    progress: bool = False,
) -> Chart:
    """Nanoseconds a point against the discrepancy that a mapping keeps, and its rounding.

    Parameters
    ----------
    mappings : str with commas, or sequence of str, optional
        Names of `sunfleck.MAPPINGS`. None: all.
    seeds, quick, keep, fresh, progress
        As in `patterns`. Seeds: 32; 8 if quick.

    Returns
    -------
    Chart

    Raises
    ------
    ValueError, TypeError, OSError
        A name, count or file that can't be, before anything is measured.

    Notes
    -----
    Discrepancy is the largest difference between the share of 1,024 mapped points and that of the
    shape's measure, over 512 half spaces through it; it is charted over that of random points.
    Rounding is that of float32 samples beside
    float64 ones at the same u.

    Examples
    --------
    >>> import sunfleck as sf
    >>> made = sf.chart.mappings("disk_polar,disk_concentric", quick=True)
    >>> [panel.title for panel in made.panels]
    ['what sobol keeps', 'what jittered keeps', 'rounding of float32']
    """
    names = _names("mappings", mappings, tuple(MAPPINGS), tuple(MAPPINGS))
    seeds = _count("seeds", seeds, 8 if quick else 32, 2, 10**6)
    store = Store(keep, fresh)
    return measured(
        "Mappings: nanoseconds a point against accuracy", mapping_cells(names), seeds, store, progress,
        lambda: mapping_panels(names, seeds, store), columns=2, size=(7.2, 4.6),
    )  # fmt: skip


KINDS: dict[str, Callable[..., Chart]] = {
    "patterns": patterns,
    "scenes": scenes,
    "generators": generators,
    "mappings": mappings,
}
"""What can be charted: name → the function that does."""


class _CallableModule(types.ModuleType):
    """Lets ``sf.chart(kind, ...)`` be said for ``sf.chart.KINDS[kind](...)``."""

    def __call__(self, kind: str = "patterns", /, *arguments: Any, **options: Any) -> Chart:
        return KINDS[choice("kind", kind, KINDS)](*arguments, **options)


sys.modules[__name__].__class__ = _CallableModule
