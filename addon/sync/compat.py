# SPDX-License-Identifier: GPL-3.0-or-later
"""What differs between Blender 4.2 and 5.2, in one place; guards ask for the feature where that is possible."""

import bpy
from mathutils import Matrix

#: From these on materials, worlds and lights always use their nodes; asking for `use_nodes` gives a deprecation
#: warning.
_ALWAYS_NODES = (5, 0, 0)
_LIGHTS_ALWAYS_NODES = (5, 2, 0)
#: From this on the random id of an instance depends on its levels only.
_RANDOM_BY_LEVELS = (5, 0, 0)
_LEVELS = 8


def may_lack_nodes(owner):
    """Whether a material, world or light has a switch that says whether its nodes are used."""
    return bpy.app.version < (_LIGHTS_ALWAYS_NODES if isinstance(owner, bpy.types.Light) else _ALWAYS_NODES)


def node_tree(owner):
    """The node tree in use of a material, world or light; None where it is shaded without nodes."""
    return None if may_lack_nodes(owner) and not owner.use_nodes else owner.node_tree


def flattened(owner):
    """(Node tree in use of a material, world or light, what must be kept while it is read); None for the tree where it
    is shaded without nodes. Blender from 5.0 on gives it without groups, muted nodes, repetitions and closures; of
    links that go in a circle it makes nothing: then it is the tree as it is."""
    tree = node_tree(owner)
    if tree is None or not hasattr(owner, "inline_shader_nodes"):
        return tree, None
    made = owner.inline_shader_nodes()
    return (made.node_tree, made) if made.node_tree.nodes else (tree, None)


def light_factor(light, matrix):
    """What multiplies a light's energy, (r, g, b): colour, and from 4.5 exposure, temperature and `normalize`.

    A light that is not normalised gives its energy for each unit of its area, as Cycles has it; `matrix` (4, 4) is
    where it stands.
    """
    color = tuple(light.color)
    if not hasattr(light, "normalize"):
        return color
    factor = 2.0**light.exposure
    if not light.normalize:
        factor *= _area(light, matrix)
    if light.use_temperature:
        color = tuple(c * t for c, t in zip(color, light.temperature_color, strict=True))
    return tuple(c * factor for c in color)


def _area(light, matrix):
    """The area by which `normalize` divides; a sun without an angle has none and counts as 1."""
    return light.area(matrix_world=Matrix(matrix)) if light.type != "SUN" or light.angle > 0.0 else 1.0


def has_geometry_sets():
    """Whether the evaluated geometry of an object, instances and all, can be read as a whole (from 4.5 on)."""
    return hasattr(bpy.types.Object, "evaluated_geometry")


def levels_of_random_ids(levels):
    """How many levels of an instance's persistent id its random id is made of, of those that it has."""
    return levels if bpy.app.version >= _RANDOM_BY_LEVELS else max(levels, _LEVELS)
