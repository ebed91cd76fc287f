"""Hit, miss and t of every kind against the float64 reference, over sizes of 1e-4 to 1e5 and far away from them."""

import numpy as np
import pytest

from . import harness, shapes
from .cases import CONVEX, INSIDE_ONLY, each_seed, each_shape, make, roundings


@each_seed
@each_shape
def test_hits_as_the_reference(device, shape, seed):
    primitives, rng = make(shape, seed)
    origin, direction = shapes.rays(rng, primitives)
    t = harness.hits(device, primitives, origin, direction).t
    hit = shapes.assert_same_hits(t, primitives, origin, direction, roundings(shape))
    assert hit.mean() > {"cone_needle": 0.005, "triangle_sliver": 0.02}.get(shape, 0.2)


@each_seed
@pytest.mark.parametrize("shape", INSIDE_ONLY)
def test_negative_radii_are_hit_from_within_only(device, shape, seed):
    primitives, rng = make(shape, seed, INSIDE_ONLY)
    origin, direction = shapes.rays(rng, primitives, far=10.0)
    hits = harness.hits(device, primitives, origin, direction)
    hit = shapes.assert_same_hits(hits.t, primitives, origin, direction)
    assert hit.mean() > 0.2
    along = np.sum(hits.normal * direction, axis=-1)[hit]
    assert (along > -1e-3).all(), "only leaving rays hit"


@each_seed
@pytest.mark.parametrize("shape", CONVEX)
def test_rays_from_inside(device, shape, seed):
    """Origins within the body: the far side is hit, seen from behind."""
    primitives, rng = make(shape, seed)
    middle, extent = shapes.middle_and_extent(primitives)
    origin = shapes.single(
        middle + shapes.unit_vectors(rng, len(primitives)) * (extent * rng.random(len(extent)))[:, None]
    )
    inside = shapes.signed_distance(primitives, origin) < 0.0
    direction = shapes.single(shapes.unit_vectors(rng, len(primitives)))
    hits = harness.hits(device, primitives, origin, direction)
    hit = shapes.assert_same_hits(hits.t, primitives, origin, direction) & inside
    assert hit.sum() > (1000 if shape != "cone_needle" else 20)
    along = np.sum(hits.normal.astype(np.float64) * direction, axis=-1)
    assert np.quantile(along[hit], 0.001) > -1e-3


@each_seed
@pytest.mark.parametrize("shape", ["sphere", "cylinder", "cone_tip", "cone_truncated", "cone_nearly_cylindrical"])
def test_grazing_rays(device, shape, seed):
    """Rays past the silhouette by 1e-6 to 1e-1 of the size, on either side of it."""
    primitives, rng = make(shape, seed)
    n = len(primitives)
    _, extent = shapes.middle_and_extent(primitives)
    surface = on_surface(primitives, rng)
    normal, _ = primitives.reference_surface(surface)
    tangent = shapes.normalized(np.cross(normal, shapes.unit_vectors(rng, n)))
    miss = (shapes.log_uniform(rng, 1e-6, 1e-1, n) * rng.choice([-1.0, 1.0], n) * extent)[:, None]
    start = (extent * shapes.log_uniform(rng, 0.1, 100.0, n))[:, None]
    origin = shapes.single(surface + miss * normal - start * tangent)
    direction = shapes.single(shapes.normalized(surface + miss * normal - origin))
    t = harness.hits(device, primitives, origin, direction).t
    # Near a cone's tip a ray along the side makes the factor of t^2 a small difference of large numbers.
    allowed = 4.0 * shapes.BACKWARD_ROUNDINGS if shape == "cone_tip" else shapes.BACKWARD_ROUNDINGS
    hit = shapes.assert_same_hits(t, primitives, origin, direction, allowed)
    assert 0.1 < hit.mean() < 0.9


def on_surface(primitives, rng):
    """Random points (n, 3) on spheres, cylinders or cones; not within a hundredth of a tip, around which a grazing
    ray's t is only right to about 1e-5 of the cone's size."""
    n = len(primitives)
    if primitives.kind == "sphere":
        return primitives.center + shapes.unit_vectors(rng, n) * np.abs(primitives.radius)[:, None]
    share = rng.uniform(0.0, 0.99, n)[:, None]
    axis = primitives.apex - primitives.base
    radial = shapes.normalized(np.cross(axis, shapes.unit_vectors(rng, n)))
    ends = (
        (primitives.radius,) * 2 if primitives.kind == "cylinder" else (primitives.base_radius, primitives.apex_radius)
    )
    radius = ends[0][:, None] * (1.0 - share) + ends[1][:, None] * share
    return primitives.base + share * axis + np.abs(radius) * radial


@each_seed
def test_one_sided_triangles(device, seed):
    rng = np.random.default_rng(seed)
    both = shapes.exactly(shapes.triangles(rng, 20_000))
    one = both._with({"one_sided": np.ones(len(both), np.int32)})
    origin, direction = shapes.rays(rng, both)
    t_both = harness.hits(device, both, origin, direction).t
    t_one = harness.hits(device, one, origin, direction).t
    shapes.assert_same_hits(t_one, one, origin, direction)
    facing = np.sum(np.cross(both.p1 - both.p0, both.p2 - both.p0) * direction, axis=-1)
    hit = np.isfinite(t_both)
    size = np.linalg.norm(np.cross(both.p1 - both.p0, both.p2 - both.p0), axis=-1)
    clear = hit & (np.abs(facing) > 1e-3 * size)
    assert (np.isfinite(t_one)[clear] == (facing < 0.0)[clear]).all()


@each_shape
def test_t_max_is_respected(device, shape):
    """A hit beyond t_max is none; one before it is the same as without a limit."""
    primitives, rng = make(shape, 7, count=5000)
    origin, direction = shapes.rays(rng, primitives)
    free = harness.hits(device, primitives, origin, direction).t
    hit = np.isfinite(free)
    for factor in np.float32([0.5, 1.0, 1.5]):
        limit = np.where(hit, free, 1.0).astype(np.float32) * factor
        t = harness.hits(device, primitives, origin, direction, t_max=limit).t
        assert np.array_equal(t[hit], free[hit] if factor > 1.0 else np.full(hit.sum(), np.inf))
