# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender's world lights, and which rays see it: Cycles' settings of it, where that is there."""

from dataclasses import replace

from ..engine.visibility import Visibility

#: Texels around the horizon of a disc of a sun in a sky.
_SUN_DETAIL = 2048
_RAYS = {
    "camera": Visibility.CAMERA,
    "glossy": Visibility.GLOSSY,
    "transmission": Visibility.TRANSMISSION,
}


def with_light(read, world, images):
    """The engine's World `read` as the light that Blender's world is; `images`: the engine's of the world alone."""
    if world is None:
        return read
    rays, settings = getattr(world, "cycles_visibility", None), getattr(world, "cycles", None)
    visibility = Visibility.ALL
    for name, ray in _RAYS.items():
        if not getattr(rays, name, True):
            visibility &= ~ray
    return replace(
        read,
        lights=getattr(rays, "diffuse", True),
        visibility=visibility,
        detail=_detail(world, settings, images),
    )


def _detail(world, settings, images):
    """How many texels around the horizon the world's finest parts need."""
    if getattr(settings, "sampling_method", "AUTOMATIC") == "MANUAL":
        return settings.sample_map_resolution
    widths = [image.pixels.shape[1] for image in images]
    if world.node_tree and any(n.type == "TEX_SKY" and getattr(n, "sun_disc", False) for n in world.node_tree.nodes):
        widths.append(_SUN_DETAIL)
    return max(widths, default=0)
