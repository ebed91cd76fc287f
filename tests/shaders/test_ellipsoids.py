"""Spheres under any affine transform, as instances, against the quadric in float64: hits, distances, normals."""

import numpy as np
import pytest

from addon.engine.packing import pack
from addon.engine.primitives import Spheres
from addon.engine.scene import Camera, Geometry, Instances

from . import scenes, shapes
from .shapes import ROUNDOFF, normalized
from .test_traversal import traverse

#: GLSL's answer is the exact one for a ray moved by at most this many roundings of the lengths it was computed from.
ROUNDINGS = 12.0


def quadric(matrix, origin, direction):
    """Nearest t (n,), inf for a miss, and outward unit normal (n, 3) of the unit sphere under a matrix, in float64."""
    inverse = np.linalg.inv(matrix)
    o, d = origin @ inverse[:3, :3].T + inverse[:3, 3], direction @ inverse[:3, :3].T
    a, b = shapes.normalized(d), np.linalg.norm(d, axis=-1)
    along = -np.sum(o * a, axis=-1)
    squared = 1.0 - np.sum((o + along[:, None] * a) ** 2, axis=-1)
    root = np.sqrt(np.maximum(squared, 0.0))
    t = np.where(along - root > 0.0, along - root, along + root)
    hit = (squared >= 0.0) & (t > 0.0)
    normal = normalized((o + t[:, None] * a) @ inverse[:3, :3])
    return np.where(hit, t / b, np.inf), normal


def around(origin, direction, amount):
    """The rays moved by `amount` (n,) to six sides."""
    for step in (*np.eye(3), *-np.eye(3)):
        yield origin + amount[:, None] * step, direction


def stretched(rng, ratio, sheared):
    """An affine matrix with axes up to `ratio` apart, turned and perhaps sheared, half of them mirrored, at 0."""
    (u, _), (v, _) = (np.linalg.qr(rng.normal(size=(3, 3))) for _ in range(2))
    axes = np.array([1.0, ratio ** -rng.random(), 1.0 / ratio])
    matrix = np.eye(4)
    matrix[:3, :3] = shapes.log_uniform(rng, 1e-2, 1e2, ()) * u @ np.diag(axes) @ (v if sheared else np.eye(3))
    return matrix


@pytest.mark.parametrize("away", [0.0, 10.0, 1e4], ids=["at the origin", "off it", "far from it"])
@pytest.mark.parametrize("sheared", [False, True], ids=["turned", "sheared"])
@pytest.mark.parametrize("ratio", [1.0, 10.0, 1000.0])
def test_any_affine_transform(device, ratio, sheared, away):
    rng = np.random.default_rng([int(ratio), int(away)])
    for _ in range(6):
        matrix = stretched(rng, ratio, sheared)
        size = np.linalg.norm(matrix[:3, :3], 2)
        place = size * away * shapes.unit_vectors(rng, 1)[0]
        matrix[:3, 3] = place
        scene = scenes.empty_scene()
        scene.camera = Camera.look_at(place + size * np.array((0.3, -4.0, 0.2)), place)
        scenes.new_materials(scene, 1)
        scene.instances.append(Instances(Geometry(Spheres(center=[[0.0, 0.0, 0.0]], radius=[1.0])), matrix))
        packed = pack(scene, device.max_texture_size)
        origin, direction = rays_at(rng, matrix, size)
        origin = shapes.single(origin - packed.origin) + packed.origin  # as the GPU gets it
        found = traverse(device, scene, origin, direction, packed=packed)
        # A sheared matrix has large and small numbers in one row: each row is rounded by the large ones.
        extra = ratio if sheared else 0.0
        assert_as_quadric(found, matrix, origin, normalized(direction), extra, packed.origin)


def rays_at(rng, matrix, size, n=5000):
    """Rays from half a size to ten sizes away towards points within the ellipsoid and a little around it."""
    ball = shapes.unit_vectors(rng, n) * (1.1 * rng.random((n, 1)) ** 0.3)
    target = ball @ matrix[:3, :3].T + matrix[:3, 3]
    origin = target + shapes.unit_vectors(rng, n) * (size * shapes.log_uniform(rng, 0.5, 10.0, (n, 1)))
    return origin, shapes.single(normalized(target - origin))


def assert_as_quadric(found, matrix, origin, direction, extra, shift):
    """`found` is what float64 says of the same rays, up to ROUNDINGS of the lengths that were subtracted and `extra`
    roundings of the size; normals up to a few more of the stretch."""
    t, normal = quadric(matrix, origin, direction)
    size = np.linalg.norm(matrix[:3, :3], 2)
    lengths = np.linalg.norm(origin - matrix[:3, 3], axis=-1) + size + np.linalg.norm(matrix[:3, 3] - shift)
    amount = ROUNDOFF * (ROUNDINGS * lengths + extra * size)
    moved = [quadric(matrix, *ray) for ray in around(origin, direction, amount)]
    hit = np.isfinite(t)
    sure = np.all([np.isfinite(other) == hit for other, _ in moved], axis=0)
    assert sure.mean() > 0.8, f"{1.0 - sure.mean():.3f} of the rays depend on rounding"
    wrong = sure & (np.isfinite(found.t) != hit)
    assert not wrong.any(), f"{wrong.sum()} of {len(wrong)} hits; stretched {np.linalg.cond(matrix[:3, :3]):.0f}"
    rows = sure & hit
    stretch = 4.0 * ROUNDOFF * np.linalg.cond(matrix[:3, :3])
    with np.errstate(invalid="ignore"):
        spread = np.sum([np.abs(other - t) for other, _ in moved], axis=0)
        turn = np.sum([np.linalg.norm(other - normal, axis=-1) for _, other in moved], axis=0)
        off = np.abs(found.t - t) / (spread + amount)
        turned = np.linalg.norm(found.normal - normal, axis=-1) / (turn + stretch)
    assert off[rows].max() <= 1.0, f"t is off by {off[rows].max():.2f} times the bound"
    assert turned[rows].max() <= 1.0, f"normals are turned by {turned[rows].max():.2f} times the bound"
    assert (np.abs(np.linalg.norm(found.normal[rows], axis=-1) - 1.0) < 1e-6).all()
