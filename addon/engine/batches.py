"""Geometries of few primitives, many of which are packed together: which, and their primitives in one."""

import numpy as np

from .plan import LARGE
from .primitives import BY_KIND

#: Primitives of a batch: the temporary arrays of a tree's builder stay in the processor's cache.
MOST = 1 << 15


def batches(plan, numbers):
    """Of `numbers` of geometries: lists of those that are built together, each of at most `MOST` primitives in all,
    whose own space either is the world's or is not; and the large ones, see `plan.LARGE`."""
    sizes = plan.counts[numbers].sum(axis=1)
    found, small = [], sizes < LARGE
    for in_world in (True, False):
        of_these = small & (plan.in_world[numbers] == in_world)
        batch = np.cumsum(sizes[of_these]) // (MOST - LARGE)
        found += np.split(numbers[of_these], np.flatnonzero(np.diff(batch)) + 1)
    return [batch for batch in found if len(batch)], numbers[~small]


def joined(geometries, counts):
    """Of geometries with `counts` (n, K) of primitives, by kind number: all primitives of a kind, without attributes;
    their rows among all primitives, where those of a geometry lie together."""
    found = {}
    for geometry in geometries:
        for label, part in geometry.kinds():
            found.setdefault(label, []).append(part)
    parts = {label: BY_KIND[label].concatenate(found[label], attributes=False) for label in sorted(found)}
    first = (np.cumsum(counts) - counts.ravel()).reshape(counts.shape)
    rows = {}
    for label, part in parts.items():
        count = counts[:, label]
        rows[label] = np.arange(len(part)) + np.repeat(first[:, label] - (np.cumsum(count) - count), count)
    return parts, rows
