"""Geometries placed many times: what a block of instances holds, and that each lands where it should."""

import re

import numpy as np
import pytest

from addon.engine import data_texture, layout, reference
from addon.engine.errors import SceneError
from addon.engine.instance_packing import affine_inverse, moved_boxes
from addon.engine.packing import pack
from addon.engine.primitives import Planes, Spheres
from addon.engine.scene import Camera, Geometry, Instances, Material, Scene, Visibility

LIMIT = 16384


def scene_of(*instances, materials=1, shapes=0, eye=(0.0, -5.0, 0.0)):
    scene = Scene(camera=Camera.look_at(eye, np.add(eye, (0, 1, 0))), materials=[Material()] * materials)
    scene.instances = list(instances)
    if shapes:
        scene.add(ball(shapes))
    return scene


def ball(count=1, material=0):
    return Spheres(center=np.linspace(0, 1, 3 * count).reshape(count, 3), radius=0.5, material=material)


def matrices_of(count, seed=0):
    matrices = np.tile(np.eye(4), (count, 1, 1))
    matrices[:, :3] = 2.0 * np.eye(3, 4) + np.random.default_rng(seed).uniform(-0.5, 0.5, (count, 3, 4))
    matrices[:, :3, 3] *= 10.0
    return matrices


def records(packed, record, count):
    return data_texture.records_of(packed.textures[record.texture], record, packed.frame[f"{record.name}_first"])[
        :count
    ]


def placed(packed, count):
    """(n, 3, 4) object to world and (n, 3, 4) world to object."""
    there, back = records(packed, layout.INSTANCE_SURFACE, count), records(packed, layout.INSTANCE, count)
    return tuple(
        np.stack([rows[f"{name}_{axis}"] for axis in "xyz"], axis=1)
        for rows, name in ((there, "to_world"), (back, "to_object"))
    )


def test_one_matrix_is_one_instance():
    one = Instances(Geometry(ball()), np.eye(4, dtype=int))
    assert len(one) == 1 and one.matrices.shape == (1, 4, 4) and one.matrices.dtype == np.float64
    many = Instances(Geometry(ball()), np.zeros((5, 4, 4), np.float32), attributes={"id": (1, 2, 3, 4)})
    assert len(many) == 5 and many.matrices.dtype == np.float32 and many.attributes["id"].shape == (5, 4)


@pytest.mark.parametrize("shape", [(4,), (3, 4), (2, 3, 4), (2, 4, 3), (2, 2, 4, 4)])
def test_matrices_of_other_shapes(shape):
    with pytest.raises(
        SceneError, match=re.escape(f"instances 'pot': matrices have shape {shape}, expected (n, 4, 4)")
    ):
        Instances(Geometry(ball()), np.zeros(shape), name="pot")


@pytest.mark.parametrize("shape", [(3,), (2, 4), (3, 3), (3, 1, 4)])
def test_attributes_of_other_shapes(shape):
    message = f"instances 'pot': attribute 'id' has shape {shape}, expected (3, 4) or (4,)"
    with pytest.raises(SceneError, match=re.escape(message)):
        Instances(Geometry(ball()), np.zeros((3, 4, 4)), name="pot", attributes={"id": np.zeros(shape)})


@pytest.mark.parametrize("shapes", [0, 2])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("away", [0.0, 1e5])
def test_each_instance_lands_where_it_should(shapes, dtype, away):
    """Every matrix once, in some order, with its inverse, its geometry and its tree."""
    geometries = [Geometry(ball(1)), Geometry(ball(70))]
    blocks = [Instances(g, matrices_of(20, i).astype(dtype)) for i, g in enumerate((*geometries, geometries[0]))]
    for block in blocks:
        block.matrices[:, :3, 3] += dtype(away)
    packed = pack(scene_of(*blocks, shapes=shapes, eye=(away, away - 5.0, away)), LIMIT)
    count = 60 + bool(shapes)
    there, back = placed(packed, count)
    full = np.concatenate([there, np.tile([[[0, 0, 0, 1]]], (count, 1, 1))], axis=1).astype(np.float64)
    inverse = np.concatenate([back, np.tile([[[0, 0, 0, 1]]], (count, 1, 1))], axis=1)
    assert np.allclose(full @ inverse, np.eye(4), atol=2e-3 if away else 2e-4)
    full[:, :3, 3] += packed.origin
    hit = records(packed, layout.INSTANCE, count)
    seen = {(int(g), *np.round(m[:3].ravel(), 2 if away else 4)) for g, m in zip(hit["geometry"], full, strict=True)}
    expected = set()
    for block, number in zip(blocks, (1, 2, 1), strict=True):
        expected |= {(number, *np.round(m[:3].astype(np.float64).ravel(), 2 if away else 4)) for m in block.matrices}
    assert len({s[0] for s in seen}) == 2 + bool(shapes)
    near = [min(np.abs(np.subtract(e, s)).max() for s in seen) for e in expected]
    assert max(near) < (0.02 if away else 2e-4) and len(seen) == count
    roots = {int(g): int(r) for g, r in zip(hit["geometry"], hit["root"], strict=True)}
    assert len(set(roots.values())) == len(roots) and min(roots.values()) == count - 1, "after the upper tree"


def test_the_world_s_shapes_among_instances_are_moved_with_the_origin():
    """An instance of the world's own shapes stands where its matrix says, far from 0 too."""
    scene = scene_of(shapes=3, eye=(1e6, 1e6, 1e6))
    scene.shapes = Geometry(Spheres(center=np.full((3, 3), 1e6), radius=[1, 2, 3]))
    matrix = np.diag([2.0, 1.0, 1.0, 1.0])
    matrix[0, 3] = -1e6
    scene.instances = [Instances(scene.shapes, matrix)]
    packed = pack(scene, LIMIT)
    there, _ = placed(packed, 2)
    center = data_texture.records_of(packed.textures["spheres"], layout.SPHERE)["center"][0].astype(np.float64)
    at = there[:, :, :3] @ center + there[:, :, 3] + packed.origin
    assert np.abs(at - 1e6).max() < 1.0, "both the world and its stretched copy are about that point"


def test_blocks_of_materials_are_shared():
    two = Geometry(ball(2, [0, 1]))
    one = Geometry(ball())
    scene = scene_of(
        Instances(two, matrices_of(3), (2, 1)),
        Instances(one, matrices_of(3, 1), (3,)),
        Instances(two, matrices_of(3, 2), (2, 1)),
        Instances(two, matrices_of(3, 3), None),
        Instances(two, matrices_of(3, 4), (0, 1)),
        materials=4,
    )
    for i in range(4):
        scene.materials[i] = Material(ior=1.0 + i)
    packed = pack(scene, LIMIT)
    first = records(packed, layout.INSTANCE, 15)["first_material"].astype(int)
    assert sorted(first.tolist()) == [0] * 3 + [3] * 3 + [4] * 6 + [6] * 3
    assert records(packed, layout.MATERIAL, 8)["ior"].tolist() == [1, 2, 3, 4, 3, 2, 1, 2]


def test_slots_that_are_the_scene_s_materials_must_exist():
    scene = scene_of(Instances(Geometry(ball(2, [0, 3])), np.eye(4), None, "pot"), materials=3)
    with pytest.raises(SceneError, match="instance 'pot' uses material 3, the scene has 3"):
        pack(scene, LIMIT)


def test_visibility_is_written_and_makes_features():
    geometry = Geometry(ball())
    scene = scene_of(Instances(geometry, np.eye(4)), Instances(geometry, matrices_of(2)), shapes=1)
    wanted = {"HAS_VISIBILITY", "HAS_HOLDOUT", "HAS_SHADOW_CATCHER"}
    assert not pack(scene, LIMIT).features & wanted
    hidden = Visibility.ALL & ~Visibility.SHADOW
    for visibility, features in (
        (hidden, {"HAS_VISIBILITY"}),
        (Visibility.ALL | Visibility.HOLDOUT, {"HAS_HOLDOUT"}),
        (Visibility.ALL | Visibility.SHADOW_CATCHER, {"HAS_SHADOW_CATCHER"}),
        (hidden | Visibility.HOLDOUT, {"HAS_HOLDOUT", "HAS_VISIBILITY"}),
    ):
        scene.instances[1] = Instances(geometry, matrices_of(2), visibility=visibility)
        packed = pack(scene, LIMIT)
        assert packed.features & wanted == features
        assert sorted(records(packed, layout.INSTANCE, 4)["visibility"]) == sorted([31, 31, visibility, visibility])
    scene.instances = []
    scene.add(Planes(point=[[0, 0, 0]] * 2, normal=[0, 0, 1.0], visibility=[31, 1]))
    packed = pack(scene, LIMIT)
    assert packed.features & wanted == {"HAS_VISIBILITY"}
    assert records(packed, layout.PLANE, 2)["visibility"].tolist() == [31, 1]


def test_an_empty_block_shows_nothing():
    scene = scene_of(Instances(Geometry(ball()), np.zeros((0, 4, 4))), shapes=2)
    packed = pack(scene, LIMIT)
    assert "HAS_INSTANCES" not in packed.features and packed.statistics["instances"] == 0
    assert scene.primitive_counts() == {"sphere": 2}


def test_statistics_count_instances_and_geometries():
    geometries = [Geometry(ball(2)), Geometry(ball(3))]
    scene = scene_of(*(Instances(g, matrices_of(5, i)) for i, g in enumerate((*geometries, geometries[0]))), shapes=7)
    found = pack(scene, LIMIT).statistics
    assert found["primitives"] == {"sphere": 7 + 10 + 15 + 10}
    assert (found["instances"], found["geometries"]) == (15, 2)


def test_a_hundred_thousand_are_all_there():
    """So many that each must be a row of arrays; the tree reaches every one once."""
    count = 100_000
    packed = pack(scene_of(Instances(Geometry(ball()), matrices_of(count))), LIMIT)
    there, _ = placed(packed, count)
    expected = matrices_of(count)[:, :3].astype(np.float32)
    assert (np.sort(there[:, 0, 3]) == np.sort(expected[:, 0, 3])).all()
    nodes = data_texture.records_of(packed.textures["nodes"], layout.NODE)[: count - 1]
    kind = layout.KINDS.index("instance")
    leaves = np.concatenate(
        [nodes[f"first_{c}"][nodes[f"leaf_{c}"] == reference.pack_leaf(kind, 1, 0)] for c in (0, 1)]
    )
    assert (np.sort(leaves.astype(int)) == np.arange(count)).all()


def test_inverses_against_lapack():
    matrices = matrices_of(200) * np.array([1e-6, 1e3, 1.0, 1.0])
    found, expected = affine_inverse(matrices), np.linalg.inv(matrices)
    assert (np.abs(found - expected) <= 1e-12 * np.abs(expected).max(axis=2, keepdims=True)).all()


def test_moved_boxes_hold_their_corners():
    matrices, bounds = matrices_of(50), np.sort(np.random.default_rng(1).normal(size=(50, 2, 3)), axis=1)
    lower, upper = moved_boxes(bounds, matrices)
    corners = np.stack([bounds[:, [i, j, k], [0, 1, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    moved = np.einsum("nij,cnj->cni", matrices[:, :3, :3], corners) + matrices[:, :3, 3]
    assert np.allclose(lower, moved.min(axis=0)) and np.allclose(upper, moved.max(axis=0))
