# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""What the tests of several modules start from."""

import os
import shutil
import signal
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from selenium import webdriver
from selenium.webdriver.support.ui import WebDriverWait

import sunfleck as sf

# Where the tests run in the background the shell has them ignore Ctrl-C, and what they start inherits that.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session")
def penumbra() -> sf.Scene:
    return sf.scenes.penumbra()


@pytest.fixture(scope="session")
def cornell() -> sf.Scene:
    return sf.scenes.cornell()


@pytest.fixture(scope="session")
def picture(penumbra: sf.Scene) -> sf.Image:
    """A small adaptive picture, for what is done with pictures."""
    return sf.render(penumbra, 40, 24, tolerance=0.05, seed=7)


@pytest.fixture(scope="session")
def chromium() -> Iterator[webdriver.Chrome]:
    """A headless Chromium without network, for all tests of pages."""
    browser, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if os.environ.get("SUNFLECK_WITHOUT_CHROMIUM"):
        pytest.skip("SUNFLECK_WITHOUT_CHROMIUM is set")
    if not browser or not driver:
        pytest.fail("pages are tested in Debian's chromium with chromium-driver; or set SUNFLECK_WITHOUT_CHROMIUM=1")
    options = webdriver.ChromeOptions()
    options.binary_location = browser
    # No sandbox: root has none. No host: whatever a page asks for from elsewhere is an error.
    for word in ("headless=new", "no-sandbox", "disable-gpu", "disable-dev-shm-usage", "window-size=1280,1024"):
        options.add_argument(f"--{word}")
    options.add_argument("--host-resolver-rules=MAP * ~NOTFOUND")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    made = webdriver.Chrome(options, webdriver.ChromeService(driver))
    yield made
    made.quit()


def page_errors(chromium: webdriver.Chrome) -> list[str]:
    entries = chromium.get_log("browser")  # type: ignore[no-untyped-call]
    return [entry["message"] for entry in entries if entry["level"] in ("SEVERE", "WARNING")]


@pytest.fixture
def open_page(chromium: webdriver.Chrome) -> Iterator[Callable[[Path], webdriver.Chrome]]:
    """Opens an HTML file: every picture must be drawn and no error on the console, then and at the test's end."""

    def opened(path: Path) -> webdriver.Chrome:
        page_errors(chromium)  # what an earlier page left
        chromium.get(path.resolve().as_uri())
        loaded = "return document.readyState === 'complete' && [...document.images].every(i => i.complete);"
        WebDriverWait(chromium, 30).until(lambda browser: browser.execute_script(loaded))
        absent = "return [...document.images].filter(i => i.hasAttribute('src') && !i.naturalWidth).map(i => i.alt);"
        missing, errors = chromium.execute_script(absent), page_errors(chromium)
        assert (missing, errors) == ([], [])
        return chromium

    yield opened
    assert page_errors(chromium) == []
