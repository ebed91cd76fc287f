# SPDX-License-Identifier: GPL-3.0-or-later
"""What Conic's own panels have in common."""

ENGINE = "CONIC"


class PropertiesPanel:
    """Mix-in of a panel in the Properties editor that is there when Conic is the render engine."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES


class RenderPanel(PropertiesPanel):
    """Mix-in of a panel of the Render tab."""

    bl_context = "render"


def as_rows(layout):
    """A panel's layout whose properties are rows, names to the left. No button to animate one stands beside it."""
    layout.use_property_split = True
    layout.use_property_decorate = False
    return layout
