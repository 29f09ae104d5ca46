# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Seconds to a stated relMSE, beside Mitsuba, Cycles and LuxCore, 256 x 256, on the same arrays.

    peers_render.py measure SCENE [--peers ...] [--limit S]    adds runs to build/peers/results.json
    peers_render.py start SCENE                                from process start to file written
    peers_render.py report                                     tables of all that is there

A run renders every configuration in turn, at growing sample counts (or falling tolerances), until
its relMSE is below the least target or a render takes longer than --cap; each renderer lives in a
process of its own with its scene built and its kernels warm. The time to a target is interpolated
in the logarithms of time and relMSE between the two renders around it, run by run; what is stated
are medians over runs, and ratios of pairs in the same run.

relMSE is mean((x - r)^2 / (r^2 + 0.01)) against the references that peers_reference.py made; their own
error is part of it.
"""

from __future__ import annotations

import argparse
import dataclasses
import itertools
import json
import os
import subprocess
import sys
import sysconfig
import time
from pathlib import Path
from typing import Any

import numpy as np
from measure import ROOT, describe_machine, state

SIZE = 256
WORK = ROOT / "build/peers"
PAUSE = 0.15  # seconds: threads of the renderer before, which wait for more work awake, go to sleep
RESULTS = WORK / "results.json"
TARGETS = (1e-3, 1e-4, 1e-5, 2.5e-6)
LEAST = {"penumbra": 2.5e-6, "defocus": 1e-5, "cornell": 1e-4}  # the reference of cornell is itself off by 7e-6

SPP = [2**k for k in range(2, 17)]
SQUARES = [4**k for k in range(1, 9)]  # Mitsuba's multijitter wants them
TOLERANCES = [0.1 * 2 ** (-k / 2) for k in range(15)]
GOALS = [8e-3 * 2 ** (-k / 2) for k in range(26)]
LADDERS: dict[str, list[float]] = {
    "sunfleck fixed": SPP,
    "sunfleck adaptive": TOLERANCES,
    "sunfleck goal": GOALS,
    "sunfleck roulette": SPP,
    "mitsuba direct": SQUARES,
    "mitsuba path": SQUARES,
    "mitsuba roulette": SQUARES,
    "mitsuba direct-independent": SQUARES,
    "mitsuba path-independent": SQUARES,
    "cycles fixed": SPP,
    "cycles adaptive": [0.04 * 2**-k for k in range(8)],
    "luxcore fixed": SPP,
}
OPEN = ("sunfleck adaptive", "sunfleck goal")
MODULES = {"mitsuba": "mitsuba", "cycles": "bpy", "luxcore": "pyluxcore"}
DIRECT_ONLY = ("mitsuba direct", "mitsuba direct-independent")
BOUNCES_ONLY = ("sunfleck roulette", "mitsuba roulette")


def relative_mse(x: np.ndarray, r: np.ndarray) -> float:
    return float(np.mean((np.asarray(x, np.float64) - r) ** 2 / (r**2 + 0.01)))


def write_arrays(name: str) -> Path:
    """The built-in scene as an .npz, for environments that do not have this package."""
    import sunfleck as sf

    scene = getattr(sf.scenes, name)()
    camera = {key: np.asarray(value).tolist() for key, value in dataclasses.asdict(scene.camera).items()}
    meshes = [{"albedo": list(map(float, m.albedo)), "emission": list(map(float, m.emission))} for m in scene.meshes]
    description = json.dumps({"meshes": meshes, "camera": camera, "max_bounces": scene.max_bounces})
    arrays = {f"vertices{i}": np.asarray(m.vertices, np.float32) for i, m in enumerate(scene.meshes)}
    arrays |= {f"triangles{i}": np.asarray(m.triangles, np.uint32) for i, m in enumerate(scene.meshes)}
    WORK.mkdir(parents=True, exist_ok=True)
    path = WORK / f"{name}.npz"
    np.savez(path, description=np.array(description), **arrays)
    return path


def command(who: str, scene: Path) -> list[str]:
    python = sys.executable if who == "sunfleck" else str(ROOT / f"build/{who}/bin/python")
    return [python, str(ROOT / "bench/peers_worker.py"), who, str(scene)]


def environment(who: str) -> dict[str, str]:
    """Mitsuba's environment has no NumPy of its own: it takes this one's."""
    return os.environ | ({"PYTHONPATH": sysconfig.get_path("platlib")} if who == "mitsuba" else {})


class Worker:
    """A renderer in a process of its own, its scene built."""

    def __init__(self, who: str, scene: Path) -> None:
        pipe, quiet = subprocess.PIPE, subprocess.DEVNULL
        self.process = subprocess.Popen(
            command(who, scene), cwd=WORK, env=environment(who), stdin=pipe, stdout=pipe, stderr=quiet, text=True
        )
        self.read()

    def read(self) -> str:
        assert self.process.stdout
        for line in self.process.stdout:  # libraries print what they like
            if line.startswith("@"):
                return line[1:]
        raise RuntimeError(f"{self.process.args} ended")

    def render(self, mode: str, value: float, seed: int) -> tuple[float, float, np.ndarray]:
        assert self.process.stdin
        self.process.stdin.write(json.dumps({"mode": mode, "value": value, "seed": seed}) + "\n")
        self.process.stdin.flush()
        answer = json.loads(self.read())
        if answer["file"].endswith(".npy"):
            return answer["seconds"], answer["samples"], np.load(answer["file"])
        import OpenImageIO

        pixels = OpenImageIO.ImageBuf(answer["file"]).get_pixels(OpenImageIO.FLOAT)
        return answer["seconds"], answer["samples"], np.asarray(pixels)[..., :3]

    def close(self) -> None:
        assert self.process.stdin
        self.process.stdin.close()
        self.process.wait()


def load_results() -> list[dict[str, Any]]:
    return json.loads(RESULTS.read_text()) if RESULTS.exists() else []


def add_results(records: list[dict[str, Any]]) -> None:
    fresh = RESULTS.with_suffix(".new")
    fresh.write_text(json.dumps(load_results() + records))
    fresh.replace(RESULTS)


def run_once(scene: str, who: list[str], workers: dict[str, Worker], run: str, args: argparse.Namespace) -> None:
    """All configurations up their ladders, in turn rung by rung, so that they see the same machine."""
    truth = np.load(ROOT / f"build/reference/{scene}_{SIZE}.npy").astype(np.float64)
    seed = int(run.split(".")[1])
    going: dict[str, list[float]] = {n: [v for v in LADDERS[n] if v < 1 or v >= args.least_spp] for n in who}
    records = []
    while going:
        for name in list(going):
            renderer, mode = name.split(" ", 1)
            value = going[name].pop(0)
            time.sleep(PAUSE)
            seconds, samples, picture = workers[renderer].render(mode, value, seed)
            # LuxCore's rows lie one lower: row y is what the others have as row y - 1.
            shifted = renderer == "luxcore"
            error = relative_mse(picture[1:], truth[:-1]) if shifted else relative_mse(picture, truth)
            records.append(
                {"scene": scene, "run": run, "who": name, "value": value, "seconds": seconds, "samples": samples}
                | {"relmse": error}
            )
            growth = 1.5 if name in OPEN else going[name][0] / value if going[name] else 0
            if not going[name] or error < (args.least or LEAST[scene]) or seconds * growth > args.cap:
                del going[name]
    add_results(records)


def measure(args: argparse.Namespace) -> None:
    scene_file = write_arrays(args.scene)
    direct = args.scene != "cornell"
    left_out = BOUNCES_ONLY if direct else DIRECT_ONLY
    who = args.who or [n for n in LADDERS if n.split()[0] in args.peers and n not in left_out]
    begin = time.perf_counter()
    workers = {name: Worker(name, scene_file) for name in {n.split()[0] for n in who}}
    for name in who:  # warms caches, compiles Mitsuba's kernels
        renderer, mode = name.split(" ", 1)
        workers[renderer].render(mode, LADDERS[name][0], 9999)
    stamp, done = f"{time.time():.0f}", 0
    first = len({r["run"] for r in load_results()})
    while done < args.runs and (not done or (time.perf_counter() - begin) * (done + 1) / done < args.limit):
        run_once(args.scene, who, workers, f"{stamp}.{first + done}", args)
        done += 1
    for worker in workers.values():
        worker.close()
    print(f"{args.scene}: {', '.join(who)}: {done} runs; {describe_machine()}")


def start(args: argparse.Namespace) -> None:
    """From process start to an EXR written, 64 samples a pixel; ours by the command line."""
    scene_file = write_arrays(args.scene)
    cli = [str(Path(sys.executable).parent / "sunfleck"), "render", args.scene, "--spp", "64"]
    cli += ["--width", str(SIZE), "--height", str(SIZE), "-o"]
    commands = {"sunfleck": cli}
    commands |= {who: [*command(who, scene_file), "--spp", "64", "-o"] for who in args.peers if who != "sunfleck"}
    stamp, begin, records = f"{time.time():.0f}", time.perf_counter(), []
    for run in range(-1, args.runs):  # the first fills caches and is not kept
        for who, line in commands.items():
            started = time.perf_counter()
            subprocess.run([*line, f"{who}.start.exr"], cwd=WORK, env=environment(who), check=True, capture_output=True)
            seconds = time.perf_counter() - started
            assert (WORK / f"{who}.start.exr").stat().st_size > SIZE * SIZE
            (WORK / f"{who}.start.exr").unlink()
            if run >= 0:
                records.append(
                    {"scene": args.scene, "run": f"{stamp}.{run}", "who": f"{who} start", "seconds": seconds}
                )
        if (time.perf_counter() - begin) * (run + 3) / (run + 2) > args.limit:
            break
    add_results(records)


def time_to(target: float, records: list[dict[str, Any]]) -> float | None:
    """Interpolated on logarithms between the renders around the target, or up to a quarter beyond the last."""
    points = sorted((r["seconds"], r["relmse"]) for r in records)
    for (t0, e0), (t1, e1) in itertools.pairwise(points):
        last = t1 == points[-1][0]
        if e0 >= target >= (e1 / 1.25 if last else e1) and e0 > e1:
            share = np.log(e0 / target) / np.log(e0 / e1)
            return float(np.exp(np.log(t0) + share * np.log(t1 / t0)))
    return None


def by_run(records: list[dict[str, Any]], scene: str, who: str) -> dict[str, list[dict[str, Any]]]:
    found: dict[str, list[dict[str, Any]]] = {}
    for record in records:
        if record["scene"] == scene and record["who"] == who:
            found.setdefault(record["run"], []).append(record)
    return found


def rows(records: list[dict[str, Any]], scene: str) -> dict[str, dict[str, dict[str, float]]]:
    """Per column ("1e-03", …, "paths at 64"), per configuration, a value for each run."""
    table: dict[str, dict[str, dict[str, float]]] = {}
    for who in LADDERS:
        for run, found in by_run(records, scene, who).items():
            for target in TARGETS:
                if (seconds := time_to(target, found)) is not None:
                    table.setdefault(f"seconds to {target:.1e}", {}).setdefault(who, {})[run] = seconds
            for record in found:
                if record["value"] == 64:
                    rate = SIZE * SIZE * record["samples"] / record["seconds"] / 1e6
                    table.setdefault("million paths/s at 64 spp", {}).setdefault(who, {})[run] = rate
                    table.setdefault("relMSE at 64 spp", {}).setdefault(who, {})[run] = record["relmse"]
    for who in ("sunfleck", "mitsuba", "cycles", "luxcore"):
        for run, found in by_run(records, scene, f"{who} start").items():
            table.setdefault("seconds from start to file, 64 spp", {}).setdefault(who, {})[run] = found[0]["seconds"]
    return table


def report(args: argparse.Namespace) -> None:
    records = load_results()
    for scene in ("penumbra", "defocus", "cornell"):
        for column, values in rows(records, scene).items():
            print(f"\n{scene}, {column}:")
            for who, runs in values.items():
                line = f"  {who:28} {state(list(runs.values()))}"
                for ours in ("sunfleck", "sunfleck fixed", "sunfleck adaptive", "sunfleck goal", "sunfleck roulette"):
                    both = [runs[run] / values[ours][run] for run in runs if run in values.get(ours, {})]
                    if both and (not who.startswith("sunfleck") or ours != who in OPEN):
                        line += f"; over {ours} {state(both)}"
                print(line)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=["measure", "start", "report"])
    parser.add_argument("scene", nargs="?", choices=sorted(LEAST))
    installed = [who for who, module in MODULES.items() if [*ROOT.glob(f"build/{who}/lib/*/site-packages/{module}")]]
    parser.add_argument("--peers", nargs="+", default=["sunfleck", *installed], help="default: all that are installed")
    parser.add_argument("--who", action="append", help='a configuration, as "sunfleck fixed"; may be repeated')
    parser.add_argument("--runs", type=int, default=7, help="at the most (default 7)")
    parser.add_argument("--limit", type=float, default=50, help="begin no run that would end after so many seconds")
    parser.add_argument("--cap", type=float, default=15, help="a render that would take longer is left out")
    parser.add_argument("--least", type=float, help="relMSE down to which to go (default by scene)")
    parser.add_argument("--least-spp", type=int, default=4, help="where counts begin (default 4)")
    args = parser.parse_args()
    os.environ.pop("SUNFLECK_ISA", None)
    if args.what == "report":
        report(args)
    elif args.scene is None:
        parser.error(f"{args.what} wants a scene")
    else:
        {"measure": measure, "start": start}[args.what](args)


if __name__ == "__main__":
    main()
