"""How good trees are, by the surface area heuristic."""

import numpy as np
import pytest

from addon.engine.bvh import build, quick_build, sah_cost, statistics, sweep_build
from addon.engine.bvh.boxes import half_areas, morton_order, spans, take_spans
from addon.engine.bvh.build import TOP
from addon.engine.bvh.flatten import flatten
from addon.engine.bvh.topology import Topology
from tests.unit.trees import BUILDERS, SCENES, SEEDS, check, slivers, sphereflake, uniform


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


def test_cost_by_hand():
    """Two unit cubes, three apart: the root's half area is 4 + 4 + 1 = 9, a cube's 3."""
    lo = np.array([[0.0, 0, 0], [3, 0, 0]])
    bvh = build(lo, lo + 1, leaf_size=1)
    assert sah_cost(bvh, traversal_cost=2, intersection_cost=5) == pytest.approx(2 + 2 * 3 / 9 * 5)
    stats = statistics(bvh)
    assert stats == {"nodes": 1, "depth": 1, "leaves": 2, "leaf_size": 1, "sah_cost": pytest.approx(4 / 3)}
