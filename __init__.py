# SPDX-License-Identifier: GPL-3.0-or-later
"""Conic, a render engine for Blender: the extension's entry, which imports nothing until it is registered."""


def register() -> None:
    """Add Conic to Blender."""
    from .addon import register as register_addon

    register_addon()


def unregister() -> None:
    """Take Conic out of Blender."""
    from .addon import unregister as unregister_addon

    unregister_addon()
