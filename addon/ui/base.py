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
