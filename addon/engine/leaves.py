"""What the leaves of trees hold, and what stands outside of trees."""

import numpy as np

from . import layout, reference
from .primitives import BY_KIND

#: Most primitives in a leaf.
_SIZE = 8
#: Cylinders and cones stand alone in their leaves, and so do spheres beside them: one test serves all three, without a
#: loop, which vector processors leave only when the fullest of their leaves is done.
QUADRICS = np.isin(layout.KINDS[: len(BY_KIND)], ("cylinder", "cone"))
ROUND = QUADRICS | np.isin(layout.KINDS[: len(BY_KIND)], "sphere")
#: From so many primitives in a geometry on memory counts more than a little time.
MANY = 1 << 17

INTERSECTION_COST = np.array([cls.intersection_cost for cls in BY_KIND], np.float32)
_INTERSECTION_COST_OF_MANY = np.array([cls.intersection_cost_of_many for cls in BY_KIND], np.float32)


def sizes(counts):
    """`leaf_size` (K,) of `bvh.build` for geometries with (K,) primitives by kind in all."""
    return np.where(ROUND & counts[QUADRICS].any(), 1, _SIZE)


def costs(counts):
    """`intersection_cost` (K,) of `bvh.build`, likewise."""
    return _INTERSECTION_COST_OF_MANY if counts.sum() >= MANY else INTERSECTION_COST


def places_outside(plan, bases):
    """Members of the uniform block that say where the primitives lie that stand outside of the trees; `bases` (K,):
    index of the first record of each kind of the world's shapes."""
    low, high = reference.split_index(bases)
    rows = np.stack([low, high, np.where(plan.outside, plan.counts[0], 0)], axis=1)
    return {f"outside_{cls.kind}": row for cls, row in zip(BY_KIND, rows, strict=True)}
