# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Where the renderer's time goes, stage by stage, on every built-in scene: nanoseconds of a thread by the path.

    render_stage_times.py [--spp N] [--runs N]

"rays" is the floor: the three kinds of rays at the rates that Embree has on that scene, with the packing
of packets of 16. What a render takes beyond it is ours. Medians over runs, with the least and the
greatest of the whole; the profile itself costs up to 1 %.
"""

from __future__ import annotations

import argparse
from statistics import median

from measure import describe_machine

import sunfleck as sf

RAYS = ("camera rays", "shadow rays", "surface rays")


def measure(scene: sf.Scene, spp: int, runs: int) -> list[dict[str, float]]:
    """By run: nanoseconds of a thread by the path, of every kind of work, and of the whole."""
    found = []
    for seed in range(runs + 1):
        summary = sf.render(scene, 256, 256, spp=spp, seed=seed, profile=True).summary()
        scale = 1e9 / summary.traced_samples
        whole = summary.threads * summary.seconds
        rest = {"decisions, waiting": whole - sum(summary.work.values()), "whole": whole}
        found.append({name: scale * seconds for name, seconds in (summary.work | rest).items()})
    return found[1:]  # the first has cold caches


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--runs", type=int, default=9)
    given = parser.parse_args()
    print(describe_machine())
    scenes = {name: getattr(sf.scenes, name)() for name in ("penumbra", "defocus", "keyhole", "cornell")}
    found = {name: measure(scene, given.spp, given.runs) for name, scene in scenes.items()}
    rows = list(dict.fromkeys(row for runs in found.values() for row in runs[0]))
    print("| |" + "|".join(scenes) + "|\n|---" + "|---" * len(scenes) + "|")
    for row in rows:
        cells = []
        for runs in found.values():
            values = [run.get(row, 0.0) for run in runs]
            spread = f" ({min(values):.1f}–{max(values):.1f})" if row == "whole" else ""
            cells.append(f"{median(values):.1f}{spread}" if any(values) else "–")
        print(f"|{row}|" + "|".join(cells) + "|")
    shares = [median(sum(run.get(r, 0.0) for r in RAYS) / run["whole"] for run in runs) for runs in found.values()]
    print("|rays, of the whole|" + "|".join(f"{100 * share:.0f} %" for share in shares) + "|")


if __name__ == "__main__":
    main()
