"""Grids in place of trees: for which geometries, and their GPU records."""

import numpy as np

from . import data_texture, grid, layout, reference
from .leaves import INTERSECTION_COST, MANY

_SPHERE, _CYLINDER = (layout.KINDS.index(kind) for kind in ("sphere", "cylinder"))
#: Share of a quickly built tree's cost up to which a grid takes the place of a good one: at 0.7 both take as long.
_WORTH = 0.6
#: Indices that an item can refer to.
_INDICES = 1 << (reference.LOW_BITS - 1)


def may_have_grid(parts):
    """Whether there can be a grid of primitives, `parts` by kind number."""
    return parts.keys() <= {_SPHERE, _CYLINDER} and sum(map(len, parts.values())) < MANY


def better_grid(hits, bases, tree_cost):
    """The `grid.Grid` of a geometry that may have one, where rays are through it sooner than through its tree; or None.

    `hits`: arrays of its primitives' first records, by kind number: what is in a cell is told from the very numbers
    that the shader has. `bases`: index of the first of each kind; `tree_cost`: of a tree that was built quickly.
    """
    if any(bases[kind] + len(records) > _INDICES for kind, records in hits.items()):
        return None
    base, axis, height, radius = _capsules(hits)
    return grid.build(base, height[:, None] * axis, radius, _test_cost(hits), _WORTH * tree_cost)


def cost(made, hits):
    """The cost of a `grid.Grid`, to be compared with that of a tree."""
    return made.cost(_test_cost(hits))


def _test_cost(hits):
    return float(max(INTERSECTION_COST[kind] for kind in hits))


def room(made):
    """Nodes that would have room in place of a grid."""
    return int(_ends(made)[-1]) // layout.NODE.texels


def write_grid(texels, made, hits, bases):
    """Write a grid into the texels (n, 4) of `room(made)` nodes; `hits` and `bases` as for `better_grid`."""
    head, cells, items, references = (
        data_texture.records_of(part, record)[:count]
        for part, (record, count) in zip(np.split(texels, _ends(made)[:-1]), _parts(made), strict=True)
    )
    _write_head(head, made)
    _write_cells(cells, made)
    base, axis, height, radius = _capsules(hits)
    items["base"], items["axis"] = base[made.items], axis[made.items]
    items["height"], items["radius"] = height[made.items], radius[made.items]
    numbers = [2 * (bases[kind] + np.arange(len(part))) + (kind == _CYLINDER) for kind, part in hits.items()]
    references["reference"] = np.concatenate(numbers)[made.items]


def _parts(made):
    """(record, how many) of what a grid is made of, in this order."""
    around = int((made.resolution + 2).prod())
    items = len(made.items)
    return (layout.GRID, 1), (layout.GRID_CELL, around), (layout.GRID_ITEM, items), (layout.GRID_REFERENCE, items)


def _ends(made):
    """Texels up to the end of each of these; they begin where nodes may."""
    texels = np.array([count * record.texels for record, count in _parts(made)])
    return np.cumsum(-(-texels // layout.NODE.texels)) * layout.NODE.texels


def _write_head(record, made):
    row, depth, _ = made.resolution + 2
    head, cells, items, _ = _ends(made)
    record["lower"], record["per_size"], record["resolution"] = made.lower, 1.0 / made.size, made.resolution
    record["row"], record["layer"] = row, row * depth
    record["first_item"] = (cells - head) // layout.GRID_ITEM.texels
    record["first_reference"] = items - head


def _write_cells(records, made):
    """The cells, and around them others where rays end."""
    records["first"], records["end"] = 1, 0
    within = records.reshape(made.resolution[::-1] + 2)[1:-1, 1:-1, 1:-1]
    within["first"] = made.first[:-1].reshape(within.shape)
    within["end"] = made.first[1:].reshape(within.shape)


def _capsules(hits):
    """Bases (n, 3), unit axes (n, 3), heights (n,) and radii (n,) of spheres and cylinders from their records."""
    found = []
    for kind, part in hits.items():
        if kind == _SPHERE:
            found.append((part["center"], np.zeros((len(part), 3)), np.zeros(len(part)), part["radius"]))
        else:
            height = np.linalg.norm(part["axis"].astype(np.float64), axis=-1)
            axis = part["axis"] / np.maximum(height, np.finfo(np.float32).tiny)[:, None]
            found.append((part["base"], axis, height, part["radius"]))
    return tuple(np.concatenate(values) for values in zip(*found, strict=True))
