# SPDX-License-Identifier: GPL-3.0-or-later
"""Keys by which things are known within one sync and from one to the next. A Blender pointer is never one of them."""


def data_key(data):
    """Key of evaluated data: objects that share their data, modifiers and all, have it in common; others have not."""
    return data.session_uid


def original_key(owner):
    """Key of a material, image or object that stays the same over evaluations, undo and renaming."""
    return owner.original.session_uid
