"""Trees that are broken, odd or not understood: they are rendered, and the picture around them is as it was."""

import bpy
import numpy as np
import pytest

from tests.blender.building import add_camera, link, material, mesh_of, node, sync
from tests.blender.pictures import picture

#: What the square beside the one of a broken material shows.
_GOOD = (0.2, 0.5, 0.8)
#: Pixels along an edge of a square.
_SIZE = 12
#: Groups in groups: more than anyone makes, as many as Blender itself opens without running out of stack.
_DEPTH = 60
_CHAIN = 300


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


def cycle_of_values(tree, output):
    emission = _emission(tree, output)
    a = node(tree, "Math", emission.inputs["Strength"])
    b = node(tree, "Math", a.inputs[0])
    tree.links.new(a.outputs[0], b.inputs[0])


def node_that_feeds_itself(tree, output):
    mix = node(tree, "MixRGB", _emission(tree, output).inputs["Color"])
    tree.links.new(mix.outputs[0], mix.inputs[1])


def cycle_of_shaders(tree, output):
    a = node(tree, "MixShader", output.inputs["Surface"])
    b = node(tree, "AddShader", a.inputs[1])
    tree.links.new(a.outputs[0], b.inputs[0])
    node(tree, "Emission", a.inputs[2])


def cycle_of_reroutes(tree, output):
    a, b = tree.nodes.new("NodeReroute"), tree.nodes.new("NodeReroute")
    tree.links.new(a.outputs[0], b.inputs[0])
    tree.links.new(b.outputs[0], a.inputs[0])
    tree.links.new(b.outputs[0], _emission(tree, output).inputs["Color"])


def reroute_of_nothing(tree, output):
    tree.links.new(tree.nodes.new("NodeReroute").outputs[0], _emission(tree, output).inputs["Color"])


def no_image(tree, output):
    node(tree, "TexImage", _emission(tree, output).inputs["Color"])


def missing_image(tree, output):
    texture = node(tree, "TexImage", _emission(tree, output).inputs["Color"])
    texture.image = bpy.data.images.new("gone", 4, 4)
    texture.image.source, texture.image.filepath = "FILE", "//is not there.png"


def missing_sequence(tree, output):
    missing_image(tree, output)
    bpy.data.images["gone"].source = "SEQUENCE"


def missing_movie(tree, output):
    missing_image(tree, output)
    bpy.data.images["gone"].source = "MOVIE"


def missing_tiles(tree, output):
    missing_image(tree, output)
    bpy.data.images["gone"].source = "TILED"


def missing_image_of_a_bsdf(tree, output):
    missing_image(tree, output)
    image_node = next(n for n in tree.nodes if n.type == "TEX_IMAGE")
    principled = node(tree, "BsdfPrincipled", output.inputs["Surface"])
    for name in ("Base Color", "Roughness", "Alpha", "Normal"):
        tree.links.new(image_node.outputs[0], principled.inputs[name])


def unlinked_output(tree, output):
    _emission(tree, output)
    tree.links.clear()


def no_output(tree, output):
    _emission(tree, output)
    tree.nodes.remove(output)


def no_nodes(tree, output):
    tree.nodes.clear()


def two_outputs_none_active(tree, output):
    _emission(tree, tree.nodes.new("ShaderNodeOutputMaterial"))
    _emission(tree, output)
    for one in tree.nodes:
        if one.type == "OUTPUT_MATERIAL":
            one.is_active_output = False


def driver_that_divides_by_zero(tree, output):
    _drive(_emission(tree, output), "1.0 / 0.0")


def driver_of_an_unknown_name(tree, output):
    _drive(_emission(tree, output), "nobody_knows(3)")


def _drive(emission, expression):
    curve = emission.inputs["Strength"].driver_add("default_value")
    curve.driver.type, curve.driver.expression = "SCRIPTED", expression


def group_of_no_tree(tree, output):
    _add_group(tree, None)


def group_without_an_output(tree, output):
    _add_group(tree, _group(), _emission(tree, output).inputs["Color"])


def group_with_an_unlinked_output(tree, output):
    group = _group(lambda inner: inner.nodes.new("NodeGroupOutput"))
    _add_group(tree, group, _emission(tree, output).inputs["Color"])


def group_whose_input_is_its_output(tree, output):
    def fill(inner):
        inner.links.new(inner.nodes.new("NodeGroupInput").outputs[0], inner.nodes.new("NodeGroupOutput").inputs[0])

    made = _add_group(tree, _group(fill, inputs=("Color",)), _emission(tree, output).inputs["Color"])
    made.inputs[0].default_value = (0.3, 0.6, 0.1, 1.0)


def group_fed_by_itself(tree, output):
    group_whose_input_is_its_output(tree, output)
    made = next(n for n in tree.nodes if n.type == "GROUP")
    tree.links.new(made.outputs[0], made.inputs[0])


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


def long_chain(tree, output):
    socket = _emission(tree, output).inputs["Color"]
    for _ in range(_CHAIN):
        made = node(tree, "Math", socket)
        made.inputs[1].default_value = 1.0 / _CHAIN
        socket = made.inputs[0]


def group_input_outside_a_group(tree, output):
    made = tree.nodes.new("NodeGroupInput")
    if made.outputs:
        tree.links.new(made.outputs[0], _emission(tree, output).inputs["Color"])
    else:
        _emission(tree, output)


def muted_texture(tree, output):
    node(tree, "TexNoise", _emission(tree, output).inputs["Color"]).mute = True


def muted_value_node(tree, output):
    mix = node(tree, "MixRGB", _emission(tree, output).inputs["Color"])
    mix.inputs[1].default_value, mix.mute = (0.3, 0.6, 0.1, 1.0), True


def muted_group(tree, output):
    group_whose_input_is_its_output(tree, output)
    next(n for n in tree.nodes if n.type == "GROUP").mute = True


def muted_emission(tree, output):
    _emission(tree, output).mute = True


def muted_mix_of_shaders(tree, output):
    mix = node(tree, "MixShader", output.inputs["Surface"])
    for socket in (mix.inputs[1], mix.inputs[2]):
        node(tree, "Emission", socket)
    mix.mute = True


def muted_link(tree, output):
    socket = _emission(tree, output).inputs["Color"]
    node(tree, "TexNoise", socket)
    socket.links[0].is_muted = True


def unknown_node(tree, output):
    bpy.utils.register_class(_Unknown)
    try:
        made = tree.nodes.new(_Unknown.bl_idname)
        made.node_tree = _group(lambda inner: inner.nodes.new("NodeGroupOutput"))
        tree.links.new(made.outputs[0], _emission(tree, output).inputs["Color"])
    finally:
        bpy.utils.unregister_class(_Unknown)


def script_without_a_script(tree, output):
    tree.nodes.new("ShaderNodeScript")
    _emission(tree, output)


def shader_as_a_color(tree, output):
    emission = _emission(tree, output)
    tree.links.new(node(tree, "BsdfDiffuse").outputs[0], emission.inputs["Color"])


def color_as_a_shader(tree, output):
    tree.links.new(node(tree, "RGB").outputs[0], output.inputs["Surface"])


def numbers_without_end(tree, output):
    emission = _emission(tree, output)
    power = node(tree, "Math", emission.inputs["Strength"])
    power.operation = "POWER"
    power.inputs[0].default_value, power.inputs[1].default_value = 1e30, 1e3


def roots_and_quotients_of_nothing(tree, output):
    emission = _emission(tree, output)
    total = node(tree, "Math", emission.inputs["Strength"])
    for socket, operation in zip(total.inputs, ("LOGARITHM", "ARCSINE"), strict=False):
        made = node(tree, "Math", socket)
        made.operation = operation
        made.inputs[0].default_value = -5.0


def attribute_that_is_not_there(tree, output):
    mix = node(tree, "MixRGB", _emission(tree, output).inputs["Color"])
    mix.blend_type = "ADD"
    for socket, name in zip(list(mix.inputs)[:2], ("", "nobody has it"), strict=True):
        node(tree, "Attribute", socket).attribute_name = name


def uv_map_that_is_not_there(tree, output):
    checker = node(tree, "TexChecker", _emission(tree, output).inputs["Color"])
    node(tree, "UVMap", checker.inputs["Vector"]).uv_map = "nobody has it"


def coordinates_of_a_deleted_object(tree, output):
    checker = node(tree, "TexChecker", _emission(tree, output).inputs["Color"])
    coordinates = node(tree, "TexCoord", checker.inputs["Vector"], "Object")
    coordinates.object = link(None, "gone")
    bpy.data.objects.remove(coordinates.object)


def curves_of_no_width(tree, output):
    curves = node(tree, "RGBCurve", _emission(tree, output).inputs["Color"])
    for curve in curves.mapping.curves:
        for point in curve.points:
            point.location = (0.5, 0.5)
    curves.mapping.update()


def ramp_of_one_stop(tree, output):
    ramp = node(tree, "ValToRGB", _emission(tree, output).inputs["Color"]).color_ramp
    ramp.elements.remove(ramp.elements[0])


def displacement_of_nothing(tree, output):
    _emission(tree, output)
    node(tree, "Displacement", output.inputs["Displacement"])
    node(tree, "VolumeAbsorption", output.inputs["Volume"])


def zones_without_ends(tree, output):
    for kind in ("GeometryNodeRepeatInput", "GeometryNodeRepeatOutput", "NodeEvaluateClosure", "NodeClosureOutput"):
        tree.nodes.new(kind)
    tree.links.new(tree.nodes["Repeat Output"].outputs[-1], _emission(tree, output).inputs["Color"])


def menu_switch_of_no_items(tree, output):
    menu = tree.nodes.new("GeometryNodeMenuSwitch")
    menu.data_type = "RGBA"
    menu.enum_items.clear()
    tree.links.new(menu.outputs[0], _emission(tree, output).inputs["Color"])


MATERIALS = [
    *(cycle_of_values, node_that_feeds_itself, cycle_of_shaders, cycle_of_reroutes, reroute_of_nothing, no_image),
    *(
        missing_image,
        missing_sequence,
        missing_movie,
        missing_tiles,
        missing_image_of_a_bsdf,
        unlinked_output,
        no_output,
    ),
    *(no_nodes, two_outputs_none_active, driver_that_divides_by_zero, driver_of_an_unknown_name, group_of_no_tree),
    *(group_without_an_output, group_with_an_unlinked_output, group_whose_input_is_its_output, group_fed_by_itself),
    *(group_in_itself, groups_nested_deeply, long_chain, group_input_outside_a_group, muted_texture, muted_value_node),
    *(muted_group, muted_emission, muted_mix_of_shaders, muted_link, unknown_node, script_without_a_script),
    *(shader_as_a_color, color_as_a_shader, numbers_without_end, roots_and_quotients_of_nothing),
    *(attribute_that_is_not_there, uv_map_that_is_not_there, coordinates_of_a_deleted_object, curves_of_no_width),
    *(ramp_of_one_stop, displacement_of_nothing),
]
if bpy.app.version >= (5, 0, 0):
    MATERIALS += [zones_without_ends, menu_switch_of_no_items]
#: What Cycles crashes on.
CRASHES_CYCLES = [group_fed_by_itself] if bpy.app.version < (5, 0, 0) else []
#: What may look otherwise: Cycles takes a color for a shader that emits it.
UNLIKE_CYCLES = [color_as_a_shader, *CRASHES_CYCLES]


def _square(column, made):
    corners = [(column + x, y, 0.0) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    mesh = mesh_of(corners, [(0, 1, 2, 3)], "square")
    mesh.materials.append(made)
    return link(mesh, "square")


def _broken(build):
    made, tree, output = material(build.__name__[:60])
    build(tree, output)
    return made


def _rendered(count, folder, engine="CONIC"):
    """The squares (count, pixels, 4) of a row."""
    camera = add_camera(type="ORTHO", ortho_scale=float(count))
    camera.location = (count / 2.0, 0.5, 10.0)
    scene = bpy.context.scene
    render = scene.render
    render.engine, render.film_transparent = engine, True
    render.resolution_x, render.resolution_y, render.resolution_percentage = count * _SIZE, _SIZE, 100
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.image_settings.color_mode = "RGBA"
    render.filepath = str(folder / f"{engine}.exr")
    scene.conic.samples, scene.cycles.samples, scene.cycles.device = 1, 4, "CPU"
    bpy.ops.render.render(write_still=True)
    pixels = picture(render.filepath).reshape(_SIZE, count, _SIZE, 4).transpose(1, 0, 2, 3)
    return pixels[:, 2:-2, 2:-2].reshape(count, -1, 4)


def _good():
    made, tree, output = material("good")
    node(tree, "Emission", output.inputs["Surface"], Color=(*_GOOD, 1.0))
    return made


def _add_sun():
    light = bpy.data.lights.new("sun", "SUN")
    light.energy = 3.0
    link(light, "sun")


@pytest.fixture(scope="module")
def squares(registered, tmp_path_factory):
    """A row of squares by each engine: a good one, all broken ones, one without a material, a good one."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    _add_sun()
    for column, made in enumerate((_good(), *map(_broken, MATERIALS), None, _good())):
        _square(column, made)
    folder = tmp_path_factory.mktemp("pictures")
    conic = _rendered(len(MATERIALS) + 3, folder)
    for build in CRASHES_CYCLES:
        bpy.data.materials.remove(bpy.data.materials[build.__name__])
    return conic[..., :3], _rendered(len(MATERIALS) + 3, folder, "CYCLES")[..., :3]


def test_what_is_beside_broken_materials(squares):
    conic, _ = squares
    assert np.isfinite(conic).all()
    for good in (conic[0], conic[-1]):
        np.testing.assert_allclose(good, np.broadcast_to(_GOOD, good.shape), rtol=1e-5)
    assert conic[-2].min() > 0.1, "without a material it is grey"


@pytest.mark.parametrize("build", MATERIALS)
def test_broken_material(build, squares):
    """It looks as in Cycles; where that shows nothing, something may be seen."""
    ours, theirs = (row[MATERIALS.index(build) + 1].mean(axis=0) for row in squares)
    assert ours.any() or theirs.max() < 0.01
    if theirs.max() > 0.01 and build not in UNLIKE_CYCLES:
        np.testing.assert_allclose(ours, theirs, atol=0.1)


def test_reports_of_broken_materials():
    """Each is named at most twice, and nothing is said twice."""
    for column, build in enumerate(MATERIALS):
        _square(column, _broken(build))
    add_camera()
    texts = [text for _, text in sync().messages]
    assert len(texts) == len(set(texts))
    for build in MATERIALS:
        assert sum(repr(build.__name__) in text for text in texts) <= 2, build.__name__


@pytest.mark.parametrize("build", [cycle_of_values, no_image, missing_image, long_chain, unknown_node, group_in_itself])
def test_broken_world(build, tmp_path):
    """A world whose Background is fed by what is broken, with a body that glows before it."""
    world = bpy.data.worlds.new("broken")
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True
    world.node_tree.nodes.clear()
    output = world.node_tree.nodes.new("ShaderNodeOutputWorld")
    build(world.node_tree, output)
    bpy.context.scene.world = world
    _square(0, _good())
    squares = _rendered(1, tmp_path)
    np.testing.assert_allclose(squares[0, :, :3], np.broadcast_to(_GOOD, squares[0, :, :3].shape), rtol=1e-5)


@pytest.mark.parametrize("build", [cycle_of_values, no_image, unknown_node, driver_that_divides_by_zero])
def test_broken_light(build, tmp_path):
    light = bpy.data.lights.new("broken", "SUN")
    if bpy.app.version < (5, 2, 0):
        light.use_nodes = True
    light.node_tree.nodes.clear()
    build(light.node_tree, light.node_tree.nodes.new("ShaderNodeOutputLight"))
    link(light, "light")
    _square(0, _good())
    squares = _rendered(1, tmp_path)
    np.testing.assert_allclose(squares[0, :, :3], np.broadcast_to(_GOOD, squares[0, :, :3].shape), rtol=1e-5)
