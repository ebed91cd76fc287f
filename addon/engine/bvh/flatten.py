"""From binary trees to a `Bvh`: which subtrees become leaves, where nodes and primitives lie."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .cost import by_label
from .refit import put_around
from .topology import Topology
from .tree import MAX_DEPTH, MIXED, Bvh, Forest

LEAF_SIZE = 4

Cut = Callable[[np.ndarray, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
"""See `lay_out`."""


def flatten(
    topology: Topology,
    curve: np.ndarray,
    lo: np.ndarray,
    hi: np.ndarray,
    label: np.ndarray,
    leaf_size: int | np.ndarray,
    traversal_cost: float,
    intersection_cost: float | np.ndarray,
) -> Bvh:
    """The `Bvh` of a complete `topology` of one tree over the (n, 3) float32 boxes with (n,) int32 labels, n > 0.

    `curve` (n,) int64: which box primitive i of the topology is.
    """
    counts = np.array([len(curve)])
    return flatten_all(topology, counts, curve, lo, hi, label, leaf_size, traversal_cost, intersection_cost).bvh


def flatten_all(
    topology: Topology,
    counts: np.ndarray,
    curve: np.ndarray,
    lo: np.ndarray,
    hi: np.ndarray,
    label: np.ndarray,
    leaf_size: int | np.ndarray,
    traversal_cost: float,
    intersection_cost: float | np.ndarray,
) -> Forest:
    """As `flatten`, of trees over (t,) `counts` of primitives one after the other."""
    topology.larger_first()
    count, leaves, kind = _choose_leaves(topology, label[curve], leaf_size, traversal_cost, intersection_cost)
    start, primitives = _depth_first(topology, counts, count)
    order, run, rank = runs(curve[primitives], label)
    del primitives
    leaf = _leaf_nodes(topology, leaves, start)
    form = rank[start[leaf]], count[leaf], kind[leaf]
    child, size, kinds, root, depth = lay_out(*form, topology.roots, leaves[topology.roots], _follow(topology, leaves))
    del count, leaves, kind, start, rank, leaf, form  # the boxes need room of their own
    no_boxes = np.empty((0, 2, 2, 3), np.float32)
    bvh = Bvh(no_boxes, child, size, kinds, order, run, int(depth.max()))
    return Forest(put_around(bvh, lo, hi, root[:-1]), root, depth, counts)


def _choose_leaves(
    topology: Topology,
    label: np.ndarray,
    leaf_size: int | np.ndarray,
    traversal_cost: float,
    intersection_cost: float | np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Bottom up: make a leaf of every subtree of one label and at most its `leaf_size` of primitives, where both its
    children are leaves and one is no dearer.

    Returns, for every node of the topology, the numbers of primitives and of leaves below it (1 within a leaf
    too), and its label or MIXED; (2n - t,) int32 each.
    """
    n, nodes = topology.n, len(topology.area)
    count, leaves = np.ones(nodes, np.int32), np.ones(nodes, np.int32)
    kind = np.empty(nodes, np.int32)
    kind[:n] = label
    cost = np.empty(nodes, np.float32)
    single, most = by_label(intersection_cost, label), by_label(leaf_size, label, np.int32)
    cost[:n] = topology.area[:n] * single[label]
    for batch in topology.batches:
        left, right = topology.left[batch], topology.right[batch]
        node = slice(n + batch.start, n + batch.stop)
        area = topology.area[node]
        total = count[left] + count[right]
        kind[node] = np.where(kind[left] == kind[right], kind[left], MIXED)
        split = area * np.float32(traversal_cost) + cost[left] + cost[right]
        whole = area * total * single[kind[node]]  # what is MIXED is no leaf, whatever it would cost
        below = leaves[left] + leaves[right]
        # Both children must be leaves, so that "one leaf below" means "in a leaf" all the way down.
        leaf = (below == 2) & (kind[node] >= 0) & (total <= most[kind[node]]) & (whole <= split)
        count[node], cost[node], leaves[node] = total, np.where(leaf, whole, split), np.where(leaf, 1, below)
    return count, leaves, kind


def _depth_first(topology: Topology, counts: np.ndarray, count: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Depth-first order: each node's first primitive, (2n - t,) int32; the primitives, (n,) int64."""
    n = topology.n
    start = np.empty(len(count), np.int32)
    start[topology.roots] = np.cumsum(counts) - counts
    for batch in reversed(topology.batches):
        left, right = topology.left[batch], topology.right[batch]
        first = start[n + batch.start : n + batch.stop]
        start[left] = first
        start[right] = first + count[left]
    primitives = np.empty(n, np.int64)
    primitives[start[:n]] = np.arange(n)
    return start, primitives


def runs(primitives: np.ndarray, label: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """`order` and `run` of the `Bvh`; and per depth-first place the place in its label's run, (n,)."""
    run = np.concatenate([[0], np.cumsum(np.bincount(label))]).astype(np.int64)
    if len(run) == 2:
        return primitives, run, np.arange(len(primitives), dtype=np.int32)
    labels = label[primitives]
    places = np.argsort(labels.astype(np.uint16), kind="stable")
    rank = np.empty(len(places), np.int32)
    rank[places] = np.arange(len(places)) - np.repeat(run[:-1], np.diff(run))
    return primitives[places], run, rank


def _leaf_nodes(topology: Topology, leaves: np.ndarray, start: np.ndarray) -> np.ndarray:
    """The nodes of the topology that become leaves, in depth-first order."""
    n = topology.n
    top = leaves == 1
    within = np.flatnonzero(top[n:])
    top[topology.left[within]] = top[topology.right[within]] = False
    nodes = np.full(n, -1, np.int32)
    top = np.flatnonzero(top)
    nodes[start[top]] = top
    return nodes[nodes >= 0]


def _follow(topology: Topology, leaves: np.ndarray) -> Cut:
    """Cuts as the topology has them; nodes below -1, where it is not followed, are halved."""

    def cut(node, first, number):
        halve = node < 0
        inner = np.where(halve, 0, node - topology.n)
        sides = np.where(halve, -1, np.stack([topology.left[inner], topology.right[inner]])).T
        return np.where(halve, number // 2, leaves[sides[:, 0]]), sides

    return cut


def lay_out(
    begin: np.ndarray, size: np.ndarray, kind: np.ndarray, roots: np.ndarray, leaves: np.ndarray, cut: Cut
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Top down, a level at a time: `child`, `count`, `label` of the `Bvh` over leaves; `root`, `depth` of the `Forest`.

    A subtree of c leaves has c - 1 nodes, so depth-first places are known at once. A chain that would become
    too deep is replaced by halves: its leaves are a range in depth-first order, and neighbours there are near
    in space.

    Args:
        begin, size, kind: (k,) of the leaves in depth-first order: first primitive as in `Bvh.child`, number of
            primitives, label.
        roots: (t,) what `cut` knows the roots of the trees by.
        leaves: (t,) numbers of leaves of the trees, one after the other.
        cut: (nodes (s,), their first leaf (s,), their numbers of leaves (s,)) to (leaves of child 0 (s,), nodes
            below (s, 2)). Nodes are what it likes, but -1 where it was not followed: it is given them again.
    """
    root = np.concatenate([[0], np.cumsum(np.maximum(leaves - 1, 1), dtype=np.int64)])
    child, count = np.full((root[-1], 2), -1, np.int64), np.zeros((root[-1], 2), np.int32)
    label = np.full((root[-1], 2), MIXED, np.int32)
    first = np.cumsum(leaves, dtype=np.int64) - leaves
    alone = leaves == 1
    only, at = root[:-1][alone], first[alone]
    child[only, 0], count[only, 0], label[only, 0] = begin[at], size[at], kind[at]

    depth, level = np.ones(len(leaves), np.int64), 0
    tree = np.flatnonzero(~alone)
    place, first, number, node = root[tree], first[tree], leaves[tree], roots[tree]
    while len(place):
        left, sides = cut(node, first, number)
        # Halving c leaves takes ceil(log2 c) levels: the last chance to begin is when just so many are left.
        if level + np.ceil(np.log2(number.max())) >= MAX_DEPTH:
            halve = level + np.ceil(np.log2(number)) >= MAX_DEPTH
            left, sides = np.where(halve, number // 2, left), np.where(halve[:, None], -1, sides)
        numbers = np.stack([left, number - left], axis=1)
        firsts = np.stack([first, first + left], axis=1)
        places = np.stack([place + 1, place + left], axis=1)
        ends = numbers == 1
        child[place] = np.where(ends, begin[firsts], places)
        count[place] = np.where(ends, size[firsts], 0)
        label[place] = np.where(ends, kind[firsts], MIXED)
        level += 1
        depth[tree] = level
        inner = ~ends
        place, first, number, node = places[inner], firsts[inner], numbers[inner], sides[inner]
        tree = np.repeat(tree, np.count_nonzero(inner, axis=1)) if len(leaves) > 1 else tree
    return child, count, label, root, depth
