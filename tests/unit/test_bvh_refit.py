"""Trees around boxes that moved, and many trees built in one go."""

import numpy as np
import pytest

from addon.engine.bvh import Form, build, build_forest, refit, sah_cost, sah_costs
from addon.engine.bvh.build import TOP
from tests.unit.trees import SCENES, SEEDS, check, clustered, grid_mesh, slivers, sphereflake, uniform


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
