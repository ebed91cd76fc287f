"""A glowing sphere before a sky, rendered by F12."""

import bpy

from tests.blender.pictures import picture

WIDTH, HEIGHT = 64, 48
SKY = (0.25, 0.5, 1.0)
GLOW = (2.0, 0.5, 0.125)


def nodes_of(owner):
    """The nodes of a new material or world, which have them only on demand before 5.0."""
    if bpy.app.version < (5, 0, 0):
        owner.use_nodes = True
    return owner.node_tree.nodes


def glowing(color=GLOW):
    """A material that shines in `color` and reflects nothing."""
    material = bpy.data.materials.new("glowing")
    nodes = nodes_of(material)
    emission = nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value = (*color, 1.0)
    output = next(node for node in nodes if node.type == "OUTPUT_MATERIAL")
    material.node_tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return material


def rendered(scene, path):
    """Render the scene; its pixels (h, w, 4)."""
    scene.render.filepath = str(path / "picture.exr")
    bpy.ops.render.render(write_still=True)
    return picture(scene.render.filepath)


def is_sphere(pixels):
    """Where the glowing sphere is, (h, w) bool."""
    return pixels[..., 0] > 1.0
