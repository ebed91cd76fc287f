"""Boxes of primitives of several kinds, moved, a piece at a time: see `bvh`, which knows boxes alone."""

import numpy as np

from . import bvh
from .threads import each_piece


def labels(parts):
    """(n,) int32 kind numbers of the primitives of all `parts`, by kind number."""
    return np.repeat(np.array(list(parts), np.int32), [len(part) for part in parts.values()])


def moved(primitives, move):
    """Primitives after a `Similarity`, None for none."""
    return primitives.transformed(move) if move else primitives


def each_moved(parts, move, write):
    """Call `write(piece, rows)` for all primitives of several kinds, moved, a piece at a time; `rows`: a slice, which
    of all they are."""
    start = 0
    for part in parts:

        def write_piece(rows, part=part, start=start):
            write(moved(part.take(rows), move), slice(start + rows.start, start + rows.stop))

        each_piece(write_piece, len(part))
        start += len(part)


def bounds(parts, move):
    """Boxes of all rows of several kinds: lower and upper (n, 3) float32, rounded outwards."""
    lower, upper = np.empty((2, sum(map(len, parts)), 3), np.float32)

    def write(piece, rows):
        lower[rows], upper[rows] = bvh.rounded_outward(*piece.bounds())

    each_moved(parts, move, write)
    return lower, upper


def spans(parts, move):
    """(6, n) float32 spans of these boxes, as `bvh.Form` takes them."""
    found = np.empty((6, sum(map(len, parts))), np.float32)
    each_moved(parts, move, lambda piece, rows: fill_spans(piece, found[:, rows]))
    return found


def fill_spans(piece, spans):
    """Write the `spans` (6, n) of the boxes of primitives."""
    lower, upper = bvh.rounded_outward(*piece.bounds())
    np.negative(lower.T, out=spans[:3])
    spans[3:] = upper.T
