"""Position, normals, uv and error of every kind, and the rays that leave the surface."""

import numpy as np
import pytest

from . import harness, shapes
from .cases import CONVEX, FLAT, each_seed, each_shape, make
from .shapes import ROUNDOFF

#: Roundings between a point on a surface and its normal and uv; a half of the product's bound on positions.
SURFACE_ROUNDINGS = 32.0


def hit_pairs(device, shape, seed, near=1e-2):
    """Primitives, rays and `Hits` of the pairs that hit, with the random generator."""
    primitives, rng = make(shape, seed)
    origin, direction = shapes.rays(rng, primitives, near)
    rows = np.isfinite(harness.hits(device, primitives, origin, direction).t)
    primitives, origin, direction = primitives.take(rows), origin[rows], direction[rows]
    return primitives, origin, direction, harness.hits(device, primitives, origin, direction), rng


def coordinates(primitives):
    """The size (n,) of the numbers that a primitive's positions are made of."""
    middle, extent = shapes.middle_and_extent(primitives)
    return np.linalg.norm(middle, axis=-1) + extent


@each_seed
@each_shape
def test_position_lies_on_the_surface(device, shape, seed):
    primitives, _, _, hits, _ = hit_pairs(device, shape, seed)
    distance = np.abs(shapes.signed_distance(primitives, hits.position))
    size = np.linalg.norm(hits.position, axis=-1) if shape == "plane" else 0.0
    assert (distance <= hits.error / 4.0).all(), (distance / hits.error).max()
    assert (hits.error <= 2.0**-16 * (coordinates(primitives) + size)).all(), "no more than rounding asks for"


@each_seed
@each_shape
def test_position_lies_on_the_ray(device, shape, seed):
    """Across the ray, by the rounding of the lengths between its origin and the hit; a triangle's edges err each on its
    own, which moves the point along a triangle that is thin as the ray sees it."""
    primitives, origin, direction, hits, _ = hit_pairs(device, shape, seed)
    along = shapes.normalized(direction)
    offset = hits.position - origin
    across = np.linalg.norm(offset - np.sum(offset * along, axis=-1, keepdims=True) * along, axis=-1)
    reach = np.linalg.norm(offset, axis=-1) + coordinates(primitives)
    bound = 2.0 * SURFACE_ROUNDINGS * ROUNDOFF * reach * seen_aspect(primitives, along)
    assert (across <= bound).all(), (across / bound).max()


def seen_aspect(primitives, direction):
    """Length over width (n,) of triangles as a ray sees them, 1 for other kinds."""
    if primitives.kind != "triangle":
        return 1.0
    points = [getattr(primitives, name) for name in ("p0", "p1", "p2")]
    edges = [b - a for a, b in zip(points, [*points[1:], points[0]], strict=True)]
    edges = [e - np.sum(e * direction, axis=-1, keepdims=True) * direction for e in edges]
    longest = np.max([np.linalg.norm(e, axis=-1) for e in edges], axis=0)
    return longest**2 / np.linalg.norm(np.cross(edges[0], edges[1]), axis=-1)


@each_seed
@each_shape
def test_normal_and_uv_as_the_reference(device, shape, seed):
    primitives, origin, _, hits, _ = hit_pairs(device, shape, seed)
    normal, uv = primitives.reference_surface(hits.position.astype(np.float64))
    reach = np.linalg.norm(hits.position - origin, axis=-1) + coordinates(primitives)
    sharpest = shapes.sharpest_radius(primitives, hits.position)
    tolerance = SURFACE_ROUNDINGS * ROUNDOFF * (1.0 + reach / sharpest)
    sure = tolerance < 0.1
    assert sure.mean() > 0.5
    assert np.abs(np.linalg.norm(hits.normal, axis=-1) - 1.0).max() < 4e-7
    assert np.abs(np.linalg.norm(hits.shading_normal, axis=-1) - 1.0).max() < 4e-7
    if primitives.kind == "triangle":
        flat = shapes.normalized(np.cross(primitives.p1 - primitives.p0, primitives.p2 - primitives.p0))
        blend = interpolated_normal(primitives, hits.position)
        tolerance_n = tolerance / np.maximum(np.linalg.norm(blend, axis=-1), 1e-6)
        side = np.sign(np.sum(blend * flat, axis=-1, keepdims=True))
        unsure = (np.abs(np.sum(shapes.normalized(blend) * flat, axis=-1)) < 10 * tolerance_n) | (tolerance_n > 0.1)
        close(hits.shading_normal, side * normal, tolerance_n, sure & ~unsure)
        close(hits.normal, flat, tolerance, sure)
    else:
        close(hits.normal, normal, tolerance, sure)
        assert np.array_equal(hits.shading_normal, hits.normal)
    difference = np.abs(hits.uv - uv)
    if primitives.kind in ("sphere", "cylinder", "cone"):  # the seam: u = 0 is u = 1
        whole = np.abs(primitives.uv_transform[:, 0]) if hasattr(primitives, "uv_transform") else 1.0
        round_uv = getattr(primitives, "planar", np.zeros(len(uv))) == 0
        difference[:, 0] = np.where(
            round_uv, np.minimum(difference[:, 0], np.abs(difference[:, 0] - whole)), difference[:, 0]
        )
    scale = np.maximum(np.abs(getattr(primitives, "uv_transform", np.ones((len(uv), 4)))).max(axis=-1), 1.0)
    scale = np.maximum(scale, np.abs(uv).max(axis=-1))
    wrong = sure[:, None] & (difference > (tolerance * scale)[:, None])
    assert not wrong.any(), (difference / (tolerance * scale)[:, None])[sure].max()
    assert np.array_equal(hits.material, np.float32(primitives.material))


def interpolated_normal(triangles, point):
    """The vertex normals' mean by the weights of points in the triangles, not normalised."""
    u, v = (value[:, None] for value in triangles._affine(point.astype(np.float64)))
    return (1.0 - u - v) * triangles.n0 + u * triangles.n1 + v * triangles.n2


def close(actual, expected, tolerance, rows):
    off = np.linalg.norm(actual - expected, axis=-1)
    assert (off <= tolerance)[rows].all(), (off / tolerance)[rows].max()


def leaving(rng, normal, side):
    """Unit directions (n, 3) on a side of the surface; half of them graze it at 1e-6 to 1e-1."""
    n = len(normal)
    tangent = shapes.normalized(np.cross(normal, shapes.unit_vectors(rng, n)))
    graze = np.where(rng.random(n) < 0.5, shapes.log_uniform(rng, 1e-6, 1e-1, n), rng.random(n))[:, None]
    return shapes.single(shapes.normalized(side * graze * normal + np.sqrt(1.0 - graze**2) * tangent))


def spawned(device, shape, seed, side):
    primitives, origin, direction, hits, rng = hit_pairs(device, shape, seed, near=0.5)
    following = leaving(rng, hits.normal.astype(np.float64), side)
    return primitives, following, harness.hits(device, primitives, origin, direction, following=following)


@each_seed
@pytest.mark.parametrize("shape", CONVEX)
def test_a_ray_that_leaves_outwards_never_hits_again(device, shape, seed):
    primitives, _, hits = spawned(device, shape, seed, 1.0)
    assert (shapes.signed_distance(primitives, hits.spawned) > 0.0).all()
    assert not np.isfinite(hits.t_next).any(), f"{np.isfinite(hits.t_next).sum()} of {len(primitives)}"


@each_seed
@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("shape", FLAT)
def test_a_flat_shape_never_hits_itself(device, shape, seed, side):
    primitives, _, hits = spawned(device, shape, seed, side)
    assert (shapes.signed_distance(primitives, hits.spawned) * side > 0.0).all()
    assert not np.isfinite(hits.t_next).any(), f"{np.isfinite(hits.t_next).sum()} of {len(primitives)}"


@each_seed
@pytest.mark.parametrize("shape", CONVEX)
def test_a_ray_that_leaves_inwards_hits_the_far_side(device, shape, seed):
    primitives, following, hits = spawned(device, shape, seed, -1.0)
    assert (shapes.signed_distance(primitives, hits.spawned) < 0.0).mean() > 0.9
    inside = shapes.signed_distance(primitives, hits.spawned) < -hits.error / 2.0
    assert inside.mean() > 0.5 or shape in ("cone_flat", "cone_needle")
    rows = primitives.take(inside)
    origin = hits.spawned[inside].astype(np.float64)
    shapes.assert_same_hits(hits.t_next[inside], rows, origin, following[inside])
    # Not the near side: what is hit is left, not entered.
    hit = np.isfinite(hits.t_next[inside])
    point = origin + hits.t_next[inside][:, None] * following[inside]
    outwards = np.sum(rows.take(hit).reference_surface(point[hit])[0] * following[inside][hit], axis=-1)
    assert (outwards > -1e-3).mean() > 0.999
