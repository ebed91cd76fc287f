"""The scene that is rendered, and a RenderEngine that is watched."""

import bpy
import pytest

from addon import render_engine, render_session
from tests.blender.final_render.rendering import HEIGHT, SKY, WIDTH, glowing, nodes_of


@pytest.fixture
def scene():
    """A glowing sphere of radius 1 in the middle of an orthographic view 6 wide, in front of a sky of one color."""
    scene = bpy.context.scene
    bpy.ops.object.camera_add(location=(0.0, 0.0, 10.0))
    scene.camera = bpy.context.object
    scene.camera.data.type = "ORTHO"
    scene.camera.data.ortho_scale = 6.0
    bpy.ops.conic.sphere_add()
    bpy.context.object.data.materials.append(glowing())
    scene.world = bpy.data.worlds.new("World")
    nodes_of(scene.world)["Background"].inputs["Color"].default_value = (*SKY, 1.0)
    render = scene.render
    render.engine = "CONIC"
    render.resolution_x, render.resolution_y, render.resolution_percentage = WIDTH, HEIGHT, 100
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    scene.conic.samples = 1
    return scene


class Watched:
    """A RenderEngine some of whose methods are replaced: Blender's own come before those that a class is given."""

    def __init__(self, engine, methods):
        self._engine, self._methods = engine, methods

    def __getattr__(self, name):
        return self._methods.get(name) or getattr(self._engine, name)


@pytest.fixture
def watch(monkeypatch):
    """Call it with methods by name, to have them called in place of the engine's."""

    def replace(**methods):
        monkeypatch.setattr(
            render_engine,
            "render_layer",
            lambda engine, depsgraph: render_session.render_layer(Watched(engine, methods), depsgraph),
        )

    return replace
