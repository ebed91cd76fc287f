# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels of the world's light: how surfaces get it, ambient occlusion, and which rays see the world."""

import bpy

from .base import PropertiesPanel, RenderPanel, as_rows


class CONIC_RENDER_PT_world_light(RenderPanel, bpy.types.Panel):
    bl_label = "World Light"

    def draw(self, context):
        layout = as_rows(self.layout)
        layout.prop(context.scene.conic, "world_light")


class CONIC_RENDER_PT_ambient_occlusion(RenderPanel, bpy.types.Panel):
    bl_label = "Ambient Occlusion"
    bl_parent_id = "CONIC_RENDER_PT_world_light"

    def draw_header(self, context):
        self.layout.active = _is_hemisphere(context.scene.conic)
        self.layout.prop(context.scene.conic, "use_ao", text="")

    def draw(self, context):
        layout, settings = as_rows(self.layout), context.scene.conic
        layout.active = settings.use_ao and _is_hemisphere(settings)
        column = layout.column(align=True)
        column.prop(settings, "ao_distance")
        column.prop(settings, "ao_factor")


class CONIC_WORLD_PT_ray_visibility(PropertiesPanel, bpy.types.Panel):
    bl_label = "Ray Visibility"
    bl_context = "world"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return super().poll(context) and hasattr(context.world, "cycles_visibility")

    def draw(self, context):
        layout, world = as_rows(self.layout), context.world
        column = layout.column(heading="Seen by")
        for ray in ("camera", "diffuse", "glossy", "transmission"):
            column.prop(world.cycles_visibility, ray)


def _is_hemisphere(settings):
    """Whether some picture has the light that ambient occlusion takes from."""
    return settings.world_light == "HEMISPHERE" or (
        settings.world_light == "SAMPLED" and 1 in (settings.samples, settings.preview_samples)
    )


register, unregister = bpy.utils.register_classes_factory(
    (CONIC_RENDER_PT_world_light, CONIC_RENDER_PT_ambient_occlusion, CONIC_WORLD_PT_ray_visibility)
)
