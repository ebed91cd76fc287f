# SPDX-License-Identifier: GPL-3.0-or-later
"""This version beside another one: `python -m benchmarks.versions FOLDER`, with FOLDER a clone of the other.

Both draw the same scenes of `examples.standard_scenes` in turn, in processes of their own. Printed are the smallest
seconds of the processor (Mesa's driver draws there) for one picture, and the ratio of this version to the other.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

SCENES = "balls", "tree", "tetra", "lattice", "mount"
SIDE, PICTURES = 256, 4


def measure(name, samples):
    """Print the seconds of pictures, as JSON: with the packages of the folder that this runs in."""
    from addon.engine.devices.headless import HeadlessDevice
    from addon.engine.session import Session
    from addon.engine.settings import Settings
    from examples import standard_scenes

    session = Session(HeadlessDevice())
    session.load(getattr(standard_scenes, name)(), Settings(samples=samples, max_depth=5, weight_cutoff=0.0))
    seconds = []
    for _ in range(PICTURES):
        session.start(SIDE, SIDE)
        start = time.process_time()
        while session.step(60.0):
            pass
        seconds.append(time.process_time() - start)
    print(json.dumps(seconds))


def measured(folder, name, samples):
    """The smallest seconds in a process that works in `folder`."""
    command = [sys.executable, __file__, str(folder), "--scene", name, "--samples", str(samples)]
    done = subprocess.run(
        command, cwd=folder, env=os.environ | {"PYTHONPATH": str(folder)}, check=True, capture_output=True, text=True
    )
    return min(json.loads(done.stdout.splitlines()[-1]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--scene", choices=SCENES, help="measure this one in this process")
    parser.add_argument("--samples", type=int, default=1)
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    if options.scene:
        measure(options.scene, options.samples)
        return
    here = Path(__file__).resolve().parents[1]
    print(f"{'scene':<10}{'other':>10}{'this':>10}{'ratio':>8}")
    for name in SCENES:
        turns = [
            (measured(options.folder.resolve(), name, options.samples), measured(here, name, options.samples))
            for _ in range(options.repeat)
        ]
        other, this = (statistics.median(column) for column in zip(*turns, strict=True))
        print(f"{name:<10}{other:>10.3f}{this:>10.3f}{this / other:>8.2f}", flush=True)


if __name__ == "__main__":
    main()
