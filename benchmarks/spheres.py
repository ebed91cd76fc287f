"""Many spheres through the engine, by stage: `python -m benchmarks.spheres [--counts 1e5 1e6 1e7] [--size 512]`.

Random spheres in a box, given as float32 columns, are packed, uploaded and drawn once on a headless context. Printed
are the seconds of each stage (bounds, tree and records are the parts of building), the seconds until the first picture,
the peak of the process's memory above what it was with the spheres made, and the bytes of GPU memory a sphere. Each
count has a process of its own, so that a peak is its own. With a software driver GPU memory is the process's too.
"""

import argparse
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np

from addon.engine import Camera, Light, Material, Scene, Session, Settings
from addon.engine.devices.headless import HeadlessDevice

COLUMNS = ("bounds", "tree", "records", "upload", "compile", "trace", "first_picture")


def spheres_in_a_box(count, seed=0):
    """A scene of `count` spheres of like size, a tenth of the box by volume."""
    rng = np.random.default_rng(seed)
    center = rng.random((count, 3), np.float32) * np.float32(2.0) - np.float32(1.0)
    radius = rng.uniform(0.2, 0.7, count).astype(np.float32) * np.float32(count ** (-1 / 3))
    scene = Scene(camera=Camera.look_at((2.2, -3.1, 1.7), (0.0, 0.0, 0.0)))
    scene.add_spheres(center, radius, scene.add_material(Material((0.7, 0.5, 0.3))))
    scene.add_light(Light.sun((0.5, -1.0, 2.0), 3.0))
    return scene


class Memory:
    """Resident memory of this process, bytes, and its peak while it is watched."""

    def __init__(self):
        self.start = self.peak = self._now()
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._watch)

    @staticmethod
    def _now():
        lines = Path("/proc/self/status").read_text().splitlines()
        return next(int(line.split()[1]) for line in lines if line.startswith("VmRSS")) * 1024

    def _watch(self):
        while not self._end.wait(0.01):
            self.peak = max(self.peak, self._now())

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._end.set()
        self._thread.join()


def measure(count, size):
    """Print one line."""
    session = Session(HeadlessDevice())
    scene = spheres_in_a_box(count)
    with Memory() as memory:
        session.load(scene, Settings(max_depth=2))
        session.start(size, size)
        while session.step(60.0):
            pass
    statistics = session.statistics()
    seconds = statistics["build"] | statistics["seconds"]
    row = "".join(f"{seconds[name]:9.2f}" for name in COLUMNS)
    used = (memory.peak - memory.start) / 2**20
    print(f"{count:9}{row}{used:9.0f}{sum(statistics['textures'].values()) / count:9.1f}", flush=True)


def main():
    parser = argparse.ArgumentParser(prog="python -m benchmarks.spheres", description=__doc__.split("\n", 1)[0])
    parser.add_argument("--counts", nargs="+", type=float, default=[1e5, 1e6, 1e7])
    parser.add_argument("--size", type=int, default=512)
    arguments = parser.parse_args()
    if len(arguments.counts) == 1:
        measure(int(arguments.counts[0]), arguments.size)
        return
    print(HeadlessDevice().name)
    print(f"{'spheres':>9}{''.join(f'{name[:8]:>9}' for name in COLUMNS)}{'MiB':>9}{'B/sphere':>9}", flush=True)
    for count in arguments.counts:
        command = [sys.executable, "-m", "benchmarks.spheres", "--counts", str(count), "--size", str(arguments.size)]
        subprocess.run(command, check=True)


if __name__ == "__main__":
    main()
