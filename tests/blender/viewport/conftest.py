"""The viewport's session, drawn into a frame buffer: Blender gives a GPU context outside of a render from 5.2 on."""

import bpy
import gpu
import pytest

from addon.engine.devices.blender_gpu import BlenderDevice
from addon.viewport import history
from tests.blender.viewport.stand_in import StandIn, mark


@pytest.fixture
def gpu_context():
    """Skips where Blender has no GPU context in the background; else nothing."""
    if not hasattr(gpu, "init"):
        pytest.skip("no GPU context in the background before Blender 5.2")


@pytest.fixture
def view(gpu_context):
    """A view of a black sphere of radius 1 before a bright sky."""
    bpy.ops.conic.sphere_add()
    world = bpy.data.worlds.new("World")
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    bpy.context.scene.world = world
    bpy.context.scene.conic.preview_samples = 2
    bpy.context.scene.conic.preview_frame_seconds = 0.2
    world.cycles_visibility.diffuse = False  # it lights nothing
    history.records.clear()
    bpy.app.handlers.depsgraph_update_post.append(mark)
    view = StandIn()
    yield view
    view.close()  # what the GPU holds goes before Blender does
    bpy.app.handlers.depsgraph_update_post.remove(mark)


@pytest.fixture
def second(view):
    """A second view of the same scene."""
    second = StandIn()
    yield second
    second.close()


@pytest.fixture
def uploads(monkeypatch):
    """A list with an entry for each texture of a scene that the device is given."""
    seen = []
    for name in ("texture", "update", "grown"):
        monkeypatch.setattr(BlenderDevice, name, counted(getattr(BlenderDevice, name), seen))
    return seen


def counted(function, seen):
    def call(*arguments, **options):
        seen.append(function.__name__)
        return function(*arguments, **options)

    return call
