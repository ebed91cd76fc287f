"""Every test here has the scene of `everything`, or one of its own, and a reader that hears of Blender's changes."""

import bpy
import pytest

from tests.blender.scene_reader.everything import build_everything
from tests.blender.scene_reader.reading import Reading


@pytest.fixture
def everything():
    """A scene with an object of each kind."""
    build_everything()


@pytest.fixture
def reading():
    made = Reading()
    yield made
    bpy.app.handlers.depsgraph_update_post.remove(made.handler)
    bpy.app.handlers.frame_change_post.remove(made.handler)
