"""Build a hierarchy: clustering from below while boxes are many, then an exact sweep from above.

The top of the tree decides most of the cost and is where clustering, which sees only neighbours, does worst;
the bottom holds most of the nodes and is where a sweep takes its time. A small scene is all sweep.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .agglomerate import agglomerate
from .boxes import checked_boxes, checked_labels, half_areas, morton_order, spans, take_spans
from .cost import INTERSECTION_COST, TRAVERSAL_COST
from .flatten import LEAF_SIZE, flatten
from .split import split_topdown
from .topology import Topology
from .tree import Bvh, empty_bvh

TOP = 8192  # clusters left to the sweep


def build(
    lo: np.ndarray,
    hi: np.ndarray,
    label: np.ndarray | None = None,
    *,
    leaf_size: int = LEAF_SIZE,
    traversal_cost: float = TRAVERSAL_COST,
    intersection_cost: float = INTERSECTION_COST,
) -> Bvh:
    """The hierarchy over n boxes.

    Args:
        lo, hi: (n, 3) float32 or float64 corners of the boxes, lo <= hi. n may be 0.
        label: (n,) small integers >= 0, for instance the kinds of the primitives; a leaf holds one label.
            Default: all 0.
        leaf_size: most primitives in a leaf; fewer where the costs say so.
        traversal_cost: of visiting a node (testing the boxes of both children), in the unit of
        intersection_cost: of testing one primitive.

    Raises:
        ValueError: a box is not finite, inverted, or beyond float32 (first bad primitive named); a bad label
            or leaf size.
    """
    return assemble(_join, lo, hi, label, leaf_size, traversal_cost, intersection_cost)


def assemble(
    join: Callable[[np.ndarray, np.ndarray], Topology],
    lo: np.ndarray,
    hi: np.ndarray,
    label: np.ndarray | None,
    leaf_size: int,
    traversal_cost: float,
    intersection_cost: float,
) -> Bvh:
    """What all builders share: check the input, `join` the boxes into one binary tree, and flatten that."""
    if leaf_size < 1:
        raise ValueError(f"leaf_size must be at least 1, not {leaf_size}")
    lo, hi = checked_boxes(lo, hi)
    label = checked_labels(label, len(lo))
    if len(lo) == 0:
        return empty_bvh()
    return flatten(join(lo, hi), lo, hi, label, leaf_size, traversal_cost, intersection_cost)


def _join(lo: np.ndarray, hi: np.ndarray) -> Topology:
    """A complete tree over the (n, 3) float32 boxes."""
    span = spans(lo, hi)
    topology = Topology(half_areas(span))
    weight = np.ones(len(lo))
    ids = np.arange(len(lo), dtype=np.int32)
    if len(lo) > TOP:
        curve = morton_order(span)
        span, ids = agglomerate(take_spans(span, curve), ids[curve], topology, TOP)
        weight = topology.counts()[ids]
    split_topdown(span, ids, weight, topology)
    return topology
