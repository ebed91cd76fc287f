"""Scenes for the tests of the sync, built through bpy, and what the sync makes of them."""

from dataclasses import dataclass, field

import bpy
import numpy as np

from addon.sync.scene_sync import sync_scene


@dataclass
class Synced:
    """An engine scene and the messages (level, text) of its sync."""

    scene: object
    messages: list = field(default_factory=list)

    def warnings(self, *words):
        """The warnings that contain all of the words."""
        return [text for level, text in self.messages if level == "WARNING" and all(word in text for word in words)]


def sync(width=64, height=48):
    """The engine scene of Blender's scene."""
    synced = Synced(None)
    synced.scene = sync_scene(
        bpy.context.evaluated_depsgraph_get(), width, height, report=lambda *message: synced.messages.append(message)
    )
    return synced


def link(data, name="object", **settings):
    """An object with `data`, in the scene."""
    obj = bpy.data.objects.new(name, data)
    for key, value in settings.items():
        setattr(obj, key, value)
    bpy.context.collection.objects.link(obj)
    return obj


def add_camera(**settings):
    data = bpy.data.cameras.new("camera")
    for key, value in settings.items():
        setattr(data, key, value)
    bpy.context.scene.camera = link(data, "camera", location=(0.0, 0.0, 10.0))
    return bpy.context.scene.camera


def mesh_of(vertices, faces, name="mesh"):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.update()
    return mesh


def quad(name="quad", **settings):
    """A quad from (0, 0) to (1, 1), with the unit square as its uv map."""
    mesh = mesh_of([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2, 3)], name)
    mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", np.array([0, 0, 1, 0, 1, 1, 0, 1], np.float32))
    return link(mesh, name, **settings)


def material(name="material"):
    """A material whose tree holds nothing but its output: (material, tree, output node)."""
    made = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0, 0):
        made.use_nodes = True
    made.node_tree.nodes.clear()
    return made, made.node_tree, made.node_tree.nodes.new("ShaderNodeOutputMaterial")


def node(tree, kind, to=None, output=0, **inputs):
    """A node of the type ShaderNode<kind>; its inputs by their names, its output linked to the socket `to`."""
    made = tree.nodes.new(f"ShaderNode{kind}")
    for name, value in inputs.items():
        made.inputs[name.replace("_", " ")].default_value = value
    if to is not None:
        tree.links.new(made.outputs[output], to)
    return made


def image(pixels, name="image", **settings):
    """A generated image of pixels (h, w, 4) as they stand in its file."""
    pixels = np.asarray(pixels, np.float32)
    made = bpy.data.images.new(name, pixels.shape[1], pixels.shape[0], alpha=True, **settings)
    made.pixels.foreach_set(pixels.ravel())
    made.update()
    return made


def triangles_of(instance):
    """The Triangles of an instance that has nothing else."""
    ((_, triangles),) = instance.geometry.kinds()
    return triangles


def shapes_of(scene):
    """The primitives in world space by kind."""
    return {part.kind: part for _, part in scene.shapes.kinds()}
