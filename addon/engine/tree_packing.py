"""Geometries' trees, and the GPU records that their leaves point to.

What is large goes a piece at a time from the scene's own arrays into the arrays that are uploaded: nothing the size of
the scene is held in between, whatever the precision of the arithmetic.
"""

from dataclasses import dataclass

import numpy as np

from . import bvh, layout
from .errors import SceneError
from .primitives import BY_KIND, Similarity
from .timing import timed

#: How much larger boxes are stored than they are, relative to the largest of their coordinates: what the intersection
#: with a primitive rounds by. The shader adds the same for the ray's origin.
_BOX_PADDING = 2.0**-21
_BOX_PADDING_ABSOLUTE = 1e-20

#: Most primitives in a leaf, and what testing one costs; see `bvh.build`.
_LEAF_SIZE = 8
_INTERSECTION_COST = np.array([cls.intersection_cost for cls in BY_KIND], np.float32)

#: Rows worked on at a time: their temporary arrays stay in the processor's cache.
_PIECE = 1 << 15


@dataclass(frozen=True)
class BuiltTree:
    """What is left of a tree when it has been packed. `bounds` (2, 3) of everything, `root` the index of its node."""

    bounds: np.ndarray
    root: int
    nodes: int
    depth: int
    sah_cost: float


class TreePacker:
    """Builds the trees of the geometries of a plan and fills the textures of their records.

    `textures`: by name, float32 (height, width, 4); those of the nodes come with `nodes`. `seconds`: by stage.
    """

    def __init__(self, plan, origin):
        self.plan, self.seconds, self.trees = plan, {}, {}
        self._move = Similarity(np.eye(3), 1.0, -origin) if origin.any() else None
        self._nodes, self._next = [], plan.top_nodes
        self.textures = {}
        for cls, count in zip(BY_KIND, plan.counts.sum(axis=0).tolist(), strict=True):
            for record in (cls.record, cls.surface_record) if count else ():
                self.textures[record.texture] = layout.data_texture(count * record.texels)

    def add(self, number, attribute_texels):
        """Build the tree of a geometry and write its records, and its attributes into `attribute_texels` (n, 4)."""
        geometry = self.plan.geometries[number]
        parts = dict(geometry.kinds())
        move = self._move if self.plan.in_world[number] else None
        with timed(self.seconds, "bounds"):
            lower, upper = _bounds(parts.values(), move)
            labels = np.repeat(np.array(list(parts), np.int32), [len(part) for part in parts.values()])
        with timed(self.seconds, "tree"):
            try:
                tree = bvh.build(lower, upper, labels, leaf_size=_LEAF_SIZE, intersection_cost=_INTERSECTION_COST)
            except ValueError as error:
                raise SceneError(f"geometry {geometry.name!r}: {error}") from error
            del lower, upper, labels
        with timed(self.seconds, "records"):
            start = 0
            for label, part in parts.items():
                order = tree.order[tree.run[label] : tree.run[label + 1]] - start
                self._write_records(self.plan.bases[number, label], part, order, move)
                self._write_attributes((number, label), part, order, attribute_texels)
                start += len(part)
            self._add_nodes(number, tree)

    def _write_records(self, base, part, order, move):
        """The rows `order` of `part`, in that order, from record `base` on."""
        hits = layout.records_of(self.textures[part.record.texture], part.record)[base:]
        surfaces = layout.records_of(self.textures[part.surface_record.texture], part.surface_record)[base:]
        for rows in pieces(len(order)):
            piece = part.take(order[rows])
            hits[rows], surfaces[rows] = (piece.transformed(move) if move else piece).records()

    def _write_attributes(self, place, part, order, texels):
        for name in self.plan.attributes.names:
            first = self.plan.attributes.first.get((name, *place))
            if first is not None:
                values = part.attributes[name]
                target = texels[first : first + values.shape[0] * values.shape[1]].reshape(-1, values.shape[1], 4)
                for rows in pieces(len(order)):
                    target[rows] = values[order[rows]]

    def _add_nodes(self, number, tree):
        nodes = layout.NODE.zeros(len(tree))
        write_nodes(nodes, tree, self._next, self.plan.bases[number], np.arange(len(BY_KIND)))
        self._nodes.append(nodes)
        # The cost of all trees would take its time where geometries are many; that of the largest says most.
        cost = bvh.sah_cost(tree, intersection_cost=_INTERSECTION_COST) if number == self.plan.largest else 0.0
        self.trees[number] = BuiltTree(tree.bounds, self._next, len(tree), tree.depth, cost)
        self._next += len(tree)

    def finish(self, top):
        """Make the texture of all nodes, those of the upper tree `top` (None: there is none) first."""
        texture = layout.data_texture(max(self._next, 1) * layout.NODE.texels)
        nodes = layout.records_of(texture, layout.NODE)
        start = self.plan.top_nodes
        if top is not None:
            kind = np.array([layout.KINDS.index("instance")])
            write_nodes(nodes[:start], top, 0, np.zeros(1, np.int64), kind)
        while self._nodes:
            part = self._nodes.pop(0)
            nodes[start : start + len(part)] = part
            start += len(part)
        self.textures["nodes"] = texture


def pieces(count):
    """Slices that cover `count` rows."""
    return (slice(start, min(start + _PIECE, count)) for start in range(0, count, _PIECE))


def _bounds(parts, move):
    """Boxes of all rows of several kinds: lower and upper (n, 3) float32, rounded outwards."""
    count = sum(map(len, parts))
    lower, upper = np.empty((count, 3), np.float32), np.empty((count, 3), np.float32)
    start = 0
    for part in parts:
        for rows in pieces(len(part)):
            piece = part.take(rows)
            low, high = (piece.transformed(move) if move else piece).bounds()
            into = slice(start + rows.start, start + rows.stop)
            lower[into], upper[into] = bvh.rounded_outward(low, high)
        start += len(part)
    return lower, upper


def write_nodes(records, tree, node_start, primitive_starts, kinds):
    """Write a tree whose nodes begin at `node_start` into `records` (n,). By label: where its primitives begin, which
    kind it is."""
    for rows in pieces(len(tree)):
        _write_nodes(records[rows], tree, rows, node_start, primitive_starts, kinds)


def _write_nodes(records, tree, rows, node_start, primitive_starts, kinds):
    child, count, label = tree.child[rows], tree.count[rows], np.maximum(tree.label[rows], 0)
    is_leaf, empty = count > 0, (count == 0) & (child < 0)
    low, high = layout.split_index(
        np.where(is_leaf, child + primitive_starts[label], np.maximum(child, 0) + node_start)
    )
    leaf = layout.pack_leaf(np.where(is_leaf, kinds[label], 0), count, high)
    boxes = tree.boxes[rows].astype(np.float64)
    padding = np.abs(boxes).max(axis=(2, 3))[:, :, None] * _BOX_PADDING + _BOX_PADDING_ABSOLUTE
    lower = np.maximum(boxes[:, :, 0] - padding, -bvh.FAR)
    upper = np.minimum(boxes[:, :, 1] + padding, bvh.FAR)
    lower[empty] = upper[empty] = bvh.FAR
    for c in (0, 1):
        records[f"lower_{c}"], records[f"upper_{c}"] = lower[:, c], upper[:, c]
        records[f"first_{c}"], records[f"leaf_{c}"] = low[:, c], leaf[:, c]
