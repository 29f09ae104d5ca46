# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Long fills under Ctrl-C, forks while threads draw, and sub-interpreters."""

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
import warnings
from collections.abc import Callable
from typing import NoReturn

import numpy as np
import pytest

import sunfleck as sf

SEED = 12345


def ran(code: str, seconds: float = 120) -> str:
    """What a process of its own prints."""
    command = [sys.executable, "-W", "ignore", "-c", textwrap.dedent(code)]
    return subprocess.run(command, capture_output=True, text=True, check=True, timeout=seconds).stdout


def repeat(work: Callable[[], object]) -> NoReturn:
    while True:
        work()


def seconds_to_answer(work: Callable[[], object]) -> float:
    """From a signal to the KeyboardInterrupt that it raises in work that would go on for much longer."""
    sent = [0.0]

    def raise_it(*_: object) -> None:
        raise KeyboardInterrupt

    def send() -> None:
        sent[0] = time.perf_counter()
        os.kill(os.getpid(), signal.SIGUSR1)

    before = signal.signal(signal.SIGUSR1, raise_it)
    timer = threading.Timer(0.3, send)
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            repeat(work)
        return time.perf_counter() - sent[0]
    finally:
        timer.cancel()
        signal.signal(signal.SIGUSR1, before)


# 2^27 values of ran2 and 2^26 of nested Sobol take seconds; a busy machine is given ten times 0.05 s, the time
# between two questions and the longest piece.
def test_a_long_draw_answers_and_leaves_the_generator_as_it_was() -> None:
    rng, out = sf.Rng("ran2", seed=SEED), np.empty(1 << 27)
    assert seconds_to_answer(lambda: rng.random(out=out)) < 0.5
    assert rng.bits(5).tolist() == sf.Rng("ran2", seed=SEED).bits(5).tolist()


@pytest.mark.parametrize("threads", [1, None])
def test_long_fills_of_points_answer(threads: int | None) -> None:
    out = np.empty((1 << 25, 2))

    def fill() -> None:
        sf.points("sobol", 1 << 25, 2, scramble="nested", dtype="float64", threads=threads, out=out)

    assert seconds_to_answer(fill) < 0.8


def test_long_sums_answer_and_are_as_they_were() -> None:
    x, sums = np.ones(1 << 27), sf.RunningSums()
    sums.add([1.0, 2.0])
    assert seconds_to_answer(lambda: sums.add(x)) < 0.5
    assert sums.count % x.size == 2  # whole additions alone


def test_pieces_change_no_bit() -> None:
    # Above and below the size of the first piece, 2^18 values.
    n = 3_000_001
    for name in sf.RNGS:
        whole, rng = sf.Rng(name, seed=SEED).random(n, "float32"), sf.Rng(name, seed=SEED)
        assert np.array_equal(whole, np.concatenate([rng.random(1 << 17, "float32") for _ in range(23)])[:n]), name
    n, step = 1 << 22, 1 << 17
    for pattern in ("sobol", "halton", "lattice", "random"):
        whole = sf.points(pattern, n, 3, seed=SEED)
        parts = [sf.points(pattern, step, 3, seed=SEED, start=k) for k in range(0, n, step)]
        assert np.array_equal(whole, np.concatenate(parts)), pattern
    for pattern, total in (("jittered", 1 << 20), ("uniform", 1 << 20), ("latin", 1 << 20), ("hammersley", 1 << 20)):
        whole = sf.points(pattern, total, 2, seed=SEED)
        parts = [sf.points(pattern, 1 << 16, 2, seed=SEED, start=k, total=total) for k in range(0, total, 1 << 16)]
        assert np.array_equal(whole, np.concatenate(parts)), pattern


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_a_child_forked_while_a_thread_draws_can_draw() -> None:
    rng, stop = sf.Rng("mt19937", seed=SEED), False

    def churn() -> None:
        while not stop:
            rng.random(1_000_000)

    thread = threading.Thread(target=churn)
    thread.start()
    try:
        for _ in range(10):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # newer Pythons warn of threads beside a fork
                child = os.fork()
            if child == 0:
                rng.random()
                os._exit(0)
            deadline = time.monotonic() + 30
            while not (done := os.waitpid(child, os.WNOHANG))[0]:
                if time.monotonic() > deadline:
                    os.kill(child, signal.SIGKILL)
                    os.waitpid(child, 0)
                    pytest.fail("the child hangs")
                time.sleep(0.005)
            assert done[1] == 0
    finally:
        stop = True
        thread.join()


def test_a_sub_interpreter_is_declined() -> None:
    interpreters = "_xxsubinterpreters" if sys.version_info < (3, 13) else "_interpreters"
    said = ran(
        f"""
        import {interpreters} as interpreters, os
        code = 'import sunfleck as sf; sf.Rng("pcg32", 1).random()'
        try:
            failed = interpreters.run_string(interpreters.create(), code)
            print("ran" if failed is None else failed)
        except Exception as error:
            print(error)
        os._exit(0)
        """
    )
    # Which of the two extensions refuses first depends on the version of Python: NumPy's own is the other.
    assert "main interpreter" in said or "subinterpreter" in said, said
