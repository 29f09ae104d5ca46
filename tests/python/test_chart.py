# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""chart: slopes against theory, broken patterns seen as such, runs that go on, files and pages."""

import csv
import itertools
import json
import math
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sunfleck as sf
from sunfleck.chart.cells import Cell, Store, disturbance, least_time, measure_cells
from sunfleck.chart.fit import fit_slope, log_allowance, pareto_front, theory_of, winners
from sunfleck.chart.generator_chart import FAILED, TESTS, linear_complexity
from sunfleck.chart.pattern_chart import VARIANTS, method_named
from sunfleck.integrands import INTEGRANDS, standard_deviation

SEEDS = 48


def errors_of(pattern: str, case: str, counts: list[int], seeds: int = SEEDS, first: int = 0) -> list[list[float]]:
    integrand, make = INTEGRANDS[case], method_named(pattern).make
    return [
        [float(integrand.f(make(n, integrand.d, (n << 24) + first + s)).mean()) - integrand.exact for s in range(seeds)]
        for n in counts
    ]


# ---- integrands --------------------------------------------------------------------------------


@pytest.mark.parametrize("name", [name for name in INTEGRANDS if not INTEGRANDS[name].pole and name != "corner"])
def test_integrands_integrate_to_what_they_say(name: str) -> None:
    integrand = INTEGRANDS[name]
    n = 2**14
    means = [integrand.f(sf.points("sobol", n, integrand.d, seed=s, dtype="float64")).mean() for s in range(16)]
    # Student's t with 15 degrees of freedom is beyond 6.5 once in 100,000.
    assert abs(np.mean(means) - integrand.exact) < 6.5 * np.std(means, ddof=1) / 4
    assert np.std(means, ddof=1) < standard_deviation(name) / math.sqrt(n)  # else the bound above says little


def test_standard_deviations_are_those_that_are_known() -> None:
    # |x + y - 1| has E f^2 = 1/6; the corner is Bernoulli; the pole has 1/(1 - 0.9) - 1/0.55^2.
    assert standard_deviation("kink") == pytest.approx(math.sqrt(1 / 6 - 1 / 9), rel=1e-3)
    assert standard_deviation("circle") == pytest.approx(math.sqrt(math.pi * (4 - math.pi)), rel=1e-3)
    assert standard_deviation("corner") == pytest.approx(1e-2, rel=0.03)  # 26 of 2^18 points are in it, or 27
    assert standard_deviation("pole") == pytest.approx(math.sqrt(10 - 1 / 0.55**2), rel=1e-12)
    assert standard_deviation("heavy-pole") == math.inf


# ---- slopes ------------------------------------------------------------------------------------

# Fitted over n = 4^2 .. 4^6: squares, on which jittered's strata are square too. The tolerance is
# four standard errors, which follow from the seeds, and on the flat side theory's logarithm
# (d - 1)/2 over the same n; a slope of independent fits is beyond once in 15,000.
SQUARES = [4**k for k in range(2, 7)]


@pytest.mark.parametrize("first", [0, 10**6])
@pytest.mark.parametrize(
    ("pattern", "case", "theory"),
    [
        ("random", "exp", -0.5),
        ("random", "product", -0.5),
        ("jittered", "product", -1.0),
        ("jittered", "circle", -0.75),
        ("latin", "product", -0.5),
        ("sobol", "exp", -1.5),
        ("sobol", "product", -1.5),
        ("sobol:nested", "product", -1.5),
        ("sobol:lms", "product", -1.5),
        ("sz", "product", -1.5),
    ],
)
def test_slopes_on_integrands_are_theory_s(pattern: str, case: str, theory: float, first: int) -> None:
    method = method_named(pattern)
    assert theory_of(method.pattern, method.scramble, INTEGRANDS[case]) == theory
    fit = fit_slope(SQUARES, errors_of(pattern, case, SQUARES, first=first))
    assert fit is not None
    assert 0 < fit.error < 0.12  # of lms, whose errors have the longest tails; others 0.01 to 0.05
    logarithm = log_allowance(INTEGRANDS[case].d, fit.counts) if theory == -1.5 else 0.0
    assert theory - 4 * fit.error < fit.slope < theory + logarithm + 4 * fit.error


def test_the_standard_error_of_a_slope_is_what_slopes_vary_by() -> None:
    fits = [fit_slope(SQUARES, errors_of("random", "exp", SQUARES, 32, 1000 * k)) for k in range(60)]
    slopes, errors = np.array([(f.slope, f.error) for f in fits if f]).T
    # A standard deviation of 60 values is known to 9 %; four times that, and the delta method's own
    # few per cent at 32 seeds.
    assert slopes.std(ddof=1) == pytest.approx(float(np.sqrt(np.mean(errors**2))), rel=0.45)
    assert abs(slopes.mean() + 0.5) < 4 * slopes.std(ddof=1) / math.sqrt(60)


def test_a_line_is_fitted_exactly_and_rounding_is_left_out() -> None:
    counts = [2**k for k in range(4, 14)]
    fit = fit_slope(counts, [[3.0 * n**-1.25] * 5 for n in counts])
    assert fit is not None
    assert fit.slope == pytest.approx(-1.25)
    assert fit.error == pytest.approx(0, abs=1e-12)
    assert fit.counts[0] == 64
    assert fit_slope(counts, [[1e-16] * 5 for _ in counts]) is None


# ---- broken patterns ---------------------------------------------------------------------------


def mark_of(made: sf.chart.Chart, name: str) -> str:
    """What the chart says of a pattern."""
    [found] = re.findall(rf"(?<![\w:]){re.escape(name)}: ([^,\n]*)", made.text)
    return str(found)


@pytest.mark.parametrize("seeds", [16, 32])
def test_broken_patterns_are_seen_as_what_they_are(seeds: int) -> None:
    names = ["random", "sobol", *VARIANTS]
    made = sf.chart.patterns(names, integrands="product", scene=None, seeds=seeds, max_samples=4096)
    assert "✗" not in mark_of(made, "random")
    assert "✗" not in mark_of(made, "sobol")
    # Owen 2020: without its first point Sobol's n^-3/2 is n^-1.
    dropped = mark_of(made, "sobol-dropped-first")
    assert dropped.endswith("(theory -1.5) ✗")
    assert float(dropped.split()[0]) == pytest.approx(-1.0, abs=0.15)  # four standard errors at 16 seeds
    # 16 threads with one seed: the rate of random points at a 16th of them, 4 sigma / sqrt(n).
    shared = re.fullmatch(r"(\S+) \(theory -0.5\) ✗ (\S+) × σ/√n", mark_of(made, "random-shared-seeds"))
    assert shared
    assert float(shared[2]) == pytest.approx(4.0, rel=4 * math.sqrt(2 / (9 * seeds)) / 2)  # mean square of 9 counts
    # On the diagonal it converges, to another integral.
    diagonal = mark_of(made, "random-shared-dimensions")
    assert float(diagonal.split()[0]) > -0.2
    assert "✗" in diagonal


def test_broken_patterns_are_made_as_they_say() -> None:
    sobol = sf.points("sobol", 32, 3, seed=5, dtype="float64")
    assert np.array_equal(VARIANTS["sobol-dropped-first"].make(16, 3, 5), sobol[1:17])
    shared = VARIANTS["random-shared-seeds"].make(64, 2, 5)
    assert np.array_equal(shared, np.tile(sf.points("random", 4, 2, seed=5, dtype="float64"), (16, 1)))
    diagonal = VARIANTS["random-shared-dimensions"].make(64, 3, 5)
    assert np.array_equal(diagonal[:, 0], diagonal[:, 2])


# ---- fronts and winners ------------------------------------------------------------------------


def test_the_front_is_what_nothing_beats() -> None:
    rng = np.random.default_rng(1)
    for _ in range(50):
        x, y = rng.integers(0, 8, (2, 12)).astype(float)
        front = set(pareto_front(x, y).tolist())
        for i in range(12):
            beaten = any((x[j] <= x[i] and y[j] <= y[i]) and (x[j] < x[i] or y[j] < y[i]) for j in range(12))
            same_before = any(x[j] == x[i] and y[j] == y[i] and j in front for j in range(12) if j != i)
            assert (i in front) == (not beaten and not same_before)


def test_winners_are_the_least_within_each_budget() -> None:
    rng = np.random.default_rng(2)
    x, y = 10 ** rng.uniform(-5, 1, 40), 10 ** rng.uniform(-9, -1, 40)
    names = [f"m{i}" for i in range(40)]
    for budget, name, error in winners(names, x, y):
        assert error == y[x <= budget].min()
        assert names[int(np.argmin(np.where(x <= budget, y, np.inf)))] == name


# ---- cells -------------------------------------------------------------------------------------


def cells_that_count(calls: list[tuple[str, int]], stop_at: int = 10**9) -> list[Cell]:
    def measure(name: str, seed: int) -> dict[str, float]:
        if len(calls) == stop_at:
            raise KeyboardInterrupt
        calls.append((name, seed))
        return {"value": 10.0 * seed}

    return [Cell((name, "m", 1), lambda seed, name=name: measure(name, seed), 1.0) for name in "abc"]  # type: ignore[misc]


def test_a_run_goes_on_where_it_was_stopped(tmp_path: Path) -> None:
    path = tmp_path / "c.json"
    first: list[tuple[str, int]] = []
    assert not measure_cells(cells_that_count(first, stop_at=4), 3, Store(path))
    second: list[tuple[str, int]] = []
    store = Store(path)
    assert measure_cells(cells_that_count(second), 3, store)
    assert first + second == list(itertools.product("abc", (1, 2, 3)))
    assert store.get(("a", "m", 1), 3) == {"value": [10, 20, 30]}
    third: list[tuple[str, int]] = []
    assert measure_cells(cells_that_count(third), 4, Store(path))  # more seeds add to what is there
    assert third == [(name, 4) for name in "abc"]
    assert Store(path, fresh=True).seeds(("a", "m", 1)) == 0


def test_numbers_of_elsewhere_and_files_of_others_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "c.json"
    measure_cells(cells_that_count([]), 1, Store(path))
    kept = json.loads(path.read_text())
    for name in ("processor", "compiler", "version"):
        path.write_text(json.dumps({**kept, name: "another"}))
        with pytest.raises(ValueError, match=f"measured with {name} another"):
            Store(path)
        assert Store(path, fresh=True).seeds(("a", "m", 1)) == 0
    for other in ("{}", "[1, 2]", "not json", '{"format": "mine"}'):
        path.write_text(other)
        for fresh in (False, True):
            with pytest.raises(ValueError, match="does not hold the numbers of a chart"):
                Store(path, fresh)
        assert path.read_text() == other


def test_a_chart_that_is_drawn_again_measures_nothing(tmp_path: Path) -> None:
    options = {"integrands": "exp", "scene": None, "seeds": 3, "max_samples": 128, "keep": tmp_path / "c.json"}
    first = sf.chart.patterns("random,sobol", **options)  # type: ignore[arg-type]
    again = sf.chart("patterns", "random,sobol", **options)  # type: ignore[operator]
    assert again.rows == first.rows  # seconds too
    assert again.text == first.text


def test_of_timings_the_least_is_drawn_and_a_busy_machine_is_told() -> None:
    cells = [Cell(("case", "method", float(n)), lambda seed: {}, 1.0) for n in (16, 32, 64)]
    quiet, busy = Store(), Store()
    for cell in cells:
        for k in range(8):
            quiet.add(cell.key, {"error": 2.0**-k, "seconds": cell.key[2] * (1 + 0.01 * k)})
            busy.add(
                cell.key, {"error": 2.0**-k, "seconds": cell.key[2] * (1 if k == 5 else 2 + (k + cell.key[2]) % 7)}
            )
    assert disturbance(cells, 8, quiet) == ""
    assert "the machine was not quiet: a point's median timing is " in disturbance(cells, 8, busy)
    for store in (quiet, busy):
        seconds = [least_time((store.get(cell.key, 8) or {})["seconds"]) for cell in cells]
        assert seconds == [16, 32, 64]  # not backwards, however busy it was
    assert math.isnan(least_time([math.nan]))
    assert least_time([math.nan, 3, 2]) == 2


def test_errors_do_not_depend_on_the_run() -> None:
    a, b = (
        sf.chart.patterns(names, integrands=cases, scene=None, seeds=4, max_samples=256)
        for names, cases in (("random,sobol", "exp,kink"), ("sobol", "kink"))
    )
    of = {(row["case"], row["method"], row["n"]): row["error_rms"] for row in a.rows}
    assert all(of[row["case"], row["method"], row["n"]] == row["error_rms"] for row in b.rows)
    assert len(b.rows) == 5


# ---- the other kinds ---------------------------------------------------------------------------


def test_pixels_of_a_scene(tmp_path: Path) -> None:
    made = sf.chart.patterns("random,sobol", integrands="exp", scene="penumbra", seeds=4, quick=True)
    rows = {(r["method"], r["n"]): r["error_rms"] for r in made.rows if r["case"].startswith("penumbra")}
    # 576 pixels and 4 seeds know an error to some 3 %; penumbra's edges keep Sobol' well below random.
    assert rows["random", 4] / rows["random", 64] == pytest.approx(4.0, rel=0.12)
    assert rows["sobol", 64] < 0.5 * rows["random", 64]
    assert rows["reference", 2**14] < 0.1 * rows["sobol", 64]
    assert "its own error" in made.text
    made.save(tmp_path / "p.png")


def test_scenes_have_fixed_and_adaptive_on_one_chart() -> None:
    made = sf.chart.scenes("penumbra", patterns="random", stops="standard_error", tolerances="0.2,0.1", quick=True)
    speed, calibration, *_ = made.panels
    assert [s.name for s in speed.series] == ["random, fixed", "random, standard_error", "Pareto front"]
    asked, got = (np.asarray(v, float) for v in (calibration.series[0].x, calibration.series[0].y))
    assert asked.tolist() == [0.1, 0.2]
    # The rule is right for independent samples: an error above the tolerance / 1.96 would be news.
    assert (got < asked / 1.96).all()
    [row] = [r for r in made.rows if r["method"] == "random, standard_error" and r["n"] == 0.1]
    assert 0.85 < row["coverage_median"] < 0.99  # of 0.95 asked, less on pixels of few, skewed samples
    assert len(made.pictures) == 4
    assert all(data.startswith(b"\x89PNG") for data in made.pictures.values())


def test_a_render_that_ctrl_c_stops_is_no_number(monkeypatch: pytest.MonkeyPatch) -> None:
    from sunfleck.chart import pixels

    render = sf.render

    def stopped(*arguments: object, **options: object) -> sf.Image:
        return render(*arguments, progress=lambda _: False, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(pixels, "render", stopped)
    made = sf.chart.patterns("sobol", integrands="exp", seeds=2, quick=True)
    assert not made.complete
    assert made.about.startswith("interrupted: ")


def test_generators_fail_what_they_must() -> None:
    made = sf.chart.generators("minstd,randu,xorshift64,mt19937,sfc64,philox4x32", quick=True)
    failed = {row["method"]: set[str]() for row in made.rows}
    for row in made.rows:
        if "p_median" in row and row["p_10%"] < FAILED:
            failed[row["method"]].add(row["case"])
    by = {name: {t for t in TESTS if name in failed.get(t, ())} for name in ("randu", "mt19937", "sfc64")}
    assert made.text.count("\n") == 7
    lines = {line.split()[0]: line for line in made.text.splitlines()[2:]}
    assert "triples" in lines["randu"]  # 15 planes
    assert "birthday spacings" in lines["minstd"]  # L'Ecuyer & Simard 2001: from 16 m^(1/3) = 20,643 on
    for linear in ("xorshift64", "mt19937"):
        assert "complexity, top bit" in lines[linear]
    for good in ("sfc64", "philox4x32"):
        assert lines[good].split()[3:] == ["0"]
    assert by["sfc64"] == set()


@pytest.mark.parametrize("test", TESTS)
def test_p_values_of_a_good_generator_are_uniform(test: str) -> None:
    words = [sf.Rng("philox4x32", seed=1000 + s).bits(1 << 17, dtype="uint32") for s in range(24)]
    p = np.sort([TESTS[test](w) for w in (words[:4] if test.startswith("complexity") else words)])
    if test.startswith("complexity"):  # discrete: 1, 1/2, 1/8, …
        assert p.min() > 1e-3
        return
    distance = np.max(np.abs(p - (np.arange(24) + 0.5) / 24)) + 0.5 / 24
    assert distance < 0.42  # Kolmogorov's distance at n = 24 is beyond once in 3,000


def test_linear_complexity_of_known_registers() -> None:
    state, bits = 0b1001, []
    for _ in range(200):  # x^4 + x + 1, a register of four
        bits.append(state & 1)
        state = state >> 1 | ((state ^ state >> 1) & 1) << 3
    assert linear_complexity(bits) == 4
    assert linear_complexity([0] * 9 + [1]) == 10
    mt = (sf.Rng("mt19937", seed=1).bits(41_000, dtype="uint32") & 1).tolist()
    assert linear_complexity(mt) == 19937


def test_mappings_keep_what_is_known_of_them() -> None:
    made = sf.chart.mappings("pixel_box,disk_polar,disk_concentric,disk_naive", quick=True, seeds=16)
    share = {row["method"]: row for row in made.rows if row["case"] == "disk_polar"}
    assert share["sobol"]["discrepancy_median"] < share["jittered"]["discrepancy_median"]
    assert share["jittered"]["discrepancy_median"] < 0.5 * share["random"]["discrepancy_median"]
    rounding = {row["case"]: row["ulps_median"] for row in made.rows if row["method"] == "float32"}
    assert rounding["pixel_box"] == 0
    assert 0.5 < rounding["disk_polar"] < 4  # 1.3 units in docs/mapping.md


# ---- files, pages, the command -----------------------------------------------------------------


def run(*arguments: str | Path, cwd: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "sunfleck", "chart", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False, cwd=cwd)


def test_the_command_writes_figure_numbers_and_page(tmp_path: Path, open_page: Callable[[Path], Any]) -> None:
    options = ["--quick", "--pattern", "random,sobol", "--integrand", "product,pole", "--seeds", "4"]
    result = run(*options, "--max-samples", "1024", "-o", "c.png", "-o", "d.svg", "--html", "c.html", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["c.csv", "c.html", "c.json", "c.png", "d.svg"]
    from sunfleck.provenance import compiler, processor

    for said in (processor(), compiler(), f"sunfleck {sf.__version__}", "seeds 1 .. 4"):
        assert said in result.stdout
        assert said in (tmp_path / "c.html").read_text()
    with open(tmp_path / "c.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {"case", "method", "n", "seeds", "error_median", "seconds_10%", "error_rms"} <= set(rows[0])
    page = (tmp_path / "c.html").read_text()
    assert page.count('class="chart"') == 6
    assert not re.findall(r'<(?:script|link|img)\b[^>]*(?:src|href)="https?:', page)
    browser = open_page(tmp_path / "c.html")
    assert len(browser.find_elements("css selector", ".chart .scatterlayer .trace")) >= 12  # six charts, two patterns
    browser.find_elements("css selector", ".chart .legendtoggle")[0].click()
    browser.execute_async_script("setTimeout(arguments[0], 600);")  # plotly waits for a second click
    assert browser.execute_script("return document.querySelector('.chart').data[0].visible;") == "legendonly"
    again = run(*options, "--max-samples", "1024", "-o", "c.png", cwd=tmp_path)
    assert again.stdout == result.stdout  # nothing was measured anew


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["pictures"], ["'pictures'", "patterns, scenes, generators, mappings"]),
        (["patterns", "nowhere"], ["'nowhere'", "penumbra"]),
        (["patterns", "nowhere.obj"], ["nowhere.obj"]),
        (["generators", "penumbra"], ["takes no scene"]),
        (["scenes", "--integrand", "exp"], ["takes no integrands"]),
        (["--pattern", "sobel"], ["'sobel'", "sobol", "sobol-dropped-first"]),
        (["--pattern", "sobol:permuted"], ["permuted"]),
        (["--integrand", "tan"], ["'tan'", "product"]),
        (["--integrand", ","], ["at least one"]),
        (["--seeds", "1"], ["seeds is 1", "2"]),
        (["--max-samples", "3"], ["max_samples is 3", "64"]),
        (["scenes", "--tolerance", "0.1,many"], ["many"]),
        (["scenes", "--tolerance", "2"], ["2", "(0, 1)"]),
        (["scenes", "--pattern", "latin"], ["'latin'", "jittered"]),
        (["generators", "--generator", "rand"], ["'rand'", "mt19937"]),
        (["-o", "c.jpg"], [".jpg", ".png, .svg, .html"]),
        (["--html", "c.htm"], [".htm", ".html"]),
        (["-o", "nowhere/c.png"], ["no folder"]),
    ],
)
def test_bad_input_is_refused_by_name(
    arguments: list[str], words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    from sunfleck.cli import main

    monkeypatch.chdir(tmp_path)
    assert main(["chart", *arguments]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("sunfleck: error: ")
    assert printed.err.count("\n") == 1
    for word in words:
        assert word in printed.err
    assert list(tmp_path.iterdir()) == []


def test_ctrl_c_draws_what_there_is_and_exits_with_130(tmp_path: Path) -> None:
    script = (
        "import itertools, os, signal, sys\n"
        "from sunfleck.chart import pattern_chart\n"
        "from sunfleck.cli import main\n"
        "measure, count = pattern_chart._measure, itertools.count()\n"
        "def stopped(*a):\n"
        "    if next(count) == 20: os.kill(os.getpid(), signal.SIGINT)\n"
        "    return measure(*a)\n"
        "pattern_chart._measure = stopped\n"
        "sys.exit(main(sys.argv[1:]))\n"
    )
    options = ["chart", "--pattern", "random,sobol", "--integrand", "exp", "--quick", "-o", "c.png"]
    command = [sys.executable, "-c", script, *options]
    result = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False, cwd=tmp_path)
    assert result.returncode == 130, result.stderr
    assert "interrupted" in result.stderr
    assert "interrupted: " in result.stdout
    kept = json.loads((tmp_path / "c.json").read_text())
    assert 19 <= sum(len(cell["error"]) for cell in kept["cells"].values() if "error" in cell) <= 22
    assert (tmp_path / "c.png").stat().st_size > 1000
    finished = run(*options[1:], cwd=tmp_path)
    assert finished.returncode == 0, finished.stderr
    now = json.loads((tmp_path / "c.json").read_text())["cells"]
    for key, cell in kept["cells"].items():
        assert all(now[key][name][: len(values)] == values for name, values in cell.items())


def test_a_chart_shows_itself_in_a_notebook() -> None:
    made = sf.chart.generators("sfc64", quick=True)
    assert made._repr_png_().startswith(b"\x89PNG")
    with pytest.raises(ValueError, match="kind is 'pictures'"):
        sf.chart("pictures")  # type: ignore[operator]
