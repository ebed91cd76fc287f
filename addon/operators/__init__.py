# SPDX-License-Identifier: GPL-3.0-or-later
"""What the user can do with Conic: Add > Conic, and File > Import > Neutral File Format."""

from . import add_shape, import_nff


def register():
    add_shape.register()
    import_nff.register()


def unregister():
    import_nff.unregister()
    add_shape.unregister()
