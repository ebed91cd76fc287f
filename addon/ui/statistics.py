# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of what the newest picture was made of and what it cost."""

import bpy

from .. import statistics
from .base import RenderPanel


class CONIC_RENDER_PT_statistics(RenderPanel, bpy.types.Panel):
    bl_label = "Statistics"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        latest = statistics.latest()
        if latest is None:
            self.layout.label(text="Nothing rendered yet", icon="INFO")
            return
        for heading, rows in statistics.sections(latest):
            column = self.layout.column(align=True)
            column.label(text=heading)
            for label, value in rows:
                row = column.split(factor=0.55)
                row.label(text=f"    {label}")
                row.label(text=value)


def _redraw():
    """Have the panel drawn again, wherever it is open."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "PROPERTIES":
                area.tag_redraw()


_register_classes, _unregister_classes = bpy.utils.register_classes_factory((CONIC_RENDER_PT_statistics,))


def register():
    _register_classes()
    statistics.observers.append(_redraw)


def unregister():
    statistics.observers.remove(_redraw)
    _unregister_classes()
