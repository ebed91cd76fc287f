# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's world: what a ray sees that hits nothing."""

from ..engine.scene import World
from .closures import read_closure
from .compat import flattened
from .nodes import output_source
from .tree_reader import TreeReader, deep_recursion

BLACK = World(color=(0.0, 0.0, 0.0))


def read_world(world, images, reports):
    """The engine's World of a Blender world; black without one."""
    if world is None:
        return BLACK
    tree, _kept = flattened(world)
    if tree is None:
        return World(color=tuple(max(c, 0.0) for c in world.color))
    reader = TreeReader(f"world {world.name!r}", world, "WORLD", images, reports)
    with deep_recursion():
        read = _read(tree, reader)
        reader.finish()
    return read


def _read(tree, reader):
    surface = output_source(tree, "Surface")
    volume = output_source(tree, "Volume")
    if volume is not None and volume.node is not None:
        reader.left_out(volume, "its volume")
    if surface is None or surface.node is None:
        return BLACK
    return World(color=read_closure(surface, reader).glow)
