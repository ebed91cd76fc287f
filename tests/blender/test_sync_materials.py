"""Materials: node trees as the engine's colour class, and what is said about the rest."""

import bpy
import numpy as np
import pytest

from addon.engine.expression import Call, Parameter
from tests.blender.building import Constants, add_camera, image, material, node, quad, sync, value_of

METAL_BASE = (0.9, 0.6, 0.3, 1.0)


def shaded(build):
    """The engine material, scene and warnings of a quad whose tree `build(tree, surface socket)` makes."""
    add_camera()
    made, tree, output = material("stuff")
    build(tree, output)
    quad().data.materials.append(made)
    synced = sync()
    (instance,) = synced.scene.instances
    return Constants(synced.scene.materials[instance.materials[0]]), synced


def of_node(kind, **inputs):
    """The engine material of one shader node alone; it must not be reported."""
    read, synced = shaded(lambda tree, output: node(tree, kind, output.inputs["Surface"], **inputs))
    assert not synced.messages
    return read


def test_diffuse():
    read = of_node("BsdfDiffuse", Color=(0.2, 0.4, 0.6, 1.0))
    assert read.diffuse == pytest.approx((0.2, 0.4, 0.6))
    assert read.reflect == read.transmit == read.glow == read.highlight == (0.0, 0.0, 0.0) and not read.fresnel


def test_smooth_plastic_reflects_by_fresnel():
    read = of_node("BsdfPrincipled", Base_Color=(0.2, 0.4, 0.6, 1.0), Roughness=0.0, IOR=1.4)
    assert read.fresnel and read.ior == pytest.approx(1.4)
    assert read.diffuse == pytest.approx((0.2, 0.4, 0.6)) and read.reflect == pytest.approx((1.0, 1.0, 1.0))


def test_rough_plastic_reflects_by_fresnel_too():
    read = of_node("BsdfPrincipled", Base_Color=(0.5, 0.5, 0.5, 1.0), Roughness=0.5, IOR=1.5)
    assert read.fresnel and read.ior == pytest.approx(1.5) and read.roughness == pytest.approx(0.5)
    assert read.diffuse == pytest.approx((0.5,) * 3) and read.reflect == pytest.approx((1.0,) * 3)
    assert read.highlight == read.transmit == read.coat == read.metallic == (0.0, 0.0, 0.0)


def test_specular_level_changes_the_index_of_an_opaque_body():
    none = of_node("BsdfPrincipled", Roughness=0.0, Specular_IOR_Level=0.0)
    assert none.fresnel_ior == pytest.approx(1.0), "Fresnel's reflectance is 0"


def test_specular_level_doubled():
    twice = of_node("BsdfPrincipled", Roughness=0.0, Specular_IOR_Level=1.0)
    assert ((twice.fresnel_ior - 1.0) / (twice.fresnel_ior + 1.0)) ** 2 == pytest.approx(0.08)
    assert twice.ior == pytest.approx(1.5)


def test_smooth_metal_is_a_mirror_without_fresnel():
    read = of_node("BsdfPrincipled", Base_Color=METAL_BASE, Metallic=1.0, Roughness=0.0)
    assert read.metallic == pytest.approx(METAL_BASE[:3])
    assert read.diffuse == read.reflect == read.transmit == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("roughness", (0.0, 0.3, 1.0))
def test_metal_of_principled_grows_white_and_is_tinted_near_the_edge(roughness):
    read = of_node(
        "BsdfPrincipled", Base_Color=METAL_BASE, Metallic=1.0, Roughness=roughness, Specular_Tint=(0.2, 0.5, 1.0, 1.0)
    )
    assert read.metallic == pytest.approx(METAL_BASE[:3]) and read.reflect == (0.0, 0.0, 0.0)
    assert read.grazing == pytest.approx((1.0,) * 3) and read.edge == pytest.approx((0.2, 0.5, 1.0))
    assert read.roughness == pytest.approx(roughness) and read.diffuse == (0.0, 0.0, 0.0)


def test_half_a_metal_is_half_a_plastic():
    read = of_node("BsdfPrincipled", Base_Color=METAL_BASE, Metallic=0.5, Roughness=0.4, IOR=1.5)
    assert read.metallic == read.diffuse == pytest.approx([0.5 * c for c in METAL_BASE[:3]])
    assert read.grazing == read.reflect == pytest.approx((0.5,) * 3) and read.roughness == pytest.approx(0.4)
    assert read.diffuse_covered == pytest.approx(1.0), "all of the plastic's body"


def test_glossy_reflects_the_same_at_all_angles():
    read = of_node("BsdfAnisotropic", Color=METAL_BASE, Roughness=0.4)
    assert read.metallic == read.grazing == pytest.approx(METAL_BASE[:3])
    assert read.roughness == pytest.approx(0.4)


@pytest.mark.skipif(not hasattr(bpy.types, "ShaderNodeBsdfMetallic"), reason="since Blender 4.3")
def test_metallic_node():
    read = of_node("BsdfMetallic", Base_Color=METAL_BASE, Edge_Tint=(0.3, 0.4, 0.5, 1.0), Roughness=0.2)
    assert read.metallic == pytest.approx(METAL_BASE[:3]) and read.edge == pytest.approx((0.3, 0.4, 0.5))


@pytest.mark.skipif(not hasattr(bpy.types, "ShaderNodeBsdfMetallic"), reason="since Blender 4.3")
def test_metallic_node_by_index_and_extinction():
    def build(tree, output):
        made = node(tree, "BsdfMetallic", output.inputs["Surface"], Roughness=0.2)
        made.fresnel_type = "PHYSICAL_CONDUCTOR"
        made.inputs["IOR"].default_value, made.inputs["Extinction"].default_value = (0.2, 1.0, 1.5), (3.0, 2.0, 0.0)

    read, synced = shaded(build)
    assert not synced.messages
    expected = [((n - 1.0) ** 2 + k**2) / ((n + 1.0) ** 2 + k**2) for n, k in ((0.2, 3.0), (1.0, 2.0), (1.5, 0.0))]
    assert read.metallic == pytest.approx(expected)
    schlick = expected[2] + (1.0 - expected[2]) * (6.0 / 7.0) ** 5
    assert read.edge[2] * schlick == pytest.approx(0.4543, abs=1e-3), "a dielectric of 1.5 at 81.79 degrees"


def test_coat_lies_over_all_with_a_roughness_of_its_own():
    read = of_node(
        "BsdfPrincipled",
        Metallic=1.0,
        Roughness=0.5,
        Coat_Weight=0.7,
        Coat_Roughness=0.1,
        Coat_IOR=1.8,
        Coat_Tint=(0.9, 0.5, 0.1, 1.0),
    )
    assert read.coat == pytest.approx((0.7,) * 3) and read.coat_tint == pytest.approx((0.9, 0.5, 0.1))
    assert (read.coat_roughness, read.coat_ior, read.roughness) == pytest.approx((0.1, 1.8, 0.5))


def test_diffuse_roughness_and_translucent():
    assert of_node("BsdfDiffuse", Roughness=0.3).diffuse_roughness == pytest.approx(0.3)
    bpy.data.objects.remove(bpy.data.objects["quad"])
    read = of_node("BsdfTranslucent", Color=(0.2, 0.4, 0.6, 1.0))
    assert read.translucent == pytest.approx((0.2, 0.4, 0.6)) and read.diffuse == (0.0, 0.0, 0.0)


def test_holdout():
    assert of_node("Holdout").holdout == 1.0


def test_changing_constants_changes_no_structure():
    """Nothing is decided by a value: zero or not, a socket is a parameter in the same place."""

    def structure(**inputs):
        read, _ = shaded(lambda tree, output: node(tree, "BsdfPrincipled", output.inputs["Surface"], **inputs))
        bpy.data.objects.remove(bpy.data.objects["quad"])
        (made,) = (m for m in bpy.data.materials)
        bpy.data.materials.remove(made)
        return {name: type(value) for name, value in vars(read.material).items()}

    plain = structure()
    for inputs in (
        {"Metallic": 0.5},
        {"Transmission_Weight": 1.0, "IOR": 0.7},
        {"Coat_Weight": 1.0, "Coat_Tint": METAL_BASE, "Alpha": 0.3},
        {"Specular_IOR_Level": 0.0, "Specular_Tint": METAL_BASE, "Emission_Strength": 3.0},
    ):
        assert structure(**inputs) == plain


def test_multiscatter_is_of_metals():
    for node_type, distribution, expected in (
        ("BsdfAnisotropic", "MULTI_GGX", True),
        ("BsdfAnisotropic", "GGX", False),
        ("BsdfGlass", "MULTI_GGX", False),
    ):
        read, synced = shaded(
            lambda tree, output, kind=node_type, name=distribution: setattr(
                node(tree, kind, output.inputs["Surface"], Roughness=0.5), "distribution", name
            )
        )
        assert bool(read.multiscatter) is expected and not synced.messages
        bpy.data.objects.remove(bpy.data.objects["quad"])


def test_another_distribution_is_reported():
    _, synced = shaded(
        lambda tree, output: setattr(
            node(tree, "BsdfAnisotropic", output.inputs["Surface"]), "distribution", "BECKMANN"
        )
    )
    assert len(synced.warnings("distribution", "GGX")) == 1 == len(synced.messages)


def test_parts_of_different_roughness_are_reported():
    def build(tree, output):
        made = node(tree, "AddShader", output.inputs["Surface"])
        node(tree, "BsdfAnisotropic", made.inputs[0], Color=(0.2, 0.2, 0.2, 1.0), Roughness=0.0)
        node(tree, "BsdfAnisotropic", made.inputs[1], Color=(0.6, 0.6, 0.6, 1.0), Roughness=0.4)

    read, synced = shaded(build)
    assert read.roughness == pytest.approx(0.3) and read.metallic == pytest.approx((0.8,) * 3)
    assert len(synced.warnings("mean roughness")) == 1 == len(synced.messages)


def test_glass_of_principled_takes_the_root_at_each_surface():
    read = of_node(
        "BsdfPrincipled", Base_Color=(0.25, 0.81, 1.0, 1.0), Transmission_Weight=1.0, Roughness=0.0, IOR=1.33
    )
    assert read.fresnel and read.ior == pytest.approx(1.33)
    assert read.transmit == pytest.approx((0.5, 0.9, 1.0)) and read.reflect == pytest.approx((1.0, 1.0, 1.0))
    assert read.diffuse == (0.0, 0.0, 0.0)


def test_glass_bsdf_colors_reflection_too():
    read = of_node("BsdfGlass", Color=(0.5, 0.9, 1.0, 1.0), IOR=1.45)
    assert read.fresnel and read.ior == pytest.approx(1.45)
    assert read.transmit == read.reflect == pytest.approx((0.5, 0.9, 1.0))


def test_refraction_does_not_reflect():
    read = of_node("BsdfRefraction", Color=(0.5, 0.9, 1.0, 1.0), IOR=1.2, Roughness=0.0)
    assert not read.transmit_covered and read.ior == pytest.approx(1.2) and read.reflect == (0.0, 0.0, 0.0)
    assert read.transmit == pytest.approx((0.5, 0.9, 1.0))


def test_transparent_does_not_bend():
    read = of_node("BsdfTransparent", Color=(0.5, 0.9, 1.0, 1.0))
    assert not read.fresnel and read.ior == 1.0 and read.transmit == pytest.approx((0.5, 0.9, 1.0))


def test_alpha():
    read = of_node("BsdfPrincipled", Base_Color=(1.0, 1.0, 1.0, 1.0), Roughness=1.0, Alpha=0.25, Specular_IOR_Level=0.0)
    assert read.transmit == pytest.approx((0.75,) * 3) and read.ior == 1.0
    assert read.diffuse == pytest.approx((0.25,) * 3)


def test_emission():
    read = of_node("Emission", Color=(1.0, 0.5, 0.25, 1.0), Strength=8.0)
    assert read.glow == pytest.approx((8.0, 4.0, 2.0)) and read.diffuse == (0.0, 0.0, 0.0)


def test_emission_of_principled():
    read = of_node("BsdfPrincipled", Emission_Color=(1.0, 0.5, 0.25, 1.0), Emission_Strength=2.0)
    assert read.glow == pytest.approx((2.0, 1.0, 0.5))


def test_glossy_is_a_metal():
    node_type = "BsdfGlossy" if bpy.app.version >= (5, 0, 0) else "BsdfAnisotropic"
    read = of_node(node_type, Color=METAL_BASE, Roughness=0.0)
    assert read.metallic == pytest.approx(METAL_BASE[:3]) and not read.fresnel


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


def test_volume_absorption():
    def build(tree, output):
        node(tree, "BsdfGlass", output.inputs["Surface"])
        node(tree, "VolumeAbsorption", output.inputs["Volume"], Color=(0.0, 0.5, 1.0, 1.0), Density=2.0)

    read, synced = shaded(build)
    assert read.absorption == pytest.approx((2.0, 1.0, 0.0)) and not synced.messages


def test_volume_alone_has_no_surface():
    read, _ = shaded(lambda tree, output: node(tree, "VolumeAbsorption", output.inputs["Volume"], Density=2.0))
    assert read.transmit == (1.0, 1.0, 1.0) and read.ior == 1.0


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


def test_inputs_that_are_not_rendered_are_named_together():
    def build(tree, output):
        principled = node(tree, "BsdfPrincipled", output.inputs["Surface"], Subsurface_Weight=0.5, Sheen_Weight=1.0)
        node(tree, "Bump", principled.inputs["Coat Normal"])

    _, synced = shaded(build)
    assert len(synced.messages) == 1
    assert synced.warnings("Coat Normal, Subsurface Weight and Sheen Weight are not rendered")


def test_rough_glass_is_rough_on_both_ways():
    read = of_node("BsdfGlass", Roughness=0.3)
    assert read.roughness == read.transmit_roughness == pytest.approx(0.3)


def test_rough_refraction():
    read, synced = shaded(lambda tree, output: node(tree, "BsdfRefraction", output.inputs["Surface"], Roughness=0.3))
    assert len(synced.warnings("distribution")) == 1 == len(synced.messages), "Beckmann's, which the node begins with"
    assert read.transmit_roughness == pytest.approx(0.3) and read.roughness == 0.0


def test_displacement_is_reported():
    def build(tree, output):
        node(tree, "BsdfGlass", output.inputs["Surface"])
        node(tree, "Displacement", output.inputs["Displacement"])

    _, synced = shaded(build)
    assert synced.warnings("displacement", "'Displacement'")


def test_tree_without_output():
    read, synced = shaded(lambda tree, output: tree.nodes.remove(output))
    assert read.diffuse == (0.0, 0.0, 0.0) and synced.warnings("'stuff'", "no output")


@pytest.mark.skipif(bpy.app.version >= (5, 0, 0), reason="since Blender 5.0 every material has nodes")
def test_without_nodes():
    add_camera()
    made = bpy.data.materials.new("plain")
    made.use_nodes = False
    made.diffuse_color, made.metallic, made.roughness = METAL_BASE, 1.0, 0.0
    quad().data.materials.append(made)
    (read,) = sync().scene.materials
    assert Constants(read).metallic == pytest.approx(METAL_BASE[:3])


def test_material_override_of_the_view_layer():
    add_camera()
    made, tree, output = material("clay")
    node(tree, "BsdfDiffuse", output.inputs["Surface"], Color=(0.1, 0.2, 0.3, 1.0))
    bpy.context.view_layer.material_override = made
    quad().data.materials.append(material("hidden")[0])
    (read,) = sync().scene.materials
    assert Constants(read).diffuse == pytest.approx((0.1, 0.2, 0.3))


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
