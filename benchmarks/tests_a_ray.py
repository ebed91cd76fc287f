"""Nodes and primitives that a ray tests, beside what the surface area heuristic expects: counted by numpy.

Rays are uniform lines through the box of the scene, for which the heuristic holds, and they meet everything on their
way: the heuristic knows of no nearest hit.
"""

import numpy as np

from addon.engine.bvh import build, sah_cost, sweep_build

from . import results, scenes
from .tables import Table

SCENES = ("balls", "lattice", "tree", "tetra", "crystal", "box:20000")
SWEEP_MOST = 25_000  # primitives; the exact sweep is slow


def add_arguments(parser):
    parser.add_argument("--rays", type=int, default=2000)
    parser.add_argument("--scenes", nargs="+", default=list(SCENES), help="FAMILY or FAMILY:SIZE")


def run(arguments):
    values = {"rays": arguments.rays, "scenes": {name: measure(name, arguments.rays) for name in arguments.scenes}}
    return results.save("tests-a-ray", values, [table(values)])


def measure(name, rays):
    """Means of nodes and primitives tested, and the costs, of one scene."""
    boxes = [part.bounds() for _, part in scenes.make(name).shapes.kinds()]
    lo, hi = (np.concatenate([b[side] for b in boxes]) for side in (0, 1))
    bvh = build(lo, hi)
    nodes, primitives = tested(bvh, *lines_through(bvh.bounds.astype(np.float64), rays, np.random.default_rng(0)))
    swept = sah_cost(sweep_build(lo, hi)) if len(lo) <= SWEEP_MOST else None
    return {"count": len(lo), "nodes": nodes, "primitives": primitives, "sah": sah_cost(bvh), "sweep": swept}


def lines_through(bounds, count, random):
    """Points (count, 3) and unit directions (count, 3) of lines, uniform among those that meet the box (2, 3)."""
    low, high = bounds
    middle, radius = (low + high) / 2.0, np.linalg.norm(high - low) / 2.0
    found = []
    while sum(len(point) for point, _ in found) < count:
        direction = random.normal(size=(4 * count, 3))
        direction /= np.linalg.norm(direction, axis=-1, keepdims=True)
        offset = random.normal(size=direction.shape)
        offset -= np.sum(offset * direction, axis=-1, keepdims=True) * direction
        offset *= radius * np.sqrt(random.random((len(offset), 1))) / np.linalg.norm(offset, axis=-1, keepdims=True)
        meets = _meets(low[None], high[None], middle + offset, direction)
        found.append(((middle + offset)[meets], direction[meets]))
    return tuple(np.concatenate(columns)[:count] for columns in zip(*found, strict=True))


def tested(bvh, point, direction):
    """Means of the nodes visited and of the primitives tested by lines through the box of the hierarchy."""
    line, node = np.arange(len(point)), np.zeros(len(point), np.int64)
    nodes = primitives = 0
    while len(line):
        nodes += len(line)
        boxes = bvh.boxes[node].astype(np.float64)
        following = []
        for side in range(2):
            low, high = boxes[:, side, 0], boxes[:, side, 1]
            meets = _meets(low, high, point[line], direction[line])
            primitives += int(bvh.count[node[meets], side].sum())
            inner = meets & bvh.is_inner[node, side]
            following.append((line[inner], bvh.child[node[inner], side]))
        line, node = (np.concatenate(columns) for columns in zip(*following, strict=True))
    return nodes / len(point), primitives / len(point)


def _meets(low, high, point, direction):
    """Whether each line meets its box, (n,) bool."""
    with np.errstate(divide="ignore", invalid="ignore"):
        first, second = (low - point) / direction, (high - point) / direction
    return np.minimum(first, second).max(axis=-1) <= np.maximum(first, second).min(axis=-1)


def table(values):
    head = (
        "scene",
        "primitives",
        "nodes a line",
        "primitives a line",
        "cost of these",
        "SAH cost",
        "SAH / exact sweep",
    )
    made = Table(f"Tests of {values['rays']} lines, all that they meet", head)
    for name, row in values["scenes"].items():
        cost = row["nodes"] + 0.5 * row["primitives"]
        ratio = f"{row['sah'] / row['sweep']:.3f}" if row["sweep"] else "-"
        cells = (row["nodes"], row["primitives"], cost, row["sah"])
        made.add(name, row["count"], *(f"{cell:.1f}" for cell in cells), ratio)
    made.notes.append("A node costs 1, a primitive a half; shapes are told by their boxes alone.")
    return made
