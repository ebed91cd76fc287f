"""Exact shapes among the islands of one mesh, against the transforms that made the islands."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from addon.engine.primitives import Cones, Cylinders, Discs, Spheres
from addon.sync.islands import find_islands
from addon.sync.recognise import MeshArrays
from tests.made_meshes import ico_sphere, lattice, mesh_of, uv_sphere


def joined(*meshes):
    """Several meshes as one, as Blender joins them."""
    vertices = np.cumsum([0, *(mesh.counts[0] for mesh in meshes)])
    corners = np.cumsum([0, *(mesh.counts[2] for mesh in meshes)])
    return MeshArrays(
        np.concatenate([mesh.positions for mesh in meshes]),
        np.concatenate([m.corner_vertex + v for m, v in zip(meshes, vertices, strict=False)]).astype(np.int32),
        np.concatenate([[0], *(m.face_offset[1:] + c for m, c in zip(meshes, corners, strict=False))]).astype(np.int32),
        np.concatenate([mesh.smooth for mesh in meshes]),
        np.concatenate([mesh.material for mesh in meshes]),
    )


def moved(mesh, linear, offset):
    positions = (mesh.positions.astype(np.float64) @ np.asarray(linear).T + offset).astype(np.float32)
    return MeshArrays(positions, mesh.corner_vertex, mesh.face_offset, mesh.smooth, mesh.material)


def tube(sides=12, heights=(0.0, 0.5, 1.0), **ends):
    """A cylinder of radius 1 and length 1 along Z with rings at the heights."""
    return mesh_of(*lattice(np.ones(len(heights)), np.array(heights), sides, **ends)[:2])


def turned(random):
    """A rotation matrix (3, 3)."""
    q = np.linalg.qr(random.normal(size=(3, 3)))[0]
    return q * np.sign(np.linalg.det(q))


def bonds(random, count):
    """Tubes between random ends with radii: (mesh, base, apex, radius)."""
    base, radius = random.uniform(-1, 1, (count, 3)), random.uniform(0.01, 0.1, count)
    length = random.uniform(0.1, 0.5, count)
    turns = [turned(random) for _ in range(count)]
    parts = [moved(tube(), r @ np.diag([s, s, h]), b) for r, s, h, b in zip(turns, radius, length, base, strict=True)]
    apex = base + np.array([r[:, 2] * h for r, h in zip(turns, length, strict=True)])
    return joined(*parts), base, apex, radius


@given(seed=st.integers(0, 2**32 - 1))
def test_tubes_and_spheres_are_exact_wherever_they_lie(seed):
    random = np.random.default_rng(seed)
    mesh, base, apex, radius = bonds(random, 5)
    ball = mesh_of(*ico_sphere(4)[:2])
    centers, sizes = random.uniform(-1, 1, (4, 3)), random.uniform(0.01, 0.1, 4)
    balls = [moved(ball, turned(random) * s, c) for c, s in zip(centers, sizes, strict=True)]
    islands = find_islands(joined(*balls, mesh))
    assert not islands.rest.any()
    by_kind = {type(part): part for part in islands.primitives}
    spheres, cylinders = by_kind[Spheres], by_kind[Cylinders]
    np.testing.assert_allclose(spheres.center, centers, atol=1e-6)
    np.testing.assert_allclose(spheres.radius, sizes, rtol=1e-4)
    np.testing.assert_allclose(cylinders.radius, radius, rtol=1e-4)
    ends = np.stack([cylinders.base, cylinders.apex], 1)
    if not np.allclose(ends[:, 0], base, atol=1e-5):  # all the other way round: the first was recognised so
        ends = ends[:, ::-1]
    np.testing.assert_allclose(ends, np.stack([base, apex], 1), atol=1e-5)


def test_halves_of_two_colors_become_two_cylinders():
    mesh, base, apex, _ = bonds(np.random.default_rng(1), 3)
    colors = np.random.default_rng(2).random((3, 2, 4)).astype(np.float32)
    colors[1, 1] = colors[1, 0]  # one of one colour
    of_face = np.repeat(colors.reshape(6, 4), 12, axis=0)
    for values, domain in ((of_face, "FACE"), (np.repeat(of_face, 4, axis=0), "CORNER")):
        cylinders = find_islands(mesh, {"Color": (values, domain)}).primitives
        assert [len(part) for part in cylinders] == [1, 2, 2]
        np.testing.assert_array_equal(cylinders[0].attributes["Color"][:, 0], colors[1:2, 0])
        for part in cylinders[1:]:
            middle = (part.base + part.apex) / 2
            half = int(np.linalg.norm(middle - base[[0, 2]]) > np.linalg.norm(middle - apex[[0, 2]]))
            np.testing.assert_array_equal(part.attributes["Color"], np.repeat(colors[[0, 2], half, None], 2, axis=1))
        np.testing.assert_allclose(cylinders[1].apex, (base + apex)[[0, 2]] / 2, atol=1e-5)


def test_a_color_that_runs_along_the_axis_does_so_exactly():
    mesh, base, _, _ = bonds(np.random.default_rng(1), 2)
    of_ring = np.random.default_rng(2).random((2, 3, 4)).astype(np.float32)
    low, high = find_islands(mesh, {"Color": (np.repeat(of_ring.reshape(6, 4), 12, axis=0), "POINT")}).primitives
    if not np.allclose(low.base, base, atol=1e-5):  # the other way round
        of_ring = of_ring[:, ::-1]
    np.testing.assert_array_equal(low.attributes["Color"], of_ring[:, :2])
    np.testing.assert_array_equal(high.attributes["Color"], of_ring[:, 1:])


def test_an_island_whose_color_changes_around_the_axis_stays_triangles():
    mesh, *_ = bonds(np.random.default_rng(1), 3)
    values = np.zeros((mesh.counts[0], 4), np.float32)
    values[36 + 5] = 1.0
    islands = find_islands(mesh, {"Color": (values, "POINT")})
    assert len(islands.primitives[0]) == 2
    np.testing.assert_array_equal(np.flatnonzero(islands.rest), np.arange(24, 48))


def test_a_tube_far_longer_than_the_first_is_a_cylinder_too():
    short = moved(tube(), np.diag([0.03, 0.03, 0.05]), (20.0, 10.0, 5.0))
    long = moved(tube(), turned(np.random.default_rng(4)) @ np.diag([0.03, 0.03, 8.0]), (20.0, 10.0, 5.0))
    assert not find_islands(joined(short, long)).rest.any()


def test_cones_and_caps():
    random = np.random.default_rng(3)
    cone = mesh_of(*lattice(np.array([1.0]), np.array([0.0]), 16, "NGON", 1.0)[:2])
    drum = tube(16, (0.0, 1.0), bottom="NGON", top=1.0)
    places = random.uniform(-1, 1, (4, 3))
    turns = [turned(random) for _ in places]
    parts = [moved(part, r, p) for part, r, p in zip((cone, drum, cone, drum), turns, places, strict=True)]
    islands = find_islands(joined(*parts))
    assert not islands.rest.any()
    by_kind = {}
    for part in islands.primitives:
        by_kind.setdefault(type(part), []).append(part)
    assert {kind: sum(map(len, parts)) for kind, parts in by_kind.items()} == {Cones: 2, Cylinders: 2, Discs: 6}
    cones = by_kind[Cones][0]
    np.testing.assert_allclose(cones.base, places[[0, 2]], atol=1e-6)
    np.testing.assert_allclose(cones.apex_radius, 0.0, atol=1e-6)
    discs = Discs.concatenate(by_kind[Discs])
    up = np.array(turns)[:, :, 2]
    expected = {*map(tuple, np.round(np.concatenate([-up, up[[1, 3]]]), 4) + 0.0)}
    assert {*map(tuple, np.round(discs.normal, 4) + 0.0)} == expected


def sheared(mesh):
    return moved(mesh, [[1, 0.2, 0], [0, 1, 0], [0, 0, 1]], 0)


def stretched(mesh):
    return moved(mesh, np.diag([1, 1.01, 1]), 0)


def dented(mesh):
    positions = mesh.positions.copy()
    positions[3] *= 1.01
    return MeshArrays(positions, mesh.corner_vertex, mesh.face_offset, mesh.smooth, mesh.material)


def mirrored(mesh):
    return moved(mesh, np.diag([1, 1, -1]), 0)


def of_two_materials(mesh):
    material = np.arange(mesh.counts[1], dtype=np.int32) % 2
    return MeshArrays(mesh.positions, mesh.corner_vertex, mesh.face_offset, mesh.smooth, material)


@pytest.mark.parametrize("damage", [sheared, stretched, dented, mirrored, of_two_materials])
@pytest.mark.parametrize("make", [lambda: mesh_of(*ico_sphere(4)[:2]), tube, lambda: mesh_of(*uv_sphere()[:2])])
def test_islands_that_are_not_the_shape_stay_triangles(make, damage):
    mesh = make()
    islands = find_islands(joined(mesh, damage(mesh), moved(mesh, np.eye(3), (9, 0, 0))))
    faces = mesh.counts[1]
    assert sum(map(len, islands.primitives)) == 2
    np.testing.assert_array_equal(np.flatnonzero(islands.rest), np.arange(faces, 2 * faces))


def test_slots_are_the_materials_and_flat_islands_can_be_left():
    ball = mesh_of(*ico_sphere(4)[:2], material=3)
    flat = mesh_of(*ico_sphere(4)[:2], smooth=False)
    mesh = joined(ball, moved(flat, np.eye(3), (3, 0, 0)))
    assert find_islands(mesh).primitives[0].material.tolist() == [3, 0]
    smooth = find_islands(mesh, smooth_only=True)
    assert smooth.primitives[0].material.tolist() == [3]
    assert smooth.rest.sum() == flat.counts[1]


def test_nothing_is_found_where_there_is_nothing():
    box = mesh_of(np.random.default_rng(0).random((8, 3)), [[0, 1, 2, 3], [4, 5, 6, 7]])
    assert find_islands(box) is None
    assert find_islands(mesh_of(*uv_sphere()[:2])) is None  # one island: recognised as a whole
    assert find_islands(mesh_of(np.zeros((0, 3)), [[]])) is None
