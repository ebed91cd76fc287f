"""Boxes that trees are built of, made from a seed, and what every tree promises."""

import numpy as np
import pytest

from addon.engine.bvh import (
    MAX_DEPTH,
    build,
    quick_build,
    sweep_build,
)
from addon.engine.bvh.tree import FAR, MIXED

BUILDERS = pytest.mark.parametrize("builder", [build, sweep_build, quick_build])
BY_COST = pytest.mark.parametrize("builder", [build, sweep_build])
SEEDS = pytest.mark.parametrize("seed", range(3))


def uniform(n, rng):
    """Spheres of like size everywhere."""
    centre, radius = rng.random((n, 3)), rng.uniform(0.1, 0.5, (n, 1)) / n ** (1 / 3)
    return centre - radius, centre + radius


def clustered(n, rng):
    """Spheres in 30 heaps a hundredfold apart in size."""
    heap, size = rng.integers(0, 30, n), 10 ** rng.uniform(-3, -1, (30, 1))
    centre = rng.random((30, 3))[heap] + rng.normal(size=(n, 3)) * size[heap]
    radius = rng.uniform(0.2, 1, (n, 1)) * size[heap] / (n / 30) ** (1 / 3)
    return centre - radius, centre + radius


def sphereflake(n, rng):
    """Nine spheres on each sphere, a third of its size."""
    centre, radius = [np.zeros((1, 3))], [np.ones((1, 1))]
    while sum(map(len, radius)) < n:
        outward = rng.normal(size=(9 * len(radius[-1]), 3))
        outward /= np.linalg.norm(outward, axis=1, keepdims=True)
        parent = np.repeat(radius[-1], 9, axis=0)
        centre.append(np.repeat(centre[-1], 9, axis=0) + outward * parent * 4 / 3)
        radius.append(parent / 3)
    centre, radius = np.concatenate(centre)[:n], np.concatenate(radius)[:n]
    return centre - radius, centre + radius


def slivers(n, rng):
    """Long thin triangles in all directions."""
    first = rng.random((n, 3))
    corner = np.stack([first, first + rng.normal(size=(n, 3)) / 10, first + rng.normal(size=(n, 3)) / 500])
    return corner.min(axis=0), corner.max(axis=0)


def grid_mesh(n, rng):
    """The triangles of a wavy height field, some of them flat boxes."""
    side = int(np.sqrt(n / 2)) + 1
    x, y = np.meshgrid(np.arange(side + 1.0), np.arange(side + 1.0), indexing="ij")
    z = np.maximum(np.sin(x * rng.uniform(0.05, 0.2)) * 5, 0)
    point = np.stack([x, y, z], axis=-1)
    a, b, c, d = point[:-1, :-1], point[1:, :-1], point[1:, 1:], point[:-1, 1:]
    corner = np.concatenate([np.stack([a, b, c]), np.stack([a, c, d])], axis=1).reshape(3, -1, 3)[:, :n]
    return corner.min(axis=0), corner.max(axis=0)


SCENES = pytest.mark.parametrize("scene", [uniform, clustered, sphereflake, slivers, grid_mesh])


def leaf_ranges(bvh):
    """Of every leaf: node, child, start and stop in `order`."""
    node, child = np.nonzero(bvh.is_leaf)
    start = bvh.leaf_start[node, child]
    return node, child, start, start + bvh.count[node, child]


def check(bvh, lo, hi, label=None, leaf_size=4):
    """Everything that `Bvh` promises about its arrays, short of quality."""
    n = len(lo)
    label = np.zeros(n, int) if label is None else label
    assert bvh.boxes.dtype == np.float32 and bvh.boxes.shape == (len(bvh), 2, 2, 3)
    assert bvh.child.dtype == bvh.order.dtype == np.int64 and bvh.count.dtype == bvh.label.dtype == np.int32

    # Every primitive once, the labels in runs, every place of `order` in one leaf of that label.
    assert np.array_equal(np.sort(bvh.order), np.arange(n))
    assert np.all(np.diff(label[bvh.order]) >= 0)
    assert np.array_equal(np.diff(bvh.run), np.bincount(label))
    node, child, start, stop = leaf_ranges(bvh)
    by_start = np.argsort(start)
    assert np.array_equal(start[by_start], np.concatenate([[0], stop[by_start][:-1]])) and stop.max() == n
    assert np.all(stop - start <= leaf_size)
    leaf_of = np.repeat(by_start, (stop - start)[by_start])
    assert np.array_equal(label[bvh.order], bvh.label[node, child][leaf_of])
    assert np.all(bvh.label[~bvh.is_leaf] == MIXED)

    # A tree in depth-first order: each node but the root is a child once, of an earlier node.
    parent, _ = np.nonzero(bvh.is_inner)
    below = bvh.child[bvh.is_inner]
    assert np.array_equal(np.sort(below), np.arange(1, len(bvh))) and np.all(below > parent)
    first = bvh.is_inner[:, 0]
    assert np.array_equal(bvh.child[first, 0], np.flatnonzero(first) + 1)
    level, depth = np.zeros(1, int), 0
    while len(level):
        level, depth = bvh.child[level][bvh.is_inner[level]], depth + 1
    assert depth == bvh.depth <= MAX_DEPTH

    # Boxes contain the primitives as given, and are the union of what is below, no more.
    box = bvh.boxes[node, child][leaf_of].astype(np.float64)
    assert np.all(box[:, 0] <= lo[bvh.order]) and np.all(box[:, 1] >= hi[bvh.order])
    union = bvh.boxes[below]
    assert np.array_equal(bvh.boxes[bvh.is_inner][:, 0], union[:, :, 0].min(axis=1))
    assert np.array_equal(bvh.boxes[bvh.is_inner][:, 1], union[:, :, 1].max(axis=1))
    empty = ~bvh.is_leaf & ~bvh.is_inner
    assert np.all(bvh.boxes[empty] == FAR) and np.all(bvh.child[empty] == -1) and np.count_nonzero(empty) <= 1
