# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered viewport of Conic, Cycles and EEVEE side by side: `python -m benchmarks.viewport`.

    python -m benchmarks.viewport [--scenes points_1e3 ...] [--engines CONIC CYCLES BLENDER_EEVEE] [--rounds 3]
                                  [--size 640 480] [--samples 4] [--backend opengl] [--json FILE] [--keep FOLDER]

It takes the application as tools/run_app_tests does, from CONIC_BLENDER or the PATH, with the window on the screen of
DISPLAY or, where there is none, on a virtual one (Xvfb). Leave the mouse alone while it runs: it must stay in the view.
The same file is looked at from the same place by each engine in turn, in one process a scene: opened, switched from
Solid to Rendered, turned by steps of 15 degrees, one ball moved, and that undone. All that the window shows is read
back from the window itself. Printed are the medians of seconds from the action to

    first   something of the new picture: nearer to it than to the one before, and not blank
    seen    the new picture recognisably: means of 8 x 8 pixels correlate by more than 0.9 with the last picture's
    sharp   every pixel: its differences to its neighbours correlate with the last picture's by more than 0.4
    done    all samples

with the least and the most, and the medians divided by Conic's. "-": it took more than two minutes, and the engine was
left out from there on. The first round, which compiles shaders or loads them from the driver's cache, is "cold".

Not equal: Cycles traces paths on the processor with four diffuse bounces, denoising and adaptive sampling off; EEVEE
rasterises, without ray tracing, and shows a point cloud's spheres as a few triangles each; Conic traces exact spheres,
lit by lamps and the world directly. The ball is an exact sphere for Conic and its stand-in mesh for the others. With a
software rasteriser Conic and EEVEE share the processor with the window; Cycles uses it with all threads either way.
"""

import argparse
import json
import os
import shlex
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ENGINES = ["CONIC", "CYCLES", "BLENDER_EEVEE"]
SCENES = ["points_1e3", "points_1e5", "points_1e6", "objects_1e3", "objects_1e4", "instances_1e5"]
ACTIONS = ["open", "switch", "orbit", "move", "undo"]
MILESTONES = ["first", "seen", "sharp", "done"]


def parser():
    parser = argparse.ArgumentParser(prog="python -m benchmarks.viewport", description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=SCENES[:3])
    parser.add_argument("--engines", nargs="+", choices=ENGINES, default=ENGINES)
    parser.add_argument("--rounds", type=int, default=3, help="besides the first, cold one")
    parser.add_argument("--size", nargs=2, type=int, default=(640, 480))
    parser.add_argument("--samples", type=int, default=4)
    parser.add_argument("--backend", choices=("opengl", "vulkan"), default="opengl")
    parser.add_argument("--json", type=Path, help="write all measurements there")
    parser.add_argument("--keep", type=Path, help="work in this folder, and leave the files")
    parser.add_argument("--virtual", action="store_true", help="a virtual screen even where DISPLAY is set")
    return parser


def in_application(options, folder):
    """Have the application measure; the lines that its windows wrote."""
    found = subprocess.run(["tools/run_app_tests", "--find"], cwd=ROOT, capture_output=True, text=True, check=True)
    command = [*shlex.split(found.stdout), "-b", "--factory-startup", "--gpu-backend", options.backend]
    command += ["--python-exit-code", "1", "--python", "benchmarks/viewport_windows.py", "--", str(folder)]
    settings = {key: value for key, value in vars(options).items() if key not in ("json", "keep")}
    subprocess.run([*command, json.dumps(settings)], cwd=ROOT, check=True, stdin=subprocess.DEVNULL)
    return [json.loads(line) for scene in options.scenes for line in (folder / f"{scene}.jsonl").open()]


def column(lines, milestone, **wanted):
    """The seconds to a milestone in the lines that are as wanted."""
    return [line[milestone] for line in lines if all(line[key] == value for key, value in wanted.items())]


def print_tables(lines, options):
    warm = [line for line in lines if line["round"] > 0]
    print(
        f"\n{'scene':12}{'action':8}{'engine':15}"
        + "".join(f"{name:>21}" for name in MILESTONES)
        + f"{'cold seen':>11}"
    )
    for scene in options.scenes:
        for action in ACTIONS:
            medians = {}
            for engine in options.engines:
                key = {"scene": scene, "action": action, "engine": engine}
                columns = {name: column(warm, name, **key) for name in MILESTONES}
                cold = column(lines, "seen", **key, round=0)[:1]
                medians[engine] = {name: statistics.median(values) for name, values in columns.items() if values}
                cells = "".join(f"{_cell(values):>21}" for values in columns.values())
                print(f"{scene:12}{action:8}{engine:15}{cells}{_cell(cold).split(' ')[0]:>11}")
            for engine, of_engine in medians.items():
                if engine != "CONIC" and of_engine and medians.get("CONIC"):
                    ratios = {name: of_engine[name] / medians["CONIC"][name] for name in of_engine}
                    cells = "".join(f"{f'{ratio:.2f}':>21}" for ratio in ratios.values())
                    print(f"{scene:12}{action:8}{engine[:9] + '/CONIC':15}{cells}")


def _cell(values):
    """A median with the least and the most: 0.12 (0.10-0.20)."""
    return f"{statistics.median(values):.2f} ({min(values):.2f}-{max(values):.2f})" if values else "-"


def main():
    options = parser().parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = (options.keep or Path(temporary)).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        load = os.getloadavg()[0]
        lines = in_application(options, folder)
    width, height = options.size
    print(
        f"{options.backend}, {width} x {height}, {options.samples} samples, {options.rounds} rounds;"
        f" {os.cpu_count()} cores, load before: {load:.1f}"
    )
    print_tables(lines, options)
    if options.json:
        options.json.write_text(
            json.dumps({"options": vars(options) | {"json": None, "keep": None}, "lines": lines}, indent=1)
        )


if __name__ == "__main__":
    sys.exit(main())
