"""A geometry's tree and the GPU records that its leaves point to."""

from dataclasses import dataclass

import numpy as np

from . import bvh, layout
from .errors import SceneError
from .primitives import Similarity

#: How much larger boxes are stored than they are, relative to the largest of their coordinates: what the intersection
#: with a primitive rounds by. The shader adds the same for the ray's origin.
_BOX_PADDING = 2.0**-21
_BOX_PADDING_ABSOLUTE = 1e-20


@dataclass(frozen=True)
class PackedTree:
    """A geometry's tree and its primitives' records in the order of the leaves, by label."""

    tree: bvh.Bvh
    records: dict
    slots: int  # one more than the largest material slot used


def build_tree(geometry, origin):
    """The tree of a geometry; `origin` is subtracted first where its space is the world's."""
    parts = dict(geometry.kinds())
    if origin is not None and origin.any():
        move = Similarity(np.eye(3), 1.0, -origin)
        parts = {label: part.transformed(move) for label, part in parts.items()}
    boxes = [part.bounds() for part in parts.values()]
    lower = np.concatenate([lower for lower, _ in boxes])
    upper = np.concatenate([upper for _, upper in boxes])
    labels = np.repeat(list(parts), [len(part) for part in parts.values()])
    try:
        tree = bvh.build(lower, upper, labels)
    except ValueError as error:
        raise SceneError(f"geometry {geometry.name!r}: {error}") from error
    records, start = {}, 0
    for label, part in parts.items():
        rows = tree.order[tree.run[label] : tree.run[label + 1]] - start
        records[label] = part.take(rows).records()
        start += len(part)
    for part in parts.values():
        if part.material.min() < 0:
            raise SceneError(f"geometry {geometry.name!r}: a {part.kind} uses material slot {int(part.material.min())}")
    return PackedTree(tree, records, 1 + max(int(part.material.max()) for part in parts.values()))


def node_records(tree, node_start, primitive_starts, kinds):
    """GPU nodes of a tree whose nodes begin at `node_start`. By label: where its primitives begin, which kind it is."""
    label = np.maximum(tree.label, 0)
    first = np.where(tree.is_leaf, tree.child + primitive_starts[label], np.maximum(tree.child, 0) + node_start)
    low, high = layout.split_index(first)
    leaf = layout.pack_leaf(np.where(tree.is_leaf, kinds[label], 0), tree.count, high)
    boxes = tree.boxes.astype(np.float64)
    padding = np.abs(boxes).max(axis=(2, 3))[:, :, None] * _BOX_PADDING + _BOX_PADDING_ABSOLUTE
    lower = np.maximum(boxes[:, :, 0] - padding, -bvh.FAR)
    upper = np.minimum(boxes[:, :, 1] + padding, bvh.FAR)
    empty = ~tree.is_leaf & ~tree.is_inner
    lower[empty] = upper[empty] = bvh.FAR
    records = layout.NODE.zeros(len(tree))
    for child in (0, 1):
        records[f"lower_{child}"], records[f"upper_{child}"] = lower[:, child], upper[:, child]
        records[f"first_{child}"], records[f"leaf_{child}"] = low[:, child], leaf[:, child]
    return records


def moved_boxes(bounds, matrices):
    """Boxes (n, 2, 3) under affine matrices (n, 4, 4): lower and upper corners (n, 3). (Arvo 1990, Graphics Gems.)"""
    center = bounds.mean(axis=1)
    half = (bounds[:, 1] - bounds[:, 0]) / 2.0
    moved = np.einsum("nij,nj->ni", matrices[:, :3, :3], center) + matrices[:, :3, 3]
    reach = np.einsum("nij,nj->ni", np.abs(matrices[:, :3, :3]), half)
    return moved - reach, moved + reach
