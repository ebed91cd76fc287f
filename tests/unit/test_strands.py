"""Polylines and edges as spheres, cylinders and cones, compared with unions of balls in float64."""

import numpy as np
import pytest

from addon.engine import rotations
from addon.engine.strands import JOINT_U, Polylines, edges, strands

RNG_SEEDS = range(6)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def nearest_hit(made, origin, direction):
    """Nearest t (k,) of rays on all the primitives together, inf for a miss."""
    best = np.full(len(origin), np.inf)
    for part in (made.spheres, made.cylinders, made.cones):
        for i in range(len(part) if part is not None else 0):
            one = part.take(np.full(len(origin), i))
            best = np.minimum(best, one.reference_hit(origin, direction))
    return best


def nearest_ball(pieces, origin, direction, balls=1500):
    """The same by brute force: the balls along each piece (p0, r0, p1, r1)."""
    best = np.full(len(origin), np.inf)
    for p0, r0, p1, r1 in pieces:
        s = np.linspace(0.0, 1.0, balls)[:, None]
        center, radius = p0 + s * (p1 - p0), (r0 + s * (r1 - r0))[:, 0]
        to_center = center[None] - origin[:, None]
        along = np.einsum("kbi,ki->kb", to_center, direction)
        squared = radius**2 - (np.einsum("kbi,kbi->kb", to_center, to_center) - along**2)
        t = np.where(squared >= 0.0, along - np.sqrt(np.maximum(squared, 0.0)), np.inf)
        best = np.minimum(best, t.min(axis=1))
    return best


def rays_at(rng, points, count=300, distance=20.0):
    """Rays from afar towards somewhere near the points."""
    origin = distance * unit(rng.normal(size=(count, 3)))
    target = points[rng.integers(len(points), size=count)] + 0.4 * rng.normal(size=(count, 3))
    return origin, unit(target - origin)


def assert_same_solid(made, pieces, rng, points):
    origin, direction = rays_at(rng, points)
    found, expected = nearest_hit(made, origin, direction), nearest_ball(pieces, origin, direction)
    both = np.isfinite(found) & np.isfinite(expected)
    assert both.sum() > 40
    np.testing.assert_allclose(found[both], expected[both], atol=2e-3)  # balls leave dents between them
    assert (np.isfinite(found) != np.isfinite(expected)).sum() <= 2, "only at the outline"


@pytest.mark.parametrize("seed", RNG_SEEDS)
@pytest.mark.parametrize("cyclic", [False, True])
def test_a_polyline_is_the_union_of_its_balls(seed, cyclic):
    """Sharp bends, tapers, balls inside others: from outside there is neither a gap nor a bulge."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(7, 3))
    radius = rng.choice([0.0, 0.05, 0.2, 0.2, 0.6], size=7)
    made = strands(Polylines(points, [0, 7], radius, cyclic))
    pairs = [(i, (i + 1) % 7) for i in range(7 if cyclic else 6)]
    pieces = [(points[i], radius[i], points[j], radius[j]) for i, j in pairs]
    assert_same_solid(made, pieces, rng, points)


@pytest.mark.parametrize("seed", RNG_SEEDS)
def test_edges_are_the_union_of_their_balls(seed):
    rng = np.random.default_rng(seed)
    points, radius = rng.normal(size=(5, 3)), rng.choice([0.05, 0.1, 0.3], size=5)
    ends = [(0, 1), (1, 2), (1, 3), (3, 0)]
    made = edges(points, ends, radius)
    assert len(made.spheres) <= 4, "one a vertex, none where there is no edge"
    assert_same_solid(made, [(points[i], radius[i], points[j], radius[j]) for i, j in ends], rng, points[:4])


def test_what_a_segment_becomes():
    line = [(0, 0, 0), (0, 0, 1)]
    cylinder = strands(Polylines(line, [0, 2], 0.1))
    assert len(cylinder.cylinders) == 1 and cylinder.cones is None and len(cylinder.spheres) == 2
    assert strands(Polylines(line, [0, 2], np.float32([0.1, 0.1 * (1 + 1e-7)]))).cones is None, "float32 rounding"
    cone = strands(Polylines(line, [0, 2], [0.1, 0.05]))
    assert len(cone.cones) == 1 and cone.cylinders is None and len(cone.spheres) == 2
    pointed = strands(Polylines(line, [0, 2], [0.1, 0.0]))
    assert pointed.cones.apex_radius.tolist() == [0.0] and pointed.cones.apex.tolist() == [[0, 0, 1]]
    assert len(pointed.spheres) == 1, "no ball at the tip"
    assert strands(Polylines(line, [0, 2], 0.0)).geometry() is None
    swallowed = strands(Polylines(line, [0, 2], [0.1, 1.5]))
    assert swallowed.cones is None and swallowed.spheres.radius.tolist() == [1.5]


def test_joints_are_shared():
    square = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    opened, closed = (strands(Polylines(square, [0, 4], 0.1, cyclic)) for cyclic in (False, True))
    assert len(opened.cylinders) == 3 and len(closed.cylinders) == 4
    assert len(opened.spheres) == len(closed.spheres) == 4
    assert len(strands(Polylines(square[:2], [0, 2], 0.1, True)).cylinders) == 1, "two points close nothing"


def test_points_that_coincide():
    made = strands(Polylines([(0, 0, 0)] * 3 + [(1, 0, 0)] * 2, [0, 5], [0.1, 0.2, 0.2, 0.1, 0.1]))
    assert len(made.cones) == 1 and sorted(made.spheres.radius) == [0.1, 0.2]
    ball = strands(Polylines([(1, 2, 3)] * 3, [0, 3], [0.1, 0.2, 0.2], True))
    assert ball.cones is None and ball.cylinders is None and ball.spheres.center.tolist() == [[1, 2, 3]]


def test_a_single_point_is_a_ball():
    made = strands(Polylines([(1, 2, 3), (0, 0, 0), (0, 0, 1)], [0, 1, 1, 3], 0.5))
    assert len(made.spheres) == 3 and len(made.cylinders) == 1


def test_nothing_at_all():
    for made in (strands(Polylines(np.zeros((0, 3)), [0], 0.1)), edges(np.zeros((0, 3)), [], 0.1)):
        assert made.geometry() is None and made.dropped == 0


def test_what_is_not_finite_is_dropped_and_counted():
    points = np.arange(27.0).reshape(9, 3)
    points[1, 0] = np.nan
    radius = np.full(9, 0.1)
    radius[5] = np.inf
    made = strands(Polylines(points, [0, 3, 6, 9], radius))
    assert made.dropped == 2 and len(made.cylinders) == 2 and len(made.spheres) == 3
    made = edges(points, [(0, 1), (2, 3), (4, 5)], radius)
    assert made.dropped == 2 and len(made.cylinders) == 1


def test_negative_radii_are_zero():
    made = strands(Polylines([(0, 0, 0), (0, 0, 1), (0, 0, 2)], [0, 3], [0.1, -0.5, -1.0]))
    assert len(made.cones) == 1 and made.cones.apex_radius.tolist() == [0.0] and len(made.spheres) == 1


def test_v_runs_by_length():
    points = [(0, 0, 0), (3, 0, 0), (3, 1, 0), (5, 5, 5), (6, 5, 5)]
    made = strands(Polylines(points, [0, 3, 5], 0.1))
    np.testing.assert_allclose(made.spheres.fixed_uv, [(JOINT_U, v) for v in (0.0, 0.75, 1.0, 0.0, 1.0)])
    np.testing.assert_allclose(made.cylinders.uv_transform, [(1, 0.75, 0, 0), (1, 0.25, 0, 0.75), (1, 1, 0, 0)])
    _, uv = made.cylinders.reference_surface(np.array([(1.5, 0.1, 0), (3.1, 0.5, 0), (5.5, 5.1, 5)]))
    np.testing.assert_allclose(uv[:, 1], (0.375, 0.875, 0.5))


def test_v_of_a_closed_polyline_comes_round_to_1():
    made = strands(Polylines([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [0, 4], 0.1, True))
    np.testing.assert_allclose(np.sort(made.spheres.fixed_uv[:, 1]), (0.0, 0.25, 0.5, 0.75))
    by_v = made.cylinders.uv_transform[np.argsort(made.cylinders.uv_transform[:, 3])]
    np.testing.assert_allclose(by_v[:, [1, 3]], [(0.25, v) for v in (0.0, 0.25, 0.5, 0.75)])


def test_v_can_be_given():
    made = strands(Polylines([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [0, 3], 0.1, v=[0.0, 0.9, 1.0]))
    np.testing.assert_allclose(made.cylinders.uv_transform[:, [1, 3]], [(0.9, 0.0), (0.1, 0.9)], atol=1e-7)


def test_materials_and_attributes_of_points_and_curves():
    rows = np.arange(20.0).reshape(5, 4)
    points = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 5, 0), (1, 5, 0)]
    made = strands(
        Polylines(points, [0, 3, 5], 0.1, material=[2, 7], attributes={"point": rows}, of_polylines={"curve": rows[:2]})
    )
    assert made.cylinders.material.tolist() == [2, 2, 7] and made.spheres.material.tolist() == [2, 2, 2, 7, 7]
    at_ends = made.cylinders.attributes["point"]
    assert at_ends.shape == (3, 2, 4) and at_ends.tolist() == rows[[(0, 1), (1, 2), (3, 4)]].tolist()
    assert made.spheres.attributes["point"][:, 0].tolist() == rows.tolist()
    assert made.cylinders.attributes["curve"][:, 0].tolist() == rows[[0, 0, 1]].tolist()


def test_the_closing_segment_goes_back_to_the_first_value():
    rows = np.arange(12.0).reshape(3, 4)
    made = strands(Polylines([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [0, 3], 0.1, True, attributes={"a": rows}))
    pairs = sorted(made.cylinders.attributes["a"][:, :, 0].tolist())
    assert pairs == [[0.0, 4.0], [4.0, 8.0], [8.0, 0.0]]


def helix(count=200, turns=5.0):
    t = np.linspace(0.0, 2.0 * np.pi * turns, count)
    return np.stack([np.cos(t), np.sin(t), 0.2 * t], axis=1)


def test_meridians_do_not_twist():
    """Each is the one before turned by the smallest rotation between the axes, as a loop finds it."""
    points = np.concatenate([helix(), helix()[::-1] * (1, 2, 3) + 10.0, [(0, 0, 0), (1, 0, 0), (0, 0, 0), (1, 1, 0)]])
    made = strands(Polylines(points, [0, 200, 400, 404], 0.01)).cylinders
    axis = unit(made.apex - made.base)
    for i in range(1, len(axis)):
        if i in (199, 398):
            continue  # the first of its polyline
        cosine = axis[i - 1] @ axis[i]
        if cosine < -1.0 + 1e-9:
            assert abs(made.meridian[i] @ axis[i]) < 1e-6
            continue
        k = np.cross(axis[i - 1], axis[i])
        m = made.meridian[i - 1].astype(np.float64)
        np.testing.assert_allclose(
            made.meridian[i], m + np.cross(k, m) + np.cross(k, np.cross(k, m)) / (1 + cosine), atol=1e-6
        )


def test_meridians_of_a_closed_polyline_close_up():
    t = np.linspace(0.0, 2.0 * np.pi, 100, endpoint=False)
    points = np.stack([np.cos(t), np.sin(t), 0.7 * np.sin(3.0 * t + 1.0) * np.cos(t)], axis=1)
    made = strands(Polylines(points, [0, 100], 0.01, True)).cylinders
    axis = unit(made.apex - made.base)
    order = [int(np.flatnonzero((made.base == p).all(axis=1))[0]) for p in points]
    axis, meridian = axis[order], made.meridian[order].astype(np.float64)
    np.testing.assert_allclose(np.einsum("ni,ni->n", axis, meridian), 0.0, atol=1e-6)
    turned = rotations.rotated(rotations.between(axis, np.roll(axis, -1, axis=0)), meridian)
    after = np.roll(meridian, -1, axis=0)
    twist = np.arctan2(
        np.einsum("ni,ni->n", np.cross(turned, after), np.roll(axis, -1, axis=0)), np.einsum("ni,ni->n", turned, after)
    )
    assert np.ptp(twist) < 1e-5 and abs(twist[0]) <= np.pi / 100 + 1e-9, "the same small twist at every joint"


@pytest.mark.parametrize("at_once", [1, 50, 1 << 16])
def test_many_polylines_are_each_by_itself(at_once, monkeypatch):
    monkeypatch.setattr("addon.engine.strands._AT_ONCE", at_once)
    rng = np.random.default_rng(1)
    counts = rng.integers(1, 9, size=40)
    offsets = np.concatenate([[0], np.cumsum(counts)])
    points, radius = rng.normal(size=(offsets[-1], 3)), rng.uniform(0.0, 0.3, size=offsets[-1])
    cyclic = rng.random(40) < 0.4
    together = strands(Polylines(points, offsets, radius, cyclic))
    alone = [
        strands(Polylines(points[a:b], [0, b - a], radius[a:b], c))
        for a, b, c in zip(offsets[:-1], offsets[1:], cyclic, strict=True)
    ]
    for kind, columns in (
        ("spheres", ("center", "radius", "fixed_uv")),
        ("cones", ("base", "apex", "base_radius", "apex_radius", "meridian", "uv_transform")),
    ):
        for column in columns:
            expected = [getattr(getattr(one, kind), column) for one in alone if getattr(one, kind) is not None]
            np.testing.assert_allclose(getattr(getattr(together, kind), column), np.concatenate(expected), atol=1e-6)


def test_running_products():
    rng = np.random.default_rng(2)
    for count in (1, 2, 3, 8, 13):
        q = unit(rng.normal(size=(count, 4))).T
        running = rotations.running_products(q)
        expected = q[:, :1]
        for i in range(1, count):
            expected = rotations.product(q[:, i : i + 1], expected)
            np.testing.assert_allclose(running[:, i : i + 1], expected, atol=1e-12)
