"""The float64 reference itself, by invariants, hand-computed cases and finite differences, so that it shares no error
with the GLSL that it judges."""

import numpy as np
import pytest

from addon.engine.primitives import Cones, Cylinders, Discs, Planes, Spheres, Triangles

from . import shapes
from .cases import INSIDE_ONLY, SHAPES, make

each = pytest.mark.parametrize("shape", SHAPES)
COUNT = 4000


def on_primitive(primitives, point, tolerance):
    """Whether points (n, 3) lie on the finite surfaces, by distances alone."""
    on = np.abs(shapes.signed_distance(primitives, point)) <= tolerance
    if primitives.kind in ("cylinder", "cone"):
        height, _, length = shapes.axis_coordinates(primitives, point)
        on &= (height >= -tolerance) & (height <= length + tolerance)
    if primitives.kind == "disc":
        on &= np.linalg.norm(point - primitives.center, axis=-1) <= primitives.radius + tolerance
    if primitives.kind == "triangle":
        p = [primitives.p0, primitives.p1, primitives.p2]
        normal = shapes.normalized(np.cross(p[1] - p[0], p[2] - p[0]))
        for a, b in zip(p, [*p[1:], p[0]], strict=True):
            on &= np.sum(np.cross(b - a, point - a) * normal, axis=-1) >= -tolerance * np.linalg.norm(b - a, axis=-1)
    return on


@each
def test_hits_lie_on_the_shape_and_nothing_lies_before_them(shape):
    """The nearest hit is on the surface; walking there in 200 steps crosses no other piece of it."""
    primitives, rng = make(shape, 0, count=COUNT)
    origin, direction = shapes.rays(rng, primitives, near=0.3, far=5.0)
    direction = shapes.normalized(direction)
    t = primitives.reference_hit(origin, direction)
    _, extent = shapes.middle_and_extent(primitives)
    hit = np.isfinite(t)
    rows, end = primitives.take(hit), np.where(hit, t, np.linalg.norm(origin, axis=-1) * 2 + 20.0 * extent)
    assert on_primitive(
        rows, (origin + np.where(hit, t, 0)[:, None] * direction)[hit], 1e-9 * reach(primitives)[hit]
    ).all()
    steps = np.linspace(0.0, 1.0, 200)[:-1]
    before = None
    for step in steps:
        point = origin + (end * step)[:, None] * direction
        side = shapes.signed_distance(primitives, point) > 0.0
        if before is not None:
            crossed = side != before[0]
            # Where the infinite surface is crossed before t it must be beyond the edges of the finite one.
            middle = (point + before[1]) / 2.0
            gap = np.linalg.norm(point - before[1], axis=-1)
            assert not (crossed & well_within(primitives, middle, gap)).any()
        before = (side, point)


def reach(primitives):
    middle, extent = shapes.middle_and_extent(primitives)
    return np.linalg.norm(middle, axis=-1) + extent


def well_within(primitives, point, margin):
    """Whether a crossing of the infinite surface within `margin` of a point is one of the finite surface."""
    if primitives.kind in ("sphere", "plane"):
        return np.ones(len(point), bool)
    if primitives.kind in ("cylinder", "cone"):
        height, _, length = shapes.axis_coordinates(primitives, point)
        return (height >= margin) & (height <= length - margin)
    if primitives.kind == "disc":
        return np.linalg.norm(point - primitives.center, axis=-1) <= primitives.radius - margin
    p = [primitives.p0, primitives.p1, primitives.p2]
    normal = shapes.normalized(np.cross(p[1] - p[0], p[2] - p[0]))
    within = np.ones(len(point), bool)
    for a, b in zip(p, [*p[1:], p[0]], strict=True):
        within &= np.sum(np.cross(b - a, point - a) * normal, axis=-1) > margin * np.linalg.norm(b - a, axis=-1)
    return within


@pytest.mark.parametrize("shape", INSIDE_ONLY)
def test_negative_radii_show_the_side_that_rays_leave(shape):
    primitives, rng = make(shape, 0, INSIDE_ONLY, COUNT)
    origin, direction = shapes.rays(rng, primitives, far=5.0)
    direction = shapes.normalized(direction)
    t = primitives.reference_hit(origin, direction)
    hit = np.isfinite(t)
    step = 1e-6 * shapes.middle_and_extent(primitives)[1]
    ahead, behind = (origin + (np.where(hit, t, 0) + s)[:, None] * direction for s in (step, -step))
    leaves = shapes.signed_distance(primitives, ahead) > shapes.signed_distance(primitives, behind)
    assert hit.sum() > 100 and leaves[hit].all()


@pytest.mark.parametrize("shape", [name for name in SHAPES if not name.startswith("triangle")])
def test_normals_are_the_gradient_of_the_distance(shape):
    primitives, rng = make(shape, 1, count=COUNT)
    point, rows = hit_points(primitives, rng)
    normal, _ = rows.reference_surface(point)
    assert np.allclose(np.linalg.norm(normal, axis=-1), 1.0, atol=1e-12)
    step = (1e-6 * shapes.sharpest_radius(rows, point))[:, None]
    gradient = [
        (shapes.signed_distance(rows, point + step * e) - shapes.signed_distance(rows, point - step * e))
        / (2 * step[:, 0])
        for e in np.eye(3)
    ]
    exact = 1e-16 * reach(rows) / step[:, 0] < 1e-6
    assert exact.mean() > 0.1
    assert np.abs(np.stack(gradient, axis=-1) - normal)[exact].max() < 1e-4


def hit_points(primitives, rng):
    origin, direction = shapes.rays(rng, primitives, far=5.0)
    direction = shapes.normalized(direction)
    t = primitives.reference_hit(origin, direction)
    hit = np.isfinite(t)
    return (origin + np.where(hit, t, 0)[:, None] * direction)[hit], primitives.take(hit)


def test_uv_gives_back_the_point():
    """The paper's parametrisations, written out the other way round: from uv to the point."""
    rng = np.random.default_rng(2)
    n = 1000
    uv = rng.uniform(0.01, 0.99, (n, 2))
    (u, v), turn = uv.T, 2.0 * np.pi * uv[:, :1]
    for shape in ("sphere", "cylinder", "cone_truncated", "disc", "plane"):
        p, _ = make(shape, 3, count=n)
        up = {"sphere": "pole", "disc": "normal", "plane": "normal"}.get(p.kind)
        up = getattr(p, up) if up else shapes.normalized(p.apex - p.base)
        e0 = shapes.normalized(p.meridian - np.sum(p.meridian * up, axis=-1, keepdims=True) * up)
        e1 = np.cross(up, e0)
        around = np.cos(turn) * e0 + np.sin(turn) * e1
        if p.kind == "sphere":
            theta = np.pi * (1.0 - v[:, None])
            point = p.center + p.radius[:, None] * (np.sin(theta) * around + np.cos(theta) * up)
        elif p.kind in ("cylinder", "cone"):
            p = p._with({"planar": np.zeros(n, int)}) if p.kind == "cone" else p
            ends = (p.radius, p.radius) if p.kind == "cylinder" else (p.base_radius, p.apex_radius)
            radius = ends[0] * (1.0 - v) + ends[1] * v
            point = p.base + v[:, None] * (p.apex - p.base) + radius[:, None] * around
        elif p.kind == "disc":
            point = p.center + 2.0 * p.radius[:, None] * ((u - 0.5)[:, None] * e0 + (v - 0.5)[:, None] * e1)
        else:
            point = p.point + p.tile[:, None] * (u[:, None] * e0 + v[:, None] * e1)
        _, found = p.reference_surface(point)
        transform = getattr(p, "uv_transform", np.tile([1.0, 1.0, 0.0, 0.0], (n, 1)))
        rounding = 1e-14 * (reach(p) / shapes.sharpest_radius(p, point))[:, None] + 1e-7
        assert (np.abs(found - (uv * transform[:, :2] + transform[:, 2:])) < 10 * rounding).all(), shape


def test_a_triangle_s_uv_and_normal_are_those_of_its_vertices():
    p, _ = make("triangle", 4, count=500)
    for i in range(3):
        normal, uv = p.reference_surface(getattr(p, f"p{i}"))
        assert np.allclose(uv, getattr(p, f"uv{i}"), atol=1e-6)
        assert np.allclose(normal, shapes.normalized(getattr(p, f"n{i}")), atol=1e-5)
    middle = (p.p0 + p.p1 + p.p2) / 3.0
    assert np.allclose(p.reference_surface(middle)[1], (p.uv0 + p.uv1 + p.uv2) / 3.0, atol=1e-6)


def test_cases_computed_by_hand():
    def t(primitives, origin, direction):
        return primitives.reference_hit(np.array([origin], float), shapes.normalized(np.array([direction], float)))[0]

    assert t(Spheres(center=[[0, 0, 5]], radius=[2]), [0, 0, 0], [0, 0, 1]) == 3.0
    assert t(Spheres(center=[[0, 0, 5]], radius=[-2]), [0, 0, 0], [0, 0, 1]) == 7.0
    assert t(Spheres(center=[[3, 0, 4]], radius=[1]), [0, 0, 0], [3, 0, 4]) == pytest.approx(4.0)
    cylinder = Cylinders(base=[[0, 0, 0]], apex=[[0, 0, 4]], radius=[1])
    assert t(cylinder, [-3, 0, 1], [1, 0, 0]) == 2.0
    assert t(cylinder, [-3, 0, 0], [3, 0, 3]) == pytest.approx(2.0 * np.sqrt(2.0))
    assert t(cylinder, [0, 0, -1], [0, 0, 1]) == np.inf
    cone = Cones(base=[[0, 0, 0]], apex=[[0, 0, 2]], base_radius=[1])
    assert t(cone, [-3, 0, 1], [1, 0, 0]) == pytest.approx(2.5)
    assert t(cone, [-3, 0, 3], [1, 0, 0]) == np.inf, "the mirrored nappe is not there"
    truncated = Cones(base=[[0, 0, 0]], apex=[[0, 0, 2]], base_radius=[2], apex_radius=[1])
    assert t(truncated, [5, 0, 1], [-1, 0, 0]) == pytest.approx(3.5)
    assert t(Discs(center=[[0, 0, 1]], normal=[[0, 0, 1]], radius=[1]), [0.5, 0, 4], [0, 0, -1]) == 3.0
    assert t(Planes(point=[[0, 0, 1]], normal=[[0, 0, 1]]), [9, 9, 3], [1, 0, -1]) == pytest.approx(2 * np.sqrt(2))
    triangle = Triangles(p0=[[0, 0, 0]], p1=[[2, 0, 0]], p2=[[0, 2, 0]])
    assert t(triangle, [0.5, 0.5, 1], [0, 0, -1]) == 1.0 and t(triangle, [1.5, 1.5, 1], [0, 0, -1]) == np.inf


@pytest.mark.parametrize("shape", [name for name in SHAPES if name != "plane"])
def test_bounds_hold_every_hit(shape):
    primitives, rng = make(shape, 5, count=COUNT)
    point, rows = hit_points(primitives, rng)
    lower, upper = rows.bounds()
    slack = 1e-9 * reach(rows)[:, None]
    assert (point >= lower - slack).all() and (point <= upper + slack).all()
