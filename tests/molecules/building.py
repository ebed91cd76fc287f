"""Molecules by the add-on Molecular Nodes in Blender, and pictures of them by Conic and by Cycles."""

import time
import warnings
from pathlib import Path

import bpy
import numpy as np

from tests.blender.pictures import picture

#: Cycles draws points exactly, and meshes as they are: the finest that the add-on makes.
EXACT = {
    "spheres": {"sphere": "Point"},
    "ball_and_stick": {"sphere": "Point", "quality": 5},
    "sticks": {"sphere": "Point", "quality": 5},
}


def load(path):
    """A file of atoms as the add-on's Molecule, without a style."""
    import molecularnodes

    molecularnodes.register()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # MDAnalysis' remarks on its own files
        return molecularnodes.Molecule.load(str(path), name="molecule", remove_solvent=False)


def set_style(molecule, style, material="Default", selection=None, **options):
    """Give the molecule one style, in place of those that it has."""
    nodes = molecule.modifier_node_tree.nodes
    for node in [node for node in nodes if node.name.startswith(("Style", "Named Attribute"))]:
        nodes.remove(node)
    molecule.add_style(style, material=material, selection=selection, **options)


def flat_paint():
    """A material that shows the atoms' colours as they are, by the add-on's own node group."""
    import molecularnodes

    material = molecularnodes.material.append_material("Default").copy()
    tree = material.node_tree
    color = next(node for node in tree.nodes if node.type == "GROUP" and node.node_tree.name.startswith("MN Color"))
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    shader = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(color.outputs["Color"], shader.inputs["Color"])
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def positions_of(molecule):
    """Where the atoms are, (n, 3)."""
    position = np.empty((len(molecule.object.data.vertices), 3), np.float32)
    molecule.object.data.attributes["position"].data.foreach_get("vector", position.reshape(-1))
    return position


def look_at(position, share=1.0):
    """A camera from the front that sees the middle `share` of atoms at position (n, 3)."""
    low, high = position.min(axis=0), position.max(axis=0)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", float((high - low).max()) * share
    camera.location = (*(low + high)[:1] / 2.0, low[1] - 1.0, (low + high)[2] / 2.0)
    camera.rotation_euler = (np.pi / 2.0, 0.0, 0.0)
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera


def rendered(engine, folder, size, samples=1):
    """The picture (size, size, 4) by an engine without background, a ray through the middle of each pixel, and the
    seconds that the render took."""
    scene = bpy.context.scene
    scene.world = None
    render = scene.render
    render.engine, render.film_transparent = engine, True
    render.resolution_x = render.resolution_y = size
    render.resolution_percentage = 100
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.image_settings.color_mode = "RGBA"
    render.filepath = str(Path(folder) / f"{engine}.exr")
    scene.conic.samples = scene.cycles.samples = samples
    scene.cycles.device = "CPU"
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "GAUSSIAN", 0.01
    started = time.perf_counter()
    bpy.ops.render.render(write_still=True)
    seconds = time.perf_counter() - started
    return picture(render.filepath), seconds


def grown(mask):
    """A mask and the eight neighbours of each of its pixels."""
    padded = np.pad(mask, 1)
    height, width = mask.shape
    return np.any([padded[y : y + height, x : x + width] for y in range(3) for x in range(3)], axis=0)
