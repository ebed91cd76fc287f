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
#: Cells along an axis below and above which no grid is made: through what is flat a tree is as fast, and rays' work is
#: bounded.
LEAST_CELLS, MOST_CELLS = 4, 512
#: Beyond so many for each shape likewise: cells that it is in, and that its box is in; about the least share of these.
MOST_ITEMS = 12
_MOST_PAIRS = 24
_LEAST_SHARE = 0.3
#: Items in one cell, likewise: a few of many shapes may be close together, and looked at.
MOST_IN_CELL = 32
#: How far beyond its surface a shape is found, in cells: a ray's steps are rounded by less.
PADDING = 1.0 / 64.0
#: Shapes that are worked on at a time: what is made of them stays in the processor's cache.
_ROWS = 1 << 12
#: Turns in search of the nearest points of a segment and a cell.
_TURNS = 5
#: A step from a cell to the next, in units of a tree's node; the test of a cylinder beside that of a step.
STEP_COST = 0.4
_CYLINDER_STEPS = 2.0
#: Finer cells, up to so many times along an axis, are taken where they cost no more than this share.
_FINEST, _WORTH_IT = 1.25, 0.95
#: Shapes by which that is told.
_LOOKED_AT = 1 << 8


@dataclass(frozen=True, eq=False)
class Cells:
    """Cells of one size, in x first.

    Attributes:
        lower: (3,) float64, the lower corner of the first cell. float32 holds it.
        size: (3,) float64, of a cell. float32 holds 1 / size.
        resolution: (3,) int64, cells along each axis.
    """

    lower: np.ndarray
    size: np.ndarray
    resolution: np.ndarray

    def cost_of(self, items: float, test_cost: float) -> float:
        """What `bvh.sah_cost` is of a tree, with so many items in all cells: a line through the box meets a cell as
        likely as their surfaces say."""
        (x, y, z), (width, depth, height) = self.size, self.size * self.resolution
        share = (x * y + z * (x + y)) / (width * depth + height * (width + depth))
        return float(share * (STEP_COST * self.resolution.prod() + test_cost * items))

    def around(self, lower: np.ndarray, upper: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Of boxes (3, n): the first cells that they are in, and in how many cells, (3, n) int32 along each axis."""
        padding, corner, size = PADDING * self.size[:, None], self.lower[:, None], self.size[:, None]
        low, high = (
            np.clip((corners - corner) / size, 0, self.resolution[:, None] - 1).astype(np.int32)
            for corners in (lower - padding, upper + padding)
        )
        return low, high - low + 1


@dataclass(frozen=True, eq=False)
class Grid(Cells):
    """Cells, and what is in them.

    Attributes:
        first: (cells + 1,) int64. Cell c holds `items[first[c]:first[c + 1]]`.
        items: (m,) int64 numbers of shapes, each in every cell that it reaches.
    """

    first: np.ndarray
    items: np.ndarray

    def cost(self, test_cost: float) -> float:
        """What `bvh.sah_cost` is of a tree."""
        return self.cost_of(len(self.items), test_cost)


def build(base: np.ndarray, axis: np.ndarray, radius: np.ndarray, test_cost: float, most_cost: float) -> Grid | None:
    """The grid over n > 0 capsules: (n, 3) their ends and the way to the other ends, 0 for spheres; (n,) radii of any
    sign. `test_cost`: of testing one of them, in units of a tree's node.

    None where it would cost more than `most_cost`, where cells would be crowded, and of what is flat.
    """
    base, axis = (np.ascontiguousarray(np.asarray(values, np.float64).T) for values in (base, axis))
    radius = np.abs(np.asarray(radius, np.float64))
    boxes = np.minimum(base, base + axis) - radius, np.maximum(base, base + axis) + radius
    bounds = boxes[0].min(axis=1), boxes[1].max(axis=1)
    extent = bounds[1] - bounds[0]
    if not (extent > 0.0).all():  # so far from the origin that radii are lost
        return None
    resolution = np.rint(extent * np.cbrt(DENSITY * len(radius) / extent.prod()))
    if resolution.min() < LEAST_CELLS or resolution.max() > MOST_CELLS:
        return None
    cells = _cells(*bounds, resolution)
    pairs = cells.around(*boxes)[1].prod(axis=0, dtype=np.int64).sum()
    if pairs > _MOST_PAIRS * len(radius) or cells.cost_of(_LEAST_SHARE * pairs, test_cost) > most_cost:
        return None
    finer = _finer(cells, bounds, base, axis, radius, boxes)
    for each in filter(None, (finer, cells)):
        grid = _filled(each, base, axis, radius, boxes)
        if grid and grid.cost(test_cost) <= most_cost:
            return grid
    return None


def _cells(lower, upper, resolution):
    """`Cells` of a `resolution` (3,) to be rounded around the bounds (3,) of all shapes, whose padding included."""
    resolution = np.rint(resolution).astype(np.int64)
    start = _stored(lower - PADDING * (upper - lower) / resolution)
    size = 1.0 / _stored(resolution / (upper - start) / (1.0 + PADDING / resolution))
    return Cells(start, size, resolution)


def _finer(cells, bounds, base, axis, radius, boxes):
    """The best of some finer `Cells`, or None where these save nothing to speak of: in lattices planes of shapes may
    fall on borders of cells or between them. Told from some of the shapes."""
    count = len(radius)
    some = np.random.default_rng(0).permutation(len(radius))[:_LOOKED_AT]
    base, axis, radius, boxes = base[:, some], axis[:, some], radius[some], [corners[:, some] for corners in boxes]
    test_cost = (_CYLINDER_STEPS if axis.any() else 1.0) * STEP_COST

    def cost(cells):
        _, shapes = _items(base, axis, radius, *cells.around(*boxes), cells)
        items = len(shapes) / len(some) * count
        return cells.cost_of(items, test_cost) if items <= MOST_ITEMS * count else np.inf

    most = cells.resolution.max()
    shares = np.arange(most + 1, min(int(_FINEST * most), MOST_CELLS) + 1) / most
    finer = min((_cells(*bounds, share * cells.resolution) for share in shares), key=cost, default=None)
    return finer if finer and cost(finer) < _WORTH_IT * cost(cells) else None


def _filled(cells, base, axis, radius, boxes):
    """The `Grid` of cells with what is in them; None where they are crowded."""
    low, spans = cells.around(*boxes)
    found = []
    for first in range(0, len(radius), _ROWS):
        rows = slice(first, first + _ROWS)
        cell, shape = _items(base[:, rows], axis[:, rows], radius[rows], low[:, rows], spans[:, rows], cells)
        found.append((cell, shape + first))
    cell, shape = (np.concatenate(numbers) for numbers in zip(*found, strict=True))
    if len(cell) > MOST_ITEMS * len(radius):
        return None
    counts = np.bincount(cell, minlength=cells.resolution.prod())
    if counts.max() > MOST_IN_CELL:
        return None
    first = np.concatenate([[0], np.cumsum(counts)])
    return Grid(cells.lower, cells.size, cells.resolution, first, shape[np.argsort(cell, kind="stable")])


def _stored(values):
    """(3,) float64: numbers that float32 holds, as the shader has them; none is larger than it was."""
    return np.nextafter(values.astype(np.float32), -np.float32(np.inf)).astype(np.float64)


def _items(base, axis, radius, low, spans, cells):
    """(m,) int32 cells and (m,) int32 shapes, for each cell that a capsule reaches; what it is given in columns, `low`
    and `spans` as `Cells.around` tells them."""
    counts = spans.prod(axis=0)
    shape = np.repeat(np.arange(len(radius), dtype=np.int32), counts)
    rest = np.arange(len(shape), dtype=np.int32) - np.repeat(np.cumsum(counts, dtype=np.int32) - counts, counts)
    place = np.empty((3, len(shape)), np.int32)
    rest, place[0] = np.divmod(rest, spans[0, shape])
    place[2], place[1] = np.divmod(rest, spans[1, shape])
    place += low[:, shape]
    center = cells.lower[:, None] + cells.size[:, None] * (place + 0.5)
    padded = radius[shape] + PADDING * cells.size.max()
    reaches = _reaches(base[:, shape], axis[:, shape], padded, center, 0.5 * cells.size[:, None])
    x, y, z = place[:, reaches]
    width, depth, _ = cells.resolution.tolist()
    return x + width * (y + depth * z), shape[reaches]


def _reaches(base, axis, radius, center, half):
    """(m,) bool: whether capsules come into cells. A few that miss one by little count, too.

    Nearest points of a segment and a cell are found by going to and fro between both. A capsule misses a cell when a
    plane across the line between them lies between both: that holds for any line, the nearer the better.
    """
    squared = _dot(axis, axis)
    if not squared.any():
        return _dot(*2 * [np.maximum(np.abs(base - center) - half, 0.0)]) <= radius * radius
    per_squared = 1.0 / np.where(squared > 0.0, squared, np.inf)
    offset = base - center  # positions relative to the middle of the cell
    point = np.zeros_like(offset)
    for _ in range(_TURNS):
        along = np.clip(_dot(point - offset, axis) * per_squared, 0.0, 1.0)
        middle = offset + along * axis
        point = np.clip(middle, -half, half)
    away = middle - point
    apart = _dot(away, offset) + np.minimum(_dot(away, axis), 0.0) - _dot(np.abs(away), half)
    return apart <= radius * np.sqrt(_dot(away, away))


def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
