"""Places in the spaces of objects, and points beside points, against float64."""

import numpy as np
import pytest

from addon.sync.spaces import space_rows

from . import harness, shapes

COUNT = 2000


def run(device, origin, seed):
    """Places (n, 3) in the spaces of objects near `origin`, normals, gradients of u, the places in the world relative
    to it, and what the shader says of them."""
    rng = np.random.default_rng(seed)
    size = shapes.log_uniform(rng, 1e-3, 1e3, COUNT)[:, None]
    matrices = np.tile(np.eye(4), (COUNT, 1, 1))
    matrices[:, :3, :3] = np.linalg.qr(rng.normal(size=(COUNT, 3, 3)))[0] * rng.uniform(0.3, 3.0, (COUNT, 1, 3))
    matrices[:, :3, :3] *= size[:, None]
    matrices[:, :3, 3] = np.float32(origin + size * rng.normal(size=(COUNT, 3)))  # as Blender has it
    places, normals = rng.uniform(-1.0, 1.0, (COUNT, 3)), shapes.unit_vectors(rng, COUNT)
    world = np.einsum("nij,nj->ni", matrices[:, :3, :3], places) + matrices[:, :3, 3]
    gradients = rng.normal(size=(COUNT, 3)) / size
    values = harness.TEST_VALUE.zeros(3 * COUNT)
    rows = space_rows(matrices)
    values["a"][0::3], values["b"][0::3], values["a"][1::3] = rows[:, 0], rows[:, 1], rows[:, 2]
    values["b"][1::3, :3], values["a"][2::3, :3], values["b"][2::3, :3] = gradients, world - origin, normals
    found = harness.run(
        device,
        "space_frag.glsl",
        COUNT,
        {"test_values": harness.texels(values)},
        features={"HAS_GRADIENTS"},
        outputs=("out_place", "out_normal", "out_vector", "out_beside"),
        frame=harness.frame_record(world_origin=origin, raster=(1e-3, 1e-3, 0.0, 0.0)),
    )
    return places, normals, gradients, world - origin, found


@pytest.mark.parametrize("origin", [(0.0, 0.0, 0.0), (65536.0, -131072.0, 8192.0)])
def test_places_and_directions(device, origin):
    """Far from the world's origin as exactly as near it: of objects of a size of 1e-3 too, within their own digits."""
    places, normals, _, _, (place, normal, vector, _) = run(device, np.array(origin), 3)
    off = np.abs(place[:, :3] - places).max(axis=-1)
    assert np.quantile(off, 0.5) < 3e-6 and off.max() < 2e-4, np.quantile(off, (0.5, 0.9, 1.0))
    np.testing.assert_allclose(normal[:, :3], normals, atol=5e-6)
    np.testing.assert_allclose(vector[:, :3], normals, atol=5e-6)


def test_a_point_beside_lies_along_the_surface_by_a_step(device):
    _, normals, gradients, near, (place, _, _, beside) = run(device, np.zeros(3), 4)
    step = place[:, 3].astype(np.float64)
    expected = np.maximum(0.1 * 1e-3 * 2.0, 1e-4 * np.abs(near).max(axis=-1))
    np.testing.assert_allclose(step, expected, rtol=1e-5)
    rounding = 2.0 * np.finfo(np.float32).eps * np.abs(near).max(axis=-1)
    offset = beside[:, :3].astype(np.float64)
    assert (np.abs(np.linalg.norm(offset, axis=-1) - step) < rounding + 1e-6 * step).all()
    assert (np.abs(np.einsum("ni,ni->n", offset, normals)) < rounding + 1e-6 * step).all()
    np.testing.assert_allclose(beside[:, 3], np.einsum("ni,ni->n", gradients, offset), rtol=1e-2, atol=3e-7)
