"""How fast hierarchies are built, and how good they are: `python benchmarks/bvh_build.py [largest n]`."""

import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from addon.engine.bvh import build, refit, sah_cost, statistics, sweep_build

SWEEP_N = 20_000


def spheres(n: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Spheres of like size everywhere."""
    centre, radius = rng.random((n, 3)), rng.uniform(0.1, 0.5, (n, 1)) / n ** (1 / 3)
    return centre - radius, centre + radius


def clusters(n: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Spheres in 50 heaps a hundredfold apart in size."""
    heap, size = rng.integers(0, 50, n), 10 ** rng.uniform(-3, -1, (50, 1))
    centre = rng.random((50, 3))[heap] + rng.normal(size=(n, 3)) * size[heap]
    radius = rng.uniform(0.2, 1, (n, 1)) * size[heap] / (n / 50) ** (1 / 3)
    return centre - radius, centre + radius


def slivers(n: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Long thin triangles in all directions."""
    first = rng.random((n, 3))
    corner = np.stack([first, first + rng.normal(size=(n, 3)) / 10, first + rng.normal(size=(n, 3)) / 500])
    return corner.min(axis=0), corner.max(axis=0)


def timed(function, *arguments):
    """The seconds a call takes, the better of two, and its result."""
    seconds = []
    for _ in range(2):
        start = time.perf_counter()
        result = function(*arguments)
        seconds.append(time.perf_counter() - start)
    return min(seconds), result


def measure(scene, n: int) -> None:
    """Print one line."""
    lo, hi = scene(n, np.random.default_rng(0))
    build_s, bvh = timed(build, lo, hi)
    refit_s, _ = timed(refit, bvh, lo, hi)
    stats = statistics(bvh)
    line = f"{scene.__name__:10} {n:9} {build_s:8.3f} {n / build_s:10.0f} {refit_s:8.3f}"
    line += f" {stats['nodes']:8} {stats['depth']:5} {stats['sah_cost']:8.1f}"
    if n == SWEEP_N:
        sweep_s, swept = timed(sweep_build, lo, hi)
        line += f" {stats['sah_cost'] / sah_cost(swept):7.3f} (in {sweep_s:.3f} s)"
    print(line, flush=True)


def main(largest: int) -> None:
    """A line for each scene and size; `against` is the cost relative to the full sweep's."""
    print("scene              n  build s  boxes / s  refit s    nodes depth     cost against")
    for scene in (spheres, clusters, slivers):
        for n in (10_000, SWEEP_N, 100_000, 1_000_000):
            if n <= largest:
                measure(scene, n)


if __name__ == "__main__":
    main(int(float(sys.argv[1])) if len(sys.argv) > 1 else 1_000_000)
