"""Rays that formulas stumble over: along axes, through tips, edges and vertices, in planes. Expected values by hand."""

import numpy as np
import pytest

from addon.engine.primitives import Cones, Cylinders, Discs, Planes, Spheres, Triangles

from . import harness, shapes

AXES = np.concatenate([np.eye(3), -np.eye(3)])


def one(device, primitives, origin, direction, **options):
    """`Hits` of rays with one primitive each of a kind that is given once."""
    origin = np.atleast_2d(np.asarray(origin, float))
    direction = np.broadcast_to(np.atleast_2d(np.asarray(direction, float)), origin.shape)
    many = primitives.take(np.zeros(len(origin), int))
    return harness.hits(device, many, origin, direction, **options)


@pytest.mark.parametrize("scale", [1e-4, 1.0, 1e5])
def test_axis_parallel_rays_at_a_sphere(device, scale):
    hits = one(device, Spheres(center=[[0, 0, 0]], radius=[scale]), -3.0 * scale * AXES, AXES)
    assert np.allclose(hits.t, 2.0 * scale, rtol=2e-7)
    assert np.array_equal(hits.normal, -AXES)
    hits = one(device, Spheres(center=[[0, 0, 0]], radius=[scale]), 0.0 * AXES, AXES)
    assert np.allclose(hits.t, scale, rtol=2e-7) and np.array_equal(hits.normal, AXES)


@pytest.mark.parametrize("scale", [1e-4, 1.0, 1e5])
def test_rays_along_the_axis_of_a_cylinder_miss_its_side(device, scale):
    rng = np.random.default_rng(0)
    axis = np.concatenate([AXES, shapes.unit_vectors(rng, 2000)])
    cylinders = shapes.exactly(Cylinders(base=-axis * scale, apex=axis * scale, radius=np.full(len(axis), 0.5 * scale)))
    direction = shapes.single(axis)
    for offset in (0.0, 0.4, 0.6):
        across = np.cross(axis, shapes.unit_vectors(rng, len(axis)))
        origin = shapes.single((-3.0 * axis + offset * shapes.normalized(across)) * scale)
        assert not np.isfinite(harness.hits(device, cylinders, origin, direction).t).any()


def test_rays_across_a_cylinder(device):
    """Both sides of the ends; exactly at an end the side is closed."""
    cylinder = Cylinders(base=[[0, 0, 0]], apex=[[0, 0, 2.0]], radius=[0.5])
    z = np.array([0.0, 1e-6, 1.0, 2.0, -1e-6, 2.00001])
    origin = np.stack([np.full(6, -2.0), np.zeros(6), z], axis=-1)
    hits = one(device, cylinder, origin, [1.0, 0.0, 0.0])
    assert np.allclose(hits.t[:4], 1.5) and not np.isfinite(hits.t[4:]).any()
    assert np.allclose(hits.uv[:3, 0], 0.5) and np.allclose(hits.uv[:4, 1], z[:4] / 2.0, atol=1e-6)


@pytest.mark.parametrize("scale", [1e-4, 1.0, 1e5])
def test_rays_through_the_tip_of_a_cone(device, scale):
    """Towards the tip from all around; rounding decides on which side of it they pass. No answer is not a number."""
    rng = np.random.default_rng(1)
    n = 5000
    axis = shapes.unit_vectors(rng, n)
    cones = shapes.exactly(Cones(base=-axis * scale, apex=np.zeros((n, 3)), base_radius=np.full(n, 0.5 * scale)))
    tip = cones.apex
    origin = shapes.single(tip + 3.0 * scale * shapes.unit_vectors(rng, n))
    direction = shapes.single(shapes.normalized(tip - origin))
    hits = harness.hits(device, cones, origin, direction)
    hit = np.isfinite(hits.t)
    away = np.linalg.norm(origin + hits.t[:, None] * direction - tip, axis=-1)[hit]
    steep = np.abs(np.sum(direction * axis, axis=-1)) > 1.0 / np.sqrt(1.25) + 0.01
    from_above = np.sum(direction * axis, axis=-1) < 0.0
    assert hit[steep].mean() > 0.98, "a ray steeper than the side meets it at the tip, but for rounding there"
    assert (away[(steep & from_above)[hit]] < 2e-3 * scale).all()
    for values in (hits.position, hits.normal, hits.uv):
        assert np.isfinite(values[hit]).all()
    assert not np.isnan(hits.t).any()


def test_a_ray_down_the_axis_of_a_cone_hits_the_tip(device):
    cone = Cones(base=[[0, 0, 0]], apex=[[0, 0, 1.0]], base_radius=[0.5])
    hits = one(device, cone, [[0, 0, 3.0], [0, 0, -3.0], [0, 0, 0.5]], [[0, 0, -1.0], [0, 0, 1.0], [0, 0, 1.0]])
    assert np.allclose(hits.t, [2.0, 4.0, 0.5])
    assert np.isfinite(hits.normal).all() and np.isfinite(hits.uv).all()


def test_rays_along_the_side_of_a_cone(device):
    """Parallel to a generator the quadratic has one root: at half the height on the other side."""
    cone = Cones(base=[[0, 0, 0]], apex=[[0, 0, 1.0]], base_radius=[1.0])
    direction = shapes.normalized(np.array([[1.0, 0.0, -1.0]]))
    hits = one(device, cone, [[-2.0, 0.0, 2.0 - 0.5]], direction)
    assert np.allclose(hits.position, [[-0.75, 0.0, 0.25]], atol=1e-6)


def test_rays_in_the_plane_of_flat_shapes_miss(device):
    angle = np.linspace(0.0, 2.0 * np.pi, 100)
    direction = shapes.single(np.stack([np.cos(angle), np.sin(angle), np.zeros(100)], axis=-1))
    origin = -3.0 * direction
    origin[:, 2] = 0.5
    for flat in (
        Discs(center=[[0, 0, 0.5]], normal=[[0, 0, 1.0]], radius=[1.0]),
        Planes(point=[[0, 0, 0.5]], normal=[[0, 0, 1.0]]),
        Triangles(p0=[[-1, -1, 0.5]], p1=[[1, -1, 0.5]], p2=[[0, 1, 0.5]]),
    ):
        assert not np.isfinite(one(device, flat, origin, direction).t).any(), flat.kind


def test_the_edge_and_centre_of_a_disc(device):
    disc = Discs(center=[[1.0, 0, 0]], normal=[[0, 0, 1.0]], radius=[2.0])
    x = np.array([1.0, 2.9999, 3.0, 3.0001])
    hits = one(device, disc, np.stack([x, np.zeros(4), np.full(4, 5.0)], axis=-1), [0, 0, -1.0])
    assert np.allclose(hits.t[:3], 5.0) and hits.t[3] == np.inf
    assert np.allclose(hits.uv[:3], [[0.5, 0.5], [0.99998, 0.5], [1.0, 0.5]], atol=1e-5)


def test_the_edges_and_vertices_of_a_triangle(device):
    triangle = Triangles(p0=[[0, 0, 0]], p1=[[1.0, 0, 0]], p2=[[0, 1.0, 0]], uv0=[[0, 0]], uv1=[[1, 0]], uv2=[[0, 1]])
    inside = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0], [0, 0.5], [0.5, 0.5], [0.25, 0.25]])
    outside = np.array([[-1e-6, 0.5], [0.5, -1e-6], [0.500001, 0.5], [1.00001, 0]])
    points = np.concatenate([inside, outside])
    hits = one(device, triangle, np.column_stack([points, np.full(len(points), 2.0)]), [0, 0, -1.0])
    assert (hits.t[:7] == 2.0).all() and (hits.t[7:] == np.inf).all()
    assert np.allclose(hits.uv[:7], inside, atol=1e-7) and (hits.normal[:7] == [0, 0, 1]).all()


def test_the_paper_s_uv_at_named_points(device):
    """Sphere (6): u = phi / 2 pi from e0 to e1 = e2 x e0, v = 1 at the pole. Cylinder (10), cone (13): v = z / l."""
    directions = shapes.normalized(np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1.0]]))
    expected = np.array([[0, 0.5], [0.25, 0.5], [0.5, 0.5], [0.75, 0.5], [0, 1], [0, 0]])
    hits = one(device, Spheres(center=[[0, 0, 0]], radius=[2.0]), 5.0 * directions, -directions)
    assert np.allclose(hits.uv, expected, atol=1e-6)
    turned = Spheres(center=[[0, 0, 0]], radius=[2.0], pole=[[1.0, 0, 0]], meridian=[[0, 1.0, 0]])
    hits = one(device, turned, [[0, 5.0, 0], [0, 0, 5.0], [5.0, 0, 0]], [[0, -1.0, 0], [0, 0, -1.0], [-1.0, 0, 0]])
    assert np.allclose(hits.uv[:2], [[0, 0.5], [0.25, 0.5]], atol=1e-6) and abs(hits.uv[2, 1] - 1.0) < 1e-6
    around = 5.0 * directions[:4] + [0, 0, 0.5]
    cylinder = Cylinders(base=[[0, 0, 0]], apex=[[0, 0, 2.0]], radius=[1.0])
    assert np.allclose(one(device, cylinder, around, -directions[:4]).uv, expected[:4] * [1, 0.5], atol=1e-6)
    cone = Cones(base=[[0, 0, 0]], apex=[[0, 0, 2.0]], base_radius=[1.0])
    hits = one(device, cone, around, -directions[:4])
    assert np.allclose(hits.uv, expected[:4] * [1, 0.5], atol=1e-6) and np.allclose(hits.t, 5.0 - 0.75)
    assert np.allclose(hits.normal[0], np.array([2.0, 0, 1.0]) / np.sqrt(5.0), atol=1e-6)
    disc = Discs(center=[[0, 0, 0]], normal=[[0, 0, 1.0]], radius=[2.0])
    hits = one(device, disc, [[0, 0, 1.0], [1.0, 0, 1.0], [0, 1.0, 1.0]], [0, 0, -1.0])
    assert np.allclose(hits.uv, [[0.5, 0.5], [0.75, 0.5], [0.5, 0.75]], atol=1e-6)


def test_u_stays_below_one_at_the_seam(device):
    """A hair before u = 1 the angle rounds to it; the paper's u is in [0, 1)."""
    angle = -np.geomspace(1e-12, 1e-3, 500)
    direction = np.stack([np.cos(angle), np.sin(angle), np.zeros(500)], axis=-1)
    hits = one(device, Spheres(center=[[0, 0, 0]], radius=[1.0]), 3.0 * direction, -direction)
    assert (hits.uv[:, 0] >= 0.0).all() and (hits.uv[:, 0] < 1.0).all()


def test_one_uv_for_all_of_a_sphere(device):
    """Where it is given; beside spheres without, and whatever the rotation of those."""
    rng = np.random.default_rng(2)
    n = 3000
    fixed = rng.uniform(-3.0, 3.0, (n, 2)).astype(np.float32)
    fixed[::3] = np.nan
    spheres = Spheres(
        center=np.zeros((n, 3)),
        radius=np.ones(n),
        pole=shapes.unit_vectors(rng, n),
        meridian=shapes.unit_vectors(rng, n),
        fixed_uv=fixed,
    )
    origin = shapes.single(5.0 * shapes.unit_vectors(rng, n))
    hits = harness.hits(device, spheres, origin, shapes.single(shapes.normalized(-origin)))
    has = np.isfinite(fixed[:, 0])
    assert np.array_equal(hits.uv[has], fixed[has])
    _, uv = spheres.take(~has).reference_surface(hits.position[~has].astype(np.float64))
    away = np.abs(hits.uv[~has] - uv)
    assert (np.minimum(away, np.abs(away - (1.0, 0.0))) < 1e-3).mean() > 0.99
