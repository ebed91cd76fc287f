"""Seconds to compile Conic's programs, with the driver's cache empty (cold) and filled (warm)."""

import json
import os
import subprocess
import sys
import tempfile

from . import results
from .measuring import Spread
from .tables import Table, digits

SCENES = ("tetra", "balls", "lattice", "mount")
SIDE = 64
_STAGES = ("compile", "first_draw")


def add_arguments(parser):
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--scenes", nargs="+", default=list(SCENES))
    parser.add_argument("--measure", help="measure this scene in this process")


def run(arguments):
    if arguments.measure:
        return _measure(arguments.measure)
    rows = {name: _cold_and_warm(name, arguments.runs) for name in arguments.scenes}
    values = {"scenes": rows}
    return results.save("compile", values, [table(values)])


def _cold_and_warm(name, runs):
    """Spreads of both stages, by cache; each run has an empty cache of its own, and a process for each measurement."""
    seconds = {"cold": [], "warm": []}
    for _ in range(runs):
        with tempfile.TemporaryDirectory() as cache:
            for state in seconds:
                seconds[state].append(_in_process(name, cache))
    return {
        state: {stage: Spread.of([s[stage] for s in taken]).json() for stage in _STAGES}
        for state, taken in seconds.items()
    }


def _in_process(name, cache):
    command = [sys.executable, "-m", "benchmarks", "compile", "--measure", name]
    environment = os.environ | {"MESA_SHADER_CACHE_DIR": cache}
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(done.stderr[-1000:])
    return json.loads(done.stdout.splitlines()[-1])


def _measure(name):
    """Print the seconds of compiling and of the first draw less a second one, as JSON."""
    from . import scenes
    from .peers import Conic

    peer = Conic(scenes.make(name), SIDE, 5)
    first, second = peer.trace(), peer.trace()
    print(json.dumps({"compile": peer.statistics()["seconds"]["compile"], "first_draw": max(first - second, 0.0)}))


def table(values):
    head = ("scene", *(f"{stage.replace('_', ' ')}, {state}" for state in ("cold", "warm") for stage in _STAGES))
    made = Table("Seconds of compiling", head)
    for name, row in values["scenes"].items():
        made.add(name, *(_spread(row[state][stage]) for state in ("cold", "warm") for stage in _STAGES))
    made.notes.append(
        "compile: of the driver's compiler. first draw: what the first draw takes longer than the second."
    )
    made.notes.append("cold: the cache of Mesa's driver is empty; other drivers have caches that this does not empty.")
    return made


def _spread(s):
    return f"{digits(s['median'])} ({digits(s['least'])} to {digits(s['greatest'])})"
