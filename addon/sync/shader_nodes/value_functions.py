# SPDX-License-Identifier: GPL-3.0-or-later
"""Numpy twins of the functions of math_lib.glsl and color_lib.glsl, for nodes whose inputs are all constants.

Numbers are arrays (..., 1), colors and vectors (..., 3), and what a function takes broadcasts.
"""

import numpy as np

_EPSILON = np.finfo(np.float32).eps


def divide(a, b):
    """a / b, 0 where b is."""
    return np.where(b != 0.0, a / np.where(b != 0.0, b, 1.0), 0.0)


def mix(a, b, t):
    return a + (b - a) * t


def _power(a, b):
    defined = (a != 0.0) & ((a > 0.0) | (b == np.floor(b)))
    return np.where(b == 0.0, 1.0, np.where(defined, np.power(np.where(defined, a, 1.0), b), 0.0))


def _logarithm(a, b):
    good = (a > 0.0) & (b > 0.0)
    return np.where(good, divide(np.log(np.where(good, a, 1.0)), np.log(np.where(good, b, 1.0))), 0.0)


def _inverse_sqrt(a):
    return np.where(a > 0.0, 1.0 / np.sqrt(np.where(a > 0.0, a, 1.0)), 0.0)


def _fraction(a):
    return a - np.floor(a)


def _modulo(a, b):
    return np.where(b != 0.0, np.fmod(a, np.where(b != 0.0, b, 1.0)), 0.0)


def _floored_modulo(a, b):
    return np.where(b != 0.0, a - np.floor(divide(a, b)) * b, 0.0)


def _wrap(a, high, low):
    width = high - low
    return np.where(width != 0.0, a - width * np.floor(divide(a - low, width)), low)


def _ping_pong(a, b):
    return np.where(b != 0.0, np.abs(_fraction(divide(a - b, 2.0 * b)) * b * 2.0 - b), 0.0)


def _smooth_minimum(a, b, width):
    h = divide(np.maximum(width - np.abs(a - b), 0.0), width)
    return np.minimum(a, b) - h**3 * width / 6.0


#: By the name of the GLSL function, which takes the same.
MATH = {
    "math_divide": divide,
    "math_power": _power,
    "math_logarithm": _logarithm,
    "math_inverse_sqrt": _inverse_sqrt,
    "math_sign": np.sign,
    "math_compare": lambda a, b, c: (np.abs(a - b) <= np.maximum(c, _EPSILON)) * 1.0,
    "math_smooth_minimum": _smooth_minimum,
    "math_round": lambda a: np.floor(a + 0.5),
    "math_floor": np.floor,
    "math_ceil": np.ceil,
    "math_truncate": np.trunc,
    "math_fraction": _fraction,
    "math_modulo": _modulo,
    "math_floored_modulo": _floored_modulo,
    "math_wrap": _wrap,
    "math_snap": lambda a, b: np.floor(divide(a, b)) * b,
    "math_ping_pong": _ping_pong,
    "math_sine": np.sin,
    "math_cosine": np.cos,
    "math_tangent": np.tan,
    "math_arcsine": lambda a: np.arcsin(np.clip(a, -1.0, 1.0)),
    "math_arccosine": lambda a: np.arccos(np.clip(a, -1.0, 1.0)),
    "math_arctangent": np.arctan,
    "math_arctan2": np.arctan2,
    "math_sinh": np.sinh,
    "math_cosh": np.cosh,
    "math_tanh": np.tanh,
}


def dot(a, b):
    return (a * b).sum(axis=-1, keepdims=True)


def _length(a):
    return np.sqrt(dot(a, a))


def normalize(a):
    return divide(a, _length(a))


def _reflect(a, b):
    normal = normalize(b)
    return a - 2.0 * normal * dot(a, normal)


def _refract(a, b, eta):
    normal = normalize(b)
    cosine = dot(normal, a)
    k = 1.0 - eta * eta * (1.0 - cosine * cosine)
    return np.where(k < 0.0, 0.0, eta * a - (eta * cosine + np.sqrt(np.maximum(k, 0.0))) * normal)


def _rotate(v, axis, angle):
    unit = normalize(axis)
    turned = v * np.cos(angle) + np.cross(unit, v) * np.sin(angle) + unit * dot(unit, v) * (1.0 - np.cos(angle))
    return np.where(_length(axis) != 0.0, turned, v)


def _turned(axis):
    """The image of an axis under a rotation by Euler angles, as three rotations one after the other."""

    def function(angles):
        made = np.eye(3)[axis]
        for i in range(3):
            made = _rotate(made, np.eye(3)[i], angles[..., i : i + 1])
        return made

    return function


def _range(bent):
    def function(x, low, high):
        t = np.clip(divide(x - low, high - low), 0.0, 1.0)
        return bent(t)

    return function


def _stepped(x, low, high, steps):
    return divide(np.floor(divide(x - low, high - low) * (steps + 1.0)), steps) * (steps > 0.0)


#: As `MATH`.
VECTORS = {
    "math_dot": dot,
    "math_length": _length,
    "math_normalize": normalize,
    "math_cross": np.cross,
    "math_project": lambda a, b: divide(dot(a, b), dot(b, b)) * b,
    "math_reflect": _reflect,
    "math_refract": _refract,
    "math_faceforward": lambda a, incident, reference: np.where(dot(reference, incident) < 0.0, a, -a),
    "math_turned_x": _turned(0),
    "math_turned_y": _turned(1),
    "math_turned_z": _turned(2),
    "math_rotate": _rotate,
    "math_range_linear": lambda x, low, high: divide(x - low, high - low),
    "math_range_stepped": _stepped,
    "math_range_smooth": _range(lambda t: t * t * (3.0 - 2.0 * t)),
    "math_range_smoother": _range(lambda t: t**3 * (t * (6.0 * t - 15.0) + 10.0)),
}


def _channel(color, i):
    return color[..., i : i + 1]


def _hue(color, high, spread):
    """The hue (..., 1), 0 to 1, of colors, their highest channel and what the lowest is below it."""
    r, g, b = (divide(high - _channel(color, i), spread) for i in range(3))
    red, green = (_channel(color, i) == high for i in range(2))
    hue = np.where(red, b - g, np.where(green, 2.0 + r - b, 4.0 + g - r)) / 6.0
    return np.where(spread > 0.0, _fraction(hue), 0.0)


def _range_of(color):
    return color.max(axis=-1, keepdims=True), color.min(axis=-1, keepdims=True)


def to_hsv(color):
    high, low = _range_of(color)
    saturation = divide(high - low, high)
    hue = np.where(saturation != 0.0, _hue(color, high, high - low), 0.0)
    return np.concatenate([hue, saturation, high], axis=-1)


def from_hsv(hsv):
    """As Smith (1978) has it, with hues beyond 0 to 1 in the last sixth."""
    hue, s, v = (hsv[..., i] for i in range(3))
    hue = np.where(hue == 1.0, 0.0, hue) * 6.0
    sector = np.floor(hue)
    p, q, t = v * (1.0 - s), v * (1.0 - s * (hue - sector)), v * (1.0 - s * (1.0 - hue + sector))
    sixths = [(v, t, p), (q, v, p), (p, v, t), (p, q, v), (t, p, v), (v, p, q)]
    number = np.where((sector < 0.0) | (sector > 5.0), 5, sector).astype(int)
    return np.stack([np.choose(number, channel) for channel in zip(*sixths, strict=True)], axis=-1)


def to_hsl(color):
    high, low = _range_of(color)
    lightness = np.minimum(1.0, (high + low) / 2.0)
    saturation = divide(high - low, np.where(lightness > 0.5, 2.0 - high - low, high + low))
    return np.concatenate([_hue(color, high, high - low), saturation, lightness], axis=-1)


def from_hsl(hsl):
    hue, saturation, lightness = (_channel(hsl, i) for i in range(3))
    pure = np.abs(hue * 6.0 - np.array((3.0, 2.0, 4.0))) * (1.0, -1.0, -1.0) + (-1.0, 2.0, 2.0)
    return (np.clip(pure, 0.0, 1.0) - 0.5) * (1.0 - np.abs(2.0 * lightness - 1.0)) * saturation + lightness


def _screen(a, b):
    return 1.0 - (1.0 - b) * (1.0 - a)


def _overlay(t, a, b):
    return np.where(a < 0.5, a * (1.0 - t + 2.0 * t * b), 1.0 - (1.0 - t + 2.0 * t * (1.0 - b)) * (1.0 - a))


def _dodge(t, a, b):
    left = 1.0 - t * b
    return np.where(a != 0.0, np.where(left > 0.0, np.minimum(divide(a, left), 1.0), 1.0), a)


def _burn(t, a, b):
    left = 1.0 - t + t * b
    return np.where(left > 0.0, np.clip(1.0 - divide(1.0 - a, left), 0.0, 1.0), 0.0)


def _hsv(color):
    made = to_hsv(color)
    return [_channel(made, i) for i in range(3)]


def _joined_hsv(*channels):
    return from_hsv(np.concatenate(np.broadcast_arrays(*channels), axis=-1))


def _blend_hue(t, a, b):
    (hue, other, _), (_, saturation, value) = _hsv(b), _hsv(a)
    return np.where(other != 0.0, mix(a, _joined_hsv(hue, saturation, value), t), a)


def _blend_saturation(t, a, b):
    hue, own, value = _hsv(a)
    return np.where(own != 0.0, _joined_hsv(hue, mix(own, _hsv(b)[1], t), value), a)


def _blend_value(t, a, b):
    hue, saturation, value = _hsv(a)
    return _joined_hsv(hue, saturation, mix(value, _hsv(b)[2], t))


def _blend_color(t, a, b):
    hue, saturation, _ = _hsv(b)
    return np.where(saturation != 0.0, mix(a, _joined_hsv(hue, saturation, _hsv(a)[2]), t), a)


def _gamma(color, exponent):
    bent = np.where(color > 0.0, np.power(np.where(color > 0.0, color, 1.0), exponent), color)
    return np.where(exponent == 0.0, 1.0, bent)


def _hue_saturation(color, hue, saturation, value, factor):
    h, s, v = _hsv(color)
    changed = _joined_hsv(_fraction(h + hue + 0.5), np.clip(s * saturation, 0.0, 1.0), v * value)
    return np.maximum(mix(color, changed, factor), 0.0)


#: As `MATH`.
COLORS = {
    "color_to_hsv": to_hsv,
    "color_from_hsv": from_hsv,
    "color_to_hsl": to_hsl,
    "color_from_hsl": from_hsl,
    "color_blend_divide": lambda t, a, b: np.where(b != 0.0, mix(a, divide(a, b), t), a),
    "color_blend_screen": lambda t, a, b: mix(a, _screen(a, b), t),
    "color_blend_overlay": _overlay,
    "color_blend_soft_light": lambda t, a, b: mix(a, (1.0 - a) * b * a + a * _screen(a, b), t),
    "color_blend_exclusion": lambda t, a, b: np.maximum(mix(a, a + b - 2.0 * a * b, t), 0.0),
    "color_blend_dodge": _dodge,
    "color_blend_burn": _burn,
    "color_blend_hue": _blend_hue,
    "color_blend_saturation": _blend_saturation,
    "color_blend_value": _blend_value,
    "color_blend_color": _blend_color,
    "color_gamma": _gamma,
    "color_bright_contrast": lambda color, bright, contrast: np.maximum(
        (1.0 + contrast) * color + (bright - 0.5 * contrast), 0.0
    ),
    "color_hue_saturation": _hue_saturation,
}
TWINS = MATH | VECTORS | COLORS
