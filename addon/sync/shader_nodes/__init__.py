# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's shader nodes, each one entry: what its outputs are as expressions of its inputs. Each file of this folder
is a subject."""

from importlib import import_module
from pkgutil import iter_modules

for _subject in iter_modules(__path__):
    import_module(f".{_subject.name}", __name__)
