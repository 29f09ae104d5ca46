# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Whatever runs long under Ctrl-C, forks while threads draw, and sub-interpreters."""

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
from sunfleck import _core

SEED = 12345


def ran(code: str, seconds: float = 120) -> str:
    """What a process of its own prints."""
    command = [sys.executable, "-W", "ignore", "-c", textwrap.dedent(code)]
    return subprocess.run(command, capture_output=True, text=True, check=True, timeout=seconds).stdout


def repeat(work: Callable[[], object]) -> NoReturn:
    while True:
        work()


def seconds_to_answer(work: Callable[[], object], clock: Callable[[], float] = time.perf_counter) -> float:
    """From a signal to the KeyboardInterrupt that it raises in work that would go on for much longer."""
    sent = [0.0]

    def raise_it(*_: object) -> None:
        raise KeyboardInterrupt

    def send() -> None:
        sent[0] = clock()
        os.kill(os.getpid(), signal.SIGUSR1)

    before = signal.signal(signal.SIGUSR1, raise_it)
    timer = threading.Timer(0.3, send)
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            repeat(work)
        return clock() - sent[0]
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


# Of one thread, by its process's own clock, which does not run while a busy machine does something else: what is
# promised, and not ten times as much.
def answers(work: Callable[[], object], limit: float = 0.2) -> bool:
    return seconds_to_answer(work, time.process_time) < limit


def takes(pattern: str, scramble: str) -> bool:
    try:
        sf.points(pattern, 1, 2, scramble=scramble)
    except ValueError:
        return False
    return True


SETS = [(pattern, scramble) for pattern in sf.PATTERNS for scramble in sf.SCRAMBLES if takes(pattern, scramble)]
WIDE = {
    "uniform": 16,
    "sobol": 21201,
    "halton": 6542,
    "hammersley": 6543,
    "lattice": 4391,
    "orthogonal": 4097,
}


@pytest.mark.parametrize(("pattern", "scramble"), [(p, s) for p, s in SETS if p != "sz"])  # it has four dimensions
def test_wide_points_answer(pattern: str, scramble: str) -> None:
    d = 16 if pattern == "jittered" else WIDE.get(pattern, 65536)
    n = 1 << 16 if d == 16 else 4096**2 if pattern == "orthogonal" else 4096
    out = np.empty((min(n, (1 << 28) // d), d), np.float32)
    total = n if pattern in ("uniform", "jittered", "orthogonal") else None
    # Memory that is touched first may take ten times as long as the piece before it.
    assert answers(lambda: sf.points(pattern, len(out), d, scramble=scramble, total=total, threads=1, out=out), 0.5)


def test_long_mappings_answer() -> None:
    u = np.full((1 << 24, 2), 0.25)
    out = np.empty((1 << 24, 3))
    corners = [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]
    mapping = sf.mapping.spherical_triangle
    assert answers(lambda: mapping.sample(u, *corners, out=out))
    wide = np.empty((1 << 24, 3), np.float32)
    wide[:] = [0.0, 0.6, 0.8]
    assert answers(lambda: sf.mapping.ggx_masking_shadowing(wide, wide, 0.5, 0.5))


def test_mappings_in_pieces_refuse_by_the_place_and_change_no_bit() -> None:
    n = 300_001
    u = sf.points("random", n, 2, seed=SEED, dtype="float64")
    angle = np.linspace(0.1, 3.0, n)
    cone = sf.mapping.cone
    parts = [cone.sample(u[k : k + 1000], angle[k : k + 1000]) for k in range(0, n, 1000)]
    assert np.array_equal(cone.sample(u, angle), np.concatenate(parts))
    u[250_003, 1] = 1.0
    with pytest.raises(ValueError, match=r"u\[250003\]\[1\] is 1"):
        cone.sample(u, angle)
    with pytest.raises(ValueError, match="value 500007 of u is 1"):
        sf.AliasTable([1.0, 2.0]).sample(u.reshape(-1))


def test_long_tables_answer() -> None:
    # Made in C: the package first has NumPy copy the weights, which is one call.
    weights = np.linspace(1.0, 3.0, 1 << 25)
    assert answers(lambda: _core.AliasTable(weights))
    assert answers(lambda: _core.Piecewise(weights.reshape(1 << 12, -1), 1 << 13, 1 << 12))
    table, u = sf.AliasTable(weights[: 1 << 20]), sf.Rng("pcg64dxsm", seed=SEED).random(1 << 25)
    density = sf.PiecewiseConstant1D(weights[: 1 << 20])
    assert answers(lambda: table.sample(u))
    assert answers(lambda: density.sample(u))
    assert table.sample(0.0) == 0


def test_long_moments_answer_and_are_as_they_were() -> None:
    x = np.ones((1 << 25, 3))
    for m, samples in ((sf.Moments(), x.reshape(-1)), (sf.VectorMoments(), x), (sf.ChannelMoments(), x)):
        m.add(x[:4].reshape(-1) if samples.ndim == 1 else x[:4])
        few = m.count
        assert answers(lambda m=m, samples=samples: m.add(samples))  # type: ignore[misc]
        assert m.count % len(samples) == few  # whole additions alone


def test_moments_in_pieces_are_those_of_one_call() -> None:
    # Above the size of a piece. Pairwise by blocks of 256, as one array of a power of two is by halves.
    x = sf.Rng("pcg64dxsm", seed=SEED).random(1 << 22) * 3.0 - 1.0
    whole, parts = sf.Moments(), [sf.Moments() for _ in range(1 << 6)]
    whole.add(x)
    for moments, part in zip(parts, np.split(x, len(parts)), strict=True):
        moments.add(part)
    while len(parts) > 1:
        for moments, other in zip(parts[::2], parts[1::2], strict=True):
            moments.merge(other)
        parts = parts[::2]
    assert (whole.count, whole.mean, whole.variance) == (parts[0].count, parts[0].mean, parts[0].variance)


def test_long_intervals_answer() -> None:
    x = sf.Rng("pcg64dxsm", seed=SEED).random(1 << 24)
    sequence = sf.ConfidenceSequence(0.0, 1.0)
    assert answers(lambda: sf.estimate.betting_interval(x, 0.0, 1.0))
    assert answers(lambda: sequence.add(x))
    assert sequence.count == 0


@pytest.mark.parametrize("kind", sf.uniformity.DISCREPANCIES)
def test_long_discrepancies_answer(kind: str) -> None:
    x = sf.points("sobol", 1 << 16, 24, seed=SEED, dtype="float64")
    assert answers(lambda: sf.uniformity.discrepancy(x, kind, threads=1))


def test_long_measures_of_uniformity_answer() -> None:
    plane = sf.points("random", 1 << 16, 2, seed=SEED, dtype="float64")
    cube = sf.points("random", 1500, 3, seed=SEED, dtype="float64")
    wide = sf.points("random", 1 << 16, 24, seed=SEED, dtype="float64")
    line = sf.points("random", 1 << 24, 1, seed=SEED, dtype="float64")
    net = sf.points("sobol", 1 << 16, 24, seed=SEED, dtype="float64")
    assert answers(lambda: sf.uniformity.star_discrepancy(plane))  # exactly, by a sweep
    assert answers(lambda: sf.uniformity.star_discrepancy(cube))  # exactly, by sweeps
    assert answers(lambda: sf.uniformity.star_discrepancy(wide))  # between bounds
    assert answers(lambda: sf.uniformity.star_discrepancy(line))  # sorts 2^24 points
    assert answers(lambda: sf.uniformity.t_value(net, effort=None, threads=1))
    assert answers(lambda: sf.uniformity.minimum_distance(wide, threads=1))


def test_a_discrepancy_on_several_threads_answers() -> None:
    # 2^44 terms. A busy machine is given ten times what asking takes.
    x = sf.points("sobol", 1 << 20, 16, seed=SEED, dtype="float64")
    assert seconds_to_answer(lambda: sf.uniformity.discrepancy(x, threads=3)) < 0.8


def test_integrals_and_renders_end_with_what_they_know() -> None:
    def stopped(work: Callable[[], object]) -> tuple[float, object]:
        found: list[object] = []

        def run() -> None:
            found.append(work())
            raise KeyboardInterrupt  # the answer spends the signal; this ends the repetition

        return seconds_to_answer(run, time.process_time), found[0]

    seconds, integral = stopped(
        lambda: sf.integrate(lambda x: x[:, 0], 5000, atol=1e-12, max_samples=1 << 40, replicates=200)
    )
    assert isinstance(integral, sf.Integral)
    assert seconds < 0.2
    assert integral.stop_reason == "interrupted"
    scene = sf.scenes.penumbra()
    seconds, image = stopped(lambda: sf.render(scene, 512, 512, spp=1 << 16, threads=1))
    assert isinstance(image, sf.Image)
    assert seconds < 0.2
    assert image.interrupted


def test_loading_answers(tmp_path: "os.PathLike[str]") -> None:
    rows = sf.points("random", 300_000, 3, seed=SEED)
    file = os.path.join(tmp_path, "large.obj")
    with open(file, "w") as stream:
        stream.writelines(f"v {x} {y} {z}\n" for x, y, z in rows)
        stream.writelines(f"f {k} {k + 1} {k + 2}\n" for k in range(1, len(rows) - 2))
    assert answers(lambda: sf.load(file))


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
