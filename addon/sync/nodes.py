# SPDX-License-Identifier: GPL-3.0-or-later
"""Following the links of a node tree: through reroutes, muted nodes and node groups, to what feeds a socket."""

import re
from dataclasses import dataclass

#: Types of sockets whose values are numbers.
NUMBERS = ("VALUE", "INT")
_NUMBERED = re.compile(r"^\d+_")
#: Outputs that only one engine uses are taken where there is no other.
_TARGETS = ("ALL", "CYCLES", "EEVEE")


@dataclass(frozen=True)
class Source:
    """What feeds a socket: `output` of `node`; or nothing, then `node` is None and `socket.default_value` counts.

    `groups` are the group nodes that one has entered on the way, outermost first: sockets of `node` are followed with
    them. `passed` are the types of the sockets that hand the value on, in their order: each converts it to its own.
    """

    socket: object
    node: object = None
    output: object = None
    groups: tuple = ()
    passed: tuple = ()

    @property
    def type(self):
        """The node's type, empty for a constant."""
        return self.node.type if self.node is not None else ""

    @property
    def constant(self):
        """The value of the socket where nothing feeds it; None for a shader. In Cycles a muted node's has none."""
        if self.socket.node.mute:
            return 0.0 if self.socket.type in NUMBERS else (0.0, 0.0, 0.0)
        return getattr(self.socket, "default_value", None)

    @property
    def socket_type(self):
        """The type of the socket that makes the value: VALUE, RGBA, VECTOR ..."""
        return (self.output or self.socket).type

    def input(self, name):
        """What feeds the input called or numbered `name` of this node, or None where the node has no such input."""
        socket = self.node.inputs[name] if isinstance(name, int) else self.node.inputs.get(name)
        return None if socket is None else self.input_of(socket)

    def input_of(self, socket):
        """What feeds an input socket of this node."""
        return source_of(socket, self.groups)

    @property
    def name(self):
        """The node's name, as the user knows it: Blender's flattened trees put a number before it."""
        return _NUMBERED.sub("", self.node.name)

    @property
    def key(self):
        """What tells this output of a node, in its groups, from all others."""
        return (*self.node_key, self.output.identifier)

    @property
    def node_key(self):
        """What tells the node, in its groups, from all others."""
        return (*(group.name for group in self.groups), self.node.name)

    @property
    def socket_key(self):
        """The same of the socket."""
        return self.socket.as_pointer()


def output_source(tree, socket_name):
    """What feeds the socket (Surface, Volume ...) of the tree's active output, or None where it has no output."""
    for target in _TARGETS:
        node = tree.get_output_node(target)
        if node is not None:
            socket = node.inputs.get(socket_name)
            return None if socket is None else source_of(socket)
    return None


def source_of(socket, groups=()):
    """Follow the link into `socket` to the node that makes its value. Where links go in a circle it is as if
    nothing were linked."""
    first, seen, passed = Source(socket, groups=groups), set(), ()
    while True:
        place = (socket.as_pointer(), *(group.as_pointer() for group in groups))
        if place in seen:
            return first
        seen.add(place)
        link = next((link for link in socket.links if link.is_valid and not link.is_muted), None)
        if link is None:
            return Source(socket, groups=groups, passed=passed)
        node, output = link.from_node, link.from_socket
        if node.type == "REROUTE":
            following = node.inputs[0]
        elif node.mute:
            following = _through_muted(node, output)
        elif node.type == "GROUP_INPUT" and groups:
            following, groups = _by_identifier(groups[-1].inputs, output), groups[:-1]
        elif node.type == "GROUP":
            following, groups = _group_output(node, output), (*groups, node)
        else:
            return Source(socket, node, output, groups, passed)
        if following is None:
            return Source(socket, groups=groups, passed=passed)
        socket, passed = following, (output.type, *passed)


def _through_muted(node, output):
    return next((link.from_socket for link in node.internal_links if link.to_socket == output), None)


def _group_output(node, output):
    """The socket inside a group that makes `output` of the group node."""
    outputs = [n for n in node.node_tree.nodes if n.type == "GROUP_OUTPUT"] if node.node_tree else []
    active = next((n for n in outputs if n.is_active_output), None)
    return _by_identifier(active.inputs, output) if active else None


def _by_identifier(sockets, like):
    return next((socket for socket in sockets if socket.identifier == like.identifier), None)
