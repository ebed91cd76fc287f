# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels of the Render tab."""

import bpy

from .base import PropertiesPanel


class RenderPanel(PropertiesPanel):
    bl_context = "render"


class CONIC_RENDER_PT_sampling(RenderPanel, bpy.types.Panel):
    bl_label = "Sampling"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column(align=True)
        column.prop(context.scene.conic, "preview_samples")
        column.prop(context.scene.conic, "samples")


class CONIC_RENDER_PT_light_paths(RenderPanel, bpy.types.Panel):
    bl_label = "Light Paths"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column(align=True)
        column.prop(context.scene.conic, "max_depth")
        column.prop(context.scene.conic, "weight_cutoff")
        layout.prop(context.scene.conic, "shadows")


class CONIC_RENDER_PT_shapes(RenderPanel, bpy.types.Panel):
    bl_label = "Shapes"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.scene.conic
        layout.prop(settings, "recognise")
        column = layout.column(align=True)
        column.prop(settings, "curve_sampling")
        column.prop(settings, "curve_tolerance" if settings.curve_sampling == "PIXELS" else "curve_steps")


register, unregister = bpy.utils.register_classes_factory(
    (CONIC_RENDER_PT_sampling, CONIC_RENDER_PT_light_paths, CONIC_RENDER_PT_shapes)
)
