# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""exit: the interpreter ends while daemon threads are in the library."""

import subprocess
import sys

import pytest

SCRIPT = """
import threading, time
import numpy as np, sunfleck as sf

begun = threading.Event()

def observe(progress):
    begun.set()

def integrand(u):
    begun.set()
    return np.sin(u).sum(axis=1)

def render():
    sf.render(sf.scenes.penumbra(), 256, 256, tolerance=1e-6, max_spp=10**6, progress=observe)

def render_unseen():
    scene = sf.scenes.penumbra()
    begun.set()
    sf.render(scene, 256, 256, tolerance=1e-6, max_spp=10**6)

def integrate():
    sf.integrate(integrand, d=5, tolerance=1e-14, max_samples=2**40)

def draw():
    rng = sf.Rng("pcg32", seed=1)
    while True:
        rng.random(100)
        begun.set()

def measure():
    begun.set()
    while True:
        sf.points("sobol", 1024, d=2)
        sf.scenes.penumbra()

for _ in range(2):
    threading.Thread(target=WORK, daemon=True).start()
begun.wait(5)
time.sleep(WAIT)
print("leaving")
"""


@pytest.mark.parametrize("wait", [0, 0.3])
@pytest.mark.parametrize("work", ["render", "render_unseen", "integrate", "draw", "measure"])
def test_daemon_threads_do_not_abort_the_exit(work: str, wait: float) -> None:
    script = SCRIPT.replace("WORK", work).replace("WAIT", str(wait))
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=False)
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "leaving\n", "")


def test_what_runs_at_exit_may_still_compute() -> None:
    script = (
        "import atexit\n"
        "atexit.register(lambda: print(sf.Rng('pcg32', seed=1).bits(3).sum() > 0, "
        "sf.integrate(lambda u: u[:, 0], d=1).samples > 0))\n"
        "import sunfleck as sf"
    )
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=False)
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "True True\n", "")
