# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels, a file a subject, and which of Blender's own panels are shown when Conic is the render engine."""

from . import light, material, object_shape, object_visibility, render_settings, standard_panels, statistics

_MODULES = (standard_panels, render_settings, statistics, object_shape, object_visibility, material, light)


def register():
    for module in _MODULES:
        module.register()


def unregister():
    for module in reversed(_MODULES):
        module.unregister()
