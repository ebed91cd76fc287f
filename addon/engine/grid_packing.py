"""Grids in place of trees: for which geometries, and their GPU records."""

import numpy as np

from . import grid, layout
from .leaves import INTERSECTION_COST, MANY

_SPHERE, _CYLINDER = (layout.KINDS.index(kind) for kind in ("sphere", "cylinder"))
#: A node takes as much room as so many cells or items.
_CELLS, _ITEMS = (layout.NODE.texels // record.texels for record in (layout.GRID_CELL, layout.GRID_ITEM))
#: Share of a tree's cost up to which a grid takes its place: at 0.8 both take the same time.
_WORTH = 0.7
#: Indices that an item can refer to.
_MOST = 1 << layout.LOW_BITS - 1


def better_grid(hits, bases, tree_cost):
    """The `grid.Grid` of a geometry where rays are through it sooner than through its tree of this cost, else None.

    `hits`: arrays of its primitives' first records, by kind number; `bases`: index of the first of each kind.
    """
    count = sum(map(len, hits.values()))
    if not hits.keys() <= {_SPHERE, _CYLINDER} or count >= MANY:
        return None
    if any(bases[kind] + len(records) > _MOST for kind, records in hits.items()):
        return None
    made = grid.build(*_capsules(hits))
    return made if made and cost(made, hits) < _WORTH * tree_cost else None


def cost(made, hits):
    """The cost of a `grid.Grid`, to be compared with that of a tree."""
    return made.cost(max(INTERSECTION_COST[kind] for kind in hits))


def room(made):
    """Nodes that would have room in place of a grid."""
    return 1 + -(-_cells_around(made) // _CELLS) + -(-len(made.items) // _ITEMS)


def write_grid(texels, made, hits, bases):
    """Write a grid into the texels (n, 4) of `room(made)` nodes; `hits` and `bases` as for `better_grid`."""
    cell_texels = -(-_cells_around(made) // _CELLS) * layout.NODE.texels
    head, cells, items = np.split(texels, [layout.NODE.texels, layout.NODE.texels + cell_texels])
    _write_head(layout.records_of(head, layout.GRID)[0:1], made, cell_texels // layout.GRID_ITEM.texels)
    _write_cells(layout.records_of(cells, layout.GRID_CELL)[: _cells_around(made)], made)
    _write_items(layout.records_of(items, layout.GRID_ITEM)[: len(made.items)], made, hits, bases)


def _write_head(record, made, first_item):
    row, depth, _ = made.resolution + 2
    record["lower"], record["per_size"], record["resolution"] = made.lower, 1.0 / made.size, made.resolution
    record["row"], record["layer"], record["first_item"] = row, row * depth, first_item


def _write_cells(records, made):
    """The cells, and around them others where rays end."""
    records["first"], records["end"] = 1, 0
    within = records.reshape(made.resolution[::-1] + 2)[1:-1, 1:-1, 1:-1]
    within["first"] = made.first[:-1].reshape(within.shape)
    within["end"] = made.first[1:].reshape(within.shape)


def _write_items(records, made, hits, bases):
    base, axis, radius = _capsules(hits)
    records["base"], records["axis"], records["radius"] = base[made.items], axis[made.items], radius[made.items]
    references = [2 * (bases[kind] + np.arange(len(part))) + (kind == _CYLINDER) for kind, part in hits.items()]
    records["reference"] = np.concatenate(references)[made.items]


def _capsules(hits):
    """Bases (n, 3), axes (n, 3) and radii (n,) of spheres and cylinders from their records."""
    parts = [
        (part["center"], np.zeros((len(part), 3), np.float32), part["radius"])
        if kind == _SPHERE
        else (part["base"], part["axis"], part["radius"])
        for kind, part in hits.items()
    ]
    return tuple(np.concatenate(values) for values in zip(*parts, strict=True))


def _cells_around(made):
    """Number of the cells with those around them."""
    return int((made.resolution + 2).prod())
