"""A uniform grid over spheres and cylinders that crowd evenly: what a ray may meet is in the cells on its way.

Where shapes of like size fill a volume, as atoms do, a tree takes many nodes to find out what is near; a step from a
cell to the next costs a fraction of a node and needs no stack (Amanatides and Woo 1987, A fast voxel traversal
algorithm). Where they do not, most cells are empty or a few are full: `cost` tells.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: Cells for each shape. Between 2 and 8 the time hardly changes, the memory does.
DENSITY = 4.0
#: How far beyond its surface a shape is found, in cells: a ray's steps are rounded by less.
PADDING = 1.0 / 64.0
#: Pairs of a shape and a cell of its box, for each shape, beyond which no grid is made.
MOST_PAIRS = 32
#: Turns in search of the nearest points of a segment and a cell.
_TURNS = 5
#: A step from a cell to the next, in units of a tree's node.
STEP_COST = 0.4


@dataclass(frozen=True, eq=False)
class Grid:
    """Cells of one size, in x first, and what is in them.

    Attributes:
        lower: (3,) float64, the lower corner of the first cell.
        size: (3,) float64, of a cell.
        resolution: (3,) int64, cells along each axis.
        first: (cells + 1,) int64. Cell c holds `items[first[c]:first[c + 1]]`.
        items: (m,) int64 numbers of shapes, each in every cell that it reaches.
    """

    lower: np.ndarray
    size: np.ndarray
    resolution: np.ndarray
    first: np.ndarray
    items: np.ndarray

    def cost(self, intersection_cost: float) -> float:
        """What `bvh.sah_cost` is of a tree: a line through the box meets a cell as likely as their surfaces say."""
        x, y, z = self.size
        width, depth, height = self.size * self.resolution
        share = (x * y + z * (x + y)) / (width * depth + height * (width + depth))
        return float(share * (STEP_COST * self.resolution.prod() + intersection_cost * len(self.items)))


def build(base: np.ndarray, axis: np.ndarray, radius: np.ndarray) -> Grid | None:
    """The grid over n > 0 capsules: (n, 3) their ends and the way to the other ends, 0 for spheres; (n,) radii of any
    sign.

    None where their sizes differ so much that cells would be crowded.
    """
    base, axis, radius = (np.asarray(values, np.float64) for values in (base, axis, np.abs(radius)))
    lower = np.minimum(base, base + axis) - radius[:, None]
    upper = np.maximum(base, base + axis) + radius[:, None]
    start, extent = lower.min(axis=0), np.ptp(np.concatenate([lower, upper]), axis=0)
    cell = np.cbrt(extent.prod() / (DENSITY * len(base)))
    resolution = np.maximum(np.rint(extent / cell), 1.0).astype(np.int64) if cell > 0.0 else np.ones(3, np.int64)
    size = extent * (1.0 + 2.0 * PADDING / resolution) / resolution
    start = start - 0.5 * (size * resolution - extent)
    low = _cells(lower - PADDING * size, start, size, resolution)
    spans = _cells(upper + PADDING * size, start, size, resolution) - low + 1
    if spans.prod(axis=1).sum() > MOST_PAIRS * len(base):
        return None
    shape, place = _pairs(low, spans)
    reaches = _reaches(base[shape], axis[shape], radius[shape] + PADDING * size.max(), start + place * size, size)
    shape, place = shape[reaches], place[reaches]
    number = place[:, 0] + resolution[0] * (place[:, 1] + resolution[1] * place[:, 2])
    first = np.concatenate([[0], np.cumsum(np.bincount(number, minlength=resolution.prod()))])
    return Grid(start, size, resolution, first, shape[np.argsort(number, kind="stable")])


def _cells(points, start, size, resolution):
    """(n, 3) int64: the cells that points are in."""
    return np.clip(np.floor((points - start) / size), 0, resolution - 1).astype(np.int64)


def _pairs(low, spans):
    """(m,) number of a shape and (m, 3) cell, for all cells of each shape's box of `spans` (n, 3) cells from `low`."""
    counts = spans.prod(axis=1)
    shape = np.repeat(np.arange(len(low)), counts)
    rest = np.arange(len(shape)) - np.repeat(np.cumsum(counts) - counts, counts)
    place, span = np.empty((len(shape), 3), np.int64), spans[shape]
    rest, place[:, 0] = np.divmod(rest, span[:, 0])
    place[:, 2], place[:, 1] = np.divmod(rest, span[:, 1])
    return shape, place + low[shape]


def _reaches(base, axis, radius, corner, size):
    """(m,) bool: whether capsules come into cells. A few that miss one by little count, too.

    Nearest points of a segment and a cell are found by going to and fro between both. A capsule misses a cell when a
    plane across the line between them lies between both: that holds for any line, the nearer the better.
    """
    squared = np.einsum("ij,ij->i", axis, axis)
    per_squared = 1.0 / np.where(squared > 0.0, squared, np.inf)
    center = corner + 0.5 * size
    point = center
    for _ in range(_TURNS):
        along = np.clip(np.einsum("ij,ij->i", point - base, axis) * per_squared, 0.0, 1.0)
        middle = base + along[:, None] * axis
        point = np.clip(middle, corner, corner + size)
    away = middle - point
    apart = np.minimum(np.einsum("ij,ij->i", away, base - center), np.einsum("ij,ij->i", away, base + axis - center))
    apart -= 0.5 * np.abs(away) @ size
    return apart <= radius * np.sqrt(np.einsum("ij,ij->i", away, away))
