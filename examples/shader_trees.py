# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials and worlds written down as nested nodes."""

from dataclasses import dataclass

import bpy


@dataclass(frozen=True)
class Shader:
    """A node of the type ShaderNode<kind> whose output of a name or number is taken. `members`: its inputs, `_` for
    spaces, and settings; each a number, a colour or another Shader."""

    kind: str
    output: str | int
    members: dict

    def made(self, tree, column=1, row=0):
        """The socket of the node, made in a tree with all that feeds it."""
        node = tree.nodes.new(f"ShaderNode{self.kind}")
        node.location = -260.0 * column, -220.0 * row
        for name in sorted(self.members, key=lambda name: not hasattr(node, name)):  # settings may change the sockets
            value = self.members[name]
            if hasattr(node, name):
                setattr(node, name, value)
                continue
            socket = _socket(node, name)
            if isinstance(value, Shader):
                tree.links.new(value.made(tree, column + 1, row), socket)
                row += 1
            else:
                socket.default_value = value
        return _output(node, self.output)


def shader(kind, output=0, /, **members):
    """A `Shader`; an input that is known by its number is called `input_<number>`."""
    return Shader(kind, output, members)


def ramp(factor, *stops, interpolation="LINEAR"):
    """A Color Ramp of stops (place, colour (3,))."""
    return _Ramp("ValToRGB", 0, {"Fac": factor}, stops, interpolation)


@dataclass(frozen=True)
class _Ramp(Shader):
    stops: tuple
    interpolation: str

    def made(self, tree, column=1, row=0):
        socket = super().made(tree, column, row)
        colors = socket.node.color_ramp
        colors.interpolation = self.interpolation
        while len(colors.elements) > 1:
            colors.elements.remove(colors.elements[-1])
        for number, (place, color) in enumerate(self.stops):
            element = colors.elements[0] if number == 0 else colors.elements.new(place)
            element.position, element.color = place, (*color, 1.0)
        return socket


def new_material(name, surface, volume=None):
    """A material of a surface Shader and, within bodies, a volume one."""
    made = bpy.data.materials.new(name)
    outputs = {"Surface": surface, "Volume": volume}
    _fill(made, "Material", outputs)
    return made


def new_world(name, surface):
    made = bpy.data.worlds.new(name)
    _fill(made, "World", {"Surface": surface})
    return made


def _fill(owner, kind, outputs):
    if bpy.app.version < (5, 0, 0):
        owner.use_nodes = True
    tree = owner.node_tree
    tree.nodes.clear()
    output = tree.nodes.new(f"ShaderNodeOutput{kind}")
    for name, made in outputs.items():
        if made is not None:
            tree.links.new(made.made(tree), output.inputs[name])


def _socket(node, name):
    if name.startswith("input_"):
        return node.inputs[int(name.removeprefix("input_"))]
    wanted = name.replace("_", " ")
    return next(s for s in node.inputs if s.enabled and s.name in (wanted, {"Fac": "Factor"}.get(wanted)))


def _output(node, output):
    if isinstance(output, int):
        return [s for s in node.outputs if s.enabled][output]
    return next(s for s in node.outputs if s.enabled and s.name in (output, {"Fac": "Factor"}.get(output)))
