# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of a material's settings beside its nodes."""

import bpy

from .base import PropertiesPanel


class CONIC_MATERIAL_PT_settings(PropertiesPanel, bpy.types.Panel):
    bl_label = "Settings"
    bl_context = "material"

    @classmethod
    def poll(cls, context):
        return context.material is not None and super().poll(context)

    def draw(self, context):
        layout, material = self.layout, context.material
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column(heading="Backface Culling")
        column.prop(material, "use_backface_culling", text="Camera")
        column.prop(material, "use_backface_culling_shadow", text="Shadow")


register, unregister = bpy.utils.register_classes_factory((CONIC_MATERIAL_PT_settings,))
