"""From frame to frame, what is animated is renewed and nothing else."""

import bpy
import numpy as np
import pytest

from tests.blender.building import image, link
from tests.blender.scene_reader.edits import objects, tree_of


def animate(owner, path, values):
    """Let a property go through values at frames 1, 2, ..."""
    for frame, value in enumerate(values, 1):
        target, _, name = path.rpartition(".")
        target = owner.path_resolve(target) if target else owner
        setattr(target, name, value)
        owner.keyframe_insert(path, frame=frame)


def animated_transform():
    animate(objects()["painted"], "location", [(0, 0, 0), (1, 0, 0), (2, 0, 0)])
    return {"placed painted"}


def animated_material():
    animate(tree_of("red"), 'nodes["Diffuse BSDF"].inputs["Roughness"].default_value', [0.0, 0.5, 0.1])
    return {"material red"}


def animated_shape_keys():
    bent = objects()["bent"]
    bent.shape_key_add(name="basis")
    key = bent.shape_key_add(name="up")
    key.data[0].co.z = 3.0
    animate(bent.data.shape_keys, 'key_blocks["up"].value', [0.0, 0.5, 1.0])
    return {"placed bent", "geometry bent"}


def animated_armature():
    armature = link(bpy.data.armatures.new("armature"), "armature")
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    armature.data.edit_bones.new("bone").tail = (0.0, 0.0, 1.0)
    bpy.ops.object.mode_set(mode="OBJECT")
    skinned = objects()["painted"]
    skinned.vertex_groups.new(name="bone").add([0, 1], 1.0, "REPLACE")
    skinned.modifiers.new("armature", "ARMATURE").object = armature
    animate(armature.pose.bones["bone"].id_data, 'pose.bones["bone"].location', [(0, 0, 0), (1, 0, 0), (2, 0, 0)])
    return {"placed painted", "geometry painted"}


def animated_points():
    tree = bpy.data.node_groups["dots"]
    animate(tree, 'nodes["Mesh to Points"].inputs["Radius"].default_value', [0.1, 0.2, 0.3])
    return {"placed dots", "geometry dots"}


@pytest.mark.parametrize(
    "build", [animated_transform, animated_material, animated_shape_keys, animated_armature, animated_points]
)
def test_frames_renew_what_is_animated(everything, reading, build):
    expected = build()
    bpy.context.scene.frame_set(1)
    reading.read()
    expected = reading.numbered(expected)
    for frame in (2, 3, 1):
        assert reading.renewed(lambda frame=frame: bpy.context.scene.frame_set(frame)) == expected


def test_frames_of_a_sequence_take_one_place(everything, reading, tmp_path):
    for frame in (1, 2, 3):
        still = image(np.full((4, 4, 4), frame / 4.0), f"still {frame}")
        still.filepath_raw, still.file_format = str(tmp_path / f"frame_{frame}.png"), "PNG"
        still.save()
    texture = tree_of("painted").nodes["Image Texture"]
    texture.image = bpy.data.images.load(str(tmp_path / "frame_1.png"))
    texture.image.source = "SEQUENCE"
    texture.image_user.frame_duration, texture.image_user.use_auto_refresh = 3, True
    bpy.context.scene.frame_set(1)
    number = len(reading.read().images) - 1
    for frame in (2, 3):
        renewed = reading.renewed(lambda frame=frame: bpy.context.scene.frame_set(frame))
        assert renewed == {f"image {number}"}
