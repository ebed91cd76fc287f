"""How fast hierarchies are built and refitted, how good they are, and what memory that takes."""

import time
import tracemalloc
import weakref

import numpy as np

from addon.engine import Camera, Geometry, Instances, Material, Scene, Spheres, Triangles
from addon.engine.bvh import Form, build, build_forest, quick_build, refit, sah_cost, sweep_build
from addon.engine.packing import pack
from addon.engine.primitives import BY_KIND

from . import results
from .measuring import Spread, in_turn
from .tables import Table, digits

MOST_SWEPT = 1_000_000
LEAF_SIZE = 8
TEXTURE_SIZE = 16384
#: Meshes, triangles of each.
SMALL = ((10_000, 12), (10_000, 100), (1000, 1000))
NOTES = (
    "Builders take turns. 'cost': by the surface area heuristic, relative to that of the exact sweep over all "
    "primitives where these are few enough for it, else to that of 'build'.",
    "'peak': bytes a primitive that a build takes at the most, its result included and the boxes that it is given "
    "left out; 'kept': of the result.",
    "'spheres that moved': an edit that moves all spheres of a scene, as packed; of it records, boxes and refit.",
)


def add_arguments(parser):
    parser.add_argument("--most", type=float, default=1e6, help="primitives of the largest scenes")
    parser.add_argument("--runs", type=int, default=3)


def run(arguments):
    sizes = [n for n in (10_000, 100_000, 1_000_000, 10_000_000) if n <= arguments.most]
    rows = []
    for scene, cls in SCENES.items():
        for n in sizes:
            rows += measure_builders(scene, cls, n, arguments.runs)
    for n in sizes[1:]:
        rows += measure_moved(n, arguments.runs)
    for meshes, triangles in SMALL:
        rows += measure_small(meshes, triangles, arguments.runs)
    values = {"most": arguments.most, "rows": rows}
    return results.save("trees", values, [table(values)])


def table(values):
    head = (
        "what",
        "primitives",
        "seconds (spread)",
        "primitives a second",
        "cost",
        "peak, bytes",
        "kept, bytes",
        "depth",
    )
    made = Table("Trees: building and refitting in numpy", head)
    for row in values["rows"]:
        seconds = row["seconds"]
        spread = f"{seconds['median']:.3f} ({seconds['least']:.3f} to {seconds['greatest']:.3f})"
        cost = f"{row['cost']:.3f}" if "cost" in row else ""
        rest = (str(round(row[name])) if name in row else "" for name in ("peak", "kept", "depth"))
        made.add(row["what"], row["count"], spread, digits(row["count"] / seconds["median"]), cost, *rest)
    made.notes += NOTES
    return made


def row(what, count, seconds, **more):
    """A row of the table, printed as it comes. `seconds`: a Spread."""
    print(f"{what:34} {count:9} {seconds.median:8.3f} s", flush=True)
    return {"what": what, "count": count, "seconds": seconds.json(), **more}


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
    """By name: the Spread of the seconds of functions that take turns; what the last call of each returned."""
    returned = {}

    def runner(name):
        def seconds():
            start = time.perf_counter()
            returned[name] = functions[name]()
            return time.perf_counter() - start

        return seconds

    seconds, failures = in_turn({name: runner(name) for name in functions}, runs)
    if failures:
        raise RuntimeError(f"not measured: {failures}")
    return seconds, returned


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
    """Rows for the builders and refits of one scene."""
    lo, hi = (corner.astype(np.float32) for corner in scene(n, np.random.default_rng(0)))
    costs = np.array([kind.intersection_cost for kind in BY_KIND], np.float32)
    label = np.full(n, BY_KIND.index(cls), np.int32)
    options = {"leaf_size": LEAF_SIZE, "intersection_cost": costs}
    builders = {
        "build": lambda: build(lo, hi, label, **options),
        "quick build": lambda: quick_build(lo, hi, label, leaf_size=LEAF_SIZE),
    }
    rows, best = [], None
    if n <= MOST_SWEPT:
        seconds, found = timed({"sweep": lambda: sweep_build(lo, hi, label, **options)}, 1)
        best = sah_cost(found["sweep"], intersection_cost=costs)
        rows.append(row(f"{scene.__name__}: exact sweep", n, seconds["sweep"], cost=1.0))
    seconds, found = timed(builders, runs)
    best = best or sah_cost(found["build"], intersection_cost=costs)
    for name, function in builders.items():
        tree = found[name]
        memory = {"peak": peak_bytes(function) / n, "kept": kept_bytes(tree) / n}
        cost = float(sah_cost(tree, intersection_cost=costs) / best)
        rows.append(row(f"{scene.__name__}: {name}", n, seconds[name], cost=cost, depth=int(tree.depth), **memory))
    return rows + measure_refits(scene, found["build"], lo, hi, runs)


def measure_refits(scene, bvh, lo, hi, runs):
    """Rows for refits: of a tree that was not kept, and of its form around spans in its own order."""
    form = Form(bvh)
    span = np.concatenate([-lo[bvh.order].T, hi[bvh.order].T])
    form.around(span)
    seconds, _ = timed({"boxes": lambda: refit(bvh, lo, hi), "a kept form": lambda: form.around(span)}, runs)
    return [row(f"{scene.__name__}: refit of {name}", len(lo), spread) for name, spread in seconds.items()]


def camera():
    return Camera.look_at((0, -5, 0), (0, 0, 0))


def measure_moved(n, runs):
    """Rows for an edit that moves all spheres of a scene: their records, boxes and the nodes around them."""
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
    return [
        row("spheres that moved: whole packing", n, Spread.of(seconds)),
        row("spheres that moved: records, boxes, refit", n, Spread.of(stages)),
    ]


def measure_small(meshes, triangles, runs):
    """Rows for many different meshes, whose trees are built together."""
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
    sizes = {name: n // 20 if name.endswith("(a 20th)") else n for name in functions}
    return [row(f"{meshes} of {triangles}: {name}", sizes[name], spread) for name, spread in seconds.items()]
