"""The hierarchy: whole, tight, of bounded depth, good, and traversed like brute force.

Scenes are made from the seed in the test's name."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from addon.engine.bvh import (
    MAX_DEPTH,
    Form,
    QuickTree,
    build,
    build_forest,
    quick_build,
    refit,
    sah_cost,
    sah_costs,
    statistics,
    sweep_build,
)
from addon.engine.bvh.agglomerate import agglomerate
from addon.engine.bvh.boxes import half_areas, morton_codes, morton_order, sorted_codes, spans, take_spans
from addon.engine.bvh.build import TOP
from addon.engine.bvh.flatten import flatten
from addon.engine.bvh.quick import cell_starts
from addon.engine.bvh.topology import Topology
from addon.engine.bvh.tree import FAR, MIXED
from addon.engine.threads import LARGE

BUILDERS = pytest.mark.parametrize("builder", [build, sweep_build, quick_build])
BY_COST = pytest.mark.parametrize("builder", [build, sweep_build])
SEEDS = pytest.mark.parametrize("seed", range(3))


def uniform(n, rng):
    """Spheres of like size everywhere."""
    centre, radius = rng.random((n, 3)), rng.uniform(0.1, 0.5, (n, 1)) / n ** (1 / 3)
    return centre - radius, centre + radius


def clustered(n, rng):
    """Spheres in 30 heaps a hundredfold apart in size."""
    heap, size = rng.integers(0, 30, n), 10 ** rng.uniform(-3, -1, (30, 1))
    centre = rng.random((30, 3))[heap] + rng.normal(size=(n, 3)) * size[heap]
    radius = rng.uniform(0.2, 1, (n, 1)) * size[heap] / (n / 30) ** (1 / 3)
    return centre - radius, centre + radius


def sphereflake(n, rng):
    """Nine spheres on each sphere, a third of its size."""
    centre, radius = [np.zeros((1, 3))], [np.ones((1, 1))]
    while sum(map(len, radius)) < n:
        outward = rng.normal(size=(9 * len(radius[-1]), 3))
        outward /= np.linalg.norm(outward, axis=1, keepdims=True)
        parent = np.repeat(radius[-1], 9, axis=0)
        centre.append(np.repeat(centre[-1], 9, axis=0) + outward * parent * 4 / 3)
        radius.append(parent / 3)
    centre, radius = np.concatenate(centre)[:n], np.concatenate(radius)[:n]
    return centre - radius, centre + radius


def slivers(n, rng):
    """Long thin triangles in all directions."""
    first = rng.random((n, 3))
    corner = np.stack([first, first + rng.normal(size=(n, 3)) / 10, first + rng.normal(size=(n, 3)) / 500])
    return corner.min(axis=0), corner.max(axis=0)


def grid_mesh(n, rng):
    """The triangles of a wavy height field, some of them flat boxes."""
    side = int(np.sqrt(n / 2)) + 1
    x, y = np.meshgrid(np.arange(side + 1.0), np.arange(side + 1.0), indexing="ij")
    z = np.maximum(np.sin(x * rng.uniform(0.05, 0.2)) * 5, 0)
    point = np.stack([x, y, z], axis=-1)
    a, b, c, d = point[:-1, :-1], point[1:, :-1], point[1:, 1:], point[:-1, 1:]
    corner = np.concatenate([np.stack([a, b, c]), np.stack([a, c, d])], axis=1).reshape(3, -1, 3)[:, :n]
    return corner.min(axis=0), corner.max(axis=0)


SCENES = pytest.mark.parametrize("scene", [uniform, clustered, sphereflake, slivers, grid_mesh])


def leaf_ranges(bvh):
    """Of every leaf: node, child, start and stop in `order`."""
    node, child = np.nonzero(bvh.is_leaf)
    start = bvh.leaf_start[node, child]
    return node, child, start, start + bvh.count[node, child]


def check(bvh, lo, hi, label=None, leaf_size=4):
    """Everything that `Bvh` promises about its arrays, short of quality."""
    n = len(lo)
    label = np.zeros(n, int) if label is None else label
    assert bvh.boxes.dtype == np.float32 and bvh.boxes.shape == (len(bvh), 2, 2, 3)
    assert bvh.child.dtype == bvh.order.dtype == np.int64 and bvh.count.dtype == bvh.label.dtype == np.int32

    # Every primitive once, the labels in runs, every place of `order` in one leaf of that label.
    assert np.array_equal(np.sort(bvh.order), np.arange(n))
    assert np.all(np.diff(label[bvh.order]) >= 0)
    assert np.array_equal(np.diff(bvh.run), np.bincount(label))
    node, child, start, stop = leaf_ranges(bvh)
    by_start = np.argsort(start)
    assert np.array_equal(start[by_start], np.concatenate([[0], stop[by_start][:-1]])) and stop.max() == n
    assert np.all(stop - start <= leaf_size)
    leaf_of = np.repeat(by_start, (stop - start)[by_start])
    assert np.array_equal(label[bvh.order], bvh.label[node, child][leaf_of])
    assert np.all(bvh.label[~bvh.is_leaf] == MIXED)

    # A tree in depth-first order: each node but the root is a child once, of an earlier node.
    parent, _ = np.nonzero(bvh.is_inner)
    below = bvh.child[bvh.is_inner]
    assert np.array_equal(np.sort(below), np.arange(1, len(bvh))) and np.all(below > parent)
    first = bvh.is_inner[:, 0]
    assert np.array_equal(bvh.child[first, 0], np.flatnonzero(first) + 1)
    level, depth = np.zeros(1, int), 0
    while len(level):
        level, depth = bvh.child[level][bvh.is_inner[level]], depth + 1
    assert depth == bvh.depth <= MAX_DEPTH

    # Boxes contain the primitives as given, and are the union of what is below, no more.
    box = bvh.boxes[node, child][leaf_of].astype(np.float64)
    assert np.all(box[:, 0] <= lo[bvh.order]) and np.all(box[:, 1] >= hi[bvh.order])
    union = bvh.boxes[below]
    assert np.array_equal(bvh.boxes[bvh.is_inner][:, 0], union[:, :, 0].min(axis=1))
    assert np.array_equal(bvh.boxes[bvh.is_inner][:, 1], union[:, :, 1].max(axis=1))
    empty = ~bvh.is_leaf & ~bvh.is_inner
    assert np.all(bvh.boxes[empty] == FAR) and np.all(bvh.child[empty] == -1) and np.count_nonzero(empty) <= 1


@BUILDERS
@SCENES
@SEEDS
def test_structure(builder, scene, seed):
    rng = np.random.default_rng(seed)
    lo, hi = scene(3000, rng)
    check(builder(lo, hi), lo, hi)


@SCENES
@SEEDS
def test_structure_with_clustering(scene, seed):
    lo, hi = scene(TOP + 5000, np.random.default_rng(seed))
    check(build(lo, hi), lo, hi)


@BUILDERS
@pytest.mark.parametrize("leaf_size", [1, 2, 3, 8])
@pytest.mark.parametrize("kinds", [1, 2, 6])
@pytest.mark.parametrize("n", [5, 700, TOP + 1])
def test_labels_and_leaf_sizes(builder, leaf_size, kinds, n):
    rng = np.random.default_rng(n)
    lo, hi = clustered(n, rng)
    label = rng.integers(0, kinds, n)
    bvh = builder(lo, hi, label, leaf_size=leaf_size)
    check(bvh, lo, hi, label, leaf_size)
    if builder is quick_build:
        return
    # Cheap tests fill the leaves to the brim, where the labels allow.
    full = builder(lo, hi, label, leaf_size=leaf_size, intersection_cost=1e-3)
    check(full, lo, hi, label, leaf_size)
    assert np.count_nonzero(full.is_leaf) <= np.count_nonzero(bvh.is_leaf)


@given(
    arrays(
        np.float64,
        st.tuples(st.integers(1, 40), st.just(2), st.just(3)),
        elements=st.sampled_from([-1e30, -3.0, -1e-30, 0.0, 1e-38, 0.1, 1 / 3, 1.0, 1.0 + 1e-12, 7.0, 1e30]),
    ),
    st.integers(1, 5),
    st.integers(1, 3),
)
def test_structure_of_any_boxes(corners, leaf_size, kinds):
    lo, hi = corners.min(axis=1), corners.max(axis=1)
    label = np.arange(len(lo)) % kinds
    for builder in (build, sweep_build, quick_build):
        check(builder(lo, hi, label, leaf_size=leaf_size), lo, hi, label, leaf_size)


@BUILDERS
def test_no_primitives(builder):
    bvh = builder(np.empty((0, 3)), np.empty((0, 3)), np.empty(0, int))
    assert len(bvh) == len(bvh.order) == bvh.depth == 0 and bvh.boxes.shape == (0, 2, 2, 3)
    assert sah_cost(bvh) == 0 and statistics(bvh)["leaves"] == 0
    assert len(refit(bvh, np.empty((0, 3)), np.empty((0, 3)))) == 0


@BUILDERS
@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_one_leaf_has_an_empty_sibling(builder, n):
    lo, hi = np.zeros((n, 3)), np.ones((n, 3))
    bvh = builder(lo, hi)
    check(bvh, lo, hi)
    assert len(bvh) == bvh.depth == 1 and bvh.count.tolist() == [[n, 0]] and bvh.child.tolist() == [[0, -1]]
    assert np.array_equal(bvh.bounds, [[0, 0, 0], [1, 1, 1]])
    assert sah_cost(bvh, 1.0, 0.25) == 1 + n * 0.25


@pytest.mark.parametrize("seed", range(3))
def test_empty_child_is_missed(seed):
    """By rays in all directions, the axes' included, and by those on the diagonal that leads to it."""
    rng = np.random.default_rng(seed)
    bvh = build(np.zeros((1, 3)), np.ones((1, 3)))
    direction = np.concatenate([rng.normal(size=(1000, 3)), np.eye(3), -np.eye(3), np.ones((50, 3)), -np.ones((50, 3))])
    direction *= 10 ** rng.uniform(-3, 3, (len(direction), 1))
    origin = rng.normal(size=direction.shape) * 10 ** rng.uniform(-4, 6, (len(direction), 1))
    origin[-100:] = origin[-100:, :1]
    assert not slabs(origin, direction, bvh.boxes[:, 1], 1e30).any()


@BY_COST
@SCENES
def test_larger_child_comes_first(builder, scene):
    size = np.diff(builder(*scene(3000, np.random.default_rng(0))).boxes.astype(np.float64), axis=2)[:, :, 0]
    area = size[..., 0] * size[..., 1] + size[..., 2] * (size[..., 0] + size[..., 1])
    assert np.all(area[:, 0] >= area[:, 1] * (1 - 1e-4))


def exponential(n, ratio):
    """(n, 3) points on a diagonal, each `ratio` times as far out as the last."""
    return ratio ** (np.arange(n) - n / 2)[:, None] * np.ones(3)


FEW, MANY = exponential(200, 1.5), exponential(20_000, 1.005)
CUBES = np.arange(30_000)[:, None] ** [0, 0, 3]
ADVERSARIES = {
    "identical boxes": (np.zeros((100_000, 3)), np.ones((100_000, 3))),
    "identical points": (np.full((20_000, 3), 5.0), np.full((20_000, 3), 5.0)),
    "few exponential points": (FEW, FEW),
    "many exponential points": (MANY, MANY),
    "few nested boxes": (-FEW, FEW),
    "many nested boxes": (-MANY, MANY),
    "flat boxes": (FEW * [0, 1, 0], FEW * [0, 1, 0.1]),
    "points on a line": (CUBES, CUBES),
}


@BUILDERS
@pytest.mark.parametrize(("lo", "hi"), ADVERSARIES.values(), ids=ADVERSARIES.keys())
def test_adversarial(builder, lo, hi):
    bvh = builder(lo, hi)
    check(bvh, lo, hi)


@BUILDERS
@pytest.mark.parametrize("n", [1000, 50_000])
def test_coincident_boxes_make_a_balanced_tree(builder, n):
    """No chain, and no scattered leaves, where the heuristic cannot tell one split from another."""
    bvh = builder(np.zeros((n, 3)), np.ones((n, 3)))
    assert bvh.depth <= np.ceil(np.log2(n)) + 2


@pytest.mark.parametrize("name", ADVERSARIES)
def test_clustering_takes_few_rounds(name):
    """Also where each box would rather join the one before, which would rather join the one before that."""
    lo, hi = (corner.astype(np.float32) for corner in ADVERSARIES[name])
    span = spans(lo, hi)
    topology, curve = Topology(half_areas(span)), morton_order(span)
    agglomerate(take_spans(span, curve), curve.astype(np.int32), topology, 1)
    assert len(topology.left) == topology.batches[-1].stop and len(topology.batches) < 12 * np.log2(len(lo))


@BUILDERS
def test_leaf_sizes_may_differ_by_label(builder):
    """Even where boxes are the same, so that a larger leaf costs nothing."""
    rng = np.random.default_rng(9)
    lo, label = np.repeat(rng.random((300, 3)), 8, axis=0), np.repeat(rng.integers(0, 3, 300), 8)
    bvh = builder(lo, lo + 0.05, label, leaf_size=np.array([8, 1, 2]))
    check(bvh, lo, lo + 0.05, label, leaf_size=8)
    assert [bvh.count[bvh.is_leaf & (bvh.label == kind)].max() for kind in range(3)] == [8, 1, 2]


def test_what_a_test_costs_may_differ_by_label():
    """Labels whose tests are cheap have large leaves; those whose are dear, single primitives."""
    rng = np.random.default_rng(8)
    lo, label = rng.random((4000, 3)), rng.integers(0, 2, 4000)
    lo[label == 1] += 10.0
    bvh = build(lo, lo + 0.05, label, leaf_size=8, intersection_cost=np.array([0.1, 5.0]))
    check(bvh, lo, lo + 0.05, label, leaf_size=8)
    sizes = [bvh.count[bvh.is_leaf & (bvh.label == kind)].mean() for kind in (0, 1)]
    assert sizes[0] > 3.0 and sizes[1] < 1.5
    only = build(lo[label == 0], lo[label == 0] + 0.05, intersection_cost=0.1)
    assert sah_cost(only, intersection_cost=np.array([0.1])) == pytest.approx(sah_cost(only, intersection_cost=0.1))


@BUILDERS
@pytest.mark.parametrize("axis", range(3))
def test_points_on_an_axis_are_split_along_it(builder, axis):
    """Though none of the boxes, nor their unions, has any area."""
    rng = np.random.default_rng(axis)
    point = rng.permutation(TOP * 2)[:, None] * np.eye(3)[axis]
    bvh = builder(point, point)
    length = bvh.boxes[bvh.is_leaf][:, 1, axis] - bvh.boxes[bvh.is_leaf][:, 0, axis]
    assert length.mean() < 4


def chain(n):
    """A topology as deep as can be: each node joins the last with one primitive more."""
    topology = Topology(np.arange(n, dtype=np.float32))
    last = np.zeros(1, np.int32)
    for i in range(1, n):
        last = topology.add(last, np.array([i], np.int32), np.array([n + i], np.float32))
    return topology


@pytest.mark.parametrize("n", [62, 63, 64, 65, 100, 3000])
def test_a_chain_is_cut_at_the_greatest_depth(n):
    lo = np.arange(3.0 * n, dtype=np.float32).reshape(n, 3)
    bvh = flatten(chain(n), np.arange(n), lo, lo, np.zeros(n, np.int32), 1, 1.0, 1.0)
    check(bvh, lo, lo, leaf_size=1)
    assert bvh.depth == min(n - 1, MAX_DEPTH)


@SCENES
@SEEDS
def test_quality_against_the_sweep(scene, seed):
    lo, hi = scene(20_000, np.random.default_rng(seed))
    assert sah_cost(build(lo, hi)) <= 1.06 * sah_cost(sweep_build(lo, hi))


@SCENES
@SEEDS
def test_quality_of_the_quick_builder(scene, seed):
    """No more than twice as dear as the best there is, where things differ much in size; most often far less."""
    lo, hi = scene(20_000, np.random.default_rng(seed))
    found, best = quick_build(lo, hi), sah_cost(sweep_build(lo, hi))
    assert sah_cost(found) <= {sphereflake: 1.8, slivers: 1.5}.get(scene, 1.35) * best


@SCENES
@pytest.mark.parametrize("most", [1, 4, 8])
def test_quick_leaves_are_the_largest_cells_that_fit(scene, most):
    """Against cutting cells one by one."""
    lo, hi = (corner.astype(np.float32) for corner in scene(2000, np.random.default_rng(0)))
    code = np.unique(morton_codes(spans(lo, hi)))
    expected, todo = [], [(0, len(code), 63)]
    while todo:
        first, stop, bit = todo.pop()
        if stop - first <= most:
            expected.append(first)
            continue
        upper = first + np.searchsorted(code[first:stop] >> np.uint64(bit - 1) & np.uint64(1), 1)
        todo += [(a, b, bit - 1) for a, b in ((first, upper), (upper, stop)) if a < b]
    assert np.array_equal(cell_starts(code, most), np.sort(expected))


def test_quick_leaves_of_equal_codes_are_full_enough():
    start = cell_starts(np.zeros(1000, np.uint64), 8)
    assert set(np.diff(start, append=1000)) == {8}


@SCENES
@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e35])
def test_a_quick_tree_in_two_parts_is_the_one_in_one(scene, scale):
    """Whatever the scale of its spans, and of many labels; so many that sorting and bits are done in pieces."""
    rng = np.random.default_rng(0)
    lo, hi = (corner.astype(np.float32) for corner in scene(150_000, rng))
    label = rng.integers(0, 3, len(lo)).astype(np.int32)
    whole = quick_build(lo, hi, label, leaf_size=8)
    span = np.concatenate([-lo.T, hi.T])
    quick = QuickTree(span * np.float32(2.0 ** np.round(np.log2(scale))), label, 8)
    found = quick.form().around(span[:, quick.order])
    check(whole, lo, hi, label, 8)
    for name in ("order", "run", "child", "count", "label", "boxes"):
        assert np.array_equal(getattr(found, name), getattr(whole, name)), name


def test_many_codes_are_sorted_as_few_are():
    """By pieces of what has its first 16 bits in common; equal ones stay in order."""
    rng = np.random.default_rng(0)
    for bits in (63, 50, 20, 3):  # in the end all are in one piece
        code = rng.integers(0, 1 << bits, 2 * LARGE, np.uint64)
        order, ascending = sorted_codes(code)
        assert np.array_equal(order, np.argsort(code, kind="stable")) and np.array_equal(ascending, code[order])


@SCENES
def test_quality_against_halving(scene):
    """The sweep itself is no straw man: it beats cutting a Morton curve in halves on every scene."""
    n = 4096
    lo, hi = (corner.astype(np.float32) for corner in scene(n, np.random.default_rng(0)))
    span = spans(lo, hi)
    topology, nodes = Topology(half_areas(span)), morton_order(span).astype(np.int32)
    span = take_spans(span, nodes)
    while len(nodes) > 1:
        span = np.maximum(span[:, ::2], span[:, 1::2])
        nodes = topology.add(nodes[::2], nodes[1::2], half_areas(span))
    halved = flatten(topology, np.arange(n), lo, hi, np.zeros(n, np.int32), 4, 1.0, 0.5)
    check(halved, lo, hi)
    assert sah_cost(sweep_build(lo, hi)) < 0.95 * sah_cost(halved)


@pytest.mark.parametrize("builder", [build, quick_build])
def test_a_far_outlier_does_not_spoil_the_rest(builder):
    """The ground as a huge sphere: the other 30 000 boxes still lie in cells of their own."""
    lo, hi = uniform(30_000, np.random.default_rng(0))

    def cost_of_the_rest(bvh):
        box, count = bvh.boxes[bvh.is_leaf | bvh.is_inner].astype(np.float64), bvh.count.ravel()
        x, y, z = (box[:, 1] - box[:, 0]).T
        area = x * y + y * z + z * x
        return np.sum((area * np.where(count > 0, 0.5 * count, 1))[area < 10])

    alone = cost_of_the_rest(builder(lo, hi))
    lo[-1], hi[-1] = -2e8, 0
    assert cost_of_the_rest(builder(lo, hi)) < 1.1 * alone


@SCENES
@SEEDS
def test_refit(scene, seed):
    """Boxes of the moved primitives on the old tree; at rest, exactly the boxes of the build."""
    rng = np.random.default_rng(seed)
    lo, hi = scene(TOP + 2000, rng)
    bvh = build(lo, hi, rng.integers(0, 3, len(lo)))
    assert np.array_equal(refit(bvh, lo, hi).boxes, bvh.boxes)
    step = rng.normal(size=lo.shape) * 0.1
    moved = refit(bvh, lo + step, hi + step)
    check(moved, lo + step, hi + step, bvh_labels(bvh))
    assert moved.child is bvh.child and moved.order is bvh.order and not np.array_equal(moved.boxes, bvh.boxes)


@pytest.mark.parametrize("count", [1, 2, 9, TOP + 500])
def test_a_form_around_spans_is_a_refit(count):
    rng = np.random.default_rng(count)
    lo, hi = (corner.astype(np.float32) for corner in uniform(count, rng))
    bvh = build(lo, hi, rng.integers(0, 3, count))
    step = rng.normal(size=lo.shape).astype(np.float32) * np.float32(0.1)
    expected = refit(bvh, lo + step, hi + step)
    order = bvh.order
    found = Form(bvh).around(np.concatenate([-(lo + step)[order].T, (hi + step)[order].T]))
    assert np.array_equal(found.boxes, expected.boxes) and np.array_equal(found.bounds, expected.bounds)
    assert np.array_equal(found.child, bvh.child) and np.array_equal(found.order, bvh.order)


@pytest.mark.parametrize("cost", [0.3, np.array([0.1, 0.5, 2.0])])
def test_a_forest_is_of_the_trees_that_are_built_one_by_one(cost):
    """Whatever the sizes and scales of what is beside them, single primitives and single leaves included."""
    rng = np.random.default_rng(0)
    scenes = [uniform, clustered, sphereflake, slivers, grid_mesh]
    counts = np.array([1, 1, 300, 2, 5, *rng.integers(1, 200, 60), 1])
    lots = []
    for number, n in enumerate(counts.tolist()):
        scale = 10 ** rng.uniform(-20, 20)
        lo, hi = (corner[:n] * scale for corner in scenes[number % len(scenes)](n, rng))
        lots.append((lo, hi, rng.integers(0, rng.integers(1, 4), n)))
    forest = build_forest(*map(np.concatenate, zip(*lots, strict=True)), counts, leaf_size=8, intersection_cost=cost)
    bounds, costs = forest.bounds, sah_costs(forest, intersection_cost=cost)
    assert len(forest) == len(counts)
    for number, (lo, hi, label) in enumerate(lots):
        expected = build(lo, hi, label, leaf_size=8, intersection_cost=cost)
        found = forest.tree(number)
        check(found, lo, hi, label, leaf_size=8)
        for name in ("boxes", "child", "count", "label", "order", "run", "depth"):
            assert np.array_equal(getattr(found, name), getattr(expected, name)), (number, name)
        assert np.array_equal(bounds[number], expected.bounds)
        assert costs[number] == pytest.approx(sah_cost(expected, intersection_cost=cost), rel=1e-6)


def bvh_labels(bvh):
    """The labels of the primitives, from the runs."""
    label = np.empty(len(bvh.order), int)
    label[bvh.order] = np.repeat(np.arange(len(bvh.run) - 1), np.diff(bvh.run))
    return label


def test_refit_of_a_single_leaf_keeps_its_empty_sibling():
    bvh = refit(build(np.zeros((1, 3)), np.ones((1, 3))), np.full((1, 3), 5.0), np.full((1, 3), 6.0))
    check(bvh, np.full((1, 3), 5.0), np.full((1, 3), 6.0))
    assert np.array_equal(bvh.bounds, [[5, 5, 5], [6, 6, 6]])


def test_cost_by_hand():
    """Two unit cubes, three apart: the root's half area is 4 + 4 + 1 = 9, a cube's 3."""
    lo = np.array([[0.0, 0, 0], [3, 0, 0]])
    bvh = build(lo, lo + 1, leaf_size=1)
    assert sah_cost(bvh, traversal_cost=2, intersection_cost=5) == pytest.approx(2 + 2 * 3 / 9 * 5)
    stats = statistics(bvh)
    assert stats == {"nodes": 1, "depth": 1, "leaves": 2, "leaf_size": 1, "sah_cost": pytest.approx(4 / 3)}


def slabs(origin, direction, boxes, t_max):
    """(...) bool, in float32: rays (..., 3) against boxes (..., 2, 3).

    The usual shader's slab test: it sorts the planes by minimum and maximum and rounds the far distance up
    (T. Ize, "Robust BVH Ray Traversal", 2013).
    """
    origin, direction = origin.astype(np.float32), direction.astype(np.float32)
    tiny = np.float32(1e-30)  # stands for a zero, so that no plane gives 0 * inf
    inverse = 1 / np.where(np.abs(direction) < tiny, np.copysign(tiny, direction), direction)
    with np.errstate(over="ignore"):
        t = (boxes - origin[..., None, :]) * inverse[..., None, :]
    near = t.min(axis=-2).max(axis=-1)
    far = t.max(axis=-2).min(axis=-1) * np.float32(1 + 2**-20)
    return (np.maximum(near, 0) <= far) & (near <= t_max)


def traverse(bvh, origin, direction):
    """(k, 2) rays and primitives of the leaves that they reach: all rays at once, a level at a time."""
    ray, node = np.arange(len(origin)), np.zeros(len(origin), int)
    pairs, levels = [np.empty((0, 2), int)], 0
    while len(ray) and len(bvh):
        levels += 1
        hit = slabs(origin[ray, None], direction[ray, None], bvh.boxes[node], 1e30)
        at, side = np.nonzero(hit & bvh.is_leaf[node])
        start, count = bvh.leaf_start[node[at], side], bvh.count[node[at], side]
        within = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        pairs.append(np.stack([np.repeat(ray[at], count), bvh.order[np.repeat(start, count) + within]], axis=1))
        at, side = np.nonzero(hit & bvh.is_inner[node])
        ray, node = ray[at], bvh.child[node[at], side]
    assert levels <= bvh.depth
    return np.concatenate(pairs)


def rays_through(lo, hi, rng, n):
    """Rays of all kinds: towards boxes, half of them from within; along the axes; from corners, in faces."""
    low, high = lo.min(axis=0), hi.max(axis=0)
    away = rng.normal(size=(n, 3)) * (high - low)
    origin = rng.uniform(low, high, (n, 3)) + away * (rng.random((n, 1)) < 0.5)
    target = rng.integers(0, len(lo), n)
    direction = rng.uniform(lo[target], hi[target]) - origin
    along = np.flatnonzero(rng.random(n) < 0.25)
    direction[along] = np.eye(3)[rng.integers(0, 3, len(along))] * rng.choice([-1, 1], (len(along), 1))
    face = np.flatnonzero(rng.random(n) < 0.25)
    origin[face] = lo[rng.integers(0, len(lo), len(face))]
    return origin, direction


@BUILDERS
@SCENES
@SEEDS
@pytest.mark.parametrize("scale", [1e-4, 1, 1e5])
def test_traversal_meets_what_brute_force_meets(builder, scene, seed, scale):
    rng = np.random.default_rng(seed)
    lo, hi = (corner * scale for corner in scene(1500, rng))
    bvh = builder(lo, hi, rng.integers(0, 3, len(lo)))
    origin, direction = rays_through(lo, hi, rng, 200)

    own = np.stack([lo, hi], axis=1).astype(np.float32)
    expected = np.argwhere(slabs(origin[:, None], direction[:, None], own[None], 1e30))
    ray, primitive = traverse(bvh, origin, direction).T
    met = slabs(origin[ray], direction[ray], own[primitive], 1e30)
    found = np.stack([ray[met], primitive[met]], axis=1)
    assert len(expected) > 150 and np.array_equal(found[np.lexsort(found.T[::-1])], expected)
    assert len(ray) < 0.2 * len(origin) * len(lo)


@BUILDERS
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("magnitude", [1e-44, 1e-38, 1e-30, 1e-4, 1e5, 1e30, 3e38])
def test_magnitudes(builder, magnitude, dtype):
    """The same scene at every scale that float32 holds; well within it, exactly the same tree."""
    rng = np.random.default_rng(0)
    lo, hi = ((corner / 2 * magnitude).astype(dtype) for corner in uniform(500, rng))
    bvh = builder(lo, hi)
    check(bvh, lo, hi)
    if 1e-30 <= magnitude:
        scaled = builder(lo * dtype(0.25), hi * dtype(0.25))
        assert np.array_equal(scaled.order, bvh.order) and np.array_equal(scaled.child, bvh.child)


@BUILDERS
def test_float64_boxes_are_rounded_outward(builder):
    lo = np.full((1, 3), 0.1)
    low, high = builder(lo, lo).bounds[:, 0].astype(np.float64)
    assert low < 0.1 < high and np.float32(high) == np.nextafter(np.float32(low), np.float32(1))


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (np.nan, "2 of 5 are not finite .* the first is primitive 3"),
        (np.inf, "2 of 5 are not finite .* the first is primitive 3"),
        (1e39, "2 of 5 are beyond the range of float32 .* the first is primitive 3"),
        (-1.0, "2 of 5 are inverted .* the first is primitive 3"),
    ],
)
def test_bad_boxes_are_refused(value, message):
    lo, hi = np.zeros((5, 3)), np.ones((5, 3))
    good = build(lo, hi)
    hi[3:, 1] = value
    for call in (build, sweep_build, quick_build, lambda lo, hi: refit(good, lo, hi)):
        with pytest.raises(ValueError, match=message):
            call(lo, hi)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((np.zeros((2, 3)), np.ones((3, 3))), r"shape \(n, 3\)"),
        ((np.zeros(3), np.ones(3)), r"shape \(n, 3\)"),
        ((np.zeros((2, 3)), np.ones((2, 3)), [0]), "expected 2 integers"),
        ((np.zeros((2, 3)), np.ones((2, 3)), [0.0, 1.0]), "expected 2 integers"),
        ((np.zeros((2, 3)), np.ones((2, 3)), [0, -1]), "primitive 1 has label -1"),
        ((np.zeros((2, 3)), np.ones((2, 3)), [0, 1 << 16]), "primitive 1 has label 65536"),
    ],
)
def test_bad_arguments_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        build(*arguments)


def test_bad_leaf_size_and_wrong_refit_are_refused():
    lo, hi = np.zeros((2, 3)), np.ones((2, 3))
    with pytest.raises(ValueError, match="leaf_size must be at least 1, not 0"):
        build(lo, hi, leaf_size=0)
    with pytest.raises(ValueError, match="holds 2 primitives, but 1 boxes"):
        refit(build(lo, hi), lo[:1], hi[:1])


def test_input_is_left_alone():
    lo, hi = (corner.astype(np.float32) for corner in uniform(TOP + 100, np.random.default_rng(0)))
    before = lo.copy(), hi.copy()
    build(lo, hi)
    assert np.array_equal(lo, before[0]) and np.array_equal(hi, before[1])
