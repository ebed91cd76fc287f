# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that compute numbers and vectors."""

import operator
from math import pi

from ...engine.expression import (
    Parameter,
    absolute,
    call,
    clamped,
    combine,
    component,
    exp,
    less,
    literal,
    maximum,
    minimum,
    mix,
    select,
    sqrt,
)
from ...engine.glsl_functions import function
from .registry import reads
from .value_functions import TWINS


def of(name, *inputs):
    """What a function of math_lib.glsl or color_lib.glsl makes of inputs, of which it takes the first ones."""
    return call(name, *inputs[: len(function(name).inputs)], fold=TWINS[name])


#: What expressions have operators for: how many inputs it takes, and the operator.
_OPERATORS = {
    "ADD": (2, operator.add),
    "SUBTRACT": (2, operator.sub),
    "MULTIPLY": (2, operator.mul),
    "DIVIDE": (2, operator.truediv),
    "MULTIPLY_ADD": (3, lambda a, b, c: a * b + c),
    "ABSOLUTE": (1, absolute),
    "MINIMUM": (2, minimum),
    "MAXIMUM": (2, maximum),
}
_MATH_OPERATORS = _OPERATORS | {
    "SQRT": (1, sqrt),
    "EXPONENT": (1, exp),
    "LESS_THAN": (2, less),
    "GREATER_THAN": (2, lambda a, b: less(b, a)),
    "SMOOTH_MAX": (3, lambda a, b, width: -of("math_smooth_minimum", -a, -b, width)),
    "RADIANS": (1, lambda a: a * (pi / 180.0)),
    "DEGREES": (1, lambda a: a * (180.0 / pi)),
}
_MATH_FUNCTIONS = {
    "POWER": "math_power",
    "LOGARITHM": "math_logarithm",
    "INVERSE_SQRT": "math_inverse_sqrt",
    "SIGN": "math_sign",
    "COMPARE": "math_compare",
    "SMOOTH_MIN": "math_smooth_minimum",
    "ROUND": "math_round",
    "FLOOR": "math_floor",
    "CEIL": "math_ceil",
    "TRUNC": "math_truncate",
    "FRACT": "math_fraction",
    "MODULO": "math_modulo",
    "FLOORED_MODULO": "math_floored_modulo",
    "WRAP": "math_wrap",
    "SNAP": "math_snap",
    "PINGPONG": "math_ping_pong",
    "SINE": "math_sine",
    "COSINE": "math_cosine",
    "TANGENT": "math_tangent",
    "ARCSINE": "math_arcsine",
    "ARCCOSINE": "math_arccosine",
    "ARCTANGENT": "math_arctangent",
    "ARCTAN2": "math_arctan2",
    "SINH": "math_sinh",
    "COSH": "math_cosh",
    "TANH": "math_tanh",
}
_VECTOR_FUNCTIONS = {
    "CROSS_PRODUCT": "math_cross",
    "PROJECT": "math_project",
    "REFLECT": "math_reflect",
    "FACEFORWARD": "math_faceforward",
    "DOT_PRODUCT": "math_dot",
    "LENGTH": "math_length",
    "NORMALIZE": "math_normalize",
}
#: The Math node's names of what Vector Math calls otherwise.
_BY_COMPONENT = {"FRACTION": "FRACT"}


def by_component(made, *vectors):
    """The vector of what `made` makes of the components of vectors."""
    return combine(*(made(*(component(vector, i) for vector in vectors)) for i in range(3)))


@reads("MATH")
def math(n):
    operation = n.node.operation
    if operation in _MATH_OPERATORS:
        count, made = _MATH_OPERATORS[operation]
        result = made(*(n.number(i) for i in range(count)))
    elif operation in _MATH_FUNCTIONS:
        name = _MATH_FUNCTIONS[operation]
        result = of(name, *(n.number(i) for i in range(len(function(name).inputs))))
    else:
        n.instead("its first input")
        result = n.number(0)
    return clamped(result) if n.node.use_clamp else result


def _vector_math(n, operation):
    """What an operation makes of vectors; None where it is not known."""
    if operation in _OPERATORS:
        count, made = _OPERATORS[operation]
        return made(*(n.vector(i) for i in range(count)))
    if operation in _VECTOR_FUNCTIONS:
        name = _VECTOR_FUNCTIONS[operation]
        return of(name, *(n.vector(i) for i in range(len(function(name).inputs))))
    name = _MATH_FUNCTIONS.get(_BY_COMPONENT.get(operation, operation))
    if name is None:
        return None
    vectors = (n.vector(i) for i in range(len(function(name).inputs)))
    return by_component(lambda *numbers: of(name, *numbers), *vectors)


@reads("VECT_MATH")
def vector_math(n):
    operation = n.node.operation
    if operation == "SCALE":
        return n.vector(0) * n.number("Scale")
    if operation == "DISTANCE":
        return of("math_length", n.vector(0) - n.vector(1))
    if operation == "REFRACT":
        return of("math_refract", n.vector(0), n.vector(1), n.number("Scale"))
    result = _vector_math(n, operation)
    if result is None:
        n.instead("its first input")
        return n.vector(0)
    return result


@reads("VALUE")
def value(n):
    return Parameter(n.source.output.default_value)


def _limited(x, low, high):
    """x between two limits in any order."""
    return minimum(maximum(x, minimum(low, high)), maximum(low, high))


@reads("CLAMP")
def clamp(n):
    x, low, high = (n.number(name) for name in ("Value", "Min", "Max"))
    return _limited(x, low, high) if n.node.clamp_type == "RANGE" else minimum(maximum(x, low), high)


_RANGES = {
    "LINEAR": "math_range_linear",
    "STEPPED": "math_range_stepped",
    "SMOOTHSTEP": "math_range_smooth",
    "SMOOTHERSTEP": "math_range_smoother",
}


@reads("MAP_RANGE")
def map_range(n):
    name, is_number = _RANGES[n.node.interpolation_type], n.node.data_type == "FLOAT"
    read = n.number if is_number else n.vector
    x = read("Value" if is_number else "Vector")
    low, high, to_low, to_high, steps = (read(i) for i in ("From Min", "From Max", "To Min", "To Max", "Steps"))
    if is_number:
        mapped = mix(to_low, to_high, of(name, x, low, high, steps))
        mapped = select(maximum(less(low, high), less(high, low)), mapped, 0.0)
    else:
        mapped = to_low + (to_high - to_low) * by_component(lambda *numbers: of(name, *numbers), x, low, high, steps)
    return _limited(mapped, to_low, to_high) if n.node.clamp else mapped


def _turned(vector, angles, back=False):
    """A vector turned by Euler angles, or turned back."""
    x, y, z = (of(f"math_turned_{axis}", angles) for axis in "xyz")
    if back:
        return combine(*(of("math_dot", axis, vector) for axis in (x, y, z)))
    return x * component(vector, 0) + y * component(vector, 1) + z * component(vector, 2)


_AXES = {"X_AXIS": (1.0, 0.0, 0.0), "Y_AXIS": (0.0, 1.0, 0.0), "Z_AXIS": (0.0, 0.0, 1.0)}


@reads("VECTOR_ROTATE")
def vector_rotate(n):
    kind, back = n.node.rotation_type, n.node.invert
    center = n.vector("Center")
    offset = n.vector("Vector") - center
    if kind == "EULER_XYZ":
        return _turned(offset, n.vector("Rotation"), back) + center
    axis = literal(_AXES[kind]) if kind in _AXES else n.vector("Axis")
    angle = n.number("Angle")
    return of("math_rotate", offset, axis, -angle if back else angle) + center


@reads("MAPPING")
def mapping(n):
    kind, vector = n.node.vector_type, n.vector("Vector")
    angles, scale = n.vector("Rotation"), n.vector("Scale")
    if kind == "POINT":
        return _turned(vector * scale, angles) + n.vector("Location")
    if kind == "TEXTURE":
        return _turned(vector - n.vector("Location"), angles, back=True) / scale
    if kind == "VECTOR":
        return _turned(vector * scale, angles)
    return of("math_normalize", _turned(vector / scale, angles))
