# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that make normals: of heights, of the colors of a map, and a direction of one's own."""

from ...engine.expression import Parameter, beside, call
from .coordinates import normal_input, object_space, own_uv
from .registry import reads

#: Filter width in pixels from which on differences are over a whole pixel, as old files have it, not a tenth; and up to
#: which that is said to be the same.
_WIDE, _WIDEST = 0.4, 2.0


@reads("NORMAL")
def normal_node(n):
    direction = call("coordinate_unit", Parameter(tuple(n.node.outputs["Normal"].default_value)))
    given = call("coordinate_unit", n.vector("Normal"))
    return {"Normal": direction, "Dot": call("input_dot", direction, given)}


@reads("BUMP")
def bump(n):
    normal = normal_input(n)
    if not n.linked("Height"):
        return normal
    height, distance, wide = n.number("Height"), n.number("Distance"), _is_wide(n)
    axes = (3, 4) if wide else (1, 2)
    distance = -distance if n.node.invert else distance
    heights = (height, *(beside(height, axis) for axis in axes))
    return call("bump_normal", normal, *heights, n.number("Strength"), distance, wide)


def _is_wide(n):
    """Whether differences are over a whole pixel: a filter width that crosses the border makes another program."""
    if not n.has("Filter Width"):
        return True
    width = n.constant("Filter Width")
    if width is None or width > _WIDEST:
        n.warn("its filter width is not rendered, one pixel is used instead")
    return width is None or width > _WIDE


@reads("NORMAL_MAP")
def normal_map(n):
    color, strength, space = n.color("Color"), n.number("Strength"), n.node.space
    if getattr(n.node, "convention", "OPENGL") == "DIRECTX":
        color = color * (1.0, -1.0, 1.0) + (0.0, 1.0, 0.0)
    if space == "TANGENT":
        own_uv(n, n.node.uv_map)
        return call("bump_tangent_map", color, strength)
    told = color * 2.0 - 1.0
    if space.startswith("BLENDER"):  # maps of Blender's own old renderer
        told = told * (1.0, -1.0, -1.0)
    if space.endswith("OBJECT"):
        told = call("coordinate_normal_from_space", told, *object_space())
    else:
        told = call("coordinate_unit", told)
    return call("bump_mixed", told, strength)


@reads("BEVEL")
def bevel(n):
    n.instead("its normal without bevel")
    return normal_input(n)
