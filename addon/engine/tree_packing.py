"""Geometries' trees, and the GPU records that their leaves point to.

What is large goes a piece at a time from the scene's own arrays into the arrays that are uploaded: nothing the size of
the scene is held in between, whatever the precision of the arithmetic.
"""

import weakref
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from . import bvh, data_texture, grid_packing, layout, leaves, part_boxes
from .batches import batches, joined
from .errors import SceneError
from .node_packing import move_nodes, write_nodes
from .primitives import BY_KIND, Similarity
from .residency import BuiltTree, KeptTree, Resident, Upload
from .threads import both, each_piece
from .timing import timed

#: Trees of fewer primitives are never built quickly: good ones take no time.
QUICK_FROM = 1 << 14
#: A refitted tree that costs so much more than a built one is built.
WORN = 1.3
#: Grids take some hundred bytes a primitive: there are none in scenes of more.
_MOST_IN_GRIDS = 1 << 19


class TreePacker:
    """Builds the trees of the geometries `numbers` of a plan and writes their records, in ranges that it takes from the
    arenas of a `Residency`.

    `uploads`: of the records, those of the nodes come with `finish`. `bases` (G, K): index of the first record of each
    kind, by number. `trees`: `BuiltTree`s by number. `seconds`: by stage. `refitted`: how many trees were not built.
    `keep`: whether trees are kept for refits. `quick`: whether large trees are built quickly, for slower rays. `grids`:
    whether these may take the place of trees.
    """

    def __init__(self, plan, numbers, residency, origin, *, top_nodes, keep, quick=False, grids=True):
        self.plan, self.residency, self.keep, self.quick, self.grids = plan, residency, keep, quick, grids
        self.seconds, self.trees, self.uploads, self.refitted = {}, {}, {}, 0
        self._added = {}
        self._move = Similarity(np.eye(3), 1.0, -origin) if origin.any() else None
        self._moved = origin.tobytes() if origin.any() else b""
        self._batches, self._large = batches(plan, numbers)
        self.bases = np.zeros(plan.counts.shape, np.int64)
        numbers = np.concatenate([*self._batches, self._large])  # those of a batch lie one after the other
        for number in np.setdiff1d(plan.built, numbers).tolist():
            self.trees[number] = residency.geometries[number].tree
            self.bases[number] = residency.geometries[number].bases
        for label, cls in enumerate(BY_KIND):
            counts = plan.counts[numbers, label]
            first, count = residency.arenas[cls.kind].take(int(counts.sum())), int(counts.sum())
            self.bases[numbers, label] = first + np.cumsum(counts) - counts
            for record in (cls.record, cls.surface_record) if count else ():
                texels = data_texture.zeros(count * record.texels)
                self.uploads[record.texture] = Upload(first * record.texels, texels, count * record.texels)
        self._nodes, self._top_nodes, self._node_count, self.node_first = [], top_nodes, top_nodes, 0

    def moved(self, number):
        """The origin as bytes that a geometry's primitives are moved by, empty for none."""
        return self._moved if self.plan.in_world[number] else b""

    def add(self, attributes, replaced_by, check_wanted):
        """Write the records of all geometries, and their attributes by an `AttributeWriter`. `replaced_by`: from the
        number of a geometry to the `Resident` whose tree may serve with new boxes, None where it must be built.
        `check_wanted()` is called now and then; it may raise."""
        for numbers in self._batches:
            check_wanted()
            self._add_batch(numbers, attributes)
        for number in self._large.tolist():
            check_wanted()
            self._add_large(number, attributes, replaced_by(number))

    def _add_large(self, number, attributes, replaced):
        parts, outside = self.plan.parts(number)
        move = self._move if self.plan.in_world[number] else None
        grid, kept, quick = None, None, False
        if self._may_have_grid(parts):
            tree, _, cost = self._built_quickly(number, parts, move)
            if tree is not None:
                grid = self._better_grid(number, parts, cost)
        if grid is None:
            tree, kept, cost, quick = self._tree(number, parts, move, replaced)
        with timed(self.seconds, "records"):
            for label, part, order in rows_by_kind(tree, parts):
                attributes.write((number, label), part, order)
            bounds = self._add_outside(number, outside, tree.bounds, move, attributes)
            if grid is not None:
                built = self._add_grid(number, parts, grid, bounds)
            else:
                built = BuiltTree(bounds, self._add_nodes(number, tree), len(tree), tree.depth, cost)
        self._added_one(number, built, attributes, kept, quick)

    def _tree(self, number, parts, move, replaced):
        """Refit or build a tree and write the records of its primitives; (tree, what is kept of it, its cost or 0,
        whether it is a quick one)."""
        if replaced is not None:
            tree, kept, cost = self._refitted(number, parts, move, replaced.kept)
            if tree is not None:
                return tree, kept, cost, replaced.quick
        good = self._good_tree(number)
        if self.quick and good is None and self.plan.counts[number].sum() >= QUICK_FROM:
            tree, kept, cost = self._built_quickly(number, parts, move)
            if tree is not None:
                return tree, kept, cost, True
        return *self._built(number, parts, move, good), False

    def _may_have_grid(self, parts):
        """Whether a grid may take the place of a geometry's tree; not where trees are kept: what moves takes its tree
        along."""
        small = self.plan.counts.sum() <= _MOST_IN_GRIDS
        return self.grids and small and not self.keep and grid_packing.may_have_grid(parts)

    def _hits(self, number, parts):
        """First records of a geometry's primitives, by kind number."""
        return {label: self._records(number, label, part)[0][: len(part)] for label, part in parts.items()}

    def _better_grid(self, number, parts, tree_cost):
        with timed(self.seconds, "tree"):
            return grid_packing.better_grid(self._hits(number, parts), self.bases[number], tree_cost)

    def _add_grid(self, number, parts, grid, bounds):
        """Write the records of a grid; its `BuiltTree`."""
        root, nodes, hits = self._node_count, grid_packing.room(grid), self._hits(number, parts)
        records = self._new_nodes(nodes, are_tree=False)
        grid_packing.write_grid(records.view(np.float32).reshape(-1, 4), grid, hits, self.bases[number])
        self._node_count += nodes
        return BuiltTree(bounds, root, nodes, 0, grid_packing.cost(grid, hits), is_grid=True)

    def _add_outside(self, number, parts, bounds, move, attributes):
        """Write the records of what stands outside of a geometry's tree with these `bounds`; the bounds of all."""
        for label, part in parts.items():
            order = np.arange(len(part))
            self._write_records(number, label, part, order, move)
            attributes.write((number, label), part, order)
            lower, upper = part_boxes.bounds([part], move)
            bounds = np.stack([np.minimum(bounds[0], lower.min(axis=0)), np.maximum(bounds[1], upper.max(axis=0))])
        return bounds

    def _added_one(self, number, tree, attributes, kept=None, quick=False):
        geometry = self.plan.geometries[number]
        self.trees[number] = tree
        self._added[number] = Resident(
            weakref.ref(geometry),
            geometry.token,
            self.moved(number),
            self.bases[number].copy(),
            self.plan.counts[number].copy(),
            tree,
            attributes.ranges(number),
            kept,
            quick,
        )

    def _add_batch(self, numbers, attributes):
        """As `_add_large` of many geometries of few primitives each."""
        move = self._move if self.plan.in_world[numbers[0]] else None
        with timed(self.seconds, "bounds"):
            parts, rows = joined([self.plan.geometries[number] for number in numbers], self.plan.counts[numbers])
            counts = self.plan.counts[numbers].sum(axis=1)
            lower, upper = np.empty((counts.sum(), 3), np.float32), np.empty((counts.sum(), 3), np.float32)
            labels = np.empty(len(lower), np.int32)
            for label, part in parts.items():
                lower[rows[label]], upper[rows[label]] = part_boxes.bounds([part], move)
                labels[rows[label]] = label
        with timed(self.seconds, "tree"):
            forest = self._forest(numbers, lower, upper, labels, counts)
            costs = bvh.sah_costs(forest, intersection_cost=leaves.INTERSECTION_COST).tolist()
        with timed(self.seconds, "records"):
            place = np.empty(len(lower), np.int64)
            for label, part in parts.items():
                place[rows[label]] = np.arange(len(part))
                order = place[forest.bvh.order[forest.bvh.run[label] : forest.bvh.run[label + 1]]]
                self._write_records(numbers[0], label, part, order, move)
                self._write_attributes(numbers, label, order, attributes)
            root = forest.root + self._add_nodes(numbers[0], forest.bvh)
        bounds, nodes, depth = forest.bounds, np.diff(root).tolist(), forest.depth.tolist()
        for place, number in enumerate(numbers.tolist()):
            tree = BuiltTree(bounds[place], int(root[place]), nodes[place], depth[place], costs[place])
            self._added_one(number, tree, attributes)

    def _forest(self, numbers, lower, upper, labels, counts):
        kinds = self.plan.counts_in_trees[numbers].sum(axis=0)
        options = {"leaf_size": leaves.sizes(kinds), "intersection_cost": leaves.INTERSECTION_COST}
        try:
            return bvh.build_forest(lower, upper, labels, counts, **options)
        except ValueError:
            start = np.cumsum(counts) - counts
            for number, first, count in zip(numbers.tolist(), start.tolist(), counts.tolist(), strict=True):
                rows = slice(first, first + count)
                with _naming(self.plan.geometries[number].name):
                    bvh.build(lower[rows], upper[rows], labels[rows], **options)
            raise

    def _write_attributes(self, numbers, label, order, attributes):
        """Write the attributes of a batch's primitives of one kind; `order`: of all of them, by tree."""
        counts = self.plan.counts[numbers, label]
        for number, start, count in zip(
            numbers.tolist(), (np.cumsum(counts) - counts).tolist(), counts.tolist(), strict=True
        ):
            if number in attributes.numbers and count:
                part = dict(self.plan.geometries[number].kinds())[label]
                attributes.write((number, label), part, order[start : start + count] - start)

    def _good_tree(self, number):
        """The tree that an improvement has built of a geometry and that is not on the GPU yet, or None."""
        geometry = self.plan.geometries[number]
        token, moved, tree = geometry.tree or (None, None, None)
        return tree if token is geometry.token and moved == self.moved(number) else None

    def _built(self, number, parts, move, tree):
        """Build a tree, where there is none, and write the records of its primitives; (tree, what is kept of it, its
        cost or 0)."""
        geometry = self.plan.geometries[number]
        if tree is None:
            tree = self._built_anew(number, parts, move)
            if self._improves(number):
                geometry.tree = geometry.token, self.moved(number), tree
        with timed(self.seconds, "tree"):
            cost = _cost(tree)
        with timed(self.seconds, "records"):
            for label, part, order in rows_by_kind(tree, parts):
                self._write_records(number, label, part, order, move)
        return tree, KeptTree(bvh.Form(tree), cost) if self.keep else None, cost

    def _built_anew(self, number, parts, move):
        counts = self.plan.counts_in_trees[number]
        with timed(self.seconds, "bounds"):
            lower, upper = part_boxes.bounds(parts.values(), move)
        with timed(self.seconds, "tree"), _naming(self.plan.geometries[number].name):
            options = {"leaf_size": leaves.sizes(counts), "intersection_cost": leaves.costs(counts)}
            return bvh.build(lower, upper, part_boxes.labels(parts), **options)

    def _built_quickly(self, number, parts, move):
        """As `_built`, a tree that is made in a fraction of the time; none where a box is not finite."""
        with timed(self.seconds, "bounds"):
            spans = part_boxes.spans(parts.values(), move)
            if not np.isfinite(spans).all():
                return None, None, 0.0  # building says what is wrong
        with timed(self.seconds, "tree"):
            quick = bvh.QuickTree(spans, part_boxes.labels(parts), leaves.sizes(self.plan.counts_in_trees[number]))
            del spans
            spans, form = both(lambda: self._write_in_order(number, parts, move, quick), quick.form)
            tree = form.around(spans)
            cost = _cost(tree)
        return tree, KeptTree(form, cost) if self.keep else None, cost

    def _improves(self, number):
        """Whether the good tree of a geometry takes the place of its quick one."""
        there = self.residency.geometries.get(number)
        there = there is not None and there.quick and there.is_of(self.plan.geometries[number], self.moved(number))
        return there and not self.quick

    def _write_records(self, number, label, part, order, move, spans=None):
        """Write the records of the rows `order` of a part of a geometry, or of what is joined to it; and the `spans`
        (6, n) of their boxes, as `bvh.Form` takes them, where these are asked for."""
        hits, surfaces = self._records(number, label, part)

        def write(rows):
            piece = part_boxes.moved(part.take(order[rows]), move)
            if spans is not None:
                part_boxes.fill_spans(piece, spans[:, rows])
            _copy_records(piece.records(), hits[rows], surfaces[rows])

        each_piece(write, len(order))

    def _refitted(self, number, parts, move, kept):
        """Put a tree that is kept around other primitives and write their records. As `_built`; no tree where a new
        one would be much better."""
        with timed(self.seconds, "refit"):
            spans = self._write_in_order(number, parts, move, kept.form.bvh)
            if not np.isfinite(spans).all():
                return None, None, 0.0  # building says what is wrong
            tree = kept.form.around(spans)
            cost = _cost(tree)
        if cost > WORN * kept.sah_cost:
            return None, None, 0.0
        self.refitted += 1
        return tree, kept, cost

    def _write_in_order(self, number, parts, move, tree):
        """Write the records of primitives in the order of a tree; the spans (6, n) of their boxes, in this order and
        made in the same go: most of the time goes into bringing them in order."""
        spans, end = np.empty((6, len(tree.order)), np.float32), 0
        for label, part, order in rows_by_kind(tree, parts):
            start, end = end, end + len(order)
            self._write_records(number, label, part, order, move, spans[:, start:end])
        return spans

    def _records(self, number, label, part):
        """The two arrays of records that are to be uploaded, from those of a part of a geometry on."""
        base = self.bases[number, label]
        found = []
        for record in (part.record, part.surface_record):
            upload = self.uploads[record.texture]
            found.append(data_texture.records_of(upload.texels, record)[base - upload.first // record.texels :])
        return found

    def _add_nodes(self, number, tree):
        """Write the nodes of a geometry's tree, or of those of all in a batch; the index of the first."""
        root = self._node_count
        nodes = self._new_nodes(len(tree))
        write_nodes(nodes, tree, root, self.bases[number], np.arange(len(BY_KIND)))
        self._node_count += len(tree)
        return root

    def _new_nodes(self, count, are_tree=True):
        """Records of further nodes that are to be uploaded, or the room of so many."""
        self._nodes.append((data_texture.zeros(count * layout.NODE.texels), count, are_tree))
        return data_texture.records_of(self._nodes[-1][0], layout.NODE)[:count]

    def settle(self):
        """Find the place of all nodes, now that their number is known; `Resident`s by number of what was added."""
        self.node_first = self.residency.arenas["node"].take(self._node_count)
        if self.node_first:
            for texture, count, are_tree in self._nodes:
                if are_tree:
                    move_nodes(data_texture.records_of(texture, layout.NODE)[:count], self.node_first)
            for number, resident in self._added.items():
                resident.tree = replace(resident.tree, root=resident.tree.root + self.node_first)
                self.trees[number] = resident.tree
        return self._added

    def add_top(self, top):
        """The upper tree `top`, whose nodes come before all others that are uploaded; its `BuiltTree`."""
        kind = np.array([layout.KINDS.index("instance")])
        write_nodes(self._new_nodes(self._top_nodes), top, self.node_first, np.zeros(1, np.int64), kind)
        self._nodes.insert(0, self._nodes.pop())
        return BuiltTree(top.bounds, self.node_first, self._top_nodes, top.depth, float(bvh.sah_cost(top)))

    def finish(self):
        """Make the upload of all nodes."""
        if not self._node_count and self.node_first:
            return
        if len(self._nodes) == 1:
            texture, *_ = self._nodes.pop()
        else:
            texture, start = data_texture.zeros(max(self._node_count, 1) * layout.NODE.texels), 0
            nodes = data_texture.records_of(texture, layout.NODE)
            while self._nodes:
                part, count, _ = self._nodes.pop(0)
                nodes[start : start + count] = data_texture.records_of(part, layout.NODE)[:count]
                start += count
        texels = layout.NODE.texels
        self.uploads["nodes"] = Upload(self.node_first * texels, texture, self._node_count * texels)


@contextmanager
def _naming(geometry):
    """Say of which geometry a box is that no tree can hold."""
    try:
        yield
    except ValueError as error:
        raise SceneError(f"geometry {geometry!r}: {error}") from error


def _cost(tree):
    return bvh.sah_cost(tree, intersection_cost=leaves.INTERSECTION_COST)


def rows_by_kind(tree, parts):
    """(kind number, primitives, (n,) rows of them in the order of the tree's leaves) of each of the `parts` that the
    tree was built of, by kind number."""
    start = 0
    for label, part in parts.items():
        yield label, part, tree.order[tree.run[label] : tree.run[label + 1]] - start
        start += len(part)


def _copy_records(records, *targets):
    """Copy arrays of records to others (n,) as floats, which is faster than field by field."""
    for record, target in zip(records, targets, strict=True):
        target.view(np.float32)[:] = record.view(np.float32)
