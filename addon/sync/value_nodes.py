# SPDX-License-Identifier: GPL-3.0-or-later
"""The nodes that compute values, each as an expression of constants and attributes."""

import numpy as np

from . import value_functions as functions
from .expressions import Constant, made

#: Places at which a Color Ramp is evaluated; Cycles has 256.
_RAMP_PLACES = 1025
_ZERO = Constant((0.0,))
_OF_COLORS = ("RGBA", "VECTOR")


class ValueNodes:
    """Reads the value nodes of one material, world or light.

    `attributes`: an `AttributeNodes`, None where there are no attributes. `not_understood(source, instead)` is told of
    nodes that are not taken as they are.
    """

    def __init__(self, attributes, not_understood):
        self._attributes, self._not_understood = attributes, not_understood
        self._known = {}

    def read(self, source, is_number=False):
        """What feeds a socket as an expression: of a color or vector, or of a number. None where some node on the way
        cannot be computed for a whole element: a texture, or one that is not known."""
        found = self._read(source)
        kind = (source.output or source.socket).type
        if found is None or not is_number or kind not in _OF_COLORS:
            return found
        return made(functions.as_number, (kind == "RGBA",), (found,))

    def _read(self, source):
        if source.node is None:
            return constant(source.constant)
        key = _key(source)
        if key not in self._known:
            read = _NODES.get(source.type)
            if read is not None:
                self._known[key] = read(self, source)
            else:
                self._known[key] = self._attributes.read(source) if self._attributes is not None else None
        return self._known[key]

    def to_blame(self, source):
        """The `Source` because of which `read` gave None for one: itself, or the first on the way to it."""
        if source.type in _NODES:
            feeding = (source.input(i) for i, socket in enumerate(source.node.inputs) if socket.enabled)
            for one in feeding:
                if one.node is not None and self._known.get(_key(one), one) is None:
                    return self.to_blame(one)
        return source

    def _inputs(self, source):
        """The expressions of a node's enabled inputs; None where one has none."""
        sockets = source.node.inputs
        numbers = [i for i, socket in enumerate(sockets) if socket.enabled]
        found = [self.read(source.input(i), sockets[i].type not in _OF_COLORS) for i in numbers]
        return None if None in found else found

    def _value(self, source):
        return constant(source.output.default_value)

    def _light_path(self, source):
        self._not_understood(source, "what the camera sees")
        return Constant((1.0 if source.output.identifier == "Is Camera Ray" else 0.0,))

    def _ambient_occlusion(self, source):
        self._not_understood(source, "its color without occlusion")
        return self.read(source.input("Color")) if source.output.identifier == "Color" else Constant((1.0,))

    def _menu_switch(self, source):
        chosen = chosen_item(source)
        return None if chosen is None else self.read(chosen, source.output.type not in _OF_COLORS)

    def _math(self, source):
        node, inputs = source.node, self._inputs(source)
        if inputs is None or node.operation not in functions.MATH:
            return None
        found = made(functions.math, (node.operation,), _padded(inputs, 3))
        return made(functions.clamped, (), (found,)) if node.use_clamp else found

    def _vector_math(self, source):
        node = source.node
        if node.operation not in functions.VECTOR_MATH or self._inputs(source) is None:
            return None
        sockets = enumerate(node.inputs)
        inputs = [self.read(source.input(i), s.type == "VALUE") if s.enabled else _ZERO for i, s in sockets]
        return made(functions.vector_math, (node.operation,), tuple(inputs))

    def _mix(self, source):
        node, inputs = source.node, self._inputs(source)
        if inputs is None or len(inputs) != 3 or node.data_type == "ROTATION":
            return None
        kind = node.blend_type if node.data_type == "RGBA" else "MIX"
        return _blended(kind, inputs, node.clamp_factor, node.data_type == "RGBA" and node.clamp_result)

    def _mix_rgb(self, source):
        inputs = self._inputs(source)
        return None if inputs is None else _blended(source.node.blend_type, inputs, True, source.node.use_clamp)

    def _clamp(self, source):
        return self._made(source, functions.limited, source.node.clamp_type == "RANGE")

    def _map_range(self, source):
        node, inputs = source.node, self._inputs(source)
        if inputs is None:
            return None
        settings = node.interpolation_type, node.data_type == "FLOAT"
        found = made(functions.map_range, settings, _padded(inputs, 6))
        if node.clamp and node.interpolation_type in ("LINEAR", "STEPPED"):
            return made(functions.limited, (True,), (found, *inputs[3:5]))
        return found

    def _ramp(self, source):
        ramp, rows = source.node.color_ramp, slice(3, 4) if source.output.identifier == "Alpha" else slice(3)
        is_constant = ramp.interpolation == "CONSTANT"
        places = [e.position for e in ramp.elements] if is_constant else np.linspace(0.0, 1.0, _RAMP_PLACES)
        table = tuple(tuple(ramp.evaluate(place)[rows]) for place in places)
        if is_constant:
            return self._made(source, functions.steps, tuple(places), table)
        return self._made(source, functions.ramp, table)

    def _separate(self, source, mode=None):
        i = [output.identifier for output in source.node.outputs].index(source.output.identifier)
        return self._made(source, functions.separate, mode or source.node.mode, i)

    def _combine(self, source, mode=None):
        return self._made(source, functions.combined, mode or source.node.mode)

    def _made(self, source, function, *settings):
        """What a function makes of all inputs of a node."""
        inputs = self._inputs(source)
        return None if inputs is None else made(function, settings, tuple(inputs))


def _key(source):
    """What tells an output of a node, in its groups, from all others."""
    return (*(group.name for group in source.groups), source.node.name, source.output.identifier)


def constant(value):
    """The `Constant` of a socket's default: a color, a vector or a number; black where it has none."""
    if value is None:
        return Constant((0.0, 0.0, 0.0))
    if isinstance(value, (bool, int, float)):
        return Constant((float(value),))
    return Constant(tuple(float(c) for c in value)[:3])


def chosen_item(source):
    """The `Source` of the item that a Menu Switch takes; None where the menu is not known before rendering."""
    menu = source.input(0)
    if menu.node is not None or not isinstance(menu.constant, str):
        return None
    items = enumerate(source.node.inputs)
    return next((source.input(i) for i, socket in items if i > 0 and socket.name == menu.constant), None)


def _padded(inputs, count):
    return (*inputs, *(_ZERO,) * (count - len(inputs)))


def _blended(kind, inputs, clamps_factor, clamps_result):
    if kind not in functions.BLENDS:
        return None
    factor, a, b = inputs
    if clamps_factor:
        factor = made(functions.clamped, (), (factor,))
    if factor == _ZERO:
        found = a
    elif kind == "MIX" and factor == Constant((1.0,)):
        found = b
    else:
        found = made(functions.blend, (kind,), (factor, a, b))
    return made(functions.clamped, (), (found,)) if clamps_result else found


def _of(method, mode):
    return lambda nodes, source: method(nodes, source, mode)


def _simple(function, *settings):
    return lambda nodes, source: nodes._made(source, function, *settings)


_NODES = {
    "VALUE": ValueNodes._value,
    "RGB": ValueNodes._value,
    "LIGHT_PATH": ValueNodes._light_path,
    "AMBIENT_OCCLUSION": ValueNodes._ambient_occlusion,
    "MENU_SWITCH": ValueNodes._menu_switch,
    "MATH": ValueNodes._math,
    "VECT_MATH": ValueNodes._vector_math,
    "MIX": ValueNodes._mix,
    "MIX_RGB": ValueNodes._mix_rgb,
    "CLAMP": ValueNodes._clamp,
    "MAP_RANGE": ValueNodes._map_range,
    "VALTORGB": ValueNodes._ramp,
    "SEPARATE_COLOR": ValueNodes._separate,
    "SEPRGB": _of(ValueNodes._separate, "RGB"),
    "SEPHSV": _of(ValueNodes._separate, "HSV"),
    "SEPXYZ": _of(ValueNodes._separate, "RGB"),
    "COMBINE_COLOR": ValueNodes._combine,
    "COMBRGB": _of(ValueNodes._combine, "RGB"),
    "COMBHSV": _of(ValueNodes._combine, "HSV"),
    "COMBXYZ": _of(ValueNodes._combine, "RGB"),
    "INVERT": _simple(functions.invert),
    "GAMMA": _simple(functions.gamma),
    "BRIGHTCONTRAST": _simple(functions.bright_contrast),
    "HUE_SAT": _simple(functions.hue_saturation),
    "RGBTOBW": _simple(functions.as_number, True),
}
