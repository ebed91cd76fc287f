# SPDX-License-Identifier: GPL-3.0-or-later
"""What materials want to know of a mesh that no attribute tells: its parts, and its form before it was deformed."""

import numpy as np

from .raw_attributes import read_positions

#: Of the size of a mesh: a vertex that moves less has not been deformed.
_MOVED = 1e-6


def undeformed(mesh):
    """The places (vertices, 3) float32 of a mesh without the modifiers that deform it; None where none does."""
    positions = read_positions(mesh)
    places = np.empty(3 * len(positions), np.float32)
    mesh.vertices.foreach_get("undeformed_co", places)
    places = places.reshape(-1, 3)
    size = np.ptp(places, axis=0).max(initial=0.0)
    return places if np.abs(places - positions).max(initial=0.0) > _MOVED * size else None


def island_randoms(mesh):
    """A number from 0 to 1 of each vertex, (vertices,) float32, the same in each part of a mesh that is not joined to
    others by edges."""
    edges = np.empty(2 * len(mesh.edges), np.int32)
    mesh.edges.foreach_get("vertices", edges)
    return _randoms(islands(len(mesh.vertices), edges.reshape(-1, 2)))


def islands(count, edges):
    """The lowest vertex (count,) of each vertex's part of a graph with edges (e, 2).

    Labels sink along edges, then to the labels of their labels, so that the turns are few (Shiloach and Vishkin 1982).
    """
    label = np.arange(count)
    a, b = np.asarray(edges, np.int64).T
    while True:
        low = np.minimum(label[a], label[b])
        if (low == label[a]).all() and (low == label[b]).all():
            return label
        for end in (a, b):
            np.minimum.at(label, label[end], low)
            np.minimum.at(label, end, low)
        while (label[label] != label).any():
            label = label[label]


def _randoms(numbers):
    """Numbers from 0 to 1 of whole numbers: a hash (Wellons 2018, Prospecting for Hash Functions)."""
    x = numbers.astype(np.uint32)
    with np.errstate(over="ignore"):
        for shift, factor in ((16, 0x7FEB352D), (15, 0x846CA68B)):
            x = (x ^ (x >> np.uint32(shift))) * np.uint32(factor)
    return ((x ^ (x >> np.uint32(16))) * (1.0 / 0xFFFFFFFF)).astype(np.float32)
