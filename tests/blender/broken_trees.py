"""Materials whose node trees are broken, odd or not understood: a function for each, of a tree and its output."""

import bpy

from tests.blender.building import link, node

#: Groups in groups: more than anyone makes, as many as Blender itself opens without running out of stack.
_DEPTH = 60
_CHAIN = 300
#: The functions of those that this Blender can make.
MATERIALS = []


def broken(since=(4, 2, 0)):
    """A decorator that adds a function to `MATERIALS` in a Blender of this version or newer."""

    def add(build):
        if bpy.app.version >= since:
            MATERIALS.append(build)
        return build

    return add


class _Unknown(bpy.types.ShaderNodeCustomGroup):
    """Of an add-on that is gone when the file is opened."""

    bl_idname = "ShaderNodeConicTestUnknown"
    bl_label = "Unknown"


def _emission(tree, output):
    return node(tree, "Emission", output.inputs["Surface"])


def _group(fill=None, outputs=("Color",), inputs=()):
    """A node group; `fill` gets its tree."""
    tree = bpy.data.node_groups.new("group", "ShaderNodeTree")
    for name in outputs:
        tree.interface.new_socket(name, in_out="OUTPUT", socket_type="NodeSocketColor")
    for name in inputs:
        tree.interface.new_socket(name, in_out="INPUT", socket_type="NodeSocketColor")
    if fill:
        fill(tree)
    return tree


def _add_group(tree, group, to=None):
    made = tree.nodes.new("ShaderNodeGroup")
    made.node_tree = group
    if to is not None and made.outputs:
        tree.links.new(made.outputs[0], to)
    return made


@broken()
def cycle_of_values(tree, output):
    emission = _emission(tree, output)
    a = node(tree, "Math", emission.inputs["Strength"])
    b = node(tree, "Math", a.inputs[0])
    tree.links.new(a.outputs[0], b.inputs[0])


@broken()
def node_that_feeds_itself(tree, output):
    mix = node(tree, "MixRGB", _emission(tree, output).inputs["Color"])
    tree.links.new(mix.outputs[0], mix.inputs[1])


@broken()
def cycle_of_shaders(tree, output):
    a = node(tree, "MixShader", output.inputs["Surface"])
    b = node(tree, "AddShader", a.inputs[1])
    tree.links.new(a.outputs[0], b.inputs[0])
    node(tree, "Emission", a.inputs[2])


@broken()
def cycle_of_reroutes(tree, output):
    a, b = tree.nodes.new("NodeReroute"), tree.nodes.new("NodeReroute")
    tree.links.new(a.outputs[0], b.inputs[0])
    tree.links.new(b.outputs[0], a.inputs[0])
    tree.links.new(b.outputs[0], _emission(tree, output).inputs["Color"])


@broken()
def reroute_of_nothing(tree, output):
    tree.links.new(tree.nodes.new("NodeReroute").outputs[0], _emission(tree, output).inputs["Color"])


@broken()
def no_image(tree, output):
    node(tree, "TexImage", _emission(tree, output).inputs["Color"])


@broken()
def missing_image(tree, output):
    texture = node(tree, "TexImage", _emission(tree, output).inputs["Color"])
    texture.image = bpy.data.images.new("gone", 4, 4)
    texture.image.source, texture.image.filepath = "FILE", "//is not there.png"


@broken()
def missing_sequence(tree, output):
    missing_image(tree, output)
    bpy.data.images["gone"].source = "SEQUENCE"


@broken()
def missing_movie(tree, output):
    missing_image(tree, output)
    bpy.data.images["gone"].source = "MOVIE"


@broken()
def missing_tiles(tree, output):
    missing_image(tree, output)
    bpy.data.images["gone"].source = "TILED"


@broken()
def missing_image_of_a_bsdf(tree, output):
    missing_image(tree, output)
    image_node = next(n for n in tree.nodes if n.type == "TEX_IMAGE")
    principled = node(tree, "BsdfPrincipled", output.inputs["Surface"])
    for name in ("Base Color", "Roughness", "Alpha", "Normal"):
        tree.links.new(image_node.outputs[0], principled.inputs[name])


@broken()
def unlinked_output(tree, output):
    _emission(tree, output)
    tree.links.clear()


@broken()
def no_output(tree, output):
    _emission(tree, output)
    tree.nodes.remove(output)


@broken()
def no_nodes(tree, output):
    tree.nodes.clear()


@broken()
def two_outputs_none_active(tree, output):
    _emission(tree, tree.nodes.new("ShaderNodeOutputMaterial"))
    _emission(tree, output)
    for one in tree.nodes:
        if one.type == "OUTPUT_MATERIAL":
            one.is_active_output = False


@broken()
def driver_that_divides_by_zero(tree, output):
    _drive(_emission(tree, output), "1.0 / 0.0")


@broken()
def driver_of_an_unknown_name(tree, output):
    _drive(_emission(tree, output), "nobody_knows(3)")


def _drive(emission, expression):
    curve = emission.inputs["Strength"].driver_add("default_value")
    curve.driver.type, curve.driver.expression = "SCRIPTED", expression


@broken()
def group_of_no_tree(tree, output):
    _add_group(tree, None)


@broken()
def group_without_an_output(tree, output):
    _add_group(tree, _group(), _emission(tree, output).inputs["Color"])


@broken()
def group_with_an_unlinked_output(tree, output):
    group = _group(lambda inner: inner.nodes.new("NodeGroupOutput"))
    _add_group(tree, group, _emission(tree, output).inputs["Color"])


@broken()
def group_whose_input_is_its_output(tree, output):
    def fill(inner):
        inner.links.new(inner.nodes.new("NodeGroupInput").outputs[0], inner.nodes.new("NodeGroupOutput").inputs[0])

    made = _add_group(tree, _group(fill, inputs=("Color",)), _emission(tree, output).inputs["Color"])
    made.inputs[0].default_value = (0.3, 0.6, 0.1, 1.0)


@broken()
def group_fed_by_itself(tree, output):
    group_whose_input_is_its_output(tree, output)
    made = next(n for n in tree.nodes if n.type == "GROUP")
    tree.links.new(made.outputs[0], made.inputs[0])


@broken()
def group_in_itself(tree, output):
    group = _group(lambda inner: inner.nodes.new("NodeGroupOutput"))
    inner = _add_group(group, None)
    try:
        inner.node_tree = group
    except RuntimeError:
        pass
    if inner.outputs:
        group.links.new(inner.outputs[0], next(n for n in group.nodes if n.type == "GROUP_OUTPUT").inputs[0])
    _add_group(tree, group, _emission(tree, output).inputs["Color"])


@broken()
def groups_nested_deeply(tree, output):
    group = None
    for _ in range(_DEPTH):

        def fill(inner, held=group):
            end = inner.nodes.new("NodeGroupOutput").inputs[0]
            if held is None:
                node(inner, "RGB", end).outputs[0].default_value = (0.3, 0.6, 0.1, 1.0)
            else:
                _add_group(inner, held, end)

        group = _group(fill)
    _add_group(tree, group, _emission(tree, output).inputs["Color"])


@broken()
def long_chain(tree, output):
    socket = _emission(tree, output).inputs["Color"]
    for _ in range(_CHAIN):
        made = node(tree, "Math", socket)
        made.inputs[1].default_value = 1.0 / _CHAIN
        socket = made.inputs[0]


@broken()
def group_input_outside_a_group(tree, output):
    made = tree.nodes.new("NodeGroupInput")
    if made.outputs:
        tree.links.new(made.outputs[0], _emission(tree, output).inputs["Color"])
    else:
        _emission(tree, output)


@broken()
def muted_texture(tree, output):
    node(tree, "TexNoise", _emission(tree, output).inputs["Color"]).mute = True


@broken()
def muted_value_node(tree, output):
    mix = node(tree, "MixRGB", _emission(tree, output).inputs["Color"])
    mix.inputs[1].default_value, mix.mute = (0.3, 0.6, 0.1, 1.0), True


@broken()
def muted_group(tree, output):
    group_whose_input_is_its_output(tree, output)
    next(n for n in tree.nodes if n.type == "GROUP").mute = True


@broken()
def muted_emission(tree, output):
    _emission(tree, output).mute = True


@broken()
def muted_mix_of_shaders(tree, output):
    mix = node(tree, "MixShader", output.inputs["Surface"])
    for socket in (mix.inputs[1], mix.inputs[2]):
        node(tree, "Emission", socket)
    mix.mute = True


@broken()
def muted_link(tree, output):
    socket = _emission(tree, output).inputs["Color"]
    node(tree, "TexNoise", socket)
    socket.links[0].is_muted = True


@broken()
def unknown_node(tree, output):
    bpy.utils.register_class(_Unknown)
    try:
        made = tree.nodes.new(_Unknown.bl_idname)
        made.node_tree = _group(lambda inner: inner.nodes.new("NodeGroupOutput"))
        tree.links.new(made.outputs[0], _emission(tree, output).inputs["Color"])
    finally:
        bpy.utils.unregister_class(_Unknown)


@broken()
def script_without_a_script(tree, output):
    tree.nodes.new("ShaderNodeScript")
    _emission(tree, output)


@broken()
def shader_as_a_color(tree, output):
    emission = _emission(tree, output)
    tree.links.new(node(tree, "BsdfDiffuse").outputs[0], emission.inputs["Color"])


@broken()
def color_as_a_shader(tree, output):
    tree.links.new(node(tree, "RGB").outputs[0], output.inputs["Surface"])


@broken()
def numbers_without_end(tree, output):
    emission = _emission(tree, output)
    power = node(tree, "Math", emission.inputs["Strength"])
    power.operation = "POWER"
    power.inputs[0].default_value, power.inputs[1].default_value = 1e30, 1e3


@broken()
def roots_and_quotients_of_nothing(tree, output):
    emission = _emission(tree, output)
    total = node(tree, "Math", emission.inputs["Strength"])
    for socket, operation in zip(total.inputs, ("LOGARITHM", "ARCSINE"), strict=False):
        made = node(tree, "Math", socket)
        made.operation = operation
        made.inputs[0].default_value = -5.0


@broken()
def attribute_that_is_not_there(tree, output):
    mix = node(tree, "MixRGB", _emission(tree, output).inputs["Color"])
    mix.blend_type = "ADD"
    for socket, name in zip(list(mix.inputs)[:2], ("", "nobody has it"), strict=True):
        node(tree, "Attribute", socket).attribute_name = name


@broken()
def uv_map_that_is_not_there(tree, output):
    checker = node(tree, "TexChecker", _emission(tree, output).inputs["Color"])
    node(tree, "UVMap", checker.inputs["Vector"]).uv_map = "nobody has it"


@broken()
def coordinates_of_a_deleted_object(tree, output):
    checker = node(tree, "TexChecker", _emission(tree, output).inputs["Color"])
    coordinates = node(tree, "TexCoord", checker.inputs["Vector"], "Object")
    coordinates.object = link(None, "gone")
    bpy.data.objects.remove(coordinates.object)


@broken()
def curves_of_no_width(tree, output):
    curves = node(tree, "RGBCurve", _emission(tree, output).inputs["Color"])
    for curve in curves.mapping.curves:
        for point in curve.points:
            point.location = (0.5, 0.5)
    curves.mapping.update()


@broken()
def ramp_of_one_stop(tree, output):
    ramp = node(tree, "ValToRGB", _emission(tree, output).inputs["Color"]).color_ramp
    ramp.elements.remove(ramp.elements[0])


@broken()
def displacement_of_nothing(tree, output):
    _emission(tree, output)
    node(tree, "Displacement", output.inputs["Displacement"])
    node(tree, "VolumeAbsorption", output.inputs["Volume"])


@broken(since=(5, 0, 0))
def zones_without_ends(tree, output):
    for kind in ("GeometryNodeRepeatInput", "GeometryNodeRepeatOutput", "NodeEvaluateClosure", "NodeClosureOutput"):
        tree.nodes.new(kind)
    tree.links.new(tree.nodes["Repeat Output"].outputs[-1], _emission(tree, output).inputs["Color"])


@broken(since=(5, 0, 0))
def menu_switch_of_no_items(tree, output):
    menu = tree.nodes.new("GeometryNodeMenuSwitch")
    menu.data_type = "RGBA"
    menu.enum_items.clear()
    tree.links.new(menu.outputs[0], _emission(tree, output).inputs["Color"])
