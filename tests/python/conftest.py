# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""What the tests of several modules start from."""

import signal

import pytest

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
