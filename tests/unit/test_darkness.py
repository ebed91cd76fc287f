"""The warning that nothing lights a scene."""

from types import SimpleNamespace

import pytest

from addon.engine.light import LightKind
from addon.engine.packing import pack
from addon.engine.primitives import Spheres
from addon.engine.scene import Camera, Light, Material, Scene, World
from addon.engine.session import Session
from addon.engine.settings import Settings


def scene_of(material=None, **settings):
    scene = Scene(camera=Camera.look_at((0, -5, 0), (0, 0, 0)), materials=[material or Material()], **settings)
    scene.add(Spheres(center=[(0.0, 0.0, 0.0)], radius=[1.0]))
    return scene


def is_told(scene, world_light):
    warnings = pack(scene, 1024).warnings_with(Settings(world_light=world_light))
    return any("no light" in warning for warning in warnings)


@pytest.mark.parametrize("lights", [False, True])
@pytest.mark.parametrize("world_light", ["NONE", "HEMISPHERE", "SAMPLED"])
def test_a_world_lights_only_where_it_may(world_light, lights):
    scene = scene_of(world=World(color=(1.0, 1.0, 1.0), lights=lights))
    assert is_told(scene, world_light) == (world_light == "NONE" or not lights)


@pytest.mark.parametrize(
    "scene",
    [
        scene_of(lights=[Light(LightKind.POINT, (0.0, 0.0, 5.0), (1.0, 1.0, 1.0))]),
        scene_of(Material(glow=(1.0, 1.0, 1.0))),
        scene_of(Material(diffuse=(0.0, 0.0, 0.0), reflect=(1.0, 1.0, 1.0))),
    ],
    ids=["a lamp", "what glows", "mirrors alone"],
)
def test_scenes_that_need_no_world(scene):
    assert not is_told(scene, "NONE")


def test_a_session_tells():
    session = Session(SimpleNamespace(max_texture_size=1024))
    session.build(scene_of(world=World(color=(1.0, 1.0, 1.0), lights=True)), Settings(world_light="NONE"))
    assert any("no light" in warning for warning in session.warnings)
