"""Top-down splitting by an exact sweep: at every level all segments at once, every split position along the
three axes.

The surface area heuristic of J. Goldsmith, J. Salmon (1987) and J. MacDonald, K. Booth (1990): split where
the areas of the two sides, weighted by their numbers of primitives, add up to least. A segmented prefix
maximum, which numpy lacks, is a plain one over int64 keys whose high bits are the number of the segment.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .boxes import half_areas
from .topology import Topology

FIXED_BITS = 38  # fraction bits of the fixed-point spans; leaves 23 bits for segments
MAX_LEVELS = 44  # levels before segments are halved rather than split by cost: chains end here
BALANCE = 1e-4  # how much worse a wholly lopsided split may look: equal boxes are halved


@dataclass
class _Level:
    """The segments of one level: `order[axis]` lists the items of segment 0, 1, ..., each by centre."""

    order: np.ndarray  # (3, k) int64
    start: np.ndarray  # (s + 1,) int64

    @property
    def size(self) -> np.ndarray:
        return np.diff(self.start)


def split_topdown(
    span: np.ndarray, ids: np.ndarray, weight: np.ndarray, topology: Topology, counts: np.ndarray | None = None
) -> None:
    """Join the clusters into trees in `topology`.

    Args:
        span: (6, k) float32 spans of the clusters.
        ids: (k,) their nodes in `topology`.
        weight: (k,) numbers of primitives in them.
        counts: (t,) numbers of clusters, one after the other, that make a tree each; by default all make one.
    """
    counts = np.array([len(ids)]) if counts is None else counts
    tree = np.repeat(np.arange(len(counts)), counts)
    centre = span[3:] - span[:3]  # twice the centre, which sorts the same
    order = np.stack([np.lexsort((axis, tree)) for axis in centre])
    several = counts > 1
    level = _Level(order[:, several[tree]], np.concatenate([[0], np.cumsum(counts[several])]))
    fixed = np.rint(span.astype(np.float64) * 2.0**FIXED_BITS).astype(np.int64)
    areas, parents = [], []
    while len(level.order[0]):
        cut, axis = _cheapest_cuts(level, fixed, weight, len(areas) >= MAX_LEVELS)
        areas.append(half_areas(np.maximum.reduceat(span[:, level.order[0]], level.start[:-1], axis=1)))
        level, children = _partition(level, cut, axis, len(fixed[0]))
        parents.append(children)
    topology.roots = ids[np.cumsum(counts) - counts]
    topology.roots[several] = _emit(areas, parents, ids, topology)


def _emit(areas: list, parents: list, ids: np.ndarray, topology: Topology) -> np.ndarray:
    """Add the levels, deepest first; the nodes of the first. A child >= 0 is a segment of the next level, ~child an
    item."""
    below = np.empty(0, np.int32)
    for area, children in zip(reversed(areas), reversed(parents), strict=True):
        nodes = np.where(children < 0, ids[np.where(children < 0, ~children, 0)], 0)
        inner = children >= 0
        nodes[inner] = below[children[inner]]
        below = topology.add(nodes[:, 0], nodes[:, 1], area)
    return below


def _cheapest_cuts(level: _Level, fixed: np.ndarray, weight: np.ndarray, halve: bool) -> tuple[np.ndarray, np.ndarray]:
    """Per segment of two items or more: (s,) items left of the cut and (s,) axis."""
    size = level.size
    cut, axis = np.ones(len(size), np.int64), np.zeros(len(size), np.int64)
    many = size > 2  # there is one way to cut the others
    if many.any():
        order = level.order[:, np.repeat(many, size)]
        part = _Level(order, np.concatenate([[0], np.cumsum(size[many])]))
        cut[many], axis[many] = _swept_cuts(part, fixed, weight, halve)
    return cut, axis


def _swept_cuts(level: _Level, fixed: np.ndarray, weight: np.ndarray, halve: bool) -> tuple[np.ndarray, np.ndarray]:
    """As `_cheapest_cuts`."""
    size, start = level.size, level.start[:-1]
    segment = np.repeat(np.arange(len(size)), size)
    rank = np.arange(len(segment)) - start[segment]  # items left of a cut before this one
    best = np.full(len(size), np.inf)
    cut, axis = size // 2, np.zeros(len(size), np.int64)
    balance = 1 + BALANCE * np.abs(2 * rank / size[segment] - 1)
    for a in range(3):
        items = level.order[a]
        left, right = _sweep_areas(fixed, items, segment)
        load = np.cumsum(weight[items])
        before = np.concatenate([[0], load])[start]
        total = load[level.start[1:] - 1] - before
        load -= before[segment]  # weight up to and including this item
        # A cut before item i: left[i - 1] covers what is before it, right[i] the rest.
        cost = np.full(len(segment), np.inf)
        cost[1:] = left[:-1] * load[:-1] + right[1:] * (total[segment[1:]] - load[:-1])
        cost *= balance
        cost[start] = np.inf
        least = np.minimum.reduceat(cost, start)
        found = np.flatnonzero(cost == least[segment])[::-1]
        where = np.empty(len(size), np.int64)
        where[segment[found]] = rank[found]
        better = least < best
        if not halve:
            cut = np.where(better, where, cut)
        axis = np.where(better, a, axis)
        best = np.where(better, least, best)
    return cut, axis


def _sweep_areas(fixed: np.ndarray, items: np.ndarray, segment: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(k,) half areas of the unions, within the segment, of the items up to each, and from each on."""
    offset = segment << (FIXED_BITS + 2)
    back = offset[-1] - offset
    left, right = np.empty((3, len(items))), np.empty((3, len(items)))
    for axis in range(3):
        low, high = fixed[axis][items], fixed[3 + axis][items]
        size = np.maximum.accumulate(low + offset)
        size += np.maximum.accumulate(high + offset)
        size -= 2 * offset
        left[axis] = size
        low += back
        high += back
        size = np.maximum.accumulate(low[::-1])
        size += np.maximum.accumulate(high[::-1])
        right[axis] = size[::-1]
        right[axis] -= 2 * back
    # Boxes half a unit larger all round: those without area still count by their length, none is free.
    left += 1.0
    right += 1.0
    return _half_areas(left), _half_areas(right)


def _half_areas(size: np.ndarray) -> np.ndarray:
    """(n,) half surface areas of boxes with (3, n) sizes."""
    x, y, z = size
    return x * y + z * (x + y)


def _partition(level: _Level, cut: np.ndarray, axis: np.ndarray, n: int) -> tuple[_Level, np.ndarray]:
    """Cut the segments: the next level, without single items, and the (s, 2) children for `_emit`."""
    size, start = level.size, level.start[:-1]
    segment = np.repeat(np.arange(len(size)), size)
    chosen = level.order[axis[segment], np.arange(len(segment))]
    on_right = np.zeros(n, bool)
    on_right[chosen] = np.arange(len(segment)) - start[segment] >= cut[segment]

    # Keep every axis sorted by centre: a stable partition of each segment by the side of its items.
    order = np.empty_like(level.order)
    for a in range(3):
        right = on_right[level.order[a]]
        rights = np.cumsum(right) - right
        rights -= rights[start][segment]
        here = np.arange(len(segment))
        target = np.where(right, (start + cut)[segment] + rights, here - rights)
        order[a, target] = level.order[a]

    sides = np.stack([cut, size - cut], axis=1)
    first = np.stack([start, start + cut], axis=1)
    single = sides == 1
    children = np.where(single, ~order[0, first], 0)
    children[~single] = np.arange(np.count_nonzero(~single))
    keep = np.repeat(~single.ravel(), sides.ravel())
    return _Level(order[:, keep], np.concatenate([[0], np.cumsum(sides[~single])])), children
