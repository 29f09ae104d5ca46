# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Speed and accuracy of fixed-count renders of penumbra and cornell, 256 x 256.

Accuracy is relMSE = mean((x - r)^2 / (r^2 + 0.01)) against the references that peers_reference.py
made; it is printed beside every speed. Where Mitsuba can be imported, it renders the same arrays
in turn with us, and the ratio of each pair of runs is given too: the machine is the same for
both, whatever else it does.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from measure import ROOT, describe_build, describe_machine, state

import sunfleck as sf

try:
    import peers_reference as peer
except ImportError:
    peer = None  # type: ignore[assignment]

SIZE = 256


def relative_mse(x: np.ndarray, r: np.ndarray) -> float:
    return float(np.mean((np.asarray(x, np.float64) - r) ** 2 / (r**2 + 0.01)))


def run(render: Callable[[int], Any], seed: int, truth: np.ndarray) -> tuple[float, float]:
    """Seconds of one render, and its relMSE."""
    start = time.perf_counter()
    image = np.asarray(render(seed))
    seconds = time.perf_counter() - start
    return seconds, relative_mse(image, truth)


def peer_renderer(name: str, spp: int) -> Callable[[int], Any]:
    """Mitsuba at its fastest: independent samples, and its direct-light integrator where that will do."""
    scene = peer.make_scene(getattr(sf.scenes, name)(), SIZE, sampler="independent", fastest=True)
    return lambda seed: peer.mi.render(scene, seed=seed, spp=spp)


def measure(name: str, spp: int, runs: int, with_peer: bool) -> None:
    truth = np.load(ROOT / f"build/reference/{name}_{SIZE}.npy").astype(np.float64)
    scene = getattr(sf.scenes, name)()
    scene.plan()  # builds what is built once

    renderers: list[Callable[[int], Any]] = [
        lambda seed: sf.render(scene, width=SIZE, height=SIZE, spp=spp, seed=seed).color
    ]
    if with_peer:
        renderers.append(peer_renderer(name, spp))
    for render in renderers:
        render(runs)  # warms caches, compiles Mitsuba's kernels
    results = [[run(render, seed, truth) for render in renderers] for seed in range(runs)]

    paths = SIZE * SIZE * spp / 1e6
    print(f"{name}, {spp} spp:")
    for index, who in enumerate(["sunfleck", "mitsuba"][: len(renderers)]):
        seconds = [pair[index][0] for pair in results]
        errors = [pair[index][1] for pair in results]
        print(f"  {who}: {state(seconds)} s; {state([paths / s for s in seconds])} million paths/s")
        print(f"    relMSE {state(errors)}")
    if with_peer:
        print(f"  seconds, mitsuba over sunfleck: {state([b[0] / a[0] for a, b in results])}")
        cost = [(b[0] * b[1]) / (a[0] * a[1]) for a, b in results]
        print(f"  seconds x relMSE, mitsuba over sunfleck: {state(cost)}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=7, help="of each, with different seeds (default 7)")
    args = parser.parse_args()

    with_peer = peer is not None and peer.choose_variant().startswith("llvm")
    print(describe_machine())
    print(describe_build())
    for note in sorted((ROOT / "build/reference").glob("*.txt")):
        print(note.read_text(), end="")
    for name, spp in [("penumbra", 64), ("penumbra", 1024), ("cornell", 64)]:
        measure(name, spp, args.runs if spp < 1024 else max(3, args.runs // 2), with_peer)


if __name__ == "__main__":
    main()
