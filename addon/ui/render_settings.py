# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels of the Render tab, and the switch that pauses a rendered viewport."""

import bpy

from .base import ENGINE, RenderPanel, as_rows


class CONIC_RENDER_PT_sampling(RenderPanel, bpy.types.Panel):
    bl_label = "Sampling"

    def draw(self, context):
        layout = as_rows(self.layout)
        column = layout.column(align=True)
        column.prop(context.scene.conic, "preview_samples")
        column.prop(context.scene.conic, "samples")
        row = layout.row(align=True)
        row.prop(context.scene.conic, "seed")
        row.prop(context.scene.conic, "use_animated_seed", text="", icon="TIME")


class CONIC_RENDER_PT_viewport(RenderPanel, bpy.types.Panel):
    bl_label = "Viewport"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = as_rows(self.layout)
        column = layout.column()
        column.prop(context.scene.conic, "preview_frame_seconds")
        column.prop(context.scene.render, "preview_pixel_size", text="Pixel Size")
        column.prop(context.scene.conic, "preview_pause")


class CONIC_RENDER_PT_light_paths(RenderPanel, bpy.types.Panel):
    bl_label = "Light Paths"

    def draw(self, context):
        layout = as_rows(self.layout)
        column = layout.column(align=True)
        column.prop(context.scene.conic, "max_depth")
        column.prop(context.scene.conic, "weight_cutoff")
        layout.prop(context.scene.conic, "shadows")


class CONIC_RENDER_PT_shapes(RenderPanel, bpy.types.Panel):
    bl_label = "Shapes"

    def draw(self, context):
        layout = as_rows(self.layout)
        settings = context.scene.conic
        layout.prop(settings, "recognise")
        column = layout.column(align=True)
        column.prop(settings, "curve_sampling")
        column.prop(settings, "curve_tolerance" if settings.curve_sampling == "PIXELS" else "curve_steps")


class CONIC_RENDER_PT_performance(RenderPanel, bpy.types.Panel):
    bl_label = "Performance"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = as_rows(self.layout)
        layout.prop(context.scene.conic, "entry")


def _draw_pause(header, context):
    """The switch in the header of a rendered viewport."""
    if context.engine == ENGINE and context.space_data.shading.type == "RENDERED":
        settings = context.scene.conic
        header.layout.prop(settings, "preview_pause", text="", icon="PLAY" if settings.preview_pause else "PAUSE")


_register_classes, _unregister_classes = bpy.utils.register_classes_factory(
    (
        CONIC_RENDER_PT_sampling,
        CONIC_RENDER_PT_viewport,
        CONIC_RENDER_PT_light_paths,
        CONIC_RENDER_PT_shapes,
        CONIC_RENDER_PT_performance,
    )
)


def register():
    _register_classes()
    bpy.types.VIEW3D_HT_header.append(_draw_pause)


def unregister():
    bpy.types.VIEW3D_HT_header.remove(_draw_pause)
    _unregister_classes()
