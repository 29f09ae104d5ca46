# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""page: a page in a browser: it loads without a network, shows its pictures and charts, and its clicks work."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from sunfleck.plot.figure import Panel, Series, draw_panels, new_figure, png
from sunfleck.plot.page import Page

OpenPage = Callable[[Path], Any]


def drawn(title: str) -> bytes:
    made, axes = new_figure(1, 1, 2, 1.5)
    axes[0, 0].set_title(title)
    return png(made)


@pytest.fixture(scope="module")
def small_page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    page = Page("A page <with> signs", "made by a test")
    page.heading("Pictures")
    page.text("Two that flip, and one alone.")
    page.pictures({"first": drawn("1"), "second & last": drawn("2")})
    page.pictures({"alone": drawn("3")})
    page.heading("Chart")
    panel = Panel("Error", "samples", "error", [Series("a", [1, 2, 4], [1, 0.5, 0.25]), Series("b", [1, 4], [2, 1])])
    page.chart(panel)
    page.pictures({"drawn": png(draw_panels([panel], "made by a test"))})
    path = tmp_path_factory.mktemp("page") / "small.html"
    page.save(path)
    return path


def test_a_page_loads_and_flips_and_zooms(small_page: Path, open_page: OpenPage) -> None:
    browser = open_page(small_page)
    assert browser.title == "A page <with> signs"
    figure, _alone, _chart = browser.find_elements("css selector", "figure")
    first, second = figure.find_elements("css selector", "img")
    caption = figure.find_element("css selector", "figcaption")
    assert (first.is_displayed(), second.is_displayed(), caption.text) == (True, False, "first")
    figure.find_element("css selector", "button").click()
    assert (first.is_displayed(), second.is_displayed(), caption.text) == (False, True, "second & last")
    zoomed = browser.find_element("css selector", "#zoom img")
    assert not zoomed.is_displayed()
    second.click()
    assert zoomed.is_displayed()
    assert zoomed.get_attribute("src") == second.get_attribute("src") != first.get_attribute("src")
    zoomed.click()
    assert not zoomed.is_displayed()
    figure.find_element("css selector", "button").click()
    assert first.is_displayed()


def test_a_page_s_chart_is_drawn_and_its_legend_hides_a_series(small_page: Path, open_page: OpenPage) -> None:
    browser = open_page(small_page)
    assert len(browser.find_elements("css selector", ".chart .scatterlayer .trace")) == 2
    browser.find_elements("css selector", ".chart .legendtoggle")[0].click()
    hidden = "return document.querySelector('.chart').data[0].visible;"
    browser.execute_async_script("setTimeout(arguments[0], 600);")  # plotly waits for a second click
    assert browser.execute_script(hidden) == "legendonly"


@pytest.mark.parametrize(
    "body",
    [
        "<script>throw new Error('thrown')</script>",
        "<script>console.error('written')</script>",
        "<img alt='missing' src='missing.png'>",
        "<script src='https://sunfleck.invalid/x.js'></script>",
    ],
)
def test_a_page_that_is_broken_does_not_pass(body: str, tmp_path: Path, open_page: OpenPage) -> None:
    path = tmp_path / "broken.html"
    path.write_text(f"<!doctype html><html><body>{body}</body></html>", encoding="utf-8")
    with pytest.raises(AssertionError):
        open_page(path)
