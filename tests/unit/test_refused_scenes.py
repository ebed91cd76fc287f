"""What a scene cannot be packed with, told before anything large is made."""

import re

import numpy as np
import pytest

from addon.engine.errors import SceneError
from addon.engine.material import surface_image
from addon.engine.packing import pack
from addon.engine.primitives import Planes, Spheres
from addon.engine.scene import Camera, Geometry, Instances, Light, Material, Scene, World
from tests.unit.packed_scenes import LIMIT, scene_of, spheres


def refuse(scene, message, limit=LIMIT):
    with pytest.raises(SceneError, match=re.escape(message)):
        pack(scene, limit)


def test_a_scene_without_a_camera():
    refuse(Scene(), "the scene has no camera; add one")


def test_a_camera_that_is_nowhere():
    scene = scene_of(spheres(1))
    scene.camera = Camera(np.full((4, 4), np.nan), (-1, 1, -1, 1))
    refuse(scene, "the camera's matrix is not finite")
    scene.camera = Camera(np.zeros((4, 4)), (-1, 1, -1, 1))
    refuse(scene, "three axes of length 1")
    scene.camera = Camera(np.eye(4), (-1, 1, 0, 0))
    refuse(scene, "the camera's window (-1, 1, 0, 0) has no width or no height")


FLAT = np.diag([1.0, 0.0, 1.0, 1.0])
TURNED_FLAT = np.array([[1, 1, 0, 0], [2, 2, 0, 0], [0.1, 0.1, 1, 0], [0, 0, 0, 1.0]])
ENDLESS = np.diag([1.0, np.inf, 1.0, 1.0])


@pytest.mark.parametrize("matrix", [FLAT, TURNED_FLAT, ENDLESS, np.full((4, 4), np.nan)])
@pytest.mark.parametrize("world", [True, False])
def test_an_instance_without_volume_is_named(matrix, world):
    scene = scene_of(*([spheres(3)] if world else []))
    geometry = Geometry(spheres(1))
    scene.instances = [Instances(geometry, np.eye(4), name="good"), Instances(geometry, matrix, name="bad")]
    refuse(scene, "instance 'bad' has a scale of 0")


@pytest.mark.parametrize("scale", [1e-9, 1e9])
def test_no_scale_is_too_small_or_large_for_an_instance(scale):
    scene = scene_of()
    scene.instances = [Instances(Geometry(spheres(1)), np.diag([scale, scale, 2 * scale, 1.0]))]
    assert pack(scene, LIMIT).frame["root_count"] == 1


@pytest.mark.parametrize("material", [-1, 2, 100])
def test_a_material_that_is_not_there(material):
    refuse(
        scene_of(Planes(point=[[0, 0, 0]], normal=[[0, 0, 1]], material=material), materials=2), "a plane uses material"
    )
    scene = scene_of(materials=2)
    scene.instances = [Instances(Geometry(spheres(1)), np.eye(4), (material,), "pot")]
    refuse(scene, f"instance 'pot' uses material {material}, the scene has 2")
    if material >= 0:
        refuse(scene_of(spheres(2, material), materials=2), f"a sphere uses material {material}, the scene has 2")


def test_a_material_beyond_the_list_is_not_taken_for_an_instance_s_block():
    """Blocks of instances' materials follow the scene's own; a shape may not reach them."""
    two = Geometry(Spheres(center=np.zeros((2, 3)), radius=1.0, material=[0, 1]))
    scene = scene_of(spheres(1, material=2), materials=2)
    scene.instances = [Instances(two, np.eye(4), (1, 0))]
    refuse(scene, "a sphere uses material 2, the scene has 2")


def test_slots_without_material():
    scene = scene_of()
    scene.instances = [Instances(Geometry(spheres(2, [0, 3])), np.eye(4), (0, 0), "pot")]
    refuse(scene, "instance 'pot' has 2 materials, its geometry uses slot 3")
    scene.instances = [Instances(Geometry(spheres(1, -1), name="mesh"), np.eye(4))]
    refuse(scene, "geometry 'mesh': a sphere uses material slot -1")


def test_an_image_that_is_not_there():
    refuse(scene_of(world=World((1, 1, 1), 0)), "the world uses image 0, the scene has 0")
    scene = scene_of()
    scene.materials = [Material(), Material(glow=surface_image(1))]
    refuse(scene, "material 1 uses image 1, the scene has 0")


def test_a_light_that_is_nowhere():
    scene = scene_of(lights=[Light.constant((np.nan, 0, 0))])
    refuse(scene, "a light has a position, a color or a shape that is not finite")
