"""The example scenes: all that they show is rendered as it is."""

import importlib

import bpy
import pytest

from tests.blender.building import sync


@pytest.mark.parametrize("name", ["still_life", "optical_bench", "solar_system"])
def test_example_is_rendered_without_a_warning(name):
    importlib.import_module(f"examples.{name}").build_scene()
    synced = sync(64, 32)
    assert not synced.messages
    exact = sum(len(part) for _, part in synced.scene.shapes.kinds()) + len(synced.scene.instances)
    assert exact >= 11 and bpy.context.scene.render.engine == "CONIC"
    kinds = {part.kind for placed in synced.scene.instances for _, part in placed.geometry.kinds()}
    meshes = {"optical_bench"}  # a prism has no other shape
    assert ("triangle" in kinds) == (name in meshes)
