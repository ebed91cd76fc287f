"""How long the viewport takes to see whether anything has changed: `python -m benchmarks.fingerprint [MILLIONS]`.

Seconds for a scene of so many million spheres, the best of five, beside those of a cryptographic hash of the same.
"""

import hashlib
import sys
import time

import numpy as np

from addon.engine import Scene
from addon.fingerprint import fingerprint


def seconds(function):
    times = []
    for _ in range(5):
        started = time.perf_counter()
        function()
        times.append(time.perf_counter() - started)
    return min(times)


if __name__ == "__main__":
    count = int(float(sys.argv[1]) * 1e6) if len(sys.argv) > 1 else 10**7
    rng = np.random.default_rng(0)
    center, radius = rng.random((count, 3), np.float32), rng.random(count, np.float32) + 0.5
    scene = Scene()
    scene.add_spheres(center, radius)
    print(f"{count:,} spheres, {(center.nbytes + radius.nbytes) / 1e6:.0f} MB")
    print(f"fingerprint {seconds(lambda: fingerprint(scene)) * 1e3:8.1f} ms")
    print(f"blake2b     {seconds(lambda: [hashlib.blake2b(a).digest() for a in (center, radius)]) * 1e3:8.1f} ms")
