# SPDX-License-Identifier: GPL-3.0-or-later
"""A panel below Blender's own of an object's visibility: which rays see it or are lit by it, and whether it catches
shadows."""

import bpy

from .base import PropertiesPanel, as_rows

#: Types that rays can meet.
SEEN = {"MESH", "CURVE", "SURFACE", "FONT", "META", "CURVES", "POINTCLOUD"}


def is_seen(obj):
    """Whether rays can meet an object: its own surface, or what it instances."""
    return obj is not None and (obj.type in SEEN or obj.is_instancer)


def is_light(obj):
    return obj is not None and obj.type == "LIGHT"


class CONIC_OBJECT_PT_ray_visibility(PropertiesPanel, bpy.types.Panel):
    bl_label = "Ray Visibility"
    bl_context = "object"
    bl_parent_id = "OBJECT_PT_visibility"

    @classmethod
    def poll(cls, context):
        obj = context.object
        return (is_seen(obj) or is_light(obj)) and super().poll(context)

    def draw(self, context):
        layout, obj = as_rows(self.layout), context.object
        column = layout.column()
        column.prop(obj, "visible_camera", text="Camera")
        if is_light(obj):
            column.prop(obj, "visible_diffuse", text="Diffuse")
        column.prop(obj, "visible_glossy", text="Glossy")
        column.prop(obj, "visible_transmission", text="Transmission")
        if is_light(obj):
            return
        column.prop(obj, "visible_shadow", text="Shadow")
        diffuse = column.column()
        diffuse.active = False
        diffuse.prop(obj, "visible_diffuse", text="Diffuse")
        diffuse.label(text="Diffuse has no effect: Conic traces no such rays", icon="INFO")
        layout.column(heading="Mask").prop(obj, "is_shadow_catcher")


register, unregister = bpy.utils.register_classes_factory((CONIC_OBJECT_PT_ray_visibility,))
