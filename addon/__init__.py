# SPDX-License-Identifier: GPL-3.0-or-later
"""Conic in Blender: registers its rooms in order. Importing this package imports no bpy."""

from importlib import import_module

# What later ones refer to comes first; each has register() and unregister().
_MODULES = ("properties", "render_engine", "operators", "ui")


def register() -> None:
    """Register every module; when one fails, those before it are taken out again."""
    done = []
    try:
        for name in _MODULES:
            module = import_module(f".{name}", __package__)
            module.register()
            done.append(module)
    except Exception:
        for module in reversed(done):
            module.unregister()
        raise


def unregister() -> None:
    """Unregister in the opposite order."""
    for name in reversed(_MODULES):
        import_module(f".{name}", __package__).unregister()
