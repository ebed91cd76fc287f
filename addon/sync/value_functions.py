# SPDX-License-Identifier: GPL-3.0-or-later
"""What the value nodes of a shader compute, as Cycles computes it.

Numbers are arrays (..., 1), colours and vectors (..., 3), and what a function takes broadcasts. What comes out may be
NaN or infinite where Cycles has something of its own: the caller makes that 0.
"""

import numpy as np

from .values import LUMINANCE

_EPSILON = np.finfo(np.float32).eps


def as_number(is_color, x):
    """What Blender makes of a colour or vector (..., 3) that is linked to a number."""
    return (colors(x) @ LUMINANCE.astype(x.dtype))[..., None] if is_color else x.mean(axis=-1, keepdims=True)


def component(i, x):
    """Number `i` of a colour or vector."""
    return colors(x)[..., i : i + 1]


def combine(x, y, z):
    return np.concatenate(np.broadcast_arrays(x, y, z), axis=-1)


def colors(x):
    """Numbers or colours as colours (..., 3)."""
    return np.broadcast_to(x, (*x.shape[:-1], 3))


def mix(a, b, t):
    return a + (b - a) * t


def divided(a, b):
    """a / b, 0 where b is."""
    return np.where(b != 0.0, a / np.where(b != 0.0, b, 1.0), 0.0)


def clamped(x):
    return np.clip(x, 0.0, 1.0)


def limited(swaps, x, low, high):
    """x between two limits; with `swaps` in any order."""
    if swaps:
        low, high = np.minimum(low, high), np.maximum(low, high)
    return np.minimum(np.maximum(x, low), high)


def _power(a, b):
    return np.where((a < 0.0) & (b != np.floor(b)), 0.0, np.power(a, b))


def _logarithm(a, b):
    good = (a > 0.0) & (b > 0.0)
    return np.where(good, divided(np.log(np.where(good, a, 1.0)), np.log(np.where(good, b, 1.0))), 0.0)


def _modulo(a, b):
    return np.where(b != 0.0, np.fmod(a, np.where(b != 0.0, b, 1.0)), 0.0)


def _floored_modulo(a, b):
    return np.where(b != 0.0, a - np.floor(divided(a, b)) * b, 0.0)


def _wrap(a, high, low):
    width = high - low
    return np.where(width != 0.0, a - width * np.floor(divided(a - low, width)), low)


def _ping_pong(a, b):
    fraction = divided(a - b, 2.0 * b)
    return np.where(b != 0.0, np.abs((fraction - np.floor(fraction)) * b * 2.0 - b), 0.0)


def _smooth_minimum(a, b, width):
    h = divided(np.maximum(width - np.abs(a - b), 0.0), width)
    return np.minimum(a, b) - h**3 * width / 6.0


def _of_one(function):
    return lambda a, *_: function(a)


def _of_two(function):
    return lambda a, b, *_: function(a, b)


#: By the operation of the Math node; each takes all three inputs.
MATH = {
    "ADD": _of_two(np.add),
    "SUBTRACT": _of_two(np.subtract),
    "MULTIPLY": _of_two(np.multiply),
    "DIVIDE": _of_two(divided),
    "MULTIPLY_ADD": lambda a, b, c: a * b + c,
    "POWER": _of_two(_power),
    "LOGARITHM": _of_two(_logarithm),
    "SQRT": _of_one(lambda a: np.sqrt(np.maximum(a, 0.0))),
    "INVERSE_SQRT": _of_one(lambda a: np.where(a > 0.0, 1.0 / np.sqrt(np.where(a > 0.0, a, 1.0)), 0.0)),
    "ABSOLUTE": _of_one(np.abs),
    "EXPONENT": _of_one(np.exp),
    "MINIMUM": _of_two(np.minimum),
    "MAXIMUM": _of_two(np.maximum),
    "LESS_THAN": _of_two(lambda a, b: (a < b) * 1.0),
    "GREATER_THAN": _of_two(lambda a, b: (a > b) * 1.0),
    "SIGN": _of_one(np.sign),
    "COMPARE": lambda a, b, c: (np.abs(a - b) <= np.maximum(c, _EPSILON)) * 1.0,
    "SMOOTH_MIN": _smooth_minimum,
    "SMOOTH_MAX": lambda a, b, c: -_smooth_minimum(-a, -b, c),
    "ROUND": _of_one(lambda a: np.floor(a + 0.5)),
    "FLOOR": _of_one(np.floor),
    "CEIL": _of_one(np.ceil),
    "TRUNC": _of_one(np.trunc),
    "FRACT": _of_one(lambda a: a - np.floor(a)),
    "MODULO": _of_two(_modulo),
    "FLOORED_MODULO": _of_two(_floored_modulo),
    "WRAP": _wrap,
    "SNAP": _of_two(lambda a, b: np.floor(divided(a, b)) * b),
    "PINGPONG": _of_two(_ping_pong),
    "SINE": _of_one(np.sin),
    "COSINE": _of_one(np.cos),
    "TANGENT": _of_one(np.tan),
    "ARCSINE": _of_one(lambda a: np.arcsin(np.clip(a, -1.0, 1.0))),
    "ARCCOSINE": _of_one(lambda a: np.arccos(np.clip(a, -1.0, 1.0))),
    "ARCTANGENT": _of_one(np.arctan),
    "ARCTAN2": _of_two(np.arctan2),
    "SINH": _of_one(np.sinh),
    "COSH": _of_one(np.cosh),
    "TANH": _of_one(np.tanh),
    "RADIANS": _of_one(np.radians),
    "DEGREES": _of_one(np.degrees),
}


def math(operation, a, b, c):
    return MATH[operation](a, b, c)


def _dot(a, b):
    return (a * b).sum(axis=-1, keepdims=True)


def _length(a):
    return np.sqrt(_dot(a, a))


def _unit(a):
    return divided(a, _length(a))


def _reflect(a, b, *_):
    normal = _unit(b)
    return a - 2.0 * normal * _dot(a, normal)


def _refract(a, b, c, eta):
    normal = _unit(b)
    cosine = _dot(normal, a)
    k = 1.0 - eta * eta * (1.0 - cosine * cosine)
    return np.where(k < 0.0, 0.0, eta * a - (eta * cosine + np.sqrt(np.maximum(k, 0.0))) * normal)


def _of_components(operation):
    return lambda a, b, c, scale: MATH[operation](a, b, c)


_BY_COMPONENT = (
    *("ADD", "SUBTRACT", "MULTIPLY", "DIVIDE", "MULTIPLY_ADD", "POWER", "ABSOLUTE", "SIGN", "MINIMUM", "MAXIMUM"),
    *("FLOOR", "CEIL", "ROUND", "MODULO", "WRAP", "SNAP", "SINE", "COSINE", "TANGENT"),
)
#: By the operation of the Vector Math node; each takes three vectors and the scale.
VECTOR_MATH = {
    **{name: _of_components(name) for name in _BY_COMPONENT},
    "FRACTION": _of_components("FRACT"),
    "CROSS_PRODUCT": _of_two(np.cross),
    "PROJECT": _of_two(lambda a, b: divided(_dot(a, b), _dot(b, b)) * b),
    "REFLECT": _reflect,
    "REFRACT": _refract,
    "FACEFORWARD": lambda a, b, c, scale: np.where(_dot(b, c) < 0.0, a, -a),
    "DOT_PRODUCT": _of_two(_dot),
    "DISTANCE": _of_two(lambda a, b: _length(a - b)),
    "LENGTH": _of_one(_length),
    "SCALE": lambda a, b, c, scale: a * scale,
    "NORMALIZE": _of_one(_unit),
}


def vector_math(operation, a, b, c, scale):
    return VECTOR_MATH[operation](colors(a), colors(b), colors(c), scale)


def _screen(a, b):
    return 1.0 - (1.0 - b) * (1.0 - a)


def _overlay(a, b, t):
    dark = a * (1.0 - t + 2.0 * t * b)
    return np.where(a < 0.5, dark, 1.0 - (1.0 - t + 2.0 * t * (1.0 - b)) * (1.0 - a))


#: By the blend type of the Mix node: a and b by the factor t.
BLENDS = {
    "MIX": mix,
    "ADD": lambda a, b, t: a + b * t,
    "SUBTRACT": lambda a, b, t: a - b * t,
    "MULTIPLY": lambda a, b, t: mix(a, a * b, t),
    "DIVIDE": lambda a, b, t: np.where(b != 0.0, mix(a, divided(a, b), t), a),
    "SCREEN": lambda a, b, t: mix(a, _screen(a, b), t),
    "OVERLAY": _overlay,
    "SOFT_LIGHT": lambda a, b, t: mix(a, (1.0 - a) * b * a + a * _screen(a, b), t),
    "LINEAR_LIGHT": lambda a, b, t: a + t * (2.0 * b - 1.0),
    "DIFFERENCE": lambda a, b, t: mix(a, np.abs(a - b), t),
    "EXCLUSION": lambda a, b, t: np.maximum(mix(a, a + b - 2.0 * a * b, t), 0.0),
    "DARKEN": lambda a, b, t: mix(a, np.minimum(a, b), t),
    "LIGHTEN": lambda a, b, t: mix(a, np.maximum(a, b), t),
}


def blend(kind, t, a, b):
    return BLENDS[kind](a, b, t)


def map_range(kind, is_number, x, from_low, from_high, to_low, to_high, steps):
    width = from_high - from_low
    t = divided(x - from_low, width)
    if kind == "STEPPED":
        t = divided(np.floor(t * (steps + 1.0)), steps) * (steps > 0.0)
    elif kind != "LINEAR":
        t = clamped(t)
        t = t * t * (3.0 - 2.0 * t) if kind == "SMOOTHSTEP" else t**3 * (t * (6.0 * t - 15.0) + 10.0)
    mapped = mix(to_low, to_high, t)
    return np.where(width != 0.0, mapped, 0.0) if is_number else mapped


def ramp(table, x):
    """A colour of a table of (r, g, b) at even steps from 0 to 1, in between linear."""
    columns = np.array(table, np.float32).T
    at = clamped(x[..., 0]) * (columns.shape[1] - 1)
    return np.stack([np.interp(at, np.arange(columns.shape[1]), column) for column in columns], axis=-1)


def steps(places, table, x):
    """A colour of a table of (r, g, b): that of the last of the `places` up to x, of the first below them."""
    row = np.searchsorted(np.array(places, np.float32), x[..., 0], side="right") - 1
    return np.array(table, np.float32)[np.maximum(row, 0)]


def invert(factor, color):
    return mix(color, 1.0 - color, factor)


def gamma(color, exponent):
    return np.where(color > 0.0, np.power(np.maximum(color, 0.0), exponent), color)


def bright_contrast(color, bright, contrast):
    return np.maximum((1.0 + contrast) * color + (bright - 0.5 * contrast), 0.0)


def hue_saturation(hue, saturation, value, factor, color):
    h, s, v = (component(i, to_hsv(color)) for i in range(3))
    h = h + hue + 0.5
    changed = from_hsv(combine(h - np.floor(h), clamped(s * saturation), v * value))
    return np.maximum(mix(color, changed, factor), 0.0)


def _hue(color, high, spread):
    """The hue of colours (..., 3), 0 to 1, of their highest channel and what the lowest is below it."""
    r, g, b = ((high - color[..., i]) / np.where(spread > 0.0, spread, 1.0) for i in range(3))
    red, green = color[..., 0] == high, color[..., 1] == high
    hue = np.where(red, b - g, np.where(green, 2.0 + r - b, 4.0 + g - r)) / 6.0
    return np.where(spread > 0.0, hue - np.floor(hue), 0.0)


def to_hsv(color):
    color = colors(color)
    high = color.max(axis=-1)
    spread = high - color.min(axis=-1)
    saturation = np.where(high != 0.0, divided(spread, high), 0.0)
    return np.stack([np.where(saturation != 0.0, _hue(color, high, spread), 0.0), saturation, high], axis=-1)


def _pure(hue):
    """The colours (..., 3) of full saturation and value of a hue."""
    return clamped(
        np.stack([np.abs(hue * 6.0 - 3.0) - 1.0, 2.0 - np.abs(hue * 6.0 - 2.0), 2.0 - np.abs(hue * 6.0 - 4.0)], axis=-1)
    )


def from_hsv(color):
    h, s, v = (color[..., i] for i in range(3))
    return ((_pure(h - np.floor(h)) - 1.0) * s[..., None] + 1.0) * v[..., None]


def to_hsl(color):
    color = colors(color)
    high, low = color.max(axis=-1), color.min(axis=-1)
    light = np.minimum(1.0, (high + low) / 2.0)
    spread = high - low
    saturation = np.where(light > 0.5, divided(spread, 2.0 - high - low), divided(spread, high + low))
    return np.stack([_hue(color, high, spread), saturation, light], axis=-1)


def from_hsl(color):
    h, s, light = (color[..., i] for i in range(3))
    chroma = (1.0 - np.abs(2.0 * light - 1.0)) * s
    return (_pure(h) - 0.5) * chroma[..., None] + light[..., None]


#: By the mode of Separate and Combine Color: from and to RGB.
MODES = {"RGB": (colors, colors), "HSV": (to_hsv, from_hsv), "HSL": (to_hsl, from_hsl)}


def separate(mode, i, color):
    return component(i, MODES[mode][0](color))


def combined(mode, x, y, z):
    return MODES[mode][1](combine(x, y, z))
