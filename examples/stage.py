# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that share their meshes: Blender's own sphere, cylinder, cone, circle and plane, which Conic renders as exact
shapes."""

import bpy
import numpy as np
from mathutils import Matrix, Vector


class Stage:
    """The meshes that the objects share, of unit size about the origin, and ways to place objects that have them."""

    def __init__(self):
        self.collection = bpy.context.scene.collection
        self.ball = new_mesh("uv_sphere", segments=32, ring_count=16)
        self.rod = new_mesh("cylinder", vertices=32, end_fill_type="NOTHING")
        self.drum = new_mesh("cylinder", vertices=32)
        self.cone = new_mesh("cone", vertices=32)
        self.disc = new_mesh("circle", vertices=32, fill_type="NGON")
        self.square = new_mesh("plane")

    def place(self, name, mesh, material, location, scale, rotation=None):
        """Add an object with a material of its own; `rotation` is a mathutils Euler or Quaternion."""
        thing = bpy.data.objects.new(name, mesh)
        thing.matrix_basis = Matrix.LocRotScale(Vector(location), rotation, Vector(np.broadcast_to(scale, 3)))
        thing.material_slots[0].link = "OBJECT"
        thing.material_slots[0].material = material
        self.collection.objects.link(thing)
        return thing

    def place_rod(self, name, material, base, apex, radius):
        """Add an open cylinder between two points."""
        base, apex = Vector(base), Vector(apex)
        turn = (apex - base).to_track_quat("Z", "Y")
        return self.place(name, self.rod, material, (base + apex) / 2, (radius, radius, (apex - base).length / 2), turn)


def new_mesh(kind, **options):
    """One of the meshes that Blender adds, smooth, with one empty material slot."""
    getattr(bpy.ops.mesh, f"primitive_{kind}_add")(**options)
    made = bpy.context.object
    mesh = made.data
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
    mesh.materials.append(None)
    bpy.data.objects.remove(made)
    return mesh


def new_image(name, pixels, is_float):
    """Pixels (h, w, 3) as an image that a .blend file keeps: scene-linear if `is_float`, otherwise in sRGB."""
    height, width, _ = pixels.shape
    image = bpy.data.images.new(name, width, height, float_buffer=is_float)
    image.pixels.foreach_set(np.concatenate([pixels, np.ones((height, width, 1))], -1).astype(np.float32).ravel())
    image.update()
    image.pack()
    return image


def add_camera(stage, eye, target, lens=45.0):
    """A camera that looks from `eye` at `target`; `lens` in millimetres."""
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.lens = lens
    camera.location = eye
    camera.rotation_euler = (Vector(target) - Vector(eye)).to_track_quat("-Z", "Y").to_euler()
    stage.collection.objects.link(camera)
    return camera
