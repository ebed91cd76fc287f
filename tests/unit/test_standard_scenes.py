"""The standard families of scenes have the sizes that were published."""

import numpy as np
import pytest

from addon.engine import Spheres, Triangles
from addon.engine.nff import read_nff, write_nff
from examples.standard_scenes import FAMILIES, balls
from tests.unit.shape_arrays import areas, corners, shapes

COUNTS = {
    "balls": {"sphere": 7381, "triangle": 2},
    "tree": {"sphere": 4095, "cone": 4095, "triangle": 2},
    "tetra": {"triangle": 4096},
    "mount": {"sphere": 4, "triangle": 8192},
    "lattice": {"sphere": 2197, "cylinder": 6084},
}


@pytest.mark.parametrize("family", FAMILIES)
def test_standard_scenes_have_the_published_sizes(tmp_path, family):
    scene = FAMILIES[family]()
    assert scene.primitive_counts() == COUNTS[family]
    write_nff(scene, tmp_path / "scene.nff", 512, 512)
    assert read_nff(tmp_path / "scene.nff").scene.primitive_counts() == COUNTS[family]


def test_sphereflake_balls_touch_their_parents():
    spheres = shapes(balls(3), Spheres)
    child = np.arange(1, len(spheres))
    distance = np.linalg.norm(spheres.center[child] - spheres.center[(child - 1) // 9], axis=1)
    np.testing.assert_allclose(distance, spheres.radius[child] * 4.0, rtol=1e-12)


def test_tetra_is_closed():
    """Every solid's four faces look outwards: their vector areas cancel, and the volume is positive."""
    faces = corners(shapes(FAMILIES["tetra"](3), Triangles))
    normals = areas(faces)
    np.testing.assert_allclose(normals.reshape(-1, 4, 3).sum(axis=1), 0.0, atol=1e-15)
    center = faces.reshape(-1, 12, 3).mean(axis=1).repeat(4, axis=0)
    assert (np.einsum("ni,ni->n", faces.mean(axis=1) - center, normals) > 0.0).all()
