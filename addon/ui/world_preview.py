# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of a world's preview, as Cycles has one; Blender's own panels have none."""

import bpy

from .base import PropertiesPanel


class CONIC_WORLD_PT_preview(PropertiesPanel, bpy.types.Panel):
    bl_label = "Preview"
    bl_context = "world"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return context.world is not None and super().poll(context)

    def draw(self, context):
        self.layout.template_preview(context.world)


register, unregister = bpy.utils.register_classes_factory((CONIC_WORLD_PT_preview,))
