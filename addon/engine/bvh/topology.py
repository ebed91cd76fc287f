"""Binary trees under construction: nodes 0 to n - 1 are the primitives; then batches, children first."""

from __future__ import annotations

import numpy as np


class Topology:
    """Children and areas of the nodes of a tree over n primitives, or of t trees over as many in all.

    Attributes:
        n: the number of primitives.
        roots: (t,) nodes; the primitives of the first tree come first.
        left, right: (n - t,) int32: children of node n + i.
        area: (2n - t,) float32: half surface areas of the nodes' boxes, in the scale of the spans.
        batches: slices of `left` and `right`. The children of a node are primitives or belong to an earlier
            batch.
    """

    def __init__(self, area: np.ndarray, trees: int = 1):
        """`area`: (n,) float32 half areas of the primitives, n > 0. The `roots` of several `trees` are to be set."""
        self.n = len(area)
        self.roots = np.full(1, 2 * self.n - 2, np.int32)
        self.left = np.empty(self.n - trees, np.int32)
        self.right = np.empty(self.n - trees, np.int32)
        self.area = np.empty(2 * self.n - trees, np.float32)
        self.area[: self.n] = area
        self.batches: list[slice] = []

    def add(self, left: np.ndarray, right: np.ndarray, area: np.ndarray) -> np.ndarray:
        """Add a batch of nodes and return their (k,) int32 numbers."""
        start = self.batches[-1].stop if self.batches else 0
        batch = slice(start, start + len(left))
        self.left[batch], self.right[batch] = left, right
        self.area[self.n + batch.start : self.n + batch.stop] = area
        self.batches.append(batch)
        return np.arange(self.n + batch.start, self.n + batch.stop, dtype=np.int32)

    def larger_first(self) -> None:
        """Make the left child of every node the one with the larger area."""
        swap = self.area[self.left] < self.area[self.right]
        self.left[swap], self.right[swap] = self.right[swap], self.left[swap]

    def counts(self) -> np.ndarray:
        """(2n - t,) int32 numbers of primitives below the nodes added so far (1 for those to come)."""
        count = np.ones(len(self.area), np.int32)
        for batch in self.batches:
            count[self.n + batch.start : self.n + batch.stop] = count[self.left[batch]] + count[self.right[batch]]
        return count
