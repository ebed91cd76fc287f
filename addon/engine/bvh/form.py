"""The form of a hierarchy, which can be put around its primitives again when they have moved."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from .refit import leaves_in_order, nodes_by_level
from .tree import FAR, Bvh


class Form:
    """A hierarchy without boxes, in narrow types.

    Attributes:
        bvh: its `order`, `run`, `child`, `count`, `label` and `depth`.
    """

    def __init__(self, bvh: Bvh):
        narrow = {name: getattr(bvh, name).astype(np.int32) for name in ("child", "order")}
        self.bvh = replace(bvh, boxes=np.empty((0, 2, 2, 3), np.float32), **narrow)

    def around(self, span: np.ndarray) -> Bvh:
        """The hierarchy around the (6, n) float32 spans of its primitives, in its own order.

        As `refit`, but spans have rows -lo.x, -lo.y, -lo.z, hi.x, hi.y, hi.z: a union is one maximum.
        """
        leaf, start = self._leaves
        whole = np.full((6, 2 * len(self.bvh)), -FAR, np.float32)
        whole[:, leaf] = np.maximum.reduceat(span, start, axis=1)
        for above, below in self._levels:
            whole[:, above] = np.maximum(np.take(whole, below, axis=1), np.take(whole, below + 1, axis=1))
        boxes = np.empty((len(self.bvh), 2, 2, 3), np.float32)
        both = boxes.reshape(-1, 2, 3)
        both[:, 0], both[:, 1] = -whole[:3].T, whole[3:].T
        both[~(self.bvh.is_leaf | self.bvh.is_inner).ravel()] = FAR
        return replace(self.bvh, boxes=boxes)

    @cached_property
    def _leaves(self):
        return leaves_in_order(self.bvh)

    @cached_property
    def _levels(self):
        """From the lowest nodes on: children that are nodes, as node * 2 + child, and the first child of each."""
        inner, levels = self.bvh.is_inner, []
        for level in reversed(nodes_by_level(self.bvh.child, inner)):
            above = (2 * level[:, None] + np.arange(2))[inner[level]]
            levels.append((above, 2 * self.bvh.child.ravel()[above].astype(np.int64)))
        return levels
