"""How nodes are put together: groups, muted nodes and links, reroutes, links between sockets of other types, several
images in a material, several materials on an object."""

from itertools import product

import bpy

from tests.blender.building import add_camera, material, node

from .case import PLACE, A, B, K, L, Node, Scene, Swatch
from .images import from_file, generated, opaque, picture


def _group(name, shown=None, inner=None):
    """A group that takes a color and a number (0.3 where nothing is linked), and gives the one times the other plus
    what is `shown` in it; `inner`: a group in the group, of the color."""
    tree = bpy.data.node_groups.new(name, "ShaderNodeTree")
    for kind, direction in (("Color", "INPUT"), ("Float", "INPUT"), ("Color", "OUTPUT")):
        socket = tree.interface.new_socket(kind, in_out=direction, socket_type=f"NodeSocket{kind}")
        if kind == "Float":
            socket.default_value = 0.3
    given, taken = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    total = node(tree, "VectorMath", taken.inputs[0])
    total.operation = "MULTIPLY_ADD"
    color = given.outputs[0]
    if inner:
        within = tree.nodes.new("ShaderNodeGroup")
        within.node_tree = inner
        tree.links.new(color, within.inputs[0])
        color = within.outputs[0]
    tree.links.new(color, total.inputs[0])
    tree.links.new(given.outputs[1], total.inputs[1])
    if shown:
        tree.links.new(shown.build(tree), total.inputs[2])
    return tree


def _used(tree, group, *feed):
    """The output of a group in a tree, fed by Nodes."""
    made = tree.nodes.new("ShaderNodeGroup")
    made.node_tree = group
    for socket, value in zip(made.inputs, feed, strict=False):
        if value is not None:
            tree.links.new(value.build(tree), socket)
    return made.outputs[0]


def _of_group(*feed, shown=None, nested=False):
    def build(tree, socket):
        inner = _group("inner", shown=Node("TexChecker", "Color", Vector=PLACE)) if nested else None
        tree.links.new(_used(tree, _group("group", shown, inner), *feed), socket)

    return build


def _converting(kind, to, shown):
    """What a group makes of a Node that hands a socket of type `kind` on to one of type `to`."""

    def build(tree, socket):
        group = bpy.data.node_groups.new("group", "ShaderNodeTree")
        group.interface.new_socket("in", in_out="INPUT", socket_type=f"NodeSocket{kind}")
        group.interface.new_socket("out", in_out="OUTPUT", socket_type=f"NodeSocket{to}")
        given, taken = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
        group.links.new(given.outputs[0], taken.inputs[0])
        tree.links.new(_used(tree, group, shown), socket)

    return build


def _of_group_twice(tree, socket):
    """The same group with other inputs, the one feeding the other."""
    group = _group("group", shown=PLACE)
    first = _used(tree, group, A, K)
    second = _used(tree, group, None, L)
    tree.links.new(first, second.node.inputs[0])
    tree.links.new(second, socket)


def _muted(kind, output=0, **values):
    """A node that is muted, so that it hands on its first input of the type."""
    return Node(kind, output, **values, then=_mute)


def _mute(made):
    made.mute = True


def _of_muted_group(tree, socket):
    made = _used(tree, _group("group", shown=PLACE), A, K)
    made.node.mute = True
    tree.links.new(made, socket)


def _by_muted_link(tree, socket):
    """A link that is muted: the value of the socket counts."""
    made = Node("VectorMath", operation="ADD", feed=(A, B)).build(tree)
    made.node.inputs[1].default_value = (0.2, 0.4, 0.6)
    made.node.inputs[1].links[0].is_muted = True
    tree.links.new(made, socket)


def _rerouted(shown, *types):
    """By way of reroutes of these types."""

    def build(tree, socket):
        given = shown.build(tree)
        for kind in types:
            reroute = tree.nodes.new("NodeReroute")
            if hasattr(reroute, "socket_idname"):
                reroute.socket_idname = f"NodeSocket{kind}"
            tree.links.new(given, reroute.inputs[0])
            given = reroute.outputs[0]
        tree.links.new(given, socket)

    return build


_NUMBER = Node("Math", operation="ADD", feed=(K, 0.25))
_COLOR = Node("Gamma", feed=(A, 1.0))
_VECTOR = Node("VectorMath", operation="ADD", feed=(A, (0.1, 0.2, 0.3)))

_LINKS = {
    "number to color": Node("Gamma", feed=(_NUMBER, 1.0)),
    "number to vector": Node("VectorMath", operation="ADD", feed=(_NUMBER, (0.1, 0.2, 0.3))),
    "color to number": Node("Math", operation="MULTIPLY", feed=(_COLOR, 0.7)),
    "color to vector": Node("VectorMath", operation="MULTIPLY", feed=(_COLOR, (0.7, 0.8, 0.9))),
    "vector to number": Node("Math", operation="MULTIPLY", feed=(_VECTOR, 0.7)),
    "vector to color": Node("Gamma", feed=(_VECTOR, 1.0)),
    "vector to number to color": Node("Gamma", feed=(Node("Math", operation="MULTIPLY", feed=(_VECTOR, 0.7)), 1.0)),
}


def _images(*makers, **settings):
    """The sum of pictures, each another image or read in another way."""

    def build(tree, socket):
        total = None
        for make, setting in makers:
            made = Node("VectorMath", operation="ADD").build(tree).node
            picture(make, **setting)(tree, made.inputs[0])
            if total:
                tree.links.new(total, made.inputs[1])
            total = made.outputs[0]
        tree.links.new(total, socket)

    return build


def _one():
    """One image, however often it is asked for."""
    made = bpy.data.images.get("one") or opaque()
    made.name = "one"
    return made


def _several_materials():
    """A cube whose sides have materials of their own: colors, an image, none."""
    bpy.ops.mesh.primitive_cube_add(size=2.0, rotation=(0.5, 0.4, 0.3))
    cube = bpy.context.object
    for color in (
        Node("RGB"),
        Node("TexChecker", Vector=Node("TexCoord", "UV")),
        picture(),
        Node("TexCoord", "Object"),
    ):
        made, tree, output = material()
        emission = node(tree, "Emission", output.inputs["Surface"], Strength=1.0)
        if isinstance(color, Node):
            tree.links.new(color.build(tree), emission.inputs["Color"])
        else:
            color(tree, emission.inputs["Color"])
        cube.data.materials.append(made)
    cube.data.polygons.foreach_set("material_index", [0, 1, 2, 3, 1, 2])
    add_camera(lens=80.0)


def _two_outputs():
    """A tree of two outputs, of which the active one counts, and one for EEVEE, which comes first."""
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1.5, segments=64, ring_count=32)
    made, tree, output = material()
    output.target = "EEVEE"
    for color, active in (((1.0, 0.0, 0.0, 1.0), False), (None, True)):
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        emission = node(tree, "Emission", output.inputs["Surface"], Strength=1.0)
        if color:
            emission.inputs["Color"].default_value = color
        else:
            tree.links.new(Node("TexCoord", "Generated").build(tree), emission.inputs["Color"])
        output.is_active_output = active
    bpy.context.object.data.materials.append(made)
    add_camera(lens=80.0)


_MADE = {"number": Node("Math", operation="MULTIPLY", feed=(K, 3.3)), "color": _COLOR, "vector": _VECTOR}
#: What a group is given, the types of sockets it goes through, and the name of the case.
_CONVERTED = {
    f"{name} as {kind} as {to} by a group": _converting(kind, to, shown)
    for (name, shown), kind, to in product(_MADE.items(), ("Float", "Int", "Color", "Vector"), ("Float", "Color"))
}

_BLACK = {"constant": True, "black": True}

CASES = [
    Swatch("group", _of_group(A, K)),
    Swatch("group of its own values", _of_group(A, shown=PLACE)),
    Swatch("group in a group", _of_group(A, K, nested=True)),
    Swatch("group twice", _of_group_twice),
    *(Swatch(name, shown) for name, shown in _CONVERTED.items()),
    Swatch("group with an image", _of_group(A, K, shown=Node("TexChecker", "Color", Vector=PLACE))),
    Swatch("muted math", _muted("Math", feed=(K, L))),
    Swatch("muted vector math", _muted("VectorMath", operation="CROSS_PRODUCT", feed=(A, B))),
    Swatch("muted mix", _muted("Mix", data_type="RGBA", feed=(K, A, B))),
    Swatch("muted ramp", _muted("ValToRGB", Fac=K), constant=True),
    Swatch("muted texture", _muted("TexNoise", "Color", Vector=PLACE), **_BLACK),
    Swatch("muted separation", _muted("SeparateXYZ", "Y", feed=(A,))),
    Swatch("muted number of a color", _muted("Math", feed=(_COLOR, K))),
    Swatch("muted alpha of a ramp", _muted("ValToRGB", "Alpha", Fac=_COLOR)),
    Swatch("muted length", _muted("VectorMath", "Value", operation="LENGTH", feed=(_VECTOR, B))),
    Swatch("muted math of a number of its own", _muted("Math", feed=(0.3, 0.4)), **_BLACK),
    Swatch("muted group", _of_muted_group),
    Swatch("muted link", _by_muted_link),
    Swatch("reroutes", _rerouted(_COLOR, "Color", "Color")),
    Swatch("reroutes of other types", _rerouted(_COLOR, "Float", "Color")),
    Swatch("reroutes of vectors", _rerouted(_VECTOR, "Vector", "Color", "Vector")),
    *(Swatch(f"link of {name}", shown) for name, shown in _LINKS.items()),
    Swatch("three images", _images((opaque, {}), (generated, {}), (from_file, {"interpolation": "Closest"}))),
    Swatch("an image read twice", _images((_one, {}), (_one, {"extension": "CLIP", "interpolation": "Cubic"}))),
    Scene("several materials", build=_several_materials, few=0.2),
    Scene("several outputs", build=_two_outputs, few=0.1),
]
