# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""The laboratory: each failure fails and each remedy holds within their stated intervals, at several seeds.

The intervals are derived where the experiments are defined. Wide ones are about six standard deviations, so
that 45 experiments at 3 seeds have a chance in a million of a false alarm; the seeds are fixed all the same.
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import sunfleck as sf
from sunfleck.cli import main

pytest.importorskip("matplotlib")

NAMES = list(sf.lab.EXPERIMENTS)


@pytest.mark.parametrize("name", NAMES)
def test_the_failure_fails_and_the_remedy_holds(name: str) -> None:
    for seed in (1, 2, 2**20 + 3):
        result = sf.lab.run(name, seed=seed)
        (low, high), (low_after, high_after) = result.experiment.fails, result.experiment.holds
        assert low <= result.before <= high, f"seed {seed}: {result}"
        assert low_after <= result.after <= high_after, f"seed {seed}: {result}"
        assert result.holds


@pytest.mark.parametrize("name", NAMES)
def test_no_number_can_be_both_the_failure_and_the_remedy(name: str) -> None:
    """So that a remedy that stops working, or a failure that is mended, is seen."""
    fails, holds = sf.lab.EXPERIMENTS[name].fails, sf.lab.EXPERIMENTS[name].holds
    assert fails[0] <= fails[1]
    assert holds[0] <= holds[1]
    assert fails[1] < holds[0] or holds[1] < fails[0] or fails[0] >= holds[1] or holds[0] >= fails[1]


def test_there_are_enough_and_each_says_everything() -> None:
    assert len(NAMES) >= 24
    for experiment in sf.lab.EXPERIMENTS.values():
        for text in (experiment.line, experiment.claim, experiment.breaks, experiment.quantity, experiment.remedy):
            assert text.strip()


def test_a_run_is_a_pure_function_of_its_seed() -> None:
    for name in ("threads-one-seed", "one-sigma"):
        a, b, other = (sf.lab.run(name, seed=seed) for seed in (5, 5, 6))
        assert (a.before, a.after) == (b.before, b.after)
        assert (a.before, a.after) != (other.before, other.after)


def test_a_number_outside_its_interval_is_told() -> None:
    result = sf.lab.run("float-one")
    measured = type(result.measured)(127.0, 0.0, result.measured.failing, result.measured.remedied)
    assert not result.experiment.holds_for(measured)


@pytest.mark.parametrize(
    ("name", "seed", "told"), [("randu", 1, "experiment is 'randu'"), ("float-one", 0, "seed is 0")]
)
def test_bad_input_is_refused(name: str, seed: int, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        sf.lab.run(name, seed=seed)


def test_importing_sunfleck_imports_neither_the_laboratory_nor_matplotlib() -> None:
    code = "import sys, sunfleck; sys.exit(bool({'sunfleck.lab', 'matplotlib'} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
    code = "import sys, sunfleck; sunfleck.lab.run('float-one'); sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_the_list_has_a_name_and_a_line_each(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["lab", "--list"]) == 0
    listed = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in listed] == NAMES
    assert all(len(line.split(maxsplit=1)) == 2 for line in listed)


def test_one_experiment_prints_its_report_and_writes_its_figure(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["lab", "randu-planes", "-o", str(tmp_path / "planes.png")]) == 0
    told = capsys.readouterr().out
    for part in ("claim:", "break:", "number:", "remedy:", "number after:", "15 ("):
        assert part in told
    assert (tmp_path / "planes.png").read_bytes()[1:4] == b"PNG"


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ([], "give one of NAME, --list and --all"),
        (["randu-planes", "--list"], "give one of NAME, --list and --all"),
        (["--all"], "--all needs -o DIR"),
        (["nothing"], "experiment is 'nothing'; choose one of randu-planes,"),
        (["randu-planes", "--seed", "-1"], "seed is -1; it must be 1 to"),
        (["randu-planes", "-o", "planes.gif"], ".png"),
    ],
)
def test_the_command_refuses(arguments: list[str], told: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["lab", *arguments]) == 2
    assert told in capsys.readouterr().err


def test_the_page_holds_all_and_loads_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], open_page: Callable[[Path], Any]
) -> None:
    assert main(["lab", "--all", "-o", str(tmp_path / "lab")]) == 0
    assert capsys.readouterr().out.strip() == str(tmp_path / "lab" / "index.html")
    page = (tmp_path / "lab" / "index.html").read_text(encoding="utf-8")
    assert not re.search(r"""(src|href)\s*=\s*["']?\s*(https?:)?//|url\(\s*["']?https?:|@import""", page)
    for name in NAMES:
        assert f'id="{name}"' in page
        assert (tmp_path / "lab" / f"{name}.png").read_bytes()[1:4] == b"PNG"
    assert page.count("data:image/png;base64,") == len(NAMES)
    browser = open_page(tmp_path / "lab" / "index.html")
    browser.find_element("css selector", "figure img").click()
    assert browser.find_element("id", "zoom").is_displayed()


def test_the_docs_name_every_experiment() -> None:
    docs = Path(__file__).parents[2] / "docs" / "lab.md"
    named = re.findall(r"^\| `([^`]+)`", docs.read_text(encoding="utf-8"), re.MULTILINE)
    assert named == NAMES
