"""The reference builder: what a full sweep from above, over all primitives, makes of a scene."""

from __future__ import annotations

import numpy as np

from .boxes import half_areas
from .build import assemble
from .cost import INTERSECTION_COST, TRAVERSAL_COST
from .flatten import LEAF_SIZE
from .split import split_topdown
from .topology import Topology
from .tree import Bvh


def sweep_build(
    lo: np.ndarray,
    hi: np.ndarray,
    label: np.ndarray | None = None,
    *,
    leaf_size: int | np.ndarray = LEAF_SIZE,
    traversal_cost: float = TRAVERSAL_COST,
    intersection_cost: float | np.ndarray = INTERSECTION_COST,
) -> Bvh:
    """As `build`, without the clustering: several times slower for large n, the measure of its quality. n < 2^24."""
    return assemble(_join, lo, hi, label, leaf_size, traversal_cost, intersection_cost)


def _join(span: np.ndarray) -> Topology:
    """A complete tree over the (6, n) spans."""
    topology = Topology(half_areas(span))
    split_topdown(span, np.arange(topology.n, dtype=np.int32), np.ones(topology.n), topology)
    return topology
