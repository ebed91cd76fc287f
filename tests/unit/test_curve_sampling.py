"""Points along curves, compared with what the types of curves promise. Blender's own evaluation is compared in
tests/blender/test_sync_curves.py."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from addon.sync import curve_sampling
from addon.sync.curve_sampling import BEZIER, CATMULL_ROM, NURBS, POLY, ControlCurves, Sampling, sample
from addon.sync.nurbs import ENDPOINT, NORMAL, knots_of


def control(counts, kind, cyclic=False, rng=None, **more):
    """Curves with random points, `counts` in each."""
    rng = rng or np.random.default_rng(5)
    offsets = np.concatenate([[0], np.cumsum(counts)]).astype(int)
    n, c = offsets[-1], len(counts)
    values = {
        "points": rng.normal(size=(n, 3)),
        "radius": rng.uniform(0.001, 0.005, n),
        "handles": rng.normal(size=(n, 2, 3)),
        "weight": rng.uniform(0.5, 2.0, n),
        "order": np.full(c, 4),
        "knots_mode": np.zeros(c, int),
        "resolution": np.full(c, 12),
        "attributes": {"a": rng.random((n, 4))},
    } | more
    return ControlCurves(offsets=offsets, kind=np.broadcast_to(kind, c), cyclic=np.broadcast_to(cyclic, c), **values)


def distance(points, polyline):
    """Of points (n, 3) from a polyline (m, 3)."""
    a, b = polyline[:-1], polyline[1:]
    d = b - a
    s = np.einsum("nmi,mi->nm", points[:, None] - a, d) / np.maximum(np.einsum("mi,mi->m", d, d), 1e-300)
    foot = a + np.clip(s, 0.0, 1.0)[..., None] * d
    return np.linalg.norm(points[:, None] - foot, axis=-1).min(axis=1)


def line_of(samples, i):
    points = samples.points[samples.offsets[i] : samples.offsets[i + 1]]
    return np.concatenate([points, points[:1]]) if samples.cyclic[i] else points


@pytest.mark.parametrize("kind", [CATMULL_ROM, POLY, BEZIER])
@pytest.mark.parametrize("cyclic", [False, True])
def test_samples_pass_through_the_control_points(kind, cyclic):
    curves = control([2, 5, 3], kind, cyclic)
    made = sample(curves, Sampling(steps=4))
    steps = 1 if kind == POLY else 4
    expected = [n if kind == POLY else 4 * n if cyclic else 4 * (n - 1) + 1 for n in (2, 5, 3)]
    assert np.diff(made.offsets).tolist() == expected
    for i in range(3):
        rows = slice(curves.offsets[i], curves.offsets[i + 1])
        here = slice(made.offsets[i], made.offsets[i + 1], steps)
        np.testing.assert_array_equal(made.points[here], curves.points[rows])
        np.testing.assert_array_equal(made.radius[here], curves.radius[rows])
        np.testing.assert_array_equal(made.attributes["a"][here], curves.attributes["a"][rows])


def test_bezier_between_the_points():
    curves = control([2], BEZIER)
    made = sample(curves, Sampling(steps=2))
    p0, h0, h1, p1 = curves.points[0], curves.handles[0, 1], curves.handles[1, 0], curves.points[1]
    np.testing.assert_allclose(made.points[1], (p0 + 3.0 * h0 + 3.0 * h1 + p1) / 8.0)
    assert made.radius[1] == pytest.approx(curves.radius.mean())


def test_catmull_rom_has_the_slope_of_its_neighbors():
    curves = control([4], CATMULL_ROM)
    made = sample(curves, Sampling(steps=1000))
    slope = (made.points[1001] - made.points[999]) * 500.0
    np.testing.assert_allclose(slope, (curves.points[2] - curves.points[0]) / 2.0, atol=1e-2)


def test_a_rational_quadratic_is_a_circle():
    """Seven points of a circle as three arcs of 120 degrees: Piegl and Tiller, chapter 7."""
    angle = np.radians(np.arange(7) * 60.0)
    size = np.where(np.arange(7) % 2, 2.0, 1.0)
    points = np.stack([size * np.cos(angle), size * np.sin(angle), np.zeros(7)], axis=1)
    curves = control(
        [7],
        NURBS,
        points=points,
        weight=np.where(np.arange(7) % 2, 0.5, 1.0),
        order=np.array([3]),
        knots_mode=np.array([3]),
    )
    made = sample(curves, Sampling(steps=16))
    assert len(made.points) == 3 * 16 + 1
    np.testing.assert_allclose(np.linalg.norm(made.points, axis=1), 1.0)
    np.testing.assert_allclose(made.points[[0, -1]], [(1, 0, 0), (1, 0, 0)], atol=1e-12)


def test_nurbs_of_order_2_is_its_polygon():
    curves = control([5], NURBS, order=np.array([2]), knots_mode=np.array([ENDPOINT]))
    made = sample(curves, Sampling(tolerance=1e-3))
    np.testing.assert_allclose(made.points, curves.points, atol=1e-12)


def test_knots():
    knots, offsets = knots_of(
        np.array([5, 4, 5]), 3, np.array([False, False, True]), np.array([ENDPOINT, NORMAL, NORMAL])
    )
    assert [knots[a:b].tolist() for a, b in pairwise(offsets)] == [
        [0, 0, 0, 1, 2, 3, 3, 3],
        [0, 1, 2, 3, 4, 5, 6],
        [0, 1, 2, 3, 4, 5, 6, 7, 8, 9],
    ]


@pytest.mark.parametrize("kind", [CATMULL_ROM, BEZIER, NURBS])
@pytest.mark.parametrize("tolerance", [0.1, 0.01, 0.001])
def test_no_chord_is_off_by_more_than_the_tolerance(kind, tolerance):
    curves = control([6, 9, 4], kind, [True, False, False])
    rough, fine = sample(curves, Sampling(tolerance=tolerance)), sample(curves, Sampling(steps=300))
    off = [distance(line_of(fine, i), line_of(rough, i)).max() for i in range(3)]
    assert max(off) <= tolerance
    assert max(off) > tolerance / 20.0, "and not far too fine"
    assert len(rough.points) < len(fine.points) / 5


def test_there_is_a_most_number_of_pieces(monkeypatch):
    """Near a camera among hairs the tolerance would ask for more than memory holds."""
    curves = control([6] * 20, CATMULL_ROM)
    fine = sample(curves, Sampling(tolerance=1e-6))
    most = len(fine.points) // 10
    monkeypatch.setattr(curve_sampling, "MAX_PIECES", most)
    coarser = sample(curves, Sampling(tolerance=1e-6))
    assert coarser.coarser and not fine.coarser
    assert most // 2 < len(coarser.points) <= most + 2 * len(curves.points)
    assert not sample(curves, Sampling(steps=100)).coarser, "a number of steps is what was asked for"


def test_a_straight_segment_is_one_step():
    points = np.stack([np.arange(5.0), np.zeros(5), np.zeros(5)], axis=1)
    handles = points[:, None] + np.array([(-1 / 3, 0, 0), (1 / 3, 0, 0)])
    curves = control([5], BEZIER, points=points, handles=handles)
    assert len(sample(curves, Sampling(tolerance=1e-3)).points) == 5


def test_the_tolerance_holds_for_the_radius_too():
    points = np.stack([np.arange(5.0), np.zeros(5), np.zeros(5)], axis=1)
    curves = control([5], CATMULL_ROM, points=points, radius=np.array([0.0, 0.0, 1.0, 0.0, 0.0]))
    rough, fine = sample(curves, Sampling(tolerance=0.01)), sample(curves, Sampling(steps=200))
    off = np.abs(np.interp(fine.points[:, 0], rough.points[:, 0], rough.radius) - fine.radius)
    assert off.max() <= 0.01


@pytest.mark.parametrize("kind", [CATMULL_ROM, BEZIER, NURBS])
def test_thick_strands_are_cut_so_that_no_ball_shows(kind):
    """Of a ring that is as thick as its hole is wide; the balls between its pieces are half a pixel wide or less."""
    t = 2.0 * np.pi * np.arange(8) / 8.0
    points = np.stack([np.cos(t), np.sin(t), np.zeros(8)], axis=1)
    along = 0.26 * np.stack([-np.sin(t), np.cos(t), np.zeros(8)], axis=1)
    handles = np.stack([points - along, points + along], axis=1)
    curves = control([8], kind, True, points=points, handles=handles, radius=np.full(8, 0.5), weight=np.ones(8))
    tolerance = 0.002
    d = np.diff(line_of(sample(curves, Sampling(tolerance=tolerance)), 0), axis=0)
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    angles = np.arccos(np.einsum("ni,ni->n", d[1:], d[:-1]))
    assert (0.5 * angles).max() <= 3.0 * tolerance
    assert (0.5 * angles).max() > 0.5 * tolerance
    thin = replace(curves, radius=np.full(8, 0.001))
    assert len(sample(thin, Sampling(tolerance=tolerance)).points) < len(d) / 5


def test_each_curve_can_have_a_tolerance():
    curves = control([6, 6], CATMULL_ROM)
    curves = control([6, 6], CATMULL_ROM, points=np.tile(curves.points[:6], (2, 1)))
    counts = np.diff(sample(curves, Sampling(tolerance=np.array([0.1, 0.001]))).offsets)
    assert counts[1] > 5 * counts[0]


def test_the_curves_own_resolution():
    curves = control([3, 3], CATMULL_ROM, resolution=np.array([2, 5]))
    assert np.diff(sample(curves, Sampling()).offsets).tolist() == [5, 11]


def test_types_can_be_mixed():
    rng = np.random.default_rng(8)
    counts, kinds = rng.integers(1, 9, 30), rng.integers(0, 4, 30)
    cyclic, order = rng.random(30) < 0.5, rng.integers(2, 7, 30)
    mode = rng.integers(0, 4, 30)
    together = control(counts, kinds, cyclic, order=order, knots_mode=mode)
    made = sample(together, Sampling(tolerance=0.05))
    for i in range(30):
        alone = sample(together.take(np.array([i])), Sampling(tolerance=0.05))
        rows = slice(made.offsets[i], made.offsets[i + 1])
        np.testing.assert_allclose(made.points[rows], alone.points, atol=1e-12)
        np.testing.assert_allclose(made.radius[rows], alone.radius, atol=1e-12)
        np.testing.assert_allclose(made.attributes["a"][rows], alone.attributes["a"], atol=1e-12)
        assert made.cyclic[i] == cyclic[i] == alone.cyclic[0]


@pytest.mark.parametrize(
    "curves",
    [
        control([1], CATMULL_ROM),
        control([1], BEZIER, True),
        control([3], BEZIER, handles=None),
        control([3], NURBS),
        control([4], NURBS, knots_mode=np.array([2])),
        control([3], 77),
    ],
)
def test_what_is_no_curve_of_its_type_is_its_points(curves):
    np.testing.assert_array_equal(sample(curves, Sampling(steps=8)).points, curves.points)


def test_two_points_and_back():
    made = sample(control([2], CATMULL_ROM, True), Sampling(steps=2))
    p = made.points
    assert len(p) == 4 and made.cyclic[0]
    np.testing.assert_allclose(p[1], (p[0] + p[2]) / 2.0)
    np.testing.assert_allclose(p[3], (p[0] + p[2]) / 2.0)


def test_points_that_are_no_numbers_stay_so():
    curves = control([4, 4], CATMULL_ROM)
    curves.points[5, 1] = np.nan
    made = sample(curves, Sampling(tolerance=0.01))
    assert np.isfinite(made.points[: made.offsets[1]]).all() and np.isnan(made.points[made.offsets[1] :]).any()


def test_no_curves():
    made = sample(control([], POLY), Sampling(tolerance=0.01))
    assert len(made.points) == 0 and made.offsets.tolist() == [0]
