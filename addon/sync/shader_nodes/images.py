# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures: Image Texture, Environment Texture, Sky Texture."""

from ...engine.expression import Parameter, call, calls, component, expression
from ..images import MISSING
from ..skies import sky
from .coordinates import normal, object_space, texture_vector
from .registry import reads

_MISSING = Parameter((*MISSING, 1.0))


def _picture(n, divided=False):
    """The `Picture` of a node; None where it is missing."""
    return n.images.picture(n.node, n.warn, divided=divided)


def _color(picture, uv):
    return _MISSING if picture is None else picture.color(uv)


@reads("TEX_IMAGE")
def image_texture(n):
    vector = texture_vector(n, "uv")  # also where no picture is wanted: it says which uv map is in use
    if n.images is None:
        return _outputs(expression((1.0, 1.0, 1.0, 1.0)))
    picture = _picture(n, divided=n.node.outputs["Alpha"].is_linked)
    projection = n.node.projection
    if projection == "BOX":
        return _outputs(_on_box(n, picture, vector))
    if projection in ("SPHERE", "TUBE"):
        vector = call(f"projection_{projection.lower()}", vector)
    return _outputs(_color(picture, vector))


def _outputs(color):
    return {"Color": color, "Alpha": component(color, 3)}


def _on_box(n, picture, vector):
    across = normal() if n.in_world else call("coordinate_normal_to_space", normal(), *object_space())
    shares = call("projection_box", across, Parameter(n.node.projection_blend))
    sides = calls("projection_box_sides", vector, across)
    return sum(component(shares, i) * _color(picture, uv) for i, uv in enumerate(sides))


@reads("TEX_ENVIRONMENT")
def environment_texture(n):
    if n.images is None:
        return expression((1.0, 1.0, 1.0))
    if n.linked("Vector"):
        vector = n.vector("Vector")
    else:
        vector = call("point_position") if n.in_world else call("coordinate_world")
    ball = n.node.projection == "MIRROR_BALL"
    return _color(_picture(n), call("projection_mirror_ball" if ball else "panorama_uv", vector))


@reads("TEX_SKY")
def sky_texture(n):
    if n.images is None:
        return expression((1.0, 1.0, 1.0))
    return sky(n.node, texture_vector(n), n.images, n.warn)
