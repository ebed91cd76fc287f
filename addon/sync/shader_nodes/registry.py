# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of shader nodes, and what an entry sees of its node."""

from dataclasses import dataclass

from ...engine.expression import AttributeNumber, Expression, Parameter, call, expression, is_constant

#: Functions by the type of the node: `read(n)` with a `Node` gives an Expression, or several by output identifier.
ENTRIES = {}


def readers_into(table):
    """The decorator that enters a function into a table under the types of the nodes that it reads."""

    def reads(*types):
        def enter(function):
            for node_type in types:
                assert node_type not in table, node_type
                table[node_type] = function
            return function

        return enter

    return reads


reads = readers_into(ENTRIES)


@dataclass(frozen=True)
class Node:
    """A node of a tree that is being read: `source` says which, in which groups, and the output that is wanted;
    `reader` is the `TreeReader`."""

    source: object
    reader: object

    @property
    def node(self):
        """Blender's node, for its settings."""
        return self.source.node

    @property
    def output(self):
        """Identifier of the output that is wanted."""
        return self.source.output.identifier

    @property
    def owner(self):
        """The material, world or light."""
        return self.reader.owner

    @property
    def in_world(self):
        return self.reader.kind == "WORLD"

    @property
    def images(self):
        """The `Images` of the scene; None where only light is asked for."""
        return self.reader.images

    @property
    def layers(self):
        """View layer, scene and world, whose properties attributes of the view layer are."""
        return self.reader.layers

    def has(self, name):
        """Whether there is an input of a name or number that is in use."""
        return self._socket(name) is not None

    def linked(self, *names):
        """Whether something feeds the first input there is of these names or numbers."""
        source = self.input(*names)
        return source is not None and source.node is not None

    def input(self, *names):
        """The `Source` of the first input there is of these names or numbers; None where there is none."""
        sockets = (self._socket(name) for name in names)
        socket = next((socket for socket in sockets if socket is not None), None)
        return None if socket is None else self.source.input_of(socket)

    def number(self, *names):
        """An input as a number, as Blender converts colours and vectors; 0 where there is none."""
        return self.reader.number(self.input(*names))

    def color(self, *names):
        """An input as a colour; black where there is none."""
        return self.reader.color(self.input(*names))

    def vector(self, *names):
        """An input as a vector; 0 where there is none."""
        return self.reader.color(self.input(*names))

    def constant(self, *names):
        """An input as a number where it is the same everywhere, else None."""
        value = self.number(*names)
        return value.value[0] if is_constant(value) else None

    def uv(self, name=""):
        """The uv map of a name as a vector, by default the active one."""
        return self.reader.uv(name)

    def parameter(self, value):
        """A setting of the node that may change without another program: number or colour."""
        return Parameter(value)

    def warn(self, text, once=None):
        self.reader.warn(f"node {self.source.name!r}: {text}", once)

    def instead(self, text):
        """Report that the node is not rendered, and what is used instead."""
        self.reader.not_understood(self.source, text)

    def _socket(self, name):
        sockets = self.node.inputs
        if isinstance(name, int):
            return sockets[name] if name < len(sockets) else None
        return next((s for s in sockets if name in (s.name, s.identifier) and s.enabled), None)


def attribute_color(key):
    """The colour (4,) of an attribute, see `attributes.key_of`."""
    return call("attribute_value", AttributeNumber(key))


def output_of(read, identifier):
    """The Expression of an output from what an entry gave; None where it gave none."""
    if isinstance(read, dict):
        read = read.get(identifier)
    return read if read is None or isinstance(read, Expression) else expression(read)
