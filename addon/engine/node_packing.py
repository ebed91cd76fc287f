"""The GPU records of the nodes of trees."""

import numpy as np

from . import bvh, reference
from .threads import each_piece, pieces

#: How much larger boxes are stored than they are, relative to the largest of their coordinates: what the intersection
#: with a primitive rounds by. The shader adds the same for the ray's origin.
_BOX_PADDING = 2.0**-21
_BOX_PADDING_ABSOLUTE = 1e-20


def write_nodes(records, tree, node_start, primitive_starts, kinds):
    """Write a tree whose nodes begin at `node_start` into `records` (n,). By label: where its primitives begin, which
    kind it is."""

    def write(rows):
        _write_nodes(records[rows], tree, rows, node_start, primitive_starts, kinds)

    each_piece(write, len(tree))


def move_nodes(records, offset):
    """Let nodes (n,) of `layout.NODE` that lie `offset` further on find each other there."""
    for rows in pieces(len(records)):
        piece = records[rows]
        for child in (0, 1):
            _, count, high = reference.unpack_leaf(piece[f"leaf_{child}"])
            inner = count == 0
            low, high = reference.split_index(
                piece[f"first_{child}"].astype(np.int64) + (high << reference.LOW_BITS) + offset
            )
            piece[f"first_{child}"][inner] = low[inner]
            piece[f"leaf_{child}"][inner] = reference.pack_leaf(0, 0, high)[inner]


def _write_nodes(records, tree, rows, node_start, primitive_starts, kinds):
    child, count, label = tree.child[rows], tree.count[rows], np.maximum(tree.label[rows], 0)
    is_leaf, empty = count > 0, (count == 0) & (child < 0)
    low, high = reference.split_index(
        np.where(is_leaf, child + primitive_starts[label], np.maximum(child, 0) + node_start)
    )
    leaf = reference.pack_leaf(np.where(is_leaf, kinds[label], 0), count, high)
    boxes = tree.boxes[rows].astype(np.float64)
    padding = np.abs(boxes).max(axis=(2, 3))[:, :, None] * _BOX_PADDING + _BOX_PADDING_ABSOLUTE
    lower = np.maximum(boxes[:, :, 0] - padding, -bvh.FAR)
    upper = np.minimum(boxes[:, :, 1] + padding, bvh.FAR)
    lower[empty] = upper[empty] = bvh.FAR
    for c in (0, 1):
        records[f"lower_{c}"], records[f"upper_{c}"] = lower[:, c], upper[:, c]
        records[f"first_{c}"], records[f"leaf_{c}"] = low[:, c], leaf[:, c]
