"""What a hierarchy is worth: the surface area heuristic and plain counts."""

from __future__ import annotations

import numpy as np

from .tree import Bvh

TRAVERSAL_COST = 1.0  # of visiting a node, which tests the boxes of both its children
INTERSECTION_COST = 0.5  # of testing a primitive: fewer texels than a node, and a leaf reads them in a row


def sah_cost(bvh: Bvh, traversal_cost: float = TRAVERSAL_COST, intersection_cost: float = INTERSECTION_COST) -> float:
    """Expected cost of a random long ray that meets the root's box (Goldsmith and Salmon 1987).

    (sum of area(inner) * traversal_cost + sum of area(leaf) * count * intersection_cost) / area(root). If the
    root's box has no area (a point or a segment), every box counts as met. 0 for an empty hierarchy.
    """
    if len(bvh) == 0:
        return 0.0
    lo, hi = bvh.bounds.astype(np.float64)
    root = _half_area(hi - lo)
    used = bvh.is_inner | bvh.is_leaf
    boxes = bvh.boxes[used].astype(np.float64)
    share = _half_area(boxes[:, 1] - boxes[:, 0]) / root if root > 0 else np.ones(len(boxes))
    count = bvh.count[used]
    return float(traversal_cost + np.sum(share * np.where(count > 0, count * intersection_cost, traversal_cost)))


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
