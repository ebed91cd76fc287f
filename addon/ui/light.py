# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels of a light: what Conic does with it and nothing else."""

import bpy

from ..sync.compat import may_lack_nodes, node_tree
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
        _draw_shape(layout.column(), light)
        layout.prop(light, "use_shadow", text="Cast Shadow")


def _draw_shape(column, light):
    if light.type == "SUN":
        column.prop(light, "angle")
    elif light.type == "AREA":
        column.prop(light, "shape")
        if light.shape in {"RECTANGLE", "ELLIPSE"}:
            column.prop(light, "size", text="Size X")
            column.prop(light, "size_y", text="Y")
        else:
            column.prop(light, "size")
        column.prop(light, "spread")
    else:
        column.prop(light, "shadow_soft_size", text="Radius")
        column.prop(light, "use_soft_falloff")
    if light.type == "SPOT":
        column.prop(light, "spot_size")
        column.prop(light, "spot_blend")
        column.prop(light, "show_cone")


class CONIC_LIGHT_PT_nodes(PropertiesPanel, bpy.types.Panel):
    bl_label = "Nodes"
    bl_context = "data"

    @classmethod
    def poll(cls, context):
        light = context.light
        return light and (may_lack_nodes(light) or light.node_tree) and super().poll(context)

    def draw(self, context):
        layout, light = self.layout, context.light
        layout.use_property_split = True
        if may_lack_nodes(light):
            layout.prop(light, "use_nodes", toggle=True)
        tree = node_tree(light)
        if tree is None:
            return
        output = tree.get_output_node("CYCLES")
        if output is None:
            layout.label(text="Without an output node it gives no light", icon="ERROR")
        else:
            layout.template_node_view(tree, output, output.inputs["Surface"])


register, unregister = bpy.utils.register_classes_factory((CONIC_LIGHT_PT_light, CONIC_LIGHT_PT_nodes))
