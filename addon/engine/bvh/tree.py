"""The bounding volume hierarchy as plain arrays, ready to be packed for the GPU."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

MAX_DEPTH = 62
"""Inner nodes on the longest path of any hierarchy made here: a stack of this size never overflows."""

MIXED = -1
"""Label of an inner child, of an empty child, and of a set of primitives with more than one label."""


FAR = np.finfo(np.float32).max
"""Coordinate, on every axis, of the point that stands for the box of an empty child."""


@dataclass(frozen=True, eq=False)
class Bvh:
    """A binary hierarchy whose nodes hold the boxes of both their children ("wide in parent").

    Node 0 is the root; nodes lie in depth-first order, so child 0 of a node, if inner, is the next node.
    Child 0 is the one with the larger surface area. A hierarchy of no primitives has no nodes. One of a
    single leaf has one node, whose child 1 is *empty*: count 0, child -1, and for its box the single point at
    the greatest float32 on each axis, which no ray reaches before t = 3e38 / |direction|. Any slab test with
    a limit on t below that misses it, whereas an inverted box would be put right, and hit, by a slab test
    that sorts the two planes of a slab by `min` and `max`.

    Attributes:
        boxes: (m, 2, 2, 3) float32: node, child, lo or hi, xyz. Rounded outward, so they contain the
            primitives' boxes as given.
        child: (m, 2) int64. Inner child: its node. Leaf: its first primitive, counted from the start of its
            label's run in `order`.
        count: (m, 2) int32. 0 for an inner or empty child, the number of primitives for a leaf.
        label: (m, 2) int32. The label of a leaf's primitives; -1 for an inner or empty child.
        order: (n,) int64, a permutation of the primitives, all of the lowest label first, then the next
            label; within a label's run in depth-first order of the leaves, so that each leaf is contiguous.
        run: (labels + 1,) int64. The primitives of label L are `order[run[L]:run[L + 1]]`.
        depth: inner nodes on the longest path from the root, at most `MAX_DEPTH`.
    """

    boxes: np.ndarray
    child: np.ndarray
    count: np.ndarray
    label: np.ndarray
    order: np.ndarray
    run: np.ndarray
    depth: int

    def __len__(self) -> int:
        """The number of nodes, m."""
        return len(self.child)

    @property
    def is_leaf(self) -> np.ndarray:
        """(m, 2) bool: the child is a leaf with primitives."""
        return self.count > 0

    @property
    def is_inner(self) -> np.ndarray:
        """(m, 2) bool: the child is a node."""
        return (self.count == 0) & (self.child >= 0)

    @property
    def leaf_start(self) -> np.ndarray:
        """(m, 2) int64: position in `order` of a leaf's first primitive; 0 where the child is no leaf."""
        return np.where(self.is_leaf, self.run[self.label] + self.child, 0)

    @property
    def bounds(self) -> np.ndarray:
        """(2, 3) float32: lo and hi of everything; an empty child's box if there is nothing."""
        if len(self) == 0:
            return np.full((2, 3), FAR, np.float32)
        root = self.boxes[0, self.child[0] >= 0]
        return np.stack([root[:, 0].min(axis=0), root[:, 1].max(axis=0)])


@dataclass(frozen=True, eq=False)
class Forest:
    """The hierarchies of t lots of primitives in one.

    Attributes:
        bvh: its nodes are those of all trees, one tree after the other; its primitives those of all lots, and in a
            label's run likewise those of one tree after the other. Children are counted accordingly. `depth` is that
            of the deepest tree. `bounds` is of no use.
        root: (t + 1,) int64: the first node of each tree; the number of nodes.
        depth: (t,) int64: of each tree, see `Bvh.depth`.
        counts: (t,) int64: numbers of primitives.
    """

    bvh: Bvh
    root: np.ndarray
    depth: np.ndarray
    counts: np.ndarray

    def __len__(self) -> int:
        """The number of trees, t."""
        return len(self.depth)

    @property
    def bounds(self) -> np.ndarray:
        """(t, 2, 3) float32: lo and hi of each tree."""
        boxes, empty = self.bvh.boxes[self.root[:-1]], self.bvh.child[self.root[:-1], 1] < 0
        boxes[empty, 1] = boxes[empty, 0]
        return np.stack([boxes[:, :, 0].min(axis=1), boxes[:, :, 1].max(axis=1)], axis=1)

    def runs(self) -> np.ndarray:
        """(t + 1, labels) int64: where the primitives of each tree and label begin in `bvh.order`; where they end."""
        labels = len(self.bvh.run) - 1
        tree = np.repeat(np.arange(len(self)), self.counts)[self.bvh.order]
        label = np.repeat(np.arange(labels), np.diff(self.bvh.run))
        counts = np.bincount(tree * labels + label, minlength=len(self) * labels).reshape(-1, labels)
        return self.bvh.run[:-1] + np.concatenate([np.zeros((1, labels), np.int64), np.cumsum(counts, axis=0)])

    def tree(self, number: int) -> Bvh:
        """One of the hierarchies, as if it had been built alone."""
        bvh, nodes = self.bvh, slice(*self.root[number : number + 2])
        start, stop = self.runs()[number : number + 2]
        start, stop = (ends[: 1 + np.flatnonzero(stop > start)[-1]] for ends in (start, stop))
        first = np.concatenate([start - bvh.run[: len(start)], [self.root[number]]])
        child, label = bvh.child[nodes], bvh.label[nodes]
        order = np.concatenate([bvh.order[a:b] for a, b in zip(start, stop, strict=True)])
        return Bvh(
            boxes=bvh.boxes[nodes],
            child=np.where(child >= 0, child - first[label], -1),  # MIXED is the last, the nodes
            count=bvh.count[nodes],
            label=label,
            order=order - self.counts[:number].sum(),
            run=np.concatenate([[0], np.cumsum(stop - start)]),
            depth=int(self.depth[number]),
        )


def empty_bvh() -> Bvh:
    """The hierarchy of no primitives."""
    return Bvh(
        boxes=np.empty((0, 2, 2, 3), np.float32),
        child=np.empty((0, 2), np.int64),
        count=np.empty((0, 2), np.int32),
        label=np.empty((0, 2), np.int32),
        order=np.empty(0, np.int64),
        run=np.zeros(1, np.int64),
        depth=0,
    )
