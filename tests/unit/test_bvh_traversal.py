"""Trees are traversed like brute force, at any scale."""

import numpy as np
import pytest

from addon.engine.bvh import build
from tests.unit.trees import BUILDERS, SCENES, SEEDS, check, uniform


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
