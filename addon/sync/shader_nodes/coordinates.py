# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that tell a place or a direction: texture coordinates, uv maps, geometry, camera, changes of space."""

from functools import cache

import numpy as np

from ...engine.expression import Parameter, call, component
from ..attributes import key_of
from ..spaces import space_rows
from .registry import attribute_color, reads

_AXES = {"X": 0, "Y": 1, "Z": 2}


@cache
def attribute(key):
    """The colour of an attribute: one Expression a key, so that a program looks it up once."""
    return attribute_color(key)


@cache
def object_space():
    """The space, see `coordinate_nodes_lib.glsl`, of the object that is shaded: three vec4."""
    return tuple(attribute(key_of("object", f"space_{axis}")) for axis in "xyz")


def space_of(obj):
    """The space of another object; moving it compiles nothing."""
    return tuple(map(Parameter, space_rows(np.array(obj.matrix_world, np.float64)[None])[0]))


def normal():
    return call("point_normal")


def normal_input(n, *names):
    """An input for a normal; the surface's own where nothing feeds it."""
    return n.vector(*(names or ("Normal",))) if n.linked(*(names or ("Normal",))) else normal()


def generated(n):
    """The place within the object's box, 0 to 1, as Blender measures it before the object is deformed."""
    if n.in_world:
        return call("point_position")
    scale, offset = (attribute(key_of("generated", name)) for name in ("scale", "offset"))
    return call("coordinate_in_box", call("coordinate_in_space", *object_space()), scale, offset)


def texture_vector(n, default="generated"):
    """The input "Vector" of a texture; where nothing feeds it the coordinates that Blender takes: generated, or with
    `default` "uv" the active uv map."""
    if n.linked("Vector"):
        return n.vector("Vector")
    return n.uv() if default == "uv" and not n.in_world else generated(n)


def _of_instancer(n):
    if n.node.from_instancer:
        n.warn("coordinates from the instancer are not rendered; those of the instance itself are used instead")


def _generated(n):
    _of_instancer(n)
    return generated(n)


def _normal(n):
    return normal() if n.in_world else call("coordinate_normal_to_space", normal(), *object_space())


def _uv(n):
    _of_instancer(n)
    return Parameter((0.0, 0.0, 0.0)) if n.in_world else n.uv()


def _object(n):
    other = n.node.object
    if n.in_world:
        direction = call("point_position")
        return direction if other is None else call("coordinate_to_space", direction, *space_of(other))
    return call("coordinate_in_space", *(object_space() if other is None else space_of(other)))


def _camera(n):
    return call("coordinate_vector_to_camera", call("point_position")) if n.in_world else call("coordinate_camera")


def _window(n):
    return call("coordinate_sky_window") if n.in_world else call("coordinate_window", call("coordinate_camera"))


def _reflection(n):
    return call("point_incoming") if n.in_world else call("coordinate_reflection")


_COORDINATES = {
    "Generated": _generated,
    "Normal": _normal,
    "UV": _uv,
    "Object": _object,
    "Camera": _camera,
    "Window": _window,
    "Reflection": _reflection,
}


@reads("TEX_COORD")
def texture_coordinate(n):
    return _COORDINATES[n.output](n)


@reads("UVMAP")
def uv_map(n):
    _of_instancer(n)
    return Parameter((0.0, 0.0, 0.0)) if n.in_world else n.uv(n.node.uv_map)


def radial_tangent(n, axis):
    """The direction around an axis of the object's box, along the surface."""
    around = call("coordinate_radial", generated(n), axis)
    return call("coordinate_along", call("coordinate_normal_from_space", around, *object_space()))


def _position(n):
    return call("point_position") if n.in_world else call("coordinate_world")


def _pointiness(n):
    n.instead("the pointiness 0.5")
    return Parameter(0.5)


_GEOMETRY = {
    "Position": _position,
    "Normal": lambda n: normal(),
    "Tangent": lambda n: Parameter((0.0, 0.0, 0.0)) if n.in_world else radial_tangent(n, _AXES["Z"]),
    "True Normal": lambda n: call("input_true_normal"),
    "Incoming": lambda n: call("point_incoming"),
    "Parametric": lambda n: call("coordinate_parametric"),
    "Backfacing": lambda n: call("input_backfacing"),
    "Pointiness": _pointiness,
    "Random Per Island": lambda n: component(attribute(key_of("island")), 0),
}


@reads("NEW_GEOMETRY")
def geometry(n):
    return _GEOMETRY[n.output](n)


@reads("CAMERA")
def camera_data(n):
    if n.in_world:
        place = call("coordinate_to_camera", call("point_position"))
    else:
        place = call("coordinate_camera")
    return {
        "View Vector": call("coordinate_unit", place),
        "View Z Depth": component(place, 2),
        "View Distance": call("coordinate_length", place),
    }


@reads("TANGENT")
def tangent(n):
    if n.in_world:
        return Parameter((0.0, 0.0, 0.0))
    if n.node.direction_type == "RADIAL":
        return radial_tangent(n, _AXES[n.node.axis])
    own_uv(n, n.node.uv_map)
    return call("bump_tangent")


def own_uv(n, name):
    """Take a uv map as that of the surface's tangent, which has that of its own uv alone."""
    n.uv(name)
    if n.reader.uv_map != name:
        n.instead(f"the tangent of the uv map {n.reader.uv_map!r}")


#: By what is moved: functions to a space, from it, to the camera, from it.
_TRANSFORMS = {
    "POINT": ("coordinate_to_space", "coordinate_from_space", "coordinate_to_camera", "coordinate_from_camera"),
    "VECTOR": (
        "coordinate_vector_to_space",
        "coordinate_vector_from_space",
        "coordinate_vector_to_camera",
        "coordinate_vector_from_camera",
    ),
    "NORMAL": (
        "coordinate_normal_to_space",
        "coordinate_normal_from_space",
        "coordinate_vector_to_camera",
        "coordinate_vector_from_camera",
    ),
}


@reads("VECT_TRANSFORM")
def vector_transform(n):
    node, vector = n.node, n.vector("Vector")
    to_space, from_space, to_camera, from_camera = _TRANSFORMS[node.vector_type]
    if node.convert_from == node.convert_to:
        return vector
    if node.convert_from == "OBJECT" and not n.in_world:
        vector = call(from_space, vector, *object_space())
    elif node.convert_from == "CAMERA":
        vector = call(from_camera, vector)
    if node.convert_to == "OBJECT" and not n.in_world:
        vector = call(to_space, vector, *object_space())
    elif node.convert_to == "CAMERA":
        vector = call(to_camera, vector)
    return call("coordinate_unit", vector) if node.vector_type == "NORMAL" else vector
