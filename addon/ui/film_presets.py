# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of the film: sets of its settings, some that come with Conic and those that people add."""

from pathlib import Path

import bpy
from bl_operators.presets import AddPresetBase
from bl_ui.utils import PresetPanel

from ..film_properties import FilmProperties
from .base import ENGINE

#: The folder that holds `presets`.
_FOLDER = str(Path(__file__).resolve().parents[1])
#: What lights the scene belongs to how it is drawn.
_LIGHTING = ("world_light", "use_ao", "ao_distance", "ao_factor")


class CONIC_PT_film_presets(PresetPanel, bpy.types.Panel):
    bl_label = "Film Presets"
    preset_subdir = "conic/film"
    preset_operator = "script.execute_preset"
    preset_add_operator = "render.conic_film_preset_add"
    COMPAT_ENGINES = {ENGINE}


class CONIC_OT_film_preset_add(AddPresetBase, bpy.types.Operator):
    """Add or remove a preset of how the film looks"""

    bl_idname = "render.conic_film_preset_add"
    bl_label = "Add Film Preset"
    preset_menu = "CONIC_PT_film_presets"
    preset_subdir = "conic/film"
    preset_defines = ["render = bpy.context.scene.render", "conic = bpy.context.scene.conic"]
    preset_values = [
        "render.film_transparent",
        *(f"conic.{name}" for name in (*FilmProperties.__annotations__, *_LIGHTING)),
    ]


_register_classes, _unregister_classes = bpy.utils.register_classes_factory(
    (CONIC_PT_film_presets, CONIC_OT_film_preset_add)
)


def register():
    _register_classes()
    bpy.utils.register_preset_path(_FOLDER)


def unregister():
    bpy.utils.unregister_preset_path(_FOLDER)
    _unregister_classes()
