"""NFF's polygons as they stand in the file, beside the triangles that the scene has of them."""

import numpy as np

from addon.engine.nff import read_nff

TEXT = """v
from 0 -5 0
at 0 0 0
up 0 0 1
angle 45
hither 0.5
resolution 40 20
f 1 0 0 1 0 1 0 1
p 4 0 0 0 1 0 0 1 1 0 0 1 0
pp 3 0 0 1 0 0 2 1 0 1 0 0 1 0 1 1 0 1 1
p 3 0 0 2 1 0 2 0 1 2
f 0 1 0 0.5 0 1 0.5 1
p 5 0 0 3 2 0 3 2 2 3 1 0.5 3 0 2 3
"""


def read(tmp_path):
    path = tmp_path / "scene.nff"
    path.write_text(TEXT)
    return read_nff(path)


def test_flat_polygons_and_patches_keep_their_vertices(tmp_path):
    flat, smooth = read(tmp_path).polygons
    assert flat.size.tolist() == [4, 3, 5] and smooth.size.tolist() == [3]
    assert flat.points[:, 2].tolist() == [0.0] * 4 + [2.0] * 3 + [3.0] * 5
    assert flat.points[10].tolist() == [1.0, 0.5, 3.0], "the corner that points inwards"
    assert flat.normals is None
    np.testing.assert_allclose(np.linalg.norm(smooth.normals, axis=1), 1.0)
    np.testing.assert_allclose(smooth.normals[2], [0.0, 0.5**0.5, 0.5**0.5])


def test_their_materials_say_whether_they_have_one_side(tmp_path):
    flat, smooth = read(tmp_path).polygons
    assert flat.material.tolist() == [0, 0, 1] and smooth.material.tolist() == [0]
    assert flat.one_sided.tolist() == [True, True, False] and smooth.one_sided.tolist() == [True]


def test_the_scene_has_their_triangles(tmp_path):
    file = read(tmp_path)
    assert file.scene.primitive_counts() == {"triangle": 2 + 1 + 3 + 1}
    assert len(file.polygons[0]) == 3
    assert file.resized(10, 10).polygons is file.polygons
