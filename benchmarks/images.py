"""What reading images costs at the first sync and at later ones: `python -m benchmarks.images`.

Seconds of the reading alone, of an image of 4096 x 4096 pixels with alpha that Blender has loaded; and of the sync, at
once, again, and again with what was read before. The file is newer than this process, so that syncs decode it anew.
"""

import tempfile
import time
from pathlib import Path

import bpy
import numpy as np

import addon
from addon.sync.image_pixels import read_image, to_linear
from addon.sync.scene_reader import SceneReader

_SIZE = 4096
_KINDS = {
    "bytes": ("PNG", "sRGB"),
    "bytes of Rec.1886": ("PNG", "Rec.1886"),
    "floats": ("OPEN_EXR", "Linear Rec.709"),
}


def saved(folder, file_format):
    """The path of a smooth picture with alpha."""
    x, y = np.meshgrid(*[np.linspace(0.0, 1.0, _SIZE, dtype=np.float32)] * 2)
    made = bpy.data.images.new("made", _SIZE, _SIZE, alpha=True, float_buffer=file_format == "OPEN_EXR")
    made.pixels.foreach_set(np.stack([x, y, x * y, 0.5 + 0.5 * x], axis=-1).ravel())
    made.filepath_raw, made.file_format = str(Path(folder) / "made"), file_format
    made.save()
    bpy.data.images.remove(made)
    return str(Path(folder) / "made")


def show(image):
    """A scene of a plane with an image."""
    bpy.ops.mesh.primitive_plane_add()
    material = bpy.data.materials.new("material")
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    tree = material.node_tree
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    bpy.context.object.data.materials.append(material)
    bpy.ops.object.camera_add()
    bpy.context.scene.camera = bpy.context.object


def sync(reader=None):
    (reader or new_reader()).read(bpy.context.evaluated_depsgraph_get(), 64, 64)


def new_reader():
    return SceneReader(lambda *message: None)


def seconds(function, *arguments):
    start = time.perf_counter()
    function(*arguments)
    return time.perf_counter() - start


def measure(path, space):
    """Seconds of reading an image, of a first sync, of another of a new reader and of the same."""
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = space
    len(image.pixels)
    show(image)
    reader = new_reader()
    yield min(seconds(lambda: to_linear(read_image(image))) for _ in range(3))
    yield seconds(sync, reader)
    yield seconds(sync)
    yield min(seconds(sync, reader) for _ in range(3))


def main():
    addon.register()
    print(f"{'':20}{'reading':>10}{'first':>10}{'again':>10}{'kept':>10}")
    for name, (file_format, space) in _KINDS.items():
        bpy.ops.wm.read_factory_settings(use_empty=True)
        with tempfile.TemporaryDirectory() as folder:
            figures = measure(saved(folder, file_format), space)
            print(f"{name:20}{''.join(f'{figure:10.4f}' for figure in figures)}", flush=True)


if __name__ == "__main__":
    main()
