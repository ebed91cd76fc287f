# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the numbers and colours that feed the shaders of one material, world or light, as expressions."""

import contextlib
import sys

from ..engine.expression import Parameter, as_type, call, luminance, mean
from .attributes import key_of
from .nodes import NUMBERS
from .shader_nodes.math import of
from .shader_nodes.registry import ENTRIES, Node, attribute_color, output_of

#: Frames of Python for one node of a chain, and for the longest chain that is read.
_DEEPEST = 50_000


class TreeReader:
    """Reads nodes; `user` names whose they are in reports, `owner` is Blender's ID.

    `kind`: MATERIAL, WORLD or LIGHT. `images` (an `Images`) may be None where no picture is wanted. `layers`: the view
    layer, scene and world. Once all is read, `finish` sends the rest of the reports; `uv_map` is then the uv map that
    the surface's uv is taken from, None where none is used.
    """

    def __init__(self, user, owner, kind, images, reports, layers=()):
        self.user, self.owner, self.kind, self.images = user, owner, kind, images
        self._reports, self._layers, self.asked_layers = reports, layers, False
        self._known, self._outputs, self._open, self._parameters, self._replaced = {}, {}, set(), {}, {}
        self.uv_map = None

    # What entries ask for

    def number(self, source):
        """What feeds a socket as a number, converted as Blender does."""
        value = self.value(source)
        return value if source is None else _as_number(value, (source.socket_type, *source.passed)[-1])

    def color(self, source):
        """What feeds a socket as a colour or vector."""
        return as_type(self.value(source), "vec3")

    def value(self, source):
        """What feeds a socket, a `Source` or None, as an Expression."""
        if source is None:
            return Parameter(0.0)
        value, kind = self._made(source), source.socket_type
        for following in source.passed:
            value, kind = _converted(value, kind, following), following
        return value

    def _made(self, source):
        if source.node is None:
            return self._constant(source)
        key = source.key
        if key not in self._known:
            if key in self._open:
                self.warn(f"node {source.name!r} feeds itself; that link is left out")
                return self._constant(source)
            self._open.add(key)
            self._known[key] = self._read(source)
            self._open.discard(key)
        found = self._known[key]
        return self._own(source) if found is None else found

    def uv(self, name=""):
        """The uv map of a name, empty for the active one, as a vector. The first one that is asked for is the
        surface's own uv, others come as attributes."""
        if self.uv_map is None:
            self.uv_map = name
        if self.uv_map == name:
            return as_type(call("point_uv"), "vec3")
        return as_type(attribute_color(key_of("geometry", name)), "vec3")

    @property
    def layers(self):
        """View layer, scene and world; that they were asked for is noted."""
        self.asked_layers = True
        return self._layers

    # Reports

    def warn(self, message, once=None):
        self._reports.warn(f"{self.user}: {message}", once)

    def not_understood(self, source, instead):
        """Report the node of `source` with what is used instead of it: all of that in one message."""
        replacements = self._replaced.setdefault(source.name, [])
        if instead not in replacements:
            replacements.append(instead)

    def left_out(self, source, what):
        """Report the node of `source`, once, and that there is nothing instead of `what` it makes."""
        self.warn(f"node {source.name!r} is not rendered; {what} is left out")

    def finish(self):
        """Report the nodes that were not understood."""
        for name, replacements in self._replaced.items():
            self.warn(f"node {name!r} is not rendered; {listed(replacements, 'is', 'are')} used instead")

    # Reading

    def _read(self, source):
        entry = ENTRIES.get(source.type)
        if entry is None:
            return None
        read = self._outputs.get(source.node_key)
        if read is None:
            read = entry(Node(source, self))
            if isinstance(read, dict):  # of all outputs: they share the calls that they have in common
                self._outputs[source.node_key] = read
        found = output_of(read, source.output.identifier)
        return output_of(read, source.output.name) if found is None and isinstance(read, dict) else found

    def _constant(self, source):
        """The parameter of a socket that nothing feeds: the same one each time."""
        key = source.socket_key
        if key not in self._parameters:
            self._parameters[key] = parameter_of(source.constant)
        return self._parameters[key]

    def _own(self, source):
        """A socket's own value in place of what feeds it, reported."""
        own = self._constant(source)
        shown = f"{own.value[0]:.3g}" if own.type == "float" else _shown(own.value)
        what = "color" if source.socket.type == "RGBA" else "value"
        self.not_understood(source, f"the socket's own {what} {shown} for {source.socket.name}")
        return own


@contextlib.contextmanager
def deep_recursion():
    """Let chains of thousands of nodes be followed."""
    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(max(limit, _DEEPEST))
    try:
        yield
    finally:
        sys.setrecursionlimit(limit)


def parameter_of(value):
    """The Parameter of a socket's default: a colour, a vector or a number; black where it has none."""
    if value is None or isinstance(value, str):
        return Parameter((0.0, 0.0, 0.0))
    if isinstance(value, (bool, int, float)):
        return Parameter(float(value))
    return Parameter(tuple(float(c) for c in value)[:3])


def _as_number(value, kind):
    """A value of a socket of type `kind` as a number."""
    if value.type == "float":
        return value
    value = as_type(value, "vec3")
    return luminance(value) if kind == "RGBA" else mean(value)


def _converted(value, kind, to):
    """A value of a socket of type `kind` as a socket of type `to` hands it on."""
    if to not in NUMBERS:
        return as_type(value, "vec3")
    value = _as_number(value, kind)
    return of("math_truncate", value) if to == "INT" else value


def _shown(rgb):
    return "(" + ", ".join(f"{c:.2f}" for c in rgb) + ")"


def listed(things, verb, plural_verb):
    """Things in a sentence, with its verb."""
    *most, last = things
    return f"{', '.join(most)} and {last} {plural_verb}" if most else f"{last} {verb}"
