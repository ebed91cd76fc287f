# SPDX-License-Identifier: GPL-3.0-or-later
"""What the user can do with Conic: Add > Conic, File > Import > Neutral File Format, and presets of materials."""

from . import add_shape, import_nff, material_presets


def register():
    add_shape.register()
    import_nff.register()
    material_presets.register()


def unregister():
    material_presets.unregister()
    import_nff.unregister()
    add_shape.unregister()
