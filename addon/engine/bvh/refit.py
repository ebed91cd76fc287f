"""New boxes for an old hierarchy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .boxes import checked_boxes
from .form import Slots
from .tree import Bvh


def refit(bvh: Bvh, lo: np.ndarray, hi: np.ndarray) -> Bvh:
    """The same hierarchy around moved primitives.

    Args:
        lo, hi: (n, 3) float32 or float64, for the same n primitives in the same order that `bvh` was built
            from.

    Raises:
        ValueError: another number of boxes, or a box that `build` would refuse.
    """
    lo, hi = checked_boxes(lo, hi)
    if len(lo) != len(bvh.order):
        raise ValueError(f"refit: the hierarchy holds {len(bvh.order)} primitives, but {len(lo)} boxes were given")
    return put_around(bvh, lo, hi)


def put_around(bvh: Bvh, lo: np.ndarray, hi: np.ndarray, roots: np.ndarray | None = None) -> Bvh:
    """A hierarchy without boxes, or all of those with `roots`, around the (n, 3) float32 boxes."""

    def span(row):  # one at a time: all take much memory
        corner = np.ascontiguousarray((lo if row < 3 else hi)[:, row % 3])
        corner = np.take(corner, bvh.order, mode="clip")
        return np.negative(corner, out=corner) if row < 3 else corner

    return replace(bvh, boxes=Slots(bvh, roots).boxes(span))
