# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's own panels that are shown for Conic: all that Blender shows for an engine it knows nothing of,
less what Conic has of its own or does nothing with, and a few of EEVEE's."""

import bpy

from .base import ENGINE

# Blender's panels for its other engines that hold for Conic too.
BORROWED = {
    "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_WORLD_PT_surface",
    "MATERIAL_PT_preview",
}

# Conic has its own, or does not do what they set.
REFUSED = {
    "DATA_PT_light",
    "DATA_PT_spot",
    "DATA_PT_falloff_curve",
    "DATA_PT_volume_render",
    "EEVEE_MATERIAL_PT_viewport_settings",
    "NODE_DATA_PT_light",
    "SCENE_PT_audio",
}
REFUSED_SUBJECTS = ("freestyle", "lightprobe")  # in the panel's name


def is_shown(panel) -> bool:
    """Whether a panel class of Blender's is one to show for Conic."""
    name = panel.__name__
    if name in BORROWED:
        return True
    refused = name in REFUSED or any(subject in name for subject in REFUSED_SUBJECTS)
    return "BLENDER_RENDER" in panel.COMPAT_ENGINES and not refused


def standard_panels():
    """Yield every registered panel class that says itself which engines it is for; Conic's leave it to a
    mix-in."""
    for panel in bpy.types.Panel.__subclasses__():
        if "COMPAT_ENGINES" in panel.__dict__:
            yield panel


def register():
    for panel in standard_panels():
        if is_shown(panel):
            panel.COMPAT_ENGINES.add(ENGINE)


def unregister():
    for panel in standard_panels():
        panel.COMPAT_ENGINES.discard(ENGINE)
