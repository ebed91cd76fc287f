# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that compute colors, and those that take colors and vectors apart."""

from ...engine.expression import (
    Parameter,
    absolute,
    clamped,
    combine,
    component,
    luminance,
    maximum,
    minimum,
    mix,
)
from .math import of
from .registry import reads

#: By blend type, of the factor, the color below and the one above.
_BLENDS = {
    "MIX": lambda t, a, b: mix(a, b, t),
    "ADD": lambda t, a, b: a + b * t,
    "SUBTRACT": lambda t, a, b: a - b * t,
    "MULTIPLY": lambda t, a, b: mix(a, a * b, t),
    "DARKEN": lambda t, a, b: mix(a, minimum(a, b), t),
    "LIGHTEN": lambda t, a, b: mix(a, maximum(a, b), t),
    "DIFFERENCE": lambda t, a, b: mix(a, absolute(a - b), t),
    "LINEAR_LIGHT": lambda t, a, b: a + (b * 2.0 - 1.0) * t,
}
_BLEND_FUNCTIONS = {
    "DIVIDE": "color_blend_divide",
    "SCREEN": "color_blend_screen",
    "OVERLAY": "color_blend_overlay",
    "SOFT_LIGHT": "color_blend_soft_light",
    "EXCLUSION": "color_blend_exclusion",
    "DODGE": "color_blend_dodge",
    "BURN": "color_blend_burn",
    "HUE": "color_blend_hue",
    "SATURATION": "color_blend_saturation",
    "VALUE": "color_blend_value",
    "COLOR": "color_blend_color",
}
#: By the mode of Separate and Combine Color, in which the names of older nodes end: functions from and to RGB.
_CHANNELS = {"HSV": ("color_to_hsv", "color_from_hsv"), "HSL": ("color_to_hsl", "color_from_hsl")}


def _blended(n, factor, a, b, clamps_result):
    kind = n.node.blend_type
    if kind in _BLENDS:
        result = _BLENDS[kind](factor, a, b)
    elif kind in _BLEND_FUNCTIONS:
        result = of(_BLEND_FUNCTIONS[kind], factor, a, b)
    else:
        n.instead("its first color")
        result = a
    return clamped(result) if clamps_result else result


@reads("MIX")
def mix_node(n):
    kind = n.node.data_type
    by_each = kind == "VECTOR" and n.node.factor_mode == "NON_UNIFORM"
    factor = n.vector("Factor") if by_each else n.number("Factor")
    factor = clamped(factor) if n.node.clamp_factor else factor
    a, b = ((n.number if kind == "FLOAT" else n.color)(name) for name in "AB")
    if kind == "RGBA":
        return _blended(n, factor, a, b, n.node.clamp_result)
    if kind == "ROTATION":
        n.instead("its first rotation")
        return a
    return a + (b - a) * factor if by_each else mix(a, b, factor)


@reads("MIX_RGB")
def mix_rgb(n):
    return _blended(n, clamped(n.number(0)), n.color(1), n.color(2), n.node.use_clamp)


@reads("RGB")
def rgb(n):
    return Parameter(tuple(n.source.output.default_value)[:3])


def _functions(n):
    """What goes from RGB to the channels of a Separate or Combine node, and back; none for RGB and XYZ."""
    return _CHANNELS.get(getattr(n.node, "mode", n.node.type[-3:]))


@reads("SEPARATE_COLOR", "SEPRGB", "SEPHSV", "SEPXYZ")
def separate(n):
    functions, color = _functions(n), n.color(0)
    channels = of(functions[0], color) if functions else color
    return {output.identifier: component(channels, i) for i, output in enumerate(n.node.outputs)}


@reads("COMBINE_COLOR", "COMBRGB", "COMBHSV", "COMBXYZ")
def combined(n):
    functions, channels = _functions(n), combine(*(n.number(i) for i in range(3)))
    return of(functions[1], channels) if functions else channels


@reads("INVERT")
def invert(n):
    color = n.color("Color")
    return mix(color, 1.0 - color, n.number("Factor", "Fac"))


@reads("GAMMA")
def gamma(n):
    return of("color_gamma", n.color("Color"), n.number("Gamma"))


@reads("BRIGHTCONTRAST")
def bright_contrast(n):
    # "Bright" was renamed in Blender 5.
    return of("color_bright_contrast", n.color(0), n.number(1), n.number(2))


@reads("HUE_SAT")
def hue_saturation(n):
    changes = (n.number(name) for name in ("Hue", "Saturation", "Value"))
    return of("color_hue_saturation", n.color("Color"), *changes, n.number("Factor", "Fac"))


@reads("RGBTOBW")
def rgb_to_bw(n):
    return luminance(n.color("Color"))
