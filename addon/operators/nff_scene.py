# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera, lights and background of an NFF file as Blender's."""

import bpy
import numpy as np
from mathutils import Matrix

from .nff_materials import new_node, new_tree

#: Blender's cameras see nothing nearer than this, and have no shorter lens, in millimeters.
_NEAREST = 1e-6
_SHORTEST_LENS = 1.0
#: Parts of the distance to the scene's middle where a camera without a near clip begins to see.
_NEAR = 1e-3
#: How many times the farthest corner's distance a camera sees.
_FAR = 10.0
_WHITE_POINT = 4.0 * np.pi**2  # watts of a point light that a white surface at distance 1 returns as radiance 1


def bounds(scene):
    """The corners low (3,) and high (3,) of the box around all shapes of an engine Scene; the eye's without any."""
    boxes = [part.bounds() for _, part in scene.shapes.kinds()]
    if not boxes:
        eye = np.asarray(scene.camera.matrix)[:3, 3]
        return eye, eye
    return np.min([low.min(axis=0) for low, _ in boxes], axis=0), np.max(
        [high.max(axis=0) for _, high in boxes], axis=0
    )


def new_camera(name, camera, box):
    """A camera object of the engine Camera; `box`: the scene's `bounds`, of which it is to see all."""
    data = bpy.data.cameras.new(name)
    _, _, bottom, top = camera.window
    data.sensor_fit = "VERTICAL"  # NFF's angle is from the bottom to the top row, whatever the picture's form
    data.lens = max(data.sensor_width / (top - bottom), _SHORTEST_LENS)
    data.sensor_height = data.lens * (top - bottom)
    eye = np.asarray(camera.matrix)[:3, 3]
    farthest = float(np.linalg.norm(np.maximum(np.abs(box[0] - eye), np.abs(box[1] - eye))))
    middle = float(np.linalg.norm((box[0] + box[1]) / 2.0 - eye))
    data.clip_start = max(camera.clip[0] or _NEAR * middle, _NEAREST)
    data.clip_end = max(_FAR * farthest, 10.0 * data.clip_start, 1000.0)
    data.display_size = 0.1 * (middle or 1.0)
    obj = bpy.data.objects.new(name, data)
    obj.matrix_basis = Matrix(np.asarray(camera.matrix).tolist())
    return obj


def new_light(name, light, box, fades):
    """A point light of the engine's light without fall-off.

    As such a light of Cycles it has a Light Falloff node; with `fades` it has none. Either way it is as bright in the
    middle of the scene's `bounds` as the file has it, where its nodes are not understood too.
    """
    size = float(np.linalg.norm(box[1] - box[0]))
    distance = float(np.linalg.norm((box[0] + box[1]) / 2.0 - light.position))
    distance = max(distance, 1e-3 * size) or 1.0
    brightest = max(light.color) or 1.0
    data = bpy.data.lights.new(name, "POINT")
    data.color = np.divide(light.color, brightest)
    data.energy = _WHITE_POINT * max(light.color) * distance**2
    data.shadow_soft_size = 0.0
    if not fades:
        tree, output = new_tree(data)
        emission = new_node(tree, "Emission", 1, Strength=1.0)
        falloff = new_node(tree, "LightFalloff", 2, Strength=distance**-2)
        tree.links.new(falloff.outputs["Constant"], emission.inputs["Strength"])
        tree.links.new(emission.outputs[0], output.inputs["Surface"])
    obj = bpy.data.objects.new(name, data)
    obj.location = light.position
    return obj


def set_world(scene, name, world):
    """Give a scene a world of one colour that lights nothing, as in NFF."""
    made = bpy.data.worlds.new(name)
    tree, output = new_tree(made)
    background = new_node(tree, "Background", 1, Color=(*world.color, 1.0))
    tree.links.new(background.outputs[0], output.inputs["Surface"])
    made.color = world.color
    scene.world = made
    if hasattr(made, "cycles_visibility"):
        made.cycles_visibility.diffuse = False  # Cycles wants the scene to have a world by now
