"""Blender's default scene by Conic: seconds of a process' first render call, the driver's cache empty and filled."""

import importlib.util
import json
import os
import subprocess
import sys
import tempfile
import time

from . import results
from .measuring import Spread
from .tables import Table, digits


def add_arguments(parser):
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--size", type=int, nargs=2, default=(960, 540))
    parser.add_argument("--measure", action="store_true", help="measure one in this process")


def run(arguments):
    if importlib.util.find_spec("bpy") is None:
        print("The first picture is not measured: this Python has no bpy")
        return None
    if arguments.measure:
        return _measure(arguments.size)
    seconds = {"cold": [], "warm": []}
    for _ in range(arguments.runs):
        with tempfile.TemporaryDirectory() as cache:
            for taken in seconds.values():
                taken.append(_in_process(arguments.size, cache))
    spreads = {
        state: {stage: Spread.of([s[stage] for s in taken]).json() for stage in ("first", "second")}
        for state, taken in seconds.items()
    }
    values = {"size": list(arguments.size), "seconds": spreads}
    return results.save("first_picture", values, [table(values)])


def _in_process(size, cache):
    command = [sys.executable, "-m", "benchmarks", "first-picture", "--measure", "--size", *map(str, size)]
    done = subprocess.run(command, env=os.environ | {"MESA_SHADER_CACHE_DIR": cache}, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(done.stderr[-1000:])
    return json.loads(next(line for line in done.stdout.splitlines() if line.startswith("{")))


def _measure(size):
    """Print the seconds of the first and the second render call, as JSON."""
    import bpy

    from examples.in_blender import register_conic

    bpy.ops.wm.read_homefile(use_factory_startup=True)
    register_conic()
    scene = bpy.context.scene
    scene.render.engine, scene.conic.samples = "CONIC", 1
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    seconds = {}
    for call in ("first", "second"):
        started = time.perf_counter()
        bpy.ops.render.render()
        seconds[call] = time.perf_counter() - started
    print("\n" + json.dumps(seconds), flush=True)


def table(values):
    width, height = values["size"]
    made = Table(
        f"Blender's default scene, {width} x {height}, one sample: seconds of the render call",
        ("cache", "first", "second"),
    )
    for state, stages in values["seconds"].items():
        made.add(state, *(_spread(stages[call]) for call in ("first", "second")))
    made.notes.append("cold: the cache of Mesa's driver is empty. Each first call is that of a new process.")
    return made


def _spread(s):
    return f"{digits(s['median'])} ({digits(s['least'])} to {digits(s['greatest'])})"
