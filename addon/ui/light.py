# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of a light: what Conic does with it and nothing else."""

import bpy

from .base import PropertiesPanel


class CONIC_LIGHT_PT_light(PropertiesPanel, bpy.types.Panel):
    bl_label = "Light"
    bl_context = "data"

    @classmethod
    def poll(cls, context):
        return context.light and super().poll(context)

    def draw(self, context):
        layout, light = self.layout, context.light
        layout.row().prop(light, "type", expand=True)
        layout.use_property_split = True
        column = layout.column()
        if hasattr(light, "use_temperature"):
            column.prop(light, "use_temperature")
            if light.use_temperature:
                column.prop(light, "temperature")
        column.prop(light, "color")
        column.prop(light, "energy", text="Strength" if light.type == "SUN" else "Power")
        if hasattr(light, "exposure"):
            column.prop(light, "exposure")
            column.prop(light, "normalize")
        if light.type in {"AREA", "SPOT"}:
            layout.label(text=f"Not a {light.type.lower()} light yet: shines as a point light", icon="INFO")


register, unregister = bpy.utils.register_classes_factory((CONIC_LIGHT_PT_light,))
