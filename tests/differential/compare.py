# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Tests whether two ways of rendering have the same mean, by blocks of independent samples.

Welch's test of block means, as Jung, Hanika & Dachsbacher 2020, "Detecting Bias in Monte Carlo Renderers using
Welch's t-test" (JCGT 9(2)), here over the frame and its sixths rather than over pixels. A scene is judged in two steps
of independent samples. The first, cheap, asks whether any of its tests has a p-value below `SCREEN`; only then the
second draws `AGAIN` times as many samples, and only its p-values count. Where one is below `CONFIRM` a third step
repeats it, against heavy tails, and the larger p-value stands. Tests that were not drawn again have p = 1. All this can
only lower the rate of false alarms, and Holm's correction (1979) over all tests of the run bounds it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats

import sunfleck as sf
from reference import FILTERS, Reference
from scenes import World, random_world

Array = NDArray[np.float64]

SCREEN = 1e-3  # the p-value below which a scene is drawn again
CONFIRM = 1e-6  # the p-value of the second step below which it is done once more, and the larger one counts
AGAIN = 4  # times as many samples then
BLOCKS = 32  # independent seeds of each side
PATHS = 1e5  # of the library, for each of the two ways of a scene
PLAIN_TESTS = 3e7  # of a ray against a primitive, for the plain tracer
LEAK = 1e-6  # of the brightest radiance: without `robust` 1 ray in 10^7 passes an edge, more where triangles are small
SLACK = 3e-4  # relative difference that single precision and the lifting of points off surfaces may make
COLUMNS, ROWS = 3, 2
TESTS = ("R", "G", "B", "A", *(f"part {x},{y}" for y in range(ROWS) for x in range(COLUMNS)))
PAIRS = ("first - plain", "second - plain", "first - second")
SIGNED = ("mitchell", "lanczos")  # filters with negative lobes
SMALL = 110  # pixels of frames that many samples a pixel are afforded for
TESTS_OF_SCENE = len(TESTS) * len(PAIRS)


@dataclass
class Frame:
    """What picture is asked for: the same for all sides."""

    width: int
    height: int
    pixel_filter: str
    crop: tuple[int, int, int, int] | None
    mask: NDArray[np.bool_] | None

    @property
    def wanted(self) -> NDArray[np.bool_]:
        wanted = np.ones((self.height, self.width), dtype=bool) if self.mask is None else self.mask.copy()
        if self.crop:
            x0, y0, x1, y1 = self.crop
            inside = np.zeros_like(wanted)
            inside[y0:y1, x0:x1] = True
            wanted &= inside
        return wanted


@dataclass
class Way:
    """How the library renders it: nothing of this changes the mean."""

    scene: dict[str, Any]
    render: dict[str, Any]

    @property
    def samples(self) -> int:
        return int(self.render.get("spp") or 2 * self.render["max_spp"])

    def __str__(self) -> str:
        return ", ".join(f"{k}={v}" for k, v in (self.scene | self.render).items())


def draw_frame(rng: np.random.Generator) -> Frame:
    pixel_filter = "box" if rng.random() < 0.4 else str(rng.choice(FILTERS))
    small = pixel_filter in SIGNED or rng.random() < 0.3
    width, height = (int(n) for n in rng.integers(7, (12, 10) if small else (32, 24)))
    crop, mask = None, None
    if rng.random() < 0.25:
        x, y = rng.integers(0, width // 2), rng.integers(0, height // 2)
        crop = (
            int(x),
            int(y),
            int(rng.integers(x + width // 3, width)) + 1,
            int(rng.integers(y + height // 3, height)) + 1,
        )
    if rng.random() < 0.25:
        mask = rng.random((height, width)) < rng.choice([0.2, 0.5, 0.9])
        mask[crop[1] if crop else 0, crop[0] if crop else 0] = True  # one pixel at least
    return Frame(width, height, pixel_filter, crop, mask)


def draw_way(rng: np.random.Generator, world: World, frame: Frame) -> Way:
    def pick(*values: Any) -> Any:
        return values[int(rng.integers(len(values)))]

    sampling = pick("both", "both", "both", "light", "surface")
    if any(sun["angular_radius"] < 2 for sun in world.suns) and sampling == "surface":
        sampling = "both"  # the narrow sun would be a few bright samples; that of angle 0 is missed
    if world.fog and sampling == "light":
        sampling = "both"  # in fog the squared distance to a light has no bound below: the variance is infinite
    scene = {
        "light_sampling": sampling,
        "light_choice": pick("auto", "auto", "power", "tree"),
        "solid_angle_ratio": pick(1.0, 1.0, 0.0, 3.0, math.inf),
        "robust": pick(False, False, True),
    }
    # Filters with negative lobes average their two signs apart, which is without bias where there are some of both.
    signed, small = frame.pixel_filter in SIGNED, frame.wanted.sum() <= SMALL
    seeds = pick("pixel", "pixel", "pixel", "thread", "shared")
    render: dict[str, Any] = {
        "pattern": pick("sobol", "sobol", "random", "halton", "jittered"),
        "threads": pick(1, 2, 3),
        "tile_size": pick(8, 16, 32, 64),
        "roulette": pick(0, 0, 2, 3),
        "seeds": seeds,
    }
    if small and rng.random() < 0.3 and not signed:
        render |= {"unbiased": True, "tolerance": 0.1, "min_spp": 16, "max_spp": 64}
        render["stop"] = pick("dyadic", "replicates", "standard_error")
        return Way(scene, render)
    few = 1, 2, 3, 4, 7, 8, 15, 16, 17
    render["spp"] = pick(128, 160) if signed else pick(*few, 31, 32, 33, 64, 128) if small else pick(*few)
    if render["pattern"] == "jittered" and not signed:
        render["spp"] = pick(1, 2, 4, 9, 16)
    elif render["pattern"] != "jittered" and rng.random() < 0.2:
        render["start"] = pick(1, 16, 100)
    return Way(scene, render)


@dataclass
class Case:
    """A scene, what is asked of it, and two ways to render it: all from one seed."""

    seed: int
    world: World = field(init=False)
    frame: Frame = field(init=False)
    ways: tuple[Way, Way] = field(init=False)

    def __post_init__(self) -> None:
        rng = np.random.default_rng([self.seed, 0xFA2E])
        self.world = random_world(self.seed)
        self.frame = draw_frame(rng)
        self.ways = draw_way(rng, self.world, self.frame), draw_way(rng, self.world, self.frame)

    def describe(self) -> str:
        f = self.frame
        masked = "" if f.mask is None else f", mask of {int(f.mask.sum())}"
        return (
            f"scene {self.seed}: {self.world.story}\n"
            f"  frame   {f.width} x {f.height}, {f.pixel_filter}, crop {f.crop}{masked}\n"
            f"  first   {self.ways[0]}\n"
            f"  second  {self.ways[1]}"
        )


# ---- block means ----


def _values(pictures: list[Array], frame: Frame) -> Array:
    """(blocks, tests): the means of pictures of the frame's wanted pixels."""
    wanted = frame.wanted
    ys, xs = np.nonzero(wanted)
    left, top, right, bottom = xs.min(), ys.min(), xs.max() + 1, ys.max() + 1
    part = (ys - top) * ROWS // (bottom - top) * COLUMNS + (xs - left) * COLUMNS // (right - left)
    out = np.zeros((len(pictures), len(TESTS)))
    for row, picture in zip(out, pictures, strict=True):
        pixels = picture[ys, xs]
        row[:4] = pixels.mean(axis=0)
        sums = np.bincount(part, pixels[:, :3].mean(axis=1), ROWS * COLUMNS)
        row[4:] = sums / np.maximum(np.bincount(part, minlength=ROWS * COLUMNS), 1)
    if frame.pixel_filter in SIGNED:  # alpha counts samples, whatever their sign
        out[:, 3] = 0
    return out


def _image(scene: sf.Scene, frame: Frame, way: Way, seed: int) -> tuple[Array, int]:
    image = sf.render(
        scene,
        frame.width,
        frame.height,
        pixel_filter=frame.pixel_filter,
        crop=frame.crop,
        mask=frame.mask,
        seed=seed,
        **way.render,
    )
    full = np.zeros((frame.height, frame.width, 4))
    x, y = frame.crop[:2] if frame.crop else (0, 0)
    h, w = image.color.shape[:2]
    full[y : y + h, x : x + w, :3] = image.color
    full[y : y + h, x : x + w, 3] = image.alpha
    return full, image.summary().nonfinite_samples


# ---- the test ----


@dataclass
class Finding:
    """One test: the two means and how sure it is that they differ."""

    pair: str
    test: str
    one: float
    other: float
    p: float

    def __str__(self) -> str:
        relative = (self.one - self.other) / self.other if self.other else math.inf
        return (
            f"{self.pair}, {self.test}: {self.one:.6g} and {self.other:.6g} ({100 * relative:+.2f} %), p = {self.p:.1e}"
        )


def welch(a: Array, b: Array, unseen: float = 0.0) -> Array:
    """p-values (tests,) that the columns' means differ by more than `SLACK` of them, and by more than `unseen`."""
    means = a.mean(axis=0), b.mean(axis=0)
    slack = SLACK * np.maximum(np.abs(means[0]), np.abs(means[1])) + 1e-7 * max(np.abs(means[1][:3]).max(), 1e-30)
    slack = slack + unseen * np.where(np.arange(slack.size) < 4, 1, ROWS * COLUMNS)
    off = np.maximum(np.abs(means[0] - means[1]) - slack, 0)
    va, vb = a.var(axis=0, ddof=1) / len(a), b.var(axis=0, ddof=1) / len(b)
    both = va + vb
    known = both > 0
    freedom = np.where(known, both, 1) ** 2 / np.where(known, va**2 / (len(a) - 1) + vb**2 / (len(b) - 1), 1)
    t = off / np.sqrt(np.where(known, both, 1))
    return np.asarray(np.where(known, 2 * stats.t.sf(t, freedom), np.where(off > 0, 0.0, 1.0)))


@dataclass
class Verdict:
    """What came of a scene."""

    seed: int
    findings: list[Finding] = field(default_factory=list)  # the second step's; none where there was none
    nonfinite: int = 0  # samples
    drawn_again: bool = False
    screen: float = 1.0  # the least p-value of the first step
    precision: float = 0.0  # standard error of the frame's green, first way against the reference, over its mean
    crash: str = ""

    @property
    def broken(self) -> str:
        """What is wrong with it whatever its means; empty where nothing is."""
        return self.crash or (f"{self.nonfinite} samples that are not finite" if self.nonfinite else "")


def _blocks(case: Case, number: int, step: int, effort: float) -> int:
    """Seeds that a way is rendered with; many where a render has few paths."""
    way, size = case.ways[number], case.frame.width * case.frame.height
    blocks = min(max(effort * PATHS / (way.samples * size), BLOCKS), 4 * BLOCKS)
    return int(blocks) * (AGAIN if step else 1)


def _draw(case: Case, library: Any, step: int, effort: float) -> tuple[list[Array], int]:
    """Block values of the plain tracer and of both ways."""
    frame, world, times = case.frame, case.world, effort * (AGAIN if step else 1)
    pixels = int(frame.wanted.sum())
    rays = 1 + 1.5 * world.max_bounces
    spp = max(1, round(times * PLAIN_TESTS / (rays * (world.primitives + 10)) / pixels / BLOCKS))
    plain = Reference(library, world, frame.width, frame.height, frame.pixel_filter)
    key = (case.seed << 20) + (step << 16)
    sides = [_values([plain.render(key + k, spp, frame.wanted) for k in range(BLOCKS)], frame)]
    nonfinite = 0
    for number, way in enumerate(case.ways):
        scene = world.scene(**way.scene)
        pictures = []
        for k in range(_blocks(case, number, step, effort)):
            picture, dropped = _image(scene, frame, way, key + ((number + 1) << 12) + k)
            pictures.append(picture)
            nonfinite += dropped
        sides.append(_values(pictures, frame))
    return sides, nonfinite


def _brightest(case: Case) -> float:
    """The largest radiance of lamps, suns and sky."""
    lamps = [max(item.surface.emission) for item in case.world.items]
    discs = [(s, math.sin(math.radians(s["angular_radius"])) ** 2 * math.pi or 1.0) for s in case.world.suns]
    suns = [max(sun["irradiance"]) / solid for sun, solid in discs]
    sky = [float(case.world.environment["image"].max())] if case.world.environment else []
    return float(max([*lamps, *suns, *sky, *case.world.background]))


def _unseen(case: Case, number: int, step: int, effort: float) -> float:
    """What a way by surface sampling alone may owe to hits too rare to have occurred.

    Of events that none of n paths met, 15 / n is the probability that a chance of 3e-7 leaves open; each brings at
    most what the brightest lamp shines. Such a way may show no light where there is little, and no spread either.
    """
    way, frame = case.ways[number], case.frame
    if way.scene["light_sampling"] != "surface":
        return 0.0
    paths = _blocks(case, number, step, effort) * int(frame.wanted.sum()) * way.samples
    return 15 / paths * _brightest(case)


def _compare(case: Case, sides: list[Array], step: int, effort: float) -> list[Finding]:
    out = []
    leak = LEAK * _brightest(case)
    rare = [0.0, _unseen(case, 0, step, effort), _unseen(case, 1, step, effort)]
    for name, one, other in zip(PAIRS, (1, 2, 1), (0, 0, 2), strict=True):
        p = welch(sides[one], sides[other], leak + rare[one] + rare[other])
        means = sides[one].mean(axis=0), sides[other].mean(axis=0)
        out += [Finding(name, t, float(a), float(b), float(q)) for t, a, b, q in zip(TESTS, *means, p, strict=True)]
    return out


def judge(seed: int, library: Any, effort: float = 1.0) -> Verdict:
    """Renders a scene by the plain tracer and in two ways, and compares the three.

    `effort` multiplies the samples of all of them, but that a way has `BLOCKS` seeds at the least.
    """
    case = Case(seed)
    sides, nonfinite = _draw(case, library, 0, effort)
    found = _compare(case, sides, 0, effort)
    least = min(f.p for f in found)
    error = math.sqrt(sum(float(s[:, 1].var(ddof=1)) / len(s) for s in sides[:2]))
    mean = float(sides[0][:, 1].mean())
    verdict = Verdict(seed, [], nonfinite, least < SCREEN, least, error / mean if mean > 0 else 0.0)
    if verdict.drawn_again:
        sides, more = _draw(case, library, 1, effort)
        verdict.findings = _compare(case, sides, 1, effort)
        verdict.nonfinite += more
        if min(f.p for f in verdict.findings) < CONFIRM:
            sides, more = _draw(case, library, 2, effort)
            for finding, other in zip(verdict.findings, _compare(case, sides, 2, effort), strict=True):
                finding.p = max(finding.p, other.p)
            verdict.nonfinite += more
    return verdict


def holm(verdicts: list[Verdict], rate: float) -> list[tuple[Verdict, Finding]]:
    """The findings that stand at a family-wise error rate over all tests of all scenes."""
    ordered = sorted(((v, f) for v in verdicts for f in v.findings), key=lambda pair: pair[1].p)
    total = TESTS_OF_SCENE * len(verdicts)
    for rank, (_, finding) in enumerate(ordered):
        if finding.p > rate / (total - rank):
            return ordered[:rank]
    return ordered
