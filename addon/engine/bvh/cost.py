"""What a hierarchy is worth: the surface area heuristic and plain counts."""

from __future__ import annotations

import numpy as np

from ..threads import each_piece
from .tree import Bvh, Forest

TRAVERSAL_COST = 1.0  # of visiting a node, which tests the boxes of both its children
INTERSECTION_COST = 0.5  # of testing a primitive: fewer texels than a node, and a leaf reads them in a row


def by_label(value: float | np.ndarray, label: np.ndarray, dtype: type = np.float32) -> np.ndarray:
    """(labels,) a value for each label, from one for all or from one for each."""
    value = np.asarray(value, dtype)
    return value if value.ndim else np.full(int(label.max()) + 1, value)


def sah_cost(
    bvh: Bvh, traversal_cost: float = TRAVERSAL_COST, intersection_cost: float | np.ndarray = INTERSECTION_COST
) -> float:
    """Expected cost of a random long ray that meets the root's box (Goldsmith and Salmon 1987).

    (sum of area(inner) * traversal_cost + sum of area(leaf) * count * intersection_cost) / area(root). If the
    root's box has no area (a point or a segment), every box counts as met. 0 for an empty hierarchy.
    `intersection_cost` may be one for each label.
    """
    if len(bvh) == 0:
        return 0.0
    lo, hi = bvh.bounds.astype(np.float64)
    root = _half_area(hi - lo)
    test = by_label(intersection_cost, np.maximum(bvh.label, 0))
    costs = each_piece(lambda nodes: float(_costs(bvh, nodes, root, traversal_cost, test).sum()), len(bvh))
    return traversal_cost + sum(costs)


def sah_costs(
    forest: Forest, traversal_cost: float = TRAVERSAL_COST, intersection_cost: float | np.ndarray = INTERSECTION_COST
) -> np.ndarray:
    """(t,) float64: `sah_cost` of each tree."""
    bvh, (lo, hi) = forest.bvh, np.moveaxis(forest.bounds.astype(np.float64), 1, 0)
    root = np.repeat(_half_area(hi - lo), np.diff(forest.root))
    test = by_label(intersection_cost, np.maximum(bvh.label, 0))
    costs = _costs(bvh, slice(None), root[:, None], traversal_cost, test)
    return traversal_cost + np.add.reduceat(costs.sum(axis=1), forest.root[:-1])


def _costs(bvh: Bvh, nodes: slice, root: np.ndarray, traversal_cost: float, test: np.ndarray) -> np.ndarray:
    """(m, 2) float64: what children of nodes cost. `root`: half the surface; `test`: by label."""
    boxes, count, child = bvh.boxes[nodes].astype(np.float64), bvh.count[nodes], bvh.child[nodes]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(np.asarray(root) > 0, _half_area(boxes[:, :, 1] - boxes[:, :, 0]) / root, 1.0)
    cost = np.where(count > 0, count * test[bvh.label[nodes]], traversal_cost)
    return np.where((count > 0) | (child >= 0), share * cost, 0.0)


def statistics(bvh: Bvh) -> dict[str, int | float]:
    """`nodes`, `depth`, `leaves`, `leaf_size` (mean) and `sah_cost` at the default costs."""
    leaves = int(np.count_nonzero(bvh.is_leaf))
    return {
        "nodes": len(bvh),
        "depth": bvh.depth,
        "leaves": leaves,
        "leaf_size": len(bvh.order) / leaves if leaves else 0.0,
        "sah_cost": sah_cost(bvh),
    }


def _half_area(size: np.ndarray) -> np.ndarray:
    """Half the surface areas of boxes of (..., 3) sizes."""
    x, y, z = np.moveaxis(size, -1, 0)
    return x * y + z * (x + y)
