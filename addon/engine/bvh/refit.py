"""New boxes for an old hierarchy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .boxes import checked_boxes
from .tree import FAR, Bvh


def refit(bvh: Bvh, lo: np.ndarray, hi: np.ndarray) -> Bvh:
    """The same hierarchy around moved primitives: leaves first, then a level at a time upward.

    Args:
        lo, hi: (n, 3) float32 or float64, for the same n primitives in the same order that `bvh` was built
            from.

    Raises:
        ValueError: another number of boxes, or a box that `build` would refuse.
    """
    lo, hi = checked_boxes(lo, hi)
    if len(lo) != len(bvh.order):
        raise ValueError(f"refit: the hierarchy holds {len(bvh.order)} primitives, but {len(lo)} boxes were given")
    boxes = np.full((len(bvh), 2, 2, 3), FAR, np.float32)
    if len(bvh) == 0:
        return replace(bvh, boxes=boxes)
    leaf, start = leaves_in_order(bvh)
    around = np.empty((len(leaf), 2, 3), np.float32)
    for side, corner, reduce in ((0, lo, np.minimum), (1, hi, np.maximum)):
        corner = np.take(corner, bvh.order, axis=0)
        for axis in range(3):
            around[:, side, axis] = reduce.reduceat(corner[:, axis], start)
    boxes.reshape(-1, 2, 3)[leaf] = around
    inner = bvh.is_inner
    for level in reversed(nodes_by_level(bvh.child, inner)):
        parent = level[inner[level].any(axis=1)]
        for side in range(2):
            above = parent[inner[parent, side]]
            below = boxes[bvh.child[above, side]]
            boxes[above, side, 0] = np.minimum(below[:, 0, 0], below[:, 1, 0])
            boxes[above, side, 1] = np.maximum(below[:, 0, 1], below[:, 1, 1])
    return replace(bvh, boxes=boxes)


def leaves_in_order(bvh: Bvh) -> tuple[np.ndarray, np.ndarray]:
    """The leaves as flat indices (node * 2 + child), and where they start in `order`; in that order."""
    leaf = np.flatnonzero(bvh.count)
    first = np.full(len(bvh.order), -1, np.int64)
    first[bvh.leaf_start.ravel()[leaf]] = leaf
    start = np.flatnonzero(first >= 0)
    return first[start], start


def nodes_by_level(child: np.ndarray, inner: np.ndarray) -> list[np.ndarray]:
    """The nodes at each distance from the root."""
    level = np.zeros(1, np.int64)
    levels = []
    while len(level):
        levels.append(level)
        level = child[level][inner[level]]
    return levels
