# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of a material's settings beside its nodes, and the menu of presets below its slots."""

import bpy

from .base import ENGINE, PropertiesPanel, as_rows


class CONIC_MATERIAL_PT_settings(PropertiesPanel, bpy.types.Panel):
    bl_label = "Settings"
    bl_context = "material"

    @classmethod
    def poll(cls, context):
        return context.material is not None and super().poll(context)

    def draw(self, context):
        layout, material = as_rows(self.layout), context.material
        column = layout.column(heading="Backface Culling")
        column.prop(material, "use_backface_culling", text="Camera")
        column.prop(material, "use_backface_culling_shadow", text="Shadow")
        layout.column().prop(material, "pass_index")


def _draw_presets(self, context):
    if context.engine == ENGINE and context.object is not None:
        self.layout.menu("CONIC_MT_material_presets", text="Conic Presets", icon="PRESET")


_register_classes, _unregister_classes = bpy.utils.register_classes_factory((CONIC_MATERIAL_PT_settings,))


def register():
    _register_classes()
    bpy.types.EEVEE_MATERIAL_PT_context_material.append(_draw_presets)


def unregister():
    bpy.types.EEVEE_MATERIAL_PT_context_material.remove(_draw_presets)
    _unregister_classes()
