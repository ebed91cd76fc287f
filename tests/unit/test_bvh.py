"""The hierarchy: whole, tight and of bounded depth, whatever it is built of."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from addon.engine.bvh import MAX_DEPTH, QuickTree, build, quick_build, refit, sah_cost, statistics, sweep_build
from addon.engine.bvh.agglomerate import agglomerate
from addon.engine.bvh.boxes import half_areas, morton_codes, morton_order, sorted_codes, spans, take_spans
from addon.engine.bvh.build import TOP
from addon.engine.bvh.flatten import flatten
from addon.engine.bvh.quick import cell_starts
from addon.engine.bvh.topology import Topology
from addon.engine.threads import LARGE
from tests.unit.trees import BUILDERS, BY_COST, SCENES, SEEDS, check, clustered, uniform


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
