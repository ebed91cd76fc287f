"""Conic beside POV-Ray and Tachyon: the same scenes, the same pixels, one ray through each, on this machine, in turns.

    python -m benchmarks [--runs 3] [--size 512] [--scenes balls tree ...]

Every run of one program is followed by a run of the others, so that what else the machine does falls on all alike.
Printed are medians of the seconds spent tracing (reading, building and compiling apart, as each program reports it) and
their spread.

Not equal: POV-Ray and Tachyon trace in float64, on as many threads as there are cores; Conic in float32, on the GPU or,
with Mesa's driver, on the same cores. None casts a shadow ray towards a light behind the surface. Tachyon reads the
same file but knows neither Fresnel nor one-sided polygons, and its depth counts differently.
"""

import argparse
import dataclasses
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from addon.engine import Geometry, Session, Settings, Triangles
from addon.engine.devices.headless import HeadlessDevice
from addon.engine.nff_writer import write_nff
from examples import standard_scenes
from tests.render import povray

DEPTH = 5
SCENES = {
    "balls": standard_scenes.balls,
    "tree": standard_scenes.tree,
    "tetra": standard_scenes.tetra,
    "lattice": standard_scenes.lattice,
}


class Conic:
    """The engine on a headless context; one device for all runs, as in a session of Blender."""

    def __init__(self, scene, size):
        self.session = Session(HeadlessDevice())
        self.session.load(scene, Settings(max_depth=DEPTH, weight_cutoff=0.0))
        self.size = size

    def trace(self):
        self.session.start(self.size, self.size)
        before = self.session.statistics()["seconds"]["trace"]
        while self.session.step(60.0):
            pass
        return self.session.statistics()["seconds"]["trace"] - before


class PovRay:
    """The program povray on the scene in its own language, antialiasing and display off."""

    def __init__(self, scene, size, folder):
        self.source = Path(folder, "scene.pov")
        self.source.write_text(povray.scene_text(scene, Settings(max_depth=DEPTH, weight_cutoff=0.0, shadows="TINTED")))
        self.options = [
            f"+W{size}",
            f"+H{size}",
            f"+I{self.source}",
            f"+O{Path(folder, 'povray.ppm')}",
            "+FP",
            "-A",
            "-D",
        ]

    def trace(self):
        done = subprocess.run(["povray", *self.options], capture_output=True, text=True, check=True)
        return _seconds(r"Trace Time:.*\((\d+\.?\d*) seconds\)", done.stderr)


class Tachyon:
    """The program tachyon on the same scene as NFF."""

    def __init__(self, scene, size, folder):
        source = Path(folder, "scene.nff")
        write_nff(scene, source, size, size)
        options = [
            "-res",
            str(size),
            str(size),
            "-format",
            "PPM",
            "-raydepth",
            str(DEPTH),
            "-o",
            str(Path(folder, "tachyon.ppm")),
        ]
        self.command = ["tachyon", str(source), *options]

    def trace(self):
        done = subprocess.run(self.command, capture_output=True, text=True, check=True)
        return _seconds(r"Ray Tracing Time:\s+(\d+\.?\d*)", done.stdout)


def _seconds(pattern, text):
    found = re.search(pattern, text)
    if not found:
        raise RuntimeError(f"no time in what the program printed:\n{text[-2000:]}")
    return float(found.group(1))


def _for_povray(scene):
    """The scene without what POV-Ray does not have: a near plane, triangles with one side."""
    shapes = Geometry(name=scene.shapes.name)
    for _, part in scene.shapes.kinds():
        if isinstance(part, Triangles):
            columns = {column.name: getattr(part, column.name) for column in part.columns}
            part = Triangles(**columns | {"one_sided": 0})
        shapes.add(part)
    return dataclasses.replace(scene, shapes=shapes, camera=dataclasses.replace(scene.camera, clip=(0.0, 1e30)))


def measure(name, size, runs):
    """Print a row for each program: median and spread of the seconds, ratio of the median to Conic's."""
    scene = _for_povray(SCENES[name]())
    with tempfile.TemporaryDirectory() as folder:
        programs = {"Conic": Conic(scene, size)}
        programs["POV-Ray"] = PovRay(scene, size, folder)
        programs["Tachyon"] = Tachyon(scene, size, folder)
        times = {program: [] for program in programs}
        for _ in range(runs):
            for program, runner in programs.items():
                times[program].append(runner.trace())
    conic = statistics.median(times["Conic"])
    for program, seconds in times.items():
        median = statistics.median(seconds)
        spread = f"{min(seconds):.2f} to {max(seconds):.2f}"
        print(f"{name:10} {program:8} {median:8.2f} s  ({spread} s)  {median / conic:6.2f} times Conic's")


def main():
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__.split("\n", 1)[0])
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    arguments = parser.parse_args()
    missing = [program for program in ("povray", "tachyon") if shutil.which(program) is None]
    if missing:
        sys.exit(
            f"missing: {', '.join(missing)}; 'make bench' installs them, or apt-get install povray tachyon-bin-nox"
        )
    print(f"{HeadlessDevice().name}, {arguments.size} x {arguments.size}, depth {DEPTH}, {arguments.runs} runs")
    for name in arguments.scenes:
        measure(name, arguments.size, arguments.runs)


if __name__ == "__main__":
    main()
