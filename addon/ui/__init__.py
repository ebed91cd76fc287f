# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels, a file a subject, and which of Blender's own panels are shown when Conic is the render engine."""

from . import (
    film,
    film_presets,
    light,
    material,
    object_shape,
    object_visibility,
    render_settings,
    standard_panels,
    statistics,
    world_light,
    world_preview,
)

# In the order of the tabs; presets before the panels that open them.
_MODULES = (
    standard_panels,
    render_settings,
    film_presets,
    film,
    world_light,
    statistics,
    object_shape,
    object_visibility,
    material,
    light,
    world_preview,
)


def register():
    for module in _MODULES:
        module.register()


def unregister():
    for module in reversed(_MODULES):
        module.unregister()
