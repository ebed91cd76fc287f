"""Node trees: how shaders are mixed, links and groups followed, colors and images computed, and what is reported."""

import bpy
import numpy as np
import pytest

from addon.engine.expression import Call, Parameter
from tests.blender.building import Constants, add_camera, image, material, node, quad, shaded, sync, value_of


def mix(tree, output, factor=0.25, second="Emission"):
    """A Mix Shader of red diffuse and another shader."""
    made = node(tree, "MixShader", output.inputs["Surface"])
    made.inputs[0].default_value = factor
    node(tree, "BsdfDiffuse", made.inputs[1], Color=(1.0, 0.0, 0.0, 1.0))
    node(tree, second, made.inputs[2])
    return made


def test_mix_shader_by_a_constant():
    read, synced = shaded(mix)
    assert read.diffuse == pytest.approx((0.75, 0.0, 0.0)) and read.glow == pytest.approx((0.25,) * 3)
    assert not synced.messages


def test_mix_shader_by_a_value_node():
    def build(tree, output):
        node(tree, "Value", mix(tree, output).inputs[0]).outputs[0].default_value = 0.5

    read, synced = shaded(build)
    assert read.diffuse == pytest.approx((0.5, 0.0, 0.0)) and not synced.messages


def test_mix_shader_by_what_varies():
    """By a number of each place, by which all shares are multiplied."""

    def build(tree, output):
        made = mix(tree, output, second="BsdfAnisotropic")
        node(tree, "Fresnel", made.inputs[0], IOR=1.33)

    read, synced = shaded(build)
    assert isinstance(read.material.diffuse, Call) and isinstance(read.material.metallic, Call) and not synced.messages
    assert isinstance(read.material.roughness, Parameter), "that of the glossy part"


def test_shaders_in_a_circle_are_reported():
    def build(tree, output):
        made = mix(tree, output)
        tree.links.new(made.outputs[0], made.inputs[2])

    read, synced = shaded(build)
    assert len(synced.warnings("'Mix Shader'", "feeds itself")) == 1
    assert read.diffuse == pytest.approx((0.75, 0.0, 0.0))


def test_add_shader():
    def build(tree, output):
        made = node(tree, "AddShader", output.inputs["Surface"])
        node(tree, "BsdfDiffuse", made.inputs[0], Color=(0.5, 0.0, 0.0, 1.0))
        node(tree, "BsdfTransparent", made.inputs[1], Color=(0.0, 0.5, 0.0, 1.0))

    read, _ = shaded(build)
    assert read.diffuse == pytest.approx((0.5, 0.0, 0.0)) and read.transmit == pytest.approx((0.0, 0.5, 0.0))


def test_reroutes_muted_nodes_and_groups_are_followed():
    def build(tree, output):
        group = bpy.data.node_groups.new("group", "ShaderNodeTree")
        group.interface.new_socket("Tint", in_out="INPUT", socket_type="NodeSocketColor")
        group.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
        inside, outside = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
        diffuse = node(group, "BsdfDiffuse", outside.inputs[0])
        group.links.new(inside.outputs[0], diffuse.inputs["Color"])
        used = node(tree, "Group")
        used.node_tree = group
        reroute = tree.nodes.new("NodeReroute")
        muted = node(tree, "AddShader", output.inputs["Surface"])
        muted.mute = True
        tree.links.new(used.outputs[0], reroute.inputs[0])
        tree.links.new(reroute.outputs[0], muted.inputs[0])
        node(tree, "RGB", used.inputs[0]).outputs[0].default_value = (0.1, 0.2, 0.3, 1.0)

    read, synced = shaded(build)
    assert read.diffuse == pytest.approx((0.1, 0.2, 0.3)) and not synced.messages


def test_unlinked_group_input_takes_the_groups_own_value():
    def build(tree, output):
        group = bpy.data.node_groups.new("group", "ShaderNodeTree")
        group.interface.new_socket("Tint", in_out="INPUT", socket_type="NodeSocketColor")
        group.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
        inside, outside = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
        group.links.new(inside.outputs[0], node(group, "BsdfDiffuse", outside.inputs[0]).inputs["Color"])
        used = node(tree, "Group")
        used.node_tree = group
        used.inputs[0].default_value = (0.3, 0.2, 0.1, 1.0)
        tree.links.new(used.outputs[0], output.inputs["Surface"])

    assert shaded(build)[0].diffuse == pytest.approx((0.3, 0.2, 0.1))


def test_unknown_shader_is_diffuse_of_its_color_and_named_once():
    add_camera()
    made, tree, output = material("fuzzy")
    node(tree, "BsdfSheen", output.inputs["Surface"], Color=(0.1, 0.2, 0.3, 1.0))
    for name in "ab":
        quad(name).data.materials.append(made)
    synced = sync()
    assert Constants(synced.scene.materials[0]).diffuse == pytest.approx((0.1, 0.2, 0.3))
    assert len(synced.warnings("'fuzzy'", "'Sheen BSDF'", "diffuse")) == 1 == len(synced.messages)


def test_unknown_node_falls_back_to_the_sockets_own_color():
    def build(tree, output):
        diffuse = node(tree, "BsdfDiffuse", output.inputs["Surface"], Color=(0.1, 0.2, 0.3, 1.0))
        node(tree, "TexIES", diffuse.inputs["Color"])

    read, synced = shaded(build)
    assert read.diffuse == pytest.approx((0.1, 0.2, 0.3))
    assert len(synced.warnings("'stuff'", "'IES Texture'", "(0.10, 0.20, 0.30)")) == 1


def test_a_color_as_the_surface_is_given_off():
    """As in Cycles."""
    read, synced = shaded(
        lambda tree, output: setattr(
            node(tree, "RGB", output.inputs["Surface"]).outputs[0], "default_value", (0.1, 0.2, 0.3, 1.0)
        )
    )
    assert read.glow == pytest.approx((0.1, 0.2, 0.3)) and not synced.messages


def test_displacement_is_reported():
    def build(tree, output):
        node(tree, "BsdfGlass", output.inputs["Surface"])
        node(tree, "Displacement", output.inputs["Displacement"])

    _, synced = shaded(build)
    assert synced.warnings("displacement", "'Displacement'")


def test_tree_without_output():
    read, synced = shaded(lambda tree, output: tree.nodes.remove(output))
    assert read.diffuse == (0.0, 0.0, 0.0) and synced.warnings("'stuff'", "no output")


def with_image(tree, output, picture, to="Base Color", **inputs):
    principled = node(tree, "BsdfPrincipled", output.inputs["Surface"], **inputs)
    textured = node(tree, "TexImage", principled.inputs[to])
    textured.image = picture
    return textured


#: What an image shows somewhere.
TEXEL = (0.5, 0.25, 1.0, 0.8)


def test_image_as_base_color_of_metal_and_body():
    picture = image(np.full((2, 2, 4), 0.5), float_buffer=True)
    read, synced = shaded(lambda tree, output: with_image(tree, output, picture, Metallic=0.5, Roughness=0.0))
    assert len(synced.scene.images) == 1 and not synced.messages
    for share in (read.diffuse, read.metallic):
        assert value_of(share, image_sample=TEXEL) == pytest.approx((0.25, 0.125, 0.5))
    assert value_of(read.reflect) == pytest.approx((0.5,) * 3), "the body's surface is white"


def test_image_as_emission():
    picture = image(np.full((2, 2, 4), 0.5), float_buffer=True)
    read, _ = shaded(lambda tree, output: with_image(tree, output, picture, "Emission Color", Emission_Strength=3.0))
    assert value_of(read.glow, image_sample=TEXEL) == pytest.approx((1.5, 0.75, 3.0))
    assert isinstance(read.material.diffuse, Parameter)


@pytest.mark.parametrize("other", ("image", "color"))
def test_mixed_images_are_mixed_where_they_are_seen(other):
    def build(tree, output):
        made = node(tree, "MixShader", output.inputs["Surface"])
        made.inputs[0].default_value = 0.25
        for i in (1, 2):
            diffuse = node(tree, "BsdfDiffuse", made.inputs[i], Color=(0.4, 0.4, 0.4, 1.0))
            if i == 1 or other == "image":
                picture = image(np.full((2, 2, 4), 0.5), str(i), float_buffer=True)
                node(tree, "TexImage", diffuse.inputs["Color"]).image = picture

    read, synced = shaded(build)
    assert len(synced.scene.images) == (2 if other == "image" else 1) and not synced.messages
    second = np.array(TEXEL[:3]) if other == "image" else 0.4
    assert value_of(read.diffuse, image_sample=TEXEL) == pytest.approx(0.75 * np.array(TEXEL[:3]) + 0.25 * second)


@pytest.mark.parametrize("kind", ("Mix", "MixRGB"))
def test_image_times_a_color(kind):
    def build(tree, output):
        diffuse = node(tree, "BsdfDiffuse", output.inputs["Surface"])
        made = tree.nodes.new(f"ShaderNode{kind}")
        if kind == "Mix":
            made.data_type = "RGBA"
        factor, first, second = (socket for socket in made.inputs if socket.enabled)
        made.blend_type = "MULTIPLY"
        factor.default_value, second.default_value = 1.0, (1.0, 0.5, 0.25, 1.0)
        node(tree, "TexImage", first).image = image(np.ones((2, 2, 4)))
        tree.links.new(next(o for o in made.outputs if o.enabled), diffuse.inputs["Color"])

    read, synced = shaded(build)
    assert value_of(read.diffuse, image_sample=TEXEL) == pytest.approx((0.5, 0.125, 0.25)) and not synced.messages


def computed(build):
    """The glow of an emission whose strength `build(tree, socket)` feeds, and the messages."""

    def whole(tree, output):
        build(tree, node(tree, "Emission", output.inputs["Surface"], Color=(1.0, 0.5, 0.25, 1.0)).inputs["Strength"])

    read, synced = shaded(whole)
    return read.glow, synced.messages


def test_nodes_with_constants_are_constants():
    def build(tree, socket):
        made = node(tree, "Math", socket)
        made.operation = "POWER"
        made.inputs[1].default_value = 3.0
        clamp = node(tree, "Clamp", made.inputs[0], Value=7.0, Max=2.0)
        node(tree, "CombineXYZ", clamp.inputs["Value"], X=6.0, Y=6.0, Z=9.0)

    glow, messages = computed(build)
    assert glow == pytest.approx((8.0, 4.0, 2.0)) and not messages


def test_a_color_is_as_bright_as_its_luminance():
    def build(tree, socket):
        node(tree, "RGB", socket).outputs[0].default_value = (1.0, 0.5, 0.0, 1.0)

    glow, messages = computed(build)
    assert glow[0] == pytest.approx(0.2126 + 0.5 * 0.7152, rel=1e-4) and not messages


@pytest.mark.skipif(not hasattr(bpy.types, "GeometryNodeMenuSwitch"), reason="a node of later Blenders")
@pytest.mark.parametrize("item", ("Plain", "Shaded"))
def test_menu_switch_takes_its_item(item):
    def build(tree, output):
        diffuse = node(tree, "BsdfDiffuse", output.inputs["Surface"])
        switch = tree.nodes.new("GeometryNodeMenuSwitch")
        switch.data_type = "RGBA"
        switch.enum_items.clear()
        for name in ("Plain", "Shaded"):
            switch.enum_items.new(name)
        switch.inputs["Menu"].default_value = item
        switch.inputs["Plain"].default_value = (0.1, 0.2, 0.3, 1.0)
        occlusion = node(tree, "AmbientOcclusion", switch.inputs["Shaded"])
        node(tree, "TexImage", occlusion.inputs["Color"]).image = image(np.ones((2, 2, 4)))
        tree.links.new(switch.outputs[0], diffuse.inputs["Color"])

    add_camera()
    made, tree, output = material("stuff")
    try:
        build(tree, output)
    except RuntimeError:
        pytest.skip("this Blender has no Menu Switch among its shader nodes")
    quad().data.materials.append(made)
    synced = sync()
    (read,) = synced.scene.materials
    if item == "Plain":
        assert Constants(read).diffuse == pytest.approx((0.1, 0.2, 0.3)) and not synced.messages
    else:
        assert len(synced.warnings("'Ambient Occlusion'")) == 1 == len(synced.messages)


def test_the_node_that_is_not_understood_is_named_not_the_ones_behind_it():
    def build(tree, output):
        shader = node(tree, "BsdfDiffuse", output.inputs["Surface"])
        ramp = node(tree, "ValToRGB", shader.inputs["Color"])
        separate = node(tree, "SeparateXYZ", ramp.inputs[0], output="Z")
        node(tree, "AmbientOcclusion", separate.inputs[0])

    _, synced = shaded(build)
    assert len(synced.warnings("node 'Ambient Occlusion' is not rendered")) == 1 == len(synced.messages)


def test_coordinates_from_the_instancer_are_named_by_that():
    def build(tree, output):
        coordinates = node(tree, "TexCoord")
        coordinates.from_instancer = True
        tree.links.new(coordinates.outputs["UV"], node(tree, "BsdfDiffuse", output.inputs["Surface"]).inputs["Color"])

    synced = shaded(build)[1]
    assert synced.warnings("'Texture Coordinate'", "from the instancer", "the instance itself")
    assert len(synced.messages) == 1
