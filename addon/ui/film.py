# SPDX-License-Identifier: GPL-3.0-or-later
"""Film, a panel of the Render tab: transparency, depth cue, outlines, and presets of all of these."""

import bpy

from .base import RenderPanel, as_rows
from .film_presets import CONIC_PT_film_presets


class CONIC_RENDER_PT_film(RenderPanel, bpy.types.Panel):
    bl_label = "Film"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header_preset(self, context):
        CONIC_PT_film_presets.draw_panel_header(self.layout)

    def draw(self, context):
        layout = as_rows(self.layout)
        layout.prop(context.scene.render, "film_transparent", text="Transparent")
        layout.prop(context.scene.conic, "use_flat_colors")


class FilmOption(RenderPanel):
    """Mix-in of a sub-panel with a check box, the property `option`, in its header."""

    bl_parent_id = "CONIC_RENDER_PT_film"
    bl_options = {"DEFAULT_CLOSED"}
    option = ""

    def draw_header(self, context):
        self.layout.prop(context.scene.conic, self.option, text="")

    def draw(self, context):
        layout = as_rows(self.layout)
        layout.active = getattr(context.scene.conic, self.option)
        self.draw_settings(layout, context.scene.conic)


class CONIC_RENDER_PT_depth_cue(FilmOption, bpy.types.Panel):
    bl_label = "Depth Cue"
    option = "use_depth_cue"

    def draw_settings(self, layout, settings):
        layout.prop(settings, "depth_cue_into")
        if settings.depth_cue_into == "COLOR":
            layout.prop(settings, "depth_cue_color")
        layout.prop(settings, "depth_cue_strength")
        layout.prop(settings, "depth_cue_range")
        if settings.depth_cue_range == "DISTANCES":
            column = layout.column(align=True)
            column.prop(settings, "depth_cue_start")
            column.prop(settings, "depth_cue_end")


class CONIC_RENDER_PT_outlines(FilmOption, bpy.types.Panel):
    bl_label = "Outlines"
    option = "use_outlines"

    def draw_settings(self, layout, settings):
        layout.prop(settings, "outline_around")
        if settings.outline_around == "ATTRIBUTE":
            layout.prop(settings, "outline_attribute")
        layout.prop(settings, "outline_color")
        column = layout.column(align=True)
        column.prop(settings, "outline_width")
        column.prop(settings, "outline_inner_width", text="Inner")
        layout.prop(settings, "outline_crease_angle")
        layout.prop(settings, "outline_depth_step")


register, unregister = bpy.utils.register_classes_factory(
    (CONIC_RENDER_PT_film, CONIC_RENDER_PT_depth_cue, CONIC_RENDER_PT_outlines)
)
