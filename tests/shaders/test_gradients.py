"""Gradients of uv and of attributes' weights over position: against differences of the float64 reference."""

import numpy as np
import pytest

from . import harness, shapes
from .cases import each_seed, each_shape, make

#: Of a primitive's size: the step of the differences, whose error grows with its square.
STEP = 1e-4


def gradients(device, primitives, origin, direction):
    """Rows (n, 4) of outputs of `gradient_frag.glsl`."""
    kind = primitives.kind
    hit, surface = primitives.records()
    names = primitives.record.texture, primitives.surface_record.texture
    textures, frame = {names[0]: harness.texels(hit), names[1]: harness.texels(surface)}, None
    if names[0] == names[1]:
        textures = {names[0]: harness.texels(hit, surface)}
        frame = harness.frame_record(**{f"{kind}_surface_first": hit.nbytes // 16})
    rays = harness.texels(harness.ray_records(origin, direction))
    return harness.run(
        device,
        "gradient_frag.glsl",
        len(origin),
        textures | {"test_rays": rays},
        features={f"HAS_{kind.upper()}", "HAS_GRADIENTS", "HAS_ATTRIBUTES"},
        constants={
            "TEST_HIT": f"{kind}_hit",
            "TEST_SURFACE": f"{kind}_surface",
            "TEST_READ": f"read_{kind}",
            "TEST_READ_SURFACE": f"read_{kind}_surface",
        },
        outputs=("out_position", "out_u", "out_v", "out_first", "out_second"),
        frame=frame,
    )


def hits(device, shape, seed):
    """Primitives that rays hit, where their surfaces are not too bent to take differences: (primitives, points (n, 3)
    float64, gradients (n, 3) of u, v and the two weights, weights (n, 2))."""
    primitives, rng = make(shape, seed, count=4000)
    origin, direction = shapes.rays(rng, primitives, 0.5)
    rows = np.isfinite(harness.hits(device, primitives, origin, direction).t)
    primitives, origin, direction = primitives.take(rows), origin[rows], direction[rows]
    position, *found = gradients(device, primitives, origin, direction)
    weights = np.stack([found[0][:, 3], found[1][:, 3]], axis=-1)
    return primitives, position[:, :3].astype(np.float64), [g[:, :3].astype(np.float64) for g in found], weights, rng


def differences(primitives, point, tangent, step):
    """The growth (n, 2) of uv along unit vectors `tangent` (n, 3) a length, by central differences."""
    uv = [primitives.reference_surface(point + side * step[:, None] * tangent)[1] for side in (1.0, -1.0)]
    return (uv[0] - uv[1]) / (2.0 * step[:, None])


@each_seed
@each_shape
def test_uv_grows_as_its_gradients_tell(device, shape, seed):
    primitives, point, found, _, rng = hits(device, shape, seed)
    normal, _ = primitives.reference_surface(point)
    if primitives.kind == "triangle":
        normal = np.cross(primitives.p1 - primitives.p0, primitives.p2 - primitives.p0)
    tangent = shapes.normalized(np.cross(shapes.normalized(normal), shapes.unit_vectors(rng, len(point))))
    extent = shapes.middle_and_extent(primitives)[1]
    sharpest = np.minimum(shapes.sharpest_radius(primitives, point), extent)
    step = STEP * sharpest
    expected = differences(primitives, point, tangent, step)
    actual = np.stack([np.einsum("ni,ni->n", g, tangent) for g in found[:2]], axis=-1)
    size = np.stack([np.linalg.norm(g, axis=-1) for g in found[:2]], axis=-1)
    # Where the numbers that a position is made of are large beside the shape, the reference's own point is coarse.
    reach = np.linalg.norm(point, axis=-1) + extent
    roundings = 64.0 * shapes.ROUNDOFF * reach / sharpest
    off = np.abs(actual - expected) / (size + 1e-30)
    seam = np.abs(expected - actual) * step[:, None] > 0.2  # the difference spans the beginning of u
    good = ((roundings < 0.1) & ~seam.any(axis=-1))[:, None] & (size > 0.0)
    assert good.mean() > 0.4
    over = (off / (1e-3 + roundings)[:, None])[good]
    assert np.quantile(off[good], 0.5) < 1e-3 and np.quantile(over, 0.995) < 1.0, np.quantile(over, (0.9, 0.99, 1.0))


@each_seed
@pytest.mark.parametrize("shape", ["cylinder", "cone_truncated", "triangle"])
def test_weights_grow_as_their_gradients_tell(device, shape, seed):
    """Weights are affine in position: two points of a primitive tell."""
    primitives, point, found, weights, _ = hits(device, shape, seed)
    start = primitives.p0 if primitives.kind == "triangle" else primitives.base  # where both are 0
    grown = np.stack([np.einsum("ni,ni->n", g, point - start) for g in found[2:]], axis=-1)
    extent = shapes.middle_and_extent(primitives)[1]
    reach = np.linalg.norm(point, axis=-1) + extent
    size = np.stack([np.linalg.norm(g, axis=-1) for g in found[2:]], axis=-1)
    np.testing.assert_array_less(np.abs(grown - weights), (64.0 * shapes.ROUNDOFF * reach)[:, None] * size + 1e-5)
    assert np.ptp(weights[:, 0]) > 0.5
