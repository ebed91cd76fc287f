# SPDX-License-Identifier: GPL-3.0-or-later
"""Add > Conic: each exact shape as an object with a mesh that stands for it."""

import bpy
from bpy.props import FloatProperty
from bpy_extras.object_utils import AddObjectHelper, object_data_add

from . import proxy_mesh
from .new_mesh import new_mesh


def length(name, description, *, default=1.0, smallest=1e-6):
    """A length in scene units that may not be less than `smallest`."""
    return FloatProperty(
        name=name,
        description=description,
        default=default,
        min=smallest,
        soft_min=0.001 if smallest else 0.0,
        soft_max=100.0,
        unit="LENGTH",
    )


class AddShape(AddObjectHelper):
    """Base of the operators: a sub-class names the shape and makes its mesh."""

    bl_options = {"REGISTER", "UNDO"}
    primitive = ""

    @classmethod
    def poll(cls, context):
        return context.mode == "OBJECT" and context.scene.is_editable

    def proxy(self):
        """The `ProxyMesh` of the operator's settings."""
        raise NotImplementedError

    def execute(self, context):
        name = self.primitive.capitalize()
        added = object_data_add(context, new_mesh(name, self.proxy()), operator=self, name=name)
        added.conic.primitive = self.primitive
        return {"FINISHED"}


class CONIC_OT_sphere_add(AddShape, bpy.types.Operator):
    """Add an exact sphere"""

    bl_idname = "conic.sphere_add"
    bl_label = "Sphere"
    primitive = "SPHERE"
    radius: length("Radius", "Radius of the sphere")

    def proxy(self):
        return proxy_mesh.sphere(self.radius)


class CONIC_OT_cylinder_add(AddShape, bpy.types.Operator):
    """Add an exact solid cylinder"""

    bl_idname = "conic.cylinder_add"
    bl_label = "Cylinder"
    primitive = "CYLINDER"
    radius: length("Radius", "Radius of the cylinder")
    depth: length("Depth", "Height of the cylinder", default=2.0)

    def proxy(self):
        return proxy_mesh.cylinder(self.radius, self.depth)


class CONIC_OT_cone_add(AddShape, bpy.types.Operator):
    """Add an exact solid cone, pointed or truncated"""

    bl_idname = "conic.cone_add"
    bl_label = "Cone"
    primitive = "CONE"
    radius1: length("Radius 1", "Radius at the lower end; 0 for a point", smallest=0.0)
    radius2: length("Radius 2", "Radius at the upper end; 0 for a point", default=0.0, smallest=0.0)
    depth: length("Depth", "Height of the cone", default=2.0)

    def execute(self, context):
        if max(self.radius1, self.radius2) < 1e-6:
            self.report({"ERROR"}, "A cone needs a radius above 0 at one of its ends")
            return {"CANCELLED"}
        return super().execute(context)

    def proxy(self):
        return proxy_mesh.cone(self.radius1, self.radius2, self.depth)


class CONIC_OT_disc_add(AddShape, bpy.types.Operator):
    """Add an exact flat disc"""

    bl_idname = "conic.disc_add"
    bl_label = "Disc"
    primitive = "DISC"
    radius: length("Radius", "Radius of the disc")

    def proxy(self):
        return proxy_mesh.disc(self.radius)


class CONIC_OT_plane_add(AddShape, bpy.types.Operator):
    """Add a plane without end; its mesh is a square that stands for it"""

    bl_idname = "conic.plane_add"
    bl_label = "Plane"
    primitive = "PLANE"
    size: length("Size", "Side of the square that stands for the plane", default=2.0)

    def proxy(self):
        return proxy_mesh.plane(self.size)


OPERATORS = (
    (CONIC_OT_sphere_add, "MESH_UVSPHERE"),
    (CONIC_OT_cylinder_add, "MESH_CYLINDER"),
    (CONIC_OT_cone_add, "MESH_CONE"),
    (CONIC_OT_disc_add, "MESH_CIRCLE"),
    (CONIC_OT_plane_add, "MESH_PLANE"),
)


class CONIC_MT_add(bpy.types.Menu):
    """Exact shapes that Conic renders without tessellation"""

    bl_label = "Conic"

    def draw(self, _context):
        self.layout.operator_context = "INVOKE_REGION_WIN"
        for operator, icon in OPERATORS:
            self.layout.operator(operator.bl_idname, icon=icon)


def draw_submenu(self, _context):
    """The entry in the 3D viewport's Add menu."""
    self.layout.menu(CONIC_MT_add.__name__, icon="MESH_UVSPHERE")


_register_classes, _unregister_classes = bpy.utils.register_classes_factory(
    (*(operator for operator, _ in OPERATORS), CONIC_MT_add)
)


def register():
    _register_classes()
    bpy.types.VIEW3D_MT_add.append(draw_submenu)


def unregister():
    bpy.types.VIEW3D_MT_add.remove(draw_submenu)
    _unregister_classes()
