"""How fast hierarchies are built and refitted, how good they are, and what memory that takes.

    python -m benchmarks.bvh_build [--most 1000000] [--runs 5]

Printed are medians of seconds and their spread, from the least to the greatest. The builders take turns, so that what
else the machine does falls on all alike. `cost`: by the surface area heuristic, relative to that of the exact sweep
over all primitives, where these are few enough for it. `peak`: bytes per primitive that a build takes at the most, its
result included and the boxes that it is given left out; `kept`: of the result.
"""

import argparse
import statistics
import time
import tracemalloc
import weakref

import numpy as np

from addon.engine import Camera, Geometry, Instances, Material, Scene, Spheres, Triangles
from addon.engine.bvh import Form, build, build_forest, quick_build, refit, sah_cost, sweep_build
from addon.engine.packing import pack
from addon.engine.primitives import BY_KIND

MOST_SWEPT = 100_000
LEAF_SIZE = 8
TEXTURE_SIZE = 16384
#: Meshes, triangles of each.
SMALL = ((10_000, 12), (10_000, 100), (1000, 1000))


def spheres(n, rng):
    """Spheres of like size everywhere."""
    center, radius = rng.random((n, 3)), rng.uniform(0.1, 0.5, (n, 1)) / n ** (1 / 3)
    return center - radius, center + radius


def clusters(n, rng):
    """Spheres in 50 heaps a hundredfold apart in size."""
    heap, size = rng.integers(0, 50, n), 10 ** rng.uniform(-3, -1, (50, 1))
    center = rng.random((50, 3))[heap] + rng.normal(size=(n, 3)) * size[heap]
    radius = rng.uniform(0.2, 1, (n, 1)) * size[heap] / (n / 50) ** (1 / 3)
    return center - radius, center + radius


def slivers(n, rng):
    """Long thin triangles in all directions."""
    first = rng.random((n, 3))
    corner = np.stack([first, first + rng.normal(size=(n, 3)) / 10, first + rng.normal(size=(n, 3)) / 500])
    return corner.min(axis=0), corner.max(axis=0)


SCENES = {spheres: Spheres, clusters: Spheres, slivers: Triangles}


def timed(functions, runs):
    """By name: the seconds of each run of each function, which take turns; what the last one returned."""
    seconds, results = {name: [] for name in functions}, {}
    for _ in range(runs):
        for name, function in functions.items():
            start = time.perf_counter()
            results[name] = function()
            seconds[name].append(time.perf_counter() - start)
    return seconds, results


def row(what, n, seconds, rest=""):
    """Print a line of the table."""
    median = statistics.median(seconds)
    spread = f"{min(seconds):.3f}-{max(seconds):.3f}"
    print(f"{what:34} {n:9} {median:8.3f} {spread:>14} {n / median:11.0f}  {rest}", flush=True)


def peak_bytes(function):
    """What a call allocates at the most at a time."""
    tracemalloc.start()
    try:
        function()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def kept_bytes(bvh):
    return sum(array.nbytes for array in (bvh.boxes, bvh.child, bvh.count, bvh.label, bvh.order))


def measure_builders(scene, cls, n, runs):
    """Lines for the builders and refits of one scene."""
    lo, hi = (corner.astype(np.float32) for corner in scene(n, np.random.default_rng(0)))
    costs = np.array([kind.intersection_cost for kind in BY_KIND], np.float32)
    label = np.full(n, BY_KIND.index(cls), np.int32)
    options = {"leaf_size": LEAF_SIZE, "intersection_cost": costs}
    builders = {
        "build": lambda: build(lo, hi, label, **options),
        "quick build": lambda: quick_build(lo, hi, label, leaf_size=LEAF_SIZE),
    }
    best = None
    if n <= MOST_SWEPT:
        seconds, found = timed({"sweep": lambda: sweep_build(lo, hi, label, **options)}, 1)
        best = sah_cost(found["sweep"], intersection_cost=costs)
        row(f"{scene.__name__}: exact sweep", n, seconds["sweep"], f"cost 1 ({best:.1f})")
    seconds, found = timed(builders, runs)
    for name, function in builders.items():
        cost = sah_cost(found[name], intersection_cost=costs)
        share = (
            f"cost {cost / best:.3f}" if best else f"cost {cost / sah_cost(found['build'], 1.0, costs):.3f} of build"
        )
        memory = f"peak {peak_bytes(function) / n:.0f}, kept {kept_bytes(found[name]) / n:.0f}"
        row(f"{scene.__name__}: {name}", n, seconds[name], f"{share}, {memory}, depth {found[name].depth}")
    measure_refits(scene, found["build"], lo, hi, runs)


def measure_refits(scene, bvh, lo, hi, runs):
    """Lines for refits: of a tree that was not kept, and of its form around spans in its own order."""
    form = Form(bvh)
    span = np.concatenate([-lo[bvh.order].T, hi[bvh.order].T])
    form.around(span)
    seconds, _ = timed({"refit": lambda: refit(bvh, lo, hi), "form": lambda: form.around(span)}, runs)
    row(f"{scene.__name__}: refit of boxes", len(lo), seconds["refit"])
    row(f"{scene.__name__}: refit of a kept form", len(lo), seconds["form"])


def camera():
    return Camera.look_at((0, -5, 0), (0, 0, 0))


def measure_moved(n, runs):
    """A line for an edit that moves all spheres of a scene: their records, boxes and the nodes around them."""
    rng = np.random.default_rng(0)
    center, radius = rng.random((n, 3), np.float32), np.full(n, 0.3 * n ** (-1 / 3), np.float32)
    before, seconds, stages = None, [], []
    shapes = []
    for _ in range(runs + 1):
        shapes.append(Geometry(Spheres(center=center, radius=radius), name="world"))
        if before:
            shapes[-1].replaces = weakref.ref(shapes[-2])
        scene = Scene(camera=camera(), materials=[Material()], shapes=shapes[-1])
        start = time.perf_counter()
        packed = pack(scene, TEXTURE_SIZE, before, keep=True)
        if before:
            seconds.append(time.perf_counter() - start)
            stages.append(packed.statistics["build"]["refit"])
        before = packed.residency
        center = center + rng.normal(0.0, 0.1 * radius[0], center.shape).astype(np.float32)
        del shapes[:-1]
    row("spheres that moved: whole packing", n, seconds)
    row("    of it records, boxes and refit", n, stages)


def measure_small(meshes, triangles, runs):
    """Lines for many different meshes, whose trees are built together."""
    rng = np.random.default_rng(0)
    first = rng.random((meshes, triangles, 3))
    corner = np.stack([first, *(first + rng.normal(size=(2, *first.shape)) / triangles**0.5)])
    lo, hi = (c.reshape(-1, 3).astype(np.float32) for c in (corner.min(axis=0), corner.max(axis=0)))
    counts, n = np.full(meshes, triangles), meshes * triangles
    lots = max((1 << 15) // triangles, 1)

    def forests():
        for start in range(0, meshes, lots):
            rows = slice(start * triangles, (start + lots) * triangles)
            build_forest(lo[rows], hi[rows], None, counts[start : start + lots], leaf_size=LEAF_SIZE)

    def one_by_one():
        for start in range(0, n // 20, triangles):
            build(lo[start : start + triangles], hi[start : start + triangles], leaf_size=LEAF_SIZE)

    geometries = [Geometry(Triangles(p0=a, p1=b, p2=c)) for a, b, c in np.moveaxis(corner, 0, 1)]
    scene = Scene(camera=camera(), materials=[Material()])
    scene.instances = [Instances(geometry, np.eye(4)) for geometry in geometries]
    functions = {
        "their trees together": forests,
        "one by one (a 20th)": one_by_one,
        "whole packing": lambda: pack(scene, TEXTURE_SIZE),
    }
    seconds, _ = timed(functions, runs)
    for name in functions:
        share = 20 if name.endswith("(a 20th)") else 1
        row(
            f"{meshes} of {triangles}: {name}",
            n // share,
            seconds[name],
            f"{statistics.median(seconds[name]) * share:.1f} s in all",
        )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--most", type=float, default=1e6, help="primitives of the largest scenes")
    parser.add_argument("--runs", type=int, default=5)
    options = parser.parse_args()
    sizes = [n for n in (10_000, MOST_SWEPT, 1_000_000, 10_000_000) if n <= options.most]
    print(f"{'':34} {'n':>9} {'seconds':>8} {'spread':>14} {'a second':>11}")
    for scene, cls in SCENES.items():
        for n in sizes:
            measure_builders(scene, cls, n, options.runs)
    for n in sizes[1:]:
        measure_moved(n, options.runs)
    for meshes, triangles in SMALL:
        measure_small(meshes, triangles, options.runs)


if __name__ == "__main__":
    main()
