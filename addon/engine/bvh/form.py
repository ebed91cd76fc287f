"""The form of a hierarchy, which can be put around its primitives, also when they have moved."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..threads import LARGE, each
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

        Spans have rows -lo.x, -lo.y, -lo.z, hi.x, hi.y, hi.z: a union is one maximum.
        """
        return replace(self.bvh, boxes=self.slots.boxes(span.__getitem__))

    @cached_property
    def slots(self) -> Slots:
        """Found where they are asked for first."""
        return Slots(self.bvh)


class Slots:
    """Places for the children of all nodes, a level after the other from the roots: what lies below the children of a
    level that are nodes lies in a row.

    Attributes:
        child: (2m,) of the `Bvh`.
        levels: the first node of each level below the roots, and their number.
        inner: (m - roots,) slots of the children that are nodes, in the order of these nodes.
        leaf, start: (leaves,) slots of leaves, and where they begin in the order of the hierarchy, ascending.
        place: (2m,) int64: of each slot, node * 2 + child.
    """

    def __init__(self, bvh: Bvh, roots: np.ndarray | None = None):
        """`roots`: of a `Forest`."""
        self.child, count = bvh.child.ravel(), bvh.count.ravel()
        nodes, inner = [np.arange(min(len(bvh), 1)) if roots is None else roots], bvh.is_inner
        while len(nodes[-1]):
            nodes.append(bvh.child[nodes[-1]][inner[nodes[-1]]])
        self.levels = np.cumsum([len(level) for level in nodes[:-1]])
        nodes = np.concatenate(nodes)
        self.place = np.empty(2 * len(nodes), np.int64)
        np.multiply(nodes, 2, out=self.place[::2])
        np.add(self.place[::2], 1, out=self.place[1::2])
        self.inner = np.flatnonzero(inner.ravel()[self.place])
        leaf = np.flatnonzero(count[self.place])
        place = self.place[leaf]
        first = np.full(len(bvh.order), -1, np.int32)
        first[self.child[place] + bvh.run[bvh.label.ravel()[place]]] = leaf
        self.start = np.flatnonzero(first >= 0)
        self.leaf = first[self.start]

    def boxes(self, span: Callable[[int], np.ndarray]) -> np.ndarray:
        """(m, 2, 2, 3) float32 boxes; `span` gives one of the six rows of spans, (n,) in the order of the hierarchy.

        Each row is put around for itself: leaves first, then a level at a time upward.
        """
        boxes = np.empty((len(self.child), 6), np.float32)
        if len(boxes):
            large = len(boxes) >= LARGE // 4
            each(lambda row: self._fill(row, span(row), boxes[:, row]), range(6), worth_it=large)
        boxes[self.child < 0] = FAR
        return boxes.reshape(-1, 2, 2, 3)

    def _fill(self, row: int, span: np.ndarray, boxes: np.ndarray) -> None:
        """From a row of spans (n,) to the column (2m,) of the boxes of all children."""
        around = np.empty(len(boxes), np.float32)
        around[self.leaf] = np.maximum.reduceat(span, self.start)
        for first, stop in zip(self.levels[-2::-1].tolist(), self.levels[:0:-1].tolist(), strict=True):
            below = around[2 * first : 2 * stop]
            above = self.inner[first - self.levels[0] : stop - self.levels[0]]
            around[above] = np.maximum(below[::2], below[1::2])
        boxes[self.place] = -around if row < 3 else around
