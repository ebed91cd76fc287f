"""Which worlds light what, and which rays see them."""

import bpy
import numpy as np
import pytest

from addon.engine.scene import Visibility
from addon.sync.settings import sync_settings
from tests.blender.building import add_camera, image, node, sync


@pytest.fixture
def world():
    """A world of nodes, the scene's; its tree and Background."""
    add_camera()
    made = bpy.context.scene.world = bpy.data.worlds.new("world")
    if bpy.app.version < (5, 0, 0):
        made.use_nodes = True
    return made


def background(world):
    return next(n for n in world.node_tree.nodes if n.type == "BACKGROUND")


def test_a_world_lights_and_is_seen_by_all_rays(world):
    read = sync().scene.world
    assert read.lights and read.visibility == Visibility.ALL and read.detail == 0


def test_no_world_lights_nothing():
    add_camera()
    bpy.context.scene.world = None
    assert not sync().scene.world.lights


@pytest.mark.parametrize("ray", ["camera", "glossy", "transmission"])
def test_rays_that_do_not_see_the_world(world, ray):
    setattr(world.cycles_visibility, ray, False)
    read = sync().scene.world
    assert read.visibility == Visibility.ALL & ~Visibility[ray.upper()]
    assert read.lights


def test_a_world_that_diffuse_rays_do_not_see_lights_nothing(world):
    world.cycles_visibility.diffuse = False
    assert not sync().scene.world.lights


def test_the_detail_is_that_of_the_image_unless_it_is_set(world):
    texture = node(world.node_tree, "TexEnvironment", background(world).inputs["Color"])
    texture.image = image(np.ones((16, 32, 4)), "sky")
    assert sync().scene.world.detail == 32
    world.cycles.sampling_method, world.cycles.sample_map_resolution = "MANUAL", 4096
    world.update_tag()
    assert sync().scene.world.detail == 4096


def test_the_settings_of_the_scene(world):
    scene = bpy.context.scene
    assert sync_settings(scene).world_light == "SAMPLED" and not sync_settings(scene).use_ao
    scene.conic.world_light, scene.conic.use_ao = "HEMISPHERE", True
    scene.conic.ao_distance, scene.conic.ao_factor = 0.5, 0.25
    settings = sync_settings(scene)
    assert (settings.world_light, settings.use_ao) == ("HEMISPHERE", True)
    assert (settings.ao_distance, settings.ao_factor) == (0.5, 0.25)
