"""What is not rendered as it is gets named, and what is not Conic's business does not."""

import bpy
import pytest

from tests.blender.building import add_camera, link, quad, sync


@pytest.fixture(autouse=True)
def lit_scene():
    add_camera()
    link(bpy.data.lights.new("lamp", "SUN"), "lamp")


def test_hair_is_named():
    bpy.ops.mesh.primitive_uv_sphere_add()
    bpy.context.object.modifiers.new("hair", "PARTICLE_SYSTEM")
    bpy.context.object.particle_systems[0].settings.type = "HAIR"
    assert sync().warnings("Sphere", "hair", "not rendered")


def test_grease_pencil_is_blenders_own():
    add = getattr(bpy.ops.object, "grease_pencil_add", None) or bpy.ops.object.gpencil_add
    add(type="MONKEY")
    assert not sync().warnings()


@pytest.mark.parametrize(("flag", "words"), [("holdout", "a holdout"), ("indirect_only", "indirect only")])
def test_flags_of_collections_are_named(flag, words):
    collection = bpy.data.collections.new("kept apart")
    bpy.context.scene.collection.children.link(collection)
    collection.objects.link(quad("in it"))
    bpy.context.scene.collection.objects.unlink(bpy.data.objects["in it"])
    setattr(bpy.context.view_layer.layer_collection.children["kept apart"], flag, True)
    assert sync().warnings("in it", words)
