"""Build a hierarchy: clustering from below while boxes are many, then an exact sweep from above.

The top of the tree decides most of the cost and is where clustering, which sees only neighbours, does worst;
the bottom holds most of the nodes and is where a sweep takes its time. A small scene is all sweep.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .agglomerate import agglomerate
from .boxes import checked_boxes, checked_labels, half_areas, morton_order, spans
from .cost import INTERSECTION_COST, TRAVERSAL_COST
from .flatten import LEAF_SIZE, flatten, flatten_all
from .split import split_topdown
from .topology import Topology
from .tree import Bvh, Forest, empty_bvh

TOP = 8192  # clusters left to the sweep


def build(
    lo: np.ndarray,
    hi: np.ndarray,
    label: np.ndarray | None = None,
    *,
    leaf_size: int | np.ndarray = LEAF_SIZE,
    traversal_cost: float = TRAVERSAL_COST,
    intersection_cost: float | np.ndarray = INTERSECTION_COST,
) -> Bvh:
    """The hierarchy over n boxes.

    Args:
        lo, hi: (n, 3) float32 or float64 corners of the boxes, lo <= hi. n may be 0.
        label: (n,) small integers >= 0, for instance the kinds of the primitives; a leaf holds one label.
            Default: all 0.
        leaf_size: most primitives in a leaf, or (labels,), of each label; fewer where the costs say so.
        traversal_cost: of visiting a node (testing the boxes of both children), in the unit of
        intersection_cost: of testing one primitive; or (labels,), of each label.

    Raises:
        ValueError: a box is not finite, inverted, or beyond float32 (first bad primitive named); a bad label
            or leaf size.
    """
    return assemble(_join, lo, hi, label, leaf_size, traversal_cost, intersection_cost)


def build_forest(
    lo: np.ndarray,
    hi: np.ndarray,
    label: np.ndarray | None,
    counts: np.ndarray,
    *,
    leaf_size: int | np.ndarray = LEAF_SIZE,
    traversal_cost: float = TRAVERSAL_COST,
    intersection_cost: float | np.ndarray = INTERSECTION_COST,
) -> Forest:
    """The hierarchies over lots of boxes, one after the other: the same trees as `build` makes of each, in one go.

    `counts`: (t,) how many are in each lot, 1 to `TOP`.
    """
    lo, hi, label = checked(lo, hi, label, leaf_size)
    span = spans(lo, hi, counts)
    topology = Topology(half_areas(span), len(counts))
    split_topdown(span, np.arange(topology.n, dtype=np.int32), np.ones(topology.n), topology, counts)
    del span
    curve = np.arange(len(lo))
    return flatten_all(topology, counts, curve, lo, hi, label, leaf_size, traversal_cost, intersection_cost)


def assemble(
    join: Callable[[np.ndarray], Topology],
    lo: np.ndarray,
    hi: np.ndarray,
    label: np.ndarray | None,
    leaf_size: int | np.ndarray,
    traversal_cost: float,
    intersection_cost: float | np.ndarray,
) -> Bvh:
    """What all builders share: check the input, `join` the spans into one binary tree, and flatten that.

    Where they are many they lie along the curve, so that what belongs together lies together in memory.
    """
    lo, hi, label = checked(lo, hi, label, leaf_size)
    if len(lo) == 0:
        return empty_bvh()
    span = spans(lo, hi)
    curve = np.arange(len(lo))
    if len(lo) > TOP:
        curve = morton_order(span)
        for row in span:  # one at a time in place: half the memory
            row[:] = row[curve]
    topology = join(span)
    del span
    return flatten(topology, curve, lo, hi, label, leaf_size, traversal_cost, intersection_cost)


def checked(
    lo: np.ndarray, hi: np.ndarray, label: np.ndarray | None, leaf_size: int | np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Boxes and labels as the builders use them; raises ValueError as `build`."""
    if np.min(leaf_size) < 1:
        raise ValueError(f"leaf_size must be at least 1, not {leaf_size}")
    lo, hi = checked_boxes(lo, hi)
    return lo, hi, checked_labels(label, len(lo))


def _join(span: np.ndarray) -> Topology:
    """A complete tree over the (6, n) spans; overwrites them."""
    topology = Topology(half_areas(span))
    ids, weight = np.arange(topology.n, dtype=np.int32), np.ones(min(topology.n, TOP))
    if topology.n > TOP:
        span, ids = agglomerate(span, ids, topology, TOP)
        weight = topology.counts()[ids]
    split_topdown(span, ids, weight, topology)
    return topology
